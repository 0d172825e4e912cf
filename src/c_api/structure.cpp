// The structure of recorded equations: C API.
// SPDX-License-Identifier: BSD-3-Clause
#include "structure/structure.h"

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "c_api/checks.h"
#include "c_api/solver.h"
#include "c_api/structs.h"
#include "linalg/format.h"

namespace sfdae::core {

namespace {

struct PublicArrays {
  int *differentiations, *orders, *assigned, *block;
};

void fill(int* to, int n, int value) {
  if (to != nullptr) std::fill_n(to, n, value);
}

void write(const std::vector<int>& values, int* to) {
  if (to != nullptr) std::copy(values.begin(), values.end(), to);
}

// As many names as a message has room for.
template <class Name>
std::string listed(std::span<const int> items, Name name) {
  constexpr std::size_t most = 8;
  std::string text;
  for (std::size_t k = 0; k < std::min(most, items.size()); ++k) text += (k > 0 ? ", " : "") + name(items[k]);
  return items.size() > most ? text + format(" and %zu more", items.size() - most) : text;
}

std::string names_of(const Record& record, std::span<const int> equations) {
  return listed(equations, [&record](int i) { return record.name(i); });
}

std::string unknowns_in_words(const std::vector<int>& unknowns) {
  if (unknowns.empty()) return "no unknown";
  return listed(unknowns, [](int j) { return format("x[%d]", j); }) + " only";
}

CallResult describe_overdetermined(const Record& record, const Overdetermined& part, const PublicArrays& arrays) {
  const int n = record.n();
  fill(arrays.differentiations, n, 0);
  fill(arrays.assigned, n, -1);
  fill(arrays.block, n, -1);
  fill(arrays.orders, n, -1);
  for (int i : part.equations)
    if (arrays.block != nullptr) arrays.block[i] = 0;
  for (int j : part.unknowns)
    if (arrays.orders != nullptr) arrays.orders[j] = 0;
  CallResult words;
  const std::string unknowns = unknowns_in_words(part.unknowns), names = names_of(record, part.equations);
  words.message = part.equations.size() == 1
                      ? names + " contains " + unknowns + ". It is contradictory or redundant"
                      : format("%zu equations contain %s: %s. They contradict each other or are redundant",
                               part.equations.size(), unknowns.c_str(), names.c_str());
  words.message += ", and other unknowns are not determined.";
  return words;
}

void write_arrays(const Structure& structure, const PublicArrays& arrays) {
  write(structure.offsets.c, arrays.differentiations);
  write(structure.offsets.d, arrays.orders);
  write(structure.transversal.unknown_of, arrays.assigned);
  if (arrays.block == nullptr) return;
  for (int block = 0; block < structure.blocks.count(); ++block)
    for (int i : structure.blocks.equations(block)) arrays.block[i] = block;
}

// Point at which equations are evaluated: x, x', known higher derivatives, and t. Linear equations have the same
// derivatives everywhere.
struct Point {
  double t;
  std::vector<double> jet;
};

std::optional<Point> known_point(const sfdae_solver& solver) {
  if (solver.system() == nullptr) return std::nullopt;
  Point point{solver.system()->t(), std::vector<double>(2 * index(solver.model.n()))};
  if (const Jet* const jet = solver.system()->point_of_equations(); jet != nullptr) {
    point.t = jet->t;
    point.jet = jet->x;
    point.jet.resize(std::max(point.jet.size(), 2 * index(solver.model.n())));
  }
  return point;
}

// Verdict of the blocks; returns a message unless they confirm the structure.
std::string judge_blocks(const Structure& structure, const Record& record, const Certificate& certificate,
                         sfdae_structure& result) {
  const int singular = certificate.first(BlockVerdict::singular);
  const bool is_singular = singular >= 0;
  result.doubtful_block = is_singular ? singular : certificate.first(BlockVerdict::unclear);
  result.smallest_pivot = is_singular ? 0.0 : certificate.smallest_kept();
  result.verdict = is_singular                 ? SFDAE_STRUCTURE_MISLEADS
                   : result.doubtful_block < 0 ? SFDAE_STRUCTURE_CERTIFIED
                                               : SFDAE_STRUCTURE_UNCLEAR;
  if (result.doubtful_block < 0) return "";
  const RankDecision& block = certificate.blocks[index(result.doubtful_block)];
  return format(
      "block %d of the system Jacobian, of %s, is %s at t = %.15g: rank %d of %d. Numbers cancel that the "
      "structure cannot see; the derivative array decides.",
      result.doubtful_block, names_of(record, structure.blocks.equations(result.doubtful_block)).c_str(),
      is_singular ? "singular" : "nearly singular", block.t, block.rank, block.cols);
}

[[noreturn]] void refuse_unrecorded() {
  refuse_argument(
      "structure is that of equations, recorded or functions with sparsity patterns, as many as unknowns, linear or "
      "nonlinear.");
}

}  // namespace

}  // namespace sfdae::core

using namespace sfdae::core;

extern "C" {

int sfdae_get_structure(sfdae_solver* solver, sfdae_structure* result, int* differentiations, int* orders,
                        int* assigned, int* block) {
  return guarded<Text::of_answer>(solver, [&]() -> CallResult {
    if (result == nullptr || !is_plausible_size(result->size))
      refuse_argument("the result is NULL or its size is not set: call its init function.");
    TaylorEvaluator* const evaluator =
        solver->model.multibody() != nullptr ? nullptr : solver->model.structure_evaluator();
    if (evaluator == nullptr || evaluator->record().m() != evaluator->record().n()) refuse_unrecorded();
    const Record& record = evaluator->record();
    const PublicArrays arrays{differentiations, orders, assigned, block};
    sfdae_structure found{};
    found.size = sizeof found;
    found.doubtful_block = -1;
    const Signature signature(record);
    const Transversal transversal = highest_transversal(signature);
    if (!transversal.exists()) {
      fill_struct(result, found);
      return describe_overdetermined(record, transversal.overdetermined, arrays);
    }
    const std::optional<Model::Extension> extension = solver->model.extension();
    const Structure structure = extension ? *extension->structure : Structure(signature, transversal);
    found.has_assignment = 1;
    found.freedom = structure.offsets.freedom();
    found.index_bound = structure.offsets.index_bound();
    found.num_blocks = structure.blocks.count();
    found.largest_block = structure.blocks.largest();
    found.num_replaced = structure.equations.num_replaced();
    found.is_followed = solver->model.follows_structure() ? 1 : 0;
    CallResult words;
    if (const std::optional<Point> point = known_point(*solver)) {
      Certificate certificate;
      if (!certify_structure(structure, *evaluator, {point->t, point->jet.data()},
                             solver->options.model.analysis.rank_tol, certificate))
        throw Failure(SFDAE_NOT_FINITE, evaluator->failure().message);
      words.message = judge_blocks(structure, record, certificate, found);
    }
    fill_struct(result, found);
    write_arrays(structure, arrays);
    return words;
  });
}

}  // extern "C"
