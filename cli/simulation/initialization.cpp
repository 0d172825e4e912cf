// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/initialization.h"

#include <algorithm>
#include <cmath>

#include "simulation/text.h"

namespace sfdae::cli {

namespace {

constexpr int max_iterations = 50, max_halvings = 12;
// Changes in units of scales: the finite-difference step, the change below which the iteration may end, and the largest
// residual that does not count as a contradiction.
constexpr double difference = 1e-6, converged = 1e-10, contradiction = 1e-6;
constexpr double unit_roundoff = 1.1e-16;
// Rounding errors of T2, times 1e10 because rows below 1e-10 of their level are zero (IndependentRows), times 100 for
// safety.
constexpr double level_of_roundoff = 1e12 * unit_roundoff;
// Shifts of starting values at which the equations are singular, in units of nominal values.
constexpr double nudges[] = {0.0, 1e-3, 0.1, 0.7};

// True also if the residual is undefined.
bool contradicts(double residual, double size) {
  return !std::isfinite(residual) || std::fabs(residual) > contradiction * size;
}

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
  return v >= 0 ? system_.sizes.nominal[at(v)] : 1.0;
}

double Initialization::scale(int unknown) const {
  const int v = modes_.unknowns()[at(unknown)];
  return v >= 0 ? system_.sizes.scale[at(v)] : 1.0;
}

bool Initialization::make_consistent(Mode& mode, sfdae::Point& point, const std::vector<int>& fixed) {
  sfdae::Point trial = point;
  if (calls_.attempt(mode, [&] { return mode.make_consistent(trial, fixed); }) < 0) return false;
  for (double value : trial.x)
    if (!std::isfinite(value)) return false;
  point = std::move(trial);
  return true;
}

std::string Initialization::undefined(const Values& values, const sfdae::Point& point) {
  const std::vector<double> all = residuals(values, point);
  const auto place_of = std::find_if(all.begin(), all.end(), [](double it) { return !std::isfinite(it); });
  if (place_of == all.end()) return "";
  const Condition& condition = conditions_[static_cast<std::size_t>(place_of - all.begin())];
  return place(system_.model, condition.at) + ": the initial condition " + condition.text +
         " is not defined at the start values, as log(-1) is not. Give better start values, or check the initial "
         "equations.";
}

// Keeps fixed values if possible. Starting values at which equations are singular or conditions undefined are shifted.
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
  const auto keep_first = [&](const std::string& message, int status) {
    if (first_message.empty()) first_message = message, first_status = status;
  };
  for (double nudge : nudges) {
    point = guess;
    for (int j = 0; j < static_cast<int>(point.x.size()); ++j)
      if (fixed[at(j)] == 0) point.x[at(j)] += nudge * nominal(j) * (1.0 + 0.37 * std::cos(1.0 + 2.0 * j));
    for (const std::vector<int>& flags : {fixed, none}) {
      sfdae::Point trial = point;
      const int status = calls_.attempt(mode, [&] { return mode.make_consistent(trial, flags); });
      const std::string unknown_condition = status >= 0 ? undefined(values, trial) : "";
      if (status >= 0 && unknown_condition.empty()) {
        point = std::move(trial);
        return;
      }
      if (status >= 0) keep_first(unknown_condition, SFDAE_NO_CONSISTENT_VALUES);
      else keep_first(calls_.message(), status);
    }
  }
  throw Failure(outcome_of(first_status, Phase::initialization), first_status, "initial values: " + first_message);
}

