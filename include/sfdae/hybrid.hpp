// SPDX-License-Identifier: BSD-3-Clause

// Hybrid systems for C++17 and later: a header-only wrapper of hybrid.h, which explains everything. Not included by
// sfdae.hpp.
#ifndef SFDAE_HYBRID_HPP
#define SFDAE_HYBRID_HPP

#include <sfdae/hybrid.h>
#include <sfdae/sfdae.hpp>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace sfdae {

using ModeSummary = sfdae_mode;
using Passage = sfdae_passage;

/// A function of t, x and x' that a transition depends on. An exception stops the call.
using TransitionFunction = std::function<double(double t, ConstVectorRef x, ConstVectorRef xdot)>;
/// Changes x from the values before a transition to those after it. An exception stops the call.
using JumpFunction = std::function<void(double t, VectorRef x)>;

/// The function of a surface as a formula, g(t, x). Called once.
using SurfaceFunction = std::function<Expression(const Expression& t, ConstExpressions x)>;

/// A transition between modes, see sfdae_transition.
struct Transition {
  int from = 0, to = 0;
  int kind = SFDAE_TRANSITION_CONDITION;
  TransitionFunction function;  ///< not for SFDAE_TRANSITION_TIME
  int direction = 0;
  double time = 0;
  TransitionFunction guard;  ///< empty: none
  JumpFunction jump;         ///< empty: by impulses
};

