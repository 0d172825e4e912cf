// Highest-value transversal by shortest augmenting paths, in phases. Every phase finds the distance from the equations
// without an unknown to the nearest free unknown, changes the prices by it, and takes as many paths of that length as
// do not meet [HK73; BDM09]. Costs are M - sigma; an entry with prices u_i + v_j = cost is tight, and paths run along
// tight entries.
// SPDX-License-Identifier: BSD-3-Clause
#include "structure/transversal.h"

#include <algorithm>
#include <limits>

namespace sfdae::core {

namespace {

constexpr int unreached = std::numeric_limits<int>::max();

class Search {
 public:
  explicit Search(const Signature& signature);
  Transversal run();

 private:
  using Entry = Signature::Entry;

  int reduced_cost(int i, const Entry& entry) const {
    return highest_ - entry.order - row_price_[index(i)] - column_price_[index(entry.unknown)];
  }
  bool is_tight(int i, const Entry& entry) const { return reduced_cost(i, entry) == 0; }
  void assign(int i, int j) {
    result_.unknown_of[index(i)] = j;
    result_.equation_of[index(j)] = i;
  }
  bool is_free_row(int i) const { return result_.unknown_of[index(i)] < 0; }
  int owner(int j) const { return result_.equation_of[index(j)]; }

  bool set_first_prices();
  void assign_tight_entries();
  int find_distances();
  void change_prices(int distance);
  bool augment();
  bool set_levels();
  bool augment_from(int row);
  Overdetermined overdetermined() const;

