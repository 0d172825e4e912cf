// SPDX-License-Identifier: BSD-3-Clause

// Conversion of C++ problems, callbacks and options to those of C. Internal; included by sfdae.hpp.
#ifndef SFDAE_CALLBACKS_HPP
#define SFDAE_CALLBACKS_HPP

#include <sfdae/sfdae.h>
#include <sfdae/problem.hpp>
#include <sfdae/results.hpp>

#include <cstddef>
#include <exception>
#include <mutex>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace sfdae::detail {

/// A count as the length of a vector; the C functions check illegal counts.
inline std::size_t size(int count) noexcept { return count < 0 ? 0 : static_cast<std::size_t>(count); }

/// Throws Error unless `found` is n.
inline void require_size(std::size_t found, int n, const char* name, const char* what = "unknowns") {
  if (found == size(n)) return;
  throw Error(SFDAE_ILLEGAL_ARGUMENT, std::string(name) + " has " + std::to_string(found) + " entries, not " +
                                          std::to_string(n) + " as the problem has " + what);
}

/// The values, or null if there are none. Throws Error if there are not n of them.
template <class T>
const T* entries(const std::vector<T>& values, int n, const char* name, const char* what = "unknowns") {
  if (values.empty()) return nullptr;
  require_size(values.size(), n, name, what);
  return values.data();
}

/// The `user` object of the C callbacks: on the heap, so that its address does not change when the Solver moves.
struct CallbackState {
  template <class AnyProblem>
  CallbackState(AnyProblem p, Monitor m)
      : num_equations(p.num_equations), num_unknowns(p.num_unknowns), problem(std::move(p)), monitor(std::move(m)) {}
  CallbackState(MultibodyProblem p, Monitor m)
      : num_equations(p.num_unknowns()),
        num_unknowns(p.num_unknowns()),
        problem(std::move(p)),
        monitor(std::move(m)) {}
  ~CallbackState() { sfdae_destroy(&solver); }
  CallbackState(const CallbackState&) = delete;
  CallbackState& operator=(const CallbackState&) = delete;

  /// No exception may cross the frames of the library: it is stored here, and the value returned stops the call.
  /// Exceptions of an ensemble come from several threads.
  template <class Call>
  int guarded(Call call) noexcept {
    try {
      return call();
    } catch (...) {
      const std::lock_guard<std::mutex> lock(exception_access);
      if (!exception) exception = std::current_exception();
      return -1;
    }
  }

  /// Throws the stored exception, if any.
  void rethrow() {
    if (exception) std::rethrow_exception(std::exchange(exception, nullptr));
  }

  int num_equations, num_unknowns;
  std::variant<LinearProblem, NonlinearProblem, MultibodyProblem> problem;
  Monitor monitor;
  EventFunction event_function;
  int num_events = 0, num_sensitivities = 0;
  std::vector<const char*> names;  // while a solver is created
  std::exception_ptr exception;
  std::mutex exception_access;
  sfdae_solver* solver = nullptr;
};

/// Names of views in error messages.
constexpr const char* name_of(MatrixFunction LinearProblem::*function) {
  return function == &LinearProblem::E ? "E" : "A";
}
constexpr const char* name_of(PositionMatrixFunction MultibodyProblem::*function) {
  using P = MultibodyProblem;
  return function == &P::mass                  ? "M"
         : function == &P::constraint_jacobian ? "G"
         : function == &P::kinematics          ? "S"
                                               : "H";
}
constexpr const char* name_of(PositionVectorFunction MultibodyProblem::*function) {
  using P = MultibodyProblem;
  return function == &P::constraints ? "g" : function == &P::constraint_rate ? "g_t" : "h";
}
constexpr const char* name_of(VelocityVectorFunction MultibodyProblem::*function) {
  using P = MultibodyProblem;
  return function == &P::forces ? "f" : function == &P::constraint_curvature ? "gamma" : "eta";
}

