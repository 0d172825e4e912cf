// Taylor coefficients of recorded equations along a jet.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/taylor_evaluator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "expression/edges.h"
#include "expression/execution.h"
#include "expression/kernel.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

using series::Fixed;

// Calls an action with the order, which is a constant for the most frequent orders.
template <class Action>
auto with_order(int order, Action action) {
  switch (order) {
    case 0: return action(Fixed<0>());
    case 1: return action(Fixed<1>());
    case 2: return action(Fixed<2>());
    case 3: return action(Fixed<3>());
    case 4: return action(Fixed<4>());
    default: return action(order);
  }
}

template <bool with_slopes, class Order>
void execute_each(const InstructionList& list, double* const slots, Order K) {
  const auto binary = [K](auto code, auto a, auto b, auto v) {
    if constexpr (code == Code::add) series::add(a, b, v, K);
    else if constexpr (code == Code::subtract) series::subtract(a, b, v, K);
    else if constexpr (code == Code::multiply) series::multiply(a, b, v, K);
    else series::scale(a, b[0], v, K);
  };
  execute_list(list, slots, binary, [slots, K](const Instruction& other) { execute<with_slopes>(other, slots, K); });
}

template <bool with_slopes>
void execute_all(const InstructionList& instructions, double* slots, int order) {
  with_order(order, [&instructions, slots](auto K) { execute_each<with_slopes>(instructions, slots, K); });
}

std::vector<Edge> in_offsets(std::vector<Edge> edges, int stride) {
  for (Edge& edge : edges)
    for (int* adjoint : {&edge.from, &edge.to}) *adjoint *= stride;
  return edges;
}

std::vector<int> in_offsets(std::vector<int> slots, int stride) {
  for (int& slot : slots) slot *= stride;
  return slots;
}

}  // namespace

void execute_values(const InstructionList& list, double* slots) { execute_all<false>(list, slots, 0); }

TaylorEvaluator::TaylorEvaluator(std::shared_ptr<const Record> record, std::shared_ptr<EquationSource> source)
    : record_(std::move(record)), source_(std::move(source)), shared_tape_(std::make_shared<const Tape>(*record_)) {
  for (const Parameter& parameter : record_->parameters()) parameters_.push_back(parameter.value);
}

std::optional<int> TaylorEvaluator::find_parameter(const std::string& name) const {
  for (int i = 0; i < record_->num_user_parameters(); ++i)
    if (record_->parameters()[index(i)].name == name) return i;
  return std::nullopt;
}

void TaylorEvaluator::set_parameter(int i, double value) {
  parameters_[index(i)] = value;
  parameters_changed_ = true;
  ++changes_of_parameters_;
}

bool TaylorEvaluator::values(double t, const double* jet, int order, double* F, const std::vector<int>* limits) {
  return gradients(t, jet, {order, -1, -1}, F, nullptr, nullptr, limits);
}

bool TaylorEvaluator::values_of(const std::vector<int>& equations, double t, const double* jet, int order,
                                double* F) {
  assert(!source_);
  const QuietArithmetic quiet;
  reserve(order);
  if (!load(t, jet, order)) return false;
  return write_or_diagnose({t, order, false, {}}, [&] {
    return write_values_of(
        static_cast<int>(equations.size()), [&equations](int k) { return equations[index(k)]; }, order, F);
  });
}

bool TaylorEvaluator::gradients(double t, const double* jet, SeriesOrders orders, double* F, double* F_xdot,
                                double* F_x, const std::vector<int>* limits) {
  const int order = orders.highest();
  assert(order <= series::highest_order);
  if (order < 0) return true;
  if (source_)
    return (orders.F < 0 || source_->values(t, jet, orders.F, F)) &&
           ask_for_gradients(t, jet, orders, F_xdot, F_x, limits);
  const QuietArithmetic quiet;
  reserve(order);
  if (!load(t, jet, order)) return false;
  return write_or_diagnose({t, order, orders.of_gradients() >= 0, {}}, [&] {
    return write_values(orders.F, F, limits) && write_gradients(orders, F_xdot, F_x, limits);
  });
}

bool TaylorEvaluator::entries(double t, const double* jet, int order, const std::vector<int>& limits,
                              double* values) {
  if (source_) return source_->entries(t, jet, order, limits, values);
  const QuietArithmetic quiet;
  reserve(order);
  if (!load(t, jet, order)) return false;
  return write_or_diagnose({t, order, true, {}}, [&] { return write_entries(order, limits, values); });
}

