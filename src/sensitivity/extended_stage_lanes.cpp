// Side-by-side linearization of the stages of a Radau step of sensitivities.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/extended_stage_lanes.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "linalg/lane_algebra.h"
#include "linalg/quiet_arithmetic.h"
#include "problem/row_factors.h"

namespace sfdae::core {

namespace {

using lane_algebra::set_abs;

// A column that loses so much to those before it may consist of rounding errors.
constexpr double least_part = 1e-8;
// As in NonlinearProblem::drop_rounding_errors: E so much smaller than A may be rounding errors.
constexpr double suspicious = 1e-10;

// ---- The extension ---------------------------------------------------------------------------------------------

struct Assembly {
  const ExtendedEquations& equations;
  const std::vector<ParameterGradient::Place>& places;  // of the entries of F_p
  const Lanes *coefficients, *F_p;
  int count;
  Lanes* matrix;
  std::size_t num_entries;
  Lanes* right;
};

void assemble(Assembly& work) {
  const ExtendedEquations& equations = work.equations;
  for (std::size_t e = 0; e < work.num_entries; ++e) work.matrix[e] = Lanes{};
  for (const ExtendedEquations::Term& term : equations.terms)
    work.matrix[term.position] += term.factor * work.coefficients[term.coefficient];
  const int states = equations.num_states(), columns = equations.num_columns();
  for (int s = 0; s < states; ++s) work.matrix[equations.state_positions[index(2 * s)]] = Lanes{} + 1.0;
  for (int k = 0; k < columns * (work.count + states); ++k) work.right[k] = Lanes{};
  const int length = equations.order + 1;
  for (std::size_t e = 0; e < work.places.size(); ++e) {
    const auto [i, q] = work.places[e];
    Lanes* const to = work.right + q * columns + equations.first_row[index(i)];
    for (int k = 0; k <= equations.limits[index(i)]; ++k) to[k] = -work.F_p[static_cast<int>(e) * length + k];
  }
  for (int s = 0; s < states; ++s) work.right[(work.count + s) * columns + equations.num_rows() + s] = Lanes{} + 1.0;
}
SFDAE_LANE_KERNEL(assemble, Assembly)

// ---- Rows ------------------------------------------------------------------------------------------------------

struct RowSizes {
  const std::vector<RecordedEntry>& entries;
  const Lanes* coefficients;
  int length;  // of the coefficients of an entry
  const Units& units;
  double unit_of_A;
  int m;
  Lanes* sizes;
  bool is_E_small;  // at any point
};

void measure_rows(RowSizes& work) {
  for (int i = 0; i < work.m; ++i) work.sizes[i] = Lanes{};
  Lanes largest_E{}, largest_A{};
  for (std::size_t e = 0; e < work.entries.size(); ++e) {
    const RecordedEntry& entry = work.entries[e];
    Lanes size;
    set_abs(work.coefficients[e * index(work.length)], size);
    Lanes& all = entry.of_slope ? largest_E : largest_A;
    all = size > all ? size : all;
    size *= entry.of_slope ? work.units[entry.column] : work.units[entry.column] * work.unit_of_A;
    Lanes& of_row = work.sizes[entry.row];
    of_row = size > of_row ? size : of_row;
  }
  work.is_E_small = !all(largest_E > suspicious * largest_A);
}
SFDAE_LANE_KERNEL(measure_rows, RowSizes)

// ---- Z1 --------------------------------------------------------------------------------------------------------

struct Basis {
  const std::vector<RecordedEntry>& entries;
  const Lanes* coefficients;
  int length, m, d;
  const ExtendedEquations& equations;
  const Lanes *tangents, *row_factors;  // tangents: of the states
  Lanes* Z1;                            // m x d, by rows
  bool is_found;
};

// Z1 := E T2, rows scaled.
void multiply_by_tangents(const Basis& work) {
  const int d = work.d, columns = work.equations.num_columns();
  for (int k = 0; k < work.m * d; ++k) work.Z1[k] = Lanes{};
  for (std::size_t e = 0; e < work.entries.size(); ++e) {
    const RecordedEntry& entry = work.entries[e];
    if (!entry.of_slope) continue;
    const Lanes value = work.row_factors[entry.row] * work.coefficients[e * index(work.length)];
    const Lanes* const tangent = work.tangents + work.equations.first_column[index(entry.column)];
    Lanes* const row = work.Z1 + entry.row * d;
    for (int k = 0; k < d; ++k) row[k] += value * tangent[k * columns];
  }
}

void sum_of_products(const Lanes* one, const Lanes* other, int count, int step, Lanes& result) {
  Lanes sum{};
  for (int i = 0; i < count; ++i) sum += one[i * step] * other[i * step];
  result = sum;
}

void find_basis(Basis& work) {
  multiply_by_tangents(work);
  const int m = work.m, d = work.d;
  Lanes* const Z1 = work.Z1;
  work.is_found = false;
  for (int k = 0; k < d; ++k) {
    // Two passes are enough if one is not: the second removes the components that the first leaves.
    Lanes before, after;
    sum_of_products(Z1 + k, Z1 + k, m, d, before);
    for (int pass = 0; pass < 2; ++pass)
      for (int j = 0; j < k; ++j) {
        Lanes part;
        sum_of_products(Z1 + j, Z1 + k, m, d, part);
        for (int i = 0; i < m; ++i) Z1[i * d + k] -= part * Z1[i * d + j];
      }
    sum_of_products(Z1 + k, Z1 + k, m, d, after);
    LaneMask bad{};
    note_not_finite(after, bad);
    if (any(bad) || !all(after > least_part * least_part * before)) return;
    Lanes scale;
    for (int l = 0; l < lane_count; ++l) scale[l] = 1.0 / std::sqrt(after[l]);
    for (int i = 0; i < m; ++i) Z1[i * d + k] *= scale;
  }
  work.is_found = true;
}
SFDAE_LANE_KERNEL(find_basis, Basis)

// ---- F1 --------------------------------------------------------------------------------------------------------

struct Projection {
  const std::vector<RecordedEntry>& entries;
  const std::vector<ParameterGradient::Place>& places;
  const Lanes *coefficients, *F_p;
  int length, n, d, count;
  double tau;
  const Units& units;
  const ExtendedEquations& equations;
  const Lanes *tangents, *row_factors, *Z1;  // tangents: all of them, of xp first
  Lanes *ZE, *ZA, *B, *Zf;
};

void project(Projection& work) {
  const int d = work.d, columns = work.equations.num_columns();
  for (int k = 0; k < work.n * d; ++k) work.ZE[k] = work.ZA[k] = Lanes{};
  for (int k = 0; k < d * d; ++k) work.B[k] = Lanes{};
  for (int k = 0; k < d * work.count; ++k) work.Zf[k] = Lanes{};
  for (std::size_t e = 0; e < work.entries.size(); ++e) {
    const RecordedEntry& entry = work.entries[e];
    const Lanes value = (entry.of_slope ? work.units[entry.column] : -work.tau * work.units[entry.column]) *
                        work.row_factors[entry.row] * work.coefficients[e * index(work.length)];
    const Lanes* const from = work.Z1 + entry.row * d;
    Lanes* const to = (entry.of_slope ? work.ZE : work.ZA) + entry.column * d;
    for (int k = 0; k < d; ++k) to[k] += value * from[k];
  }
  for (std::size_t e = 0; e < work.places.size(); ++e) {
    const auto [i, q] = work.places[e];
    const Lanes value = -work.tau * work.row_factors[i] * work.F_p[e * index(work.length)];
    for (int k = 0; k < d; ++k) work.Zf[q * d + k] += value * work.Z1[i * d + k];
  }
  // Z1^T A xp is added to Z1^T f, and B = Z1^T A T2.
  for (int c = 0; c < work.count + d; ++c) {
    Lanes* const to = c < work.count ? work.Zf + c * d : work.B + (c - work.count) * d;
    for (int j = 0; j < work.n; ++j) {
      const Lanes tangent = 1.0 / work.units[j] * work.tangents[c * columns + work.equations.first_column[index(j)]];
      for (int k = 0; k < d; ++k) to[k] += work.ZA[j * d + k] * tangent;
    }
  }
}
SFDAE_LANE_KERNEL(project, Projection)

}  // namespace

bool ExtendedStageLanes::begin(int s) {
  s_ = 0;
  if (s < 2 || s > lane_count || !extension_.is_possible() || extension_.list() == nullptr ||
      !problem_.has_lanes(extension_.equations().order))
    return false;
  s_ = s;
  n_ = problem_.n();
  jet_order_ = extension_.equations().order + 1;
  resize();
  return true;
}

void ExtendedStageLanes::resize() {
  const ExtendedEquations& equations = extension_.equations();
  const std::size_t n = index(n_), d = index(equations.num_states()), count = index(parameters_.count());
  if (entries_.empty()) entries_ = recorded_entries(problem_);
  level_0_.assign(index(problem_.m()), 0);
  points_.t.resize(1);
  points_.jets.resize(n * index(jet_order_ + 1));
  points_.x_xdot.resize(2 * n);
  matrix_.resize(extension_.num_entries());
  right_.resize(index(equations.num_columns()) * (count + d));
  tangents_.resize(right_.size());
  for (LaneArray* array : {&row_sizes_, &row_factors_}) array->resize(index(problem_.m()));
  Z1_.resize(index(problem_.m()) * d);
  for (LaneArray* array : {&projected_.ZE, &projected_.ZA}) array->resize(n * d);
  projected_.B.resize(d * d);
  projected_.Zf.resize(d * count);
  factors_.resize(index(problem_.m()));
}

// Unused lanes repeat the last stage.
void ExtendedStageLanes::keep(int i, const Jet& jet, const double* xdot) {
  const std::size_t n = index(n_);
  points_.has_slopes = xdot != nullptr;
  for (int l = i; l < (i + 1 == s_ ? lane_count : i + 1); ++l) {
    points_.t[0].lane[l] = jet.t;
    for (std::size_t k = 0; k < points_.jets.size(); ++k) points_.jets[k].lane[l] = jet.x[k];
    for (std::size_t k = 0; points_.has_slopes && k < n; ++k) {
      points_.x_xdot[k].lane[l] = jet.x[k];
      points_.x_xdot[n + k].lane[l] = xdot[k];
    }
  }
}

Jet ExtendedStageLanes::jet(int i) const {
  Jet jet;
  jet.t = points_.t[0].lane[i];
  jet.n = n_;
  jet.order = jet_order_;
  for (const LaneBlock& block : points_.jets) jet.x.push_back(block.lane[i]);
  return jet;
}

const double* ExtendedStageLanes::xdot(int i, std::vector<double>& buffer) const {
  if (!points_.has_slopes) return nullptr;
  buffer.resize(index(n_));
  for (std::size_t k = 0; k < buffer.size(); ++k) buffer[k] = points_.x_xdot[index(n_) + k].lane[i];
  return buffer.data();
}

// Uses the known states and pivots. False unless both are suitable at all stages.
bool ExtendedStageLanes::find_tangents() {
  const ExtendedEquations& equations = extension_.equations();
  const int count = parameters_.count(), d = equations.num_states(), columns = equations.num_columns();
  const LaneBlock* const F_p =
      parameters_.values_side_by_side(points_.t.data(), points_.jets.data(), equations.order);
  const LaneBlock* const coefficients = problem_.gradient_entries_side_by_side(
      s_, points_.t.data(), points_.jets.data(), equations.order, equations.limits);
  if (F_p == nullptr || coefficients == nullptr) return false;
  Assembly assembly{equations, parameters_.places(), to_lanes(coefficients),   to_lanes(F_p),
                    count,     to_lanes(matrix_),    extension_.num_entries(), to_lanes(right_)};
  run_assemble(assembly);
  if (!planned_.solve(*extension_.list(), matrix_.data(), right_.data(), count + d, tangents_.data())) return false;
  std::vector<double>& sizes = extension_.sizes();
  for (int j = 0; j < n_; ++j)
    for (int l = 0; l < s_; ++l)
      sizes[index(j)] = std::max(sizes[index(j)], std::fabs(points_.jets[index(j)].lane[l]));
  for (int j = 0; j < n_; ++j) {
    if (sizes[index(j)] == 0.0) continue;
    for (int l = 0; l < s_; ++l) {
      double move = 0.0;
      for (int k = 0; k < d; ++k)
        move += (k % 2 == 0 ? 1.0 : -1.0) * sizes[index(equations.states[index(k)])] *
                tangents_[index((count + k) * columns + equations.first_column[index(j)])].lane[l];
      if (!extension_.are_good_states(std::fabs(move) / sizes[index(j)])) return false;
    }
  }
  return true;
}

// Row factors of each point, as in TaylorData::scale for a given unit of time.
bool ExtendedStageLanes::find_row_factors(const AnalyzedEquations& equations) {
  const IndexAnalysis& analysis = equations.analysis();
  for (int l = 0; l < s_; ++l) {
    for (std::size_t i = 0; i < factors_.size(); ++i) {
      factors_[i] = row_sizes_[i].lane[l];
      if (!(factors_[i] > 0.0)) return false;
    }
    become_row_factors(factors_, analysis.rows);
    for (std::size_t i = 0; i < factors_.size(); ++i) row_factors_[i].lane[l] = factors_[i];
  }
  for (LaneBlock& factor : row_factors_)
    for (int l = s_; l < lane_count; ++l) factor.lane[l] = factor.lane[s_ - 1];
  return true;
}

bool ExtendedStageLanes::linearize(const AnalyzedEquations& equations, SensitivityStages& stages) {
  const QuietArithmetic quiet;
  const IndexAnalysis& analysis = equations.analysis();
  const ExtendedEquations& extension = extension_.equations();
  const int count = parameters_.count(), d = extension.num_states(), m = problem_.m();
  if (!(analysis.time_scale > 0.0) || !find_tangents()) return false;
  // Those of the last evaluation.
  const LaneBlock* coefficients = problem_.last_entries_side_by_side();
  int length = extension.order + 1;
  const double tau = power_of_two_near(analysis.time_scale);
  RowSizes rows{entries_, to_lanes(coefficients), length, equations.units(), unit_of_A(analysis.rows, tau),
                m,        to_lanes(row_sizes_),   false};
  run_measure_rows(rows);
  if (rows.is_E_small || !find_row_factors(equations)) return false;
  const Lanes* const T2 = to_lanes(tangents_) + count * extension.num_columns();
  Basis basis{entries_, to_lanes(coefficients), length,        m,    d, extension,
              T2,       to_lanes(row_factors_), to_lanes(Z1_), false};
  run_find_basis(basis);
  if (!basis.is_found) return false;
  const LaneBlock* F_p = nullptr;
  if (points_.has_slopes && parameters_.needs_slopes()) {
    length = 1;
    F_p = parameters_.values_side_by_side(points_.t.data(), points_.x_xdot.data(), 0);
    coefficients = problem_.gradient_entries_side_by_side(s_, points_.t.data(), points_.x_xdot.data(), 0, level_0_);
  } else {
    F_p = parameters_.last_values_side_by_side();
  }
  if (F_p == nullptr || coefficients == nullptr) return false;
  Projection projection{entries_,
                        parameters_.places(),
                        to_lanes(coefficients),
                        to_lanes(F_p),
                        length,
                        n_,
                        d,
                        count,
                        tau,
                        equations.units(),
                        extension,
                        to_lanes(tangents_),
                        to_lanes(row_factors_),
                        to_lanes(Z1_),
                        to_lanes(projected_.ZE),
                        to_lanes(projected_.ZA),
                        to_lanes(projected_.B),
                        to_lanes(projected_.Zf)};
  run_project(projection);
  write(equations, stages);
  return true;
}

void ExtendedStageLanes::write(const AnalyzedEquations& equations, SensitivityStages& stages) const {
  const ExtendedEquations& extension = extension_.equations();
  const int d = extension.num_states(), columns = extension.num_columns(), count = parameters_.count();
  const double tau = power_of_two_near(equations.analysis().time_scale);
  const auto copy_block = [](const LaneArray& from, int lane, View to) {
    const LaneBlock* next = from.data();
    for (int j = 0; j < to.cols; ++j)
      for (int k = 0; k < to.rows; ++k) to(k, j) = (next++)->lane[lane];
  };
  for (int i = 0; i < s_; ++i) {
    const SensitivityStages::Parts parts = stages.parts(i, tau);
    copy_block(projected_.ZE, i, parts.L);
    copy_block(projected_.B, i, parts.B);
    copy_block(projected_.Zf, i, parts.b);
    const LaneBlock* from = tangents_.data();
    for (int c = 0; c < count + d; ++c, from += columns) {
      double* const to = c < count ? parts.xp.column(c) : parts.T2.column(c - count);
      for (int j = 0; j < n_; ++j) to[j] = from[extension.first_column[index(j)]].lane[i] / equations.units()[j];
    }
  }
}

}  // namespace sfdae::core
