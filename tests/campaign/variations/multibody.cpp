// Masses with friction as a mechanical system, each on an axis or held on a line in the plane.
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "system.h"

namespace campaign {

namespace {

class Multibody final : public System {
 public:
  Multibody(const Case& problem, const Variant& variant, const std::vector<std::unique_ptr<Reference>>& references)
      : System(problem, variant, references) {
    for (const SmallProblem& data : problem.copies) {
      recorded_.emplace_back(*data.formulas, std::vector<Formula>{data.f[1]}, Purpose::recording);
      force_.emplace_back(*data.formulas, std::vector<Formula>{data.f[1]});
    }
  }

  int size() const override { return (problem_.on_line ? 5 : 2) * problem_.num_copies; }
  int create(sfdae_solver** solver, const sfdae_options& options) override;
  std::vector<double> start() const override {
    return assembled(0.0, [&](int k) { return reference(k).start(); });
  }
  std::vector<double> solution(std::size_t output) const override {
    return assembled(problem_.outputs[output], [&](int k) { return reference(k).values()[output]; });
  }
  std::vector<double> sizes() const override {
    std::vector<double> result = assembled(0.0, [&](int k) { return reference(k).sizes(); });
    for (double& size : result) size = std::abs(size);
    return result;
  }
  std::vector<double> perturbed(std::size_t output, double rtol, const std::vector<double>& atol) const override;
  std::string text() const override;

 private:
  int dimension() const { return problem_.on_line ? 2 : 1; }
  double direction(int i) const { return problem_.on_line ? (i == 0 ? 0.8 : 0.6) : 1.0; }
  double normal(int i) const { return i == 0 ? -0.6 : 0.8; }
  // The force along the normal, which the constraint takes.
  static double load(double t) { return 1.0 + 0.5 * std::sin(t); }
  double force_unit(int k) const { return unit(k) / (variant_.time_unit * variant_.time_unit); }
  template <class Values>
  std::vector<double> assembled(double t, Values values) const;
  int record(sfdae_expression t, const sfdae_expression* q, const sfdae_expression* v,
             const sfdae_multibody_formulas& formulas) const;
  void write_forces(double t, const double* q, const double* v, double* f) const;
  void set_callbacks(sfdae_multibody_problem& problem) const;

