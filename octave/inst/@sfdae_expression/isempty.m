% SPDX-License-Identifier: BSD-3-Clause
function r = isempty(a)
% True if there are no elements.
r = isempty(a.id);
end
