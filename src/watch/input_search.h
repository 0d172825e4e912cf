// A search for places within a step where inputs differ from the polynomials through their values at its nodes, by
// enclosures.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "expression/time_inputs.h"

namespace sfdae::core {

// Weights of the values at the nodes in the value at t of the polynomial through them.
void set_lagrange_weights(std::span<const double> nodes, double t, double* weights);

// Polynomials through the values of inputs at the nodes of a step, in y from -1 at its start to 1 at its end.
class NodePolynomials {
 public:
  static constexpr std::size_t most_nodes = 8;

  void resize(std::size_t inputs);
  // nodes: the start of the step of size h is the first one.
  void set(TimeInputs& inputs, std::span<const double> nodes, double h);
  double time(double y) const { return middle_ + y * half_; }
  double half() const { return half_; }

  // True if all values at nodes are finite.
  bool is_defined(std::size_t i) const { return at_nodes_[i].is_defined; }
  // Values at all nodes, and at those of them that are not before the step.
  Interval range(std::size_t i) const { return at_nodes_[i].all; }
  Interval range_within(std::size_t i) const { return at_nodes_[i].within; }
  double value(std::size_t i, double y) const;
  Interval values(std::size_t i, Interval y) const;
  // Enclosures of the first derivative by t, and of half the second one.
  Interval slopes(std::size_t i, Interval y) const;
  Interval bends(std::size_t i, Interval y) const;

 private:
  struct AtNodes {
    Interval all, within;
    bool is_defined;
    std::array<double, most_nodes> coefficients;  // of powers of y
  };
  void set_basis(std::span<const double> nodes);

  double middle_ = 0.0, half_ = 0.0;
  std::size_t count_ = 0;
  std::vector<AtNodes> at_nodes_;
  std::array<std::array<double, most_nodes>, most_nodes> basis_{};  // coefficients of the Lagrange polynomials
  std::vector<double> now_;
};

class InputSearch {
 public:
  static constexpr std::size_t most_nodes = NodePolynomials::most_nodes;

  void resize(int inputs);
  // nodes: the points of a step of size h at which equations are evaluated, the start first, those before it among
  // them. fastest: in which time inputs are known to change, or 0.
  void search(TimeInputs& inputs, std::span<const double> nodes, double h, double fastest);
  // Different times at which inputs are far from the polynomial through their values at the nodes, or unexpectedly
  // beyond all of these, the worst ones first.
  std::span<const double> unseen() const { return unseen_.all(); }
  // Times at which inputs of steep functions are largest or smallest, beyond their values at the nodes, expected or
  // not.
  std::span<const double> peaks() const { return peaks_.all(); }
  // How many times farther than at these places inputs may be from their polynomials elsewhere; at most 1: no more
  // than is of no importance.
  double doubt() const { return doubt_; }
  // A bound of the distances of inputs from their polynomials, of their ranges.
  double farthest() const { return farthest_; }

 private:
  // In y; score: above 1, what inputs do in it is not known well enough.
  struct Piece {
    double low, high, score;
    bool operator<(const Piece& other) const { return score < other.score; }
  };
  struct Sample {
    std::vector<double> values, distances;  // from the polynomials
  };
  struct Extreme {
    double value, t, reach;  // to the samples beside it
  };
  // Samples of an input: the largest and smallest ones, the farthest one, and those that are most above and below the
  // values at all nodes without being expected there.
  struct Seen {
    Extreme high, low, far, above, below;
  };
  // Different times in the order of their scores; those with scores up to one are none.
  class Places {
   public:
    void resize(std::size_t most);
    void clear() { places_.clear(); }
    void add(double score, double t);
    // Times that are nearer to each other than that become one.
    void finish(double same);
    std::span<const double> all() const { return t_; }

   private:
    struct Place {
      double score, t;
    };
    std::vector<Place> places_;
    std::vector<double> t_;
  };

  void take(TimeInputs& inputs, double y, double reach, Sample& sample);
  void add_piece(TimeInputs& inputs, Piece piece, const Sample& start, const Sample& end);
  double score(std::size_t i, const Piece& piece, const Sample& start, const Sample& end);
  double range_of(std::size_t i) const;
  void find_noise(TimeInputs& inputs, double start, double end);
  void find_places(TimeInputs& inputs);
  double peak(TimeInputs& inputs, std::size_t i, double sign, const Extreme& from);

  NodePolynomials polynomials_;
  std::vector<Seen> seen_;
  std::vector<TimeSeries> enclosed_;
  std::vector<double> noise_;  // rounding errors of inputs at the ends of the step
  std::array<Sample, 3> samples_;
  std::vector<Piece> pieces_;  // a heap
  Places unseen_, peaks_;
  double doubt_ = 0.0, farthest_ = 0.0;
  bool with_peaks_ = false;
};

}  // namespace sfdae::core
