// SPDX-License-Identifier: BSD-3-Clause
// Equations written with operators, for tests and benchmarks of what lies behind the C API.
#ifndef SFDAE_TESTS_RECORDED_H
#define SFDAE_TESTS_RECORDED_H

#include <memory>
#include <utility>
#include <vector>

#include "expression/recorder.h"

namespace sfdae_test {

using sfdae::core::Operation;
using sfdae::core::Record;
using sfdae::core::Recorder;

// A node of a recorder; a plain number while it has none.
struct Term {
  Term(double number = 0.0) : value(number) {}
  Term(Recorder* owner, int index) : recorder(owner), node(index) {}
  Recorder* recorder = nullptr;
  int node = -1;
  double value = 0.0;
  int in(Recorder& owner) const { return recorder != nullptr ? node : owner.constant(value); }
};

// At least one of the operands belongs to a recorder.
inline Term apply(Operation operation, const Term& a, const Term& b) {
  Recorder& recorder = *(a.recorder != nullptr ? a.recorder : b.recorder);
  const int left = a.in(recorder), right = b.in(recorder);
  return {&recorder, recorder.apply(operation, left, right)};
}
inline Term apply(Operation operation, const Term& a) { return {a.recorder, a.recorder->apply(operation, a.node)}; }

inline Term operator+(const Term& a, const Term& b) { return apply(Operation::add, a, b); }
inline Term operator-(const Term& a, const Term& b) { return apply(Operation::subtract, a, b); }
inline Term operator*(const Term& a, const Term& b) { return apply(Operation::multiply, a, b); }
inline Term operator/(const Term& a, const Term& b) { return apply(Operation::divide, a, b); }
inline Term operator-(const Term& a) { return apply(Operation::negate, a); }
inline Term pow(const Term& a, const Term& b) { return apply(Operation::power, a, b); }
inline Term atan2(const Term& a, const Term& b) { return apply(Operation::atan2, a, b); }
inline Term sqrt(const Term& a) { return apply(Operation::sqrt, a); }
inline Term exp(const Term& a) { return apply(Operation::exp, a); }
inline Term log(const Term& a) { return apply(Operation::log, a); }
inline Term log10(const Term& a) { return apply(Operation::log10, a); }
inline Term sin(const Term& a) { return apply(Operation::sin, a); }
inline Term cos(const Term& a) { return apply(Operation::cos, a); }
inline Term tan(const Term& a) { return apply(Operation::tan, a); }
inline Term asin(const Term& a) { return apply(Operation::asin, a); }
inline Term acos(const Term& a) { return apply(Operation::acos, a); }
inline Term atan(const Term& a) { return apply(Operation::atan, a); }
inline Term sinh(const Term& a) { return apply(Operation::sinh, a); }
inline Term cosh(const Term& a) { return apply(Operation::cosh, a); }
inline Term tanh(const Term& a) { return apply(Operation::tanh, a); }
inline Term floor(const Term& a) { return apply(Operation::floor, a); }
inline Term modulo(const Term& a, const Term& b) { return apply(Operation::modulo, a, b); }
inline Term abs(const Term& a) { return {a.recorder, a.recorder->abs(a.node)}; }
inline Term min(const Term& a, const Term& b) { return {a.recorder, a.recorder->min(a.node, b.in(*a.recorder))}; }
inline Term max(const Term& a, const Term& b) { return {a.recorder, a.recorder->max(a.node, b.in(*a.recorder))}; }
inline Term choose(const Term& c, const Term& a, const Term& b) {
  Recorder& recorder = *c.recorder;
  const int chosen = a.in(recorder), otherwise = b.in(recorder);
  return {&recorder, recorder.apply(Operation::choose, c.node, chosen, otherwise)};
}

// The function, or its derivative by the arguments `by`, at arguments at least one of which belongs to a recorder.
inline Term call(const std::shared_ptr<const sfdae::core::PointFunction>& function,
                 const std::vector<Term>& arguments, std::vector<int> by = {}) {
  Recorder& recorder = *arguments.front().recorder;
  sfdae::core::FunctionCall call{function, {}, std::move(by)};
  for (const Term& argument : arguments) call.arguments.push_back(argument.in(recorder));
  return {&recorder, recorder.call(call)};
}

// Unknowns, their derivatives and time of equations that are being recorded.
struct Recording {
  explicit Recording(int n) : recorder(n), t(&recorder, recorder.time()) {
    for (int j = 0; j < n; ++j) {
      x.push_back({&recorder, recorder.unknown(j)});
      xdot.push_back({&recorder, recorder.derivative(j)});
    }
  }
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  Term parameter(const std::string& name, double value) { return {&recorder, recorder.parameter(name, value)}; }

  std::shared_ptr<const Record> finish(const std::vector<Term>& residuals) {
    std::vector<int> nodes;
    for (const Term& residual : residuals) nodes.push_back(residual.in(recorder));
    return recorder.finish(nodes);
  }

  Recorder recorder;
  Term t;
  std::vector<Term> x, xdot;
};

}  // namespace sfdae_test

#endif
