// A mechanical system given by recorded formulas.
//
// Along q(t + s) = q + q_1 s + q_2 s^2 with q_1 = S v and 2 q_2 = S a + (dS/dt) v the constraints are
// g + g_1 s + g_2 s^2 with g_1 = G v + g_t and 2 g_2 = G a + gamma: without a, g_2 gives gamma. As the derivative of
// g_k by q_j is (g_q)_(k-j), Taylor coefficients of g_q are all that an iteration's Jacobian needs of the
// constraints. SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "expression/recorder.h"
#include "expression/taylor_evaluator.h"
#include "multibody/multibody_problem.h"

namespace sfdae::core {

// Nodes of a recorder whose unknowns are (q, v), matrices column by column. All but f depend on t and q alone.
struct MultibodyFormulas {
  MultibodySizes sizes;
  std::vector<int> M, f, g, S, H, h;
};

class RecordedMultibody final : public MultibodyProblem {
 public:
  // The recorder is of no use afterwards.
  RecordedMultibody(Recorder& recorder, const MultibodyFormulas& formulas);

  bool has_kinematics() const override { return kinematics_.has_value(); }
  CallbackError constraints(double t, const double* q, double* g) override;
  CallbackError at_position(double t, const double* q, MultibodyTerms& terms) override;
  CallbackError at_velocity(double t, const double* q, const double* v, MultibodyTerms& terms) override;
  CallbackError linearize(const MultibodyState& state, const MultibodyTerms& terms,
                          MultibodyJacobian& jacobian) override;
  TaylorEvaluator* evaluator() override { return &*all_; }
  void parameters_changed() override;

 private:
  enum class Part { M, S, C, rest, f };
  // Of formulas within MultibodyTerms.
  struct Block {
    Part part;
    const char* name;
    int rows, columns;
    int first, ld;  // of the entries of the part
  };
  // An entry that is not a number, and which of the values goes there.
  struct Place {
    Part part;
    std::size_t entry, value;
  };
  struct Values {
    std::unordered_map<int, std::size_t> known;  // by node
    std::vector<int> nodes;
    std::vector<std::string> names;
    std::vector<Place> places;
  };
  // Parameters whose values are those of a vector that is held.
  struct Held {
    std::vector<int> a, kappa, p, lambda;  // indices of parameters
  };

  static double* entries_of(MultibodyTerms& terms, Part part);
  void add_values(const Recorder& recorder, const std::vector<int>& formulas, const Block& block, Values& values);
  void record_values(const Recorder& recorder, const MultibodyFormulas& formulas);
  void record_balance(Recorder& recorder, const MultibodyFormulas& formulas);
  void allocate();

  // Errors know the time.
  CallbackError begin(double t) const;
  static bool failed(const TaylorEvaluator& evaluator, CallbackError& error);
  // All but f, g and g_q; or f, too. x: (q, v).
  bool evaluate_values(const double* x, bool with_forces, MultibodyTerms& terms, CallbackError& error);
  // The jets, with v_1 (null: 0); q_2 = (dS/dt v + S v_1) / 2 is left to be computed where S is not the identity.
  void set_jet(const double* q, const double* v, const double* v_1, const MultibodyTerms& terms);
  // g, g_q, G and g_t along q_jet_, order 2; or with q_1 = 0, lower orders.
  bool evaluate_constraints(int order, MultibodyTerms& terms, CallbackError& error);

  bool linearize_balance(const double* a, const double* mu, const MultibodyTerms& terms, MultibodyJacobian& jacobian,
                         CallbackError& error);
  bool subtract_curvature(const double* q, const MultibodyTerms& terms, View force_q, CallbackError& error);
  bool linearize_kinematics(const MultibodyTerms& terms, MultibodyJacobian& jacobian, CallbackError& error);
  bool linearize_holonomic(const MultibodyTerms& terms, MultibodyJacobian& jacobian, CallbackError& error);
  bool linearize_nonholonomic(const MultibodyTerms& terms, MultibodyJacobian& jacobian, CallbackError& error);

  int num_parameters_;      // the user's
  bool rheonomic_ = false;  // g depends on t
  // M, S, H, h; these and f; g; what the balance of forces depends on; lambda^T g; S v; H v + h.
  std::optional<TaylorEvaluator> position_, all_, constraints_, balance_, curvature_, kinematics_, nonholonomic_;
  std::vector<Place> position_places_, all_places_;
  Held held_;
  MultibodyTerms numbers_;  // entries that are numbers
  std::vector<double> values_;
  std::vector<double> q_jet_;  // nq x 4
  std::vector<double> jet_;    // of (q, v): (nq + nv) x 3
  std::vector<double> g_jet_;  // nl x 3
  std::vector<double> rates_;  // S v or H v + h, and their first coefficients
  std::vector<double> gradients_, curvature_gradients_;
  std::vector<int> curved_;  // j where lambda^T g is not linear in q_j
  Matrix rate_q_, rate_v_;   // derivatives of 2 q_2 by q and v
};

}  // namespace sfdae::core
