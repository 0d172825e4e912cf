// Values of the formulas of a mechanical system, written to its terms: M, S, H, h and f. Constants are copied.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "expression/recorder.h"
#include "expression/taylor_evaluator.h"
#include "multibody/multibody_formulas.h"
#include "multibody/multibody_problem.h"

namespace sfdae::core {

class RecordedTerms {
 public:
  enum class Part { M, S, C, rest, f };
  // An entry that is not a number, and the value that belongs there.
  struct Place {
    Part part;
    std::size_t entry, value;
  };

  RecordedTerms(const Recorder& recorder, const MultibodyFormulas& formulas, bool has_kinematics);

  // M, S, H, h at (error.t, q), with f at (error.t, q, v); x: (q, v). False if they cannot be evaluated.
  bool evaluate(const double* x, bool with_forces, MultibodyTerms& terms, CallbackError& error);

  // Evaluator of all formulas, in which parameters are changed; call copy_parameters after a change of the first ones.
  TaylorEvaluator& evaluator() { return *all_; }
  const TaylorEvaluator& evaluator() const { return *all_; }
  // Constant entries, and the places of the evaluator's values.
  const MultibodyTerms& numbers() const { return numbers_; }
  const std::vector<Place>& places() const { return all_places_; }
  void copy_parameters(int count) {
    for (int i = 0; i < count; ++i) position_->set_parameter(i, all_->parameter(i));
  }

 private:
  // Block of formulas within MultibodyTerms.
  struct Block {
    Part part;
    const char* name;
    int rows, columns;
    int first, ld;  // of the entries of the part
  };
  struct Values {
    std::unordered_map<int, std::size_t> known;  // by node
    std::vector<int> nodes;
    std::vector<std::string> names;
    std::vector<Place> places;
  };

  static double* entries_of(MultibodyTerms& terms, Part part);
  void add_values(const Recorder& recorder, const std::vector<int>& formulas, const Block& block, Values& values);

  MultibodySizes sizes_;
  MultibodyTerms numbers_;                         // entries that are numbers
  std::optional<TaylorEvaluator> position_, all_;  // M, S, H, h; these and f
  std::vector<Place> position_places_, all_places_;
  std::vector<double> values_;
};

}  // namespace sfdae::core
