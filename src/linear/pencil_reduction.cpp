// SPDX-License-Identifier: BSD-3-Clause
#include "linear/pencil_reduction.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "linalg/index.h"
#include "linear/linear_model.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

struct Pencil {
  Matrix E, A;
};

// lambda G - B, lambda in 1 / time_scale, G of full row rank.
struct ReducedPencil {
  CharacteristicValues values;
  double time_scale = 1.0;
  // Approximate bound for the growth of rounding errors of the pencil in G and B: see reduction/judge.h.
  double amplification = 1.0;
  Matrix G, B;
};

int write(const Matrix& from, int order, double* to) {
  if (order == 0) std::copy_n(from.data(), index(from.rows()) * index(from.cols()), to);
  return 0;
}

LinearFunctions functions_of(Pencil& pencil) {
  LinearFunctions functions;
  functions.m = pencil.E.rows();
  functions.n = pencil.E.cols();
  functions.E = [](double, int order, double* E, void* user) {
    return write(static_cast<Pencil*>(user)->E, order, E);
  };
  functions.A = [](double, int order, double* A, void* user) {
    return write(static_cast<Pencil*>(user)->A, order, A);
  };
  functions.user = &pencil;
  functions.constant_E = functions.constant_A = true;
  return functions;
}

ReducedPencil reduce(Pencil pencil, double rank_tol) {
  ReducedPencil result;
  const int m = pencil.E.rows(), n = pencil.E.cols();
  if (m == 0 || n == 0) {
    result.values = {0, 0, 0, n, m};
    return result;
  }
  LinearModel model(functions_of(pencil));
  ModelOptions options;
  options.analysis.max_index = max_strangeness_index;
  options.analysis.rank_tol = rank_tol;
  options.leading = LeadingTerm::identity;
  std::vector<RankDecision> decisions;
  model.analyze({.t = 0.0, .toward = 1.0, .x = nullptr}, options, decisions);
  model.set_point(0.0, options);
  const LinearPoint& point = model.system()->point();
  result.values = model.system()->analysis().values;
  result.time_scale = point.data.time_scale;
  result.amplification = 1.0 / (point.pivot * point.kept_constraints * point.kept_differential);
  result.G = to_matrix(point.form.G());
  result.B = to_matrix(point.form.B());
  return result;
}

ReducedPencil reduce_named(Pencil pencil, double rank_tol, const std::string& name) {
  try {
    return reduce(std::move(pencil), rank_tol);
  } catch (const Failure& failure) {
    throw Failure(failure.status(), name + ": " + failure.what());
  }
}

}  // namespace

PencilSpectrum spectrum_of_pencil(ConstView E, ConstView A, double rank_tol, const std::string& name) {
  // Up to this size every eigenvalue is refined: n^3 operations each. Larger ones only if QZ leaves fewer digits than
  // this. By judgment: 200 eigenvalues of 200 unknowns are a few seconds.
  constexpr int always_refined = 150;
  constexpr double few_digits = 1e-10;
  ReducedPencil reduced = reduce_named({to_matrix(E), to_matrix(A)}, rank_tol, name);
  PencilSpectrum result;
  result.values = reduced.values;
  double time_scale = reduced.time_scale, amplification = reduced.amplification;
  if (reduced.values.u > 0 && reduced.values.d > 0) {
    reduced = reduce_named({transpose(reduced.G), transpose(reduced.B)}, rank_tol, name + ", transposed");
    time_scale *= reduced.time_scale;
    amplification *= reduced.amplification;
  }
  if (reduced.values.d == 0) return result;
  if (reduced.G.rows() != reduced.G.cols())
    throw Failure(SFDAE_RANK_UNCLEAR,
                  format("%s: its regular part has not been found, as %d equations with %d unknowns were left.",
                         name.c_str(), reduced.G.rows(), reduced.G.cols()));
  result.finite = generalized_eigenvalues(reduced.G, reduced.B);
  for (Eigenvalue& eigenvalue : result.finite) {
    if (!std::isfinite(std::abs(eigenvalue.value)))
      throw Failure(SFDAE_RANK_UNCLEAR, name + ": an eigenvalue that counts as finite is infinite by QZ.");
    eigenvalue.value /= time_scale;
    eigenvalue.error *= amplification / time_scale;
  }
  if (result.is_regular())
    result.finite = refined(E, A, std::move(result.finite), E.cols <= always_refined ? 0.0 : few_digits);
  sort_by_size(result.finite);
  return result;
}

}  // namespace sfdae::core
