// SPDX-License-Identifier: BSD-3-Clause
// Patterns that lack an entry: it is named, or there is a failure, or the solution is right all the same; and linear
// problems with patterns of E(t) and A(t).
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
  return recording_of(system.n(), [&system](const auto& t, const auto* x, const auto* xdot, auto* F) {
    system.residual(t, x, xdot, F);
  });
}

struct Counts {
  int tried = 0, named = 0, other_failures = 0, right = 0;
};

// An entry of either matrix at random is taken away.
void leave_out(PatternedTwin& twin, RandomNumbers& numbers) {
  const int of_x = twin.F_x.entries(), all = of_x + twin.F_xdot.entries();
  const int at = static_cast<int>(numbers.uniform(0.0, all - 1e-9));
  Pattern& pattern = at < of_x ? twin.F_x : twin.F_xdot;
  pattern = without(pattern, at < of_x ? at : at - of_x);
}

}  // namespace

TEST(MissingEntries, NeverLeadToWrongSolutions) {
  const int count = scaled_count(900);
  Counts counts;
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const SparseSystem system(static_cast<unsigned>(trial + 800001), SparseSystem::Mixing::none);
    RandomNumbers numbers(static_cast<unsigned>(trial + 1));
    const int form = all_forms[trial % 3];
    PatternedTwin twin(recording(system), form);
    leave_out(twin, numbers);
    const int structure = trial % 2 == 0 ? SFDAE_STRUCTURE_REQUIRED : SFDAE_STRUCTURE_AUTOMATIC;
    ASSERT_EQ(twin.create(options_of(structure)), SFDAE_OK);
    const int status = twin.integrate(0.2, 1.5, system.exact(0.2));
    ++counts.tried;
    if (status == SFDAE_WRONG_PATTERN) ++counts.named;
    else if (!is_known(status)) ++counts.other_failures;
    else ++counts.right;
    if (is_known(status)) {
      EXPECT_LT(error_in_tolerances(twin.x, system.exact(1.5)), 10.0) << form;
    }
  }
  RecordProperty("named", counts.named);
  RecordProperty("other_failures", counts.other_failures);
  RecordProperty("right", counts.right);
  // Entries that are zero at the solution, as those of products of deviations, are not missed.
  EXPECT_GT(counts.named, counts.tried * 3 / 5);
}

// u' = u_xx, 0 = v - u^3 on 400 cells: groups of unknowns, not each by itself.
TEST(MissingEntries, OfLargeSystemsAreNearlyAllFoundAtTheStart) {
  constexpr int cells = 400;
  const auto residual = [](const auto&, const auto* x, const auto* xdot, auto* F) {
    for (int i = 0; i < cells; ++i) {
      F[i] = xdot[i] + 2.0 * x[i] - 0.1 * x[cells + i];
      if (i > 0) F[i] = F[i] - x[i - 1];
      if (i + 1 < cells) F[i] = F[i] - x[i + 1];
      F[cells + i] = x[cells + i] - x[i] * x[i] * x[i];
    }
  };
  const std::shared_ptr<const Record> record = recording_of(2 * cells, residual);
  std::vector<double> x0(2 * cells, 0.0);
  for (int i = 0; i < cells; ++i) x0[index(i)] = std::sin(0.1 * i), x0[index(cells + i)] = std::pow(x0[index(i)], 3);
  const int count = scaled_count(40);
  int named = 0;
  for (int trial = 0; trial < count; ++trial) {
    RandomNumbers numbers(static_cast<unsigned>(trial + 1));
    PatternedTwin twin(record, SFDAE_MATRICES_DIFFERENCES);
    leave_out(twin, numbers);
    ASSERT_EQ(twin.create(options_of(SFDAE_STRUCTURE_AUTOMATIC)), SFDAE_OK);
    std::vector<double> x = x0, xdot(x0.size());
    const int status = sfdae_start(twin.solver(), 0.0, 1.0, x.data(), xdot.data());
    if (status == SFDAE_WRONG_PATTERN) ++named;
  }
  RecordProperty("named", named);
  EXPECT_GE(named, count * 9 / 10);
}

