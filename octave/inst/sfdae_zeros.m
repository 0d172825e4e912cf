% SPDX-License-Identifier: BSD-3-Clause
function r = sfdae_zeros(varargin)
% sfdae_zeros  Zeros to which expressions can be assigned.
%
%   r = sfdae_zeros(m)       m x m (as zeros)
%   r = sfdae_zeros(m, n)    m x n
%
% Within equations that are being recorded, r(i) = x(1) needs an r that can hold expressions: begin with sfdae_zeros in
% place of zeros. Everywhere else sfdae_zeros returns zeros, so the same function works with record = false.
%
% Example:
%   function r = chain(t, x, xdot)
%     r = sfdae_zeros(numel(x), 1);
%     for k = 1:numel(x)
%       r(k) = xdot(k) + k * x(k);
%     end
%   end
%   [T, X] = sfdae_solve(@chain, [0 1], ones(5, 1));
%
% See also: sfdae_solve, sfdae_expression
r = zeros(varargin{:});
if sfdae_mex('depth') > 0
  r = sfdae_expression(sfdae_mex('nodes', r));
end
end
