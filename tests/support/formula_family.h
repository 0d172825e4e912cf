// SPDX-License-Identifier: BSD-3-Clause
// Linear DAEs given by formulas: the entries are written once as functions of a jet, all derivatives follow.
#ifndef SFDAE_TESTS_FORMULA_FAMILY_H
#define SFDAE_TESTS_FORMULA_FAMILY_H

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "linear_family.h"

namespace sfdae_test {

using Entries = std::vector<Jet>;  // of a matrix: row by row, as on paper
using Formula = std::function<Entries(const Jet& t)>;

struct Formulas {
  Formula E, A;             // m n entries each
  Formula f = nullptr;      // m entries; empty: f = 0
  Formula exact = nullptr;  // n entries; empty: not known
  bool constant_E = false;
  bool constant_A = false;
};

std::unique_ptr<LinearFamily> formula_family(std::string name, CharacteristicValues values, Formulas formulas);

}  // namespace sfdae_test

#endif
