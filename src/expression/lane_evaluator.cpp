// Recorded equations at several points in one pass of their tape.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/lane_evaluator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "expression/execution.h"
#include "expression/kernel.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

using series::Fixed;

template <class Order>
void add(const Lanes* a, const Lanes* b, Lanes* v, Order K) {
  for (int k = 0; k <= K; ++k) v[k] = a[k] + b[k];
}

template <class Order>
void subtract(const Lanes* a, const Lanes* b, Lanes* v, Order K) {
  for (int k = 0; k <= K; ++k) v[k] = a[k] - b[k];
}

template <class Order>
void scale(const Lanes* a, const Lanes* b, Lanes* v, Order K) {
  for (int k = 0; k <= K; ++k) v[k] = b[0] * a[k];
}

template <class Order>
void multiply(const Lanes* a, const Lanes* b, Lanes* v, Order K) {
  for (int k = 0; k <= K; ++k) {
    Lanes sum = a[0] * b[k];
    for (int j = 1; j <= k; ++j) sum += a[j] * b[k - j];
    v[k] = sum;
  }
}

// The arguments of a function and the derivatives by them lie side by side.
template <bool with_slopes, class Order>
[[gnu::noinline]] void execute_function_singly(const Instruction& given, Lanes* slots, Order K) {
  constexpr int size = LaneEvaluator::highest_order + 1;
  const FunctionCall& call = *given.call;
  const int k = call.function->num_arguments();
  const std::ptrdiff_t stride = given.b - given.a;
  double arguments[PointFunction::max_arguments * size], slopes[PointFunction::max_arguments * size], value[size];
  for (int l = 0; l < lane_count; ++l) {
    for (int i = 0; i < k; ++i)
      for (int j = 0; j <= K; ++j) arguments[i * size + j] = slots[given.a + i * stride + j][l];
    evaluate(call, {arguments, size, value, with_slopes ? slopes : nullptr}, K);
    for (int j = 0; j <= K; ++j) slots[given.v + j][l] = value[j];
    if constexpr (with_slopes)
      for (int i = 0; i < k; ++i)
        for (int j = 0; j <= K; ++j) slots[given.p + i * stride + j][l] = slopes[i * size + j];
  }
}

// Unused lanes repeat the last point; operations that run lane by lane skip them.
bool repeats_lane_before(const Lanes& values, int l) {
  const LaneMask& bits = reinterpret_cast<const LaneMask&>(values);
  return l > 0 && bits[l] == bits[l - 1];
}

template <class Function>
void apply_to_each(const Lanes& a, Lanes& v, Function function) {
  for (int l = 0; l < lane_count; ++l) v[l] = repeats_lane_before(a, l) ? v[l - 1] : function(a[l]);
}

// Executes the points one by one, as TaylorEvaluator does. Slot 0 is a leaf: a result there means none. Not inlined
// into each of the passes, as that took the compiler a minute.
template <bool with_slopes, class Order>
[[gnu::noinline]] void execute_singly(const Instruction& given, Lanes* slots, Order K) {
  if (given.code == Code::function) return execute_function_singly<with_slopes>(given, slots, K);
  constexpr int size = LaneEvaluator::highest_order + 1;
  const Instruction own{given.code, 0, size, 2 * size, 3 * size, 4 * size, 5 * size};
  const int from[] = {given.v, given.a, given.b, given.c, given.p, given.q};
  double series[6 * size] = {};
  for (int l = 0; l < lane_count; ++l) {
    bool is_repeated = true;
    for (int i = 1; i < 4; ++i)
      for (int k = 0; k <= K; ++k) is_repeated = is_repeated && repeats_lane_before(slots[from[i] + k], l);
    if (!is_repeated) {
      for (int i = 0; i < 6; ++i)
        for (int k = 0; k <= K; ++k) series[i * size + k] = slots[from[i] + k][l];
      execute<with_slopes>(own, series, K);
    }
    for (const int i : {0, 4, 5})
      if (from[i] != 0)
        for (int k = 0; k <= K; ++k) slots[from[i] + k][l] = series[i * size + k];
  }
}

template <class Order>
bool divide(const Lanes* a, const Lanes* b, Lanes* v, Order K) {
  if (any(b[0] == 0.0)) return false;
  for (int k = 0; k <= K; ++k) {
    Lanes sum = a[k];
    for (int j = 1; j <= k; ++j) sum -= b[j] * v[k - j];
    v[k] = sum / b[0];
  }
  return true;
}

