// The solution over a whole run: the C API.
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <memory>
#include <new>
#include <utility>

#include "c_api/creation.h"
#include "c_api/hybrid.h"
#include "c_api/solver.h"
#include "integrate/solution_pieces.h"
#include "linalg/archive.h"

using namespace sfdae::core;

// A solver has a weak pointer to the pieces: a solution that was destroyed is not recorded any more.
struct sfdae_solution {
  std::shared_ptr<SolutionPieces> pieces = std::make_shared<SolutionPieces>();
};

namespace {

// Header: a mark, the length in doubles and a checksum of all that follows.
constexpr double mark = 5.0e7 + 7353.0;  // no number that a solution begins with by chance
constexpr int layout = 2;
constexpr std::size_t header_size = 4;

double checksum(const double* values, std::size_t count) {
  WordHash hash;
  hash.add(values, count);
  return hash.value_as_real();
}

std::size_t length_of(SolutionPieces& pieces) {
  Archive counter = Archive::counter();
  pieces.archive(counter);
  return header_size + counter.size();
}

template <class Body>
int quietly(Body body) noexcept {
  try {
    return body();
  } catch (const std::bad_alloc&) {
    return SFDAE_OUT_OF_MEMORY;
  } catch (const DamagedArchive&) {
    return SFDAE_ILLEGAL_ARGUMENT;
  } catch (...) {
    return SFDAE_INTERNAL;
  }
}

// The doubles after the header. Throws DamagedArchive.
Archive checked_content(const double* values, std::size_t length) {
  if (length < header_size || values[0] != mark || values[1] != layout || !std::isfinite(values[2]) ||
      !(values[2] >= header_size) || !(values[2] <= static_cast<double>(length)) ||
      values[2] != std::floor(values[2]))
    throw DamagedArchive();
  const std::size_t size = static_cast<std::size_t>(values[2]) - header_size;
  if (values[3] != checksum(values + header_size, size)) throw DamagedArchive();
  return Archive::reader(values + header_size, size);
}

}  // namespace

extern "C" {

int sfdae_create_solution(sfdae_solution** solution) {
  if (solution != nullptr) *solution = nullptr;
  return creating([&] {
    if (solution == nullptr) refuse_argument("solution, where the new one goes, is NULL.");
    *solution = new sfdae_solution;
  });
}

int sfdae_destroy_solution(sfdae_solution** solution) {
  if (solution == nullptr) return SFDAE_OK;
  delete *solution;
  *solution = nullptr;
  return SFDAE_OK;
}

int sfdae_record_solution(sfdae_solver* solver, sfdae_solution* solution) {
  return guarded(solver, [&] { solver->record(solution != nullptr ? solution->pieces : nullptr); });
}

int sfdae_record_hybrid(sfdae_hybrid* hybrid, sfdae_solution* solution) {
  return guarded(hybrid, [&] {
    if (hybrid->modes.empty()) refuse_argument("there are no modes: call sfdae_add_mode.");
    hybrid->record(solution != nullptr ? solution->pieces : nullptr);
  });
}

int sfdae_get_solution_range(const sfdae_solution* solution, int* num_unknowns, double* start, double* end) {
  if (solution == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  const SolutionPieces& pieces = *solution->pieces;
  if (pieces.count() == 0) return SFDAE_NOT_STARTED;
  if (num_unknowns != nullptr) *num_unknowns = pieces.n();
  if (start != nullptr) *start = pieces.start();
  if (end != nullptr) *end = pieces.end();
  return SFDAE_OK;
}

int sfdae_evaluate_solution(const sfdae_solution* solution, double t, double* x, double* xdot) {
  if (solution == nullptr || x == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  if (solution->pieces->count() == 0) return SFDAE_NOT_STARTED;
  if (!std::isfinite(t)) return SFDAE_ILLEGAL_ARGUMENT;
  return solution->pieces->evaluate(t, x, xdot) ? SFDAE_OK : SFDAE_ILLEGAL_ARGUMENT;
}

int sfdae_get_solution_accuracy(const sfdae_solution* solution, double* accuracy, double* t) {
  if (solution == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  if (solution->pieces->count() == 0) return SFDAE_NOT_STARTED;
  const SolutionPieces::Accuracy found = solution->pieces->accuracy();
  if (accuracy != nullptr) *accuracy = found.in_tolerances;
  if (t != nullptr) *t = found.t;
  return SFDAE_OK;
}

int sfdae_cut_solution(sfdae_solution* solution, double t) {
  if (solution == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  SolutionPieces& pieces = *solution->pieces;
  if (pieces.count() == 0) return SFDAE_NOT_STARTED;
  const double direction = pieces.end() < pieces.start() ? -1.0 : 1.0;
  if (!std::isfinite(t) || (t - pieces.start()) * direction < 0.0 || (pieces.end() - t) * direction < 0.0)
    return SFDAE_ILLEGAL_ARGUMENT;
  pieces.cut(t);
  return SFDAE_OK;
}

int sfdae_get_solution_length(const sfdae_solution* solution, size_t* length) {
  if (solution == nullptr || length == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  return quietly([&] {
    *length = length_of(*solution->pieces);
    return SFDAE_OK;
  });
}

int sfdae_save_solution(const sfdae_solution* solution, double* values, size_t length) {
  if (solution == nullptr || values == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  return quietly([&] {
    const std::size_t needed = length_of(*solution->pieces);
    if (length < needed) return SFDAE_ILLEGAL_ARGUMENT;
    Archive archive = Archive::writer(values + header_size, needed - header_size);
    solution->pieces->archive(archive);
    values[0] = mark;
    values[1] = layout;
    values[2] = static_cast<double>(needed);
    values[3] = checksum(values + header_size, needed - header_size);
    return SFDAE_OK;
  });
}

int sfdae_load_solution(sfdae_solution* solution, const double* values, size_t length) {
  if (solution == nullptr || values == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  return quietly([&] {
    Archive archive = checked_content(values, length);
    SolutionPieces loaded;
    loaded.archive(archive);
    if (!archive.has_ended()) throw DamagedArchive();
    *solution->pieces = std::move(loaded);
    return SFDAE_OK;
  });
}

}  // extern "C"
