% SPDX-License-Identifier: BSD-3-Clause
function need_time(caller, t)
% An error unless t is a finite real number.
if ~(isnumeric(t) && isreal(t) && isscalar(t) && isfinite(t))
  error('sfdae:illegal_argument', '%s: t has to be a finite real number', caller);
end
end