/// A view of a matrix of m rows and n columns, or of the entries of its pattern, to be written.
inline MatrixRef view(double* values, const CallbackState& state, const SparsityPattern& pattern, int matrices,
                      const char* name) {
  if (values == nullptr) return {values, 0, state.num_unknowns, name};
  if (matrices == SFDAE_MATRICES_DENSE) return {values, state.num_equations, state.num_unknowns, name};
  return {values, static_cast<int>(pattern.row_index.size()), 1, name};
}

template <MatrixFunction LinearProblem::*function, SparsityPattern LinearProblem::*pattern>
int call_matrix(double t, int order, double* values, void* user) noexcept {
  CallbackState& state = *static_cast<CallbackState*>(user);
  return state.guarded([&] {
    const LinearProblem& problem = std::get<LinearProblem>(state.problem);
    return (problem.*function)
        .call(t, order, view(values, state, problem.*pattern, problem.matrices, name_of(function)));
  });
}

inline int call_f(double t, int order, double* values, void* user) noexcept {
  CallbackState& state = *static_cast<CallbackState*>(user);
  return state.guarded([&] {
    return std::get<LinearProblem>(state.problem).f.call(t, order, {values, state.num_equations, "f"});
  });
}

template <class AnyProblem>
int call_prescribed(double t, int order, double* values, void* user) noexcept {
  CallbackState& state = *static_cast<CallbackState*>(user);
  return state.guarded([&] {
    const AnyProblem& problem = std::get<AnyProblem>(state.problem);
    return problem.prescribed_values.call(t, order,
                                          {values, static_cast<int>(problem.prescribed.size()), "prescribed"});
  });
}

template <class AnyProblem>
int call_conditions(double t, const double* x, const double* xdot, double* g, void* user) noexcept {
  CallbackState& state = *static_cast<CallbackState*>(user);
  const int n = state.num_unknowns;
  return state.guarded([&] {
    const Conditions& conditions = std::get<AnyProblem>(state.problem).conditions;
    return conditions.functions.call(t, {x, n, "x"}, {xdot, n, "xdot"}, {g, conditions.count, "g"});
  });
}

inline void copy_back(const std::vector<Expression>& from, sfdae_expression* to) noexcept {
  for (const Expression& expression : from) *to++ = expression.c();
}

inline int call_equations(sfdae_record*, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                          sfdae_expression* residual, void* user) noexcept {
  CallbackState& state = *static_cast<CallbackState*>(user);
  return state.guarded([&] {
    const int m = state.num_equations, n = state.num_unknowns;
    const std::vector<Expression> unknowns(x, x + n), derivatives(xdot, xdot + n);
    std::vector<Expression> F(residual, residual + m);
    const int outcome =
        std::get<NonlinearProblem>(state.problem)
            .equations.call(t, {unknowns.data(), n, "x"}, {derivatives.data(), n, "xdot"}, {F.data(), m, "F"});
    copy_back(F, residual);
    return outcome;
  });
}

inline int call_linear_equations(sfdae_record*, sfdae_expression t, sfdae_expression* E, sfdae_expression* A,
                                 sfdae_expression* f, void* user) noexcept {
  CallbackState& state = *static_cast<CallbackState*>(user);
  return state.guarded([&] {
    const int m = state.num_equations, n = state.num_unknowns;
    std::vector<Expression> matrix_E(size(m) * size(n)), matrix_A(matrix_E), vector_f(size(m));
    const int outcome = std::get<NonlinearProblem>(state.problem)
                            .linear_equations.call(t, {matrix_E.data(), m, n, "E"}, {matrix_A.data(), m, n, "A"},
                                                   {vector_f.data(), m, "f"});
    copy_back(matrix_E, E);
    copy_back(matrix_A, A);
    copy_back(vector_f, f);
    return outcome;
  });
}

