% SPDX-License-Identifier: BSD-3-Clause
function [flag, varargout] = sfdae_call_(fn, varargin)
% sfdae_call_  Calls a function for sfdae_mex, which calls this function.
%
% flag is 0, 1 if the function asks for a smaller step by an error with the identifier sfdae:retry, or -1 after any
% other error, which is stored. Results become full matrices of class double.
%
% Example:
%   [flag, y] = sfdae_call_(@(t) 2 * t, 3);
varargout = cell(1, nargout - 1);
try
  [varargout{:}] = fn(varargin{:});
  for k = 1:numel(varargout)
    value = varargout{k};
    if ~isa(value, 'double') || issparse(value) || ~isreal(value)
      varargout{k} = numbers_of(value);
    end
  end
  flag = 0;
catch err
  flag = -1;
  if strcmp(err.identifier, 'sfdae:retry')
    flag = 1;
  else
    sfdae_callback_error_(err);
  end
end
end

function value = numbers_of(value)
if isa(value, 'sfdae_expression') || ~(isnumeric(value) || islogical(value))
  error('sfdae:illegal_argument', 'a function returned a value of class %s; it has to return numbers', class(value));
end
if ~isreal(value) && all(imag(value(:)) == 0)
  value = real(value);
end
if ~isreal(value)
  error('sfdae:illegal_argument', ['a function returned complex values, as sqrt and log do for negative numbers; ' ...
        'equations have to be real, or raise an error with the identifier sfdae:retry there']);
end
value = full(double(value));
end
