// A mechanical system given by recorded formulas: what is recorded besides, and values.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_recorded.h"

#include <algorithm>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

bool is_number(const Recorder& recorder, int node) { return recorder.node(node).operation == Operation::constant; }

bool is_identity(const Recorder& recorder, const std::vector<int>& S, int rows, int cols) {
  if (rows != cols) return false;
  for (int j = 0; j < cols; ++j)
    for (int i = 0; i < rows; ++i) {
      const int node = S[index(i) + index(j) * index(rows)];
      if (!is_number(recorder, node) || recorder.number(node) != (i == j ? 1.0 : 0.0)) return false;
    }
  return true;
}

std::vector<std::string> numbered(const char* name, int count) {
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) names.push_back(format("%s[%d]", name, i));
  return names;
}

// A row or a column of a matrix of nodes.
std::vector<int> row_of(const std::vector<int>& matrix, int rows, int row) {
  std::vector<int> entries;
  for (std::size_t entry = index(row); entry < matrix.size(); entry += index(rows)) entries.push_back(matrix[entry]);
  return entries;
}
std::vector<int> column_of(const std::vector<int>& matrix, int rows, int column) {
  return {matrix.begin() + column * rows, matrix.begin() + (column + 1) * rows};
}

// sum_j coefficients_j factors_j, zeros left out.
int combination(Recorder& recorder, const std::vector<int>& coefficients, const std::vector<int>& factors) {
  int sum = recorder.constant(0.0);
  for (std::size_t j = 0; j < factors.size(); ++j)
    sum = recorder.apply(Operation::add, sum, recorder.apply(Operation::multiply, coefficients[j], factors[j]));
  return sum;
}

// Parameters that no user can name.
std::vector<int> held_vector(Recorder& recorder, char name, int count) {
  std::vector<int> nodes;
  for (int i = 0; i < count; ++i)
    nodes.push_back(recorder.parameter(std::string(1, '\0') + name + std::to_string(i), 0.0));
  return nodes;
}

std::vector<int> parameters_of(const Recorder& recorder, const std::vector<int>& nodes) {
  std::vector<int> indices;
  for (const int node : nodes) indices.push_back(recorder.node(node).a);
  return indices;
}

}  // namespace

RecordedMultibody::RecordedMultibody(Recorder& recorder, const MultibodyFormulas& formulas)
    : MultibodyProblem(formulas.sizes), num_parameters_(recorder.num_parameters()), numbers_(formulas.sizes) {
  const int nq = sizes().positions, nv = sizes().velocities, nl = sizes().holonomic, nk = sizes().nonholonomic;
  const bool kinematics = !is_identity(recorder, formulas.S, nq, nv);
  if (kinematics) numbers_.S = Matrix(nq, nv);
  record_values(recorder, formulas);
  if (nl > 0) constraints_.emplace(recorder.excerpt(nq, formulas.g, numbered("g", nl)));
  for (const int node : formulas.g)
    if ((constraints_->record().dependence(node) & on_time) != 0) rheonomic_ = true;
  std::vector<int> v;
  for (int j = 0; j < nv; ++j) v.push_back(recorder.unknown(nq + j));
  const auto applied_to_v = [&](const std::vector<int>& matrix, int rows) {
    std::vector<int> products;
    for (int i = 0; i < rows; ++i) products.push_back(combination(recorder, row_of(matrix, rows, i), v));
    return products;
  };
  if (kinematics) kinematics_.emplace(recorder.excerpt(nq + nv, applied_to_v(formulas.S, nq), numbered("S v", nq)));
  if (nk > 0) {
    std::vector<int> levels = applied_to_v(formulas.H, nk);
    for (int i = 0; i < nk; ++i)
      levels[index(i)] = recorder.apply(Operation::add, levels[index(i)], formulas.h[index(i)]);
    nonholonomic_.emplace(recorder.excerpt(nq + nv, levels, numbered("H v + h", nk)));
  }
  record_balance(recorder, formulas);
  allocate();
}

