% SPDX-License-Identifier: BSD-3-Clause
function sys = sfdae_to_dss(system)
% sfdae_to_dss  A descriptor system as a system of the package control.
%
%   sys = sfdae_to_dss(system)
%
% system: struct with E, A, B, C, D, from sfdae_linearize, with as many equations as unknowns. Needs the package control
% (Octave: pkg load control) or the Control System Toolbox.
%
% Example (needs the package control):
%   sys = sfdae_to_dss(struct('E', 1, 'A', -2, 'B', 1, 'C', 1, 'D', 0));
%
% See also: sfdae_from_dss, sfdae_linearize
system = checked_system('sfdae_to_dss', system);
if isempty(which('dss'))
  error('sfdae:package_missing', ['sfdae_to_dss needs the function dss of the package control: pkg install -forge ' ...
        'control (Debian: octave-control), then pkg load control']);
end
if size(system.E, 1) ~= size(system.E, 2)
  error('sfdae:illegal_argument', 'sfdae_to_dss: %d equations and %d unknowns; systems of the package are square', ...
        size(system.E, 1), size(system.E, 2));
end
sys = dss(system.A, system.B, system.C, system.D, system.E);
end
