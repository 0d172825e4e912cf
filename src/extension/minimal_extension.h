// The minimal extension of recorded equations by structural analysis: f_i, ..., f_i^(c_i) in the unknowns x_j, ...,
// x_j^(d_j), c and d the canonical offsets [P01], all as Taylor coefficients along a jet, with sparse derivatives. If
// the structural analysis fails, f_i are combinations of recorded equations that replace them
// (structure/replacement.h).
//
// Folder extension: the strangeness-free system of equations whose structural analysis is confirmed numerically, for
// many unknowns or a high index. Only the necessary derivatives are formed, and matrices are sparse.
//
// [P01] J. D. Pryce: A Simple Structural Analysis Method for DAEs. BIT 41 (2001), 364-394.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "array/jet_lanes.h"
#include "linalg/lanes.h"
#include "problem/nonlinear_problem.h"
#include "structure/structure.h"
#include "structure/system_jacobian.h"

namespace sfdae::core {

// Rows and columns in the order that the offsets determine.
struct ExtensionLayout {
  // Both sorted by stages: the rows f_i^(k) by k - c_i, the unknowns x_j^(l) by l - d_j.
  struct Row {
    int equation, order;
  };
  struct Column {
    int unknown, order;
  };
  int highest_d = 0;
  std::vector<Row> rows;
  std::vector<Column> columns;
  std::vector<int> first_rows, first_columns;  // of each stage
  // Columns of x_j^(d_j), x_j^(d_j - 1), ..., x_j, and where those of each j begin.
  std::vector<int> places, first_place;

  int first_stage() const { return -highest_d; }
};

// Rows as sums of factors times Taylor coefficients of recorded equations.
struct ExtensionSums {
  struct Part {
    int equation, order;
    double factor;
  };
  // Empty if each row is one coefficient.
  std::vector<Part> parts;
  std::vector<int> first_part;
  // Place of each row's only coefficient among those of the recorded equations; empty if rows are sums, or the
  // equations as they are.
  std::vector<int> places;
  std::shared_ptr<const OrderLimits> levels;  // the highest of each recorded equation
};

class MinimalExtension {
 public:
  // ordered: see StructureJudge.
  MinimalExtension(RecordedProblem& problem, std::shared_ptr<const Structure> structure,
                   std::shared_ptr<OrderedBlocks> ordered = nullptr);

  int n() const { return n_; }
  using Row = ExtensionLayout::Row;
  using Column = ExtensionLayout::Column;
  const std::vector<Row>& rows() const { return layout_.rows; }           // n + sum c of them
  const std::vector<Column>& columns() const { return layout_.columns; }  // n + sum d
  int num_rows() const { return static_cast<int>(layout_.rows.size()); }
  int num_columns() const { return static_cast<int>(layout_.columns.size()); }
  int freedom() const { return num_columns() - num_rows(); }
  // The column of x_j^(order), order <= d_j.
  int column_of(int unknown, int order) const {
    return layout_.places[index(layout_.first_place[index(unknown)] + offsets().d[index(unknown)] - order)];
  }
  const Structure& structure() const { return *structure_; }
  const std::shared_ptr<const Structure>& shared_structure() const { return structure_; }
  const Offsets& offsets() const { return structure_->offsets; }
  RecordedProblem& problem() const { return problem_; }
  using Part = ExtensionSums::Part;
  // Parts of a row; pointers into it are valid during its lifetime only.
  class Parts {
   public:
    explicit Parts(const Row& row) : only_{row.equation, row.order, 1.0} {}
    Parts(const Part* first, const Part* last) : first_(first), last_(last) {}
    const Part* begin() const { return first_ != nullptr ? first_ : &only_; }
    const Part* end() const { return first_ != nullptr ? last_ : &only_ + 1; }

   private:
    Part only_{};
    const Part *first_ = nullptr, *last_ = nullptr;
  };
  Parts parts(int row) const {
    if (sums_.parts.empty()) return Parts(layout_.rows[index(row)]);
    return {sums_.parts.data() + sums_.first_part[index(row)], sums_.parts.data() + sums_.first_part[index(row + 1)]};
  }
  // Stages are first_stage(), ..., 0; rows and columns of each end where those of the next one begin.
  int first_stage() const { return layout_.first_stage(); }
  int first_row(int stage) const { return layout_.first_rows[index(stage + layout_.highest_d)]; }
  int first_column(int stage) const { return layout_.first_columns[index(stage + layout_.highest_d)]; }
  // True for derivatives of such an order that all equations together may not determine any digit of them. They need
  // not, as these are found one after the other (docs/design/structural_analysis.md).
  bool is_deep() const { return layout_.highest_d >= deep; }
  // The highest derivative of a recorded equation.
  int highest_level() const { return highest_level_; }
  // Order of jets; coefficients of x_j beyond d_j have no meaning.
  int jet_order() const { return highest_level_ + 1; }

