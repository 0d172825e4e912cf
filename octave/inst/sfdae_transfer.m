% SPDX-License-Identifier: BSD-3-Clause
function H = sfdae_transfer(system, s)
% sfdae_transfer  Transfer function H(s) = C (s E - A)^-1 B + D of a descriptor system.
%
%   H = sfdae_transfer(system, s)
%
% system: struct with E, A, B, C, D, from sfdae_linearize or by hand. s: complex numbers, 1i * omega for a frequency
% response. H is p x q x numel(s), or has the shape of s if there is one input and one output.
%
% Example:
%   system = struct('E', 1, 'A', -2, 'B', 1, 'C', 1, 'D', 0);
%   sfdae_transfer(system, [0 2i])     % 0.5, 0.25 - 0.25i
%
% See also: sfdae_linearize, sfdae_poles, sfdae_invariant_zeros
if nargin ~= 2
  error('sfdae:illegal_argument', 'sfdae_transfer needs a system and numbers s');
end
if ~isnumeric(s) || any(~isfinite(s(:)))
  error('sfdae:illegal_argument', 'sfdae_transfer: s has to be finite numbers');
end
system = checked_system('sfdae_transfer', system);
shape = size(s);
s = full(double(s(:)));
result = sfdae_mex('descriptor', system, struct('what', 'transfer', 'real', real(s), 'imaginary', imag(s)));
if result.status < 0
  error(identifier_of(result.status_name), 'sfdae_transfer: %s', result.message);
end
H = reshape(complex(result.real, result.imaginary), size(system.C, 1), size(system.B, 2), []);
if size(H, 1) == 1 && size(H, 2) == 1
  H = reshape(H, shape);
end
end