double* RecordedMultibody::entries_of(MultibodyTerms& terms, Part part) {
  switch (part) {
    case Part::M: return terms.M.data();
    case Part::S: return terms.S.data();
    case Part::C: return terms.C.data();
    case Part::rest: return terms.velocity_rest.data();
    default: return terms.f.data();
  }
}

void RecordedMultibody::add_values(const Recorder& recorder, const std::vector<int>& formulas, const Block& block,
                                   Values& values) {
  for (int j = 0; j < block.columns; ++j)
    for (int i = 0; i < block.rows; ++i) {
      const int node = formulas[index(i) + index(j) * index(block.rows)];
      const std::size_t entry = index(block.first + i) + index(j) * index(block.ld);
      if (const auto number = recorder.number(node)) {
        entries_of(numbers_, block.part)[entry] = *number;
        continue;
      }
      const auto [known, is_new] = values.known.try_emplace(node, values.nodes.size());
      values.places.push_back({block.part, entry, known->second});
      if (!is_new) continue;
      values.nodes.push_back(node);
      const bool is_matrix = block.part != Part::rest && block.part != Part::f;
      values.names.push_back(is_matrix ? format("%s(%d, %d)", block.name, i, j) : format("%s[%d]", block.name, i));
    }
}

void RecordedMultibody::record_values(const Recorder& recorder, const MultibodyFormulas& formulas) {
  const int nq = sizes().positions, nv = sizes().velocities, nl = sizes().holonomic, nk = sizes().nonholonomic;
  Values values;
  add_values(recorder, formulas.M, {Part::M, "M", nv, nv, 0, nv}, values);
  add_values(recorder, formulas.H, {Part::C, "H", nk, nv, nl, nl + nk}, values);
  add_values(recorder, formulas.h, {Part::rest, "h", nk, 1, nl, nk}, values);
  if (numbers_.S.cols() > 0) add_values(recorder, formulas.S, {Part::S, "S", nq, nv, 0, nq}, values);
  position_.emplace(recorder.excerpt(nq, values.nodes, values.names));
  position_places_ = values.places;
  add_values(recorder, formulas.f, {Part::f, "f", nv, 1, 0, nv}, values);
  all_.emplace(recorder.excerpt(nq + nv, values.nodes, values.names));
  all_places_ = values.places;
}

// f - M a - S^T p - H^T kappa, p = g_q^T lambda, with a, p and kappa held. Its values mean nothing: numbers among the
// coefficients are left out, as they have no derivatives.
void RecordedMultibody::record_balance(Recorder& recorder, const MultibodyFormulas& formulas) {
  const int nq = sizes().positions, nv = sizes().velocities, nl = sizes().holonomic, nk = sizes().nonholonomic;
  const std::vector<int> a = held_vector(recorder, 'a', nv), kappa = held_vector(recorder, 'k', nk);
  const std::vector<int> p = held_vector(recorder, 'p', kinematics_ ? nq : 0),
                         lambda = held_vector(recorder, 'l', nl);
  const int zero = recorder.constant(0.0);
  const auto subtract = [&](int& from, std::vector<int> coefficients, const std::vector<int>& factors) {
    for (int& coefficient : coefficients)
      if (is_number(recorder, coefficient)) coefficient = zero;
    from = recorder.apply(Operation::subtract, from, combination(recorder, coefficients, factors));
  };
  std::vector<int> balance = formulas.f;
  for (int i = 0; i < nv; ++i) {
    subtract(balance[index(i)], row_of(formulas.M, nv, i), a);
    if (kinematics_) subtract(balance[index(i)], column_of(formulas.S, nq, i), p);
    if (nk > 0) subtract(balance[index(i)], column_of(formulas.H, nk, i), kappa);
  }
  balance_.emplace(recorder.excerpt(nq + nv, balance, numbered("f", nv)));
  if (nl > 0) {
    curvature_.emplace(recorder.excerpt(nq, {combination(recorder, formulas.g, lambda)}, {"g"}));
    for (const Entry& entry : curvature_->record().entries(0))
      if ((entry.dependence & on_unknowns) != 0) curved_.push_back(entry.unknown);
  }
  held_ = {parameters_of(recorder, a), parameters_of(recorder, kappa), parameters_of(recorder, p),
           parameters_of(recorder, lambda)};
}

