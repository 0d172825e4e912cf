% SPDX-License-Identifier: BSD-3-Clause
function varargout = sort(varargin)
% Sorting needs values.
unsupported('sort', 'use min and max of the elements');
varargout = {};
end
