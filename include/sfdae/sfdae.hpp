// SPDX-License-Identifier: BSD-3-Clause
//
// sfdae for C++17 and later: a header-only wrapper of sfdae.h, which has the meaning of everything here.
//
//  - Failures are thrown as sfdae::Error, remarks (> 0) and SFDAE_OK are returned.
//  - An exception thrown in a callback or in the monitor stops the call and leaves it unchanged.
//  - Results are the structs of sfdae.h, already initialised; matrices are column-major, indices count from 0.
//
//     sfdae::LinearProblem problem(2, 2);
//     problem.E = [](double t, int order, sfdae::MatrixRef E) { if (order == 0) E(1, 0) = 1, E(1, 1) = -t; ... };
//     problem.A = ...;
//     sfdae::Solver solver(problem);
//     sfdae::Point point{0.0, {1.0, 1.0}, {}};
//     solver.start(point, 10.0);
//     solver.advance(10.0, point);
//
// Nonlinear problems are written once, as formulas:
//
//     sfdae::NonlinearProblem problem(2, 2);
//     problem.equations = [](const auto&, auto x, auto xdot, auto F) { F[0] = xdot[0] + x[1], F[1] = x[0] * x[1] - 1; };
//
// and mechanical systems with constraints as sfdae::MultibodyProblem.
#ifndef SFDAE_SFDAE_HPP
#define SFDAE_SFDAE_HPP

#include <sfdae/sfdae.h>
#include <sfdae/problem.hpp>

#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace sfdae {

using Characteristics = sfdae_characteristics;
using Decision = sfdae_decision;
using Change = sfdae_change;
using InitialReport = sfdae_initial_report;
using Statistics = sfdae_statistics;
using DerivativeCheck = sfdae_derivative_check;
using MultibodyReport = sfdae_multibody_report;
using Progress = sfdae_progress;

/// Version of the library that is running.
inline const char* version() noexcept { return sfdae_version(); }

/// Name of a status, for example "SFDAE_STEP_TOO_SMALL".
inline const char* status_name(int status) noexcept { return sfdae_status_name(status); }

/// A failure of the library: status() < 0, what() says what, where and what to do next.
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

/// M y = N x + g, see sfdae_get_derivative_array.
struct DerivativeArray {
  Matrix M, N;
  std::vector<double> g;
};

/// See sfdae_get_projectors.
struct Projectors {
  Matrix Z1, Z2, Z3, T2;
};

/// E1 x' = A1 x + f1, 0 = A2 x + f2, see sfdae_get_strangeness_free.
struct StrangenessFreeSystem {
  Matrix E1, A1;
  std::vector<double> f1;
  Matrix A2;
  std::vector<double> f2;
  double residual = 0;  ///< contradiction of redundant equations
};

/// Owns an sfdae_solver and the callbacks. Movable; a solver moved from can only be assigned to or destroyed.
/// It must not be moved, assigned to or destroyed from within its own callbacks.
class Solver {
 public:
  /// Copies what is given. Throws Error if it makes no sense.
  explicit Solver(LinearProblem problem, const Options& options = {})
      : state_(std::make_unique<State>(std::move(problem), options.monitor)) {
    create(sfdae_create_linear, sfdae_check_linear, std::get<LinearProblem>(state_->problem), options);
  }

  /// Records the equations, if the problem has some. Exceptions of the function that writes them are passed on.
  explicit Solver(NonlinearProblem problem, const Options& options = {})
      : state_(std::make_unique<State>(std::move(problem), options.monitor)) {
    create(sfdae_create_nonlinear, sfdae_check_nonlinear, std::get<NonlinearProblem>(state_->problem), options);
  }

  /// Likewise. The unknowns are (q, v, lambda, kappa).
  explicit Solver(MultibodyProblem problem, const Options& options = {})
      : state_(std::make_unique<State>(std::move(problem), options.monitor)) {
    create(sfdae_create_multibody, sfdae_check_multibody, std::get<MultibodyProblem>(state_->problem), options);
  }

