// The user's events and their state during integrations.
// SPDX-License-Identifier: BSD-3-Clause
#include "watch/events.h"

#include <algorithm>

#include "linalg/index.h"

namespace sfdae::core {

void Events::resize(std::size_t n) {
  for (Point* point : {&searched, &candidate, &now, &rough}) {
    point->x.resize(n);
    point->xdot.resize(n);
  }
  for (std::vector<double>* g : {&g_now, &g_rough, &rough_error}) g->resize(index(search.count()));
  resolution.resize(index(search.count()));
}

void Events::begin_step(double t) {
  resolution.begin_step(t, search.g());
  std::fill(rough_error.begin(), rough_error.end(), 0.0);
}

int Events::evaluate(double t, const Point& point, std::vector<double>& g) const {
  std::fill(g.begin(), g.end(), 0.0);
  return function(t, point.x.data(), point.xdot.data(), g.data(), user);
}

}  // namespace sfdae::core