inline int call_total_derivative(double t, int order, const double* derivatives, double* F, double* F_x,
                                 double* F_xdot, void* user) noexcept {
  CallbackState& state = *static_cast<CallbackState*>(user);
  return state.guarded([&] {
    const int m = state.num_equations, n = state.num_unknowns;
    const NonlinearProblem& problem = std::get<NonlinearProblem>(state.problem);
    return problem.total_derivative.call(t, order, {derivatives, n, order + 2, "derivatives"},
                                         {{F, m, "F"},
                                          view(F_x, state, problem.F_x_pattern, problem.matrices, "F_x"),
                                          view(F_xdot, state, problem.F_xdot_pattern, problem.matrices, "F_xdot")});
  });
}

inline int call_derivative_array(double t, int order, const double* derivatives, double* F, double* jacobian,
                                 void* user) noexcept {
  CallbackState& state = *static_cast<CallbackState*>(user);
  return state.guarded([&] {
    const int rows = (order + 1) * state.num_equations, n = state.num_unknowns;
    const MatrixRef matrix{jacobian, jacobian == nullptr ? 0 : rows, (order + 2) * n, "jacobian"};
    return std::get<NonlinearProblem>(state.problem)
        .derivative_array.call(t, order, {derivatives, n, order + 2, "derivatives"}, {{F, rows, "F"}, matrix});
  });
}

template <PositionMatrixFunction MultibodyProblem::*function, int MultibodyProblem::*rows,
          int MultibodyProblem::*columns>
int call_position_matrix(double t, const double* q, double* values, void* user) noexcept {
  CallbackState& state = *static_cast<CallbackState*>(user);
  return state.guarded([&] {
    const MultibodyProblem& problem = std::get<MultibodyProblem>(state.problem);
    return (problem.*function)
        .call(t, {q, problem.num_positions, "q"}, {values, problem.*rows, problem.*columns, name_of(function)});
  });
}

template <PositionVectorFunction MultibodyProblem::*function, int MultibodyProblem::*rows>
int call_position_vector(double t, const double* q, double* values, void* user) noexcept {
  CallbackState& state = *static_cast<CallbackState*>(user);
  return state.guarded([&] {
    const MultibodyProblem& problem = std::get<MultibodyProblem>(state.problem);
    return (problem.*function).call(t, {q, problem.num_positions, "q"}, {values, problem.*rows, name_of(function)});
  });
}

template <VelocityVectorFunction MultibodyProblem::*function, int MultibodyProblem::*rows>
int call_velocity_vector(double t, const double* q, const double* v, double* values, void* user) noexcept {
  CallbackState& state = *static_cast<CallbackState*>(user);
  return state.guarded([&] {
    const MultibodyProblem& problem = std::get<MultibodyProblem>(state.problem);
    return (problem.*function)
        .call(t, {q, problem.num_positions, "q"}, {v, problem.num_velocities, "v"},
              {values, problem.*rows, name_of(function)});
  });
}

inline int call_multibody_equations(sfdae_record*, sfdae_expression t, const sfdae_expression* q,
                                    const sfdae_expression* v, const sfdae_multibody_formulas* to,
                                    void* user) noexcept {
  CallbackState& state = *static_cast<CallbackState*>(user);
  return state.guarded([&] {
    const MultibodyProblem& p = std::get<MultibodyProblem>(state.problem);
    const int nq = p.num_positions, nv = p.num_velocities, nl = p.num_constraints, nk = p.num_nonholonomic;
    const std::vector<Expression> positions(q, q + nq), velocities(v, v + nv);
    std::vector<Expression> M(to->M, to->M + nv * nv), f(to->f, to->f + nv), g(to->g, to->g + nl),
        S(to->S, to->S + nq * nv), H(to->H, to->H + nk * nv), h(to->h, to->h + nk);
    const MultibodyFormulas formulas{{M.data(), nv, nv, "M"}, {f.data(), nv, "f"},     {g.data(), nl, "g"},
                                     {S.data(), nq, nv, "S"}, {H.data(), nk, nv, "H"}, {h.data(), nk, "h"}};
    const int outcome = p.equations.call(t, {positions.data(), nq, "q"}, {velocities.data(), nv, "v"}, formulas);
    copy_back(M, to->M), copy_back(f, to->f), copy_back(g, to->g);
    copy_back(S, to->S), copy_back(H, to->H), copy_back(h, to->h);
    return outcome;
  });
}

