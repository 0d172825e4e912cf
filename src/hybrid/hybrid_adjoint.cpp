// Adjoint gradients of hybrid systems: stored visits and their evaluation backward in time.
// SPDX-License-Identifier: BSD-3-Clause
#include "hybrid/hybrid_adjoint.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hybrid/hybrid_system.h"
#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

Vector parameters_of(const Solver& solver) {
  const TaylorEvaluator& evaluator = *solver.model.evaluator();
  Vector values;
  for (int i = 0; i < evaluator.num_parameters(); ++i) values.push_back(evaluator.parameter(i));
  return values;
}

std::shared_ptr<Solver> solver_of(const HybridMode& mode) {
  return mode.surface != nullptr ? mode.surface->shared_solver()
                                 : std::shared_ptr<Solver>(std::shared_ptr<void>(), mode.solver);
}

// Evaluation from the last visit to the first one.
class BackwardRun {
 public:
  BackwardRun(HybridSystem& hybrid, const HybridSystem::Functionals& functionals)
      : hybrid_(hybrid),
        functionals_(functionals),
        n_(hybrid.n()),
        count_(static_cast<int>(hybrid.sensitivities->names.size())),
        gradient_(count_, functionals.count) {}

  void read() {
    const HybridRun& run = hybrid_.run;
    const std::vector<KeptVisit>& visits = hybrid_.kept.visits;
    Matrix of_columns =
        read_visit({run.mode, *hybrid_.mode().solver, *hybrid_.mode().solver->integration}, times_of(visits.size()));
    for (std::size_t k = visits.size(); k-- > 0;) {
      const KeptVisit& visit = visits[k];
      go_to_end_of(visit, of_columns);
      of_columns = {};
      std::vector<int> times = times_of(k);
      if (has_weights_) times.push_back(end_of_visit);
      if (times.empty()) continue;
      check(visit);
      end_ = visit.end;
      visit.solver->set_limits(visit.start, run.direction());
      of_columns = read_visit({visit.mode, *visit.solver, *visit.integration}, times);
    }
  }
  const Matrix& gradient() const { return gradient_; }

 private:
  static constexpr int end_of_visit = -1;

  // Output times within a visit. The time of a transition belongs to the visit after it.
  std::vector<int> times_of(std::size_t visit) const {
    std::vector<int> times;
    for (int k = 0; k < functionals_.num_times; ++k)
      if (visit_at(functionals_.t[k]) == visit) times.push_back(k);
    return times;
  }
  std::size_t visit_at(double t) const {
    const std::vector<KeptVisit>& visits = hybrid_.kept.visits;
    const double direction = hybrid_.run.direction();
    if ((t - hybrid_.run.visit.entered) * direction >= 0.0) return visits.size();
    for (std::size_t k = visits.size(); k-- > 1;)
      if ((t - visits[k].start) * direction >= 0.0) return k;
    return 0;
  }
  void check(const KeptVisit& visit) const {
    const Solver& solver = *visit.solver;
    if (parameters_of(solver) != visit.parameters)
      refuse_argument(
          format("parameters of %s have other values than from t = %.15g to %.15g, where the gradient is to be "
                 "computed.",
                 hybrid_.name_of(visit.mode).c_str(), visit.start, visit.end));
    if (solver.model.shared_system() != visit.system && solver.model.follows_structure() != visit.follows_structure)
      refuse_argument(
          format("%s has been analyzed anew, with other equations differentiated, since t = %.15g: the gradient "
                 "cannot be computed before that. Set structure = SFDAE_STRUCTURE_OFF.",
                 hybrid_.name_of(visit.mode).c_str(), visit.end));
  }
  struct Visit {
    int mode;
    Solver& solver;
    Integration& integration;
  };
  // The part of the mode above, along a surface, is in no functional, but it affects the state at the end of the visit.
  Vector weights_of(const std::vector<int>& times, int rows) const {
    Vector weights;
    for (int q = 0; q < functionals_.count; ++q)
      for (const int k : times) {
        const int given = k == end_of_visit ? rows : n_;
        const double* const from =
            k == end_of_visit
                ? weights_.view().column(q)
                : functionals_.weights + index(n_) * (index(k) + index(functionals_.num_times) * index(q));
        weights.insert(weights.end(), from, from + given);
        weights.resize(weights.size() + index(rows - given), 0.0);
      }
    return weights;
  }
  // Gradient with respect to all columns at the start of the visit; empty without times.
  Matrix read_visit(const Visit& visit, const std::vector<int>& times) {
    if (times.empty()) return {};
    const DiscreteAdjoint& adjoint = *visit.integration.adjoint();
    Vector t;
    for (const int k : times) t.push_back(k == end_of_visit ? end_ : functionals_.t[k]);
    const Vector weights = weights_of(times, adjoint.unknowns());
    Matrix found(std::max(adjoint.count(), 1), functionals_.count);
    hybrid_.call(visit.solver, visit.mode, [&](Solver&) {
      return visit.integration.gradient({t, weights.data(), functionals_.count}, found.data());
    });
    for (int q = 0; q < functionals_.count; ++q)
      for (int j = 0; j < count_; ++j) gradient_(j, q) += found(j, q);
    Matrix of_columns(found.rows() - count_, functionals_.count);
    copy(found.view().block(count_, 0, of_columns.rows(), functionals_.count), of_columns);
    return of_columns;
  }
  // Transforms weights of z into weights of S at the end of the visit.
  void go_to_end_of(const KeptVisit& visit, const Matrix& of_columns) {
    weights_ = Matrix(visit.integration->adjoint()->unknowns(), functionals_.count);
    if (of_columns.rows() > 0 && visit.is_whole) copy(of_columns, weights_);
    else if (of_columns.rows() > 0)
      multiply(1.0, Op::transposed, visit.coordinates, Op::plain, of_columns, 0.0, weights_);
    has_weights_ = max_abs(weights_) > 0.0;
  }