/// Modes, transitions, and an integration across them. Movable. It has to be destroyed before its solvers: declare it
/// after them.
class Hybrid {
 public:
  Hybrid() {
    if (const int status = sfdae_create_hybrid(&hybrid_); status < 0) throw Error(status, "a hybrid system");
  }
  Hybrid(Hybrid&& other) noexcept { swap(other); }
  Hybrid& operator=(Hybrid&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Hybrid() { sfdae_destroy_hybrid(&hybrid_); }

  /// Adds a mode, solved by the solver; returns its number. The solver may be moved, but has to live as long as this.
  int add_mode(Solver& solver, const std::string& name = "") {
    modes_.reserve(modes_.size() + 1);
    int mode = 0;
    checked(sfdae_add_mode(hybrid_, solver.get(), name.c_str(), &mode));
    modes_.push_back(solver.state_.get());
    return mode;
  }

  /// Adds a transition; returns its number.
  int add_transition(Transition transition) {
    auto state = std::make_unique<State>();
    state->transition = std::move(transition);
    state->num_unknowns = modes_.empty() ? 0 : modes_.front()->num_unknowns;
    const Transition& given = state->transition;
    sfdae_transition c;
    sfdae_transition_init(&c, sizeof c);
    c.from = given.from;
    c.to = given.to;
    c.kind = given.kind;
    c.function = given.function ? call_function : nullptr;
    c.direction = given.direction;
    c.time = given.time;
    c.guard = given.guard ? call_guard : nullptr;
    c.jump = given.jump ? call_jump : nullptr;
    c.user = state.get();
    transitions_.reserve(transitions_.size() + 1);
    int number = 0;
    checked(sfdae_add_transition(hybrid_, &c, &number));
    transitions_.push_back(std::move(state));
    return number;
  }

  /// Adds the switch between a mode for g < 0 and one for g > 0, see sfdae_add_switch; returns the number of the
  /// sliding mode along g = 0.
  int add_switch(int below, int above, SurfaceFunction surface, const std::string& name = "") {
    SurfaceCall call{std::move(surface), static_cast<int>(num_unknowns()), nullptr};
    int mode = 0;
    const int status = sfdae_add_switch(hybrid_, below, above, call_surface, &call, name.c_str(), &mode);
    if (call.exception) std::rethrow_exception(call.exception);
    checked(status);
    return mode;
  }

  /// Starts in a mode at point.t toward the given time; `point` gets the consistent values.
  int start(int mode, Point& point, double toward) {
    prepare(point, point.x.size());
    return checked(sfdae_start_hybrid(hybrid_, mode, point.t, toward, point.x.data(), point.xdot.data()));
  }

  /// Integrates to tout across all transitions. After failures `point` is the one reached.
  int advance(double tout, Point& point) {
    prepare(point, num_unknowns());
    return checked(sfdae_advance_hybrid(hybrid_, tout, &point.t, point.x.data(), point.xdot.data()));
  }

  /// Integrates to the next transition, SFDAE_EVENT, or to tout.
  int advance_to_transition(double tout, Point& point) {
    prepare(point, num_unknowns());
    return checked(sfdae_advance_to_transition(hybrid_, tout, &point.t, point.x.data(), point.xdot.data()));
  }

  /// Records all accepted steps in all modes from now on.
  int record(Solution& solution) { return checked(sfdae_record_hybrid(hybrid_, solution.get())); }
  /// Stops recording.
  int stop_recording() { return checked(sfdae_record_hybrid(hybrid_, nullptr)); }

  /// Stops the call that is running, or else the next one. From any thread or signal handler.
  void request_stop() noexcept { sfdae_request_stop_hybrid(hybrid_); }

  /// Requests sensitivities from the next start on, see sfdae_set_hybrid_sensitivities; none: ends them.
  int set_sensitivities(const Sensitivities& wanted) {
    const int count = static_cast<int>(wanted.parameters.size());
    std::vector<const char*> names;
    for (const std::string& name : wanted.parameters) names.push_back(name.empty() ? nullptr : name.c_str());
    const Matrix& directions = wanted.directions;
    if (directions.columns() > 0 || directions.rows() > 0) {
      detail::require_size(detail::size(directions.rows()), static_cast<int>(num_unknowns()), "directions");
      detail::require_size(detail::size(directions.columns()), count, "columns of directions");
    }
    if (!wanted.scales.empty()) detail::require_size(wanted.scales.size(), count, "scales");
    sfdae_sensitivity_options options;
    sfdae_sensitivity_options_init(&options, sizeof options);
    options.error_test = wanted.error_test ? 1 : 0;
    options.scales = wanted.scales.empty() ? nullptr : wanted.scales.data();
    options.adjoint = wanted.adjoint ? 1 : 0;
    options.max_kept_steps = wanted.max_kept_steps;
    const int status = checked(sfdae_set_hybrid_sensitivities(
        hybrid_, count, names.data(), directions.columns() > 0 ? directions.data() : nullptr, &options));
    num_sensitivities_ = count;
    return status;
  }

  /// S and S' at t, see sfdae_get_hybrid_sensitivities. Without slopes Sdot is empty.
  SensitivityValues sensitivities(double t, bool slopes = true) {
    const int n = static_cast<int>(num_unknowns());
    SensitivityValues values{Matrix(n, num_sensitivities_), slopes ? Matrix(n, num_sensitivities_) : Matrix()};
    double nothing = 0;  // an empty matrix may have no address
    checked(sfdae_get_hybrid_sensitivities(hybrid_, t, num_sensitivities_ > 0 ? values.S.data() : &nothing,
                                           slopes && num_sensitivities_ > 0 ? values.Sdot.data() : nullptr));
    return values;
  }

  /// dt/dp of the last transition.
  std::vector<double> passage_sensitivities() {
    std::vector<double> dt(detail::size(num_sensitivities_));
    double nothing = 0;
    checked(sfdae_get_passage_sensitivities(hybrid_, dt.empty() ? &nothing : dt.data()));
    return dt;
  }

  /// Gradients of functionals with weights at these times, see sfdae_get_hybrid_gradient: one column for each.
  /// weights: n rows, a column for each time, for one functional after the other.
  Matrix gradient(const std::vector<double>& times, const Matrix& weights) {
    const int points = static_cast<int>(times.size());
    const int functionals = points > 0 ? weights.columns() / points : 0;
    detail::require_size(detail::size(weights.rows()), static_cast<int>(num_unknowns()), "weights");
    detail::require_size(detail::size(weights.columns()), points * functionals, "columns of weights",
                         "points in time");
    Matrix gradient(num_sensitivities_, functionals);
    double nothing = 0;
    checked(sfdae_get_hybrid_gradient(hybrid_, points, times.empty() ? &nothing : times.data(), functionals,
                                      weights.columns() > 0 ? weights.data() : &nothing,
                                      num_sensitivities_ > 0 ? gradient.data() : &nothing));
    return gradient;
  }

  /// The message of the last call.
  std::string message() const { return sfdae_get_hybrid_message(hybrid_); }

  /// The current mode.
  int current_mode() const {
    int mode = 0;
    checked(sfdae_get_current_mode(hybrid_, &mode));
    return mode;
  }

  /// Statistics of a mode since the start.
  ModeSummary mode(int number) const {
    ModeSummary result;
    sfdae_mode_init(&result, sizeof result);
    checked(sfdae_get_mode(hybrid_, number, &result));
    return result;
  }

  /// Number of transitions since the start.
  long num_passages() const {
    long count = 0;
    checked(sfdae_get_num_passages(hybrid_, &count));
    return count;
  }

  /// A transition that happened, from 0 on.
  Passage passage(long index) const {
    Passage result;
    sfdae_passage_init(&result, sizeof result);
    checked(sfdae_get_passage(hybrid_, index, &result));
    return result;
  }

  /// Values before and after the last transition, with the impulse of order 0.
  Jump last_jump() const {
    const int n = modes_.empty() ? 0 : modes_.front()->num_unknowns;
    Jump jump{0.0, std::vector<double>(num_unknowns()), std::vector<double>(num_unknowns()), Matrix(n, 1)};
    checked(sfdae_get_passage_values(hybrid_, jump.before.data(), jump.after.data(), jump.impulses.data()));
    jump.t = passage(num_passages() - 1).t;
    return jump;
  }

  /// The time at which transitions accumulate, after SFDAE_ZENO.
  double accumulation() const {
    double t = 0;
    checked(sfdae_get_accumulation(hybrid_, &t));
    return t;
  }

  /// Counts over all modes.
  Statistics statistics() const {
    Statistics result;
    sfdae_statistics_init(&result, sizeof result);
    checked(sfdae_get_hybrid_statistics(hybrid_, &result));
    return result;
  }

  /// Modes and transitions as text.
  std::string report() const {
    std::size_t needed = 0;
    checked(sfdae_report_hybrid(hybrid_, nullptr, 0, &needed));
    std::string text(needed, '\0');
    checked(sfdae_report_hybrid(hybrid_, text.data(), needed, &needed));
    text.resize(needed - 1);
    return text;
  }

  /// The state of the run, see sfdae_save_hybrid_checkpoint.
  std::vector<double> save_checkpoint() {
    std::size_t length = 0;
    checked(sfdae_get_hybrid_checkpoint_length(hybrid_, &length));
    std::vector<double> checkpoint(length);
    checked(sfdae_save_hybrid_checkpoint(hybrid_, checkpoint.data(), length));
    return checkpoint;
  }

  /// Continues from a checkpoint instead of start().
  int restore_checkpoint(const std::vector<double>& checkpoint) {
    const double nothing = 0;  // an empty vector may have no address
    return checked(sfdae_restore_hybrid_checkpoint(hybrid_, checkpoint.empty() ? &nothing : checkpoint.data(),
                                                   checkpoint.size()));
  }

  /// The C object, which this one owns.
  sfdae_hybrid* get() const noexcept { return hybrid_; }

 private:
  struct State {
    Transition transition;
    int num_unknowns = 0;
    std::exception_ptr exception;
    template <class Call>
    int guarded(Call call) noexcept {
      try {
        call();
        return 0;
      } catch (...) {
        if (!exception) exception = std::current_exception();
        return -1;
      }
    }
  };

  struct SurfaceCall {
    SurfaceFunction function;
    int num_unknowns;
    std::exception_ptr exception;
  };

  static int call_surface(sfdae_record*, sfdae_expression t, const sfdae_expression* x, const sfdae_expression*,
                          sfdae_expression* residual, void* user) noexcept {
    SurfaceCall& call = *static_cast<SurfaceCall*>(user);
    try {
      const std::vector<Expression> unknowns(x, x + call.num_unknowns);
      *residual = call.function(t, {unknowns.data(), call.num_unknowns, "x"}).c();
      return 0;
    } catch (...) {
      call.exception = std::current_exception();
      return -1;
    }
  }

  static int call_function(double t, const double* x, const double* xdot, double* g, void* user) noexcept {
    State& state = *static_cast<State*>(user);
    const int n = state.num_unknowns;
    return state.guarded([&] { *g = state.transition.function(t, {x, n, "x"}, {xdot, n, "xdot"}); });
  }
  static int call_guard(double t, const double* x, const double* xdot, double* g, void* user) noexcept {
    State& state = *static_cast<State*>(user);
    const int n = state.num_unknowns;
    return state.guarded([&] { *g = state.transition.guard(t, {x, n, "x"}, {xdot, n, "xdot"}); });
  }
  static int call_jump(double t, int, int, const double*, double* after, void* user) noexcept {
    State& state = *static_cast<State*>(user);
    return state.guarded([&] { state.transition.jump(t, {after, state.num_unknowns, "x"}); });
  }

  std::size_t num_unknowns() const { return modes_.empty() ? 0 : detail::size(modes_.front()->num_unknowns); }

  void prepare(Point& point, std::size_t size) const {
    if (!modes_.empty()) detail::require_size(size, modes_.front()->num_unknowns, "x");
    point.x.resize(size);
    point.xdot.resize(size);
  }

  void swap(Hybrid& other) noexcept {
    std::swap(hybrid_, other.hybrid_);
    modes_.swap(other.modes_);
    transitions_.swap(other.transitions_);
    std::swap(num_sensitivities_, other.num_sensitivities_);
  }

  /// Returns the status, unless the call failed or an exception is stored.
  int checked(int status) const {
    for (const auto& state : transitions_)
      if (state->exception) std::rethrow_exception(std::exchange(state->exception, nullptr));
    for (detail::CallbackState* mode : modes_) mode->rethrow();
    if (status < 0) throw Error(status, message());
    return status;
  }

  sfdae_hybrid* hybrid_ = nullptr;
  std::vector<detail::CallbackState*> modes_;
  std::vector<std::unique_ptr<State>> transitions_;
  int num_sensitivities_ = 0;
};

}  // namespace sfdae

#endif
