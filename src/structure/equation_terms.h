// Equations that take the place of recorded ones: f^_i = sum of factor D^order f_k over terms, D the total derivative
// by t, factors constant; f_i is among the terms, as it stands.
//
// As the other equations stay, the system has the solutions of the recorded one [TNP17].
//
// [TNP17] G. Tan, N. S. Nedialkov, J. D. Pryce: Conversion methods for improving structural analysis of
//         differential-algebraic equation systems. BIT 57 (2017), 845-865.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "linalg/index.h"

namespace sfdae::core {

// factor D^order f_equation
struct EquationTerm {
  int equation;
  int order;
  double factor;
};

class EquationTerms {
 public:
  // Terms of one equation. Pointers into it are valid during its lifetime only.
  class Terms {
   public:
    explicit Terms(int recorded) : recorded_{recorded, 0, 1.0} {}
    explicit Terms(const std::vector<EquationTerm>& replaced) : replaced_(&replaced) {}
    const EquationTerm* begin() const { return replaced_ != nullptr ? replaced_->data() : &recorded_; }
    const EquationTerm* end() const { return begin() + (replaced_ != nullptr ? replaced_->size() : 1); }

   private:
    EquationTerm recorded_{};
    const std::vector<EquationTerm>* replaced_ = nullptr;
  };

  // All equations are those recorded.
  explicit EquationTerms(int n) : n_(n) {}

  Terms of(int i) const { return is_replaced(i) ? Terms(replaced_[index(place_[index(i)])]) : Terms(i); }
  bool is_replaced(int i) const { return !place_.empty() && place_[index(i)] >= 0; }
  int num_replaced() const { return static_cast<int>(replaced_.size()); }
  // Highest order of D in all terms.
  int highest_order() const { return highest_order_; }

  void replace(int i, std::vector<EquationTerm> terms) {
    for (const EquationTerm& term : terms) highest_order_ = std::max(highest_order_, term.order);
    if (!is_replaced(i)) {
      place_.resize(index(n_), -1);
      place_[index(i)] = num_replaced();
      replaced_.emplace_back();
    }
    replaced_[index(place_[index(i)])] = std::move(terms);
  }

 private:
  int n_;
  std::vector<int> place_;  // in replaced_, or -1; empty if nothing is replaced
  std::vector<std::vector<EquationTerm>> replaced_;
  int highest_order_ = 0;
};

// A Taylor coefficient of a derivative of f_k by x_j or x_j', times a factor: part of the derivative of D^order f_k by
// x_j^(s). order of the coefficient: -1 if there is none.
struct SeriesTerm {
  int order;
  double factor;
};

// With f_k = a_1 x_j' + a_0 x_j: D^m f_k contains (binomial(m, s - 1) a_1^(m - s + 1) + binomial(m, s) a_0^(m - s))
// x_j^(s).
SeriesTerm series_term(const EquationTerm& term, bool of_derivative, int s);

// values[entry] += factor times coefficients[coefficient], a Taylor coefficient of a derivative of a recorded equation.
struct EntryTerm {
  EntryTerm(int of, std::size_t from, double times)
      : entry(of), coefficient(static_cast<std::uint32_t>(from)), factor(times) {}
  int entry;
  std::uint32_t coefficient;
  double factor;
};
inline void sum_terms(const std::vector<EntryTerm>& terms, const std::vector<double>& coefficients,
                      std::vector<double>& values) {
  std::fill(values.begin(), values.end(), 0.0);
  for (const EntryTerm& term : terms) values[index(term.entry)] += term.factor * coefficients[term.coefficient];
}

}  // namespace sfdae::core
