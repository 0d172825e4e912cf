// SPDX-License-Identifier: BSD-3-Clause
// The test set in forms that codes for low index take:
//   raw   the equations themselves (index 0 or 1)
//   idx1  constraints differentiated twice
//   idx2  constraints differentiated once, multipliers (and accelerations) out of the error test
//   ggl2  constraints and their first derivatives (Gear, Gupta, Leimkuhler), multipliers out of the error test
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "ida_solver.h"
#include "test_set/test_set.h"

namespace sfdae_bench {

inline PeerProblem peer_problem(const sfdae_test::TestProblem& p, const char* form, PeerProblem::Residual residual,
                                int differential) {
  const std::string name = form;
  return {p.name, form,    residual,   p.t0,         p.tf,
          p.x0,   p.xdot0, p.restarts, differential, name == "idx1" || name == "raw"};
}

template <class System, sfdae_test::ConstraintLevel level>
void direct_form(int, double t, const double* x, const double* xdot, double* F) {
  sfdae_test::direct_residual<System, level>(t, x, xdot, F);
}
template <class System>
void stabilized_form(int, double t, const double* x, const double* xdot, double* F) {
  sfdae_test::stabilized_residual<System>(t, x, xdot, F);
}
template <class System, sfdae_test::ConstraintLevel level>
void accelerated_form(int, double t, const double* x, const double* xdot, double* F) {
  sfdae_test::accelerated_residual<System, level>(t, x, xdot, F);
}

template <class System>
void add_direct_forms(const sfdae_test::TestProblem& p, std::vector<PeerProblem>& forms) {
  using sfdae_test::ConstraintLevel;
  constexpr int states = 2 * System::positions;
  forms.push_back(peer_problem(p, "idx1", direct_form<System, ConstraintLevel::acceleration>, 2 * System::positions));
  forms.push_back(peer_problem(p, "idx2", direct_form<System, ConstraintLevel::velocity>, states));
  PeerProblem stabilized = peer_problem(p, "ggl2", stabilized_form<System>, states);
  stabilized.x0.resize(p.x0.size() + System::multipliers, 0.0);
  stabilized.xdot0.resize(stabilized.x0.size(), 0.0);
  forms.push_back(std::move(stabilized));
}

template <class System>
void add_accelerated_forms(const sfdae_test::TestProblem& p, std::vector<PeerProblem>& forms) {
  using sfdae_test::ConstraintLevel;
  forms.push_back(
      peer_problem(p, "idx1", accelerated_form<System, ConstraintLevel::acceleration>, 2 * System::positions));
  forms.push_back(
      peer_problem(p, "idx2", accelerated_form<System, ConstraintLevel::velocity>, 2 * System::positions));
}

inline void raw_transistor_amplifier(int, double t, const double* x, const double* xdot, double* F) {
  sfdae_test::transistor_amplifier_residual(t, x, xdot, F);
}
inline void raw_akzo(int, double t, const double* x, const double* xdot, double* F) {
  sfdae_test::akzo_residual(t, x, xdot, F);
}
inline void raw_nand(int segment, double t, const double* x, const double* xdot, double* F) {
  sfdae_test::nand_residual(sfdae_test::nand_inputs(t, segment), x, xdot, F);
}

// All forms of one problem; empty for a name that is not known.
inline std::vector<PeerProblem> peer_forms(const sfdae_test::TestProblem& p) {
  std::vector<PeerProblem> forms;
  if (p.name == "pendulum") add_direct_forms<sfdae_test::Pendulum>(p, forms);
  if (p.name == "car_axis") add_direct_forms<sfdae_test::CarAxis>(p, forms);
  if (p.name == "rigid_slider_crank") add_direct_forms<sfdae_test::RigidSliderCrank>(p, forms);
  if (p.name == "slider_crank") add_accelerated_forms<sfdae_test::SliderCrank>(p, forms);
  if (p.name == "andrews") add_accelerated_forms<sfdae_test::Andrews>(p, forms);
  if (p.name == "fekete_position") add_direct_forms<sfdae_test::Fekete>(p, forms);
  if (p.name == "akzo") forms.push_back(peer_problem(p, "raw", raw_akzo, 5));
  if (p.name == "nand") forms.push_back(peer_problem(p, "raw", raw_nand, p.n));
  if (p.name == "transistor_amplifier") {
    forms.push_back(peer_problem(p, "raw", raw_transistor_amplifier, p.n));
    // IDA stops Newton's iteration too early here, error test failures follow.
    forms.push_back(forms.back());
    forms.back().form = "raw tight";
    forms.back().newton_coefficient = 0.001;
  }
  for (PeerProblem& form : forms)
    if (form.problem == "fekete_position") form.problem = "fekete";
  return forms;
}

}  // namespace sfdae_bench
