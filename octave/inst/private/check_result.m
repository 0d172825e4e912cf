% SPDX-License-Identifier: BSD-3-Clause
function check_result(result, must_succeed)
% Raises the error of a function that the library called, or, if the call must succeed, that of the library.
err = sfdae_callback_error_();
if result.has_exception && ~isempty(err)
  rethrow(err);
end
if must_succeed && (result.status < 0 || strcmp(result.status_name, 'SFDAE_STOPPED'))
  error(identifier_of(result.status_name), '%s', result.message);
end
end
