// The user's functions E, A, f of a linear problem: called, checked, counted, differentiated where necessary.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "expression/opaque_record.h"
#include "linalg/archive.h"
#include "linalg/arena.h"
#include "linalg/kept_factorizations.h"
#include "problem/coefficient_source.h"
#include "problem/difference_spacings.h"
#include "problem/problem.h"
#include "problem/taylor_data.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

// Options for derivatives that callbacks do not provide.
struct DifferenceOptions {
  bool allowed = false;
  double step = 0.0;  // 0: chosen
  double span = 1.0;  // length of the interval of interest, a first guess for the step
};

// The user's input: E and A are m x n.
struct LinearFunctions {
  int m = 0, n = 0;
  sfdae_matrix_function E = nullptr, A = nullptr;
  sfdae_vector_function f = nullptr;  // null: f = 0
  void* user = nullptr;               // handed to these three
  bool constant_E = false, constant_A = false;
  PrescribedInputs inputs;
  EquationNames names;
  // Patterns of A (F_x) and E (F_xdot), or null. Compressed: E and A write their entries, not matrices.
  std::shared_ptr<const JacobianPatterns> patterns = nullptr;
  bool compressed = false;
};

class LinearProblem final : public Problem, public CoefficientSource {
 public:
  explicit LinearProblem(LinearFunctions user);

  int m() const override { return user_.m; }
  int n() const override { return user_.n; }
  bool is_constant() const override { return user_.constant_E && user_.constant_A; }
  bool is_constant_E() const { return user_.constant_E; }
  bool is_constant(char which) const { return functions_[slot(which)].constant; }
  const std::vector<int>& prescribed() const { return user_.inputs.components; }

  // Derivatives up to the orders asked for, scaled to Taylor coefficients with the given time scale (0: chosen).
  // A stop request ends the evaluation with SFDAE_STOPPED.
  // preferred_rows: as for TaylorData::scale.
  CallbackError evaluate(double t, Orders orders, double time_scale, TaylorData& data,
                         RowScaling rows = RowScaling::each,
                         const std::vector<double>* preferred_rows = nullptr) override;
  void set_units(Units units) override { units_ = std::move(units); }
  const Units& units() const { return units_; }
  // Plain derivatives of the orders asked for, unscaled.
  CallbackError evaluate_plain(double t, Orders orders, TaylorData& data);
  // Values of the prescribed components.
  CallbackError evaluate_prescribed(double t, double* values);

  // One derivative straight from the callback: which = 'E', 'A' or 'f'. No differences.
  CallbackError call(char which, double t, int order, double* values);

  const std::shared_ptr<const JacobianPatterns>& patterns() const { return user_.patterns; }
  // Same for E and A as the entries of their patterns.
  CallbackError call_entries(char which, double t, int order, double* values);

  // E_0 is also factored once, in the units of earlier factorizations.
  void keep_values(double t) override;
  void forget_values() override;

  // explanation: the reason why callbacks cannot evaluate, if known.
  void set_explanation(std::function<std::string()> explanation) { explanation_ = std::move(explanation); }

  // Also forgets which orders were unavailable.
  void set_differences(const DifferenceOptions& options);

  // Requests constant matrices again.
  void forget_constants() {
    for (Function& function : functions_) function.constant_value.clear();
  }

  // Length of the interval of interest.
  double span() const { return differences_.span; }

  // Archives units of the unknowns and findings about derivatives.
  void archive(Archive& archive);
  // All that set_units, set_differences, set_limits and archive change.
  struct Settings {
    Units units;
    DifferenceOptions differences;
    std::array<int, 3> highest_orders{};
    std::array<Spacings, 3> spacings{};
    double lowest_t = 0.0, highest_t = 0.0;
  };
  Settings settings() const;
  void set_settings(Settings settings);

  long evaluations(char which) const { return functions_[slot(which)].calls; }

 private:
  struct Function {
    char name;
    int rows, columns;
    bool constant;
    long calls = 0;
    int highest_order = std::numeric_limits<int>::max();  // known to be available
    Spacings spacings;                                    // of differences
    std::vector<double> constant_value;
  };

  struct OrderRange {
    int first, last;
  };

  static std::size_t slot(char which) { return which == 'E' ? 0u : which == 'A' ? 1u : 2u; }
  const ColumnPattern* pattern_of(char which) const;
  CallbackError call_now(char which, double t, int order, double* values);
  CallbackError invoke(char which, double t, int order, double* values, const ColumnPattern* compressed);
  bool keeps_values_at(double t) const { return kept_ != nullptr && kept_->t == t; }
  CallbackError fill(Function& function, double t, int order, TaylorData& data);
  CallbackError differentiate(Function& function, double t, OrderRange orders, TaylorData& data);
  // Interval of the points of differences.
  struct Interval {
    double middle, half_width;
  };
  Interval interval_about(double t, double step) const;
  double time_in(const Interval& interval, double position) const;
  CallbackError sample(Function& function, const Interval& interval, std::vector<double>& samples);
  CallbackError choose_spacings(Function& function, double t, int last);
  static void archive_spacings(Archive& archive, Function& function);

  LinearFunctions user_;
  Units units_;
  std::array<Function, 3> functions_;
  DifferenceOptions differences_;
  std::function<std::string()> explanation_;
  // Values between keep_values() and forget_values().
  struct KeptPoint {
    double t = 0.0;
    Arena memory;
    // Values of E, A, f, by orders; null: not yet evaluated.
    std::array<std::array<double*, max_derivative_order + 1>, 3> values{};
  };
  std::unique_ptr<KeptPoint> kept_;
  KeptFactorizations kept_factorizations_;  // in its memory
};

}  // namespace sfdae::core
