// Combinations of equations that replace those that depend on others.
//
// With u^T J = 0, u_p = 1 and c_p the least of the offsets of u's equations, f^_p = sum u_i D^(c_i - c_p) f_i no longer
// contains a highest derivative; the value of the transversal decreases each time, so that this ends.
// SPDX-License-Identifier: BSD-3-Clause
#include "structure/replacement.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <utility>

#include "linalg/random.h"
#include "structure/dependent_equations.h"
#include "structure/system_jacobian.h"

namespace sfdae::core {

namespace {

// Relative to the sum of terms: sums that are roundoff, and sums that are not. Sums in between remain undecided.
constexpr double cancelled = 1e-12, present = 1e-9;
// Beyond it equations would be differentiated more often than double precision permits.
constexpr int highest_order = 8;

// d f^ / d x_unknown^(order) at a point: its value and its derivative along a jet; sums of the absolute terms of both.
struct Derivative {
  int unknown, order;
  double value, slope, size, size_of_slope;
  bool has_cancelled(double limit) const {
    return std::fabs(value) <= limit * size && std::fabs(slope) <= limit * (size + size_of_slope);
  }
};

// Derivatives of the recorded equations as series along a jet.
class Gradients {
 public:
  // False if the equations cannot be evaluated there. jet: of one order more.
  bool evaluate(TaylorEvaluator& evaluator, double t, const double* jet, int order) {
    tape_ = &evaluator.tape();
    length_ = index(order + 1);
    coefficients_.assign(tape_->targets.size() * length_, 0.0);
    const std::vector<int> limits(index(evaluator.record().m()), order);
    return evaluator.entries(t, jet, order, limits, coefficients_.data());
  }

  // Derivatives of the sum of these terms, by unknowns, the highest first.
  std::vector<Derivative> of(std::span<const EquationTerm> terms) const {
    std::vector<Derivative> parts;
    for (const EquationTerm& term : terms)
      for (std::size_t e = tape_->first_target[index(term.equation)];
           e < tape_->first_target[index(term.equation + 1)]; ++e)
        add(term, e, parts);
    std::stable_sort(parts.begin(), parts.end(), [](const Derivative& a, const Derivative& b) {
      return a.unknown != b.unknown ? a.unknown < b.unknown : a.order > b.order;
    });
    std::vector<Derivative> sums;
    for (const Derivative& part : parts) {
      if (sums.empty() || sums.back().unknown != part.unknown || sums.back().order != part.order)
        sums.push_back({part.unknown, part.order, 0.0, 0.0, 0.0, 0.0});
      sums.back().value += part.value;
      sums.back().slope += part.slope;
      sums.back().size += part.size;
      sums.back().size_of_slope += part.size_of_slope;
    }
    return sums;
  }

 private:
  void add(const EquationTerm& term, std::size_t e, std::vector<Derivative>& parts) const {
    const Tape::Variable& leaf = tape_->targets[e];
    for (int s = 0; s <= term.order + 1; ++s) {
      const SeriesTerm part = series_term(term, leaf.derivative, s);
      if (part.order < 0) continue;
      const double* const a = &coefficients_[e * length_ + index(part.order)];
      const bool has_slope = index(part.order) + 1 < length_;
      const double value = part.factor * a[0];
      const double slope = has_slope ? part.factor * (part.order + 1) * a[1] : 0.0;
      parts.push_back({leaf.unknown, s, value, slope, std::fabs(value), std::fabs(slope)});
    }
  }

