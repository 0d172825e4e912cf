% SPDX-License-Identifier: BSD-3-Clause
function r = numel(a, varargin)
% Number of elements.
if isempty(varargin)
  r = numel(a.id);
else
  r = 1;
end
end