// ---- Linear problems -----------------------------------------------------------------------------------------------

namespace {

// e_i' = -b_i e_i + sin(t) e_w,  0 = (2 + cos t) e_i - e_w, and chains e_(i+1)' = e_i, 0 = (1 + t) e_k of the
// deviation e from x_i = sin(w_i t + i); rows are permuted. mu is one less than the length of the chain.
class LinearTwin {
 public:
  LinearTwin(unsigned seed, int matrices) : matrices_(matrices), numbers_(seed) {
    differential_ = 1 + below(4), algebraic_ = below(4), chain_ = 1 + below(3);
    n_ = differential_ + algebraic_ + chain_;
    for (int i = 0; i < n_; ++i) rows_.push_back(i);
    for (int i = n_ - 1; i > 0; --i) std::swap(rows_[index(i)], rows_[index(below(i + 1))]);
    for (int i = 0; i < n_; ++i) {
      frequency_.push_back(numbers_.uniform(0.5, 2.0));
      damping_.push_back(numbers_.uniform(0.2, 2.0));
      neighbour_.push_back(below(differential_));
    }
    E_ = pattern_of([this](int j, auto add) { write_E(0.7, 0, j, add); });
    A_ = pattern_of([this](int j, auto add) { write_A(0.7, 0, j, add); });
  }
  ~LinearTwin() { sfdae_destroy(&solver_); }
  LinearTwin(const LinearTwin&) = delete;
  LinearTwin& operator=(const LinearTwin&) = delete;

  int integrate(const sfdae_options& options) {
    sfdae_linear_problem problem;
    sfdae_linear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = n_;
    problem.E = [](double t, int order, double* E, void* user) {
      LinearTwin& twin = *static_cast<LinearTwin*>(user);
      twin.write(twin.E_, E, [&](int j, auto add) { twin.write_E(t, order, j, add); });
      return 0;
    };
    problem.A = [](double t, int order, double* A, void* user) {
      LinearTwin& twin = *static_cast<LinearTwin*>(user);
      twin.write(twin.A_, A, [&](int j, auto add) { twin.write_A(t, order, j, add); });
      return 0;
    };
    problem.f = [](double t, int order, double* f, void* user) {
      return static_cast<LinearTwin*>(user)->write_f(t, order, f);
    };
    problem.user = this;
    problem.matrices = matrices_;
    problem.E_entries = E_.entries(), problem.A_entries = A_.entries();
    problem.E_col_start = E_.col_start.data(), problem.E_row_index = E_.row_index.data();
    problem.A_col_start = A_.col_start.data(), problem.A_row_index = A_.row_index.data();
    int status = sfdae_create_linear(&solver_, &problem, &options);
    x = exact(0.0), xdot.resize(index(n_));
    if (status >= 0) status = sfdae_start(solver_, 0.0, 2.0, x.data(), xdot.data());
    double t = 0.0;
    return status < 0 ? status : sfdae_advance(solver_, 2.0, &t, x.data(), xdot.data());
  }
  std::vector<double> exact(double t, int order = 0) const {
    std::vector<double> values;
    for (int i = 0; i < n_; ++i)
      values.push_back(std::pow(frequency_[index(i)], order) *
                       std::sin(frequency_[index(i)] * t + i + order * std::acos(0.0)));
    return values;
  }
  int mu() const {
    sfdae_characteristics c;
    sfdae_characteristics_init(&c, sizeof c);
    sfdae_get_characteristics(solver_, &c);
    return c.strangeness_index;
  }
  int chain() const { return chain_; }
  std::string message() const { return sfdae_message(solver_); }

  std::vector<double> x, xdot;

 private:
  int below(int bound) { return static_cast<int>(numbers_.uniform(0.0, bound - 1e-9)); }

