% SPDX-License-Identifier: BSD-3-Clause
function [values, errors] = sfdae_invariant_zeros(system)
% sfdae_invariant_zeros  Invariant zeros of a descriptor system of any index.
%
%   values = sfdae_invariant_zeros(system)
%   [values, errors] = sfdae_invariant_zeros(system)
%
% The finite eigenvalues of the pencil [s E - A, -B; C, D]. system: struct with E, A, B, C and D, from sfdae_linearize
% or by hand. errors: estimates of the absolute errors that rounding errors of the entries cause.
%
% Example (the transfer function is (s + 3) / ((s + 1) (s + 2))):
%   system = struct('E', eye(2), 'A', [-1 0; 0 -2], 'B', [1; 1], 'C', [2 -1], 'D', 0);
%   sfdae_invariant_zeros(system)     % -3
%
% See also: sfdae_linearize, sfdae_poles, sfdae_transfer
[values, errors] = roots_of('sfdae_invariant_zeros', system, 'zeros');
end
