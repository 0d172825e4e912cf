% SPDX-License-Identifier: BSD-3-Clause
function r = isrow(a)
% True for a row.
r = isrow(a.id);
end
