% SPDX-License-Identifier: BSD-3-Clause
function [problem, system] = sfdae_from_dss(sys, u)
% sfdae_from_dss  The linear problem E x' = A x + B u(t) of a system of the package control.
%
%   problem = sfdae_from_dss(sys)
%   problem = sfdae_from_dss(sys, u)
%   [problem, system] = sfdae_from_dss(sys, u)
%
% sys: a continuous system of dss or ss. u: function u(t) that returns the inputs; without u they are 0. problem is for
% sfdae_solve, and system = struct with E, A, B, C, D for sfdae_poles and sfdae_transfer. Needs the package control.
%
% Example (needs the package control):
%   problem = sfdae_from_dss(dss(-2, 1, 1, 0, 1), @(t) sin(t));
%   [T, X] = sfdae_solve(problem, [0 1], 0);
%
% See also: sfdae_to_dss, sfdae_linear
if nargin < 1 || isempty(which('dss'))
  error('sfdae:package_missing', ['sfdae_from_dss needs a system and the functions of the package control: pkg ' ...
        'install -forge control (Debian: octave-control), then pkg load control']);
end
if nargin < 2
  u = [];
end
[A, B, C, D, E] = dssdata(sys);
if isempty(E)
  E = eye(size(A));
end
system = struct('E', E, 'A', A, 'B', B, 'C', C, 'D', D);
if isempty(u)
  problem = sfdae_linear(E, A);
elseif is_function_handle(u)
  problem = sfdae_linear(E, A, @(t) B * u(t));
else
  error('sfdae:illegal_argument', 'sfdae_from_dss: u has to be a function handle u(t), not of class %s', class(u));
end
end
