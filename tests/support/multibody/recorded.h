// SPDX-License-Identifier: BSD-3-Clause
// A system handed to the library for recording, as a multibody system and as a general nonlinear problem.
#ifndef SFDAE_TESTS_MULTIBODY_RECORDED_H
#define SFDAE_TESTS_MULTIBODY_RECORDED_H

#include <algorithm>
#include <vector>

#include "sfdae/expression.hpp"
#include "sfdae/sfdae.h"
#include "system.h"
#include "test_set/scalar.h"

namespace sfdae_test {

// `user` is the system.
template <class System>
struct RecordedMultibody {
  using Numbers = std::vector<sfdae::Expression>;

  static int multibody(sfdae_record*, sfdae_expression t, const sfdae_expression* q, const sfdae_expression* v,
                       const sfdae_multibody_formulas* formulas, void* user) {
    const System& system = *static_cast<const System*>(user);
    const SystemSizes& s = system.sizes;
    const Numbers position(q, q + s.positions), velocity(v, v + s.positions);
    Numbers M = none(s.positions * s.positions), f = none(s.positions), g = none(s.holonomic),
            H = none(s.nonholonomic * s.positions), h = none(s.nonholonomic);
    system.mass(sfdae::Expression(t), position.data(), M.data());
    system.force(sfdae::Expression(t), position.data(), velocity.data(), f.data());
    system.constraints(sfdae::Expression(t), position.data(), g.data());
    system.nonholonomic(sfdae::Expression(t), position.data(), H.data(), h.data());
    write(M, formulas->M);
    write(f, formulas->f);
    write(g, formulas->g);
    write(H, formulas->H);
    write(h, formulas->h);
    return 0;
  }

  static int general(sfdae_record*, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                     sfdae_expression* residual, void* user) {
    const System& system = *static_cast<const System*>(user);
    const int n = system.sizes.unknowns();
    const Numbers unknowns(x, x + n), slopes(xdot, xdot + n);
    Numbers F = none(n);
    general_residual(system, sfdae::Expression(t), unknowns.data(), slopes.data(), F.data());
    write(F, residual);
    return 0;
  }

 private:
  static Numbers none(int count) { return zeros<sfdae::Expression>(count); }
  static void write(const Numbers& from, sfdae_expression* to) {
    std::transform(from.begin(), from.end(), to, [](const sfdae::Expression& e) { return e.c(); });
  }
};

}  // namespace sfdae_test

#endif
