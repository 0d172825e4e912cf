% SPDX-License-Identifier: BSD-3-Clause
function r = circshift(a, varargin)
% The elements shifted in a circle.
a.id = circshift(a.id, varargin{:});
r = a;
end
