% SPDX-License-Identifier: BSD-3-Clause
function id = identifier_of(status_name)
% The identifier of errors and warnings: sfdae:rank_unclear for SFDAE_RANK_UNCLEAR.
id = ['sfdae:' strrep(lower(status_name), 'sfdae_', '')];
end