  HybridSystem& hybrid_;
  const HybridSystem::Functionals functionals_;
  int n_, count_;
  Matrix gradient_;
  Matrix weights_;  // of S at the end of a visit
  bool has_weights_ = false;
  double end_ = 0.0;
};

// Scope in which evaluations refer to ended visits; the destructor restores the state of the present one.
class LookBack {
 public:
  explicit LookBack(HybridSystem& hybrid) : hybrid_(hybrid) {}
  LookBack(const LookBack&) = delete;
  LookBack& operator=(const LookBack&) = delete;
  ~LookBack() {
    if (hybrid_.kept.visits.empty()) return;
    Solver& solver = *hybrid_.mode().solver;
    solver.set_limits(solver.integration->start(), hybrid_.run.direction());
    solver.integration->keep_to_last_piece();
  }

 private:
  HybridSystem& hybrid_;
};

}  // namespace

Vector find_columns(HybridSystem& hybrid, bool at_once) {
  HybridRun& run = hybrid.run;
  Integration& integration = *hybrid.mode().solver->integration;
  if (at_once) return integration.adjoint()->values_at_start();
  TangentSpace& space = hybrid.kept.ending;
  space = {};
  hybrid.call(run.mode, [&](Solver&) { return integration.end_at(run.t, space); });
  const int n = hybrid.mode().solver->model.n(), count = static_cast<int>(hybrid.sensitivities->names.size());
  const int unknowns = space.is_whole() ? n : space.basis.cols();
  Matrix all(n, count + unknowns);
  copy(space.offset.view().columns(0, count), all.view().columns(0, count));
  const View of_basis = all.view().columns(count, unknowns);
  if (!space.is_whole()) copy(space.basis, of_basis);
  for (int i = 0; i < unknowns && space.is_whole(); ++i) of_basis(i, i) = 1.0;
  run.moving.shifts.assign(index(all.cols()), 0.0);
  return {all.data(), all.data() + index(n) * index(all.cols())};
}

void keep_visit(HybridSystem& hybrid, bool at_once) {
  if (!hybrid.sensitivities || !hybrid.sensitivities->by_adjoint || at_once) return;
  HybridRun& run = hybrid.run;
  Solver& solver = *hybrid.mode().solver;
  std::vector<KeptVisit>& visits = hybrid.kept.visits;
  visits.push_back({run.mode, solver_of(hybrid.mode()), run.visit.entered, run.t, solver.model.shared_system(),
                    solver.model.follows_structure(), parameters_of(solver), nullptr, hybrid.kept.ending.is_whole(),
                    std::move(hybrid.kept.ending.coordinates)});
  KeptVisit& visit = visits.back();
  hybrid.kept.ending = {};
  visit.integration = std::move(solver.integration);
  visit.integration->keep_steps_alone();
}

void HybridSystem::gradient(const Functionals& functionals, double* gradient) {
  BackwardRun backward(*this, functionals);
  {
    const LookBack look_back(*this);
    backward.read();
  }
  const Matrix& found = backward.gradient();
  const std::size_t size = index(found.rows()) * index(found.cols());
  if (!all_finite(found.data(), size))
    throw Failure(SFDAE_NOT_FINITE, "the gradient overflows: rescale the problem or the weights.");
  std::copy_n(found.data(), size, gradient);
}

}  // namespace sfdae::core