bool TaylorEvaluator::values_within(double t, const double* jet, const std::shared_ptr<const OrderLimits>& limits,
                                    int more, double* F) {
  const int order = limits->highest + more;
  if (order < 0) return true;
  if (source_) return source_->values(t, jet, order, F);
  const QuietArithmetic quiet;
  reserve(order, limits);
  if (!load_within(t, jet, more)) return false;
  return write_or_diagnose({t, order, false, more}, [&] { return write_values_within(more, F); });
}

bool TaylorEvaluator::write_values_within(int more, double* F) {
  const int m = record_->m();
  const int* const limit = limits_->of_equations.data();
  bool finite = true;
  for (int i = 0; i < m; ++i) {
    const double* const from = slots_.data() + index(tape_.residuals[index(i)]) * index(stride_);
    for (int k = 0; k <= limit[i] + more; ++k) {
      F[i + k * m] = from[k];
      finite &= std::isfinite(from[k]);
    }
  }
  for (int i = 0; i < m && !finite; ++i)
    if (!write_value(i, limit[i] + more, F)) return false;
  return true;
}

bool TaylorEvaluator::entries_within(double t, const double* jet, const std::shared_ptr<const OrderLimits>& limits,
                                     double* values) {
  const int order = limits->highest;
  if (source_) return source_->entries(t, jet, order, limits->of_equations, values);
  const QuietArithmetic quiet;
  reserve(order, limits);
  if (!load_within(t, jet, 0)) return false;
  return write_or_diagnose({t, order, true, 0}, [&] { return write_entries(order, limits->of_equations, values); });
}

bool TaylorEvaluator::entries(double t, const double* jet, VaryingEntries& varying, double* values) {
  if (!source_ && varying.version == changes_of_parameters_ && varying_entries(t, jet, varying, values)) return true;
  // Evaluates all of them, which also reports the error.
  varying.version = -1;
  const std::vector<int> none(index(record_->m()), 0);
  if (!entries(t, jet, 0, none, values)) return false;
  if (source_) return true;
  if (varying.stride() != stride_) varying.set(tape_, stride_);
  varying.version = changes_of_parameters_;
  return true;
}

bool TaylorEvaluator::varying_entries(double t, const double* jet, const VaryingEntries& varying, double* values) {
  const QuietArithmetic quiet;
  if (varying.stride() != stride_ || !load(t, jet, 0)) return false;
  run_before_state(t, 0);
  double *const slots = slots_.data(), *const adjoints = adjoints_.data();
  execute_all<true>(varying.instructions(), slots, 0);
  bool finite = true;
  for (const VaryingEntries::Row& row : varying.rows()) {
    adjoints[0] = 1.0;
    if (tape_.has_choices) follow<true>(varying.edges_of(row), slots, adjoints, Fixed<0>());
    else follow<false>(varying.edges_of(row), slots, adjoints, Fixed<0>());
    for (std::size_t k = row.first_target; k < row.last_target; ++k) {
      const std::size_t e = varying.target(k);
      values[e] = adjoints[index(varying.adjoint(k)) * index(stride_)];
      finite &= std::isfinite(values[e]);
    }
  }
  return finite;
}

// Allocates series of this order in every slot. Never shrinks.
void TaylorEvaluator::reserve(int order, const std::shared_ptr<const OrderLimits>& limits) {
  // Other extensions of the same equations may have limits of their own, which are the same as a rule.
  const bool are_same = limits == limits_ || (limits && limits_ && limits->of_equations == limits_->of_equations);
  if (order < stride_ && are_same) return;
  const int stride = std::max(order + 1, stride_);
  std::vector<double> slots(index(tape_.num_slots) * index(stride), 0.0),
      adjoints(index(tape_.num_adjoints) * index(stride), 0.0);
  Program program;
  if (stride > 1) {
    program = {tape_.of_parameters.in_offsets(stride),
               tape_.of_time.in_offsets(stride),
               limits ? InstructionList() : tape_.of_state.in_offsets(stride),
               limits ? InstructionsByOrder(tape_, *limits) : InstructionsByOrder(),
               in_offsets(tape_.edges, stride),
               in_offsets(tape_.factors, stride)};
    if (limits) program.by_order.to_offsets(tape_, record_->n(), stride);
  }
  limits_ = limits;
  program_ = std::move(program);
  slots_ = std::move(slots);
  adjoints_ = std::move(adjoints);
  stride_ = stride;
  for (const Tape::Number& constant : tape_.constants)
    slots_[index(constant.slot) * index(stride_)] = record_->constant(constant.index);
  parameters_changed_ = true;
  time_order_ = -1;
}