template <class Order>
bool sqrt(const Lanes* a, Lanes* v, Order K) {
  if (!all(a[0] > 0.0)) return false;
  apply_to_each(a[0], v[0], [](double x) { return std::sqrt(x); });
  for (int k = 1; k <= K; ++k) {
    Lanes sum = a[k];
    for (int j = 1; j < k; ++j) sum -= v[j] * v[k - j];
    v[k] = sum / (2.0 * v[0]);
  }
  return true;
}

template <class Order>
bool sin_cos(const Lanes* a, Lanes* s, Lanes* c, Order K) {
  LaneMask bad{};
  note_not_finite(a[0], bad);
  if (any(bad)) return false;
  for (int l = 0; l < lane_count; ++l) {
    const bool is_repeated = repeats_lane_before(a[0], l);
    const double x = a[0][l], sine = is_repeated ? s[0][l - 1] : std::sin(x);
    const double cosine = is_repeated ? c[0][l - 1] : std::cos(x);
    s[0][l] = sine;
    c[0][l] = cosine;
  }
  for (int k = 1; k <= K; ++k) {
    Lanes sum_s{}, sum_c{};
    for (int j = 1; j <= k; ++j) {
      const Lanes change = static_cast<double>(j) * a[j];
      sum_s += change * c[k - j];
      sum_c -= change * s[k - j];
    }
    s[k] = sum_s / static_cast<double>(k);
    c[k] = sum_c / static_cast<double>(k);
  }
  return true;
}

// Larger arguments overflow, and each point is checked by itself.
template <class Order>
bool exp(const Lanes* a, Lanes* v, Order K) {
  constexpr double largest_argument = 709.0;
  if (!all(a[0] <= largest_argument)) return false;
  apply_to_each(a[0], v[0], [](double x) { return std::exp(x); });
  for (int k = 1; k <= K; ++k) {
    Lanes sum{};
    for (int j = 1; j <= k; ++j) sum += static_cast<double>(j) * a[j] * v[k - j];
    v[k] = sum / static_cast<double>(k);
  }
  return true;
}

template <class Order>
bool choose(const Lanes* a, const Lanes* b, const Lanes* c, Lanes* v, Order K) {
  LaneMask bad{};
  note_not_finite(a[0], bad);
  if (any(bad)) return false;
  const Lanes condition = a[0];
  for (int k = 0; k <= K; ++k) {
    const Lanes if_positive = b[k], otherwise = c[k];
    v[k] = condition > 0.0 ? if_positive : otherwise;
  }
  return true;
}

// v = c / b
template <class Order>
void reciprocal(double c, const Lanes* b, Lanes* v, Order K) {
  v[0] = c / b[0];
  for (int k = 1; k <= K; ++k) {
    Lanes sum{};
    for (int j = 1; j <= k; ++j) sum -= b[j] * v[k - j];
    v[k] = sum / b[0];
  }
}

// Same operations in the same order as execute(). Returns false if lanes have to be checked one by one.
template <bool with_slopes, class Order>
bool execute_together(const Instruction& instruction, Lanes* slots, Order K) {
  const Lanes* const a = slots + instruction.a;
  const Lanes* const b = slots + instruction.b;
  Lanes* const v = slots + instruction.v;
  Lanes* const p = slots + instruction.p;
  switch (instruction.code) {
    case Code::negate:
      for (int k = 0; k <= K; ++k) v[k] = -a[k];
      return true;
    case Code::copy:
      for (int k = 0; k <= K; ++k) v[k] = a[k];
      return true;
    case Code::divide:
      if (!divide(a, b, v, K)) return false;
      if constexpr (with_slopes) {
        reciprocal(1.0, b, p, K);
        multiply(v, p, slots + instruction.q, K);
      }
      return true;
    case Code::divide_by_number:
      if (any(b[0] == 0.0)) return false;
      for (int k = 0; k <= K; ++k) v[k] = a[k] / b[0];
      if constexpr (with_slopes) p[0] = 1.0 / b[0];
      return true;
    case Code::sqrt:
      if (!sqrt(a, v, K)) return false;
      if constexpr (with_slopes) reciprocal(0.5, v, p, K);
      return true;
    case Code::exp: return exp(a, v, K);
    case Code::choose: return choose(a, b, slots + instruction.c, v, K);
    case Code::sin_cos: return sin_cos(a, v, p, K);
    default: return false;
  }
}

