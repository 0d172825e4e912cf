% SPDX-License-Identifier: BSD-3-Clause
function result = takes_parameters(fn, count, parameters)
% True if a function has an argument p after `count` others. A function of any number of arguments gets p if there are
% parameters.
try
  number = nargin(fn);
catch
  number = count;
end
result = number == count + 1 || (number < 0 && ~isempty(fieldnames(parameters)));
if result && number > 0 && isempty(fieldnames(parameters))
  error('sfdae:illegal_argument', ['a function has %d arguments, so the last one gets the parameters; give them ' ...
        'with the option parameters'], number);
end
end
