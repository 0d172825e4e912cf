% SPDX-License-Identifier: BSD-3-Clause
function ids = sfdae_nodes(a)
% sfdae_nodes  Values of equations as sfdae_mex takes them; the package calls this function.
%
% Example:
%   sfdae_nodes([1 2 3])
ids = full(double(a));
end
