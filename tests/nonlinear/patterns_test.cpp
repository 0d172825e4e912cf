// SPDX-License-Identifier: BSD-3-Clause
// Functions with sparsity patterns: what recorded equations give, with fewer evaluations and by their structure; and
// patterns that are wrong are named.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "family_run.h"
#include "patterned_twin.h"
#include "sparse_run.h"

namespace sfdae_test {

namespace {

constexpr int all_forms[] = {SFDAE_MATRICES_DENSE, SFDAE_MATRICES_COMPRESSED, SFDAE_MATRICES_DIFFERENCES};

std::shared_ptr<const Record> recording(const SparseSystem& system) {
  return sfdae_test::recording_of(system.n(), [&system](const auto& t, const auto* x, const auto* xdot, auto* F) {
    system.residual(t, x, xdot, F);
  });
}

// u' = u_xx + u (1 - u) on `cells` cells, and the sum of neighbours as algebraic unknowns: v_i = u_(i-1) + u_(i+1).
struct Line {
  int cells;
  template <class V>
  void operator()(const V&, const V* x, const V* xdot, V* F) const {
    const V* const u = x;
    const V* const v = x + cells;
    for (int i = 0; i < cells; ++i) {
      F[i] = xdot[i] - (v[i] - 2.0 * u[i] + 0.5 * u[i] * (1.0 - u[i]));
      if (i == 0) F[cells + i] = v[i] - u[i + 1] - 1.0;
      else if (i + 1 == cells) F[cells + i] = v[i] - u[i - 1];
      else F[cells + i] = v[i] - u[i - 1] - u[i + 1];
    }
  }
  int n() const { return 2 * cells; }
};

std::vector<double> start_of(const Line& line) {
  std::vector<double> x(index(line.n()), 0.0);
  for (int i = 0; i < line.cells; ++i) x[index(i)] = 1.0 / (1.0 + i);
  return x;
}

}  // namespace

// By the extension and by the whole array, half of the systems with a structure that misleads.
TEST(Patterns, RandomSystemsHaveTheSolutionsOfTheirRecordings) {
  const int count = scaled_count(600);
  int integrated = 0, of_higher_index = 0, unconfirmed = 0;
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const SparseSystem system(static_cast<unsigned>(trial + 500001),
                              trial % 4 == 3 ? SparseSystem::Mixing::any : SparseSystem::Mixing::none);
    const int form = all_forms[trial % 3], method = trial % 2 == 0 ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU;
    const int structure = trial % 5 == 4 ? SFDAE_STRUCTURE_AUTOMATIC : SFDAE_STRUCTURE_REQUIRED;
    NonlinearRun recorded(equations_of(system), options_of(structure, method));
    PatternedTwin twin(recording(system), form);
    ASSERT_EQ(twin.create(options_of(structure, method)), SFDAE_OK);
    const int expected = recorded.integrate(0.2, 1.5, system.exact(0.2));
    const int status = twin.integrate(0.2, 1.5, system.exact(0.2));
    if (!is_known(status)) {
      // What numbers do not confirm has a name, and equations are not replaced by what differences say.
      EXPECT_TRUE(!is_known(expected) || form == SFDAE_MATRICES_DIFFERENCES) << twin.message();
      EXPECT_TRUE(status == SFDAE_RANK_UNCLEAR || status == SFDAE_NO_CONSISTENT_VALUES ||
                  status == SFDAE_CHARACTERISTICS_CHANGED || status == SFDAE_SINGULAR)
          << sfdae_status_name(status) << ": " << twin.message();
      ++unconfirmed;
      continue;
    }
    ++integrated;
    if (system.values().mu > 0) ++of_higher_index;
    EXPECT_EQ(twin.values(), system.values()) << form;
    EXPECT_LT(error_in_tolerances(twin.x, system.exact(1.5)), 10.0) << form << " " << method;
    EXPECT_EQ(twin.gave_jacobians, form != SFDAE_MATRICES_DIFFERENCES);
  }
  RecordProperty("integrated", integrated);
  RecordProperty("of_higher_index", of_higher_index);
  RecordProperty("unconfirmed", unconfirmed);
  EXPECT_GT(integrated, count * 3 / 5);
  EXPECT_GT(of_higher_index, count * 3 / 10);
}

