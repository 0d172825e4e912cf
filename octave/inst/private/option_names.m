% SPDX-License-Identifier: BSD-3-Clause
function [names, kinds, choices] = option_names()
% Names of all options: those of the library, with their kinds and choices, then those of this package.
persistent all kinds_of_library choices_of_library
if isempty(all)
  list = sfdae_mex('options');
  list = list(~ismember(list(:, 1), {'rtol_vector', 'atol_vector', 'xdot_is_guess', 'use_stop_time', 'stop_time'}), :);
  all = [list(:, 1).', {'breakpoints', 'breakpoint_kinds', 'dense', 'monitor', 'xdot0', 'parameters', 'record', ...
         'jacobian', 'pattern_x', 'pattern_xdot', 'equation_names', 'prescribed', 'prescribed_values', ...
         'differentiations', 'events', 'event_action', 'sensitivities', 'toward', 'xdot', 'inputs', 'outputs', ...
         'input_columns', 'output_rows'}];
  kinds_of_library = list(:, 2).';
  choices_of_library = list(:, 3).';
end
names = all;
kinds = kinds_of_library;
choices = choices_of_library;
end