// B: columns of D^-1 T2, orthonormalized. Errors of T2 are amplified by 1 / |D^-1 T2| in the columns of B. Exact zeros,
// as for unknowns without constraints, have no errors.
sfdae::Matrix Initialization::basis(Mode& mode, const sfdae::Point& point, std::vector<double>& roundoff) {
  sfdae::Matrix T2;
  calls_.run(mode, Phase::initialization, "initial values", [&] {
    const int mu = mode.solver.characteristics().strangeness_index;
    T2 = mode.solver.projectors(point.t, mode.solver.jet(point.t, mu, point.x)).T2;
    return SFDAE_OK;
  });
  sfdae::Matrix B(T2.rows(), T2.columns());
  roundoff.assign(at(T2.rows()), 0.0);
  for (int k = 0; k < T2.columns(); ++k) {
    std::vector<double> column(at(T2.rows()));
    for (int j = 0; j < T2.rows(); ++j) column[at(j)] = T2(j, k) / scale(j);
    const double size = norm(column);
    for (int j = 0; j < T2.rows(); ++j)
      if (T2(j, k) != 0.0) roundoff[at(j)] = std::max(roundoff[at(j)], level_of_roundoff / size);
    for (int pass = 0; pass < 2; ++pass)
      for (int l = 0; l < k; ++l) {
        double factor = 0.0;
        for (int j = 0; j < T2.rows(); ++j) factor += column[at(j)] * B(j, l);
        for (int j = 0; j < T2.rows(); ++j) column[at(j)] -= factor * B(j, l);
      }
    const double remaining = norm(column);
    for (int j = 0; j < T2.rows(); ++j) B(j, k) = column[at(j)] / remaining;
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
      size = std::fabs(condition.factor) * scale(condition.unknown);
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

// The row of a condition on an unknown; zeros for an equation.
std::vector<double> Initialization::row_of(const Condition& condition, const sfdae::Matrix& B) const {
  std::vector<double> row(at(B.columns()), 0.0);
  for (int k = 0; k < B.columns() && condition.unknown >= 0; ++k)
    row[at(k)] = condition.factor * scale(condition.unknown) * B(condition.unknown, k);
  return row;
}

Initialization::Linearization Initialization::linearized(Mode& mode, const Values& values,
                                                         const sfdae::Point& point) {
  Linearization result;
  result.B = basis(mode, point, result.roundoff);
  result.residuals = residuals(values, point, &result.sizes);
  result.levels = result.sizes;
  for (std::size_t i = 0; i < conditions_.size(); ++i) {
    const Condition& condition = conditions_[i];
    result.rows.push_back(row_of(condition, result.B));
    if (condition.unknown >= 0)
      result.levels[i] =
          std::fabs(condition.factor) * std::max(scale(condition.unknown), result.roundoff[at(condition.unknown)]);
  }
  const std::vector<int> others = add_exact_rows(values, point, result);
  if (!others.empty()) add_difference_rows(mode, values, point, others, result);
  return result;
}

// Rows of equations by their gradients, times D B. Returns the conditions that need finite differences instead: they
// contain der(), whose derivatives are unknown, or their gradient is zero or not finite.
std::vector<int> Initialization::add_exact_rows(Values values, const sfdae::Point& point, Linearization& result) {
  Tape tape(system_.formulas);
  std::vector<int> exact, others;
  std::vector<Formula> sides;
  for (int i = 0; i < static_cast<int>(conditions_.size()); ++i) {
    const Condition& condition = conditions_[at(i)];
    if (condition.unknown >= 0) continue;
    const bool has_derivative = system_.formulas.depends(condition.left, on_derivative) ||
                                system_.formulas.depends(condition.right, on_derivative);
    (has_derivative ? others : exact).push_back(i);
    if (has_derivative) continue;
    for (Formula side : {condition.left, condition.right}) tape.add(side), sides.push_back(side);
  }
  if (exact.empty()) return others;
  modes_.to_values(point, values);
  tape.evaluate(values);
  std::vector<double> direction(values.variable.size(), 0.0), sizes(exact.size(), 0.0), errors(exact.size(), 0.0);
  std::vector<char> occurs(values.variable.size(), 0);
  for (Formula part : system_.formulas.parts(sides))
    if (system_.formulas[part].operation == Operation::variable) occurs[at(system_.formulas[part].index)] = 1;
  for (int j = 0; j < result.B.rows(); ++j) {
    const int v = modes_.unknowns()[at(j)];
    if (v < 0 || occurs[at(v)] == 0) continue;
    direction[at(v)] = 1.0;
    tape.differentiate(direction);
    direction[at(v)] = 0.0;
    for (std::size_t e = 0; e < exact.size(); ++e) {
      const double entry = tape.tangent(2 * static_cast<int>(e)) - tape.tangent(2 * static_cast<int>(e) + 1);
      if (entry == 0.0) continue;
      sizes[e] = std::hypot(sizes[e], entry * scale(j));
      errors[e] += std::fabs(entry) * result.roundoff[at(j)];
      for (int k = 0; k < result.B.columns(); ++k)
        result.rows[at(exact[e])][at(k)] += entry * scale(j) * result.B(j, k);
    }
  }
  for (std::size_t e = 0; e < exact.size(); ++e) {
    if (sizes[e] > 0.0 && std::isfinite(sizes[e])) result.levels[at(exact[e])] = std::max(sizes[e], errors[e]);
    else others.push_back(exact[e]);
  }
  std::sort(others.begin(), others.end());
  return others;
}

void Initialization::add_difference_rows(Mode& mode, const Values& values, const sfdae::Point& point,
                                         const std::vector<int>& conditions, Linearization& result) {
  const bool has_derivatives = std::any_of(conditions.begin(), conditions.end(), [&](int i) {
    return system_.formulas.depends(conditions_[at(i)].left, on_derivative) ||
           system_.formulas.depends(conditions_[at(i)].right, on_derivative);
  });
  const std::vector<int> none(point.x.size(), 0);
  for (int i : conditions) result.levels[at(i)] = 0.0;
  for (int k = 0; k < result.B.columns(); ++k) {
    // The step is the geometric mean of those for the scale and for the nominal value: a small start value may have the
    // size of the solution, or be a bad initial guess of a large one.
    double step = 0.0;
    for (int j = 0; j < result.B.rows(); ++j) step += std::pow(result.B(j, k), 2) * nominal(j) / scale(j);
    step = difference * std::sqrt(step);
    sfdae::Point moved = point;
    for (int j = 0; j < result.B.rows(); ++j) moved.x[at(j)] += step * scale(j) * result.B(j, k);
    if (has_derivatives && !make_consistent(mode, moved, none))
      throw Failure(Outcome::not_started, SFDAE_NO_CONSISTENT_VALUES, "initial values: " + calls_.message());
    const std::vector<double> there = residuals(values, moved);
    for (int i : conditions) {
      result.rows[at(i)][at(k)] = (there[at(i)] - result.residuals[at(i)]) / step;
      result.levels[at(i)] = std::max(result.levels[at(i)], result.sizes[at(i)] * difference / step);
    }
  }
}

Initialization::Selection Initialization::selected(const Linearization& linearization) const {
  Selection result;
  for (int i = 0; i < static_cast<int>(conditions_.size()); ++i) {
    if (result.rows.add(linearization.rows[at(i)], linearization.levels[at(i)])) {
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
                             const std::vector<double>& z, int halvings) {
  const auto merit = [&](const std::vector<double>& r) {
    double sum = 0.0;
    for (int i : selection.chosen) sum += std::pow(r[at(i)] / norm(linearization.rows[at(i)]), 2);
    return std::isfinite(sum) ? sum : HUGE_VAL;
  };
  const double before = merit(linearization.residuals);
  double factor = 1.0;
  for (int halving = 0; halving < halvings; ++halving, factor *= 0.5) {
    sfdae::Point trial = point;
    for (int j = 0; j < linearization.B.rows(); ++j)
      for (int k = 0; k < linearization.B.columns(); ++k)
        trial.x[at(j)] += factor * scale(j) * linearization.B(j, k) * z[at(k)];
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
    if (after < before) {
      point = std::move(trial);
      return true;
    }
  }
  return false;
}

// Adds start values if there are too few conditions.
Initialization::Linearization Initialization::completed(Mode& mode, const Values& values, const sfdae::Point& point,
                                                        const Linearization& linearization) {
  IndependentRows rows = selected(linearization).rows;
  const std::size_t num_wanted = conditions_.size();
  for (const Condition& wish : wishes_)
    if (wish.unknown < 0) conditions_.push_back(wish);  // an equation
  const Linearization of_equations =
      conditions_.size() > num_wanted ? linearized(mode, values, point) : Linearization();
  std::size_t equation = num_wanted;
  std::vector<Condition> chosen;
  for (const Condition& wish : wishes_) {
    const bool is_equation = wish.unknown < 0;
    const bool is_independent =
        is_equation ? rows.add(of_equations.rows[equation], of_equations.levels[equation])
                    : rows.add(row_of(wish, linearization.B),
                               std::max(scale(wish.unknown), linearization.roundoff[at(wish.unknown)]));
    if (is_equation) ++equation;
    if (is_independent) chosen.push_back(wish);
  }
  conditions_.resize(num_wanted);
  if (chosen.empty()) return linearization;
  conditions_.insert(conditions_.end(), chosen.begin(), chosen.end());
  return linearized(mode, values, point);
}

void Initialization::solve(Values& values, sfdae::Point& point, const std::vector<Condition>& more) {
  warnings_.clear();
  conditions_.resize(num_given_);
  conditions_.insert(conditions_.end(), more.begin(), more.end());
  const std::size_t num_wanted = conditions_.size();
  const std::shared_ptr<Mode> mode = modes_.at_values(values);
  find_start(*mode, values, point);
  Linearization linearization = linearized(*mode, values, point);
  if (selected(linearization).rows.size() < linearization.B.columns())
    linearization = completed(*mode, values, point, linearization);
  Selection selection = selected(linearization);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    std::vector<double> b;
    for (double residual : selection.residuals) b.push_back(-residual);
    const std::vector<double> z = selection.rows.solve(b);
    double size = 0.0;
    for (double value : z) size = std::max(size, std::fabs(value));
    if (size == 0.0) break;
    const bool is_close = size <= converged;
    const bool is_last = iteration + 1 == max_iterations;
    const bool is_better =
        !is_last && improve(*mode, values, point, linearization, selection, z, is_close ? 1 : max_halvings);
    if (is_close && !is_better) break;
    if (!is_better) {
      report(linearization, selection);
      std::string worst;
      for (int i : selection.chosen)
        if (contradicts(linearization.residuals[at(i)], linearization.sizes[at(i)]))
          worst += (worst.empty() ? "" : "; ") + place(system_.model, conditions_[at(i)].at) + ": " +
                   conditions_[at(i)].text + " is off by " + to_text(linearization.residuals[at(i)]);
      if (worst.empty()) break;  // rounding errors allow no better
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
    if (contradicts(residual, linearization.sizes[at(i)]))
      throw Failure(Outcome::not_started, SFDAE_FIXED_VALUES,
                    where + "the initial condition " + condition.text +
                        " contradicts the equations and the other initial conditions: it is violated by " +
                        to_text(residual));
    warnings_.push_back(where + "the initial condition " + condition.text +
                        " follows from the others and is not needed");
  }
}

}  // namespace sfdae::cli