  /// What is wrong with a problem and its options, in words; "" if nothing is.
  static std::string check(const LinearProblem& problem, const Options& options = {}) {
    State state(problem, options.monitor);
    return complaint(sfdae_check_linear, in_c(problem, &state), in_c(options, problem.num_unknowns, &state), state);
  }
  static std::string check(const NonlinearProblem& problem, const Options& options = {}) {
    State state(problem, options.monitor);
    return complaint(sfdae_check_nonlinear, in_c(problem, &state), in_c(options, problem.num_unknowns, &state),
                     state);
  }
  static std::string check(const MultibodyProblem& problem, const Options& options = {}) {
    State state(problem, options.monitor);
    return complaint(sfdae_check_multibody, in_c(problem, &state), in_c(options, problem.num_unknowns(), &state),
                     state);
  }

  /// Replaces the options, the monitor included; the point reached stays. See sfdae_set_options for those that
  /// make a new start necessary.
  int set_options(const Options& options) {
    Monitor monitor = options.monitor;
    const sfdae_options c_options = in_c(options, num_unknowns(), state_.get());
    const int status = checked(sfdae_set_options(get(), &c_options));
    state_->monitor.swap(monitor);
    return status;
  }

  /// What the last call had to say.
  std::string message() const { return sfdae_message(get()); }

  /// Stops the call that is running, or else the next one, with SFDAE_STOPPED. From any thread or signal handler.
  void request_stop() noexcept { sfdae_request_stop(get()); }

  /// Detects the strangeness index at t, forward or backward toward the given time.
  int analyze(double t, double toward) { return checked(sfdae_analyze(get(), t, toward, nullptr)); }

  /// The same along the solution through a point near point.x, for nonlinear problems.
  int analyze_at(const Point& point, double toward) {
    require_size(point.x.size(), num_unknowns(), "x");
    return checked(sfdae_analyze_at(get(), point.t, toward, point.x.data(), nullptr));
  }

  /// Parameters of recorded equations. After a change start() has to follow.
  int set_parameter(const std::string& name, double value) {
    return checked(sfdae_set_parameter(get(), name.c_str(), value));
  }
  double parameter(const std::string& name) const {
    double value = 0;
    checked(sfdae_get_parameter(get(), name.c_str(), &value));
    return value;
  }

  /// The characteristic values in use.
  Characteristics characteristics() const { return filled(sfdae_characteristics_init, sfdae_get_characteristics); }

  /// The rank decisions of the last analysis.
  std::vector<Decision> decisions() const {
    int count = 0;
    checked(sfdae_get_num_decisions(get(), &count));
    std::vector<Decision> result(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      Decision& decision = result[static_cast<std::size_t>(i)];
      sfdae_decision_init(&decision, sizeof(Decision));
      checked(sfdae_get_decision(get(), i, &decision));
    }
    return result;
  }

  /// Where the characteristic values changed, after SFDAE_CHARACTERISTICS_CHANGED.
  Change change() const { return filled(sfdae_change_init, sfdae_get_change); }

  /// Makes point.x consistent at point.t and computes point.xdot. The point reached is unaffected.
  int make_consistent(Point& point) {
    double* const xdot = prepared(point);
    return checked(sfdae_make_consistent(get(), point.t, point.x.data(), xdot));
  }

  /// What the last start or make_consistent did to the initial values.
  InitialReport initial_report() const { return filled(sfdae_initial_report_init, sfdae_get_initial_report); }

  /// Starts or restarts at point.t toward the given time: makes point.x consistent, computes point.xdot.
  int start(Point& point, double toward) {
    double* const xdot = prepared(point);
    return checked(sfdae_start(get(), point.t, toward, point.x.data(), xdot));
  }

  /// Integrates to tout. Remarks and failures of the integration leave the last accepted point.
  int advance(double tout, Point& point) {
    point.x.resize(size(num_unknowns()));
    double* const xdot = prepared(point);
    return checked(sfdae_advance(get(), tout, &point.t, point.x.data(), xdot));
  }

