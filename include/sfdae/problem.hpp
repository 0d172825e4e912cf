// SPDX-License-Identifier: BSD-3-Clause

// Problems for C++17 and later: user-supplied functions and their views of arrays. Included by sfdae.hpp.
#ifndef SFDAE_PROBLEM_HPP
#define SFDAE_PROBLEM_HPP

#include <sfdae/sfdae.h>
#include <sfdae/expression.hpp>
#include <sfdae/results.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace sfdae {

namespace detail {

/// True if 0 <= i < size.
constexpr bool is_index(int i, int size) noexcept { return static_cast<unsigned>(i) < static_cast<unsigned>(size); }

[[noreturn]] inline void refuse_index(const char* name, int i, int size) {
  const std::string what(name);
  throw Error(SFDAE_ILLEGAL_ARGUMENT, what + "[" + std::to_string(i) + "] does not exist: " + what + " has " +
                                          std::to_string(size) + " entries, counted from 0");
}

[[noreturn]] inline void refuse_index(const char* name, std::pair<int, int> place, std::pair<int, int> shape) {
  const std::string what(name);
  throw Error(SFDAE_ILLEGAL_ARGUMENT, what + "(" + std::to_string(place.first) + ", " + std::to_string(place.second) +
                                          ") does not exist: " + what + " is " + std::to_string(shape.first) + " x " +
                                          std::to_string(shape.second) + ", counted from 0");
}

}  // namespace detail

/// View of a matrix owned elsewhere; copies refer to the same entries. Access out of range throws an Error that names
/// the entry, which ends the call.
template <class T>
class BasicMatrixRef {
 public:
  /// name: as the Error calls it, a string that outlives the view.
  BasicMatrixRef(T* values, int rows, int columns, const char* name = "matrix") noexcept
      : values_(values), rows_(rows), columns_(columns), name_(name) {}
  T& operator()(int i, int j) const {
    if (!detail::is_index(i, rows_) || !detail::is_index(j, columns_))
      detail::refuse_index(name_, {i, j}, {rows_, columns_});
    return values_[i + std::ptrdiff_t{j} * rows_];
  }
  int rows() const noexcept { return rows_; }
  int columns() const noexcept { return columns_; }
  T* data() const noexcept { return values_; }
  /// False for one that is not there, see TotalDerivatives.
  explicit operator bool() const noexcept { return values_ != nullptr; }

 private:
  T* values_;
  int rows_, columns_;
  const char* name_;
};
using MatrixRef = BasicMatrixRef<double>;
using ConstMatrixRef = BasicMatrixRef<const double>;
using ExpressionMatrix = BasicMatrixRef<Expression>;

/// View of a vector owned elsewhere; access out of range throws an Error as for matrices.
template <class T>
class BasicVectorRef {
 public:
  /// name: as the Error calls it, a string that outlives the view.
  BasicVectorRef(T* values, int size, const char* name = "vector") noexcept
      : values_(values), size_(size), name_(name) {}
  T& operator[](int i) const {
    if (!detail::is_index(i, size_)) detail::refuse_index(name_, i, size_);
    return values_[i];
  }
  int size() const noexcept { return size_; }
  T* data() const noexcept { return values_; }
  T* begin() const noexcept { return values_; }
  T* end() const noexcept { return values_ + size_; }

 private:
  T* values_;
  int size_;
  const char* name_;
};
using VectorRef = BasicVectorRef<double>;
using ConstVectorRef = BasicVectorRef<const double>;
using Expressions = BasicVectorRef<Expression>;
using ConstExpressions = BasicVectorRef<const Expression>;

/// A user-supplied function that returns nothing, or an int as in C: 0 ok, > 0 cannot evaluate here, < 0 stop.
template <class... Arguments>
class Callback {
 public:
  Callback() = default;
  Callback(std::nullptr_t) {}

  template <class F, class = std::enable_if_t<std::is_invocable_v<F&, Arguments...>>>
  Callback(F function) {
    using Result = std::invoke_result_t<F&, Arguments...>;
    static_assert(std::is_void_v<Result> || std::is_same_v<Result, int>, "return nothing, or an int as in C");
    if constexpr (std::is_void_v<Result>) {
      function_ = [f = std::move(function)](Arguments... arguments) mutable {
        f(arguments...);
        return 0;
      };
    } else {
      function_ = std::move(function);
    }
  }

  explicit operator bool() const noexcept { return static_cast<bool>(function_); }
  int call(Arguments... arguments) const { return function_(arguments...); }

 private:
  std::function<int(Arguments...)> function_;
};

/// A user-supplied function in recorded equations, which writes all partial derivatives of an order, see
/// sfdae_external_function. It must not move, and must live as long as the solver:
///     [](int order, sfdae::ConstVectorRef arguments, sfdae::VectorRef derivatives) { ... }
/// An exception counts as "stop at once". Calling it with expressions gives an expression.
class ExternalFunction {
 public:
  using Derivatives = Callback<int, ConstVectorRef, VectorRef>;

