// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "system.h"

namespace campaign {

namespace {

// Entries of the Jacobian of a copy that are not zero, by columns.
struct Pattern {
  std::vector<int> rows, columns;
};

// What is evaluated for a copy: residuals, entries of F_x, entries of F_xdot.
struct CopyPrograms {
  Program recorded, residuals, F_x, F_xdot;
  Pattern x_pattern, xdot_pattern;

  explicit CopyPrograms(const SmallProblem& problem)
      : recorded(*problem.formulas, problem.residuals, Purpose::recording) {
    F_x = jacobian(problem, Operation::unknown, x_pattern);
    F_xdot = jacobian(problem, Operation::slope, xdot_pattern);
    residuals = Program(*problem.formulas, problem.residuals);
  }
  static Program jacobian(const SmallProblem& problem, Operation variable, Pattern& pattern) {
    std::vector<Formula> entries;
    for (int j = 0; j < problem.num_unknowns(); ++j) {
      for (int i = 0; i < problem.num_unknowns(); ++i) {
        const Formula entry = derivative(problem.residuals[static_cast<std::size_t>(i)], variable, j);
        if (problem.formulas->is_number(entry.node, 0.0)) continue;
        entries.push_back(entry);
        pattern.rows.push_back(i);
        pattern.columns.push_back(j);
      }
    }
    return Program(*problem.formulas, entries);
  }
};

class Equations final : public System {
 public:
  Equations(const Case& problem, const Variant& variant, const std::vector<std::unique_ptr<Reference>>& references)
      : System(problem, variant, references) {
    for (const SmallProblem& data : problem.copies) programs_.emplace_back(data);
    make_pattern(x_start_, x_rows_, true);
    make_pattern(xdot_start_, xdot_rows_, false);
  }

  int size() const override { return problem_.num_copies * n() + (variant_.has_sum ? 1 : 0); }
  int create(sfdae_solver** solver, const sfdae_options& options) override;
  std::vector<double> start() const override;
  std::vector<double> solution(std::size_t output) const override;
  std::vector<double> sizes() const override;
  std::vector<double> perturbed(std::size_t output, double rtol, const std::vector<double>& atol) const override;
  std::string text() const override;

 private:
  int n() const { return problem_.copies[0].num_unknowns(); }
  void make_pattern(std::vector<int>& start, std::vector<int>& rows, bool of_x) const;
  // Of values of all copies, those of the library: in its units, with the sum.
  template <class Values>
  std::vector<double> assembled(Values values) const;
  int record(sfdae_expression t, const sfdae_expression* X, const sfdae_expression* slopes,
             sfdae_expression* residual) const;
  int differentiate(double t, int order, const double* jet, const std::array<double*, 3>& results) const;
  int expand_copy(int k, int order, const std::vector<std::vector<TaylorSeries>>& jets,
                  const std::array<double*, 3>& results) const;

