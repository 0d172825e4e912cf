// SPDX-License-Identifier: BSD-3-Clause
// The mechanical systems of the test set as multibody systems: what is known of each.
#ifndef SFDAE_TESTS_MULTIBODY_MODELS_H
#define SFDAE_TESTS_MULTIBODY_MODELS_H

#include <string>
#include <utility>
#include <vector>

#include "system.h"
#include "test_set/andrews.h"
#include "test_set/car_axis.h"
#include "test_set/fekete.h"
#include "test_set/pendulum.h"
#include "test_set/rigid_slider_crank.h"
#include "test_set/slider_crank.h"

namespace sfdae_test {

// visit(problem, system) for each. The problem has x0 and references for (q, v) alone: multipliers of its equations
// may differ from those of G^T lambda in sign and size.
template <class Visitor>
void for_each_multibody_model(Visitor&& visit) {
  const auto model = [&visit](TestProblem p, const auto& system, int counted) {
    const SystemSizes& s = system.sizes;
    p.m = p.n = s.unknowns();
    p.x0.resize(static_cast<std::size_t>(2 * s.positions));
    const int freedom = s.positions - s.holonomic;
    p.values = {2, 2 * freedom, p.n - 2 * freedom, 0, 0};
    p.counted = first_components(counted);
    visit(std::as_const(p), system);
  };
  model(pendulum(), DirectSystem<Pendulum>(), 4);
  model(car_axis(), DirectSystem<CarAxis>(), 8);
  model(rigid_slider_crank(), DirectSystem<RigidSliderCrank>(), 6);
  model(slider_crank(), AcceleratedSystem<SliderCrank>(), 7);
  model(andrews(), AcceleratedSystem<Andrews>(), 7);
  TestProblem sphere = fekete_position();
  sphere.name = "fekete";
  model(std::move(sphere), DirectSystem<Fekete>(), 60);
}

}  // namespace sfdae_test

#endif