  template <class Write>
  Pattern pattern_of(Write write_column) const {
    Pattern pattern;
    for (int j = 0; j < n_; ++j) {
      write_column(j, [&](int row, double) { pattern.row_index.push_back(rows_[index(row)]); });
      pattern.col_start.push_back(pattern.entries());
    }
    return pattern;
  }
  template <class Write>
  void write(const Pattern& pattern, double* to, Write write_column) const {
    for (int j = 0; j < n_; ++j)
      write_column(j, [&](int row, double value) {
        const int i = rows_[index(row)];
        if (matrices_ == SFDAE_MATRICES_DENSE) {
          to[i + j * n_] = value;
          return;
        }
        int e = pattern.col_start[index(j)];
        while (pattern.row_index[index(e)] != i) ++e;
        to[e] = value;
      });
  }
  // Entries of column j: add(row before the permutation, value).
  template <class Add>
  void write_E(double, int order, int j, Add add) const {
    const int first = differential_ + algebraic_;
    if (j < differential_) add(j, order == 0 ? 1.0 : 0.0);
    else if (j > first) add(j - 1, order == 0 ? 1.0 : 0.0);
  }
  template <class Add>
  void write_A(double t, int order, int j, Add add) const {
    const int first = differential_ + algebraic_;
    const double phase = order * std::acos(0.0);
    for (int i = 0; i < first; ++i) {
      const bool is_neighbour = neighbour_[index(i)] == j && i != j;
      if (i < differential_ && i == j) add(i, order == 0 ? -damping_[index(i)] : 0.0);
      else if (i < differential_ && is_neighbour) add(i, std::sin(t + phase));
      else if (i >= differential_ && i == j) add(i, (order == 0 ? 2.0 : 0.0) + std::cos(t + phase));
      else if (i >= differential_ && is_neighbour) add(i, order == 0 ? -1.0 : 0.0);
    }
    if (j >= first && j + 1 < n_) add(j, order == 0 ? 1.0 : 0.0);
    if (j == n_ - 1) add(j, order == 0 ? 1.0 + t : order == 1 ? 1.0 : 0.0);
  }
  // f = E x' - A x of the solution, and its derivatives; E is constant.
  int write_f(double t, int order, double* f) const {
    const std::vector<double> slope = exact(t, order + 1);
    for (int j = 0; j < n_; ++j) {
      write_E(t, 0, j, [&](int row, double value) { f[rows_[index(row)]] += value * slope[index(j)]; });
      double binomial = 1.0;
      for (int k = 0; k <= order; ++k) {
        const double x_j = exact(t, order - k)[index(j)];
        write_A(t, k, j, [&](int row, double value) { f[rows_[index(row)]] -= binomial * value * x_j; });
        binomial *= static_cast<double>(order - k) / (k + 1);
      }
    }
    return 0;
  }

  int matrices_;
  RandomNumbers numbers_;
  int differential_ = 0, algebraic_ = 0, chain_ = 0, n_ = 0;
  std::vector<int> rows_, neighbour_;
  std::vector<double> frequency_, damping_;
  Pattern E_, A_;
  sfdae_solver* solver_ = nullptr;
};

}  // namespace

TEST(LinearPatterns, GiveTheExactSolutionsByStructureAndByTheWholeArray) {
  const int count = scaled_count(300);
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const int form = trial % 2 == 0 ? SFDAE_MATRICES_COMPRESSED : SFDAE_MATRICES_DENSE;
    const int structure = trial % 3 == 2 ? SFDAE_STRUCTURE_AUTOMATIC : SFDAE_STRUCTURE_REQUIRED;
    LinearTwin twin(static_cast<unsigned>(trial + 1), form);
    const int method = trial % 4 < 2 ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU;
    ASSERT_TRUE(is_known(twin.integrate(options_of(structure, method)))) << twin.message();
    EXPECT_EQ(twin.mu(), twin.chain() - 1);
    EXPECT_LT(error_in_tolerances(twin.x, twin.exact(2.0)), 10.0);
  }
}

}  // namespace sfdae_test
