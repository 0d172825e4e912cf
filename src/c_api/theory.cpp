// Objects of the theory: the C API of jets, derivative arrays, projectors, strangeness-free and extended systems.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>

#include "c_api/solver.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "reduction/derivative_array.h"

namespace sfdae::core {

namespace {

void copy_out(ConstView from, double* to) {
  if (to == nullptr || from.rows == 0 || from.cols == 0) return;
  copy(from, {to, from.rows, from.cols, from.rows});
}

void copy_out(const std::vector<double>& from, double* to) {
  if (to != nullptr) std::copy(from.begin(), from.end(), to);
}

[[noreturn]] void raise(int status, const std::string& message) { throw Failure(status, message); }

void demand_time(double t) {
  if (!std::isfinite(t)) raise(SFDAE_ILLEGAL_ARGUMENT, format("t is %g.", t));
}

void demand_level(double t, int level) {
  if (!std::isfinite(t) || level < 0 || level > max_strangeness_index)
    raise(SFDAE_ILLEGAL_ARGUMENT,
          format("t = %g, level = %d: level must be 0 ... %d.", t, level, max_strangeness_index));
}

void demand_analysis(const sfdae_solver& solver) {
  if (!solver.system()) raise(SFDAE_NOT_STARTED, "call sfdae_analyze, sfdae_analyze_at or sfdae_start first.");
}

void demand_numbers(const char* name, const double* values, std::size_t count) {
  if (values == nullptr) raise(SFDAE_ILLEGAL_ARGUMENT, format("%s is NULL.", name));
  if (!all_finite(values, count)) raise(SFDAE_ILLEGAL_ARGUMENT, format("%s contains NaN or Inf.", name));
}

// Argument of objects: t alone for linear problems, a jet of the solution for others.
Jet point_at(sfdae_solver& solver, double t, int level) {
  if (solver.model.linear() != nullptr) {
    Jet point;
    point.t = t;
    return point;
  }
  const std::vector<double> x = solver.solution_at(t);
  return solver.model.whole().jet_through(t, x.data(), level);
}

Jet given_jet(const sfdae_solver& solver, double t, const double* derivatives, int level) {
  const std::size_t n = index(solver.model.n());
  demand_numbers("jet", derivatives, n * index(level + 2));
  Jet jet;
  jet.t = t;
  jet.n = solver.model.n();
  jet.order = level + 1;
  double factorial = 1.0;
  for (int k = 0; k <= jet.order; ++k) {
    factorial *= std::max(k, 1);
    for (std::size_t j = 0; j < n; ++j) jet.x.push_back(derivatives[index(k) * n + j] / factorial);
  }
  return jet;
}

struct ArrayPlaces {
  double *M, *N, *g;
};

void write(const DerivativeArray& array, const ArrayPlaces& to) {
  copy_out(array.M, to.M);
  copy_out(array.N, to.N);
  copy_out(array.g, to.g);
}

struct ProjectorPlaces {
  double *Z1, *Z2, *Z3, *T2;
  int* vhat;
  bool of_array() const { return Z2 != nullptr || Z3 != nullptr || vhat != nullptr; }
};

void write(const Projectors& found, const ProjectorPlaces& to) {
  copy_out(found.Z1, to.Z1);
  copy_out(found.Z2, to.Z2);
  copy_out(found.Z3, to.Z3);
  copy_out(found.T2, to.T2);
  if (to.vhat != nullptr) *to.vhat = found.Z3.cols();
}

struct SystemPlaces {
  double *E1, *A1, *f1, *A2, *f2, *residual;
};

void write(const StrangenessFreeEquations& found, const SystemPlaces& to) {
  copy_out(found.E1, to.E1);
  copy_out(found.A1, to.A1);
  copy_out(found.f1, to.f1);
  copy_out(found.A2, to.A2);
  copy_out(found.f2, to.f2);
  if (to.residual != nullptr) *to.residual = found.residual;
}

}  // namespace

}  // namespace sfdae::core

using namespace sfdae::core;

