// The last nodes of a Radau integration, its last step and nodes within that.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "integrate/radau_node.h"
#include "integrate/radau_polynomial.h"
#include "integrate/radau_stages.h"
#include "integrate/stepper.h"
#include "linalg/archive.h"
#include "system/stage_method.h"

namespace sfdae::core {

// Maximum number of nodes: enough for divided differences of order 2s that include a new one.
inline constexpr int max_radau_nodes = max_stages + 1;

// Nodes of an interpolation polynomial.
struct ChosenNodes {
  std::array<const RadauNode*, max_radau_nodes> nodes{};
  int count = 0;
};

class RadauHistory {
 public:
  void resize(std::size_t n, std::size_t size_w, const StepOptions& options);
  void start(const StartingPoint& point);

  // Number of nodes; node 0 is the newest.
  int count() const { return count_; }
  const RadauNode& node(int i) const { return nodes_[index(i)]; }
  const RadauNode& newest() const { return nodes_[0]; }
  const LastStep& last() const { return last_; }
  int last_stages() const { return (last_.order + 1) / 2; }
  // Collocation polynomial of the last step, if any.
  const RadauPolynomial& polynomial() const { return polynomial_; }
  void note_test(double error) { polynomial_.note_test(error); }

  // Takes over an accepted step, and leaves arbitrary values in it.
  void append(RadauStep& step, const InteriorErrors& errors);
  // The solution is less smooth than the nodes before the newest suggest.
  void forget_past() { count_ = 1; }
  // Takes over a node within the last step; later polynomials of this step use it.
  const RadauNode& insert(RadauNode& node);
  int inner_count() const { return inner_count_; }

  // The newest nodes, `count` of them.
  ChosenNodes newest_nodes(int count) const;
  // Both ends of the last step and the nodes nearest to t, one more than that step had stages, if there are so many.
  ChosenNodes nodes_around(double t) const;

  // Contents of a checkpoint: points within steps need one node more than the next step does.
  struct Extent {
    int nodes, order, inner;
  };
  Extent extent(const StepOptions& options) const;
  // Allocates memory for this extent; throws DamagedArchive if it is invalid.
  void set_extent(const Extent& extent, const StrangenessFreeSystem& system, const StepOptions& options);
  // with_x: at all nodes, not only at the newest one; with_w: of the polynomial.
  struct Content {
    bool with_x, with_polynomial, with_w;
  };
  void archive(Archive& archive, const Extent& extent, const Content& content);

 private:
  // Points within one step at which outputs were requested and the polynomial was too inaccurate: a few (chosen).
  static constexpr int inner_capacity = 6;

  std::array<RadauNode, max_radau_nodes> nodes_;
  int count_ = 0, max_count_ = 0;
  std::array<RadauNode, inner_capacity> inner_;
  int inner_count_ = 0;
  LastStep last_;
  RadauPolynomial polynomial_;
};

}  // namespace sfdae::core
