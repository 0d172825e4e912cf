// Search for places within a step where inputs differ from the polynomials through their values at its nodes, by
// interval enclosures.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "expression/time_inputs.h"

namespace sfdae::core {

// Weights of the node values in the value at t of the interpolating polynomial.
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

  // True if all node values are finite.
  bool is_defined(std::size_t i) const { return at_nodes_[i].is_defined; }
  // Values at all nodes, and at the nodes that are not before the step.
  Interval range(std::size_t i) const { return at_nodes_[i].all; }
  Interval range_within(std::size_t i) const { return at_nodes_[i].within; }
  double value(std::size_t i, double y) const;
  Interval values(std::size_t i, Interval y) const;
  // Enclosures of the first derivative with respect to t, and of half the second one.
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
  // nodes: the points of a step of size h at which equations are evaluated: its start first, then others, including
  // earlier ones. fastest: time scale on which inputs are known to change, or 0.
  void search(TimeInputs& inputs, std::span<const double> nodes, double h, double fastest);
  // Times at which inputs are far from the polynomial through their node values, or unexpectedly outside the range of
  // these values, the worst first.
  std::span<const double> unseen() const { return unseen_.all(); }
  // Times of peaks of inputs that steep functions use: the largest or smallest values outside the range of the node
  // values, whether the polynomial predicts them or not.
  std::span<const double> peaks() const { return peaks_.all(); }
  // Factor by which inputs may be farther from their polynomials elsewhere than at these places; at most 1: negligible.
  double doubt() const { return doubt_; }
  // Bound on the distances of inputs from their polynomials, relative to their ranges.
  double farthest() const { return farthest_; }

 private:
  // In y; score above 1: the inputs are not known accurately enough in it.
  struct Piece {
    double low, high, score;
    bool operator<(const Piece& other) const { return score < other.score; }
  };
  struct Sample {
    std::vector<double> values, distances;  // from the polynomials
  };
  struct Extreme {
    double value, t, reach;  // reach: distance to the neighboring samples
  };
  // Samples of an input: the largest and the smallest, the farthest from the polynomial, and those most above and below
  // the node values without being predicted there.
  struct Seen {
    Extreme high, low, far, above, below;
  };
  // Different times in descending order of their scores; scores up to one are ignored.
  class Places {
   public:
    void resize(std::size_t most);
    void clear() { places_.clear(); }
    void add(double score, double t);
    // Merges times that are nearer to each other than `same`.
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
