% SPDX-License-Identifier: BSD-3-Clause
function r = interp1(x, y, a, varargin)
% Table of an expression: interp1(x, y, a, 'linear' or 'spline', 'extrap' or a number).
if isa(x, 'sfdae_expression') || isa(y, 'sfdae_expression')
  unsupported('interp1 with points that depend on unknowns', 'use points of numbers');
end
method = 'linear';
outside = NaN;
for k = 1:numel(varargin)
  if ~ischar(varargin{k})
    outside = varargin{k};
  elseif strcmpi(varargin{k}, 'extrap')
    outside = Inf;
  else
    method = lower(varargin{k});
  end
end
if strcmp(method, 'linear')
  degree = 1;
elseif strcmp(method, 'spline')
  degree = 3;
else
  unsupported(sprintf('interp1 with the method ''%s''', method), 'use ''linear'' or ''spline'', or sfdae_table');
end
if ~(isnumeric(outside) && isscalar(outside) && isnan(outside))
  unsupported('interp1 with values outside of the table', ...
              'write interp1(x, y, min(max(a, x(1)), x(end))) for constant extrapolation');
end
r = sfdae_table(a, degree, x, y);
end