namespace {

// Taylor coefficients of an unknown, or of its derivative.
template <class Order>
bool load_leaf(const Tape::Leaf& leaf, const double* jet, std::size_t n, double* to, Order K) {
  const double* const from = jet + leaf.unknown + (leaf.derivative ? n : 0);
  bool finite = true;
  for (int k = 0; k <= K; ++k) {
    to[k] = leaf.derivative ? (k + 1) * from[index(k) * n] : from[index(k) * n];
    finite &= std::isfinite(to[k]);
  }
  return finite;
}

}  // namespace

bool TaylorEvaluator::load(double t, const double* jet, int order) {
  bool finite = std::isfinite(t);
  const std::size_t n = index(record_->n()), stride = index(stride_);
  double* const slots = slots_.data();
  with_order(order, [&](auto K) {
    for (const Tape::Leaf& leaf : tape_.leaves)
      finite &= load_leaf(leaf, jet, n, slots + index(leaf.slot) * stride, K);
  });
  return finite || note_not_finite();
}

// Without separate lists only values of order 0 are available.
bool TaylorEvaluator::load_within(double t, const double* jet, int more) {
  if (stride_ == 1) return load(t, jet, 0);
  bool finite = std::isfinite(t);
  double* const slots = slots_.data();
  if (more == 0) {
    for (const InstructionsByOrder::Load& load : program_.by_order.loads) {
      slots[load.to] = load.factor * jet[load.from];
      finite &= std::isfinite(slots[load.to]);
    }
    return finite || note_not_finite();
  }
  const std::size_t n = index(record_->n());
  for (std::size_t i = 0; i < tape_.leaves.size(); ++i) {
    const Tape::Leaf& leaf = tape_.leaves[i];
    double* const to = slots + index(leaf.slot) * index(stride_);
    finite &= load_leaf(leaf, jet, n, to, program_.by_order.of_leaves[i] + more);
  }
  return finite || note_not_finite();
}

bool TaylorEvaluator::note_not_finite() {
  failure_ = {EvaluationFailure::Kind::not_finite, -1, "", "t, x or a derivative of x is not finite"};
  return false;
}

// Lists of instructions in their order, with the order of the coefficients: execute(list, order).
template <class Execute>
void TaylorEvaluator::run_state(const Pass& pass, Execute execute) const {
  if (stride_ == 1 || !limits_) return execute(instructions(&Tape::of_state, &Program::of_state), pass.order);
  program_.by_order.for_each([&](const InstructionList& list, int order) {
    const int own = pass.more ? order + *pass.more : pass.order;
    if (own >= 0) execute(list, own);
  });
}

void TaylorEvaluator::run(const Pass& pass) {
  run_before_state(pass.t, pass.order);
  run_state(pass, [&](const InstructionList& list, int order) {
    if (pass.with_slopes) execute_all<true>(list, slots_.data(), order);
    else execute_all<false>(list, slots_.data(), order);
  });
}

BoundarySweep TaylorEvaluator::sweep_at_boundary(const Pass& pass, BoundarySweep::Unknowns unknowns) {
  BoundarySweep sweep(tape_, movement_, slots_, stride_, unknowns);
  sweep.execute(instructions(&Tape::of_time, &Program::of_time), pass.order, false, false);
  run_state(pass,
            [&](const InstructionList& list, int order) { sweep.execute(list, order, pass.with_slopes, true); });
  return sweep;
}

std::vector<double> TaylorEvaluator::residuals_in_slots(int order) const {
  std::vector<double> found;
  for (const int slot : tape_.residuals) {
    const double* const from = slots_.data() + index(slot) * index(stride_);
    found.insert(found.end(), from, from + order + 1);
  }
  return found;
}

// Returns false, with nothing changed, if no operation is at the boundary of its domain. Residuals that depend on
// unknown values there do not exist.
bool TaylorEvaluator::run_at_boundary(const Pass& pass) {
  using Unknowns = BoundarySweep::Unknowns;
  const BoundarySweep first = sweep_at_boundary(pass, Unknowns::other);
  if (!first.has_found_boundary()) return false;
  if (!first.has_unknowns()) return true;
  const std::vector<double> with_other = residuals_in_slots(pass.order);
  sweep_at_boundary(pass, Unknowns::near);
  const std::vector<double> with_near = residuals_in_slots(pass.order);
  if (with_near == with_other) return true;
  sweep_at_boundary(pass, Unknowns::none);
  const std::size_t length = index(pass.order + 1);
  for (std::size_t i = 0; i < tape_.residuals.size(); ++i) {
    double* const to = slots_.data() + index(tape_.residuals[i]) * index(stride_);
    for (std::size_t k = 0; k < length; ++k) {
      const double near = with_near[i * length + k];
      to[k] = near == with_other[i * length + k] ? near : std::numeric_limits<double>::quiet_NaN();
    }
  }
  return true;
}

