// Sets of equations that contradict each other.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/contradiction.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Up to this many rows, singular value decompositions for each equation are worth a message.
constexpr int most_decomposed_rows = 300;
// Relative to the largest singular value, rows and columns scaled: smaller ones are zero. Relative to the right-hand
// side: smaller residuals are no contradiction. By judgment; consistency_tol is 1e-8 as well.
constexpr double rank_tol = 1e-10, least_contradiction = 1e-8;

// B z = g, rows and columns of size 1, and the size of the terms of g.
struct Equations {
  Matrix B;
  Vector g;
  double size = 0.0;
};

void scale_columns(Matrix& B) {
  for (int j = 0; j < B.cols(); ++j) {
    const double size = max_abs(B.view().columns(j, 1));
    for (int i = 0; i < B.rows() && size > 0.0; ++i) B(i, j) /= size;
  }
}

// Columns and rows are divided by their largest entries, so that no units matter; those of rows with their right-hand
// sides.
Equations equations_of(const DerivativeArray& array, const std::vector<char>& fixed, const double* x) {
  const int rows = array.M.rows(), derivatives = array.M.cols(), n = array.N.cols();
  const bool has_fixed = !fixed.empty();
  Equations result{Matrix(rows, derivatives + n), array.g};
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < derivatives; ++j) result.B(i, j) = array.M(i, j);
    for (int j = 0; j < n; ++j) {
      if (has_fixed && fixed[index(j)] != 0) result.g[index(i)] += array.N(i, j) * x[j];
      else result.B(i, derivatives + j) = -array.N(i, j);
    }
  }
  scale_columns(result.B);
  for (int i = 0; i < rows; ++i) {
    double largest = std::fabs(result.g[index(i)]);
    for (int j = 0; j < result.B.cols(); ++j) largest = std::max(largest, std::fabs(result.B(i, j)));
    if (largest == 0.0) continue;
    for (int j = 0; j < result.B.cols(); ++j) result.B(i, j) /= largest;
    result.g[index(i)] /= largest;
    result.size = std::max(result.size, std::fabs(result.g[index(i)]));
  }
  scale_columns(result.B);
  return result;
}

// The part of g outside the range of B, in the rows given: they cannot hold together.
Vector residual(const Equations& equations, const std::vector<int>& rows) {
  const int count = static_cast<int>(rows.size());
  Matrix B(count, equations.B.cols());
  Vector g(rows.size());
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < B.cols(); ++j) B(i, j) = equations.B(rows[index(i)], j);
    g[index(i)] = equations.g[index(rows[index(i)])];
  }
  const Svd parts = svd(B);
  Vector rest(g);
  for (int k = 0; k < static_cast<int>(parts.s.size()) && parts.s[index(k)] > rank_tol * parts.s.front(); ++k) {
    double along = 0.0;
    for (int i = 0; i < count; ++i) along += parts.U(i, k) * g[index(i)];
    for (int i = 0; i < count; ++i) rest[index(i)] -= along * parts.U(i, k);
  }
  return rest;
}

bool contradict(const Equations& equations, const std::vector<int>& rows) {
  if (rows.empty()) return false;
  const Vector rest = residual(equations, rows);
  return max_abs(rest.data(), static_cast<int>(rest.size())) > least_contradiction * equations.size;
}

}  // namespace

std::vector<ContradictingEquation> contradicting_equations(const DerivativeArray& array, int m,
                                                           const std::vector<char>& fixed, const double* x) {
  const int rows = array.M.rows();
  if (rows > most_decomposed_rows) return {};
  const Equations equations = equations_of(array, fixed, x);
  std::vector<int> left(index(rows));
  for (int i = 0; i < rows; ++i) left[index(i)] = i;
  if (!contradict(equations, left)) return {};
  // Rows of the highest orders first, then later equations: in the end none can be left out.
  for (int row = rows - 1; row >= 0; --row) {
    std::vector<int> fewer;
    for (const int i : left)
      if (i != row) fewer.push_back(i);
    if (contradict(equations, fewer)) left = std::move(fewer);
  }
  std::vector<ContradictingEquation> result;
  for (const int row : left) {
    const auto known = std::find_if(result.begin(), result.end(),
                                    [&](const ContradictingEquation& e) { return e.equation == row % m; });
    if (known == result.end()) result.push_back({row % m, row / m});
    else known->derivatives = std::max(known->derivatives, row / m);
  }
  std::sort(result.begin(), result.end(),
            [](const ContradictingEquation& a, const ContradictingEquation& b) { return a.equation < b.equation; });
  return result;
}

std::string in_words(const std::vector<ContradictingEquation>& equations, const EquationNames& names) {
  constexpr std::size_t most_named = 8;
  std::string text = equations.size() == 1 ? "equation" : equations.empty() ? "" : "equations";
  const std::size_t count = std::min(equations.size(), most_named);
  for (std::size_t i = 0; i < count; ++i) {
    const ContradictingEquation& e = equations[i];
    text += (i == 0 ? " " : i + 1 == equations.size() ? " and " : ", ") + std::to_string(e.equation);
    std::string more = names[e.equation];
    if (e.derivatives > 0) {
      if (!more.empty()) more += ", ";
      more += e.derivatives == 1 ? "differentiated once" : format("differentiated %d times", e.derivatives);
    }
    if (!more.empty()) text += " (" + more + ")";
  }
  if (count < equations.size()) text += format(" and %d others", static_cast<int>(equations.size() - count));
  return text;
}

}  // namespace sfdae::core