inline int call_monitor(const sfdae_progress* progress, void* user) noexcept {
  CallbackState& state = *static_cast<CallbackState*>(user);
  return state.guarded([&] { return state.monitor(*progress) ? 1 : 0; });
}

inline int call_events(double t, const double* x, const double* xdot, double* g, void* user) noexcept {
  CallbackState& state = *static_cast<CallbackState*>(user);
  const int n = state.num_unknowns;
  return state.guarded([&] {
    return state.event_function.call(t, {x, n, "x"}, {xdot, n, "xdot"}, {g, state.num_events, "g"});
  });
}

template <class AnyProblem, class AnyCProblem>
void fill_prescribed(const AnyProblem& problem, AnyCProblem& c) {
  c.num_prescribed = static_cast<int>(problem.prescribed.size());
  c.prescribed = problem.prescribed.empty() ? nullptr : problem.prescribed.data();
  c.prescribed_values = problem.prescribed_values ? call_prescribed<AnyProblem> : nullptr;
}

template <class AnyProblem, class AnyCProblem>
void fill_conditions(const AnyProblem& problem, AnyCProblem& c) {
  const Conditions& conditions = problem.conditions;
  c.num_conditions = conditions.count;
  c.conditions = conditions.functions ? call_conditions<AnyProblem> : nullptr;
  if (conditions.branches == nullptr || conditions.count <= 0) return;
  conditions.branches->resize(size(conditions.count));
  c.branches = conditions.branches->data();
}

/// Names as a C array, which C copies; the state owns the array. Throws Error unless there are n, or none.
inline const char* const* names_in_c(const std::vector<std::string>& given, int n, const char* name, const char* what,
                                     CallbackState& state) {
  state.names.clear();
  for (const std::string& one : given) state.names.push_back(one.c_str());
  return entries(state.names, n, name, what);
}

/// Passes a pattern to C. Throws Error unless col_start has n + 1 numbers, or nothing is given.
inline void fill_pattern(const SparsityPattern& pattern, int n, const char* name, int& count, const int*& col_start,
                         const int*& row_index) {
  if (pattern.col_start.empty() && pattern.row_index.empty()) return;
  require_size(pattern.col_start.size(), n + 1, name, "unknowns, and one more");
  count = static_cast<int>(pattern.row_index.size());
  col_start = pattern.col_start.data();
  row_index = pattern.row_index.data();
}

inline sfdae_linear_problem in_c(const LinearProblem& problem, CallbackState* user) {
  sfdae_linear_problem c;
  sfdae_linear_problem_init(&c, sizeof c);
  c.num_equations = problem.num_equations;
  c.num_unknowns = problem.num_unknowns;
  c.E = problem.E ? call_matrix<&LinearProblem::E, &LinearProblem::E_pattern> : nullptr;
  c.A = problem.A ? call_matrix<&LinearProblem::A, &LinearProblem::A_pattern> : nullptr;
  c.f = problem.f ? call_f : nullptr;
  c.constant_E = problem.constant_E ? 1 : 0;
  c.constant_A = problem.constant_A ? 1 : 0;
  fill_prescribed(problem, c);
  c.equation_names = names_in_c(problem.equation_names, problem.num_equations, "equation_names", "equations", *user);
  fill_pattern(problem.E_pattern, c.num_unknowns, "E_pattern.col_start", c.E_entries, c.E_col_start, c.E_row_index);
  fill_pattern(problem.A_pattern, c.num_unknowns, "A_pattern.col_start", c.A_entries, c.A_col_start, c.A_row_index);
  c.matrices = problem.matrices;
  fill_conditions(problem, c);
  c.user = user;
  return c;
}

