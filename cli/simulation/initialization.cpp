// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/initialization.h"

#include <algorithm>
#include <cmath>

#include "simulation/text.h"

namespace sfdae::cli {

namespace {

constexpr int max_iterations = 50, max_halvings = 12;
// Changes in units of nominal values: of differences, that end the iteration, and that contradictions may have.
constexpr double difference = 1e-6, converged = 1e-10, contradiction = 1e-6;
// Guesses at which equations are singular are moved by these, in units of nominal values.
constexpr double nudges[] = {0.0, 1e-3, 0.1, 0.7};

std::string joined(const std::vector<std::string>& texts) {
  std::string result;
  for (const std::string& text : texts) result += (result.empty() ? "" : ", ") + text;
  return result;
}

}  // namespace

Initialization::Initialization(const System& system, Modes& modes, LibraryCalls& calls)
    : system_(system),
      modes_(modes),
      calls_(calls),
      conditions_(given_conditions(system, modes.unknowns())),
      wishes_(possible_conditions(system, modes.unknowns())),
      num_given_(conditions_.size()) {}

double Initialization::nominal(int unknown) const {
  const int v = modes_.unknowns()[at(unknown)];
  return v >= 0 ? system_.nominal[at(v)] : 1.0;
}

bool Initialization::make_consistent(Mode& mode, sfdae::Point& point, const std::vector<int>& fixed) {
  sfdae::Point trial = point;
  if (calls_.attempt(mode, [&] { return mode.make_consistent(trial, fixed); }) < 0) return false;
  for (double value : trial.x)
    if (!std::isfinite(value)) return false;
  point = std::move(trial);
  return true;
}

// Fixed values stay if they can. A guess where the equations are singular is moved a little.
void Initialization::find_start(Mode& mode, Values& values, sfdae::Point& point) {
  modes_.to_point(values, point);
  std::vector<int> fixed(point.x.size(), 0), none(point.x.size(), 0);
  for (const Condition& condition : conditions_)
    if (condition.unknown >= 0) {
      point.x[at(condition.unknown)] = condition.value;
      fixed[at(condition.unknown)] = 1;
    }
  const sfdae::Point guess = point;
  std::string first_message;
  int first_status = 0;
  for (double nudge : nudges) {
    point = guess;
    for (int j = 0; j < static_cast<int>(point.x.size()); ++j)
      if (fixed[at(j)] == 0) point.x[at(j)] += nudge * nominal(j) * (1.0 + 0.37 * std::cos(1.0 + 2.0 * j));
    for (const std::vector<int>& flags : {fixed, none}) {
      sfdae::Point trial = point;
      const int status = calls_.attempt(mode, [&] { return mode.make_consistent(trial, flags); });
      if (status >= 0) {
        point = std::move(trial);
        return;
      }
      if (first_message.empty()) first_message = calls_.message(), first_status = status;
    }
  }
  throw Failure(outcome_of(first_status, Phase::initialization), first_status, "initial values: " + first_message);
}

// B: columns of D^-1 T2, orthonormalized.
sfdae::Matrix Initialization::basis(Mode& mode, const sfdae::Point& point) {
  sfdae::Matrix T2;
  calls_.run(mode, Phase::initialization, "initial values", [&] {
    const int mu = mode.solver.characteristics().strangeness_index;
    T2 = mode.solver.projectors(point.t, mode.solver.jet(point.t, mu, point.x)).T2;
    return SFDAE_OK;
  });
  sfdae::Matrix B(T2.rows(), T2.columns());
  for (int k = 0; k < T2.columns(); ++k) {
    std::vector<double> column(at(T2.rows()));
    for (int j = 0; j < T2.rows(); ++j) column[at(j)] = T2(j, k) / nominal(j);
    for (int pass = 0; pass < 2; ++pass)
      for (int l = 0; l < k; ++l) {
        double factor = 0.0;
        for (int j = 0; j < T2.rows(); ++j) factor += column[at(j)] * B(j, l);
        for (int j = 0; j < T2.rows(); ++j) column[at(j)] -= factor * B(j, l);
      }
    double norm = 0.0;
    for (double value : column) norm += value * value;
    for (int j = 0; j < T2.rows(); ++j) B(j, k) = column[at(j)] / std::sqrt(norm);
  }
  return B;
}

std::vector<double> Initialization::residuals(Values values, const sfdae::Point& point, std::vector<double>* sizes) {
  modes_.to_values(point, values);
  Tape tape(system_.formulas);
  for (const Condition& condition : conditions_) {
    if (condition.unknown >= 0) continue;
    tape.add(condition.left);
    tape.add(condition.right);
  }
  tape.run(values);
  std::vector<double> result;
  int next = 0;
  for (const Condition& condition : conditions_) {
    double left = 0.0, right = condition.value, size = 0.0;
    if (condition.unknown >= 0) {
      left = condition.factor * point.x[at(condition.unknown)];
      right = condition.factor * condition.value;
      size = std::fabs(condition.factor) * nominal(condition.unknown);
    } else {
      left = tape[next];
      right = tape[next + 1];
      next += 2;
    }
    result.push_back(left - right);
    if (sizes != nullptr) sizes->push_back(std::max({size, std::fabs(left), std::fabs(right)}));
  }
  return result;
}

Initialization::Linearization Initialization::linearized(Mode& mode, const Values& values,
                                                         const sfdae::Point& point) {
  Linearization result;
  result.B = basis(mode, point);
  result.residuals = residuals(values, point, &result.sizes);
  const int n = result.B.rows(), d = result.B.columns();
  bool has_equations = false, has_derivatives = false;
  for (const Condition& condition : conditions_) {
    std::vector<double> row(at(d), 0.0);
    for (int k = 0; k < d && condition.unknown >= 0; ++k)
      row[at(k)] = condition.factor * nominal(condition.unknown) * result.B(condition.unknown, k);
    result.rows.push_back(row);
    if (condition.unknown >= 0) continue;
    has_equations = true;
    has_derivatives = has_derivatives || system_.formulas.depends(condition.left, on_derivative) ||
                      system_.formulas.depends(condition.right, on_derivative);
  }
  if (!has_equations) return result;
  const std::vector<int> none(point.x.size(), 0);
  for (int k = 0; k < d; ++k) {
    sfdae::Point moved = point;
    for (int j = 0; j < n; ++j) moved.x[at(j)] += difference * nominal(j) * result.B(j, k);
    if (has_derivatives && !make_consistent(mode, moved, none))
      throw Failure(Outcome::not_started, SFDAE_NO_CONSISTENT_VALUES, "initial values: " + calls_.message());
    const std::vector<double> there = residuals(values, moved);
    for (std::size_t i = 0; i < conditions_.size(); ++i)
      if (conditions_[i].unknown < 0) result.rows[i][at(k)] = (there[i] - result.residuals[i]) / difference;
  }
  return result;
}

Initialization::Selection Initialization::selected(const Linearization& linearization) const {
  Selection result;
  for (int i = 0; i < static_cast<int>(conditions_.size()); ++i) {
    if (result.rows.add(linearization.rows[at(i)], linearization.sizes[at(i)])) {
      result.chosen.push_back(i);
      result.residuals.push_back(linearization.residuals[at(i)]);
    } else {
      result.dropped.push_back(i);
    }
  }
  return result;
}

bool Initialization::improve(Mode& mode, const Values& values, sfdae::Point& point,
                             const Linearization& linearization, const Selection& selection,
                             const std::vector<double>& z) {
  const auto merit = [&](const std::vector<double>& r) {
    double sum = 0.0;
    for (int i : selection.chosen) {
      double norm = 0.0;
      for (double entry : linearization.rows[at(i)]) norm += entry * entry;
      sum += r[at(i)] * r[at(i)] / norm;
    }
    return std::isfinite(sum) ? sum : HUGE_VAL;
  };
  const double before = merit(linearization.residuals);
  double factor = 1.0;
  for (int halving = 0; halving < max_halvings; ++halving, factor *= 0.5) {
    sfdae::Point trial = point;
    for (int j = 0; j < linearization.B.rows(); ++j)
      for (int k = 0; k < linearization.B.columns(); ++k)
        trial.x[at(j)] += factor * nominal(j) * linearization.B(j, k) * z[at(k)];
    std::vector<int> fixed(trial.x.size(), 0);
    for (int i : selection.chosen)
      if (factor == 1.0 && conditions_[at(i)].unknown >= 0) {
        trial.x[at(conditions_[at(i)].unknown)] = conditions_[at(i)].value;
        fixed[at(conditions_[at(i)].unknown)] = 1;
      }
    const bool is_consistent =
        make_consistent(mode, trial, fixed) || make_consistent(mode, trial, std::vector<int>(trial.x.size(), 0));
    if (!is_consistent) continue;
    const double after = merit(residuals(values, trial));
    if (after < before || after <= converged * converged) {
      point = std::move(trial);
      return true;
    }
  }
  return false;
}

void Initialization::solve(Values& values, sfdae::Point& point, const std::vector<Condition>& more) {
  warnings_.clear();
  conditions_.resize(num_given_);
  conditions_.insert(conditions_.end(), more.begin(), more.end());
  const std::size_t num_wanted = conditions_.size();
  const std::shared_ptr<Mode> mode = modes_.at_values(values);
  find_start(*mode, values, point);
  Linearization linearization = linearized(*mode, values, point);
  Selection selection = selected(linearization);
  if (selection.rows.size() < linearization.B.columns()) {
    const std::size_t before = conditions_.size();
    IndependentRows rows = selection.rows;
    for (const Condition& wish : wishes_) {
      std::vector<double> row(at(linearization.B.columns()));
      for (int k = 0; k < linearization.B.columns(); ++k)
        row[at(k)] = nominal(wish.unknown) * linearization.B(wish.unknown, k);
      if (rows.add(row, nominal(wish.unknown))) conditions_.push_back(wish);
    }
    if (conditions_.size() > before) {
      linearization = linearized(*mode, values, point);
      selection = selected(linearization);
    }
  }
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    std::vector<double> b;
    for (double residual : selection.residuals) b.push_back(-residual);
    const std::vector<double> z = selection.rows.solve(b);
    double size = 0.0;
    for (double value : z) size = std::max(size, std::fabs(value));
    if (size <= converged) break;
    if (iteration + 1 == max_iterations || !improve(*mode, values, point, linearization, selection, z)) {
      report(linearization, selection);
      std::string worst;
      for (int i : selection.chosen)
        if (std::fabs(linearization.residuals[at(i)]) > contradiction * linearization.sizes[at(i)])
          worst += (worst.empty() ? "" : "; ") + place(system_.model, conditions_[at(i)].at) + ": " +
                   conditions_[at(i)].text + " is off by " + to_text(linearization.residuals[at(i)]);
      if (worst.empty()) break;  // rounding allows no better
      throw Failure(Outcome::not_started, SFDAE_NO_CONSISTENT_VALUES,
                    "no initial values were found near the start values; " + worst +
                        ". Give better start values, or check the initial equations.");
    }
    linearization = linearized(*mode, values, point);
    selection = selected(linearization);
  }
  report(linearization, selection);
  if (conditions_.size() > num_wanted) {
    std::vector<std::string> texts;
    for (std::size_t i = num_wanted; i < conditions_.size(); ++i) texts.push_back(conditions_[i].text);
    warnings_.push_back(std::to_string(texts.size()) + " initial condition" + (texts.size() > 1 ? "s are" : " is") +
                        " missing; start values are used: " + joined(texts));
  }
  modes_.to_values(point, values);
}

void Initialization::report(const Linearization& linearization, const Selection& selection) {
  for (int i : selection.dropped) {
    const Condition& condition = conditions_[at(i)];
    const double residual = linearization.residuals[at(i)];
    const std::string where = place(system_.model, condition.at) + ": ";
    if (std::fabs(residual) > contradiction * linearization.sizes[at(i)])
      throw Failure(Outcome::not_started, SFDAE_FIXED_VALUES,
                    where + "the initial condition " + condition.text +
                        " contradicts the equations and the other initial conditions: it is violated by " +
                        to_text(residual));
    warnings_.push_back(where + "the initial condition " + condition.text +
                        " follows from the others and is not needed");
  }
}

}  // namespace sfdae::cli
