% SPDX-License-Identifier: BSD-3-Clause
function [poles, errors] = sfdae_poles(system)
% sfdae_poles  Poles of a descriptor system of any index: the finite eigenvalues of lambda E - A.
%
%   poles = sfdae_poles(system)
%   [poles, errors] = sfdae_poles(system)
%
% system: struct with E and A, from sfdae_linearize or by hand. errors: estimates of the absolute errors that rounding
% errors of the entries cause.
%
% Example:
%   sfdae_poles(struct('E', [1 0; 0 0], 'A', [-2 1; 1 -1]))     % -1
%
% See also: sfdae_linearize, sfdae_invariant_zeros, sfdae_transfer
[poles, errors] = roots_of('sfdae_poles', system, 'poles');
end