  ExternalFunction(std::string name, int num_arguments, Derivatives derivatives)
      : name_(std::move(name)), num_arguments_(num_arguments), derivatives_(std::move(derivatives)) {}
  ExternalFunction(const ExternalFunction&) = delete;
  ExternalFunction& operator=(const ExternalFunction&) = delete;

  /// Throws Error for another number of arguments than it has.
  template <class... Arguments>
  Expression operator()(const Arguments&... arguments) const {
    const sfdae_expression list[] = {Expression(arguments).c()...};
    if (static_cast<int>(sizeof...(arguments)) != num_arguments_)
      throw Error(SFDAE_ILLEGAL_ARGUMENT, name_ + " has " + std::to_string(num_arguments_) + " arguments, not " +
                                              std::to_string(sizeof...(arguments)));
    void* const self = const_cast<ExternalFunction*>(this);
    return sfdae_external(name_.c_str(), derivatives_ ? call : nullptr, num_arguments_, list, self);
  }

 private:
  static int call(int order, const double* arguments, double* derivatives, void* user) noexcept {
    const ExternalFunction& self = *static_cast<const ExternalFunction*>(user);
    int count = 1;
    for (int i = 0; i < order; ++i) count *= self.num_arguments_;
    try {
      return self.derivatives_.call(order, {arguments, self.num_arguments_, "arguments"},
                                    {derivatives, count, "derivatives"});
    } catch (...) {
      return -1;
    }
  }

  std::string name_;
  int num_arguments_;
  Derivatives derivatives_;
};

/// Functions of time that write their derivative of the given order into a view filled with zeros, or return
/// SFDAE_ORDER_NOT_AVAILABLE:
///     [](double t, int order, sfdae::MatrixRef E) { ... }
using MatrixFunction = Callback<double, int, MatrixRef>;
using VectorFunction = Callback<double, int, VectorRef>;

/// Equations to be recorded, F(t, x, x') = 0 for all entries of F:
///     [](sfdae::Expression t, sfdae::ConstExpressions x, sfdae::ConstExpressions xdot, sfdae::Expressions F) { ... }
using EquationsFunction = Callback<const Expression&, ConstExpressions, ConstExpressions, Expressions>;

/// Linear equations to be recorded, E x' = A x + f, whose entries are zero at first:
///     [](sfdae::Expression t, sfdae::ExpressionMatrix E, sfdae::ExpressionMatrix A, sfdae::Expressions f) { ... }
using LinearEquationsFunction = Callback<const Expression&, ExpressionMatrix, ExpressionMatrix, Expressions>;

/// Total derivatives along a jet, to be written, initially zero; F_x and F_xdot convert to false if not requested.
struct TotalDerivatives {
  VectorRef F;
  MatrixRef F_x, F_xdot;
};

/// Column k of `derivatives` (n x (order + 2)) is the k-th derivative of x, see sfdae_total_derivative_function:
///     [](double t, int order, sfdae::ConstMatrixRef derivatives, sfdae::TotalDerivatives result) { ... }
using TotalDerivativeFunction = Callback<double, int, ConstMatrixRef, TotalDerivatives>;

/// Derivative array along a jet, to be written, initially zero; the Jacobian converts to false if it is not requested.
struct ArrayValues {
  VectorRef F;         ///< (order + 1) m entries
  MatrixRef jacobian;  ///< (order + 1) m x (order + 2) n
};

/// Column k of `derivatives` (n x (order + 2)) is the k-th derivative of x, see sfdae_derivative_array_function:
///     [](double t, int order, sfdae::ConstMatrixRef derivatives, sfdae::ArrayValues result) { ... }
using DerivativeArrayFunction = Callback<double, int, ConstMatrixRef, ArrayValues>;

/// Event functions, see sfdae_set_events: writes g_i(t, x, x') into a view filled with zeros,
///     [](double t, sfdae::ConstVectorRef x, sfdae::ConstVectorRef xdot, sfdae::VectorRef g) { ... }
using EventFunction = Callback<double, ConstVectorRef, ConstVectorRef, VectorRef>;

/// Conditions of callbacks that contain an `if`, see sfdae_conditions_function.
struct Conditions {
  int count = 0;
  EventFunction functions;               ///< writes g_k(t, x, x') of all conditions; condition k holds where g_k > 0
  std::vector<int>* branches = nullptr;  ///< yours, resized when a solver is created; 1 where the condition holds
};

/// Sparsity pattern in compressed sparse column format, see SFDAE_MATRICES_DENSE: n + 1 numbers and one for each entry;
/// all empty: not given.
struct SparsityPattern {
  std::vector<int> col_start, row_index;
};

/// E(t) x' = A(t) x + f(t), see sfdae_linear_problem.
struct LinearProblem {
  LinearProblem(int equations, int unknowns) : num_equations(equations), num_unknowns(unknowns) {}