  /// Takes one step toward tout: SFDAE_STEP_TAKEN, or SFDAE_OK at tout.
  int step(double tout, Point& point) {
    point.x.resize(size(num_unknowns()));
    double* const xdot = prepared(point);
    return checked(sfdae_step(get(), tout, &point.t, point.x.data(), xdot));
  }

  /// The state of the integration, to be kept, written to a file or handed to another process; see
  /// sfdae_save_checkpoint. It contains neither problem nor options.
  std::vector<double> save_checkpoint() {
    std::size_t length = 0;
    checked(sfdae_get_checkpoint_length(get(), &length));
    std::vector<double> checkpoint(length);
    checked(sfdae_save_checkpoint(get(), checkpoint.data(), length));
    return checkpoint;
  }

  /// Continues from a checkpoint instead of start(): advance() is next. The problem and the options have to be those
  /// that the checkpoint was made with. After a failure nothing is started.
  int restore_checkpoint(const std::vector<double>& checkpoint) {
    const double nothing = 0;  // an empty vector may have no address
    const double* const values = checkpoint.empty() ? &nothing : checkpoint.data();
    return checked(sfdae_restore_checkpoint(get(), values, checkpoint.size()));
  }

  /// Events are zeros of `count` functions: advance() and step() return SFDAE_EVENT there. directions: empty, or count
  /// numbers, +1 where only rising zeros count, -1 where only falling ones do, else 0. count = 0: no events any more.
  int set_events(int count, EventFunction function, const std::vector<int>& directions = {}) {
    if (!directions.empty() && directions.size() != size(count))
      throw Error(SFDAE_ILLEGAL_ARGUMENT, "directions has " + std::to_string(directions.size()) + " entries, not " +
                                              std::to_string(count) + " as there are events");
    const int status = checked(sfdae_set_events(get(), count, function ? call_events : nullptr,
                                                directions.empty() ? nullptr : directions.data(), state_.get()));
    state_->event_function = std::move(function);
    state_->num_events = count;
    return status;
  }

  /// Which events happened at the point returned with SFDAE_EVENT: +1 rising, -1 falling, else 0.
  std::vector<int> events() const {
    std::vector<int> which(size(state_ ? state_->num_events : 0));
    int nothing = 0;
    checked(sfdae_get_events(get(), which.empty() ? &nothing : which.data()));
    return which;
  }

  /// The solution at any point.t within the last step taken; the point reached stays.
  int interpolate(Point& point) {
    point.x.resize(size(num_unknowns()));
    double* const xdot = prepared(point);
    return checked(sfdae_interpolate(get(), point.t, point.x.data(), xdot));
  }

  Statistics statistics() const { return filled(sfdae_statistics_init, sfdae_get_statistics); }

  /// The diagnostics report.
  std::string report() const {
    std::size_t needed = 0;
    checked(sfdae_report(get(), nullptr, 0, &needed));
    std::string text(needed, '\0');
    checked(sfdae_report(get(), text.data(), needed, &needed));
    text.resize(needed - 1);
    return text;
  }

  /// Classical derivative array of the given level at t.
  DerivativeArray derivative_array(double t, int level) {
    checked(sfdae_get_derivative_array(get(), t, level, nullptr, nullptr, nullptr));  // refuses impossible levels
    const int blocks = level + 1, rows = blocks * num_equations();
    DerivativeArray array{{rows, blocks * num_unknowns()}, {rows, num_unknowns()}, std::vector<double>(size(rows))};
    checked(sfdae_get_derivative_array(get(), t, level, array.M.data(), array.N.data(), array.g.data()));
    return array;
  }

  /// Projectors at t for the classical array of level mu.
  Projectors projectors(double t) {
    const Characteristics c = characteristics();
    const int rows = (c.strangeness_index + 1) * num_equations();
    int vhat = 0;
    checked(sfdae_get_projectors(get(), t, nullptr, nullptr, nullptr, nullptr, &vhat));
    Projectors p{{num_equations(), c.differential},
                 {rows, c.algebraic},
                 {rows, vhat},
                 {num_unknowns(), num_unknowns() - c.algebraic}};
    checked(sfdae_get_projectors(get(), t, p.Z1.data(), p.Z2.data(), p.Z3.data(), p.T2.data(), &vhat));
    return p;
  }

