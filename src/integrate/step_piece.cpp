// Piece of an integration: saving and repeating.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/step_piece.h"

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Repetition of steps: restores the data other than the system on which they depend.
class Replay {
 public:
  Replay(const StepPiece& piece, SystemTwin& twin)
      : piece_(piece), twin_(twin), integrator_(twin.system(), piece.direction) {
    integrator_.create(piece.method, *piece.options);
    xdot_.resize(index(twin.system().unknowns()));
  }
  void restore(Archive& archive) {
    integrator_.stepper->archive(archive, integrator_.system);
    if (!archive.has_ended()) throw DamagedArchive();
  }
  void begin_anew(KeptSteps& steps) {
    KeptStep step;
    step.t = integrator_.stepper->state().t;
    points_.clear();
    points_.push_back(twin_.point(nullptr));
    steps.make_room();
    steps.add(step, points_);
  }
  // False if the outcome differs from the original one.
  bool repeat(const Attempt& attempt, const std::vector<double>& times, KeptSteps& steps) {
    Stepper& stepper = *integrator_.stepper;
    const double h = attempt.t - stepper.state().t;
    integrator_.weights.set_part(attempt.part);
    const StepOutcome outcome = stepper.attempt(integrator_.system, attempt.t, integrator_.weights);
    const bool has_succeeded = attempt.end == AttemptEnd::taken || attempt.end == AttemptEnd::withdrawn;
    if (outcome == StepOutcome::callback_error && !integrator_.system.callback_error().is_recoverable())
      integrator_.system.callback_error().raise();
    if ((outcome == StepOutcome::accepted) != has_succeeded) return false;
    if (attempt.end == AttemptEnd::reduced) stepper.reduce_after_failure(h);
    if (attempt.end == AttemptEnd::withdrawn) stepper.withdraw();
    if (attempt.end != AttemptEnd::taken) return true;
    const std::size_t k = piece_.first + steps.count();
    const TriedStep tried = stepper.tried();
    steps.make_room();
    const KeptStep step = formula_of(tried, times.data() + (k - 1), k - piece_.origin);
    keep_points(twin_, tried, xdot_, points_);
    steps.add(step, points_);
    stepper.commit();
    integrator_.system.accept();
    return true;
  }

 private:
  const StepPiece& piece_;
  SystemTwin& twin_;
  Integrator integrator_;
  std::vector<double> xdot_;
  std::vector<KeptPoint> points_;
};

[[noreturn]] void refuse(const StepPiece& piece, const std::vector<double>& times) {
  throw Failure(
      SFDAE_CALLBACK_FAILED,
      format("the steps from t = %.15g on cannot be made again as they were: functions that the equations call "
             "return something else now. Keep all steps (max_kept_steps = 0).",
             times[piece.first]));
}

}  // namespace

void StepPiece::follow(const StepPiece& last, std::size_t most) {
  for (std::size_t i = last.kept.count(); i-- > 0 && before.size() < most;)
    before.push_back(before.empty() ? last.kept.end(i) : with_values_alone(last.kept.end(i)));
  for (std::size_t i = 0; i < last.before.size() && before.size() < most; ++i)
    before.push_back(before.empty() ? last.before[i] : with_values_alone(last.before[i]));
}

void StepPiece::save(Integrator& integrator) {
  DaeSystem& system = integrator.system;
  const auto archive_all = [&](Archive& archive) {
    system.archive(archive);
    integrator.stepper->archive(archive, system);
  };
  Archive counter = Archive::counter();
  archive_all(counter);
  std::vector<double> saved(counter.size());
  Archive writer = Archive::writer(saved.data(), saved.size());
  archive_all(writer);
  checkpoint = std::move(saved);
  attempts.clear();
  method = integrator.method;
  direction = integrator.direction;
}

KeptSteps steps_made_again(const StepPiece& piece, const std::vector<double>& times, SystemTwin& twin) {
  KeptSteps steps;
  bool agrees = true;
  try {
    Archive archive = Archive::reader(piece.checkpoint.data(), piece.checkpoint.size());
    twin.restore(archive);
    Replay replay(piece, twin);
    replay.restore(archive);
    if (piece.begins_anew) replay.begin_anew(steps);
    for (std::size_t i = 0; agrees && steps.count() < piece.count; ++i)
      agrees = i < piece.attempts.size() && replay.repeat(piece.attempts[i], times, steps);
  } catch (const DamagedArchive&) {
    agrees = false;
  }
  if (agrees && steps.fingerprint() == piece.kept.fingerprint()) return steps;
  if (twin.stop_is_requested()) throw Failure(SFDAE_STOPPED, "stopped on request; the call can be repeated.");
  refuse(piece, times);
}

}  // namespace sfdae::core
