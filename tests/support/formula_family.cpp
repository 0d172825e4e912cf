// SPDX-License-Identifier: BSD-3-Clause
#include "formula_family.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace sfdae_test {

namespace {

class FormulaFamily : public LinearFamily {
 public:
  FormulaFamily(std::string name, CharacteristicValues values, Formulas formulas)
      : LinearFamily(std::move(name), values), formulas_(std::move(formulas)) {}

  void matrix_coefficients(double t, int order, double* E, double* A) const override {
    write(formulas_.E, t, order, n(), E);
    write(formulas_.A, t, order, n(), A);
  }

  void vector_coefficients(double t, int order, double* f) const override {
    if (formulas_.f) write(formulas_.f, t, order, 1, f);
    else std::fill_n(f, m() * (order + 1), 0.0);
  }

  bool constant_E() const override { return formulas_.constant_E; }
  bool constant_A() const override { return formulas_.constant_A; }
  bool has_exact() const override { return formulas_.exact != nullptr; }

  void exact(double t, double* x, double* xdot) const override {
    if (!formulas_.exact) LinearFamily::exact(t, x, xdot);
    const Entries jets = formulas_.exact(Jet::variable(t, 1));
    for (std::size_t j = 0; j < jets.size(); ++j) {
      x[j] = jets[j][0];
      if (xdot) xdot[j] = jets[j][1];
    }
  }

 private:
  // From rows of jets to columns of coefficients.
  void write(const Formula& formula, double t, int order, int columns, double* out) const {
    const Entries entries = formula(Jet::variable(t, order));
    if (entries.size() != static_cast<std::size_t>(m() * columns)) throw std::logic_error(name() + ": shape");
    for (int k = 0; k <= order; ++k)
      for (int j = 0; j < columns; ++j)
        for (int i = 0; i < m(); ++i) *out++ = entries[static_cast<std::size_t>(i * columns + j)][k];
  }

  Formulas formulas_;
};

}  // namespace

std::unique_ptr<LinearFamily> formula_family(std::string name, CharacteristicValues values, Formulas formulas) {
  return std::make_unique<FormulaFamily>(std::move(name), values, std::move(formulas));
}

}  // namespace sfdae_test