  /// Strangeness-free system at t.
  StrangenessFreeSystem strangeness_free(double t) {
    const Characteristics c = characteristics();
    const int n = num_unknowns();
    StrangenessFreeSystem s{{c.differential, n},
                            {c.differential, n},
                            std::vector<double>(size(c.differential)),
                            {c.algebraic, n},
                            std::vector<double>(size(c.algebraic))};
    checked(sfdae_get_strangeness_free(get(), t, s.E1.data(), s.A1.data(), s.f1.data(), s.A2.data(), s.f2.data(),
                                       &s.residual));
    return s;
  }

  /// Compares the derivatives that the callbacks supply near t with differences; returns the worst mismatch.
  DerivativeCheck check_derivatives(double t, int max_order) {
    DerivativeCheck result;
    sfdae_derivative_check_init(&result, sizeof result);
    checked(sfdae_check_derivatives(get(), t, max_order, &result));
    return result;
  }

  /// The same for total derivatives along a jet: derivatives, n x (highest order compared + 2).
  DerivativeCheck check_total_derivatives(double t, const Matrix& derivatives) {
    require_size(size(derivatives.rows()), num_unknowns(), "a column of derivatives");
    DerivativeCheck result;
    sfdae_derivative_check_init(&result, sizeof result);
    checked(sfdae_check_total_derivatives(get(), t, derivatives.data(), derivatives.columns() - 2, &result));
    return result;
  }

  /// The same for derivatives of a mechanical system near (t, q, v).
  DerivativeCheck check_multibody_derivatives(double t, const std::vector<double>& q, const std::vector<double>& v) {
    const auto* problem = std::get_if<MultibodyProblem>(&state_->problem);
    if (problem != nullptr) {
      require_size(q.size(), problem->num_positions, "q", "positions");
      require_size(v.size(), problem->num_velocities, "v", "velocities");
    }
    DerivativeCheck result;
    sfdae_derivative_check_init(&result, sizeof result);
    checked(sfdae_check_multibody_derivatives(get(), t, q.data(), v.data(), &result));
    return result;
  }

  /// Constraints, freedom and partition of a mechanical system at the point reached.
  MultibodyReport multibody_report() const { return filled(sfdae_multibody_report_init, sfdae_get_multibody_report); }

  int num_equations() const noexcept { return state_ ? state_->num_equations : 0; }
  int num_unknowns() const noexcept { return state_ ? state_->num_unknowns : 0; }

  /// The C handle; it stays with this object.
  sfdae_solver* get() const noexcept { return state_ ? state_->solver : nullptr; }

 private:
  /// What the C callbacks get as `user`: on the heap, so that it stays in place when the Solver moves.
  struct State {
    template <class AnyProblem>
    State(AnyProblem p, Monitor m)
        : num_equations(p.num_equations),
          num_unknowns(p.num_unknowns),
          problem(std::move(p)),
          monitor(std::move(m)) {}
    State(MultibodyProblem p, Monitor m)
        : num_equations(p.num_unknowns()),
          num_unknowns(p.num_unknowns()),
          problem(std::move(p)),
          monitor(std::move(m)) {}
    ~State() { sfdae_destroy(&solver); }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    /// No exception may cross the frames of the library: it waits here, the value returned stops the call.
    template <class Call>
    int guarded(Call call) noexcept {
      try {
        return call();
      } catch (...) {
        if (!exception) exception = std::current_exception();
        return -1;
      }
    }

    /// Lets an exception go on its way that waits.
    void rethrow() {
      if (exception) std::rethrow_exception(std::exchange(exception, nullptr));
    }