extern "C" {

int sfdae_get_jet(sfdae_solver* solver, double t, const double* x, int level, double* jet) {
  return guarded<Text::of_failure>(solver, [&] {
    demand_level(t, level);
    if (jet == nullptr) refuse_argument("jet is NULL.");
    demand_analysis(*solver);
    std::vector<double> given;
    if (x == nullptr) given = solver->solution_at(t);
    else demand_numbers("x", x, index(solver->model.n()));
    const Jet found = solver->model.whole().jet_through(t, x == nullptr ? given.data() : x, level);
    double factorial = 1.0;
    for (int k = 0; k <= level + 1; ++k) {
      factorial *= std::max(k, 1);
      for (int j = 0; j < found.n; ++j) *jet++ = factorial * found.column(k)[j];
    }
  });
}

int sfdae_get_derivative_array(sfdae_solver* solver, double t, int level, double* M, double* N, double* g) {
  return guarded<Text::of_failure>(solver, [&] {
    demand_level(t, level);
    if (solver->model.linear() == nullptr) demand_analysis(*solver);
    const Jet jet = point_at(*solver, t, level);
    return write(solver->model.whole().derivative_array(jet, level), {M, N, g});
  });
}

int sfdae_get_derivative_array_at(sfdae_solver* solver, double t, const double* jet, int level, double* M, double* N,
                                  double* g) {
  return guarded<Text::of_failure>(solver, [&] {
    demand_level(t, level);
    const Jet given = given_jet(*solver, t, jet, level);
    return write(solver->model.whole().derivative_array(given, level), {M, N, g});
  });
}

int sfdae_get_projectors(sfdae_solver* solver, double t, double* Z1, double* Z2, double* Z3, double* T2, int* vhat) {
  return guarded<Text::of_failure>(solver, [&] {
    demand_time(t);
    demand_analysis(*solver);
    const ProjectorPlaces to{Z1, Z2, Z3, T2, vhat};
    const Jet jet = point_at(*solver, t, solver->model.same_whole().level_of_jets(to.of_array()));
    return write(solver->model.same_whole().projectors(jet, to.of_array()), to);
  });
}

int sfdae_get_projectors_at(sfdae_solver* solver, double t, const double* jet, double* Z1, double* Z2, double* Z3,
                            double* T2, int* vhat) {
  return guarded<Text::of_failure>(solver, [&] {
    demand_time(t);
    demand_analysis(*solver);
    const ProjectorPlaces to{Z1, Z2, Z3, T2, vhat};
    const Jet given = given_jet(*solver, t, jet, solver->model.same_whole().level_of_jets(to.of_array()));
    return write(solver->model.same_whole().projectors(given, to.of_array()), to);
  });
}

int sfdae_get_strangeness_free(sfdae_solver* solver, double t, double* E1, double* A1, double* f1, double* A2,
                               double* f2, double* residual) {
  return guarded<Text::of_failure>(solver, [&] {
    demand_time(t);
    demand_analysis(*solver);
    const Jet jet = point_at(*solver, t, solver->model.same_whole().level_of_jets(false));
    return write(solver->model.same_whole().strangeness_free(jet), {E1, A1, f1, A2, f2, residual});
  });
}

int sfdae_get_strangeness_free_at(sfdae_solver* solver, double t, const double* jet, double* E1, double* A1,
                                  double* f1, double* A2, double* f2, double* residual) {
  return guarded<Text::of_failure>(solver, [&] {
    demand_time(t);
    demand_analysis(*solver);
    const Jet given = given_jet(*solver, t, jet, solver->model.same_whole().level_of_jets(false));
    return write(solver->model.same_whole().strangeness_free(given), {E1, A1, f1, A2, f2, residual});
  });
}

int sfdae_get_extended_system(sfdae_solver* solver, double t, const double* x, double* Qq, double* Qv, double* E,
                              double* A, double* f, double* w) {
  return guarded<Text::of_failure>(solver, [&] {
    demand_time(t);
    if (solver->model.multibody() == nullptr) refuse_argument("the problem is not a multibody system.");
    demand_analysis(*solver);
    std::vector<double> given;
    if (x == nullptr) given = solver->solution_at(t);
    else demand_numbers("x", x, index(solver->model.n()));
    const ExtendedSystem found =
        solver->model.local_coordinates().extended_system(t, x == nullptr ? given.data() : x);
    copy_out(found.Qq, Qq);
    copy_out(found.Qv, Qv);
    copy_out(found.E, E);
    copy_out(found.A, A);
    copy_out(found.f, f);
    copy_out(found.w, w);
  });
}

}  // extern "C"
