// Memory that is missing: the call says so, and the handle is as good as before.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

#include "calls_on_a_handle.h"
#include "sfdae/sfdae.h"

namespace sfdae::test {
namespace {

// A problem from t = 0 to 1, with what is called beyond the life cycle.
struct Subject {
  std::string name;
  Create create;
  std::vector<double> x;
  bool needs_x = true;  // sfdae_analyze_at
  // Of results. Linear and multibody systems go on from exactly where they were. A nonlinear one may have lost its
  // linearization, or knows how fast its iterations are from the step that failed: then it has other errors of
  // iterations and steps of other sizes, which the times show that single steps reach.
  double tolerance = 0.0;
  std::vector<Call> more = {};
  int density = 4;  // of Sequence
};

Sequence sequence_of(const Subject& subject, int method) {
  const sfdae_options options = options_of(method, 1e-3), tight = options_of(method, 1e-5);
  sfdae_options shallow = options;
  shallow.max_index = 2;
  Sequence result;
  result.name = subject.name + (method == SFDAE_METHOD_BDF     ? " by BDF"
                                : method == SFDAE_METHOD_RADAU ? " by Radau"
                                                               : "");
  result.x = subject.x;
  result.tolerance = subject.tolerance;
  result.density = subject.density;
  std::vector<Call>& calls = result.calls;
  calls.push_back(create_call(subject.create, options));
  calls.push_back(set_options("set options", options));
  calls.push_back(set_events("set events", 2));
  calls.push_back(analyze(subject.x, subject.needs_x));
  calls.push_back(make_consistent(subject.x));
  calls.push_back(start("start", subject.x));
  calls.push_back(step("first step"));
  calls.push_back(advance("advance to the first event", 0.3));
  calls.push_back(report());
  for (Call& call : checkpoint_calls()) calls.push_back(std::move(call));
  calls.push_back(advance("advance from event", 0.3));
  calls.push_back(set_options("set tight options", tight));
  calls.push_back(advance("advance with tight options", 0.35));
  calls.push_back(interpolate());
  calls.push_back(set_options("set first options again", options));
  calls.push_back(restore());
  calls.push_back(advance("advance after restore", 0.3));
  calls.push_back(set_events("no events", 0));
  calls.push_back(advance_without_slopes("advance without slopes", 0.6));
  calls.push_back(step("step"));
  calls.push_back(set_options("set another max_index", shallow));
  calls.push_back(start("start without analysis", subject.x));
  calls.push_back(advance("advance", 0.5));
  for (const Call& call : subject.more) calls.push_back(call);
  return result;
}

// ---- Problems --------------------------------------------------------------------------------------------------

// y1' + sin(t)/2 y2' = -y1 + t y2 + (1 + t/2) z + 1,   y2' = y1 - y2 + z + cos t,   0 = y1 + (2 + t) y2 - sin t.
// mu = 1, d = 1, a = 2.
int varying_E(double t, int order, double* E, void*) {
  constexpr double quarter = 1.5707963267948966;
  if (order == 0) E[0] = E[4] = 1.0;
  E[3] = 0.5 * std::sin(t + quarter * order);
  return 0;
}
int varying_A(double t, int order, double* A, void*) {
  if (order == 0) {
    const double entries[] = {-1.0, 1.0, -1.0, t, -1.0, -2.0 - t, 1.0 + 0.5 * t, 1.0, 0.0};
    std::copy(entries, entries + 9, A);
  } else if (order == 1) {
    A[3] = 1.0, A[5] = -1.0, A[6] = 0.5;
  }
  return 0;
}
int varying_f(double t, int order, double* f, void*) {
  constexpr double quarter = 1.5707963267948966;
  if (order == 0) f[0] = 1.0;
  f[1] = std::cos(t + quarter * order);
  f[2] = std::sin(t + quarter * order);
  return 0;
}

int create_varying(sfdae_solver** solver, const sfdae_options& options) {
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 3;
  problem.E = varying_E, problem.A = varying_A, problem.f = varying_f;
  return sfdae_create_linear(solver, &problem, &options);
}

template <class Function>
Call linear_call(const std::string& name, Function function) {
  return {name, [function](Session& s) {
            s.result.assign(100, 0.0);
            return armed([&] { return function(s.solver, s.result.data()); });
          }};
}

std::vector<Call> linear_inspection() {
  return {linear_call("derivative array",
                      [](sfdae_solver* solver, double* to) {
                        return sfdae_get_derivative_array(solver, 0.5, 1, to, to + 36, to + 60);
                      }),
          linear_call("projectors",
                      [](sfdae_solver* solver, double* to) {
                        return sfdae_get_projectors(solver, 0.5, to, to + 10, nullptr, to + 30, nullptr);
                      }),
          linear_call("strangeness-free system",
                      [](sfdae_solver* solver, double* to) {
                        return sfdae_get_strangeness_free(solver, 0.5, to, to + 10, to + 20, to + 30, to + 40,
                                                          to + 50);
                      }),
          linear_call("check of derivatives", [](sfdae_solver* solver, double* to) {
            sfdae_derivative_check check;
            sfdae_derivative_check_init(&check, sizeof check);
            const int status = sfdae_check_derivatives(solver, 0.5, 2, &check);
            *to = status == 0 ? check.error : 0.0;
            return status;
          })};
}

// The pendulum with a motor that turns its suspension, index 3; k is a parameter.
int record_pendulum(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                    sfdae_expression* F, void*) {
  const sfdae_expression k = sfdae_parameter(record, "k", 0.5);
  F[0] = sfdae_subtract(xdot[0], x[2]);
  F[1] = sfdae_subtract(xdot[1], x[3]);
  F[2] = sfdae_add(xdot[2], sfdae_multiply(x[4], x[0]));
  F[3] = sfdae_add(sfdae_add(xdot[3], sfdae_multiply(x[4], x[1])), sfdae_multiply(k, sfdae_exp(sfdae_sin(t))));
  F[4] = sfdae_subtract(sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_multiply(x[1], x[1])), sfdae_number(1.0));
  return 0;
}

int create_pendulum(sfdae_solver** solver, const sfdae_options& options) {
  return create_recorded(solver, options, 5, record_pendulum);
}

std::vector<Call> with_parameter(const std::vector<double>& x) {
  return {
      {"set parameter", [](Session& s) { return armed([&] { return sfdae_set_parameter(s.solver, "k", 0.75); }); }},
      start("start with parameter", x),
      advance("advance with parameter", 0.4),
      {"reset parameter", [](Session& s) { return armed([&] { return sfdae_set_parameter(s.solver, "k", 0.5); }); }}};
}

// x1' = -x1 x2, 0 = x2 - x1 by total derivatives.
int hyperbola(double, int order, const double* x, double* F, double* F_x, double* F_xdot, void*) {
  const auto derivative = [x](int i, int k) { return x[i + 2 * k]; };
  F[0] = derivative(0, order + 1);
  double binomial = 1.0;
  for (int j = 0; j <= order; ++j) {
    F[0] += binomial * derivative(0, j) * derivative(1, order - j);
    binomial *= static_cast<double>(order - j) / (j + 1);
  }
  F[1] = derivative(1, order) - derivative(0, order);
  const double one = order == 0 ? 1.0 : 0.0;
  if (F_x != nullptr) {
    F_x[0] = derivative(1, order);
    F_x[1] = -one;
    F_x[2] = derivative(0, order);
    F_x[3] = one;
  }
  if (F_xdot != nullptr) F_xdot[0] = one;
  return 0;
}

int create_callbacks(sfdae_solver** solver, const sfdae_options& options) {
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 2;
  problem.total_derivative = hyperbola;
  return sfdae_create_nonlinear(solver, &problem, &options);
}

Call check_total_derivatives() {
  return linear_call("check of total derivatives", [](sfdae_solver* solver, double* to) {
    const double jet[] = {1.0, 1.0, -1.0, -1.0, 2.0, 2.0};
    sfdae_derivative_check check;
    sfdae_derivative_check_init(&check, sizeof check);
    const int status = sfdae_check_total_derivatives(solver, 0.5, jet, 1, &check);
    *to = status == 0 ? check.error : 0.0;
    return status;
  });
}

// The pendulum as a multibody system, its constraint given twice.
int gravity(double, const double*, const double*, double* f, void*) {
  f[1] = -1.0;
  return 0;
}
int circle(double, const double* q, double* g, void*) {
  g[0] = g[1] = 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0);
  return 0;
}
int circle_jacobian(double, const double* q, double* G, void*) {
  G[0] = G[1] = q[0];
  G[2] = G[3] = q[1];
  return 0;
}

