// Exchanges after the elimination: q of a lower class for p of a higher one, if q depends on p, w_p != 0, w = A_B^-1
// A_q.
//
// w^T = L(q, :) L_B^-1, L_B: the rows of L that belong to the basic columns of the elimination. An exchange
// multiplies A_B by E from the right, the identity with w in column p: later solutions are multiplied by E^-1
// (product form).
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/column_basis.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "linalg/column_elimination.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

using Entry = ColumnElimination::Entry;

class Exchanges {
 public:
  Exchanges(const ColumnElimination& elimination, const BasisSettings& settings, int columns);
  void run(ColumnBasis& result);

 private:
  struct Exchange {
    int pivot;
    std::vector<Entry> w;  // by pivots, without that of `pivot`
    double w_pivot;
  };
  int class_of(int column) const { return settings_.classes[index(column)]; }
  int highest_basic_class() const;
  void solve(int column);
  int leaving_pivot_for(int column);
  void exchange(int pivot, int column, ColumnBasis& result);

  const ColumnElimination& elimination_;
  const BasisSettings& settings_;
  std::vector<int> first_of_column_;  // rows of L
  std::vector<Entry> rows_;
  std::vector<int> basic_;                 // column of each pivot
  std::vector<std::vector<int>> waiting_;  // columns left over, by class
  std::vector<Exchange> exchanges_;
  std::vector<double> w_;
  double largest_ = 0.0;  // of w
};

Exchanges::Exchanges(const ColumnElimination& elimination, const BasisSettings& settings, int columns)
    : elimination_(elimination),
      settings_(settings),
      first_of_column_(index(columns) + 1, 0),
      rows_(elimination.entries().size()),
      basic_(elimination.column_of_pivot()),
      w_(elimination.column_of_pivot().size()) {
  for (const Entry& entry : elimination.entries()) ++first_of_column_[index(entry.place) + 1];
  std::partial_sum(first_of_column_.begin(), first_of_column_.end(), first_of_column_.begin());
  std::vector<int> next(first_of_column_.begin(), first_of_column_.end() - 1);
  for (std::size_t pivot = 0; pivot < basic_.size(); ++pivot)
    for (int k = elimination.first_of_pivot()[pivot]; k < elimination.first_of_pivot()[pivot + 1]; ++k) {
      const Entry& entry = elimination.entries()[index(k)];
      rows_[index(next[index(entry.place)]++)] = {static_cast<int>(pivot), entry.value};
    }
  const int highest =
      settings.classes.empty() ? 0 : *std::max_element(settings.classes.begin(), settings.classes.end());
  waiting_.resize(index(highest) + 1);
  if (settings.classes.empty()) return;
  for (int column = 0; column < columns; ++column)
    if (elimination.pivot_of_column(column) < 0) waiting_[index(class_of(column))].push_back(column);
}

int Exchanges::highest_basic_class() const {
  int highest = 0;
  for (const int column : basic_) highest = std::max(highest, class_of(column));
  return highest;
}

// Classes ascending: a column refused once depends on basic columns of its class and lower ones only, and stays
// refused.
void Exchanges::run(ColumnBasis& result) {
  if (settings_.classes.empty() || basic_.empty()) return;
  int highest = highest_basic_class();
  for (int entering = 0; entering < static_cast<int>(waiting_.size()); ++entering)
    for (std::size_t k = 0; k < waiting_[index(entering)].size() && entering < highest; ++k) {
      const int column = waiting_[index(entering)][k];
      solve(column);
      const int pivot = leaving_pivot_for(column);
      if (pivot < 0) continue;
      exchange(pivot, column, result);
      highest = highest_basic_class();
    }
  for (std::size_t pivot = 0; pivot < basic_.size(); ++pivot)
    result.column_of_row[index(elimination_.row_of_pivot()[pivot])] = basic_[pivot];
}

// w := A_B^-1 A_column
void Exchanges::solve(int column) {
  std::fill(w_.begin(), w_.end(), 0.0);
  const int own_pivot = elimination_.pivot_of_column(column);
  int last = own_pivot;
  if (own_pivot >= 0) {
    w_[index(own_pivot)] = 1.0;
  } else {
    for (int k = first_of_column_[index(column)]; k < first_of_column_[index(column) + 1]; ++k) {
      w_[index(rows_[index(k)].place)] = rows_[index(k)].value;
      last = std::max(last, rows_[index(k)].place);
    }
    for (int pivot = last; pivot >= 0; --pivot) {
      const double value = w_[index(pivot)];
      if (value == 0.0) continue;
      const std::size_t first_basic = index(elimination_.column_of_pivot()[index(pivot)]);
      for (int k = first_of_column_[first_basic]; k < first_of_column_[first_basic + 1]; ++k)
        w_[index(rows_[index(k)].place)] -= value * rows_[index(k)].value;
    }
  }
  for (const Exchange& before : exchanges_) {
    double& of_pivot = w_[index(before.pivot)];
    if (of_pivot == 0.0) continue;
    of_pivot /= before.w_pivot;
    for (const Entry& entry : before.w) w_[index(entry.place)] -= of_pivot * entry.value;
  }
}

// The largest entry of w that belongs to a higher class; -1: none is large enough.
int Exchanges::leaving_pivot_for(int column) {
  largest_ = 0.0;
  int best = -1;
  for (std::size_t pivot = 0; pivot < w_.size(); ++pivot) {
    const double size = std::fabs(w_[pivot]);
    largest_ = std::max(largest_, size);
    if (class_of(basic_[pivot]) > class_of(column) && (best < 0 || size > std::fabs(w_[index(best)])))
      best = static_cast<int>(pivot);
  }
  const bool suffices =
      best >= 0 && w_[index(best)] != 0.0 && std::fabs(w_[index(best)]) >= settings_.exchange * largest_;
  return suffices ? best : -1;
}

void Exchanges::exchange(int pivot, int column, ColumnBasis& result) {
  Exchange exchange{pivot, {}, w_[index(pivot)]};
  for (std::size_t other = 0; other < w_.size(); ++other)
    if (w_[other] != 0.0 && static_cast<int>(other) != pivot)
      exchange.w.push_back({static_cast<int>(other), w_[other]});
  exchanges_.push_back(std::move(exchange));
  waiting_[index(class_of(basic_[index(pivot)]))].push_back(basic_[index(pivot)]);
  basic_[index(pivot)] = column;
  result.smallest_pivot = std::min(result.smallest_pivot, std::fabs(w_[index(pivot)]) / largest_);
  ++result.exchanges;
}

}  // namespace

ColumnBasis column_basis(const SparseRows& a, const BasisSettings& settings) {
  ColumnBasis result;
  if (a.rows() > 0) {
    ColumnElimination elimination(a, settings);
    elimination.run(result);
    Exchanges(elimination, settings, a.columns).run(result);
  }
  std::vector<bool> is_basic(index(a.columns));
  for (const int column : result.column_of_row)
    if (column >= 0) is_basic[index(column)] = true;
  for (int column = 0; column < a.columns; ++column) {
    if (is_basic[index(column)]) continue;
    result.left_over.push_back(column);
    if (settings.classes.empty() || settings.classes[index(column)] == 0) result.has_all_of_class_0 = false;
  }
  return result;
}

}  // namespace sfdae::core
