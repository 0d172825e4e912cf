// The user's functions of a mechanical system: called and checked.
//
// All members that call them return false if one fails. A function that is not given is zero, a mass that is not given
// the identity.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multibody/multibody_problem.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

MultibodySizes sizes_of(const sfdae_multibody_problem& problem);

// v: null for functions of (t, q) alone.
struct MultibodyArguments {
  double t;
  const double* q;
  const double* v;
};

class MultibodyFunctions {
 public:
  // problem: supplies sizes, stop requests and limits of t; must outlive this object.
  MultibodyFunctions(const sfdae_multibody_problem& given, const MultibodyProblem& problem);

  const sfdae_multibody_problem& given() const { return given_; }
  const MultibodySizes& sizes() const { return problem_.sizes(); }
  bool has_kinematics() const { return given_.kinematics != nullptr; }
  bool may_depend_on_time() const {
    return given_.constraint_rate != nullptr || has_kinematics() || given_.nonholonomic_matrix != nullptr;
  }
  double room(double t, double direction) const { return problem_.room(t, direction); }

  bool mass(const MultibodyArguments& at, Matrix& M, CallbackError& error) const;
  bool forces(const MultibodyArguments& at, double* f, CallbackError& error) const;
  // g
  bool constraints(const MultibodyArguments& at, double* g, CallbackError& error) const;
  // S, which becomes nq x nv if it is not the identity.
  bool kinematics(const MultibodyArguments& at, Matrix& S, CallbackError& error) const;
  // g_q and g_t
  bool constraint_derivatives(const MultibodyArguments& at, Matrix& g_q, double* g_t, CallbackError& error) const;
  // H and h
  bool nonholonomic(const MultibodyArguments& at, Matrix& H, double* h, CallbackError& error) const;
  // S, g_q, C, r.
  bool velocity_constraints(const MultibodyArguments& at, MultibodyTerms& terms, CallbackError& error);
  // The given parts of s.
  bool curvatures(const MultibodyArguments& at, double* s, CallbackError& error) const;
  // S v
  void velocity(const Matrix& S, const double* v, double* result) const;

 private:
  template <class Call>
  bool checked(const char* name, double t, View result, CallbackError& error, Call call) const;
  bool call(const char* name, sfdae_position_function function, const MultibodyArguments& at, View result,
            CallbackError& error) const;
  bool call(const char* name, sfdae_velocity_function function, const MultibodyArguments& at, View result,
            CallbackError& error) const;

  sfdae_multibody_problem given_;
  const MultibodyProblem& problem_;
  Matrix H_;
};

}  // namespace sfdae::core
