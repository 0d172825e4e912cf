// States block by block.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/states_by_blocks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "linalg/column_basis.h"
#include "linalg/equilibration.h"
#include "linalg/index.h"
#include "structure/structure.h"
#include "structure/system_jacobian.h"

namespace sfdae::core {

namespace {

// Least pivot relative to the sum of terms, in blocks scaled by themselves: blocks that are nearly singular have
// far-away solutions of disproportionate sizes, which proper equations do not have. Chosen, not measured.
constexpr double good_pivot = 1e-9;

// A diagonal block by rows, scaled by powers of two; zeros left out.
SparseRows scaled_block(int block, int size, const SystemJacobian& jacobian, BlockEntries& entries) {
  SparseRows rows;
  rows.columns = size;
  rows.first.assign(index(size) + 1, 0);
  entries.for_each(block, [&](int row, int column, int e) {
    const double value = jacobian.values()[index(e)];
    if (value == 0.0) return;
    rows.column.push_back(column);
    rows.value.push_back(value);
    ++rows.first[index(row) + 1];
  });
  for (int row = 0; row < rows.columns; ++row) rows.first[index(row) + 1] += rows.first[index(row)];
  Equilibration scales;
  scales.compute({rows.columns, rows.columns, rows.first.data(), rows.column.data()}, rows.value.data());
  for (int row = 0; row < rows.columns; ++row)
    for (int e = rows.first[index(row)]; e < rows.first[index(row) + 1]; ++e)
      rows.value[index(e)] = times_power_of_two(
          rows.value[index(e)], scales.of_lines()[index(row)] + scales.of_crossings()[index(rows.column[index(e)])]);
  return rows;
}

// Unknowns that the stages of one block leave over.
class BlockStates {
 public:
  BlockStates(const MinimalExtension& extension, int block, const SparseRows& rows)
      : offsets_(extension.offsets()),
        equations_(extension.structure().blocks.equations(block)),
        unknowns_(extension.structure().blocks.unknowns(block)),
        rows_(rows) {}

  // False if something else than x_j is left over, or some equations depend on others.
  bool add_to(std::vector<int>& states) {
    if (!is_regular()) return false;
    int highest = 0;
    for (int j : unknowns_) highest = std::max(highest, offsets_.d[index(j)]);
    for (int stage = -highest; stage < 0; ++stage)
      if (!add_stage(stage, states)) return false;
    return true;
  }

 private:
  // True if the last stage, which leaves nothing over, is nonsingular.
  bool is_regular() const {
    if (rows_.columns == 1) return !rows_.value.empty();
    BasisSettings settings;
    settings.is_scaled = true;
    const ColumnBasis basis = column_basis(rows_, settings);
    return basis.rank == rows_.columns && basis.smallest_pivot >= good_pivot;
  }

  // Numbers the unknowns of the stage.
  void number_columns(int stage) {
    columns_.clear();
    place_.assign(unknowns_.size(), -1);
    for (std::size_t k = 0; k < unknowns_.size(); ++k) {
      if (offsets_.d[index(unknowns_[k])] + stage < 0) continue;
      place_[k] = static_cast<int>(columns_.size());
      columns_.push_back(unknowns_[k]);
    }
  }

  SparseRows rows_of(int stage) const {
    SparseRows rows;
    rows.columns = static_cast<int>(columns_.size());
    rows.first.assign(1, 0);
    for (std::size_t row = 0; row < equations_.size(); ++row) {
      if (offsets_.c[index(equations_[row])] + stage < 0) continue;
      for (int e = rows_.first[row]; e < rows_.first[row + 1]; ++e) {
        rows.column.push_back(place_[index(rows_.column[index(e)])]);
        rows.value.push_back(rows_.value[index(e)]);
      }
      rows.first.push_back(static_cast<int>(rows.column.size()));
    }
    return rows;
  }

  bool add_stage(int stage, std::vector<int>& states) {
    number_columns(stage);
    BasisSettings settings;
    settings.is_scaled = true;
    for (int j : columns_) settings.classes.push_back(offsets_.d[index(j)] + stage == 0 ? 1 : 0);
    const SparseRows rows = rows_of(stage);
    if (rows.rows() == rows.columns) return true;
    const ColumnBasis basis = column_basis(rows, settings);
    if (basis.rank != rows.rows() || !basis.has_all_of_class_0 || basis.smallest_pivot < good_pivot) return false;
    for (int column : basis.left_over) states.push_back(columns_[index(column)]);
    return true;
  }

  const Offsets& offsets_;
  std::span<const int> equations_, unknowns_;
  const SparseRows& rows_;
  std::vector<int> columns_, place_;
};

// Relative to the values of the jet, far above roundoff: a point that is only so near to a solution has entries of that
// size which vanish there, and a block does not show how small they are. Chosen, not measured.
constexpr double doubt = 1e-6;

// Evaluates the system Jacobian at the jet; entries that a small change of the jet alters become zero. False if it
// cannot be evaluated.
bool evaluate(MinimalExtension& extension, const Jet& jet) {
  SystemJacobian& jacobian = extension.leading();
  TaylorEvaluator& evaluator = extension.problem().evaluator();
  const std::size_t count = index(extension.n()) * index(jacobian.jet_order() + 1);
  std::vector<double> noise(jet.x.begin(), jet.x.begin() + static_cast<std::ptrdiff_t>(count));
  for (double& value : noise) value = doubt * std::fabs(value);
  std::vector<double> nearby;
  for (const double side : {1.0, -1.0})
    if (nearby.empty() &&
        jacobian.evaluate(evaluator, jet.t,
                          moved_by_rounding({jet.t, jet.x.data(), noise.data()}, count, side).data()))
      nearby = jacobian.values();
  if (nearby.empty() || !jacobian.evaluate(evaluator, jet.t, jet.x.data())) return false;
  jacobian.drop_changes_from(nearby);
  return true;
}

}  // namespace

std::optional<std::vector<int>> states_by_blocks(MinimalExtension& extension, const Jet& jet) {
  if (!evaluate(extension, jet)) return std::nullopt;
  std::vector<int> states;
  const Blocks& blocks = extension.structure().blocks;
  BlockEntries entries(extension.structure(), extension.leading());
  for (int block = 0; block < blocks.count(); ++block) {
    const int size = static_cast<int>(blocks.equations(block).size());
    const SparseRows rows = scaled_block(block, size, extension.leading(), entries);
    if (!BlockStates(extension, block, rows).add_to(states)) return std::nullopt;
  }
  std::sort(states.begin(), states.end());
  return states;
}

}  // namespace sfdae::core
