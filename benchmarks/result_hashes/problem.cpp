// SPDX-License-Identifier: BSD-3-Clause
#include "problem.h"

#include <algorithm>

namespace sfdae_bench {

namespace {

// Several kinds of problems in one visit.
int create_c(sfdae_solver** s, const sfdae_linear_problem* p, const sfdae_options* o) {
  return sfdae_create_linear(s, p, o);
}
int create_c(sfdae_solver** s, const sfdae_nonlinear_problem* p, const sfdae_options* o) {
  return sfdae_create_nonlinear(s, p, o);
}
int create_c(sfdae_solver** s, const sfdae_multibody_problem* p, const sfdae_options* o) {
  return sfdae_create_multibody(s, p, o);
}
int check_c(const sfdae_linear_problem* p, const sfdae_options* o, char* text, std::size_t length) {
  return sfdae_check_linear(p, o, text, length);
}
int check_c(const sfdae_nonlinear_problem* p, const sfdae_options* o, char* text, std::size_t length) {
  return sfdae_check_nonlinear(p, o, text, length);
}
int check_c(const sfdae_multibody_problem* p, const sfdae_options* o, char* text, std::size_t length) {
  return sfdae_check_multibody(p, o, text, length);
}
int unknowns(const sfdae_linear_problem& p) { return p.num_unknowns; }
int unknowns(const sfdae_nonlinear_problem& p) { return p.num_unknowns; }
int unknowns(const sfdae_multibody_problem& p) {
  return p.num_positions + (p.num_velocities > 0 ? p.num_velocities : p.num_positions) + p.num_constraints +
         p.num_nonholonomic;
}

struct LinearOwner {
  LinearFunction function;
  std::vector<int> prescribed;
  template <char which>
  static int call(double t, int order, double* values, void* user) {
    return static_cast<const LinearOwner*>(user)->function(which, t, order, values);
  }
};

struct RecordedOwner {
  int m, n;
  RecordedFunction function;
  std::vector<int> differentiations, prescribed;
  std::function<double(double)> value;

  static int record(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                    sfdae_expression* residual, void* user) {
    const auto& self = *static_cast<const RecordedOwner*>(user);
    const std::vector<Expression> unknowns(x, x + self.n), slopes(xdot, xdot + self.n);
    std::vector<Expression> F(residual, residual + self.m);
    self.function(record, Expression(t), unknowns.data(), slopes.data(), F.data());
    std::transform(F.begin(), F.end(), residual, [](const Expression& e) { return e.c(); });
    return 0;
  }
  static int prescribe(double t, int, double* values, void* user) {
    values[0] = static_cast<const RecordedOwner*>(user)->value(t);
    return 0;
  }
};

int call_total_derivative(double t, int order, const double* derivatives, double* F, double* F_x, double* F_xdot,
                          void* user) {
  return (*static_cast<const TotalDerivative*>(user))(t, order, derivatives, F, F_x, F_xdot);
}

}  // namespace

int Problem::n() const {
  return std::visit([](const auto& problem) { return unknowns(problem); }, c);
}

int Problem::create(sfdae_solver** solver, const sfdae_options* options) const {
  return std::visit([&](const auto& problem) { return create_c(solver, &problem, options); }, c);
}

std::pair<int, std::string> Problem::check(const sfdae_options* options) const {
  char text[1024] = "";
  const int status =
      std::visit([&](const auto& problem) { return check_c(&problem, options, text, sizeof text); }, c);
  return {status, text};
}

Problem linear_problem(int m, int n, LinearFunction function, std::vector<int> prescribed) {
  auto owner = std::make_shared<LinearOwner>(LinearOwner{std::move(function), std::move(prescribed)});
  sfdae_linear_problem c;
  sfdae_linear_problem_init(&c, sizeof c);
  c.num_equations = m;
  c.num_unknowns = n;
  c.E = LinearOwner::call<'E'>;
  c.A = LinearOwner::call<'A'>;
  c.f = LinearOwner::call<'f'>;
  if (!owner->prescribed.empty()) {
    c.num_prescribed = static_cast<int>(owner->prescribed.size());
    c.prescribed = owner->prescribed.data();
    c.prescribed_values = LinearOwner::call<'p'>;
  }
  c.user = owner.get();
  return {c, owner, 0.0, 1.0, std::vector<double>(size(n), 0.0)};
}

Problem family_problem(const Family& family, double t0, double tf, const Interference& interference,
                       std::vector<int> prescribed) {
  const int n = family->n();
  LinearFunction function = [family, interference, prescribed, n](char which, double t, int order, double* values) {
    if (order > sfdae_test::max_family_order) return SFDAE_ORDER_NOT_AVAILABLE;
    if (which == 'E') family->E(t, order, values);
    if (which == 'A') family->A(t, order, values);
    if (which == 'f') family->f(t, order, values);
    if (which == 'p') {
      std::vector<double> x(size(n));
      family->exact(t, x.data(), nullptr);
      for (std::size_t i = 0; i < prescribed.size(); ++i) values[i] = x[size(prescribed[i])];
    }
    return interference ? interference(which, t, order, values) : 0;
  };
  Problem problem = linear_problem(family->m(), n, std::move(function), prescribed).on(t0, tf);
  std::fill(problem.x0.begin(), problem.x0.end(), 1.0);
  if (family->has_exact()) family->exact(t0, problem.x0.data(), nullptr);
  return problem;
}

Problem constant_family_problem(const Family& family, double t0, double tf) {
  Problem problem = family_problem(family, t0, tf);
  problem.linear().constant_E = family->constant_E() ? 1 : 0;
  problem.linear().constant_A = family->constant_A() ? 1 : 0;
  return problem;
}

Problem recorded_problem(int m, int n, RecordedFunction function, std::vector<int> differentiations,
                         std::vector<int> prescribed, std::function<double(double t)> value) {
  auto owner = std::make_shared<RecordedOwner>(
      RecordedOwner{m, n, std::move(function), std::move(differentiations), std::move(prescribed), std::move(value)});
  sfdae_nonlinear_problem c;
  sfdae_nonlinear_problem_init(&c, sizeof c);
  c.num_equations = m;
  c.num_unknowns = n;
  c.equations = RecordedOwner::record;
  if (!owner->differentiations.empty()) c.differentiations = owner->differentiations.data();
  if (!owner->prescribed.empty()) {
    c.num_prescribed = static_cast<int>(owner->prescribed.size());
    c.prescribed = owner->prescribed.data();
    c.prescribed_values = RecordedOwner::prescribe;
  }
  c.user = owner.get();
  return {c, owner, 0.0, 1.0, std::vector<double>(size(n), 0.0)};
}

Problem derivative_problem(int m, int n, TotalDerivative function) {
  auto owner = std::make_shared<TotalDerivative>(std::move(function));
  sfdae_nonlinear_problem c;
  sfdae_nonlinear_problem_init(&c, sizeof c);
  c.num_equations = m;
  c.num_unknowns = n;
  c.total_derivative = call_total_derivative;
  c.user = owner.get();
  return {c, owner, 0.0, 1.0, std::vector<double>(size(n), 0.0)};
}

sfdae_options options_of(int method, double tol) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.method = method;
  options.rtol = options.atol = tol;
  return options;
}

}  // namespace sfdae_bench
