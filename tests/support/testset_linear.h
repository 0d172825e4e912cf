// SPDX-License-Identifier: BSD-3-Clause
// Linear problems of the literature and small ones made to be difficult, with everything known about them.
//
// [AP98]  U. Ascher, L. Petzold: Computer Methods for ODEs and DAEs. SIAM, 1998.
// [BCP96] K. Brenan, S. Campbell, L. Petzold: Numerical Solution of IVPs in DAEs. SIAM, 1996.
// [GP84]  C. W. Gear, L. Petzold: ODE methods for the solution of DAE systems. SIAM J. Numer. Anal. 21, 1984.
// [KM06]  P. Kunkel, V. Mehrmann: Differential-Algebraic Equations. EMS, 2006.
#ifndef SFDAE_TESTS_TESTSET_LINEAR_H
#define SFDAE_TESTS_TESTSET_LINEAR_H

#include <memory>
#include <vector>

#include "linear_family.h"

namespace sfdae_test {

struct LinearTestProblem {
  std::unique_ptr<LinearFamily> family;
  double t0, tf;
  std::vector<double> x0;  // consistent at t0; where nothing else is said, the exact solution there
};

// Characteristic values are written (mu; d, a, u, v).

// ---- Literature ----
LinearTestProblem km_ex31_underdet();        // (1; 0, 1, 1, 1) [KM06, Ex. 3.1]: c(t) (t, 1) solves for every c
LinearTestProblem km_ex32_gelda_demo();      // (1; 0, 2, 0, 0) [KM06, Ex. 3.2]: singular pencils, unique solution
LinearTestProblem gear_petzold(double eta);  // (1; 0, 2, 0, 0) [GP84]; the pencil is singular for eta = -1
LinearTestProblem rankdrop_t();              // (1; 0, 2, 0, 0), E = [0 t; 0 0], A = I; t = 0 alone says mu = 0
LinearTestProblem nilpotent(int n);          // (n-1; 0, n, 0, 0), one Jordan block, f_i = sin t
LinearTestProblem index4_indigo();           // (3; 2, 4, 0, 0)
LinearTestProblem brenan_index1();           // (0; 1, 1, 0, 0) [BCP96, ch. 4]
LinearTestProblem ascher_petzold_ind2(double stiffness = 50.0);  // (1; 1, 2, 0, 0) [AP98]
LinearTestProblem lin_overdet_consistent();                      // (1; 1, 1, 0, 1), 3 equations, 2 unknowns
LinearTestProblem lin_underdet();                                // (1; 0, 2, 1, 0), 2 equations, 3 unknowns
LinearTestProblem crane_mass_spring();  // (4; 0, 5, 0, 0), the force that moves a mass along a given path

// ---- Rows and columns that hide something ----
LinearTestProblem dense_rows(double w);  // (0; 1, 1, 0, 0), rows mixed by a rotation of speed w; constant if w = 0
LinearTestProblem free_component();      // (0; 1, 0, 1, 1), E = [0 0; 0 1], A = [0 0; 0 -1]
LinearTestProblem singular_pencil_5();   // (1; 0, 3, 2, 2), E = diag(1,0,0,0,0), A with a22 = a33 = a41 = 1
LinearTestProblem purely_algebraic();    // (0; 0, 1, 1, 1), E = 0, A = diag(1, 0)
LinearTestProblem no_equations();        // (0; 0, 0, 2, 2), E = 0, A = 0
LinearTestProblem scaled_row(double factor = 1e-12);  // (0; 2, 1, 0, 0), a differential row of E, A, f times factor
// (0; 1, 1, 0, 1), x1' = -x1, 0 = x2 - sin t, 0 = x2 - sin t + rho sin t: no solution for rho != 0, then x0 fits
// at t0 = 0, where the contradiction vanishes.
LinearTestProblem redundant_row(double rho);

// ---- Small numbers ----
LinearTestProblem singular_perturbation(double eps);     // (0; 2, 0, 0, 0), E = diag(1, eps), A = -I, eps > 0
LinearTestProblem badly_scaled_ode(double eps = 1e-14);  // (0; 2, 0, 0, 0), E = diag(1, eps), A = diag(-1, -eps)

// ---- Characteristic values that change ----
// E = diag(1, t - 1/2), A = diag(-1, a22): (0; 2, 0, 0, 0), at t = 1/2 (0; 1, 1, 0, 0). Errors of x2 behave like
// |t - 1/2|^a22.
LinearTestProblem vanishing_E(double a22 = -1.0);
// E = diag(1, 0), A = diag(-1, t - 1/2): (0; 1, 1, 0, 0), at t = 1/2 (0; 1, 0, 1, 1), where
// the hypothesis also holds with (1; 1, 1, 0, 0).
LinearTestProblem vanishing_A();
// x2' = -x2 + f2 before t_change, 0 = -x2 + f2 from then on: (0; 2, 0, 0, 0), then (0; 1, 1, 0, 0). x is smooth.
LinearTestProblem changing_structure(double t_change = 0.4);

// ---- Circuits, x = (node potentials, currents) ----
LinearTestProblem rlc_circuit();     // (0; 2, 3, 0, 0), source sin t, resistor, inductor, capacitor in series
LinearTestProblem capacitor_loop();  // (1; 0, 2, 0, 0), capacitor parallel to a source

// All of them, gear_petzold for eta = -2, -1, 0.5, nilpotent for n = 2..6, the others with parameters in the range
// where the values above are numerically clear. No contradictions.
std::vector<LinearTestProblem> linear_testset();

}  // namespace sfdae_test

#endif