  const Signature& signature_;
  int n_, highest_;
  Transversal result_;
  std::vector<int> row_price_, column_price_;
  std::vector<int> row_distance_, column_distance_;
  std::vector<int> level_;             // of rows, along tight entries from a free row on
  std::vector<std::size_t> position_;  // in the row, of the entry to be tried next
  std::vector<int> path_;
};

Search::Search(const Signature& signature)
    : signature_(signature),
      n_(signature.size()),
      highest_(signature.highest_order()),
      row_price_(index(n_)),
      column_price_(index(n_), unreached),
      level_(index(n_)),
      position_(index(n_)) {
  result_.unknown_of.assign(index(n_), -1);
  result_.equation_of.assign(index(n_), -1);
}

Transversal Search::run() {
  if (set_first_prices()) {
    assign_tight_entries();
    while (std::find(result_.unknown_of.begin(), result_.unknown_of.end(), -1) != result_.unknown_of.end()) {
      const int distance = find_distances();
      if (distance == unreached) break;
      change_prices(distance);
      while (augment()) {
      }
    }
  }
  result_.overdetermined = overdetermined();
  return result_;
}

// False if a row is empty.
bool Search::set_first_prices() {
  for (int i = 0; i < n_; ++i)
    for (const Entry& entry : signature_.row(i)) {
      int& price = column_price_[index(entry.unknown)];
      price = std::min(price, highest_ - entry.order);
    }
  for (int i = 0; i < n_; ++i) {
    int price = unreached;
    for (const Entry& entry : signature_.row(i))
      price = std::min(price, highest_ - entry.order - column_price_[index(entry.unknown)]);
    if (price == unreached) return false;
    row_price_[index(i)] = price;
  }
  return true;
}

void Search::assign_tight_entries() {
  for (int i = 0; i < n_; ++i)
    for (const Entry& entry : signature_.row(i))
      if (is_free_row(i) && owner(entry.unknown) < 0 && is_tight(i, entry)) assign(i, entry.unknown);
}

// Distances from the free rows to all rows and columns that are at most as far as the nearest free column; returns its
// distance. Costs are small numbers, so that rows wait in lists by distance.
int Search::find_distances() {
  row_distance_.assign(index(n_), unreached);
  column_distance_.assign(index(n_), unreached);
  std::vector<std::vector<int>> waiting(1);
  for (int i = 0; i < n_; ++i)
    if (is_free_row(i)) {
      row_distance_[index(i)] = 0;
      waiting[0].push_back(i);
    }
  int nearest = unreached;
  const auto reach = [&](int j, int distance) {
    if (distance >= column_distance_[index(j)] || distance > nearest) return;
    column_distance_[index(j)] = distance;
    const int next = owner(j);
    if (next < 0) {
      nearest = distance;
    } else if (distance < row_distance_[index(next)]) {
      row_distance_[index(next)] = distance;
      if (waiting.size() <= index(distance)) waiting.resize(index(distance) + 1);
      waiting[index(distance)].push_back(next);
    }
  };
  for (std::size_t distance = 0; distance < waiting.size() && static_cast<int>(distance) <= nearest; ++distance)
    for (std::size_t k = 0; k < waiting[distance].size(); ++k) {
      const int i = waiting[distance][k];
      if (row_distance_[index(i)] != static_cast<int>(distance)) continue;
      for (const Entry& entry : signature_.row(i))
        reach(entry.unknown, static_cast<int>(distance) + reduced_cost(i, entry));
    }
  return nearest;
}

void Search::change_prices(int distance) {
  for (int i = 0; i < n_; ++i)
    if (row_distance_[index(i)] < distance) row_price_[index(i)] += distance - row_distance_[index(i)];
  for (int j = 0; j < n_; ++j)
    if (column_distance_[index(j)] < distance) column_price_[index(j)] -= distance - column_distance_[index(j)];
}

// Augments along tight entries, shortest paths first; false if there is none.
bool Search::augment() {
  if (!set_levels()) return false;
  std::fill(position_.begin(), position_.end(), 0);
  bool found = false;
  for (int i = 0; i < n_; ++i)
    if (is_free_row(i) && augment_from(i)) found = true;
  return found;
}

bool Search::set_levels() {
  std::fill(level_.begin(), level_.end(), unreached);
  std::vector<int> queue;
  for (int i = 0; i < n_; ++i)
    if (is_free_row(i)) {
      level_[index(i)] = 0;
      queue.push_back(i);
    }
  bool reaches_free_column = false;
  for (std::size_t k = 0; k < queue.size(); ++k) {
    const int i = queue[k];
    for (const Entry& entry : signature_.row(i)) {
      if (!is_tight(i, entry)) continue;
      const int next = owner(entry.unknown);
      if (next < 0) {
        reaches_free_column = true;
      } else if (level_[index(next)] == unreached) {
        level_[index(next)] = level_[index(i)] + 1;
        queue.push_back(next);
      }
    }
  }
  return reaches_free_column;
}

// Depth first, without recursion: position_ of the rows on the path are the entries it takes.
bool Search::augment_from(int row) {
  path_.assign(1, row);
  while (!path_.empty()) {
    const int i = path_.back();
    const auto entries = signature_.row(i);
    std::size_t& position = position_[index(i)];
    if (position == entries.size()) {
      path_.pop_back();
      if (!path_.empty()) ++position_[index(path_.back())];
      continue;
    }
    const Entry& entry = entries[position];
    const int next = owner(entry.unknown);
    if (is_tight(i, entry) && next < 0) {
      for (int on_path : path_) {
        std::size_t& taken = position_[index(on_path)];
        assign(on_path, signature_.row(on_path)[taken].unknown);
        taken = signature_.row(on_path).size();  // paths do not meet
      }
      return true;
    }
    const bool continues = is_tight(i, entry) && level_[index(next)] == level_[index(i)] + 1 &&
                           position_[index(next)] < signature_.row(next).size();
    if (continues) path_.push_back(next);
    else ++position;
  }
  return false;
}

// The part reached from an unassigned equation: its unknowns, the equations they are assigned to, and so on. None of
// these unknowns is free, or there would be a path.
Overdetermined Search::overdetermined() const {
  Overdetermined result;
  for (int i = 0; i < n_; ++i)
    if (signature_.row(i).empty()) return {.equations = {i}, .unknowns = {}};
  for (int i = 0; i < n_ && result.equations.empty(); ++i)
    if (is_free_row(i)) result.equations.push_back(i);
  std::vector<char> is_reached(index(n_));
  for (std::size_t k = 0; k < result.equations.size(); ++k)
    for (const Entry& entry : signature_.row(result.equations[k])) {
      if (is_reached[index(entry.unknown)] != 0) continue;
      is_reached[index(entry.unknown)] = 1;
      result.unknowns.push_back(entry.unknown);
      result.equations.push_back(owner(entry.unknown));
    }
  std::sort(result.equations.begin(), result.equations.end());
  std::sort(result.unknowns.begin(), result.unknowns.end());
  return result;
}

}  // namespace

Transversal highest_transversal(const Signature& signature) { return Search(signature).run(); }

}  // namespace sfdae::core
