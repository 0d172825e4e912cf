% SPDX-License-Identifier: BSD-3-Clause
function err = sfdae_callback_error_(new)
% sfdae_callback_error_  The error that a function called by the library has raised; the package uses it.
%
% With an argument the error is stored; without one it is returned and forgotten, [] if there is none.
%
% Example:
%   err = sfdae_callback_error_();
persistent stored
if nargin > 0
  stored = new;
  err = new;
else
  err = stored;
  stored = [];
end
end