    int num_equations, num_unknowns;
    std::variant<LinearProblem, NonlinearProblem, MultibodyProblem> problem;
    Monitor monitor;
    EventFunction event_function;
    int num_events = 0;
    std::exception_ptr exception;
    sfdae_solver* solver = nullptr;
  };

  template <MatrixFunction LinearProblem::*function>
  static int call_matrix(double t, int order, double* values, void* user) noexcept {
    State& state = *static_cast<State*>(user);
    return state.guarded([&] {
      const LinearProblem& problem = std::get<LinearProblem>(state.problem);
      return (problem.*function).call(t, order, {values, state.num_equations, state.num_unknowns});
    });
  }

  static int call_f(double t, int order, double* values, void* user) noexcept {
    State& state = *static_cast<State*>(user);
    return state.guarded([&] {
      return std::get<LinearProblem>(state.problem).f.call(t, order, {values, state.num_equations});
    });
  }

  template <class AnyProblem>
  static int call_prescribed(double t, int order, double* values, void* user) noexcept {
    State& state = *static_cast<State*>(user);
    return state.guarded([&] {
      const AnyProblem& problem = std::get<AnyProblem>(state.problem);
      return problem.prescribed_values.call(t, order, {values, static_cast<int>(problem.prescribed.size())});
    });
  }

  static int call_equations(sfdae_record*, sfdae_expression t, const sfdae_expression* x,
                            const sfdae_expression* xdot, sfdae_expression* residual, void* user) noexcept {
    State& state = *static_cast<State*>(user);
    return state.guarded([&] {
      const int m = state.num_equations, n = state.num_unknowns;
      const std::vector<Expression> unknowns(x, x + n), derivatives(xdot, xdot + n);
      std::vector<Expression> F(residual, residual + m);
      const int outcome = std::get<NonlinearProblem>(state.problem)
                              .equations.call(t, {unknowns.data(), n}, {derivatives.data(), n}, {F.data(), m});
      copy_back(F, residual);
      return outcome;
    });
  }

  static int call_linear_equations(sfdae_record*, sfdae_expression t, sfdae_expression* E, sfdae_expression* A,
                                   sfdae_expression* f, void* user) noexcept {
    State& state = *static_cast<State*>(user);
    return state.guarded([&] {
      const int m = state.num_equations, n = state.num_unknowns;
      std::vector<Expression> matrix_E(size(m) * size(n)), matrix_A(matrix_E), vector_f(size(m));
      const int outcome =
          std::get<NonlinearProblem>(state.problem)
              .linear_equations.call(t, {matrix_E.data(), m, n}, {matrix_A.data(), m, n}, {vector_f.data(), m});
      copy_back(matrix_E, E);
      copy_back(matrix_A, A);
      copy_back(vector_f, f);
      return outcome;
    });
  }

  static int call_total_derivative(double t, int order, const double* derivatives, double* F, double* F_x,
                                   double* F_xdot, void* user) noexcept {
    State& state = *static_cast<State*>(user);
    return state.guarded([&] {
      const int m = state.num_equations, n = state.num_unknowns;
      return std::get<NonlinearProblem>(state.problem)
          .total_derivative.call(t, order, {derivatives, n, order + 2}, {{F, m}, {F_x, m, n}, {F_xdot, m, n}});
    });
  }

  template <PositionMatrixFunction MultibodyProblem::*function, int MultibodyProblem::*rows,
            int MultibodyProblem::*columns>
  static int call_position_matrix(double t, const double* q, double* values, void* user) noexcept {
    State& state = *static_cast<State*>(user);
    return state.guarded([&] {
      const MultibodyProblem& problem = std::get<MultibodyProblem>(state.problem);
      return (problem.*function).call(t, {q, problem.num_positions}, {values, problem.*rows, problem.*columns});
    });
  }

  template <PositionVectorFunction MultibodyProblem::*function, int MultibodyProblem::*rows>
  static int call_position_vector(double t, const double* q, double* values, void* user) noexcept {
    State& state = *static_cast<State*>(user);
    return state.guarded([&] {
      const MultibodyProblem& problem = std::get<MultibodyProblem>(state.problem);
      return (problem.*function).call(t, {q, problem.num_positions}, {values, problem.*rows});
    });
  }