int create_multibody(sfdae_solver** solver, const sfdae_options& options) {
  sfdae_multibody_problem problem;
  sfdae_multibody_problem_init(&problem, sizeof problem);
  problem.num_positions = problem.num_constraints = 2;
  problem.forces = gravity, problem.constraints = circle, problem.constraint_jacobian = circle_jacobian;
  return sfdae_create_multibody(solver, &problem, &options);
}

Call check_multibody_derivatives() {
  return linear_call("check of multibody derivatives", [](sfdae_solver* solver, double* to) {
    const double q[] = {0.6, -0.8}, v[] = {0.8, 0.6};
    sfdae_derivative_check check;
    sfdae_derivative_check_init(&check, sizeof check);
    const int status = sfdae_check_multibody_derivatives(solver, 0.5, q, v, &check);
    *to = status == 0 ? check.error : 0.0;
    return status;
  });
}

// A skate on a tilted plane, recorded: q = (x, y, phi), v along and across, nonholonomic: no speed across; and a
// holonomic constraint that moves with t.
int record_skate(sfdae_record*, sfdae_expression t, const sfdae_expression* q, const sfdae_expression* v,
                 const sfdae_multibody_formulas* to, void*) {
  const auto number = sfdae_number;
  const sfdae_expression c = sfdae_cos(q[2]), s = sfdae_sin(q[2]);
  to->S[0] = c, to->S[1] = s, to->S[3] = sfdae_negate(s), to->S[4] = c, to->S[8] = number(1.0);
  to->M[0] = to->M[4] = number(2.0), to->M[8] = sfdae_add(number(1.0), sfdae_multiply(q[0], q[0]));
  to->f[0] = c, to->f[1] = sfdae_multiply(v[0], v[2]), to->f[2] = sfdae_negate(q[2]);
  to->H[0] = number(0.1), to->H[1] = number(1.0);
  to->g[0] = sfdae_subtract(q[2], sfdae_multiply(number(0.5), sfdae_sin(t)));
  return 0;
}

