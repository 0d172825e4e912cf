% SPDX-License-Identifier: BSD-3-Clause
function r = end(a, k, count)
% The last index in x(end).
if count == 1
  r = numel(a.id);
else
  r = size(a.id, k);
end
end
