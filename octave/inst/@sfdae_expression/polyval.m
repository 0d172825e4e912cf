% SPDX-License-Identifier: BSD-3-Clause
function r = polyval(p, a)
% Value of the polynomial with the coefficients p, highest power first, by Horner's rule.
if isempty(p)
  r = 0 * a;
else
  r = p(1);
  for k = 2:numel(p)
    r = r .* a + p(k);
  end
  if numel(p) == 1
    r = p(1) + 0 * a;
  end
end
end
