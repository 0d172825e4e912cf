% SPDX-License-Identifier: BSD-3-Clause
function ids = sfdae_nodes(a)
% Numbers of the nodes of an expression, for the functions of the package.
ids = a.id;
end
