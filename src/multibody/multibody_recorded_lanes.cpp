// A mechanical system given by recorded formulas at several points in one pass of their tapes.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_recorded_lanes.h"

#include <algorithm>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

void fill(LaneBlock& block, double value) { std::fill_n(block.lane, lane_count, value); }

}  // namespace

void RecordedLanes::prepare(const Formulas& formulas, MultibodyLaneTerms& terms) {
  using Part = RecordedTerms::Part;
  const MultibodyTerms& numbers = formulas.terms.numbers();
  const int nv = numbers.M.rows();
  std::vector<int> value_of(index(nv) * index(nv) + 1, -1);
  for (const RecordedTerms::Place& place : formulas.terms.places())
    if (place.part == Part::M) value_of[place.entry] = static_cast<int>(place.value);
  terms.has_diagonal_mass = true;
  terms.M.places.clear();
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nv; ++i) {
      if (value_of[index(i + j * nv)] < 0 && numbers.M(i, j) == 0.0) continue;
      terms.M.places.push_back({i, j});
      if (i != j) terms.has_diagonal_mass = false;
    }
  terms.M.resize();
  terms.f.assign(index(nv) + 1, {});
  // If memory runs out, the data of another system stay unchanged.
  std::vector<Target> masses, forces;
  LaneArray zeros(index(formulas.positions) + 1);
  for (std::size_t e = 0; e < terms.M.places.size(); ++e) {
    const auto [i, j] = terms.M.places[e];
    const int value = value_of[index(i + j * nv)];
    if (value >= 0) masses.push_back({value, e});
    else fill(terms.M.entries[e], numbers.M(i, j));
  }
  for (int i = 0; i < nv; ++i) fill(terms.f[index(i)], numbers.f[index(i)]);
  for (const RecordedTerms::Place& place : formulas.terms.places())
    if (place.part == Part::f) forces.push_back({static_cast<int>(place.value), place.entry});
  terms.C.places.clear();
  terms.is_rheonomic = formulas.is_rheonomic;
  int constraints = 0;
  if (formulas.constraints != nullptr) {
    const Tape& tape = formulas.constraints->tape();
    constraints = formulas.constraints->record().m();
    for (int i = 0; i < constraints; ++i)
      for (std::size_t e = tape.first_target[index(i)]; e < tape.first_target[index(i + 1)]; ++e)
        terms.C.places.push_back({i, tape.targets[e].unknown});
  }
  terms.C.resize();
  for (auto* values : {&terms.g, &terms.velocity_rest, &terms.acceleration_rest})
    values->assign(index(constraints) + 1, {});
  masses_ = std::move(masses);
  forces_ = std::move(forces);
  zeros_ = std::move(zeros);
}

bool RecordedLanes::evaluate(const Formulas& formulas, const LaneBlock* t, const LaneBlock* qv,
                             MultibodyLaneTerms& terms) {
  if (!values_.evaluate(formulas.terms.evaluator(), {t, {qv, nullptr, nullptr, nullptr}}, 0, false)) return false;
  for (const Target& target : masses_) terms.M.entries[target.entry] = *values_.value(target.value);
  for (const Target& target : forces_) terms.f[target.entry] = *values_.value(target.value);
  return formulas.constraints == nullptr || evaluate_constraints(formulas, t, qv, terms);
}

// Along q + v s: the second coefficients are half of s (multibody_recorded.h).
bool RecordedLanes::evaluate_constraints(const Formulas& formulas, const LaneBlock* t, const LaneBlock* qv,
                                         MultibodyLaneTerms& terms) {
  const TaylorEvaluator& source = *formulas.constraints;
  const LaneBlock* v = qv + formulas.positions;
  if (!constraints_.evaluate(source, {t, {qv, v, zeros_.data(), nullptr}}, 2, true)) return false;
  std::copy_n(constraints_.gradients(), terms.C.places.size(), terms.C.entries.data());
  for (int i = 0; i < source.record().m(); ++i) {
    const LaneBlock* g = constraints_.value(i);
    terms.g[index(i)] = g[0];
    for (int l = 0; l < lane_count; ++l) terms.acceleration_rest[index(i)].lane[l] = 2.0 * g[2].lane[l];
    if (terms.is_rheonomic) terms.velocity_rest[index(i)] = g[1];
  }
  if (!terms.is_rheonomic) return true;
  for (std::size_t e = 0; e < terms.C.places.size(); ++e) {
    const auto [i, j] = terms.C.places[e];
    for (int l = 0; l < lane_count; ++l)
      terms.velocity_rest[index(i)].lane[l] -= terms.C.entries[e].lane[l] * v[j].lane[l];
  }
  return true;
}

}  // namespace sfdae::core
