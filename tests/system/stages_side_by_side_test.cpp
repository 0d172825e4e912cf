// SPDX-License-Identifier: BSD-3-Clause
// Stages of recorded equations side by side are those that are solved for one after the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "array/nonlinear_system.h"
#include "instruction_sets.h"
#include "integrate/radau_method.h"
#include "nonlinear_examples.h"

namespace sfdae::core {
namespace {

using namespace sfdae_test;
using Values = std::vector<double>;

// The same equations, for which there are no lanes.
class OneByOne final : public NonlinearProblem {
 public:
  explicit OneByOne(std::shared_ptr<const Record> record)
      : NonlinearProblem(record->m(), record->n(), {}), evaluator_(std::move(record)) {}

 protected:
  CallbackError evaluate_values(double t, const double* jet, int order, double* F) override {
    return result(evaluator_.values(t, jet, order, F));
  }
  CallbackError evaluate_gradients(double t, const double* jet, Orders orders, TaylorData& data) override {
    return result(evaluator_.gradients(t, jet, {orders.f, orders.E, orders.A}, orders.f >= 0 ? data.f(0) : nullptr,
                                       orders.E >= 0 ? data.E(0).data : nullptr,
                                       orders.A >= 0 ? data.A(0).data : nullptr, &data.differentiations));
  }

 private:
  static CallbackError result(bool is_good) {
    CallbackError error;
    if (!is_good) error.status = SFDAE_NOT_FINITE;
    return error;
  }
  TaylorEvaluator evaluator_;
};

struct StageCase {
  std::string name;
  RecordPointer record;
  Values x0;
  double h;
  int mu;
};

// Pendula of mass `mass`, each pulled by the next one: mu = 2, 5 unknowns each. Light ones have large multipliers.
StageCase pendula(int count, double mass) {
  Recording r(5 * count);
  std::vector<Term> F;
  StageCase result{std::to_string(count) + " pendula of mass " + std::to_string(mass), nullptr, {}, 0.04, 2};
  for (int k = 0; k < count; ++k) {
    const auto x = [&](int i) { return r.x[index((5 * k + i) % (5 * count))]; };
    const auto slope = [&](int i) { return r.xdot[index(5 * k + i)]; };
    F.push_back(slope(0) - x(2));
    F.push_back(slope(1) - x(3));
    F.push_back(mass * (slope(2) + 0.3 * sin(x(0) - (count > 1 ? x(5) : Term(0.0)))) + x(4) * x(0));
    F.push_back(mass * (slope(3) + 9.81) + x(4) * x(1));
    F.push_back(x(0) * x(0) + x(1) * x(1) - 1.0);
    const double angle = 0.4 + 0.2 * k, c = std::cos(angle), s = std::sin(angle);
    result.x0.insert(result.x0.end(), {s, -c, 0.5 * c, 0.5 * s, mass * 9.81});
  }
  result.record = r.finish(F);
  return result;
}

// x1 = sin t through the second derivative of a constraint: no differential equations.
StageCase without_dynamics() {
  Recording r(3);
  return {"no dynamics",
          r.finish({r.xdot[0] - r.x[1], r.xdot[1] - r.x[2] - r.x[0] * r.x[1], r.x[0] - sin(r.t)}),
          {0.0, 1.0, 0.0},
          0.1,
          2};
}

std::vector<StageCase> stage_cases() {
  return {{"hyperbola", record_of_hyperbola(), {1.0, 1.0}, 0.3, 0},
          without_dynamics(),
          pendula(1, 1.0),
          pendula(1, 1e-3),
          pendula(3, 1.0),
          pendula(3, 1e-3)};
}

struct Solved {
  PointStatus status;
  Values x;
  long evaluations;
  bool has_reflections = false;
};

// Two steps of size h from constant guesses.
Solved solve(const StageCase& given, std::unique_ptr<NonlinearProblem> problem, int stages) {
  NonlinearExample e(given.record);
  if (problem) e.problem = std::move(problem);
  e.analyze(0.0, 1.0, given.x0);
  EXPECT_EQ(e.analysis.values.mu, given.mu) << given.name;
  const std::size_t block = e.system->jet().x.size(), n = given.x0.size(), s = index(stages);
  const long before = e.problem->evaluations();
  Solved result{PointStatus::ok, Values(n * s), 0};
  for (int k = 0; k < 2 && result.status == PointStatus::ok; ++k) {
    const Values start(e.system->jet().x.begin(), e.system->jet().x.end());
    Values taylor, weights(n, 1e10), w(n * s);
    for (std::size_t i = 0; i < s; ++i) taylor.insert(taylor.end(), start.begin(), start.end());
    taylor.resize(block * s);
    double reached = 0.0;
    const StageEquations equations{radau_method(stages).stages,
                                   k * given.h,
                                   (k + 1) * given.h,
                                   start.data(),
                                   start.data(),
                                   {taylor.data(), start.data(), weights.data()}};
    EXPECT_EQ(e.system->move_to((k + 1) * given.h), PointStatus::ok);
    result.status = e.system->solve_stages(equations, result.x.data(), w.data(), reached);
    if (result.status == PointStatus::ok) e.system->accept();
  }
  result.evaluations = e.problem->evaluations() - before;
  for (int i = 0; i <= given.mu; ++i)
    if (e.system->linearization().elimination().stage(i).by_reflections) result.has_reflections = true;
  return result;
}

// Iterations end by the same decisions, so that rounding is all that is left; multipliers are divided by masses.
TEST(StagesSideBySide, AreThoseOneByOne) {
  bool has_reflections = false;
  for (const StageCase& given : stage_cases())
    for (const int stages : {3, 5, 7}) {
      const Solved expected = solve(given, std::make_unique<OneByOne>(given.record), stages);
      ASSERT_EQ(expected.status, PointStatus::ok) << given.name << ", " << stages;
      Values first;
      for_each_instruction_set([&](InstructionSet) {
        const Solved found = solve(given, nullptr, stages);
        ASSERT_EQ(found.status, PointStatus::ok) << given.name << ", " << stages;
        EXPECT_EQ(found.evaluations, expected.evaluations) << given.name << ", " << stages;
        for (std::size_t i = 0; i < found.x.size(); ++i)
          EXPECT_NEAR(found.x[i], expected.x[i], 1e-11 * std::max(1.0, std::fabs(expected.x[i])))
              << given.name << ", " << stages << ", entry " << i;
        if (first.empty()) first = found.x;
        EXPECT_EQ(found.x, first) << given.name << ", " << stages;  // to the last bit
        has_reflections = has_reflections || found.has_reflections;
      });
    }
  EXPECT_TRUE(has_reflections);  // the rarer way of an elimination is among them
}

// A stage where the equations do not exist is found, and named, one by one.
TEST(StagesSideBySide, AreLeftWhereLanesCannotBeEvaluated) {
  Recording r(2);
  // x1 = 1 - 20 t leaves the domain of the logarithm within the step.
  const StageCase given{
      "logarithm", r.finish({r.xdot[0] + 20.0, r.x[1] - log(r.x[0] - 0.5)}), {1.0, std::log(0.5)}, 0.1, 0};
  EXPECT_EQ(solve(given, nullptr, 3).status, PointStatus::callback_error);
  EXPECT_EQ(solve(given, std::make_unique<OneByOne>(given.record), 3).status, PointStatus::callback_error);
}

}  // namespace
}  // namespace sfdae::core