  const Tape* tape_ = nullptr;
  std::size_t length_ = 0;
  std::vector<double> coefficients_;
};

// Merges terms with the same derivative of an equation; those that cancel are left out.
std::vector<EquationTerm> merged(std::vector<EquationTerm> terms) {
  std::stable_sort(terms.begin(), terms.end(), [](const EquationTerm& a, const EquationTerm& b) {
    return a.equation != b.equation ? a.equation < b.equation : a.order < b.order;
  });
  std::vector<EquationTerm> sums;
  for (std::size_t k = 0; k < terms.size();) {
    EquationTerm sum = terms[k];
    double size = std::fabs(sum.factor);
    for (++k; k < terms.size() && terms[k].equation == sum.equation && terms[k].order == sum.order; ++k) {
      sum.factor += terms[k].factor;
      size += std::fabs(terms[k].factor);
    }
    if (std::fabs(sum.factor) > cancelled * size) sums.push_back(sum);
  }
  return sums;
}

class Replacement {
 public:
  Replacement(TaylorEvaluator& evaluator, const Neighbourhood& neighbourhood)
      : evaluator_(evaluator), neighbourhood_(neighbourhood) {}

  ReplacedStructure run(const Structure& recorded);

 private:
  struct Sample {
    std::vector<double> jet;
    Gradients gradients;
  };
  void choose_jets(int order);
  bool sample(int order);
  bool judge(const Structure& structure, Certificate& certificate);
  std::shared_ptr<const Structure> replaced(const Structure& recorded, Certificate certificate);
  bool replace_in(const Structure& structure, const SystemJacobian& jacobian, int block);
  std::optional<Signature> signature(const Signature& before) const;
  std::optional<std::vector<Signature::Entry>> row(std::span<const EquationTerm> terms) const;