// write() is false if anything is not finite, after fail().
template <class Write>
bool TaylorEvaluator::write_or_diagnose(const Pass& pass, Write write) {
  run(pass);
  if (write() || (run_at_boundary(pass) && write())) return true;
  failure_ = diagnose(*record_, {slots_.data(), stride_}, failed_);
  return false;
}

void TaylorEvaluator::run_before_state(double t, int order) {
  double* const slots = slots_.data();
  if (parameters_changed_) {
    for (const Tape::Number& parameter : tape_.parameters)
      slots[index(parameter.slot) * index(stride_)] = parameters_[index(parameter.index)];
    // Coefficients of higher order stay 0.
    execute_all<false>(instructions(&Tape::of_parameters, &Program::of_parameters), slots, 0);
    parameters_changed_ = false;
    time_order_ = -1;
  }
  if (t != time_ || order > time_order_) {
    if (tape_.time >= 0) {
      slots[index(tape_.time) * index(stride_)] = t;
      if (order > 0) slots[index(tape_.time) * index(stride_) + 1] = 1.0;
    }
    execute_all<false>(instructions(&Tape::of_time, &Program::of_time), slots, order);
    time_ = t;
    time_order_ = order;
  }
}

bool TaylorEvaluator::write_values(int order, double* F, const std::vector<int>* limits) {
  return order < 0 || write_values_of(
                          record_->m(), [](int i) { return i; }, order, F, limits);
}

template <class EquationAt>
bool TaylorEvaluator::write_values_of(int count, EquationAt equation, int order, double* F,
                                      const std::vector<int>* limits) {
  const std::size_t m = index(record_->m()), stride = index(stride_);
  const double* const slots = slots_.data();
  const int* const residuals = tape_.residuals.data();
  return with_order(order, [&](auto K) {
    bool finite = true;
    for (int next = 0; next < count; ++next) {
      const int i = equation(next);
      const double* const from = slots + index(residuals[i]) * stride;
      for (int k = 0; k <= K; ++k) {
        F[index(i) + index(k) * m] = from[k];
        finite &= std::isfinite(from[k]);
      }
    }
    if (finite) return true;
    // Reports the one that is not finite, if it is used.
    const bool has_limits = limits != nullptr && !limits->empty();
    for (int next = 0; next < count; ++next) {
      const int i = equation(next), own = has_limits ? std::min<int>(K, (*limits)[index(i)]) : static_cast<int>(K);
      if (!write_value(i, own, F)) return false;
    }
    return true;
  });
}

template <class Order>
bool TaylorEvaluator::write_value(int equation, Order order, double* F) {
  const std::size_t m = index(record_->m());
  const double* const from = slots_.data() + index(tape_.residuals[index(equation)]) * index(stride_);
  bool finite = true;
  for (int k = 0; k <= order; ++k) {
    F[index(equation) + index(k) * m] = from[k];
    finite &= std::isfinite(from[k]);
  }
  return finite || fail(equation, order, -1);
}

bool TaylorEvaluator::write_entries(int order, const std::vector<int>& limits, double* values) {
  const std::size_t length = index(order + 1);
  for (int i = 0; i < record_->m(); ++i) {
    const int own = std::min(order, limits[index(i)]);
    with_order(own, [&](auto G) { sweep_back(i, G); });
    bool finite = true;
    const int* adjoint = tape_.adjoints_of_targets(index(i));
    for (std::size_t e = tape_.first_target[index(i)]; e < tape_.first_target[index(i + 1)]; ++e) {
      const double* const from = adjoints_.data() + index(*adjoint++) * index(stride_);
      for (int k = 0; k <= own; ++k) {
        values[e * length + index(k)] = from[k];
        finite = finite && std::isfinite(from[k]);
      }
    }
    if (!finite) return fail(i, own, own);
  }
  return true;
}

namespace {

// The wanted orders, limited to the order that an equation is differentiated to.
SeriesOrders within(SeriesOrders orders, int limit) {
  return {orders.F, std::min(orders.F_xdot, limit), std::min(orders.F_x, limit)};
}

}  // namespace

