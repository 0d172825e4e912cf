// Gradients of hybrid systems by the adjoint: what is kept of visits, and how these are read backward.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/hybrid_adjoint.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "c_api/hybrid.h"
#include "c_api/sensitivities.h"
#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

Vector parameters_of(const sfdae_solver& solver) {
  const TaylorEvaluator& evaluator = *solver.model.evaluator();
  Vector values;
  for (int i = 0; i < evaluator.num_parameters(); ++i) values.push_back(evaluator.parameter(i));
  return values;
}

std::shared_ptr<sfdae_solver> solver_of(const HybridMode& mode) {
  return mode.surface != nullptr ? mode.surface->shared_solver()
                                 : std::shared_ptr<sfdae_solver>(std::shared_ptr<void>(), mode.solver);
}

// Goes back from the last visit to the first one.
class BackwardRun {
 public:
  struct Functionals {
    int num_times;
    const double* t;
    int count;
    const double* weights;
  };
  BackwardRun(sfdae_hybrid& hybrid, const Functionals& functionals)
      : hybrid_(hybrid),
        functionals_(functionals),
        n_(hybrid.n()),
        count_(static_cast<int>(hybrid.sensitivities->names.size())),
        gradient_(count_, functionals.count) {}

  CallResult read() {
    const HybridRun& run = hybrid_.run;
    const std::vector<KeptVisit>& visits = hybrid_.kept.visits;
    Matrix of_columns;
    CallResult result = read_visit({run.mode, *hybrid_.mode().solver, *hybrid_.mode().solver->integration},
                                   times_of(visits.size()), of_columns);
    for (std::size_t k = visits.size(); k-- > 0 && result.status >= 0;) {
      const KeptVisit& visit = visits[k];
      go_to_end_of(visit, of_columns);
      of_columns = {};
      std::vector<int> times = times_of(k);
      if (has_weights_) times.push_back(end_of_visit);
      if (times.empty()) continue;
      result = check(visit);
      if (result.status < 0) break;
      end_ = visit.end;
      visit.solver->set_limits(visit.start, run.direction());
      result = read_visit({visit.mode, *visit.solver, *visit.integration}, times, of_columns);
    }
    return result;
  }
  const Matrix& gradient() const { return gradient_; }

 private:
  static constexpr int end_of_visit = -1;

  // Points in time of a visit. Of a transition's time they are those after it.
  std::vector<int> times_of(std::size_t visit) const {
    std::vector<int> times;
    for (int k = 0; k < functionals_.num_times; ++k)
      if (visit_at(functionals_.t[k]) == visit) times.push_back(k);
    return times;
  }
  std::size_t visit_at(double t) const {
    const std::vector<KeptVisit>& visits = hybrid_.kept.visits;
    const double direction = hybrid_.run.direction();
    if ((t - hybrid_.run.entered) * direction >= 0.0) return visits.size();
    for (std::size_t k = visits.size(); k-- > 1;)
      if ((t - visits[k].start) * direction >= 0.0) return k;
    return 0;
  }
  CallResult check(const KeptVisit& visit) const {
    const sfdae_solver& solver = *visit.solver;
    if (parameters_of(solver) != visit.parameters)
      return illegal_argument(
          format("parameters of %s have other values than from t = %.15g to %.15g, where the gradient is to be "
                 "computed.",
                 hybrid_.name_of(visit.mode).c_str(), visit.start, visit.end));
    if (solver.model.shared_system() != visit.system && solver.follows_structure() != visit.follows_structure)
      return illegal_argument(
          format("%s has been analyzed anew, with other equations differentiated, since t = %.15g: the gradient "
                 "cannot be computed before that. Set structure = SFDAE_STRUCTURE_OFF.",
                 hybrid_.name_of(visit.mode).c_str(), visit.end));
    return {};
  }
  struct Visit {
    int mode;
    sfdae_solver& solver;
    Integration& integration;
  };
  // The part of the mode above, along a surface, is in no functional, but in what follows where the visit ends.
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
  // The gradient by all columns that the visit has begun with.
  CallResult read_visit(const Visit& visit, const std::vector<int>& times, Matrix& of_columns) {
    if (times.empty()) return {};
    const DiscreteAdjoint& adjoint = *visit.integration.adjoint();
    Vector t;
    for (const int k : times) t.push_back(k == end_of_visit ? end_ : functionals_.t[k]);
    const Vector weights = weights_of(times, adjoint.unknowns());
    Matrix found(std::max(adjoint.count(), 1), functionals_.count);
    hybrid_.running.store(&visit.solver);
    const int status = guarded(&visit.solver, [&] {
      return visit.integration.gradient({t, weights.data(), functionals_.count}, found.data());
    });
    hybrid_.running.store(nullptr);
    if (status == SFDAE_STOPPED) hybrid_.stop_is_requested.store(false);
    if (status < 0 || status == SFDAE_STOPPED)
      return {status, hybrid_.name_of(visit.mode) + ": " + visit.solver.message};
    for (int q = 0; q < functionals_.count; ++q)
      for (int j = 0; j < count_; ++j) gradient_(j, q) += found(j, q);
    of_columns = Matrix(found.rows() - count_, functionals_.count);
    copy(found.view().block(count_, 0, of_columns.rows(), functionals_.count), of_columns);
    return {};
  }
  // Weights of z become those of S where the visit ends.
  void go_to_end_of(const KeptVisit& visit, const Matrix& of_columns) {
    weights_ = Matrix(visit.integration->adjoint()->unknowns(), functionals_.count);
    if (of_columns.rows() > 0 && visit.is_whole) copy(of_columns, weights_);
    else if (of_columns.rows() > 0)
      multiply(1.0, Op::transposed, visit.coordinates, Op::plain, of_columns, 0.0, weights_);
    has_weights_ = max_abs(weights_) > 0.0;
  }