void RecordedMultibody::allocate() {
  const std::size_t nq = index(sizes().positions), nv = index(sizes().velocities), n = nq + nv;
  const std::size_t nl = index(sizes().holonomic), nk = index(sizes().nonholonomic);
  values_.resize(index(all_->record().m()));
  q_jet_.resize(4 * nq);
  jet_.resize(3 * n);
  g_jet_.resize(3 * nl);
  rates_.resize(2 * std::max(nq, nk));
  gradients_.resize(std::max({nv * n, 3 * nl * nq, 2 * nk * n, kinematics_ ? 2 * nq * n : 0}));
  curvature_gradients_.resize(2 * nq);
  if (!kinematics_) return;
  rate_q_ = Matrix(sizes().positions, sizes().positions);
  rate_v_ = Matrix(sizes().positions, sizes().velocities);
}

void RecordedMultibody::parameters_changed() {
  for (auto* other : {&position_, &constraints_, &balance_, &curvature_, &kinematics_, &nonholonomic_})
    if (other->has_value())
      for (int i = 0; i < num_parameters_; ++i) (*other)->set_parameter(i, all_->parameter(i));
}

CallbackError RecordedMultibody::begin(double t) const {
  CallbackError error;
  error.t = t;
  if (stop_is_requested()) error.status = SFDAE_STOPPED;
  return error;
}

bool RecordedMultibody::failed(const TaylorEvaluator& evaluator, CallbackError& error) {
  error.status = SFDAE_NOT_FINITE;
  error.row = evaluator.failure().equation;
  error.detail =
      format("the formulas cannot be evaluated at t = %.15g: ", error.t) + evaluator.failure().message + ".";
  return false;
}

bool RecordedMultibody::evaluate_values(const double* x, bool with_forces, MultibodyTerms& terms,
                                        CallbackError& error) {
  TaylorEvaluator& evaluator = with_forces ? *all_ : *position_;
  if (!evaluator.values(error.t, x, 0, values_.data())) return failed(evaluator, error);
  if (kinematics_ && terms.S.cols() == 0) terms.S = numbers_.S;
  const auto copy_numbers = [&](Part part, std::size_t count) {
    std::copy_n(entries_of(numbers_, part), count, entries_of(terms, part));
  };
  const std::size_t nv = index(sizes().velocities);
  copy_numbers(Part::M, nv * nv);
  copy_numbers(Part::C, index(sizes().constraints()) * nv);
  copy_numbers(Part::rest, index(sizes().constraints()));
  if (kinematics_) copy_numbers(Part::S, index(sizes().positions) * nv);
  if (with_forces) copy_numbers(Part::f, nv);
  for (const Place& place : with_forces ? all_places_ : position_places_)
    entries_of(terms, place.part)[place.entry] = values_[place.value];
  return true;
}

CallbackError RecordedMultibody::constraints(double t, const double* q, double* g) {
  CallbackError error = begin(t);
  ++evaluations_;
  if (error.status != SFDAE_OK || !constraints_) return error;
  if (!constraints_->values(t, q, 0, g)) failed(*constraints_, error);
  return error;
}