  int num_equations;
  int num_unknowns;
  MatrixFunction E;
  MatrixFunction A;
  VectorFunction f;  ///< not given: f = 0
  bool constant_E = false;
  bool constant_A = false;
  std::vector<int> prescribed;              ///< indices of the components that are prescribed, u > 0 only
  VectorFunction prescribed_values;         ///< writes their values; order is 0
  std::vector<std::string> equation_names;  ///< for messages: none, or m names, "" for equations without one
  SparsityPattern E_pattern, A_pattern;     ///< both or none
  /// SFDAE_MATRICES_COMPRESSED: E and A are views of one column, the entries in the order of the pattern.
  int matrices = SFDAE_MATRICES_DENSE;
  Conditions conditions;  ///< on which E, A and f depend
};

/// F(t, x, x') = 0, see sfdae_nonlinear_problem. One of the four functions has to be given.
struct NonlinearProblem {
  NonlinearProblem(int equations_given, int unknowns) : num_equations(equations_given), num_unknowns(unknowns) {}

  int num_equations;
  int num_unknowns;
  EquationsFunction equations;                  ///< recorded when a solver is created
  LinearEquationsFunction linear_equations;     ///< recorded when a solver is created
  TotalDerivativeFunction total_derivative;     ///< called at every point
  DerivativeArrayFunction derivative_array;     ///< called at every point
  std::vector<int> prescribed;                  ///< indices of the components that are prescribed, u > 0 only
  VectorFunction prescribed_values;             ///< writes their values; order is 0
  std::vector<int> differentiations;            ///< none, or how often each equation is differentiated at most
  std::vector<std::string> equation_names;      ///< for messages: none, or m names, "" for equations without one
  SparsityPattern F_x_pattern, F_xdot_pattern;  ///< for total_derivative, derivative_array: both or none
  /// SFDAE_MATRICES_COMPRESSED (total_derivative only): F_x and F_xdot are views of one column, the entries in the
  /// order of the pattern; SFDAE_MATRICES_DIFFERENCES: Jacobians are not requested.
  int matrices = SFDAE_MATRICES_DENSE;
  Conditions conditions;  ///< on which total_derivative or derivative_array depends
};

/// Functions of a mechanical system that write into a view filled with zeros, see sfdae_multibody_problem:
///     [](double t, sfdae::ConstVectorRef q, sfdae::MatrixRef M) { ... }
///     [](double t, sfdae::ConstVectorRef q, sfdae::ConstVectorRef v, sfdae::VectorRef f) { ... }
using PositionMatrixFunction = Callback<double, ConstVectorRef, MatrixRef>;
using PositionVectorFunction = Callback<double, ConstVectorRef, VectorRef>;
using VelocityVectorFunction = Callback<double, ConstVectorRef, ConstVectorRef, VectorRef>;

/// Formulas of a recorded mechanical system, to be written; initially zero, except S, the identity if nq = nv.
struct MultibodyFormulas {
  ExpressionMatrix M;
  Expressions f, g;
  ExpressionMatrix S, H;
  Expressions h;
};

/// Formulas to be recorded:
///     [](const auto& t, auto q, auto v, auto to) { to.M(0, 0) = 1, to.f[0] = -v[0], to.g[0] = q[0] * q[1]; }
using MultibodyEquationsFunction = Callback<const Expression&, ConstExpressions, ConstExpressions, MultibodyFormulas>;

/// q' = S v, M v' = f - G^T lambda - H^T kappa, 0 = g, 0 = H v + h, see sfdae_multibody_problem. Either `equations`
/// or callbacks have to be given. The unknowns are (q, v, lambda, kappa).
struct MultibodyProblem {
  explicit MultibodyProblem(int positions, int constraints_given = 0)
      : num_positions(positions), num_velocities(positions), num_constraints(constraints_given) {}

  int num_unknowns() const { return num_positions + num_velocities + num_constraints + num_nonholonomic; }

  int num_positions;
  int num_velocities;
  int num_constraints;
  int num_nonholonomic = 0;
  MultibodyEquationsFunction equations;           ///< recorded when a solver is created
  PositionMatrixFunction mass;                    ///< mass matrix M; not given: the identity
  VelocityVectorFunction forces;                  ///< f
  PositionVectorFunction constraints;             ///< g
  PositionMatrixFunction constraint_jacobian;     ///< g_q
  PositionVectorFunction constraint_rate;         ///< g_t; not given: g does not depend on t
  PositionMatrixFunction kinematics;              ///< S; not given: the identity
  PositionMatrixFunction nonholonomic_matrix;     ///< H
  PositionVectorFunction nonholonomic_offset;     ///< h; not given: h = 0
  VelocityVectorFunction constraint_curvature;    ///< gamma; not given: finite differences
  VelocityVectorFunction nonholonomic_curvature;  ///< eta; not given: finite differences
  int coordinates = SFDAE_COORDINATES_ORTHOGONAL;
  std::vector<std::string> constraint_names;  ///< for messages: none, or one for each, holonomic constraints first
};

}  // namespace sfdae

#endif