  std::vector<CopyPrograms> programs_;
  std::vector<int> x_start_, x_rows_, xdot_start_, xdot_rows_;
};

void Equations::make_pattern(std::vector<int>& start, std::vector<int>& rows, bool of_x) const {
  start = {0};
  for (int k = 0; k < problem_.num_copies; ++k) {
    const CopyPrograms& programs = programs_[data_of(k)];
    const Pattern& pattern = of_x ? programs.x_pattern : programs.xdot_pattern;
    for (int j = 0; j < n(); ++j) {
      for (std::size_t e = 0; e < pattern.rows.size(); ++e)
        if (pattern.columns[e] == j) rows.push_back(k * n() + pattern.rows[e]);
      if (of_x && j == 0 && variant_.has_sum) rows.push_back(size() - 1);
      start.push_back(static_cast<int>(rows.size()));
    }
  }
  if (!variant_.has_sum) return;
  if (of_x) rows.push_back(size() - 1);
  start.push_back(static_cast<int>(rows.size()));
}

template <class Values>
std::vector<double> Equations::assembled(Values values) const {
  std::vector<double> result;
  double sum = 0.0;
  for (int k = 0; k < problem_.num_copies; ++k) {
    const std::vector<double>& x = values(k);
    for (int j = 0; j < n(); ++j) result.push_back(unit(k * n() + j) * x[static_cast<std::size_t>(j)]);
    sum += x[0];
  }
  if (variant_.has_sum) result.push_back(unit(size() - 1) * sum);
  return result;
}

std::vector<double> Equations::start() const {
  return assembled([&](int k) { return reference(k).start(); });
}
std::vector<double> Equations::solution(std::size_t output) const {
  return assembled([&](int k) { return reference(k).values()[output]; });
}
std::vector<double> Equations::sizes() const {
  return assembled([&](int k) { return reference(k).sizes(); });
}

std::vector<double> Equations::perturbed(std::size_t output, double rtol, const std::vector<double>& atol) const {
  return assembled([&](int k) {
    std::vector<double> own;
    for (int j = 0; j < n(); ++j) own.push_back(atol[static_cast<std::size_t>(k * n() + j)] / unit(k * n() + j));
    return reference(k).perturbed(output, rtol, own);
  });
}

std::string Equations::text() const {
  std::string result;
  for (std::size_t k = 0; k < problem_.copies.size(); ++k) {
    const SmallProblem& data = problem_.copies[k];
    result += "copy " + std::to_string(k) + ":\n";
    for (const Formula& residual : data.residuals)
      result += "  0 = " + data.formulas->text(residual, data.names) + "\n";
    for (std::size_t j = 0; j < data.names.size(); ++j)
      result += "  " + data.names[j] + "(0) = " + std::to_string(references_[k]->start()[j]) + "\n";
  }
  if (variant_.has_sum) result += "further unknown: the sum of the first unknowns of all copies\n";
  return result;
}

int Equations::record(sfdae_expression t, const sfdae_expression* X, const sfdae_expression* slopes,
                      sfdae_expression* residual) const {
  const auto scaled = [](double factor, sfdae_expression a) {
    return factor == 1.0 ? a : sfdae_multiply(sfdae_number(factor), a);
  };
  sfdae_expression sum = sfdae_number(0.0);
  for (int k = 0; k < problem_.num_copies; ++k) {
    std::vector<sfdae_expression> x, xdot;
    for (int j = k * n(); j < (k + 1) * n(); ++j) {
      x.push_back(scaled(1.0 / unit(j), X[j]));
      xdot.push_back(scaled(variant_.time_unit / unit(j), slopes[j]));
    }
    const auto values = programs_[data_of(k)].recorded.record(scaled(1.0 / variant_.time_unit, t), x, xdot);
    std::copy(values.begin(), values.end(), residual + k * n());
    sum = sfdae_add(sum, x[0]);
  }
  if (variant_.has_sum) residual[size() - 1] = sfdae_subtract(scaled(1.0 / unit(size() - 1), X[size() - 1]), sum);
  return 0;
}

// jets: series of t, x and slopes. results: F, F_x, F_xdot.
int Equations::expand_copy(int k, int order, const std::vector<std::vector<TaylorSeries>>& jets,
                           const std::array<double*, 3>& results) const {
  const CopyPrograms& programs = programs_[data_of(k)];
  double factor = 1.0;
  for (int i = 2; i <= order; ++i) factor *= i;
  std::vector<TaylorSeries> values;
  programs.residuals.expand(order, jets[0][0], jets[1], jets[2], values);
  for (std::size_t i = 0; i < values.size(); ++i)
    results[0][k * n() + static_cast<int>(i)] = factor * coefficient(values[i], order);
  for (std::size_t which = 1; which <= 2; ++which) {
    if (results[which] == nullptr) continue;
    const bool of_x = which == 1;
    (of_x ? programs.F_x : programs.F_xdot).expand(order, jets[0][0], jets[1], jets[2], values);
    const Pattern& pattern = of_x ? programs.x_pattern : programs.xdot_pattern;
    const std::vector<int>& start = of_x ? x_start_ : xdot_start_;
    int place = start[static_cast<std::size_t>(k * n())], column = -1;
    for (std::size_t e = 0; e < values.size(); ++e) {
      const int j = k * n() + pattern.columns[e], row = k * n() + pattern.rows[e];
      if (j != column) place = start[static_cast<std::size_t>(j)];
      column = j;
      const double entry = factor * coefficient(values[e], order) / unit(j) * (of_x ? 1.0 : variant_.time_unit);
      const bool compressed = variant_.formulation == Formulation::compressed;
      results[which][compressed ? place++ : row + j * size()] = entry;
    }
  }
  return 0;
}

int Equations::differentiate(double t, int order, const double* jet, const std::array<double*, 3>& results) const {
  if (order >= highest_taylor_order) return SFDAE_ORDER_NOT_AVAILABLE;
  const double T = variant_.time_unit;
  const int N = size();
  // The series of X_j, or of its slope, divided by its unit.
  const auto series = [&](int j, int shift) {
    TaylorSeries result{};
    double factor = (shift == 1 ? T : 1.0) / unit(j);
    for (int k = 0; k <= order; ++k) {
      coefficient(result, k) = factor * jet[j + (k + shift) * N];
      factor /= k + 1;
    }
    return result;
  };
  double sum = 0.0;
  for (int k = 0; k < problem_.num_copies; ++k) {
    std::vector<std::vector<TaylorSeries>> jets = {{TaylorSeries{t / T, 1.0 / T}}, {}, {}};
    for (int j = k * n(); j < (k + 1) * n(); ++j) {
      jets[1].push_back(series(j, 0));
      jets[2].push_back(series(j, 1));
    }
    expand_copy(k, order, jets, results);
    sum += jet[k * n() + order * N] / unit(k * n());
  }
  if (!variant_.has_sum) return 0;
  results[0][N - 1] = jet[N - 1 + order * N] / unit(N - 1) - sum;
  if (results[1] == nullptr || order > 0) return 0;
  const bool compressed = variant_.formulation == Formulation::compressed;
  for (int k = 0; k <= problem_.num_copies; ++k) {
    const int j = k * n();
    const double entry = (k == problem_.num_copies ? 1.0 : -1.0) / unit(j);
    results[1][compressed ? x_start_[static_cast<std::size_t>(j) + 1] - 1 : N - 1 + j * N] = entry;
  }
  return 0;
}

int Equations::create(sfdae_solver** solver, const sfdae_options& options) {
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = size();
  problem.user = this;
  if (!has_callbacks(variant_.formulation)) {
    problem.equations = [](sfdae_record*, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                           sfdae_expression* residual,
                           void* user) { return static_cast<Equations*>(user)->record(t, x, xdot, residual); };
    return sfdae_create_nonlinear(solver, &problem, &options);
  }
  problem.total_derivative = [](double t, int order, const double* jet, double* F, double* F_x, double* F_xdot,
                                void* user) {
    return static_cast<Equations*>(user)->differentiate(t, order, jet, {F, F_x, F_xdot});
  };
  if (variant_.formulation != Formulation::dense) {
    problem.F_x_entries = static_cast<int>(x_rows_.size());
    problem.F_x_col_start = x_start_.data();
    problem.F_x_row_index = x_rows_.data();
    problem.F_xdot_entries = static_cast<int>(xdot_rows_.size());
    problem.F_xdot_col_start = xdot_start_.data();
    problem.F_xdot_row_index = xdot_rows_.data();
    problem.matrices =
        variant_.formulation == Formulation::compressed ? SFDAE_MATRICES_COMPRESSED : SFDAE_MATRICES_DIFFERENCES;
  }
  return sfdae_create_nonlinear(solver, &problem, &options);
}

}  // namespace

std::unique_ptr<System> make_equations(const Case& problem, const Variant& variant,
                                       const std::vector<std::unique_ptr<Reference>>& references) {
  return std::make_unique<Equations>(problem, variant, references);
}

}  // namespace campaign
