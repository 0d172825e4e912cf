% SPDX-License-Identifier: BSD-3-Clause
function r = cross(a, b)
% Vector product of two vectors of three elements; the size is that of a.
if numel(a) ~= 3 || numel(b) ~= 3
  error('sfdae:illegal_argument', 'cross: two vectors of 3 elements are needed, not of sizes %s and %s', ...
        mat2str(size(a)), mat2str(size(b)));
end
r = [a(2) * b(3) - a(3) * b(2); a(3) * b(1) - a(1) * b(3); a(1) * b(2) - a(2) * b(1)];
if size(a, 1) == 1
  r = r.';
end
end
