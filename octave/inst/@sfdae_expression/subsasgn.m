% SPDX-License-Identifier: BSD-3-Clause
function r = subsasgn(a, s, value)
% r(i) = value, r(i, j) = value, r(i) = [], for an expression r.
if numel(s) ~= 1 || ~strcmp(s.type, '()')
  error('sfdae:illegal_argument', 'elements of an expression are written as r(i) = value or r(i, j) = value');
end
if isempty(value) && isnumeric(value) && ~isa(value, 'sfdae_expression')
  a.id(s.subs{:}) = [];
  r = a;
  return
end
if isa(a, 'sfdae_expression')
  ids = a.id;
else
  ids = sfdae_mex('nodes', operand(a));
end
count = numel(ids);
ids(s.subs{:}) = sfdae_mex('nodes', operand(value));
if numel(ids) > count && any(ids(:) == 0)
  ids(ids == 0) = sfdae_mex('nodes', 0);
end
r = sfdae_expression(ids);
end