TEST(Patterns, SystemsOnALineTakeSparseMatricesAndFewEvaluations) {
  const Line line{100};
  NonlinearRun recorded(equations_of(line.n(), line.n(), line), options_of(SFDAE_STRUCTURE_REQUIRED));
  ASSERT_TRUE(is_known(recorded.integrate(0.0, 1.0, start_of(line)))) << recorded.message();
  for (const int form : all_forms) {
    PatternedTwin twin(recording_of(line.n(), line), form);
    ASSERT_EQ(twin.create(options_of(SFDAE_STRUCTURE_AUTOMATIC)), SFDAE_OK);
    ASSERT_TRUE(is_known(twin.integrate(0.0, 1.0, start_of(line)))) << twin.message();
    EXPECT_EQ(twin.values(), (CharacteristicValues{0, line.cells, line.cells, 0, 0}));
    // Both are within their tolerances.
    EXPECT_LT(error_in_tolerances(twin.x, recorded.x), 2.0) << form;
    sfdae_structure structure;
    sfdae_structure_init(&structure, sizeof structure);
    ASSERT_EQ(sfdae_get_structure(twin.solver(), &structure, nullptr, nullptr, nullptr, nullptr), SFDAE_OK)
        << twin.message();
    EXPECT_EQ(structure.verdict, SFDAE_STRUCTURE_CERTIFIED);
    EXPECT_EQ(structure.freedom, line.cells);
    // A difference for each column would take 400 for each Jacobian; groups of columns take some 20, with all checks.
    if (form == SFDAE_MATRICES_DIFFERENCES) {
      EXPECT_LT(twin.calls, 3000);
    }
  }
}

// Order 1 is not available; x' at outputs is that of differences.
TEST(Patterns, DifferencesNeedNoTotalDerivativesWhereNothingIsDifferentiated) {
  const Line line{40};
  NonlinearRun recorded(equations_of(line.n(), line.n(), line), options_of(SFDAE_STRUCTURE_REQUIRED));
  ASSERT_TRUE(is_known(recorded.integrate(0.0, 1.0, start_of(line))));
  PatternedTwin twin(recording_of(line.n(), line), SFDAE_MATRICES_DIFFERENCES);
  twin.highest_order = 0;
  ASSERT_EQ(twin.create(options_of(SFDAE_STRUCTURE_AUTOMATIC)), SFDAE_OK);
  ASSERT_TRUE(is_known(twin.integrate(0.0, 1.0, start_of(line)))) << twin.message();
  EXPECT_LT(error_in_tolerances(twin.x, recorded.x), 2.0);
  for (std::size_t j = 0; j < twin.x.size(); ++j) EXPECT_NEAR(twin.xdot[j], recorded.xdot[j], 2e-5) << j;
}

TEST(Patterns, EveryEntryThatIsMissingIsNamed) {
  const Line line{6};
  const std::shared_ptr<const Record> record = recording_of(line.n(), line);
  for (const int form : all_forms) {
    PatternedTwin whole(record, form);
    for (const bool of_xdot : {false, true}) {
      const int entries = of_xdot ? whole.F_xdot.entries() : whole.F_x.entries();
      for (int at = 0; at < entries; ++at) {
        SCOPED_TRACE(testing::Message() << "form " << form << (of_xdot ? " F_xdot " : " F_x ") << at);
        PatternedTwin twin(record, form);
        Pattern& pattern = of_xdot ? twin.F_xdot : twin.F_x;
        const int row = pattern.row_index[index(at)];
        int column = 0;
        while (pattern.col_start[index(column + 1)] <= at) ++column;
        pattern = without(pattern, at);
        sfdae_options options = options_of(SFDAE_STRUCTURE_AUTOMATIC);
        ASSERT_EQ(twin.create(options), SFDAE_OK);
        const int status = twin.integrate(0.0, 1.0, start_of(line));
        // Without an unknown of its own for each equation there is nothing to be evaluated.
        if (status == SFDAE_RANK_UNCLEAR && form == SFDAE_MATRICES_DIFFERENCES) {
          EXPECT_NE(twin.message().find("too few unknowns"), std::string::npos) << twin.message();
          continue;
        }
        if (form == SFDAE_MATRICES_COMPRESSED && status != SFDAE_WRONG_PATTERN) ADD_FAILURE() << status;
        EXPECT_EQ(status, SFDAE_WRONG_PATTERN) << twin.message();
        const std::string expected = "row " + std::to_string(row) + ", column " + std::to_string(column);
        EXPECT_NE(twin.message().find(expected), std::string::npos) << twin.message() << expected;
        EXPECT_NE(twin.message().find(of_xdot ? "F_xdot has" : "F_x has"), std::string::npos) << twin.message();
      }
    }
  }
}