  sfdae_hybrid& hybrid_;
  const Functionals functionals_;
  int n_, count_;
  Matrix gradient_;
  Matrix weights_;  // of S where a visit ends
  bool has_weights_ = false;
  double end_ = 0.0;
};

CallResult find_gradient(sfdae_hybrid& hybrid, const BackwardRun::Functionals& functionals, double* gradient) {
  BackwardRun backward(hybrid, functionals);
  CallResult result = backward.read();
  sfdae_solver& solver = *hybrid.mode().solver;
  if (!hybrid.kept.visits.empty()) {
    solver.set_limits(solver.integration->start(), hybrid.run.direction());
    solver.integration->keep_to_last_piece();
  }
  if (result.status < 0 || result.status == SFDAE_STOPPED) return result;
  const Matrix& found = backward.gradient();
  const std::size_t size = index(found.rows()) * index(found.cols());
  if (!all_finite(found.data(), size))
    return {SFDAE_NOT_FINITE, "the gradient overflows: rescale the problem or the weights."};
  std::copy_n(found.data(), size, gradient);
  return result;
}

}  // namespace

CallResult find_columns(sfdae_hybrid& hybrid, bool at_once, Vector& columns) {
  HybridRun& run = hybrid.run;
  sfdae_solver* solver = hybrid.mode().solver;
  if (at_once) {
    columns = solver->integration->adjoint()->values_at_start();
    return {};
  }
  TangentSpace& space = hybrid.kept.ending;
  space = {};
  const int status = guarded(solver, [&] { return solver->integration->end_at(run.t, space); });
  if (status < 0) return of_mode(hybrid, run.mode, status);
  const int n = solver->model.n(), count = static_cast<int>(hybrid.sensitivities->names.size());
  const int unknowns = space.is_whole() ? n : space.basis.cols();
  Matrix all(n, count + unknowns);
  copy(space.offset.view().columns(0, count), all.view().columns(0, count));
  const View of_basis = all.view().columns(count, unknowns);
  if (!space.is_whole()) copy(space.basis, of_basis);
  for (int i = 0; i < unknowns && space.is_whole(); ++i) of_basis(i, i) = 1.0;
  columns.assign(all.data(), all.data() + index(n) * index(all.cols()));
  run.shifts.assign(index(all.cols()), 0.0);
  return {};
}

void keep_visit(sfdae_hybrid& hybrid, bool at_once) {
  if (!hybrid.sensitivities || !hybrid.sensitivities->by_adjoint || at_once) return;
  HybridRun& run = hybrid.run;
  sfdae_solver& solver = *hybrid.mode().solver;
  std::vector<KeptVisit>& visits = hybrid.kept.visits;
  visits.push_back({run.mode, solver_of(hybrid.mode()), run.entered, run.t, solver.model.shared_system(),
                    solver.follows_structure(), parameters_of(solver), nullptr, hybrid.kept.ending.is_whole(),
                    std::move(hybrid.kept.ending.coordinates)});
  KeptVisit& visit = visits.back();
  hybrid.kept.ending = {};
  visit.integration = std::move(solver.integration);
  visit.integration->keep_steps_alone();
}

}  // namespace sfdae::core

using namespace sfdae::core;

extern "C" {

int sfdae_get_hybrid_gradient(sfdae_hybrid* hybrid, int num_times, const double* t, int num_functionals,
                              const double* weights, double* gradient) {
  return guarded(hybrid, [&]() -> CallResult {
    if (t == nullptr || weights == nullptr || gradient == nullptr)
      return illegal_argument("t, weights and gradient must not be NULL.");
    if (!hybrid->is_running() || hybrid->mode().solver->integration->adjoint() == nullptr)
      return {SFDAE_NOT_STARTED,
              "no steps are kept: call sfdae_set_hybrid_sensitivities with the option adjoint = 1, and "
              "sfdae_start_hybrid, first."};
    const CallResult checked = check_functionals({hybrid->n(), num_times, t, num_functionals, weights});
    if (checked.status != SFDAE_OK) return checked;
    return find_gradient(*hybrid, {num_times, t, num_functionals, weights}, gradient);
  });
}

}  // extern "C"
