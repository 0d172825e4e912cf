% SPDX-License-Identifier: BSD-3-Clause
function r = logical(a)
% Octave asks for it in if, while, && and ||, which need a number.
unsupported('a condition on an expression (if, while, && or ||)', ...
            'write ifelse(condition, value, other_value), and & or | in place of && or ||');
r = [];
end
