// Published measurements of GELDA 1.1.1 on the families kron (w = 0.5) and chain, one core.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace sfdae_bench {

inline constexpr double not_published = NAN;

// Milliseconds of CPU time per step; with OpenBLAS 0.3.21 from n = 16 on, reference BLAS below and for the chain.
struct PublishedCost {
  int n, mu;
  double bdf, radau;
};
inline constexpr PublishedCost published_kron_cost[] = {
    {4, 0, .0057, .019}, {4, 1, .016, .050},   {4, 2, .032, .11},     {4, 3, .060, .20},     {8, 0, .013, .044},
    {8, 1, .050, .16},   {8, 2, .12, .38},     {8, 3, .25, .75},      {16, 0, .039, .12},    {16, 1, .18, .56},
    {16, 2, .46, 1.4},   {16, 3, 1.05, 3.3},   {32, 0, .12, .40},     {32, 1, .78, 2.4},     {32, 2, 2.3, 7.3},
    {32, 3, 7.6, 23.0},  {64, 0, .53, 1.9},    {64, 1, 5.3, 16.0},    {64, 2, 16.0, 48.0},   {64, 3, 81.0, 250.0},
    {100, 0, 1.25, 4.7}, {100, 1, 11.0, 36.0}, {100, 2, 45.0, 150.0}, {100, 3, 120.0, 410.0}};
inline constexpr PublishedCost published_chain_cost = {22, 2, 1.1, 3.5};

// Steps on kron(32, 2), t in [0, 1], rtol = atol = tol, and the error in units of the tolerance. Failed attempts were
// not published and count as none.
struct PublishedRun {
  double tol;
  int steps;
  double error;
};
inline constexpr PublishedRun published_bdf_runs[] = {
    {1e-3, 19, 3.0}, {1e-5, 42, 6.0}, {1e-7, 66, 6.0}, {1e-9, 106, 12.0}};
inline constexpr PublishedRun published_radau_runs[] = {
    {1e-3, 7, 0.09}, {1e-5, 15, not_published}, {1e-7, 36, not_published}, {1e-9, 99, 0.002}};

}  // namespace sfdae_bench