  TaylorEvaluator& evaluator_;
  const Neighbourhood& neighbourhood_;
  std::vector<Sample> samples_;
  int order_ = -1;  // of D that samples suffice for
  EquationTerms terms_{0};
};

// Random points: few functions that vanish there do not vanish everywhere.
void Replacement::choose_jets(int order) {
  constexpr int count = 2;
  constexpr double near = 0.01;
  std::minstd_rand generator(1);
  const std::size_t n = neighbourhood_.sizes.size();
  samples_.resize(count);
  for (Sample& sample : samples_) {
    // One order more for slopes, and one for x'.
    sample.jet.resize(n * index(order + 3));
    for (std::size_t k = 0; k < sample.jet.size(); ++k) {
      const std::size_t j = k % n;
      const double x = neighbourhood_.x[j], size = std::max(std::fabs(x), neighbourhood_.sizes[j]);
      sample.jet[k] = (k < n ? x : 0.0) + near * size * symmetric_random(generator);
    }
  }
}

bool Replacement::sample(int order) {
  if (order <= order_) return true;
  if (order_ >= 0) choose_jets(order);
  order_ = order;
  for (Sample& sample : samples_)
    if (!sample.gradients.evaluate(evaluator_, neighbourhood_.t, sample.jet.data(), order + 1)) return false;
  return true;
}

bool Replacement::judge(const Structure& structure, Certificate& certificate) {
  return certify_structure(structure, evaluator_, {neighbourhood_.t, samples_[0].jet.data()}, 0.0, certificate);
}

ReplacedStructure Replacement::run(const Structure& recorded) {
  constexpr int first_order = 1;
  choose_jets(first_order);
  // Most structures are confirmed, and series of all derivatives would be the largest arrays of their starts.
  SystemJacobian jacobian(recorded, evaluator_.tape());
  StructureJudge judge(recorded, jacobian);
  Certificate certificate;
  if (!judge.certify(evaluator_, {neighbourhood_.t, samples_[0].jet.data()}, 0.0, certificate) ||
      certificate.is_given() || !sample(first_order))
    return {nullptr, judge.ordered()};
  ReplacedStructure result{replaced(recorded, std::move(certificate)), nullptr};
  if (!result.structure) result.ordered = judge.ordered();
  return result;
}

std::shared_ptr<const Structure> Replacement::replaced(const Structure& recorded, Certificate certificate) {
  terms_ = recorded.equations;
  auto structure = std::make_shared<const Structure>(recorded);
  while (!certificate.is_given()) {
    SystemJacobian jacobian(*structure, evaluator_.tape());
    if (!jacobian.evaluate(evaluator_, neighbourhood_.t, samples_[0].jet.data())) return nullptr;
    bool has_replaced = false;
    for (int block = 0; block < structure->blocks.count(); ++block)
      if (certificate.verdict(block) != BlockVerdict::regular)
        has_replaced = replace_in(*structure, jacobian, block) || has_replaced;
    if (!has_replaced || terms_.highest_order() > highest_order || !sample(terms_.highest_order())) return nullptr;
    const std::optional<Signature> rows = signature(recorded.signature);
    if (!rows) return nullptr;
    const Transversal transversal = highest_transversal(*rows);
    if (!transversal.exists()) return nullptr;
    auto next = std::make_shared<const Structure>(*rows, transversal, terms_);
    if (next->offsets.freedom() >= structure->offsets.freedom() || !judge(*next, certificate)) return nullptr;
    structure = std::move(next);
  }
  return structure;
}

// Replaces dependent equations of the block; true if there are any.
bool Replacement::replace_in(const Structure& structure, const SystemJacobian& jacobian, int block) {
  const std::vector<DependentEquation> dependent = dependent_equations(structure, jacobian, block);
  const std::vector<int>& c = structure.offsets.c;
  for (const auto& [equation, parts] : dependent) {
    const EquationTerms::Terms known = terms_.of(equation);
    std::vector<EquationTerm> terms(known.begin(), known.end());
    for (const DependentEquation::Part& part : parts) {
      const int more = c[index(part.equation)] - c[index(equation)];
      for (const EquationTerm& term : structure.equations.of(part.equation))
        terms.push_back({term.equation, term.order + more, -part.factor * term.factor});
    }
    terms_.replace(equation, merged(std::move(terms)));
  }
  return !dependent.empty();
}

// Null if it cannot be decided whether some entry is present.
std::optional<Signature> Replacement::signature(const Signature& before) const {
  std::vector<std::vector<Signature::Entry>> rows;
  for (int i = 0; i < before.size(); ++i) {
    if (!terms_.is_replaced(i)) {
      rows.emplace_back(before.row(i).begin(), before.row(i).end());
      continue;
    }
    auto found = row(terms_.of(i));
    if (!found) return std::nullopt;
    rows.push_back(std::move(*found));
  }
  return Signature(rows);
}

std::optional<std::vector<Signature::Entry>> Replacement::row(std::span<const EquationTerm> terms) const {
  std::vector<Signature::Entry> entries;
  const std::vector<Derivative> first = samples_[0].gradients.of(terms), second = samples_[1].gradients.of(terms);
  for (std::size_t k = 0; k < first.size(); ++k) {
    if (!entries.empty() && entries.back().unknown == first[k].unknown) continue;
    if (first[k].has_cancelled(cancelled) && second[k].has_cancelled(cancelled)) continue;
    if (first[k].has_cancelled(present) && second[k].has_cancelled(present)) return std::nullopt;
    if (first[k].order > Signature::highest_possible_order) return std::nullopt;
    entries.emplace_back(first[k].unknown, first[k].order);
  }
  return entries;
}

}  // namespace

ReplacedStructure structure_with_replacements(const Structure& structure, TaylorEvaluator& evaluator,
                                              const Neighbourhood& neighbourhood) {
  return Replacement(evaluator, neighbourhood).run(structure);
}

bool still_cancel(const Structure& structure, TaylorEvaluator& evaluator, double t, const double* jet) {
  if (structure.equations.num_replaced() == 0) return true;
  Gradients gradients;
  if (!gradients.evaluate(evaluator, t, jet, structure.equations.highest_order())) return false;
  for (int i = 0; i < structure.signature.size(); ++i) {
    if (!structure.equations.is_replaced(i)) continue;
    const auto row = structure.signature.row(i);
    for (const Derivative& derivative : gradients.of(structure.equations.of(i))) {
      const auto entry = std::find_if(row.begin(), row.end(), [&derivative](const Signature::Entry& e) {
        return e.unknown == derivative.unknown && e.order >= derivative.order;
      });
      if (entry == row.end() && std::fabs(derivative.value) > present * derivative.size) return false;
    }
  }
  return true;
}

}  // namespace sfdae::core