// F_1 has x_0 (t - 1)^3 for t > 1 only.
TEST(Patterns, AnEntryThatComesLaterIsFoundThen) {
  const auto residual = [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] + x[0];
    F[1] = xdot[1] + x[1] + x[0] * max(t - 1.0, 0.0) * (t - 1.0);
  };
  PatternedTwin twin(recording_of(2, residual), SFDAE_MATRICES_DENSE);
  ASSERT_EQ(twin.F_x.entries(), 3);
  twin.F_x = without(twin.F_x, 1);
  ASSERT_EQ(twin.create(options_of(SFDAE_STRUCTURE_AUTOMATIC)), SFDAE_OK);
  EXPECT_EQ(twin.integrate(0.0, 30.0, {1.0, 1.0}), SFDAE_WRONG_PATTERN) << twin.message();
  EXPECT_GE(twin.t, 0.9);
  EXPECT_NE(twin.message().find("row 1, column 0"), std::string::npos) << twin.message();
}

TEST(Patterns, BadOnesAreRefusedWithWhatIsWrong) {
  const Line line{3};
  const std::shared_ptr<const Record> record = recording_of(line.n(), line);
  const auto complaint = [&](auto change) {
    PatternedTwin twin(record, SFDAE_MATRICES_COMPRESSED);
    change(twin.F_x);
    sfdae_nonlinear_problem problem;
    sfdae_nonlinear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = line.n();
    problem.total_derivative = [](double, int, const double*, double*, double*, double*, void*) { return -1; };
    problem.F_x_entries = twin.F_x.entries(), problem.F_xdot_entries = twin.F_xdot.entries();
    problem.F_x_col_start = twin.F_x.col_start.data(), problem.F_x_row_index = twin.F_x.row_index.data();
    problem.F_xdot_col_start = twin.F_xdot.col_start.data();
    problem.F_xdot_row_index = twin.F_xdot.row_index.data();
    char text[400];
    return sfdae_check_nonlinear(&problem, nullptr, text, sizeof text) == SFDAE_OK ? "" : std::string(text);
  };
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  EXPECT_EQ(complaint([](Pattern&) {}), "");
  // In any order.
  EXPECT_EQ(complaint([](Pattern& p) { std::swap(p.row_index[0], p.row_index[1]); }), "");
  EXPECT_TRUE(has(complaint([](Pattern& p) { p.row_index[2] = 6; }), "row_index[2] is 6"));
  EXPECT_TRUE(has(complaint([](Pattern& p) { p.row_index[1] = -1; }), "row_index[1] is -1"));
  EXPECT_TRUE(has(complaint([](Pattern& p) { p.row_index[1] = p.row_index[0]; }), "occurs twice in column 0"));
  EXPECT_TRUE(has(complaint([](Pattern& p) { p.col_start[0] = 1; }), "col_start[0] is 1, not 0"));
  EXPECT_TRUE(has(complaint([](Pattern& p) { p.col_start[2] = 0; }), "must not decrease"));
  EXPECT_TRUE(has(complaint([](Pattern& p) { p.col_start.back() -= 1; }), "but there are"));
  EXPECT_TRUE(has(complaint([](Pattern& p) { p.col_start[3] = 100; }), "must not decrease"));
}

}  // namespace sfdae_test
