% SPDX-License-Identifier: BSD-3-Clause
function r = sfdae_derivative(a, variable)
% Partial derivatives of formulas: see help sfdae_derivative.
r = applied('derivative', a, variable);
end
