// Replacement of klu_factors.cpp in builds without KLU.
// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "linalg/klu_factors.h"

namespace sfdae::core {

namespace {

[[noreturn]] void complain() { throw std::logic_error("built without KLU"); }

}  // namespace

bool klu_is_available() { return false; }

template <class Number>
struct KluFactors<Number>::State {};

template <class Number>
KluFactors<Number>::KluFactors() = default;
template <class Number>
KluFactors<Number>::~KluFactors() = default;
template <class Number>
KluFactors<Number>::KluFactors(const KluFactors&) {}
template <class Number>
KluFactors<Number>::KluFactors(KluFactors&&) noexcept = default;
template <class Number>
KluFactors<Number>& KluFactors<Number>::operator=(KluFactors) noexcept {
  return *this;
}
template <class Number>
void KluFactors<Number>::analyze(const SparsePattern&) {
  complain();
}
template <class Number>
double KluFactors<Number>::flops() const {
  complain();
}
template <class Number>
bool KluFactors<Number>::factor(const SparsePattern&, const Number*) {
  complain();
}
template <class Number>
void KluFactors<Number>::forget_pivots() {
  complain();
}
template <class Number>
void KluFactors<Number>::solve(Op, Number*, int) {
  complain();
}
template <class Number>
std::size_t KluFactors<Number>::fill() const {
  complain();
}

template <class Number>
Determinant<Number> KluFactors<Number>::determinant() const {
  complain();
}

template class KluFactors<double>;
template class KluFactors<std::complex<double>>;

}  // namespace sfdae::core
