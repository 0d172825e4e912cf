// SPDX-License-Identifier: BSD-3-Clause
//
// sfdae_message(NULL) says why the last creation of this thread has failed, whatever it was to create.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <sfdae/hybrid.hpp>
#include <sfdae/sfdae.hpp>
#include <string>
#include <thread>

namespace {

std::string reason() { return sfdae_message(nullptr); }

void expect_part(const char* part) { EXPECT_NE(reason().find(part), std::string::npos) << reason(); }

int equations(sfdae_record*, sfdae_expression, const sfdae_expression* x, const sfdae_expression* xdot,
              sfdae_expression* F, void* user) {
  F[0] = sfdae_add(xdot[0], x[0]);
  return user != nullptr ? *static_cast<int*>(user) : 0;
}

sfdae_nonlinear_problem decay() {
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 1;
  problem.equations = equations;
  return problem;
}

TEST(CreationMessage, SaysWhatIsWrongWithAProblem) {
  sfdae_solver* solver = nullptr;
  sfdae_nonlinear_problem problem = decay();
  problem.equations = nullptr;
  EXPECT_EQ(sfdae_create_nonlinear(&solver, &problem, nullptr), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(solver, nullptr);
  char text[1024];
  sfdae_check_nonlinear(&problem, nullptr, text, sizeof text);
  EXPECT_STRNE(text, "");
  EXPECT_EQ(reason(), text);
  EXPECT_EQ(sfdae_create_nonlinear(&solver, nullptr, nullptr), SFDAE_ILLEGAL_ARGUMENT);
  expect_part("problem is NULL");
  EXPECT_EQ(sfdae_create_nonlinear(nullptr, &problem, nullptr), SFDAE_ILLEGAL_ARGUMENT);
  expect_part("solver");
  expect_part("NULL");
}

TEST(CreationMessage, SaysWhatIsWrongWithOptions) {
  sfdae_solver* solver = nullptr;
  const sfdae_nonlinear_problem problem = decay();
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = -1;
  EXPECT_EQ(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_ILLEGAL_ARGUMENT);
  expect_part("rtol");
}

TEST(CreationMessage, IsEmptyAfterACreationThatSucceeds) {
  sfdae_solver* solver = nullptr;
  sfdae_nonlinear_problem problem = decay();
  int stop = -1;
  problem.user = &stop;
  EXPECT_EQ(sfdae_create_nonlinear(&solver, &problem, nullptr), SFDAE_CALLBACK_STOPPED);
  EXPECT_NE(reason(), "");
  // Calls on solvers, and checks, leave it alone.
  problem.user = nullptr;
  sfdae_check_nonlinear(&problem, nullptr, nullptr, 0);
  EXPECT_EQ(sfdae_start(nullptr, 0, 1, nullptr, nullptr), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_NE(reason(), "");
  EXPECT_EQ(sfdae_create_nonlinear(&solver, &problem, nullptr), SFDAE_OK);
  EXPECT_EQ(reason(), "");
  sfdae_destroy(&solver);
}

TEST(CreationMessage, AllKindsHaveOne) {
  sfdae_solver* solver = nullptr;
  sfdae_linear_problem linear;
  sfdae_linear_problem_init(&linear, sizeof linear);
  linear.num_equations = linear.num_unknowns = 1;
  EXPECT_EQ(sfdae_create_linear(&solver, &linear, nullptr), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_NE(reason(), "");
  sfdae_multibody_problem multibody;
  sfdae_multibody_problem_init(&multibody, sizeof multibody);
  multibody.num_positions = -1;
  EXPECT_EQ(sfdae_create_multibody(&solver, &multibody, nullptr), SFDAE_ILLEGAL_ARGUMENT);
  expect_part("num_positions");
  EXPECT_EQ(sfdae_create_hybrid(nullptr), SFDAE_ILLEGAL_ARGUMENT);
  expect_part("hybrid");
  EXPECT_EQ(sfdae_create_solution(nullptr), SFDAE_ILLEGAL_ARGUMENT);
  expect_part("solution");
  sfdae_descriptor* descriptor = nullptr;
  sfdae_descriptor_matrices matrices;
  sfdae_descriptor_matrices_init(&matrices, sizeof matrices);
  matrices.num_equations = matrices.num_unknowns = 1;
  const double one = 1, bad = std::numeric_limits<double>::quiet_NaN();
  matrices.E = &one;
  matrices.A = &bad;
  EXPECT_EQ(sfdae_create_descriptor(&matrices, &descriptor), SFDAE_ILLEGAL_ARGUMENT);
  expect_part("A is NULL or contains NaN");
  matrices.A = &one;
  matrices.rank_tol = 2;
  EXPECT_EQ(sfdae_create_descriptor(&matrices, &descriptor), SFDAE_ILLEGAL_ARGUMENT);
  expect_part("rank_tol = 2");
}

TEST(CreationMessage, EachThreadHasItsOwn) {
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_linear(&solver, nullptr, nullptr), SFDAE_ILLEGAL_ARGUMENT);
  const std::string here = reason();
  EXPECT_NE(here, "");
  std::string before, after;
  std::thread([&] {
    before = reason();
    sfdae_nonlinear_problem problem = decay();
    problem.equations = nullptr;
    sfdae_solver* other = nullptr;
    sfdae_create_nonlinear(&other, &problem, nullptr);
    after = reason();
  }).join();
  EXPECT_EQ(before, "");
  EXPECT_NE(after, "");
  EXPECT_NE(after, here);
  EXPECT_EQ(reason(), here);
}

// In C++ the exception has the same words, and equations are recorded once.
TEST(CreationMessage, IsThatOfTheExceptionInCpp) {
  int calls = 0;
  sfdae::NonlinearProblem problem(1, 1);
  problem.equations = [&calls](const auto&, auto x, auto xdot, auto F) {
    ++calls;
    F[0] = xdot[0] + pow(x[0], 2);
  };
  sfdae::Options options;
  options.atol = -1;
  try {
    sfdae::Solver solver(problem, options);
    ADD_FAILURE();
  } catch (const sfdae::Error& error) {
    EXPECT_NE(std::string(error.what()).find("atol"), std::string::npos) << error.what();
    EXPECT_EQ(reason(), error.what());
  }
  EXPECT_LE(calls, 1);
}

}  // namespace