  // num_rows() Taylor coefficients of f along a jet of jet_order().
  CallbackError residuals(const Jet& jet, double* r);
  // Likewise along the first `count` jets at once, to the last bit; r: a column for each. False: they have to be
  // evaluated one by one.
  bool residuals_side_by_side(const std::vector<Jet>& jets, int count, double* r);
  // Likewise for the total derivatives by t of all rows along the jet, which is of one order more.
  CallbackError slopes(const Jet& jet, double* r);

  // Residuals of the rows of a stage alone.
  CallbackError stage_residuals(int stage, const Jet& jet, double* r);
  // Derivatives of the rows of a stage by its unknowns, which are those of the system Jacobian times factors; rows
  // and columns count from the first of the stage.
  struct StageMatrix {
    std::vector<int> first, column;
    std::vector<double> values;
  };
  CallbackError linearize_stage(int stage, const Jet& jet, StageMatrix& matrix);

  // The derivatives of the rows by the unknowns, by rows: those of row i are entries first()[i], ..., first()[i + 1]
  // - 1.
  CallbackError linearize(const Jet& jet) { return linearize(jet, values_); }
  // values: receives the derivatives, in place of values().
  CallbackError linearize(const Jet& jet, std::vector<double>& values);
  // Likewise along the first `count` jets at once; values: of all entries, not those of values(). False: as
  // residuals_side_by_side().
  bool linearize_side_by_side(const std::vector<Jet>& jets, int count, LaneArray& values);
  // values: of the entries, from Taylor coefficients of the derivatives of recorded equations: coefficient k of the
  // derivative by the target number e of the tape is coefficient(e, k), k <= highest_level().
  template <class Coefficient>
  void take_derivatives(Coefficient coefficient, double* values) const;
  // Terms of the sums that entries are: action(entry, e, k, factor), in the order in which they are added up.
  template <class Action>
  void for_each_term(Action action) const;
  // For the first judge of the structure.
  std::shared_ptr<OrderedBlocks> take_ordered_blocks() { return std::move(ordered_); }
  // The system Jacobian; users evaluate it first.
  SystemJacobian& leading() { return leading_; }
  // Frees the memory of the values until they are computed again.
  void forget_values() { std::vector<double>().swap(values_); }
  // Multiplies each value by 1 + size times a random number, until they are computed again.
  void perturb(double size);
  const std::vector<int>& first() const { return first_; }
  const std::vector<int>& column() const { return column_; }
  const std::vector<double>& values() const { return values_; }

 private:
  // True if nothing is differentiated or replaced.
  bool are_rows_as_recorded() const { return highest_level_ == 0 && sums_.parts.empty(); }
  CallbackError residuals_as_recorded(const Jet& jet, double* r);
  void make_pattern();
  CallbackError evaluate(const Jet& jet, int more);
  const LaneEvaluator* evaluate_lanes(const std::vector<Jet>& jets, int count, bool with_gradients);
  double value_of(int row) const;

  static constexpr int deep = 12;

  RecordedProblem& problem_;
  std::shared_ptr<const Structure> structure_;
  std::shared_ptr<OrderedBlocks> ordered_;
  int n_;
  ExtensionLayout layout_;
  ExtensionSums sums_;
  int highest_level_;
  std::vector<int> first_, column_;
  // Empty if values are derivatives of the recorded equations as they are, in their order.
  std::vector<EntryTerm> terms_;
  std::vector<double> coefficients_, values_;
  SystemJacobian leading_;
  std::vector<double> F_;  // coefficients of the recorded equations; empty if these are the residuals
  JetLanes lanes_;
};

template <class Coefficient>
void MinimalExtension::take_derivatives(Coefficient coefficient, double* values) const {
  const std::size_t length = index(highest_level_ + 1);
  if (terms_.empty()) {
    for (std::size_t e = 0; e < column_.size(); ++e)
      values[e] = length == 1 ? coefficient(e, std::size_t(0)) : coefficient(e / length, e % length);
    return;
  }
  std::fill_n(values, column_.size(), 0.0);
  for (const EntryTerm& term : terms_)
    values[index(term.entry)] += term.factor * coefficient(term.coefficient / length, term.coefficient % length);
}

template <class Action>
void MinimalExtension::for_each_term(Action action) const {
  const std::size_t length = index(highest_level_ + 1);
  if (terms_.empty())
    for (std::size_t e = 0; e < column_.size(); ++e) action(e, e / length, e % length, 1.0);
  for (const EntryTerm& term : terms_)
    action(index(term.entry), term.coefficient / length, term.coefficient % length, term.factor);
}

}  // namespace sfdae::core