inline sfdae_nonlinear_problem in_c(const NonlinearProblem& problem, CallbackState* user) {
  sfdae_nonlinear_problem c;
  sfdae_nonlinear_problem_init(&c, sizeof c);
  c.num_equations = problem.num_equations;
  c.num_unknowns = problem.num_unknowns;
  c.equations = problem.equations ? call_equations : nullptr;
  c.linear_equations = problem.linear_equations ? call_linear_equations : nullptr;
  c.total_derivative = problem.total_derivative ? call_total_derivative : nullptr;
  c.derivative_array = problem.derivative_array ? call_derivative_array : nullptr;
  fill_prescribed(problem, c);
  c.equation_names = names_in_c(problem.equation_names, problem.num_equations, "equation_names", "equations", *user);
  c.differentiations = entries(problem.differentiations, problem.num_equations, "differentiations", "equations");
  fill_pattern(problem.F_x_pattern, c.num_unknowns, "F_x_pattern.col_start", c.F_x_entries, c.F_x_col_start,
               c.F_x_row_index);
  fill_pattern(problem.F_xdot_pattern, c.num_unknowns, "F_xdot_pattern.col_start", c.F_xdot_entries,
               c.F_xdot_col_start, c.F_xdot_row_index);
  c.matrices = problem.matrices;
  fill_conditions(problem, c);
  c.user = user;
  return c;
}

inline sfdae_multibody_problem in_c(const MultibodyProblem& problem, CallbackState* user) {
  using P = MultibodyProblem;
  constexpr auto nq = &P::num_positions, nv = &P::num_velocities, nl = &P::num_constraints, nk = &P::num_nonholonomic;
  sfdae_multibody_problem c;
  sfdae_multibody_problem_init(&c, sizeof c);
  c.num_positions = problem.num_positions;
  c.num_velocities = problem.num_velocities;
  c.num_constraints = problem.num_constraints;
  c.num_nonholonomic = problem.num_nonholonomic;
  c.equations = problem.equations ? call_multibody_equations : nullptr;
  c.mass = problem.mass ? call_position_matrix<&P::mass, nv, nv> : nullptr;
  c.forces = problem.forces ? call_velocity_vector<&P::forces, nv> : nullptr;
  c.constraints = problem.constraints ? call_position_vector<&P::constraints, nl> : nullptr;
  c.constraint_jacobian =
      problem.constraint_jacobian ? call_position_matrix<&P::constraint_jacobian, nl, nq> : nullptr;
  c.constraint_rate = problem.constraint_rate ? call_position_vector<&P::constraint_rate, nl> : nullptr;
  c.kinematics = problem.kinematics ? call_position_matrix<&P::kinematics, nq, nv> : nullptr;
  c.nonholonomic_matrix =
      problem.nonholonomic_matrix ? call_position_matrix<&P::nonholonomic_matrix, nk, nv> : nullptr;
  c.nonholonomic_offset = problem.nonholonomic_offset ? call_position_vector<&P::nonholonomic_offset, nk> : nullptr;
  c.constraint_curvature =
      problem.constraint_curvature ? call_velocity_vector<&P::constraint_curvature, nl> : nullptr;
  c.nonholonomic_curvature =
      problem.nonholonomic_curvature ? call_velocity_vector<&P::nonholonomic_curvature, nk> : nullptr;
  c.coordinates = problem.coordinates;
  c.constraint_names = names_in_c(problem.constraint_names, problem.num_constraints + problem.num_nonholonomic,
                                  "constraint_names", "constraints", *user);
  c.user = user;
  return c;
}

/// The vectors of the result are those of `options`.
inline sfdae_options in_c(const Options& options, int n, CallbackState* user) {
  sfdae_options c = options;
  c.rtol_vector = entries(options.rtol_vector, n, "rtol_vector");
  c.atol_vector = entries(options.atol_vector, n, "atol_vector");
  c.fixed = entries(options.fixed, n, "fixed");
  c.initial_weights = entries(options.initial_weights, n, "initial_weights");
  c.monitor = options.monitor ? call_monitor : nullptr;
  c.monitor_user = user;
  return c;
}

}  // namespace sfdae::detail

#endif
