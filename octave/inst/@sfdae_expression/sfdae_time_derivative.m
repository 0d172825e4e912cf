% SPDX-License-Identifier: BSD-3-Clause
function r = sfdae_time_derivative(a)
% Total time derivatives of formulas: see help sfdae_time_derivative.
r = applied('time_derivative', a);
end
