// One run: a case in one of its variants, judged by the reference.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "system.h"

namespace campaign {

inline constexpr int variants_of_problem = 6;
// Errors above so many tolerances, or so many times what a perturbation of one tolerance does, are wrong.
inline constexpr double allowed_tolerances = 50.0;

enum class Verdict { right, wrong, named, no_reference };

struct RunResult {
  Verdict verdict = Verdict::right;
  int status = SFDAE_OK;
  double error = 0.0;  // largest, in tolerances or, where it is larger, in units of perturbations by a tolerance
  double plain_error = 0.0;  // in tolerances
  double seconds = 0.0;
  int unknown = -1;
  double t = 0.0;
  char message[240] = "";
};

Variant random_variant(const Case& problem, int number, int variant, int seed);
std::vector<std::unique_ptr<Reference>> make_references(const Case& problem);
// prints: the problem, its options and the errors at outputs.
RunResult run(const Case& problem, const Variant& variant, const std::vector<std::unique_ptr<Reference>>& references,
              bool prints);

}  // namespace campaign
