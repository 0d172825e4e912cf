// Whether the points that a step looks at show what inputs do between them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "expression/time_inputs.h"

namespace sfdae::core {

// Of the values at the nodes, for the value at t of the polynomial through them.
void set_lagrange_weights(std::span<const double> nodes, double t, double* weights);

class InputSamples {
 public:
  static constexpr std::size_t most_nodes = 8;

  void resize(int inputs);
  // nodes: the points of a step of size h at which equations are evaluated, the start first, those before it among
  // them. Inputs are sampled in between. fastest: in which time inputs are known to change, or 0.
  void take(TimeInputs& inputs, std::span<const double> nodes, double h, double fastest);
  // Times at which inputs are far from the polynomial through their values at the nodes, or unexpectedly beyond all
  // of these, the worst ones first.
  std::span<const double> unseen() const { return unseen_.all(); }
  // Times at which inputs of steep functions are largest or smallest, beyond their values at the nodes, expected or
  // not.
  std::span<const double> crests() const { return crests_.all(); }

 private:
  struct Extreme {
    double value, distance, t;
  };
  struct Interval {
    double start, end;
  };
  // Times in the order of their scores; those with scores up to one are none.
  class Places {
   public:
    void clear() { count_ = 0; }
    void add(double score, double t);
    std::span<const double> all() const { return std::span(t_).first(count_); }

   private:
    static constexpr std::size_t most = 4;
    std::array<double, most> t_{}, scores_{};
    std::size_t count_ = 0;
  };
  void take_nodes(TimeInputs& inputs, std::span<const double> nodes);
  void take_sample(TimeInputs& inputs, std::span<const double> nodes, double t);
  void take_expected_extremes(TimeInputs& inputs, std::span<const double> nodes, double h);
  double expected(std::size_t i, std::size_t nodes, const double* weights) const;
  double range_of(std::size_t i) const;
  bool are_smooth() const;
  void find_unseen();
  void find_crests(TimeInputs& inputs, std::span<const double> nodes, double spacing, double h);
  double crest(TimeInputs& inputs, std::size_t i, double sign, double spacing, double at, const Interval& step);

  std::vector<double> at_nodes_;  // of input i, one for each node, from i most_nodes on
  std::vector<double> now_;
  // Of each input, at the nodes and in between, with the distance from the polynomial there; and where that is largest.
  std::vector<double> lowest_node_, highest_node_;
  std::vector<Extreme> lowest_, highest_, farthest_;
  Places unseen_, crests_;
};

}  // namespace sfdae::core