// Gradients from the source, which computes entries only. Derivatives that it does not supply stay zero.
bool TaylorEvaluator::ask_for_gradients(double t, const double* jet, SeriesOrders orders, double* F_xdot, double* F_x,
                                        const std::vector<int>* limits) {
  const int order = orders.of_gradients();
  if (order < 0) return true;
  clear_gradients(orders, F_xdot, F_x);
  const std::vector<int> own =
      limits != nullptr && !limits->empty() ? *limits : std::vector<int>(index(record_->m()), order);
  const std::size_t length = index(order + 1);
  std::vector<double> values(tape_.targets.size() * length, 0.0);
  if (!source_->entries(t, jet, order, own, values.data())) return false;
  for (int i = 0; i < record_->m(); ++i)
    write_targets(i, within(orders, own[index(i)]), F_xdot, F_x,
                  [&](std::size_t e) { return values.data() + e * length; });
  return true;
}

void TaylorEvaluator::clear_gradients(SeriesOrders orders, double* F_xdot, double* F_x) const {
  const std::size_t area = index(record_->m()) * index(record_->n());
  std::fill_n(F_xdot, area * index(orders.F_xdot + 1), 0.0);
  std::fill_n(F_x, area * index(orders.F_x + 1), 0.0);
}

bool TaylorEvaluator::write_gradients(SeriesOrders orders, double* F_xdot, double* F_x,
                                      const std::vector<int>* limits) {
  const int order = orders.of_gradients();
  if (order < 0) return true;
  clear_gradients(orders, F_xdot, F_x);
  if (limits != nullptr && !limits->empty()) {
    for (int i = 0; i < record_->m(); ++i) {
      const int limit = (*limits)[index(i)], own = std::min(order, limit);
      with_order(own, [&](auto G) { sweep_back(i, G); });
      if (!write_adjoints(i, within(orders, limit), F_xdot, F_x)) return fail(i, orders.F, own);
    }
    return true;
  }
  return with_order(order, [&](auto G) {
    for (int i = 0; i < record_->m(); ++i) {
      sweep_back(i, G);
      if (!write_adjoints(i, orders, F_xdot, F_x)) return fail(i, orders.F, order);
    }
    return true;
  });
}

// Backward sweep from the residual, whose derivative by itself is 1, to the leaves.
template <class Order>
void TaylorEvaluator::sweep_back(int equation, Order order) {
  double* const adjoints = adjoints_.data();
  for (int k = 1; k <= order; ++k) adjoints[k] = 0.0;
  adjoints[0] = 1.0;
  const bool is_own = stride_ > 1;
  const Tape::EdgesOfEquation edges = tape_.edges_of(index(equation), is_own ? program_.edges : tape_.edges,
                                                     is_own ? program_.factors : tape_.factors);
  if (tape_.has_choices) follow<true>(edges, slots_.data(), adjoints, order);
  else follow<false>(edges, slots_.data(), adjoints, order);
}

bool TaylorEvaluator::write_adjoints(int equation, SeriesOrders orders, double* F_xdot, double* F_x) const {
  const int* const adjoint = tape_.adjoints_of_targets(index(equation));
  const std::size_t first = tape_.first_target[index(equation)];
  return write_targets(equation, orders, F_xdot, F_x,
                       [&](std::size_t e) { return adjoints_.data() + index(adjoint[e - first]) * index(stride_); });
}

// Entries of one row, coefficients from coefficients_of(target) on; false if one is not finite.
template <class CoefficientsOf>
bool TaylorEvaluator::write_targets(int equation, SeriesOrders orders, double* F_xdot, double* F_x,
                                    CoefficientsOf coefficients_of) const {
  const std::size_t m = index(record_->m()), area = m * index(record_->n());
  bool finite = true;
  for (std::size_t e = tape_.first_target[index(equation)]; e < tape_.first_target[index(equation + 1)]; ++e) {
    const Tape::Variable& leaf = tape_.targets[e];
    const double* const from = coefficients_of(e);
    const int order = leaf.derivative ? orders.F_xdot : orders.F_x;
    if (order < 0) continue;  // there is no array either
    double* const to = (leaf.derivative ? F_xdot : F_x) + index(equation) + index(leaf.unknown) * m;
    for (int k = 0; k <= order; ++k) {
      to[index(k) * area] = from[k];
      finite = finite && std::isfinite(from[k]);
    }
  }
  return finite;
}

bool TaylorEvaluator::fail(int equation, int order, int order_of_gradients) {
  failed_ = {equation, order, order_of_gradients};
  return false;
}

}  // namespace sfdae::core
