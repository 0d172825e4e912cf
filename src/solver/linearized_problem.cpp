// SPDX-License-Identifier: BSD-3-Clause
#include "solver/linearized_problem.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "linalg/index.h"
#include "problem/parameter_derivatives.h"

namespace sfdae::core {

namespace {

void demand_list(const char* name, int count, const void* list) {
  if (count < 0 || count > most_dense_unknowns)
    refuse_argument(format("num_%s = %d; it must be 0 ... %d.", name, count, most_dense_unknowns));
  if (count > 0 && list == nullptr) refuse_argument(format("num_%s = %d, but %s is NULL.", name, count, name));
}

void demand_finite(const char* name, const double* values, std::size_t count) {
  if (!all_finite(values, count)) refuse_argument(format("%s contains NaN or Inf.", name));
}

void demand_unknowns(const char* name, int count, const int* unknowns, int n) {
  demand_list(name, count, unknowns);
  for (int k = 0; k < count; ++k)
    if (unknowns[k] < 0 || unknowns[k] >= n)
      refuse_argument(format("%s[%d] = %d; unknowns are 0 ... %d.", name, k, unknowns[k], n - 1));
}

void demand_no_repetition(const sfdae_linearization& choice) {
  std::vector<int> sorted(choice.input_unknowns, choice.input_unknowns + choice.num_input_unknowns);
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) refuse_argument(format("input_unknowns contains %d twice.", *twice));
}

void check(const sfdae_linearization& choice, int m, int n) {
  if (m > most_dense_unknowns || n > most_dense_unknowns)
    refuse_argument(
        format("%d equations in %d unknowns; linearizations have at most %d.", m, n, most_dense_unknowns));
  if (!std::isfinite(choice.t)) refuse_argument(format("t is %g.", choice.t));
  if (choice.xdot != nullptr && choice.x == nullptr) refuse_argument("xdot is given, but x is NULL.");
  if (choice.x != nullptr) demand_finite("x", choice.x, index(n));
  if (choice.xdot != nullptr) demand_finite("xdot", choice.xdot, index(n));
  demand_list("input_parameters", choice.num_input_parameters, choice.input_parameters);
  demand_unknowns("input_unknowns", choice.num_input_unknowns, choice.input_unknowns, n);
  if (choice.num_input_unknowns > 0) demand_no_repetition(choice);
  demand_list("input_columns", choice.num_input_columns, choice.input_columns);
  demand_finite("input_columns", choice.input_columns, index(m) * index(choice.num_input_columns));
  demand_unknowns("output_unknowns", choice.num_output_unknowns, choice.output_unknowns, n);
  demand_list("output_rows", choice.num_output_rows, choice.output_rows);
  demand_finite("output_rows", choice.output_rows, index(n) * index(choice.num_output_rows));
}

// Recorded equations F, whatever the kind of problem.
class Equations {
 public:
  explicit Equations(Solver& solver) {
    if (solver.model.multibody() == nullptr) {
      evaluator_ = solver.model.evaluator();
    } else if (solver.model.evaluator() != nullptr) {
      first_order_ = solver.model.multibody()->recorded_first_order_problem();
      evaluator_ = &first_order_->evaluator();
    }
  }
  // Null if there are none.
  const TaylorEvaluator* evaluator() const { return evaluator_; }

