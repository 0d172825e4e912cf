// A problem that one of several formulations serves: its own one (the whole derivative array, local coordinates of a
// mechanical system), the minimal extension of its recorded equations, or the whole array of these.
//
// Each analysis chooses anew, by options, size and numbers; everything else asks the one that serves. Objects of the
// theory are those of the problem's own formulation, whichever serves.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "array/nonlinear_model.h"
#include "extension/extension_model.h"
#include "system/model.h"

namespace sfdae::core {

enum class Formulation { own, extension, array };

class FormulatedModel : public Model {
 public:
  Problem& problem() override { return own_->problem(); }
  int m() const override { return own_->m(); }
  int n() const override { return own_->n(); }
  bool is_constant() const override { return own_->is_constant(); }
  bool needs_x() const override { return own_->needs_x(); }
  EvaluationCounts evaluations() const override;
  TaylorEvaluator* evaluator() override { return own_->evaluator(); }
  void parameters_changed() override;
  std::vector<const TaylorEvaluator*> evaluators_of_inputs() override { return own_->evaluators_of_inputs(); }

  void analyze(const PointOfInterest& point, const ModelOptions& options,
               std::vector<RankDecision>& decisions) override;
  bool expect(SystemForm form, bool for_sensitivities) override;
  void restore(const ModelOptions& options, Archive& archive) override;
  void undo_restore() override;
  void finish_restore() override;
  DaeSystem* system() override { return active().system(); }
  void forget_system() override;
  std::shared_ptr<const DaeSystem> shared_system() override { return active().shared_system(); }
  double certify() override { return active().certify(); }
  std::unique_ptr<ChangeWatch> change_watch() override { return active().change_watch(); }
  std::unique_ptr<SensitivitySystem> sensitivities(std::vector<int> parameters) override {
    return active().sensitivities(std::move(parameters));
  }
  ConsistentPoint consistent_point(const PointOfInterest& point, const ModelOptions& options) override {
    return active().consistent_point(point, options);
  }
  ConsistentPoint consistent_point_beside(const PointOfInterest& point, const ModelOptions& options) override {
    return active().consistent_point_beside(point, options);
  }
  std::optional<Extension> extension() override { return active().extension(); }

  Jump jump(const PointOfInterest& point, const ModelOptions& options) override {
    return whole().jump(point, options);
  }
  Jet jet_through(double t, const double* x, int level) override { return whole().jet_through(t, x, level); }
  DerivativeArray derivative_array(const Jet& jet, int level) override {
    return whole().derivative_array(jet, level);
  }
  // Their sizes are those of the characteristic values in use.
  Projectors projectors(const Jet& jet, bool of_array) override { return same_whole().projectors(jet, of_array); }
  StrangenessFreeEquations strangeness_free(const Jet& jet) override { return same_whole().strangeness_free(jet); }
  int level_of_jets(bool of_array) override { return same_whole().level_of_jets(of_array); }
  Jet accepted_point() const override { return active().accepted_point(); }

 protected:
  explicit FormulatedModel(std::unique_ptr<Model> own) : own_(std::move(own)) {}
  // equations: for the extension; `owned` if that is another object than that of `own`.
  void set_equations(RecordedProblem& equations, std::unique_ptr<RecordedProblem> owned);
  void make_array();

  Model& own() const { return *own_; }
  RecordedProblem* equations() const { return equations_; }
  bool owns_equations() const { return owned_ != nullptr; }
  ExtensionModel& extended() const { return *extended_; }
  NonlinearModel& array() const { return *array_; }
  Formulation formulation() const { return formulation_; }
  const ModelOptions& options() const { return options_; }  // of the last analysis
  Model& active() const;
  // The own formulation, analyzed where the active one is.
  Model& analyze_own();

 private:
  Formulation choose_formulation(const PointOfInterest& point, const ModelOptions& options,
                                 std::vector<RankDecision>& decisions);
  bool settle_doubt(const PointOfInterest& point, const ModelOptions& options, std::vector<RankDecision>& decisions);

  // What tells kinds of problems apart. Whether options leave the extension only; throws Failure where they cannot be
  // followed.
  virtual bool requires_extension(const ModelOptions& options) = 0;
  // Whether options and the kind of equations allow it, and numbers suggest it from the beginning.
  virtual bool may_extend(const ModelOptions& options) = 0;
  virtual bool is_extended_first(const PointOfInterest& point, const ModelOptions& options) = 0;
  // Of an analysis without the extension: whether it has failed where the extension need not.
  virtual bool is_in_doubt(const Failure&, const PointOfInterest&, const ModelOptions&) { return false; }
  virtual bool are_others_possible() const { return true; }
  // Sensitivities are those of the array of the equations.
  virtual bool has_array_for_sensitivities() const = 0;
  virtual bool has_archived_extension(bool for_sensitivities) = 0;
  virtual std::unique_ptr<RecordedProblem> equations_of_array() = 0;
  virtual void analyze_as(Formulation formulation, const PointOfInterest& point, const ModelOptions& options,
                          std::vector<RankDecision>& decisions) = 0;
  virtual Model& whole() = 0;
  virtual Model& same_whole() { return whole(); }

  std::unique_ptr<Model> own_;
  std::unique_ptr<RecordedProblem> owned_;
  RecordedProblem* equations_ = nullptr;
  std::unique_ptr<ExtensionModel> extended_;
  std::unique_ptr<NonlinearModel> array_;
  Formulation formulation_ = Formulation::own, before_ = Formulation::own;
  ModelOptions options_;
};

}  // namespace sfdae::core
