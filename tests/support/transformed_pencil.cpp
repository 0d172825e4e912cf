// SPDX-License-Identifier: BSD-3-Clause
#include "transformed_pencil.h"

#include <algorithm>
#include <utility>

namespace sfdae_test {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

// (a, b) <- (c a + s b, c b - s a) for two columns of W. Coefficient k needs the old ones up to k: downwards.
void rotate_columns(JetColumns& W, int column_a, int column_b, const Jet& c, const Jet& s) {
  const int rows = W.rows();
  for (int k = W.order(); k >= 0; --k) {
    double* __restrict a = W.at(column_a, k);
    double* __restrict b = W.at(column_b, k);
    const double c0 = c[0], s0 = s[0];
    for (int i = 0; i < rows; ++i) {
      const double old = a[i];
      a[i] = c0 * old + s0 * b[i];
      b[i] = c0 * b[i] - s0 * old;
    }
    for (int l = 0; l < k; ++l) {
      const double* __restrict a_l = W.at(column_a, l);
      const double* __restrict b_l = W.at(column_b, l);
      const double cl = c[k - l], sl = s[k - l];
      for (int i = 0; i < rows; ++i) {
        a[i] += cl * a_l[i] + sl * b_l[i];
        b[i] += cl * b_l[i] - sl * a_l[i];
      }
    }
  }
}

void scale_column(JetColumns& W, int column, const Jet& factor) {
  const int rows = W.rows();
  for (int k = W.order(); k >= 0; --k) {
    double* __restrict a = W.at(column, k);
    for (int i = 0; i < rows; ++i) a[i] *= factor[0];
    for (int l = 0; l < k; ++l) {
      const double* __restrict a_l = W.at(column, l);
      for (int i = 0; i < rows; ++i) a[i] += factor[k - l] * a_l[i];
    }
  }
}

void rotate(JetColumns& W, const Rotation& G, double t, bool transposed) {
  SineCosine angle = sine_cosine(G.phase, G.speed, t, W.order());
  if (transposed) angle.sine = -angle.sine;
  rotate_columns(W, G.i, G.j, angle.cosine, angle.sine);
}

void scale(JetColumns& W, const std::vector<Scaling>& scalings, double t, bool inverse) {
  for (std::size_t j = 0; j < scalings.size(); ++j) {
    const Scaling& D = scalings[j];
    const Jet factor = 1.0 + D.amplitude * sine_cosine(D.phase, D.speed, t, W.order()).sine;
    scale_column(W, static_cast<int>(j), inverse ? 1.0 / factor : factor);
  }
}

// f^ = E^ y' - A^ y as a row of jets.
JetColumns canonical_inhomogeneity(const CanonicalPencil& pencil, double t, int order) {
  const int m = pencil.m(), n = pencil.n();
  JetColumns f(1, m, order);
  for (int j = 0; j < n; ++j) {
    const Jet y = smooth_component(j + 1, t, order + 1);
    for (int i = 0; i < m; ++i) {
      const double E_ij = pencil.E[index(i + j * m)], A_ij = pencil.A[index(i + j * m)];
      if (E_ij == 0.0 && A_ij == 0.0) continue;
      for (int k = 0; k <= order; ++k) *f.at(i, k) += E_ij * (k + 1) * y[k + 1] - A_ij * y[k];
    }
  }
  return f;
}

}  // namespace

JetColumns::JetColumns(int rows, int columns, int order)
    : rows_(rows), columns_(columns), order_(order), data_(index(rows) * index(columns) * index(order + 1)) {}

bool SmoothTransformation::constant() const {
  return std::all_of(rotations.begin(), rotations.end(), [](const Rotation& G) { return G.speed == 0.0; }) &&
         std::all_of(scalings.begin(), scalings.end(), [](const Scaling& D) { return D.speed == 0.0; });
}