template <bool with_slopes, class Order>
void execute_all(const InstructionList& list, Lanes* slots, Order K) {
  const auto binary = [K](auto code, auto a, auto b, auto v) {
    if constexpr (code == Code::add) add(a, b, v, K);
    else if constexpr (code == Code::subtract) subtract(a, b, v, K);
    else if constexpr (code == Code::multiply) multiply(a, b, v, K);
    else scale(a, b, v, K);
  };
  execute_list(list, slots, binary, [slots, K](const Instruction& other) {
    if (!execute_together<with_slopes>(other, slots, K)) execute_singly<with_slopes>(other, slots, K);
  });
}

// Contribution of an edge, as in edges.h.
template <class Order>
void hand_on(const Edge& edge, const Lanes* from, const Lanes* factor, Lanes* handed, Order K) {
  std::copy_n(from, K + 1, handed);
  switch (edge.code) {
    case EdgeCode::pass: return;
    case EdgeCode::negate:
      for (int k = 0; k <= K; ++k) handed[k] = -from[k];
      return;
    case EdgeCode::multiply:
    case EdgeCode::multiply_negated:
      if (edge.from_number)
        for (int k = 0; k <= K; ++k) handed[k] = from[0] * factor[k];
      else multiply(from, factor, handed, K);
      if (edge.code == EdgeCode::multiply_negated)
        for (int k = 0; k <= K; ++k) handed[k] = -handed[k];
      return;
    case EdgeCode::scale:
      for (int k = 0; k <= K; ++k) handed[k] = factor[0] * from[k];
      return;
    case EdgeCode::pass_if_positive:
      for (int k = 0; k <= K; ++k) handed[k] = factor[0] > 0.0 ? from[k] : Lanes{};
      return;
    case EdgeCode::pass_otherwise:
      for (int k = 0; k <= K; ++k) handed[k] = factor[0] > 0.0 ? Lanes{} : from[k];
      return;
  }
}

// Adjoints have K + 1 coefficients each. with_choices: as in edges.h.
template <bool with_choices, class Order>
void follow(const Tape::EdgesOfEquation& edges, const Lanes* slots, Lanes* adjoints, Order K) {
  for (const Edge* edge = edges.first; edge != edges.last; ++edge) {
    const Lanes* const from = adjoints + edge->from * (K + 1);
    Lanes* const to = adjoints + edge->to * (K + 1);
    Lanes handed[LaneEvaluator::highest_order + 1];
    hand_on(*edge, from, slots + edges.factors[edge->factor], handed, K);
    if constexpr (with_choices) {
      LaneMask vanishes = from[0] == 0.0;
      for (int k = 1; k <= K; ++k) vanishes &= from[k] == 0.0;
      for (int k = 0; k <= K; ++k) handed[k] = vanishes ? Lanes{} : handed[k];
    }
    if (edge->is_first) std::copy_n(handed, K + 1, to);
    else
      for (int k = 0; k <= K; ++k) to[k] += handed[k];
  }
}

struct Pass {
  const Tape& tape;
  const InstructionList *of_parameters, *of_time;  // null: nothing to be done
  const InstructionList& of_state;
  const InstructionsByOrder& by_order;  // in place of of_state, unless it is empty
  const std::vector<int>& factors;
  const LaneEvaluator::Points& points;
  int stride, order;
  bool with_gradients;
  const int* limits;        // of the orders of gradients; null: 0
  const int* value_limits;  // of equations, by_order was made for them; null: the order
  Lanes *slots, *adjoints, *gradients;
  bool is_finite;
};

// The gradient of equation i, `length` places for each of its derivatives.
template <class Order>
void sweep_back(const Pass& pass, std::size_t i, int length, LaneMask& bad, Order K) {
  const Tape& tape = pass.tape;
  pass.adjoints[0] = Lanes{} + 1.0;
  for (int k = 1; k <= K; ++k) pass.adjoints[k] = Lanes{};
  const Tape::EdgesOfEquation edges = tape.edges_of(i, tape.edges, pass.factors);
  if (tape.has_choices) follow<true>(edges, pass.slots, pass.adjoints, K);
  else follow<false>(edges, pass.slots, pass.adjoints, K);
  const int* adjoint = tape.adjoints_of_targets(i);
  for (std::size_t e = tape.first_target[i]; e < tape.first_target[i + 1]; ++e, ++adjoint)
    for (int k = 0; k <= K; ++k) {
      const Lanes entry = pass.adjoints[*adjoint * (K + 1) + k];
      note_not_finite(entry, bad);
      pass.gradients[e * index(length) + index(k)] = entry;
    }
}