  template <VelocityVectorFunction MultibodyProblem::*function, int MultibodyProblem::*rows>
  static int call_velocity_vector(double t, const double* q, const double* v, double* values, void* user) noexcept {
    State& state = *static_cast<State*>(user);
    return state.guarded([&] {
      const MultibodyProblem& problem = std::get<MultibodyProblem>(state.problem);
      return (problem.*function)
          .call(t, {q, problem.num_positions}, {v, problem.num_velocities}, {values, problem.*rows});
    });
  }

  static int call_multibody_equations(sfdae_record*, sfdae_expression t, const sfdae_expression* q,
                                      const sfdae_expression* v, const sfdae_multibody_formulas* to,
                                      void* user) noexcept {
    State& state = *static_cast<State*>(user);
    return state.guarded([&] {
      const MultibodyProblem& p = std::get<MultibodyProblem>(state.problem);
      const int nq = p.num_positions, nv = p.num_velocities, nl = p.num_constraints, nk = p.num_nonholonomic;
      const std::vector<Expression> positions(q, q + nq), velocities(v, v + nv);
      std::vector<Expression> M(to->M, to->M + nv * nv), f(to->f, to->f + nv), g(to->g, to->g + nl),
          S(to->S, to->S + nq * nv), H(to->H, to->H + nk * nv), h(to->h, to->h + nk);
      const MultibodyFormulas formulas{{M.data(), nv, nv}, {f.data(), nv},     {g.data(), nl},
                                       {S.data(), nq, nv}, {H.data(), nk, nv}, {h.data(), nk}};
      const int outcome = p.equations.call(t, {positions.data(), nq}, {velocities.data(), nv}, formulas);
      copy_back(M, to->M), copy_back(f, to->f), copy_back(g, to->g);
      copy_back(S, to->S), copy_back(H, to->H), copy_back(h, to->h);
      return outcome;
    });
  }

  static void copy_back(const std::vector<Expression>& from, sfdae_expression* to) noexcept {
    for (const Expression& expression : from) *to++ = expression.c();
  }

  static int call_monitor(const sfdae_progress* progress, void* user) noexcept {
    State& state = *static_cast<State*>(user);
    return state.guarded([&] { return state.monitor(*progress) ? 1 : 0; });
  }

  static int call_events(double t, const double* x, const double* xdot, double* g, void* user) noexcept {
    State& state = *static_cast<State*>(user);
    const int n = state.num_unknowns;
    return state.guarded([&] { return state.event_function.call(t, {x, n}, {xdot, n}, {g, state.num_events}); });
  }

  static sfdae_linear_problem in_c(const LinearProblem& problem, State* user) {
    sfdae_linear_problem c;
    sfdae_linear_problem_init(&c, sizeof c);
    c.num_equations = problem.num_equations;
    c.num_unknowns = problem.num_unknowns;
    c.E = problem.E ? call_matrix<&LinearProblem::E> : nullptr;
    c.A = problem.A ? call_matrix<&LinearProblem::A> : nullptr;
    c.f = problem.f ? call_f : nullptr;
    c.constant_E = problem.constant_E ? 1 : 0;
    c.constant_A = problem.constant_A ? 1 : 0;
    fill_prescribed(problem, c);
    c.user = user;
    return c;
  }

  static sfdae_nonlinear_problem in_c(const NonlinearProblem& problem, State* user) {
    sfdae_nonlinear_problem c;
    sfdae_nonlinear_problem_init(&c, sizeof c);
    c.num_equations = problem.num_equations;
    c.num_unknowns = problem.num_unknowns;
    c.equations = problem.equations ? call_equations : nullptr;
    c.linear_equations = problem.linear_equations ? call_linear_equations : nullptr;
    c.total_derivative = problem.total_derivative ? call_total_derivative : nullptr;
    fill_prescribed(problem, c);
    c.differentiations = entries(problem.differentiations, problem.num_equations, "differentiations", "equations");
    c.user = user;
    return c;
  }

