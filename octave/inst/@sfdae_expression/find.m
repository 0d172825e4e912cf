% SPDX-License-Identifier: BSD-3-Clause
function varargout = find(varargin)
% find needs values.
unsupported('find', 'use ifelse for choices');
varargout = {};
end