void sweep_back_all(const Pass& pass, LaneMask& bad) {
  const int length = pass.limits == nullptr ? 1 : pass.order + 1;
  for (std::size_t i = 0; i < pass.tape.residuals.size(); ++i) {
    switch (pass.limits == nullptr ? 0 : std::min(pass.order, pass.limits[i])) {
      case 0: sweep_back(pass, i, length, bad, Fixed<0>()); break;
      case 1: sweep_back(pass, i, length, bad, Fixed<1>()); break;
      default: sweep_back(pass, i, length, bad, Fixed<2>());
    }
  }
}

void load(const Pass& pass, LaneMask& bad) {
  for (std::size_t i = 0; i < pass.tape.leaves.size(); ++i) {
    const Tape::Leaf& leaf = pass.tape.leaves[i];
    const int order = pass.value_limits == nullptr ? pass.order : pass.by_order.of_leaves[i];
    for (int k = 0; k <= order; ++k) {
      const Lanes x = leaf.derivative ? (k + 1) * lanes(pass.points.x[index(k + 1)][leaf.unknown])
                                      : lanes(pass.points.x[index(k)][leaf.unknown]);
      note_not_finite(x, bad);
      pass.slots[leaf.slot * pass.stride + k] = x;
    }
  }
}

void load_time(const Pass& pass, LaneMask& bad) {
  const Lanes& t = lanes(*pass.points.t);
  note_not_finite(t, bad);
  if (pass.tape.time < 0) return;
  pass.slots[pass.tape.time * pass.stride] = t;
  if (pass.order > 0) pass.slots[pass.tape.time * pass.stride + 1] = Lanes{} + 1.0;
}

// A list of instructions, and the order of the coefficients that it is executed for.
struct Task {
  const InstructionList* list;
  int order;
  bool with_slopes;
};
// The lists of parameters, of time, and of the state by orders.
struct Tasks {
  std::array<Task, LaneEvaluator::highest_order + 3> list;
  std::size_t count = 0;
  void add(const Task& task) { list[count++] = task; }
};

Tasks tasks_of(const Pass& pass) {
  Tasks tasks;
  if (pass.of_parameters != nullptr) tasks.add({pass.of_parameters, 0, false});
  if (pass.of_time != nullptr) tasks.add({pass.of_time, pass.order, false});
  if (pass.by_order.lists.empty()) tasks.add({&pass.of_state, pass.order, pass.with_gradients});
  pass.by_order.for_each([&](const InstructionList& list, int order) {
    tasks.add({&list, pass.value_limits == nullptr ? pass.order : std::min(order, pass.order), pass.with_gradients});
  });
  return tasks;
}

// Inlines everything, once for each instruction set (SFDAE_LANE_KERNEL). execute_all has one call for each order, with
// and without slopes, as the compiler takes seconds for each of them.
void execute_tasks(const Tasks& tasks, Lanes* slots) {
  for (std::size_t i = 0; i < tasks.count; ++i) {
    const auto& [list, order, with_slopes] = tasks.list[i];
    switch (2 * order + (with_slopes ? 1 : 0)) {
      case 0: execute_all<false>(*list, slots, Fixed<0>()); break;
      case 1: execute_all<true>(*list, slots, Fixed<0>()); break;
      case 2: execute_all<false>(*list, slots, Fixed<1>()); break;
      case 3: execute_all<true>(*list, slots, Fixed<1>()); break;
      case 4: execute_all<false>(*list, slots, Fixed<2>()); break;
      default: execute_all<true>(*list, slots, Fixed<2>());
    }
  }
}

void evaluate_pass(Pass& pass) {
  LaneMask bad{};
  if (pass.of_time != nullptr) load_time(pass, bad);
  load(pass, bad);
  pass.is_finite = !any(bad);
  if (!pass.is_finite) return;
  execute_tasks(tasks_of(pass), pass.slots);
  for (std::size_t i = 0; i < pass.tape.residuals.size(); ++i) {
    const int order = pass.value_limits == nullptr ? pass.order : pass.value_limits[i];
    for (int k = 0; k <= order; ++k) note_not_finite(pass.slots[pass.tape.residuals[i] * pass.stride + k], bad);
  }
  if (pass.with_gradients) sweep_back_all(pass, bad);
  pass.is_finite = !any(bad);
}
SFDAE_LANE_KERNEL(evaluate_pass, Pass)

}  // namespace

