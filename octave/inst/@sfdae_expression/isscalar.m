% SPDX-License-Identifier: BSD-3-Clause
function r = isscalar(a)
% True for one element.
r = isscalar(a.id);
end
