// Node: the end of a step of a Radau method, or a point within a step that was computed as such.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace sfdae::core {

struct RadauNode {
  void assign_zero(std::size_t n, std::size_t size_w) {
    for (std::vector<double>* v : {&w, &wdot}) v->assign(size_w, 0.0);
    for (std::vector<double>* v : {&x, &xdot}) v->assign(n, 0.0);
  }

  double t = 0.0;
  std::vector<double> w, wdot, x, xdot;
};

// Variables that polynomials through nodes interpolate.
enum class Interpolated { w, x };

inline const std::vector<double>& values_of(const RadauNode& node, Interpolated which) {
  return which == Interpolated::w ? node.w : node.x;
}
inline const std::vector<double>& slopes_of(const RadauNode& node, Interpolated which) {
  return which == Interpolated::w ? node.wdot : node.xdot;
}

}  // namespace sfdae::core
