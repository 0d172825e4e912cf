// SPDX-License-Identifier: BSD-3-Clause

// Input and results of a solver, for C++17 and later: options, points, results, errors. Included by sfdae.hpp.
#ifndef SFDAE_RESULTS_HPP
#define SFDAE_RESULTS_HPP

#include <sfdae/branches.h>
#include <sfdae/sfdae.h>

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace sfdae {

using Characteristics = sfdae_characteristics;
using Decision = sfdae_decision;
using Change = sfdae_change;
using SingularPoint = sfdae_singular_point;

/// A switch of recorded equations, see sfdae_switch.
struct Switch {
  double t, before, after;
  bool jumps;
  std::string condition;
};
using InitialReport = sfdae_initial_report;
using Statistics = sfdae_statistics;
using DerivativeCheck = sfdae_derivative_check;
using MultibodyReport = sfdae_multibody_report;
using Progress = sfdae_progress;

/// The structure of recorded equations (sfdae_get_structure): n entries in each vector.
struct Structure {
  sfdae_structure summary;
  std::vector<int> differentiations, orders, assigned, block;
  std::string words;  ///< description of a disagreement, "" if there is none
};

/// Version of the library that is running.
inline const char* version() noexcept { return sfdae_version(); }

/// Name of a status, for example "SFDAE_STEP_TOO_SMALL".
inline const char* status_name(int status) noexcept { return sfdae_status_name(status); }

/// A failure of the library: status() < 0, what() tells what happened, where and what to do.
class Error : public std::runtime_error {
 public:
  Error(int status, const std::string& message)
      : std::runtime_error(message.empty() ? sfdae_status_name(status) : message), status_(status) {}
  int status() const noexcept { return status_; }

 private:
  int status_;
};

/// Matrix that owns its entries.
class Matrix {
 public:
  Matrix() = default;
  Matrix(int rows, int columns)
      : rows_(rows), columns_(columns), values_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns)) {}
  double& operator()(int i, int j) noexcept { return values_[index(i, j)]; }
  double operator()(int i, int j) const noexcept { return values_[index(i, j)]; }
  int rows() const noexcept { return rows_; }
  int columns() const noexcept { return columns_; }
  double* data() noexcept { return values_.data(); }
  const double* data() const noexcept { return values_.data(); }

 private:
  std::size_t index(int i, int j) const noexcept {
    return static_cast<std::size_t>(i) + static_cast<std::size_t>(j) * static_cast<std::size_t>(rows_);
  }
  int rows_ = 0, columns_ = 0;
  std::vector<double> values_;
};

/// Called after every accepted step; true stops the call with SFDAE_STOPPED.
using Monitor = std::function<bool(const Progress&)>;

/// sfdae_options with its defaults. The members declared here replace those of the same name in C.
struct Options : sfdae_options {
  Options() : sfdae_options() { sfdae_options_init(this, sizeof(sfdae_options)); }

  std::vector<double> rtol_vector;      ///< empty, or n values
  std::vector<double> atol_vector;      ///< empty, or n values
  std::vector<int> fixed;               ///< empty, or n flags
  std::vector<double> initial_weights;  ///< empty, or n values
  Monitor monitor;
};

/// A point of the solution.
struct Point {
  double t = 0;
  std::vector<double> x;     ///< n values
  std::vector<double> xdot;  ///< x'(t), resized to n by the solver
};

/// M y = N x + g, or M dy = N dx + g along a jet; see sfdae_get_derivative_array.
struct DerivativeArray {
  Matrix M, N;
  std::vector<double> g;
};

/// See sfdae_get_projectors. Z2 and Z3 of multibody systems given by callbacks are empty.
struct Projectors {
  Matrix Z1, Z2, Z3, T2;
};

/// E1 x' = A1 x + f1, 0 = A2 x + f2, or those of changes; see sfdae_get_strangeness_free.
struct StrangenessFreeSystem {
  Matrix E1, A1;
  std::vector<double> f1;
  Matrix A2;
  std::vector<double> f2;
  double residual = 0;  ///< contradiction of redundant equations
};

/// E X' = A X + f for changes of X = (x, wq, wv), see sfdae_get_extended_system.
struct ExtendedSystem {
  Matrix Qq, Qv;
  Matrix E, A;
  std::vector<double> f, w;
};

/// Values before and after equations or data change at t, and the impulses there: x = impulses(:, 0) delta(t) +
/// impulses(:, 1) delta'(t) + ..., n rows.
struct Jump {
  double t = 0;
  std::vector<double> before, after;
  Matrix impulses;
};

}  // namespace sfdae

#endif