  static sfdae_multibody_problem in_c(const MultibodyProblem& problem, State* user) {
    using P = MultibodyProblem;
    constexpr auto nq = &P::num_positions, nv = &P::num_velocities, nl = &P::num_constraints,
                   nk = &P::num_nonholonomic;
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
    c.user = user;
    return c;
  }

  template <class AnyProblem, class AnyCProblem>
  static void fill_prescribed(const AnyProblem& problem, AnyCProblem& c) {
    c.num_prescribed = static_cast<int>(problem.prescribed.size());
    c.prescribed = problem.prescribed.empty() ? nullptr : problem.prescribed.data();
    c.prescribed_values = problem.prescribed_values ? call_prescribed<AnyProblem> : nullptr;
  }

  /// The vectors are borrowed from `options`.
  static sfdae_options in_c(const Options& options, int n, State* user) {
    sfdae_options c = options;
    c.rtol_vector = entries(options.rtol_vector, n, "rtol_vector");
    c.atol_vector = entries(options.atol_vector, n, "atol_vector");
    c.fixed = entries(options.fixed, n, "fixed");
    c.initial_weights = entries(options.initial_weights, n, "initial_weights");
    c.monitor = options.monitor ? call_monitor : nullptr;
    c.monitor_user = user;
    return c;
  }

  template <class T>
  static const T* entries(const std::vector<T>& values, int n, const char* name, const char* what = "unknowns") {
    if (values.empty()) return nullptr;
    require_size(values.size(), n, name, what);
    return values.data();
  }

  static void require_size(std::size_t found, int n, const char* name, const char* what = "unknowns") {
    if (found == size(n)) return;
    throw Error(SFDAE_ILLEGAL_ARGUMENT, std::string(name) + " has " + std::to_string(found) + " entries, not " +
                                            std::to_string(n) + " as the problem has " + what);
  }

  static std::size_t size(int count) noexcept { return count < 0 ? 0 : static_cast<std::size_t>(count); }

  template <class CProblem>
  using Create = int (*)(sfdae_solver**, const CProblem*, const sfdae_options*);
  template <class CProblem>
  using Check = int (*)(const CProblem*, const sfdae_options*, char*, std::size_t);

  template <class CProblem, class AnyProblem>
  void create(Create<CProblem> create_in_c, Check<CProblem> check_in_c, const AnyProblem& problem,
              const Options& options) {
    const CProblem c_problem = in_c(problem, state_.get());
    const sfdae_options c_options = in_c(options, num_unknowns(), state_.get());
    const int status = create_in_c(&state_->solver, &c_problem, &c_options);
    state_->rethrow();
    if (status < 0) throw Error(status, complaint(check_in_c, c_problem, c_options, *state_));
  }

  template <class CProblem>
  static std::string complaint(Check<CProblem> check_in_c, const CProblem& problem, const sfdae_options& options,
                               State& state) {
    char text[1024] = "";
    const int status = check_in_c(&problem, &options, text, sizeof text);
    state.rethrow();
    return status < 0 && text[0] == '\0' ? sfdae_status_name(status) : text;
  }

  /// Where x'(t) goes; x has to have n entries already.
  double* prepared(Point& point) const {
    require_size(point.x.size(), num_unknowns(), "x");
    point.xdot.resize(size(num_unknowns()));
    return point.xdot.data();
  }

  template <class Result>
  Result filled(int (*init)(Result*, std::size_t), int (*get_result)(const sfdae_solver*, Result*)) const {
    Result result;
    init(&result, sizeof result);
    checked(get_result(get(), &result));
    return result;
  }

  /// Passes on the status, unless the call failed or an exception waits.
  int checked(int status) const {
    if (state_) state_->rethrow();
    if (status < 0) throw Error(status, sfdae_message(get()));
    return status;
  }

  std::unique_ptr<State> state_;
};

}  // namespace sfdae

#endif