 private:
  std::unique_ptr<RecordedProblem> first_order_;
  const TaylorEvaluator* evaluator_ = nullptr;
};

std::vector<int> numbers_of_parameters(const sfdae_linearization& choice, const TaylorEvaluator* evaluator) {
  std::vector<int> numbers;
  if (choice.num_input_parameters > 0 && evaluator == nullptr)
    refuse_argument("input_parameters are those of recorded equations; for callbacks give input_columns.");
  for (int k = 0; k < choice.num_input_parameters; ++k) {
    const char* const name = choice.input_parameters[k];
    if (name == nullptr) refuse_argument(format("input_parameters[%d] is NULL.", k));
    const auto found = evaluator->find_parameter(name);
    if (!found) refuse_argument(format("there is no parameter \"%.60s\" in the equations.", name));
    if (std::find(numbers.begin(), numbers.end(), *found) != numbers.end())
      refuse_argument(format("the parameter \"%.60s\" is named twice.", name));
    numbers.push_back(*found);
  }
  return numbers;
}

// x and x', order 1. Both are 0 for linear problems of which only the matrices matter.
Jet point_of(Solver& solver, const sfdae_linearization& choice, bool solution_counts) {
  const std::size_t n = index(solver.model.n());
  Jet point;
  point.t = choice.t;
  point.n = solver.model.n();
  point.order = 1;
  if (choice.xdot != nullptr) {
    point.x.assign(choice.x, choice.x + n);
    point.x.insert(point.x.end(), choice.xdot, choice.xdot + n);
    return point;
  }
  if (!solution_counts) {
    point.x.assign(2 * n, 0.0);
    return point;
  }
  if (solver.system() == nullptr)
    throw Failure(SFDAE_NOT_STARTED,
                  "the linearization depends on x and x': call sfdae_start or sfdae_analyze_at first, or give both.");
  const std::vector<double> x =
      choice.x != nullptr ? std::vector<double>(choice.x, choice.x + n) : solver.solution_at(choice.t);
  return solver.model.whole().jet_through(choice.t, x.data(), 0);
}

// Prescribed unknowns of the user's problem, without those made inputs.
const std::vector<int>& prescribed_of(const Solver& solver) {
  static const std::vector<int> none;
  if (solver.model.linear() != nullptr) return solver.model.linear()->problem().prescribed();
  if (solver.model.nonlinear() != nullptr) return solver.model.nonlinear()->problem().prescribed();
  return none;
}

// Unknowns with an additional equation: inputs, then prescribed ones that are held.
std::vector<int> pinned_unknowns(const Solver& solver, const sfdae_linearization& choice) {
  std::vector<int> pinned(choice.input_unknowns, choice.input_unknowns + choice.num_input_unknowns);
  for (int j : prescribed_of(solver))
    if (std::find(pinned.begin(), pinned.end(), j) == pinned.end()) pinned.push_back(j);
  return pinned;
}

// B: m rows for parameters and right-hand sides, then 0 = -x_j + u.
void add_inputs(const sfdae_linearization& choice, const Matrix& F_p, int m, Matrix& B) {
  const int first_unknown = F_p.cols(), first_column = first_unknown + choice.num_input_unknowns;
  for (int k = 0; k < F_p.cols(); ++k)
    for (int i = 0; i < m; ++i) B(i, k) = F_p(i, k) == 0.0 ? 0.0 : -F_p(i, k);
  for (int k = 0; k < choice.num_input_unknowns; ++k) B(m + k, first_unknown + k) = 1.0;
  if (choice.num_input_columns > 0)
    copy({choice.input_columns, m, choice.num_input_columns, m},
         B.view().block(0, first_column, m, choice.num_input_columns));
}

Matrix outputs_of(const sfdae_linearization& choice, int n) {
  const int unknowns = choice.num_output_unknowns, rows = choice.num_output_rows;
  Matrix C(unknowns + rows, n);
  for (int k = 0; k < unknowns; ++k) C(k, choice.output_unknowns[k]) = 1.0;
  if (rows > 0) copy({choice.output_rows, rows, n, rows}, C.view().block(unknowns, 0, rows, n));
  return C;
}

}  // namespace

DescriptorSystem linearized(Solver& solver, const sfdae_linearization& choice) {
  const int m = solver.model.m(), n = solver.model.n();
  check(choice, m, n);
  const Equations equations(solver);
  const std::vector<int> parameters = numbers_of_parameters(choice, equations.evaluator());
  std::optional<ParameterDerivatives> by_parameters;
  if (!parameters.empty()) by_parameters.emplace(*equations.evaluator(), parameters);
  const bool is_linear = solver.model.linear() != nullptr;
  const bool solution_counts = !is_linear || (by_parameters && by_parameters->depend_on_solution());
  const Jet point = point_of(solver, choice, solution_counts);
  const DerivativeArray array = solver.model.whole().derivative_array(point, 0);
  const Matrix F_p = by_parameters ? by_parameters->at(choice.t, point.x.data()) : Matrix(m, 0);
  const std::vector<int> pinned = pinned_unknowns(solver, choice);
  const int rows = m + static_cast<int>(pinned.size());
  const int inputs = F_p.cols() + choice.num_input_unknowns + choice.num_input_columns;
  DescriptorSystem result{Matrix(rows, n), Matrix(rows, n), Matrix(rows, inputs), outputs_of(choice, n), {}};
  copy(array.M, result.E.view().top(m));
  copy(array.N, result.A.view().top(m));
  for (std::size_t k = 0; k < pinned.size(); ++k) result.A(m + static_cast<int>(k), pinned[k]) = -1.0;
  add_inputs(choice, F_p, m, result.B);
  result.D = Matrix(result.C.rows(), inputs);
  return result;
}

}  // namespace sfdae::core