int create_recorded_multibody(sfdae_solver** solver, const sfdae_options& options) {
  sfdae_multibody_problem problem;
  sfdae_multibody_problem_init(&problem, sizeof problem);
  problem.num_positions = 3;
  problem.num_constraints = problem.num_nonholonomic = 1;
  problem.equations = record_skate;
  return sfdae_create_multibody(solver, &problem, &options);
}

constexpr double tolerance = 1e-3, several_tolerances = 10.0 * tolerance;

std::vector<Subject> subjects() {
  const std::vector<double> swing = {0.6, -0.8, 0.8, 0.6, 0.3}, turning = {0.0, 0.0, 0.0, 0.4, -0.04, 0.5, 0.1, 0.1};
  return {{"varying linear problem", create_varying, {0.3, 0.1, 0.2}, false, 0.0, linear_inspection()},
          {"recorded pendulum", create_pendulum, swing, true, several_tolerances, with_parameter(swing), 1},
          {"callbacks of a nonlinear problem",
           create_callbacks,
           {1.0, 1.0},
           true,
           several_tolerances,
           {check_total_derivatives()}},
          {"multibody pendulum",
           create_multibody,
           {0.6, -0.8, 0.8, 0.6, 0.1, 0.1},
           true,
           0.0,
           {check_multibody_derivatives()}},
          {"recorded skate", create_recorded_multibody, turning, true}};
}

class FailingAllocations : public testing::TestWithParam<std::tuple<std::size_t, int>> {};
INSTANTIATE_TEST_SUITE_P(Everywhere, FailingAllocations,
                         testing::Combine(testing::Range(std::size_t{0}, subjects().size()),
                                          testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU)));

TEST_P(FailingAllocations, LeaveAHandleThatGoesOn) {
  Sequence sequence = sequence_of(subjects()[std::get<0>(GetParam())], std::get<1>(GetParam()));
  FaultRun run(sequence);
  const FaultRun::Counts& counts = run.run(stride_of_faults(500));
  RecordProperty("injected", static_cast<int>(counts.injected));
  std::printf("%s: %ld faults, %ld refused, %ld compared, %ld differing, at most by %.2g\n", sequence.name.c_str(),
              counts.injected, counts.refused, counts.compared, counts.differing, counts.largest_difference);
}

}  // namespace
}  // namespace sfdae::test