void multiply(JetColumns& W, const SmoothTransformation& T, Factor factor, double t) {
  if (factor == Factor::transposed) {  // T^T = D G_M^T ... G_1^T
    scale(W, T.scalings, t, false);
    for (auto G = T.rotations.rbegin(); G != T.rotations.rend(); ++G) rotate(W, *G, t, true);
  } else {  // T = G_1 ... G_M D and T^-T = G_1 ... G_M D^-1
    for (const Rotation& G : T.rotations) rotate(W, G, t, false);
    scale(W, T.scalings, t, factor == Factor::inverse_transposed);
  }
}

Jet smooth_component(int i, double t, int order) {
  return sine_cosine(0.7 * i, 1.0 + 0.5 * std::sin(static_cast<double>(i)), t, order).sine;
}

TransformedPencil::TransformedPencil(std::string name, CanonicalPencil pencil, SmoothTransformation P,
                                     SmoothTransformation Q, std::vector<double> row_scale,
                                     std::vector<double> contradiction)
    : LinearFamily(std::move(name), pencil.values),
      pencil_(std::move(pencil)),
      P_(std::move(P)),
      Q_(std::move(Q)),
      row_scale_(std::move(row_scale)),
      contradiction_(std::move(contradiction)) {}

void TransformedPencil::matrix_coefficients(double t, int order, double* E, double* A) const {
  // W = [E^; A^] Q, one order more than asked for: Q' takes it.
  JetColumns W(2 * m(), n(), order + 1);
  for (int j = 0; j < n(); ++j) {
    std::copy_n(&pencil_.E[index(j * m())], m(), W.at(j, 0));
    std::copy_n(&pencil_.A[index(j * m())], m(), W.at(j, 0) + m());
  }
  multiply(W, Q_, Factor::direct, t);

  // V = [E^ Q, A^ Q - E^ Q']^T P^T; coefficient k of E^ Q' is (k+1) times coefficient k+1 of E^ Q.
  JetColumns V(2 * n(), m(), order);
  for (int j = 0; j < n(); ++j)
    for (int k = 0; k <= order; ++k)
      for (int i = 0; i < m(); ++i) {
        V.at(i, k)[j] = W.at(j, k)[i];
        V.at(i, k)[n() + j] = W.at(j, k)[m() + i] - (k + 1) * W.at(j, k + 1)[i];
      }
  multiply(V, P_, Factor::transposed, t);

  for (int k = 0; k <= order; ++k)
    for (int j = 0; j < n(); ++j)
      for (int i = 0; i < m(); ++i) {
        *E++ = row_scale_[index(i)] * V.at(i, k)[j];
        *A++ = row_scale_[index(i)] * V.at(i, k)[n() + j];
      }
}

void TransformedPencil::vector_coefficients(double t, int order, double* f) const {
  JetColumns V = canonical_inhomogeneity(pencil_, t, order);
  for (int i = 0; i < m(); ++i) {
    if (contradiction_[index(i)] == 0.0) continue;
    const Jet cosine = sine_cosine(i + 1.0, 1.0, t, order).cosine;
    for (int k = 0; k <= order; ++k) *V.at(i, k) += contradiction_[index(i)] * cosine[k];
  }
  multiply(V, P_, Factor::transposed, t);
  for (int k = 0; k <= order; ++k)
    for (int i = 0; i < m(); ++i) *f++ = row_scale_[index(i)] * *V.at(i, k);
}

bool TransformedPencil::has_exact() const {
  return std::all_of(contradiction_.begin(), contradiction_.end(), [](double c) { return c == 0.0; });
}

void TransformedPencil::exact(double t, double* x, double* xdot) const {
  if (!has_exact()) LinearFamily::exact(t, x, xdot);
  JetColumns V(1, n(), 1);
  for (int j = 0; j < n(); ++j) {
    const Jet y = smooth_component(j + 1, t, 1);
    for (int k = 0; k <= 1; ++k) *V.at(j, k) = y[k];
  }
  multiply(V, Q_, Factor::inverse_transposed, t);
  for (int j = 0; j < n(); ++j) {
    x[j] = *V.at(j, 0);
    if (xdot) xdot[j] = *V.at(j, 1);
  }
}

}  // namespace sfdae_test
