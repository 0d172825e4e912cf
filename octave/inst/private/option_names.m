% SPDX-License-Identifier: BSD-3-Clause
function [names, kinds, choices] = option_names()
% Names of all options: those of the library, with their kinds and choices, then those of this package.
persistent list
if isempty(list)
  list = sfdae_mex('options');
  list = list(~ismember(list(:, 1), {'rtol_vector', 'atol_vector', 'xdot_is_guess', 'use_stop_time', 'stop_time'}), :);
end
own = {'breakpoints', 'breakpoint_kinds', 'dense', 'monitor', 'xdot0', 'parameters', 'record', 'jacobian', ...
       'pattern_x', 'pattern_xdot', 'equation_names', 'prescribed', 'prescribed_values', 'differentiations', ...
       'events', 'event_action', 'sensitivities', 'toward', 'xdot', 'inputs', 'outputs', 'input_columns', 'output_rows'};
names = [list(:, 1).', own];
kinds = list(:, 2).';
choices = list(:, 3).';
end
