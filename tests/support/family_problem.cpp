// SPDX-License-Identifier: BSD-3-Clause
#include "family_problem.h"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <utility>

namespace sfdae_test {

namespace {

std::size_t size(int i) { return static_cast<std::size_t>(i); }

}  // namespace

std::function<int(const Call&)> return_at_call(long number, int status) {
  return [=](const Call& call) { return call.number == number ? status : 0; };
}

std::function<int(const Call&)> return_behind(double t, int status) {
  return [=](const Call& call) { return call.t > t ? status : 0; };
}

std::function<void(const Call&, std::span<double>)> poison_behind(double t, double value) {
  return [=](const Call& call, std::span<double> values) {
    if (call.t > t) values[0] = value;
  };
}

FamilyProblem::FamilyProblem(std::shared_ptr<const LinearFamily> family, CallbackHooks hooks_wanted)
    : problem{}, hooks(std::move(hooks_wanted)), family_(std::move(family)) {
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = family_->m();
  problem.num_unknowns = family_->n();
  problem.E = call_E;
  problem.A = call_A;
  problem.f = call_f;
  problem.user = this;
  matrices_.expected_order = vectors_.expected_order = std::min(family_->values().mu + 1, max_family_order);
}

void FamilyProblem::declare_constants() {
  problem.constant_E = family_->constant_E() ? 1 : 0;
  problem.constant_A = family_->constant_A() ? 1 : 0;
}

long FamilyProblem::calls(Callback function) const {
  const auto& counts = counts_[static_cast<std::size_t>(function)];
  return std::accumulate(counts.begin(), counts.end(), 0L);
}

long FamilyProblem::calls(Callback function, int order) const {
  return counts_[static_cast<std::size_t>(function)][size(std::clamp(order, 0, max_family_order + 1))];
}

void FamilyProblem::reset_counts() {
  counts_ = {};
  count_ = 0;
  highest_order_asked_ = -1;
  seconds_ = 0.0;
}

int FamilyProblem::call_E(double t, int order, double* out, void* user) {
  return static_cast<FamilyProblem*>(user)->call(Callback::E, t, order, out);
}
int FamilyProblem::call_A(double t, int order, double* out, void* user) {
  return static_cast<FamilyProblem*>(user)->call(Callback::A, t, order, out);
}
int FamilyProblem::call_f(double t, int order, double* out, void* user) {
  return static_cast<FamilyProblem*>(user)->call(Callback::f, t, order, out);
}

int FamilyProblem::call(Callback function, double t, int order, double* out) {
  ++counts_[static_cast<std::size_t>(function)][size(std::clamp(order, 0, max_family_order + 1))];
  ++count_;
  highest_order_asked_ = std::max(highest_order_asked_, order);
  const Call call{function, t, order, count_};
  if (!hooks.measure_time) return evaluate(call, out);

  const auto start = std::chrono::steady_clock::now();
  const int status = evaluate(call, out);
  seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return status;
}

int FamilyProblem::evaluate(const Call& call, double* out) {
  if (hooks.status) {
    const int status = hooks.status(call);
    if (status != 0) return status;
  }
  if (call.order > std::min(hooks.highest_order, max_family_order)) return SFDAE_ORDER_NOT_AVAILABLE;
  const std::span<const double> values = derivative(call.function, call.t, call.order);
  std::copy(values.begin(), values.end(), out);
  if (hooks.tamper) hooks.tamper(call, {out, values.size()});
  return 0;
}

std::span<const double> FamilyProblem::derivative(Callback function, double t, int order) {
  const bool matrices = function != Callback::f;
  if (matrices && family_->constant_E() && family_->constant_A()) t = 0.0;  // one slot serves all points
  const Slot& values = slot(matrices ? matrices_ : vectors_, t, order, matrices);
  const std::size_t length = size(m()) * (matrices ? size(n()) : 1);
  const std::vector<double>& all = values.values[function == Callback::A ? 1 : 0];
  return {all.data() + size(order) * length, length};
}

const FamilyProblem::Slot& FamilyProblem::slot(Cache& cache, double t, int order, bool matrices) {
  if (t != cache.asked_t && cache.asked_order >= 0) {
    cache.expected_order = cache.asked_order;
    cache.asked_order = -1;
  }
  cache.asked_t = t;
  cache.asked_order = std::max(cache.asked_order, order);

  for (Slot& known : cache.slots) {
    if (known.t != t || known.order < 0) continue;
    if (known.order < order) {
      known.order = order;
      build(known, matrices);
    }
    return known;
  }
  Slot& fresh = cache.slots[cache.oldest];
  cache.oldest = (cache.oldest + 1) % cache.slots.size();
  fresh.t = t;
  fresh.order = std::max(order, cache.expected_order);
  build(fresh, matrices);
  return fresh;
}

void FamilyProblem::build(Slot& slot, bool matrices) const {
  const std::size_t length = size(m()) * (matrices ? size(n()) : 1);
  for (auto& values : slot.values) values.resize(length * size(slot.order + 1));
  if (matrices) family_->matrix_coefficients(slot.t, slot.order, slot.values[0].data(), slot.values[1].data());
  else family_->vector_coefficients(slot.t, slot.order, slot.values[0].data());

  for (auto& values : slot.values)
    for (int k = 2; k <= slot.order; ++k)
      for (std::size_t i = 0; i < length; ++i) values[size(k) * length + i] *= factorial(k);
}

}  // namespace sfdae_test