  std::vector<Program> recorded_, force_;
};

template <class Values>
std::vector<double> Multibody::assembled(double t, Values values) const {
  const int N = problem_.num_copies, D = dimension();
  std::vector<double> result(static_cast<std::size_t>(size()));
  for (int k = 0; k < N; ++k) {
    const std::vector<double>& x = values(k);
    for (int i = 0; i < D; ++i) {
      result[static_cast<std::size_t>(k * D + i)] = unit(k) * direction(i) * x[0];
      result[static_cast<std::size_t>((N + k) * D + i)] = unit(k) / variant_.time_unit * direction(i) * x[1];
    }
    if (problem_.on_line) result[static_cast<std::size_t>(2 * N * D + k)] = force_unit(k) * load(t);
  }
  return result;
}

std::vector<double> Multibody::perturbed(std::size_t output, double rtol, const std::vector<double>& atol) const {
  const int N = problem_.num_copies, D = dimension();
  std::vector<double> result = assembled(0.0, [&](int k) {
    const double U = unit(k) * direction(0), T = variant_.time_unit;
    return reference(k).perturbed(
        output, rtol,
        {atol[static_cast<std::size_t>(k * D)] / U, atol[static_cast<std::size_t>((N + k) * D)] * T / U});
  });
  for (int k = 0; problem_.on_line && k < N; ++k) result[static_cast<std::size_t>(2 * N * D + k)] = 0.0;
  for (double& entry : result) entry = std::abs(entry);
  return result;
}

std::string Multibody::text() const {
  std::string result =
      problem_.on_line ? "q = s (0.8, 0.6), held on this line, load 1 + 0.5 sin(t) along the normal\n" : "";
  for (std::size_t k = 0; k < problem_.copies.size(); ++k) {
    const SmallProblem& data = problem_.copies[k];
    result += "copy " + std::to_string(k) +
              ", from rest: q' = v, v' = " + data.formulas->text(data.f[1], data.names) + "\n";
  }
  return result;
}

int Multibody::record(sfdae_expression t, const sfdae_expression* q, const sfdae_expression* v,
                      const sfdae_multibody_formulas& formulas) const {
  const int N = problem_.num_copies, D = dimension(), nv = N * D;
  const double T = variant_.time_unit;
  const auto scaled = [](double factor, sfdae_expression a) { return sfdae_multiply(sfdae_number(factor), a); };
  const sfdae_expression s = T == 1.0 ? t : scaled(1.0 / T, t);
  for (int i = 0; i < nv; ++i) formulas.M[i + i * nv] = sfdae_number(1.0);
  for (int k = 0; k < N; ++k) {
    std::vector<sfdae_expression> x = {sfdae_number(0.0), sfdae_number(0.0)};
    for (int i = 0; i < D; ++i) {
      x[0] = sfdae_add(x[0], scaled(direction(i) / unit(k), q[k * D + i]));
      x[1] = sfdae_add(x[1], scaled(direction(i) * T / unit(k), v[k * D + i]));
    }
    const sfdae_expression force = recorded_[data_of(k)].record(s, x, {})[0];
    const sfdae_expression load = sfdae_add(sfdae_number(1.0), scaled(0.5, sfdae_sin(s)));
    for (int i = 0; i < D; ++i) {
      const sfdae_expression along = scaled(force_unit(k) * direction(i), force);
      formulas.f[k * D + i] = problem_.on_line ? sfdae_add(along, scaled(force_unit(k) * normal(i), load)) : along;
    }
    if (problem_.on_line) formulas.g[k] = sfdae_add(scaled(normal(0), q[k * D]), scaled(normal(1), q[k * D + 1]));
  }
  return 0;
}

void Multibody::write_forces(double t, const double* q, const double* v, double* f) const {
  const int D = dimension();
  const double T = variant_.time_unit;
  for (int k = 0; k < problem_.num_copies; ++k) {
    std::array<double, 2> x = {0.0, 0.0};
    for (int i = 0; i < D; ++i) {
      x[0] += direction(i) / unit(k) * q[k * D + i];
      x[1] += direction(i) * T / unit(k) * v[k * D + i];
    }
    double force = 0.0;
    force_[data_of(k)].evaluate(t / T, x.data(), nullptr, &force);
    for (int i = 0; i < D; ++i) {
      f[k * D + i] = force_unit(k) * direction(i) * force;
      if (problem_.on_line) f[k * D + i] += force_unit(k) * normal(i) * load(t / T);
    }
  }
}

void Multibody::set_callbacks(sfdae_multibody_problem& problem) const {
  problem.forces = [](double t, const double* q, const double* v, double* f, void* user) {
    static_cast<Multibody*>(user)->write_forces(t, q, v, f);
    return 0;
  };
  if (!problem_.on_line) return;
  problem.constraints = [](double, const double* q, double* g, void* user) {
    const Multibody& self = *static_cast<Multibody*>(user);
    for (int k = 0; k < self.problem_.num_copies; ++k)
      g[k] = self.normal(0) * q[2 * k] + self.normal(1) * q[2 * k + 1];
    return 0;
  };
  problem.constraint_jacobian = [](double, const double*, double* G, void* user) {
    const Multibody& self = *static_cast<Multibody*>(user);
    const int N = self.problem_.num_copies;
    for (int k = 0; k < N; ++k)
      for (int i = 0; i < 2; ++i) G[k + (2 * k + i) * N] = self.normal(i);
    return 0;
  };
}

int Multibody::create(sfdae_solver** solver, const sfdae_options& options) {
  sfdae_multibody_problem problem;
  sfdae_multibody_problem_init(&problem, sizeof problem);
  problem.num_positions = dimension() * problem_.num_copies;
  problem.num_constraints = problem_.on_line ? problem_.num_copies : 0;
  problem.user = this;
  if (has_callbacks(variant_.formulation)) {
    set_callbacks(problem);
  } else {
    problem.equations = [](sfdae_record*, sfdae_expression t, const sfdae_expression* q, const sfdae_expression* v,
                           const sfdae_multibody_formulas* formulas,
                           void* user) { return static_cast<Multibody*>(user)->record(t, q, v, *formulas); };
  }
  return sfdae_create_multibody(solver, &problem, &options);
}

}  // namespace

std::unique_ptr<System> make_multibody(const Case& problem, const Variant& variant,
                                       const std::vector<std::unique_ptr<Reference>>& references) {
  return std::make_unique<Multibody>(problem, variant, references);
}

}  // namespace campaign
