% SPDX-License-Identifier: BSD-3-Clause
function [values, errors] = roots_of(caller, system, what)
% Poles or zeros of a descriptor system.
result = sfdae_mex('descriptor', checked_system(caller, system), struct('what', what));
if result.status < 0
  error(identifier_of(result.status_name), '%s: %s', caller, result.message);
end
values = complex(result.real, result.imaginary);
if all(result.imaginary == 0)
  values = result.real;
end
errors = result.errors;
end
