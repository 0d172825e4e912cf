// Blocks as strongly connected components [T72], without recursion: an equation points to those that its unknowns are
// assigned to. A component is complete when all that it points to are, so that they come in the order required.
// SPDX-License-Identifier: BSD-3-Clause
#include "structure/blocks.h"

#include <algorithm>

namespace sfdae::core {

namespace {

class ComponentSearch {
 public:
  ComponentSearch(const Signature& signature, const Transversal& transversal, const Offsets& offsets)
      : signature_(signature),
        transversal_(transversal),
        offsets_(offsets),
        number_(index(signature.size()), -1),
        lowest_(number_),
        position_(index(signature.size())),
        is_open_(index(signature.size())) {}

  // done: called with the equations of each component.
  template <class Action>
  void run(Action done) {
    for (int i = 0; i < signature_.size(); ++i)
      if (number_[index(i)] < 0) visit(i, done);
  }

 private:
  void open(int i) {
    number_[index(i)] = lowest_[index(i)] = count_++;
    is_open_[index(i)] = 1;
    open_.push_back(i);
    path_.push_back(i);
  }

  template <class Action>
  void visit(int start, Action done) {
    open(start);
    while (!path_.empty()) {
      const int i = path_.back();
      const auto entries = signature_.row(i);
      if (position_[index(i)] < entries.size()) {
        follow(i, entries[position_[index(i)]++]);
        continue;
      }
      path_.pop_back();
      if (!path_.empty()) lower(path_.back(), lowest_[index(i)]);
      if (lowest_[index(i)] == number_[index(i)]) close(i, done);
    }
  }

  void follow(int i, const Signature::Entry& entry) {
    if (!offsets_.is_leading(i, entry)) return;
    const int next = transversal_.equation_of[index(entry.unknown)];
    if (number_[index(next)] < 0) open(next);
    else if (is_open_[index(next)] != 0) lower(i, number_[index(next)]);
  }

  void lower(int i, int number) { lowest_[index(i)] = std::min(lowest_[index(i)], number); }

  template <class Action>
  void close(int i, Action done) {
    const auto first = std::find(open_.rbegin(), open_.rend(), i).base() - 1;
    for (auto equation = first; equation != open_.end(); ++equation) is_open_[index(*equation)] = 0;
    done(std::span<const int>(first, open_.end()));
    open_.erase(first, open_.end());
  }

  const Signature& signature_;
  const Transversal& transversal_;
  const Offsets& offsets_;
  int count_ = 0;
  std::vector<int> number_, lowest_;   // order of first visits, and the least one that can be reached
  std::vector<std::size_t> position_;  // of the entry to follow next
  std::vector<char> is_open_;          // not in a component yet
  std::vector<int> open_, path_;
};

}  // namespace

Blocks::Blocks(const Signature& signature, const Transversal& transversal, const Offsets& offsets) {
  ComponentSearch(signature, transversal, offsets).run([&](std::span<const int> equations) {
    equations_.insert(equations_.end(), equations.begin(), equations.end());
    std::sort(equations_.end() - static_cast<std::ptrdiff_t>(equations.size()), equations_.end());
    first_.push_back(static_cast<int>(equations_.size()));
  });
  equations_.shrink_to_fit();
  first_.shrink_to_fit();
  unknowns_.reserve(equations_.size());
  for (int i : equations_) unknowns_.push_back(transversal.unknown_of[index(i)]);
}

int Blocks::largest() const {
  std::size_t largest = 0;
  for (int block = 0; block < count(); ++block) largest = std::max(largest, equations(block).size());
  return static_cast<int>(largest);
}

}  // namespace sfdae::core
