// Interface of a problem for integrators: its strangeness-free system.
//
// Folder system: this interface, linear and nonlinear systems behind it, consistent values, and models: problem,
// options and system in one.
//
//     F1(t, x, w') = 0   (d equations),   F2(t, x) = 0   (a equations),   w = W(t) x
//
// consistent at any t. This interface is independent of indices and derivative arrays.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "system/stage_method.h"

namespace sfdae::core {

enum class PointStatus {
  ok,
  callback_error,   // a callback failed: see callback_error()
  changed,          // the characteristic values differ from those known
  leading_changed,  // they hold, but rank E differs: W of the history does not fit this point
  singular,         // the equations to be solved at the point (or at several) have no unique solution
  not_converged     // nonlinear equations, with no solution found near the initial guess
};

// Properties of a system that do not depend on the point.
struct SystemTraits {
  int unknowns = 0;      // n
  int differential = 0;  // d
  int undetermined = 0;  // u, free components that remain
  int leading_size = 0;  // entries of w: n, or m where W = E
  // The same matrices hold at every t, so that factorizations can be reused.
  bool is_constant = false;
  // The equations of a step are linear: they need no initial guess.
  bool is_linear = false;
  // Else the highest order of the Taylor coefficients that an initial guess has to provide; 0: values alone.
  int taylor_order = 0;
  // error_in_x() may write over the errors in w: w has n entries.
  bool maps_errors_in_place = false;
};

// Initial guess and scaling of the iteration for nonlinear equations.
struct Guess {
  // Taylor coefficients of the predicted x, n x (taylor_order + 1): at the point, or a block for each stage.
  const double* taylor = nullptr;
  // Coefficients of the same polynomial at the point accepted last.
  const double* taylor_before = nullptr;
  // Per component of x: an error of one unit is as large as the tolerance.
  const double* inverse_weights = nullptr;
  // For points between the last two accepted ones: coefficients at the first of them.
  const double* taylor_at_start = nullptr;
};

// F1(t, x, c W x + w_rest) = 0, F2(t, x) = 0 and U^T (c x + x_rest) = 0, U an orthonormal basis of the free
// directions.
struct StepEquations {
  double c;
  const double* w_rest;
  const double* x_rest;
  Guess guess;
};

// The stages of one step from (t, x), w = W x, to t_end = t + h.
struct StageEquations {
  const StageMethod& method;
  double t, t_end;
  const double* w;
  const double* x;
  Guess guess;
};

// Approximate operations for s stages that have a reduction each and one system of s q equations for all of them; n
// unknowns.
double cost_of_reduced_stages(int n, int q, int s);

class StrangenessFreeSystem {
 public:
  virtual ~StrangenessFreeSystem() = default;

  int unknowns() const { return traits_.unknowns; }
  int differential() const { return traits_.differential; }
  int undetermined() const { return traits_.undetermined; }
  int leading_size() const { return traits_.leading_size; }
  bool is_constant() const { return traits_.is_constant; }
  bool is_linear() const { return traits_.is_linear; }
  int taylor_order() const { return traits_.taylor_order; }
  bool maps_errors_in_place() const { return traits_.maps_errors_in_place; }
  // Initial guesses are values of x alone, without derivatives.
  bool guesses_values() const { return !traits_.is_linear && traits_.taylor_order == 0; }

  // Makes t the current point, which the functions below refer to, and evaluates the parts that depend on t alone: the
  // whole reduction of a linear problem, inputs of a nonlinear one.
  virtual PointStatus move_to(double t) = 0;
  // The current point is the last accepted one from now on, while move_to tries others.
  virtual void accept() = 0;

  // w := W x.
  virtual void leading(const double* x, double* w) = 0;
  virtual PointStatus solve(const StepEquations& equations, double* x) = 0;
  // Cost of solve_stages for s stages, in units of its own: approximate operations.
  virtual double stage_cost(int s) const {
    return cost_of_reduced_stages(unknowns(), differential() + undetermined(), s);
  }
  // Solves F1(t_i, x_i, D_h w_i) = 0, F2(t_i, x_i) = 0 and U_i^T D_h x_i = 0 for all stages i together; x: n x s,
  // w: leading_size() x s. The system stands at t_end afterwards, or else at t_reached, the stage that fails.
  virtual PointStatus solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) = 0;
  // For the point solved last, with w' and x' of a polynomial that fulfills F1 there: corrects the parts that F2
  // prescribes, where these are known at no cost.
  virtual void correct_slopes(double*, double*) {}
  // The changes of x that correspond to changes of w and satisfy F2; free directions do not change. One column for
  // each: leading_size() x count in dw, n x count in dx.
  virtual void error_in_x(const double* dw, int count, double* dx) = 0;
  void error_in_x(const double* dw, double* dx) { error_in_x(dw, 1, dx); }
  // x with F2(t, x) = 0 and the given w and free part (x_free: a good approximation of x). guess: initial guess of the
  // iteration; may be empty.
  virtual void restore(const double* w, const double* x_free, const Guess& guess, double* x) = 0;
  void restore(const double* w, const double* x_free, double* x) { restore(w, x_free, {}, x); }
  // Corrects xdot within the directions that F2 leaves open toward F1(t, x, .) = 0. In components that are stiff over
  // the time 1 / |c| the residual of F1 is that of the error of x, and they stay; c = infinity: F1 = 0 exactly.
  virtual void correct_derivative(double c, const double* x, double* xdot) = 0;
  // The same with c = infinity, using a linearization from nearby if available, for the components of w'. False: it is
  // not known.
  virtual bool estimate_derivative(const double* x, double* xdot) {
    correct_derivative(std::numeric_limits<double>::infinity(), x, xdot);
    return true;
  }

 protected:
  SystemTraits traits_;
};

}  // namespace sfdae::core