// Along q_jet_, up to q_2 (order 2) or with q_1 = 0.
bool RecordedMultibody::evaluate_constraints(int order, MultibodyTerms& terms, CallbackError& error) {
  const int nl = sizes().holonomic, nq = sizes().positions, nv = sizes().velocities;
  if (!constraints_) return true;
  if (!constraints_->gradients(error.t, q_jet_.data(), {order, -1, 0}, g_jet_.data(), nullptr, terms.g_q.data()))
    return failed(*constraints_, error);
  const double* const g_1 = g_jet_.data() + nl;
  std::copy_n(g_jet_.data(), nl, terms.g.data());
  const View G = terms.C.view().block(0, 0, nl, nv);
  if (kinematics_) multiply(1.0, Op::plain, terms.g_q, Op::plain, terms.S, 0.0, G);
  else copy(terms.g_q, G);
  if (order == 0 || !rheonomic_) return true;
  std::copy_n(g_1, nl, terms.velocity_rest.data());
  if (order == 2) multiply(-1.0, Op::plain, terms.g_q, q_jet_.data() + nq, 1.0, terms.velocity_rest.data());
  return true;
}

CallbackError RecordedMultibody::at_position(double t, const double* q, MultibodyTerms& terms) {
  CallbackError error = begin(t);
  ++evaluations_;
  if (error.status != SFDAE_OK || !evaluate_values(q, false, terms, error)) return error;
  const std::size_t nq = index(sizes().positions);
  std::copy_n(q, nq, q_jet_.data());
  std::fill_n(q_jet_.data() + nq, nq, 0.0);
  evaluate_constraints(rheonomic_ ? 1 : 0, terms, error);
  return error;
}

void RecordedMultibody::set_jet(const double* q, const double* v, const double* v_1, const MultibodyTerms& terms) {
  const std::size_t nq = index(sizes().positions), nv = index(sizes().velocities);
  double* const q_1 = q_jet_.data() + nq;
  std::copy_n(q, nq, q_jet_.data());
  if (kinematics_) multiply(1.0, Op::plain, terms.S, v, 0.0, q_1);
  else std::copy_n(v, nq, q_1);
  if (v_1 != nullptr && !kinematics_)
    for (std::size_t j = 0; j < nq; ++j) q_1[nq + j] = 0.5 * v_1[j];
  else std::fill_n(q_1 + nq, nq, 0.0);
  std::copy_n(q, nq, jet_.data());
  std::copy_n(v, nv, jet_.data() + nq);
  std::copy_n(q_1, nq, jet_.data() + nq + nv);
  if (v_1 != nullptr) std::copy_n(v_1, nv, jet_.data() + 2 * nq + nv);
  else std::fill_n(jet_.data() + 2 * nq + nv, nv, 0.0);
}

CallbackError RecordedMultibody::at_velocity(double t, const double* q, const double* v, MultibodyTerms& terms) {
  CallbackError error = begin(t);
  ++evaluations_;
  if (error.status != SFDAE_OK) return error;
  const int nq = sizes().positions, nl = sizes().holonomic, nk = sizes().nonholonomic;
  std::copy_n(q, nq, jet_.data());
  std::copy_n(v, sizes().velocities, jet_.data() + nq);
  if (!evaluate_values(jet_.data(), true, terms, error)) return error;
  set_jet(q, v, nullptr, terms);
  double* const s = terms.acceleration_rest.data();
  if (kinematics_) {
    if (!kinematics_->values(t, jet_.data(), 1, rates_.data())) return failed(*kinematics_, error), error;
    for (int i = 0; i < nq; ++i) q_jet_[index(2 * nq + i)] = 0.5 * rates_[index(nq + i)];
  }
  if (!evaluate_constraints(2, terms, error)) return error;
  for (int i = 0; i < nl; ++i) s[i] = 2.0 * g_jet_[index(2 * nl + i)];
  if (!nonholonomic_) return error;
  if (!nonholonomic_->values(t, jet_.data(), 1, rates_.data())) return failed(*nonholonomic_, error), error;
  std::copy_n(rates_.data() + nk, nk, s + nl);
  return error;
}

}  // namespace sfdae::core
