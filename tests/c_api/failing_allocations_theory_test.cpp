// Memory that is missing for the objects of the theory, guesses of slopes, singular points of nonlinear problems and
// ranks that need a certificate.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "calls_on_a_handle.h"
#include "sfdae/sfdae.h"

namespace sfdae::test {
namespace {

class TheoryMethods : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(FailingAllocations, TheoryMethods, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// What a getter writes, at most so many numbers.
template <class Function>
Call get(const std::string& name, Function function) {
  return {name, [function](Session& s) {
            s.result.assign(1000, 0.0);
            const std::vector<double> before = s.result;
            const int status = armed([&] { return function(s.solver, s.result.data()); });
            if (status == SFDAE_OUT_OF_MEMORY) {
              EXPECT_EQ(s.result, before) << "half of a result";
            }
            return status;
          }};
}

// At t, where x is known, and at a jet of five unknowns. Only what the equations determine: derivatives of the last
// unknown, a force, are those that the steps before have left.
std::vector<Call> get_all_at(double t) {
  static const std::vector<double> x = {0.6, -0.8, 0.8, 0.6, 1.8}, jet = [] {
    std::vector<double> derivatives;
    for (int i = 0; i < 20; ++i) derivatives.push_back(i < 5 ? x[static_cast<std::size_t>(i)] : std::sin(1.0 + i));
    return derivatives;
  }();
  const auto get_jet = [t](const std::string& name, const double* through) {
    return get(name, [t, through](sfdae_solver* solver, double* to) {
      double found[15] = {};
      const int status = sfdae_get_jet(solver, t, through, 1, found);
      std::copy_n(found, 9, to);
      return status;
    });
  };
  return {get_jet("jet", nullptr),
          get_jet("jet through x", x.data()),
          get("derivative array",
              [t](sfdae_solver* solver, double* to) {
                return sfdae_get_derivative_array(solver, t, 0, to, to + 100, to + 200);
              }),
          get("derivative array at a jet",
              [t](sfdae_solver* solver, double* to) {
                return sfdae_get_derivative_array_at(solver, t, jet.data(), 1, to, to + 100, to + 150);
              }),
          get("projectors",
              [t](sfdae_solver* solver, double* to) {
                int vhat = 0;
                return sfdae_get_projectors(solver, t, to, to + 100, to + 300, to + 500, &vhat);
              }),
          get("strangeness-free system", [t](sfdae_solver* solver, double* to) {
            return sfdae_get_strangeness_free(solver, t, to, to + 100, to + 200, to + 300, to + 400, to + 500);
          })};
}

// Of five recorded equations.
Call get_structure() {
  return get("structure", [](sfdae_solver* solver, double* to) {
    sfdae_structure structure;
    sfdae_structure_init(&structure, sizeof structure);
    int found[4][5] = {};
    const int status = sfdae_get_structure(solver, &structure, found[0], found[1], found[2], found[3]);
    for (const auto& row : found)
      for (const int entry : row) *to++ = entry;
    *to = structure.verdict;
    return status;
  });
}

// Of five recorded equations; destroyed again.
Call linearize(double t) {
  return get("linearization", [t](sfdae_solver* solver, double* to) {
    const int outputs[] = {0};
    sfdae_linearization choice;
    sfdae_linearization_init(&choice, sizeof choice);
    choice.t = t;
    choice.num_output_unknowns = 1;
    choice.output_unknowns = outputs;
    sfdae_descriptor* descriptor = nullptr;
    const int status = sfdae_linearize(solver, &choice, &descriptor);
    if (status == SFDAE_OK) sfdae_get_descriptor_matrices(descriptor, to, to + 100, nullptr, to + 200, nullptr);
    sfdae_destroy_descriptor(&descriptor);
    return status;
  });
}

Call certify() {
  return get("certify", [](sfdae_solver* solver, double* to) { return sfdae_certify(solver, to); });
}

void run_with_theory(Sequence sequence, const std::vector<Call>& getters) {
  std::vector<Call> all = std::move(sequence.calls);
  all.insert(all.end(), getters.begin(), getters.end());
  all.push_back(advance("advance further", 0.4));
  sequence.calls = std::move(all);
  run_with_faults(sequence);
}

// The pendulum, index 3.
int plain_pendulum(sfdae_record*, sfdae_expression, const sfdae_expression* x, const sfdae_expression* xdot,
                   sfdae_expression* F, void*) {
  F[0] = sfdae_subtract(xdot[0], x[2]);
  F[1] = sfdae_subtract(xdot[1], x[3]);
  F[2] = sfdae_add(xdot[2], sfdae_multiply(x[4], x[0]));
  F[3] = sfdae_add(sfdae_add(xdot[3], sfdae_multiply(x[4], x[1])), sfdae_number(1.0));
  F[4] = sfdae_subtract(sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_multiply(x[1], x[1])), sfdae_number(1.0));
  return 0;
}

template <sfdae_equations_function record, int n>
int create_formulas(sfdae_solver** solver, const sfdae_options& options) {
  return create_recorded(solver, options, n, record);
}

TEST_P(TheoryMethods, InTheTheoryOfANonlinearProblem) {
  const std::vector<double> x = {0.6, -0.8, 0.8, 0.6, 1.8};
  Sequence sequence{"theory of a nonlinear problem",
                    x,
                    {create_call(create_formulas<plain_pendulum, 5>, options_of(GetParam(), 1e-3)), start("start", x),
                     advance("advance", 0.3)},
                    1e-3};
  sequence.density = 2;
  std::vector<Call> getters = get_all_at(0.3);
  getters.push_back(get_structure());
  getters.push_back(linearize(0.3));
  run_with_theory(sequence, getters);
}

int record_multibody_pendulum(sfdae_record*, sfdae_expression, const sfdae_expression* q, const sfdae_expression*,
                              const sfdae_multibody_formulas* to, void*) {
  to->M[0] = to->M[3] = sfdae_number(1.0);
  to->f[1] = sfdae_number(-1.0);
  const sfdae_expression squares = sfdae_add(sfdae_multiply(q[0], q[0]), sfdae_multiply(q[1], q[1]));
  to->g[0] = sfdae_multiply(sfdae_number(0.5), sfdae_subtract(squares, sfdae_number(1.0)));
  return 0;
}

TEST_P(TheoryMethods, InTheTheoryOfAMultibodySystem) {
  const auto create = [](sfdae_solver** solver, const sfdae_options& options) {
    sfdae_multibody_problem problem;
    sfdae_multibody_problem_init(&problem, sizeof problem);
    problem.num_positions = 2, problem.num_constraints = 1;
    problem.equations = record_multibody_pendulum;
    return sfdae_create_multibody(solver, &problem, &options);
  };
  const std::vector<double> x = {0.6, -0.8, 0.8, 0.6, 0.1};
  std::vector<Call> getters = get_all_at(0.3);
  getters.push_back(get("extended system", [](sfdae_solver* solver, double* to) {
    return sfdae_get_extended_system(solver, 0.3, nullptr, to, to + 10, to + 20, to + 100, to + 200, to + 300);
  }));
  Sequence sequence{"theory of a multibody system",
                    x,
                    {create_call(create, options_of(GetParam(), 1e-3)), start("start", x), advance("advance", 0.3)}};
  sequence.density = 2;
  run_with_theory(sequence, getters);
}

// x'^2 = x^2: a guess says which way x goes.
int record_square(sfdae_record*, sfdae_expression, const sfdae_expression* x, const sfdae_expression* xdot,
                  sfdae_expression* F, void*) {
  F[0] = sfdae_subtract(sfdae_multiply(xdot[0], xdot[0]), sfdae_multiply(x[0], x[0]));
  return 0;
}

Call start_downward() {
  return {"start downward", [](Session& s) {
            double x = 1.0, xdot = -0.9;
            const int status = armed([&] { return sfdae_start(s.solver, 0.0, 1.0, &x, &xdot); });
            if (status < 0) {
              EXPECT_EQ(x, 1.0);
              EXPECT_EQ(xdot, -0.9);
              return status;
            }
            EXPECT_NEAR(xdot, -x, 1e-10);
            s.t = 0.0, s.x = {x}, s.xdot = {xdot};
            keep_point(s);
            return status;
          }};
}

TEST_P(TheoryMethods, WhereTheSlopeIsGuessed) {
  sfdae_options options = options_of(GetParam(), 1e-3);
  options.xdot_is_guess = 1;
  run_with_faults({"guess of a slope",
                   {1.0},
                   {create_call(create_formulas<record_square, 1>, options), start_downward(), certify(),
                    advance("advance", 0.5)},
                   1e-2});
}

// x' = y,  x^2 + y^2 = 1: x = sin t, and F_x' and the constraint leave y open at t = pi / 2.
int record_circle(sfdae_record*, sfdae_expression, const sfdae_expression* x, const sfdae_expression* xdot,
                  sfdae_expression* F, void*) {
  F[0] = sfdae_subtract(xdot[0], x[1]);
  F[1] = sfdae_subtract(sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_multiply(x[1], x[1])), sfdae_number(1.0));
  return 0;
}

TEST_P(TheoryMethods, WhereANonlinearProblemIsSingular) {
  const std::vector<double> x = {0.0, 1.0};
  Call changed = advance("advance to the singular point", 2.0);
  changed.failure = SFDAE_CHARACTERISTICS_CHANGED;
  run_with_faults({"singular point",
                   x,
                   {create_call(create_formulas<record_circle, 2>, options_of(GetParam(), 1e-3)), start("start", x),
                    changed, get_change(false)},
                   1e-2});
}

// A source with 1 MOhm at node 1, 1 pF from there to node 2, 3 pF from node 2 to the ground, 1 uH from node 1 to node
// 3, 1 Ohm from there to the ground, by modified nodal analysis: e0, ..., e3, iL, iV. mu = 0, d = 3.
constexpr double R1 = 1e6, C1 = 1e-12, C2 = 3e-12, L = 1e-6, R2 = 1.0;
int circuit_E(double, int order, double* E, void*) {
  if (order > 0) return 0;
  E[1 + 6 * 1] = C1, E[1 + 6 * 2] = E[2 + 6 * 1] = -C1, E[2 + 6 * 2] = C1 + C2;
  E[4 + 6 * 4] = L;
  return 0;
}
int circuit_A(double, int order, double* A, void*) {
  if (order > 0) return 0;
  A[0 + 6 * 0] = A[1 + 6 * 1] = -1.0 / R1, A[0 + 6 * 1] = A[1 + 6 * 0] = 1.0 / R1, A[0 + 6 * 5] = -1.0;
  A[1 + 6 * 4] = -1.0;
  A[3 + 6 * 4] = 1.0, A[3 + 6 * 3] = -1.0 / R2;
  A[4 + 6 * 1] = 1.0, A[4 + 6 * 3] = -1.0;
  A[5 + 6 * 0] = 1.0;
  return 0;
}
int circuit_f(double t, int order, double* f, void*) {
  constexpr double quarter = 1.5707963267948966;  // of a turn
  f[5] = -std::sin(t + order * quarter);
  return 0;
}

TEST_P(TheoryMethods, WhereRanksNeedACertificate) {
  const auto create = [](sfdae_solver** solver, const sfdae_options& options) {
    sfdae_linear_problem problem;
    sfdae_linear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = 6;
    problem.E = circuit_E, problem.A = circuit_A, problem.f = circuit_f;
    return sfdae_create_linear(solver, &problem, &options);
  };
  const std::vector<double> x(6, 0.0);
  std::vector<Call> calls = {create_call(create, options_of(GetParam(), 1e-3)),
                             analyze(x, false),
                             start("start", x),
                             certify(),
                             advance("advance", 0.1),
                             certify()};
  for (Call& call : checkpoint_calls()) calls.push_back(std::move(call));
  calls.push_back(restore());
  calls.push_back(advance("advance after restore", 0.2));
  run_with_faults({"circuit", x, calls});
}

// Poles, zeros and values of a descriptor system with missing memory: nothing is written, and the call can be repeated.
TEST(FailingAllocations, InPolesOfADescriptorSystem) {
  const double E[] = {1, 0, 0, 0}, A[] = {-2, 1, 1, -1}, B[] = {1, 0}, C[] = {1, 0}, one = 1;
  sfdae_descriptor_matrices matrices;
  sfdae_descriptor_matrices_init(&matrices, sizeof matrices);
  matrices.num_equations = matrices.num_unknowns = 2;
  matrices.num_inputs = matrices.num_outputs = 1;
  matrices.E = E, matrices.A = A, matrices.B = B, matrices.C = C;
  sfdae_descriptor* descriptor = nullptr;
  sfdae_spectrum spectrum;
  sfdae_spectrum_init(&spectrum, sizeof spectrum);
  double real[2] = {7, 7}, imaginary[2] = {7, 7};
  const std::vector<std::function<int()>> calls = {
      [&] { return descriptor != nullptr ? 0 : sfdae_create_descriptor(&matrices, &descriptor); },
      [&] { return sfdae_get_poles(descriptor, &spectrum, real, imaginary, nullptr); },
      [&] { return sfdae_get_zeros(descriptor, &spectrum, real, imaginary, nullptr); },
      [&] { return sfdae_get_transfer(descriptor, 1, &one, &one, real, imaginary); }};
  for (const auto& call : calls) {
    real[0] = imaginary[0] = 7;
    allocations = {.blocks = allocations.blocks};
    int status = SFDAE_OUT_OF_MEMORY;
    for (allocations.first = 1; status != SFDAE_OK; ++allocations.first) {
      const long blocks = allocations.blocks;
      allocations.seen = 0;
      status = armed(call);
      if (status == SFDAE_OK) break;
      ASSERT_EQ(status, SFDAE_OUT_OF_MEMORY);
      EXPECT_EQ(real[0], 7);
      EXPECT_EQ(allocations.blocks, blocks);
    }
    EXPECT_GT(allocations.first, 1);
  }
  sfdae_destroy_descriptor(&descriptor);
  allocations.first = 0;
}

}  // namespace
}  // namespace sfdae::test
