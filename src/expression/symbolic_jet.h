// Taylor coefficients of recorded expressions along a jet, recorded themselves, and their first derivatives.
//
// [GW08] A. Griewank, A. Walther: Evaluating Derivatives, 2nd ed. SIAM, 2008. Section 13.2: recurrences of
// coefficients; their cost is quadratic in the order, while repeated differentiation of formulas is exponential.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "expression/recorder.h"

namespace sfdae::core {

// Returns whether the equations call user-supplied functions or tables.
bool has_functions(const Record& record);

// First derivatives by unknowns and their derivatives. Carried forward, so that a branch that was not chosen has no
// influence, even if its derivatives do not exist.
class SymbolicPartials {
 public:
  explicit SymbolicPartials(Recorder& recorder) : recorder_(recorder) {}
  struct Leaf {
    int unknown;
    bool derivative;
    auto operator<=>(const Leaf&) const = default;
  };
  using Gradient = std::map<Leaf, int>;  // nodes, but those that are zero
  const Gradient& of(int node);

 private:
  Gradient gradient(int node);

  Recorder& recorder_;
  std::map<int, Gradient> known_;
};

class SymbolicJet {
 public:
  // leaf: the node in `to` of Taylor coefficient k of an unknown x_j, or of its derivative x_j'. Nodes are those of
  // `from`, where auxiliary ones are recorded.
  using Leaf = std::function<int(int unknown, bool derivative, int k)>;
  SymbolicJet(Recorder& from, Recorder& to, Leaf leaf) : from_(from), to_(to), leaf_(std::move(leaf)) {}

  // Taylor coefficient k of a node.
  int coefficient(int node, int k);
  // The parameters have these names and values.
  void set_parameters(const std::vector<Parameter>& parameters) { parameters_ = &parameters; }

 private:
  void prepare(int node, int k);
  int compute(int node, int k);
  int compute_leaf(const Node& node, int k);
  int convolution(int a, int b, int first, int k);
  int quotient(const Node& node, int v, int k);
  int by_slopes(int node, int k);
  int number(double value) { return to_.constant(value); }

  Recorder &from_, &to_;
  Leaf leaf_;
  const std::vector<Parameter>* parameters_ = nullptr;
  std::map<int, std::vector<int>> known_;  // coefficients by nodes
};

}  // namespace sfdae::core
