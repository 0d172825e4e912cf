% SPDX-License-Identifier: BSD-3-Clause
function r = subsindex(a)
% An expression cannot be an index.
unsupported('an index that depends on unknowns', 'write interp1 or sfdae_table for tables, ifelse for choices');
r = [];
end
