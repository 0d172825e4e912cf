% SPDX-License-Identifier: BSD-3-Clause
function r = subsref(a, s)
% x(i), x(i, j), x(:), x(mask).
if ~strcmp(s(1).type, '()')
  error('sfdae:illegal_argument', 'an expression has no fields and no cells: index it as x(i) or x(i, j)');
end
r = a;
r.id = a.id(s(1).subs{:});
if numel(s) > 1
  r = subsref(r, s(2:end));
end
end
