// Sparse factorizations: a band and KLU, on matrices of a reaction-diffusion equation on a line, of the Laplacian on
// a square, and of a flow (a saddle point). Milliseconds: analysis, first factorization, one with other values,
// solution.
//
//   OPENBLAS_NUM_THREADS=1 sparse_factors [csv]
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "linalg/sparse_lu.h"
#include "sparse_matrices.h"
#include "text_table.h"

namespace {

using namespace sfdae::core;
using sfdae_bench::text;
using Clock = std::chrono::steady_clock;

// The least of as many runs as take a fifth of a second, three at least.
double milliseconds(auto&& run) {
  double least = 1e300, sum = 0.0;
  for (int count = 0; count < 3 || sum < 200.0; ++count) {
    const Clock::time_point start = Clock::now();
    run();
    const double time = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    least = std::min(least, time);
    sum += time;
  }
  return least;
}

const char* name_of(SparseMethod method) {
  return method == SparseMethod::dense ? "dense" : method == SparseMethod::band ? "band" : "klu";
}

void measure(const sfdae_bench::TextTable& table, const std::string& name, const sfdae_test::SparseMatrix& matrix,
             SparseMethod method) {
  if (method == SparseMethod::klu && !klu_is_available()) return;
  SparseLu<double> chosen, lu;
  chosen.analyze(matrix.pattern);
  const double analysis = milliseconds([&] { lu.analyze(matrix.pattern, method); });
  std::vector<double> b(static_cast<std::size_t>(matrix.pattern.size), 1.0), other = matrix.values;
  const double first = milliseconds([&] {
    SparseLu<double> fresh = lu;
    if (!fresh.factor(matrix.values.data())) std::abort();
  });
  for (double& value : other) value *= 1.01;
  const double factor = milliseconds([&] {
    if (!lu.factor(other.data())) std::abort();
  });
  const double solve = milliseconds([&] { lu.solve(b.data()); });
  table.row({name, text(matrix.pattern.size), text(static_cast<int>(matrix.values.size())),
             name_of(method) + std::string(chosen.method() == method ? " *" : ""),
             text(1e-3 * static_cast<double>(lu.fill())), text(analysis), text(first), text(factor), text(solve)});
}

}  // namespace

int main(int argc, char** argv) {
  const bool csv = argc > 1 && std::strcmp(argv[1], "csv") == 0;
  const sfdae_bench::TextTable table({{"matrix", -10},
                                      {"n", 6},
                                      {"entries", 8},
                                      {"method", -7},
                                      {"fill/1e3", 9},
                                      {"analyze", 8},
                                      {"first", 8},
                                      {"factor", 8},
                                      {"solve", 8}},
                                     csv);
  const auto both = [&](const std::string& name, const sfdae_test::SparseMatrix& matrix) {
    if (matrix.pattern.size <= 1000) measure(table, name, matrix, SparseMethod::dense);
    for (const SparseMethod method : {SparseMethod::band, SparseMethod::klu}) measure(table, name, matrix, method);
  };
  for (int n : {40, 100, 400, 2000, 20000}) both("line", sfdae_test::reaction_diffusion(n / 2));
  for (int cells : {10, 20, 40, 80, 120}) both("square", sfdae_test::laplacian(cells, cells));
  for (int cells : {5, 10, 20, 40, 60}) both("flow", sfdae_test::flow(cells));
  for (int n : {100, 1000}) both("full block", sfdae_test::arrow(n, n / 2));
  for (int n : {1000, 4000}) both("arrow", sfdae_test::arrow(n, 3));
}