bool LaneEvaluator::evaluate(const TaylorEvaluator& source, const Points& points, int order, bool with_gradients) {
  reserve(source, order, limits_);
  return evaluate_all(source, points, {order, with_gradients, nullptr, false});
}

bool LaneEvaluator::evaluate_entries(const TaylorEvaluator& source, const Points& points, int order,
                                     const std::vector<int>& limits) {
  reserve(source, order, limits_);
  return evaluate_all(source, points, {order, true, limits.data(), false});
}

bool LaneEvaluator::evaluate_within(const TaylorEvaluator& source, const Points& points,
                                    const std::shared_ptr<const OrderLimits>& limits, bool with_gradients) {
  reserve(source, limits->highest, limits);
  return evaluate_all(source, points, {limits->highest, with_gradients, limits->of_equations.data(), true});
}

bool LaneEvaluator::evaluate_all(const TaylorEvaluator& source, const Points& points, const Wanted& wanted) {
  const int order = wanted.order;
  assert(order >= 0 && order <= highest_order);
  const QuietArithmetic quiet;
  const bool has_new_parameters = parameters_are_new(source);
  const bool has_new_time = has_new_parameters || order > time_order_ || std::memcmp(&t_, points.t, sizeof t_) != 0;
  Pass pass{source.tape(),
            has_new_parameters ? &of_parameters_ : nullptr,
            has_new_time ? &of_time_ : nullptr,
            of_state_,
            by_order_,
            factors_,
            points,
            stride_,
            order,
            wanted.with_gradients,
            wanted.limits,
            wanted.are_values_within ? wanted.limits : nullptr,
            to_lanes(slots_),
            to_lanes(adjoints_),
            to_lanes(gradients_),
            true};
  run_evaluate_pass(pass);
  if (has_new_time) {
    t_ = *points.t;
    time_order_ = pass.is_finite ? order : -1;
  }
  return pass.is_finite;
}

// Allocates series of this order in every slot.
void LaneEvaluator::reserve(const TaylorEvaluator& source, int order,
                            const std::shared_ptr<const OrderLimits>& limits) {
  // Other extensions of the same equations may have limits of their own, which are the same as a rule.
  const bool are_same = limits == limits_ || (limits && limits_ && limits->of_equations == limits_->of_equations);
  if (order < stride_ && are_same) return;
  const Tape& tape = source.tape();
  const int stride = std::max(order + 1, stride_);
  stride_ = 0;  // until there is memory for all
  LaneArray slots(index(tape.num_slots) * index(stride) + 1), adjoints(index(tape.num_adjoints) * index(stride)),
      gradients(tape.targets.size() * index(stride) + 1);
  of_parameters_ = tape.of_parameters.in_offsets(stride);
  of_time_ = tape.of_time.in_offsets(stride);
  of_state_ = limits ? InstructionList() : tape.of_state.in_offsets(stride);
  by_order_ = limits ? InstructionsByOrder(tape, *limits) : InstructionsByOrder();
  if (limits) by_order_.to_offsets(tape, source.record().n(), stride);
  factors_ = tape.factors;
  values_ = tape.residuals;
  for (auto* slots_of : {&factors_, &values_})
    for (int& slot : *slots_of) slot *= stride;
  for (const Tape::Number& constant : tape.constants)
    lanes(slots[index(constant.slot * stride)]) = Lanes{} + source.record().constant(constant.index);
  slots_ = std::move(slots);
  adjoints_ = std::move(adjoints);
  gradients_ = std::move(gradients);
  parameters_.resize(tape.parameters.size());
  time_order_ = -1;
  limits_ = limits;
  stride_ = stride;
}

// Loads the parameters that the equations depend on. Returns whether any has changed.
bool LaneEvaluator::parameters_are_new(const TaylorEvaluator& source) {
  const std::vector<Tape::Number>& used = source.tape().parameters;
  const bool is_first = time_order_ < 0;
  bool is_new = is_first;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const double value = source.parameter(used[i].index);
    if (!is_first && value == parameters_[i]) continue;
    is_new = true;
    parameters_[i] = value;
    lanes(slots_[index(used[i].slot * stride_)]) = Lanes{} + value;
  }
  return is_new;
}

}  // namespace sfdae::core
