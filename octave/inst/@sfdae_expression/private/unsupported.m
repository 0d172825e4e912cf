% SPDX-License-Identifier: BSD-3-Clause
function unsupported(what, instead)
% Raises the error for something that formulas cannot express.
error('sfdae:not_recordable', ['%s cannot be recorded: %s. The option record = false calls the function with ' ...
      'numbers instead (differentiation index 0 or 1).'], what, instead);
end
