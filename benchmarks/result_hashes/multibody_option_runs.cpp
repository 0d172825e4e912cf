// SPDX-License-Identifier: BSD-3-Clause
// Multibody systems: options, initial values, redundancy, singular configurations, kinematics, callbacks that fail,
// checks of derivatives, parameters.
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "multibody/four_bar.h"
#include "session.h"
#include "test_set/pendulum.h"

namespace sfdae_bench {

namespace {

using namespace sfdae_test;

using Change = std::function<void(sfdae_options&)>;
constexpr int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU};
constexpr double inf = std::numeric_limits<double>::infinity();

// Functions of a system as closures. Those that are empty are not given.
struct Functions {
  using Position = std::function<int(double t, const double* q, double* result)>;
  using Velocity = std::function<int(double t, const double* q, const double* v, double* result)>;
  int positions = 2, velocities = 0, holonomic = 1, nonholonomic = 0;
  int coordinates = SFDAE_COORDINATES_ORTHOGONAL;
  Velocity forces;
  Position constraints, jacobian, mass, rate, kinematics, matrix, offset;
  Velocity curvature, nonholonomic_curvature;

  template <Position Functions::*function>
  static int position(double t, const double* q, double* result, void* user) {
    return (static_cast<const Functions*>(user)->*function)(t, q, result);
  }
  template <Velocity Functions::*function>
  static int velocity(double t, const double* q, const double* v, double* result, void* user) {
    return (static_cast<const Functions*>(user)->*function)(t, q, v, result);
  }
};

Problem problem_of(const Functions& functions, double tf, std::vector<double> guess) {
  using F = Functions;
  auto owner = std::make_shared<Functions>(functions);
  sfdae_multibody_problem c;
  sfdae_multibody_problem_init(&c, sizeof c);
  c.num_positions = functions.positions;
  if (functions.velocities > 0) c.num_velocities = functions.velocities;
  c.num_constraints = functions.holonomic;
  c.num_nonholonomic = functions.nonholonomic;
  c.coordinates = functions.coordinates;
  if (functions.forces) c.forces = F::velocity<&F::forces>;
  if (functions.constraints) c.constraints = F::position<&F::constraints>;
  if (functions.jacobian) c.constraint_jacobian = F::position<&F::jacobian>;
  if (functions.mass) c.mass = F::position<&F::mass>;
  if (functions.rate) c.constraint_rate = F::position<&F::rate>;
  if (functions.kinematics) c.kinematics = F::position<&F::kinematics>;
  if (functions.matrix) c.nonholonomic_matrix = F::position<&F::matrix>;
  if (functions.offset) c.nonholonomic_offset = F::position<&F::offset>;
  if (functions.curvature) c.constraint_curvature = F::velocity<&F::curvature>;
  if (functions.nonholonomic_curvature) c.nonholonomic_curvature = F::velocity<&F::nonholonomic_curvature>;
  c.user = owner.get();
  Problem problem{c, owner, 0.0, tf, {}};
  guess.resize(size(problem.n()), 0.0);
  return problem.from(std::move(guess));
}

// Pendulum of length 1, its constraint repeated.
Functions pendulum_functions(int copies = 1, double offset = 0.0) {
  Functions f;
  f.holonomic = copies;
  f.forces = [](double, const double*, const double*, double* out) { return out[1] = -1.0, 0; };
  f.constraints = [=](double, const double* q, double* g) {
    for (int i = 0; i < copies; ++i) g[i] = 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0);
    return g[copies - 1] += offset, 0;
  };
  f.jacobian = [=](double, const double* q, double* G) {
    for (int i = 0; i < copies; ++i) G[i] = q[0], G[i + copies] = q[1];
    return 0;
  };
  f.curvature = [=](double, const double*, const double* v, double* gamma) {
    for (int i = 0; i < copies; ++i) gamma[i] = v[0] * v[0] + v[1] * v[1];
    return 0;
  };
  return f;
}
const std::vector<double> pendulum_start = {std::sin(1.0), -std::cos(1.0), 0.5 * std::cos(1.0), 0.5 * std::sin(1.0),
                                            0.25 + std::cos(1.0)};

void add(Runs& runs, const std::string& name, const Problem& problem, const Change& change = nullptr,
         const Plan& plan = {}) {
  for (const int method : methods) {
    sfdae_options options = options_of(method);
    if (change) change(options);
    runs.push_back(
        {"multibody_" + name + "_" + name_of(method), [=](Trace& trace) { solve(trace, problem, options, plan); }});
  }
}

void add_options(Runs& runs) {
  const Problem problem = problem_of(pendulum_functions(), 3.0, pendulum_start);
  const auto option = [&](const std::string& name, const Change& change, const Plan& plan = {}) {
    add(runs, "option_" + name, problem, change, plan);
  };
  option("none", nullptr, {.checkpoint = true, .events = true});
  option("tol_3", [](sfdae_options& o) { o.rtol = o.atol = 1e-3; });
  option("tol_11", [](sfdae_options& o) { o.rtol = o.atol = 1e-11; });
  option("max_index", [](sfdae_options& o) { o.max_index = 1; });
  option("many_outputs", nullptr, {.outputs = 120, .checkpoint = true});
  option("steps", nullptr, {.by_steps = true});
  option("stop_time", [](sfdae_options& o) { o.use_stop_time = 1, o.stop_time = 3.0; });
  option("max_steps", [](sfdae_options& o) { o.max_steps = 6; });
  option("max_step", [](sfdae_options& o) { o.max_step = 0.05; });
  option("order_2", [](sfdae_options& o) { o.max_order = 2, o.max_stages = 3; });
  option("automatic", [](sfdae_options& o) { o.method = SFDAE_METHOD_AUTOMATIC; }, {.outputs = 60});
  add(runs, "option_backward", problem.on(1.0, -1.0), nullptr, {.checkpoint = true, .events = true});
}

void add_initial_values(Runs& runs) {
  static const int first[] = {1, 0, 0, 0, 0}, all[] = {1, 1, 1, 1, 1}, force[] = {0, 0, 0, 0, 1};
  static const double weights[] = {1.0, 5.0, 1.0, 3.0, 1.0};
  Functions heavy = pendulum_functions();
  heavy.mass = [](double, const double*, double* M) { return M[0] = 1.0, M[3] = 50.0, 0; };
  Functions skewed = pendulum_functions();
  skewed.mass = [](double, const double*, double* M) { return M[0] = M[3] = 2.0, M[1] = 0.5, 0; };
  const std::vector<double> far = {2.0, -1.0, 1.0, 0.3, 5.0};
  const auto values = [&](const std::string& name, const Functions& functions, const std::vector<double>& guess,
                          int mode, const int* fixed = nullptr, const double* weight = nullptr) {
    const Problem problem = problem_of(functions, 1.0, guess);
    sfdae_options options = options_of();
    options.initial_values = mode;
    options.fixed = fixed;
    options.initial_weights = weight;
    runs.push_back({"multibody_initial_" + name, [=](Trace& trace) {
                      solve(trace, problem, options, {.outputs = 1});
                      Session session(trace, problem, options);
                      session.make_consistent(0.0, problem.x0);
                      session.analyze_at(0.0, -1.0);
                      session.describe();
                    }});
  };
  values("near", pendulum_functions(), pendulum_start, SFDAE_INITIAL_NEAREST);
  values("far", pendulum_functions(), far, SFDAE_INITIAL_NEAREST);
  values("heavy", heavy, far, SFDAE_INITIAL_NEAREST);
  values("skewed", skewed, far, SFDAE_INITIAL_NEAREST);
  values("weights", pendulum_functions(), far, SFDAE_INITIAL_NEAREST, nullptr, weights);
  values("fixed", pendulum_functions(), {0.6, -0.9, 0.1, 0.1}, SFDAE_INITIAL_FIXED, first);
  values("fixed_impossible", pendulum_functions(), far, SFDAE_INITIAL_FIXED, first);
  values("fixed_all", pendulum_functions(), far, SFDAE_INITIAL_FIXED, all);
  values("fixed_force", pendulum_functions(), pendulum_start, SFDAE_INITIAL_FIXED, force);
  values("accept", pendulum_functions(), pendulum_start, SFDAE_INITIAL_ACCEPT);
  values("accept_wrong", pendulum_functions(), far, SFDAE_INITIAL_ACCEPT);
  values("center", pendulum_functions(), {0.0, 0.0}, SFDAE_INITIAL_NEAREST);
  values("nan", pendulum_functions(), {0.0, std::nan("")}, SFDAE_INITIAL_NEAREST);
}

void add_redundancy(Runs& runs) {
  for (const int copies : {2, 4})
    add(runs, "copies_" + std::to_string(copies), problem_of(pendulum_functions(copies), 2.0, pendulum_start),
        nullptr, {.checkpoint = true, .events = true});
  for (const double offset : {1e-12, 1e-6, 1e-2})
    for (const bool ignored : {false, true})
      add(runs, "offset_" + std::to_string(static_cast<int>(-std::log10(offset))) + (ignored ? "_ignored" : ""),
          problem_of(pendulum_functions(2, offset), 1.0, pendulum_start),
          [=](sfdae_options& o) { o.ignore_inconsistency = ignored ? 1 : 0; });
  Functions late = pendulum_functions(2);
  late.constraints = [](double t, const double* q, double* g) {
    g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0);
    g[1] = g[0] - (t > 1.0 ? 0.5 * (t - 1.0) * (t - 1.0) * (t - 1.0) : 0.0);
    return 0;
  };
  late.rate = [](double t, const double*, double* g_t) {
    return g_t[1] = t > 1.0 ? -1.5 * (t - 1.0) * (t - 1.0) : 0.0, 0;
  };
  late.curvature = nullptr;
  add(runs, "late_contradiction", problem_of(late, 3.0, pendulum_start));
  for (const double small : {3e-13, 1e-10, 1e-4})
    for (const double rank_tol : {0.0, 1e-6}) {
      Functions near = pendulum_functions(2);
      near.positions = 3;
      near.jacobian = [=](double, const double* q, double* G) {
        G[0] = G[1] = q[0], G[2] = G[3] = q[1], G[5] = small;
        return 0;
      };
      near.constraints = [=](double, const double* q, double* g) {
        g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0);
        return g[1] = g[0] + small * q[2], 0;
      };
      near.curvature = nullptr;
      add(runs,
          "nearly_redundant_" + std::to_string(static_cast<int>(-std::log10(small))) + (rank_tol > 0.0 ? "_tol" : ""),
          problem_of(near, 1.0, {0.6, -0.8}), [=](sfdae_options& o) { o.rank_tol = rank_tol; });
    }
}

Functions crank_and_rod(double rod) {
  Functions f;
  f.forces = [](double, const double*, const double*, double*) { return 0; };
  f.constraints = [=](double, const double* q, double* g) { return g[0] = std::sin(q[0]) + rod * std::sin(q[1]), 0; };
  f.jacobian = [=](double, const double* q, double* G) {
    return G[0] = std::cos(q[0]), G[1] = rod * std::cos(q[1]), 0;
  };
  return f;
}

void add_singular_configurations(Runs& runs) {
  add(runs, "singular_passed", problem_of(crank_and_rod(1.0001), 3.0, {0.1, -0.1, 1.0, -1.0}), nullptr,
      {.checkpoint = true});
  add(runs, "singular_met", problem_of(crank_and_rod(1.0), 3.0, {0.1, -0.1, 1.0, -1.0}));
  const double upright = std::acos(0.0);
  add(runs, "singular_start", problem_of(crank_and_rod(1.0), 3.0, {upright, -upright, 1.0, -1.0}));
  Functions squared = pendulum_functions();
  squared.constraints = [](double, const double* q, double* g) {
    const double c = q[0] * q[0] + q[1] * q[1] - 1.0;
    return g[0] = c * c, 0;
  };
  squared.jacobian = [](double, const double* q, double* G) {
    const double c = q[0] * q[0] + q[1] * q[1] - 1.0;
    return G[0] = 4.0 * c * q[0], G[1] = 4.0 * c * q[1], 0;
  };
  squared.curvature = nullptr;
  add(runs, "squared_constraint", problem_of(squared, 1.0, pendulum_start));
  Functions massless = pendulum_functions();
  massless.mass = [](double, const double*, double* M) { return M[0] = 1.0, 0; };
  add(runs, "mass_singular", problem_of(massless, 1.0, pendulum_start));
  massless.mass = [](double, const double*, double*) { return 0; };
  add(runs, "mass_zero", problem_of(massless, 1.0, pendulum_start));
}

Functions bead(std::vector<double> wrong = {0.0, 0.0, 0.0, 0.0}) {
  Functions f;
  f.nonholonomic = 1;
  f.forces = [](double, const double*, const double*, double*) { return 0; };
  f.constraints = [](double t, const double* q, double* g) {
    return g[0] = q[0] * std::sin(t) - q[1] * std::cos(t), 0;
  };
  f.jacobian = [=](double t, const double*, double* G) {
    return G[0] = std::sin(t), G[1] = wrong[0] - std::cos(t), 0;
  };
  f.rate = [=](double t, const double* q, double* g_t) {
    return g_t[0] = q[0] * std::cos(t) + q[1] * std::sin(t) + wrong[1], 0;
  };
  f.curvature = [=](double t, const double* q, const double* v, double* gamma) {
    gamma[0] = 2.0 * (v[0] * std::cos(t) + v[1] * std::sin(t)) - q[0] * std::sin(t) + q[1] * std::cos(t) + wrong[2];
    return 0;
  };
  f.matrix = [](double, const double* q, double* H) { return H[0] = q[0], H[1] = q[1], 0; };
  f.offset = [](double t, const double*, double* h) { return h[0] = -t, 0; };
  f.nonholonomic_curvature = [=](double, const double*, const double* v, double* eta) {
    return eta[0] = v[0] * v[0] + v[1] * v[1] - 1.0 + wrong[3], 0;
  };
  return f;
}

void add_other_systems(Runs& runs) {
  // A symmetric top in Euler parameters.
  Functions top;
  top.positions = 4, top.velocities = 3;
  top.mass = [](double, const double*, double* M) { return M[0] = M[4] = 1.0, M[8] = 2.0, 0; };
  top.forces = [](double, const double*, const double* w, double* f) {
    return f[0] = -w[1] * w[2], f[1] = w[0] * w[2], 0;
  };
  top.kinematics = [](double, const double* q, double* S) {
    const double rows[3][4] = {{-q[1], q[0], q[3], -q[2]}, {-q[2], -q[3], q[0], q[1]}, {-q[3], q[2], -q[1], q[0]}};
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 4; ++i) S[i + 4 * j] = 0.5 * rows[j][i];
    return 0;
  };
  top.constraints = [](double, const double* q, double* g) {
    return g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1.0), 0;
  };
  top.jacobian = [](double, const double* q, double* G) {
    for (int i = 0; i < 4; ++i) G[i] = q[i];
    return 0;
  };
  add(runs, "top", problem_of(top, 2.0, {1.0, 0.0, 0.0, 0.0, 0.3, 0.0, 1.2}), nullptr,
      {.checkpoint = true, .events = true});
  top.coordinates = SFDAE_COORDINATES_PERMUTATION;
  add(runs, "top_permuted", problem_of(top, 2.0, {1.0, 0.0, 0.0, 0.0, 0.3, 0.0, 1.2}));

  add(runs, "bead", problem_of(bead(), 0.5, {0.6, 0.7, 1.5, -2.0}).on(0.3, 1.0));
  Functions driven = pendulum_functions();
  driven.positions = 1;
  driven.forces = [](double, const double*, const double*, double*) { return 0; };
  driven.constraints = [](double t, const double* q, double* g) { return g[0] = q[0] - std::cos(t), 0; };
  driven.jacobian = [](double, const double*, double* G) { return G[0] = 1.0, 0; };
  driven.rate = [](double t, const double*, double* g_t) { return g_t[0] = std::sin(t), 0; };
  driven.curvature = nullptr;
  add(runs, "driven", problem_of(driven, 4.0, {0.9, 0.0, 0.0}).on(0.5, 4.0), nullptr, {.events = true});
  Functions oscillator;
  oscillator.positions = 1, oscillator.holonomic = 0;
  oscillator.forces = [](double, const double* q, const double*, double* f) { return f[0] = -q[0], 0; };
  add(runs, "oscillator", problem_of(oscillator, 3.0, {1.0, 0.0}), nullptr, {.checkpoint = true, .events = true});
  Functions knife;
  knife.positions = 3, knife.holonomic = 0, knife.nonholonomic = 1;
  knife.forces = [](double, const double*, const double*, double* f) { return f[0] = 1.0, 0; };
  knife.matrix = [](double, const double* q, double* H) { return H[0] = std::sin(q[2]), H[1] = -std::cos(q[2]), 0; };
  add(runs, "knife_by_differences", problem_of(knife, 2.0, {0.0, 0.0, 0.0, 0.0, 0.0, 1.5}));
}

void add_failing_callbacks(Runs& runs) {
  const auto with_forces = [&runs](const std::string& name, const Functions::Velocity& forces) {
    Functions f = pendulum_functions();
    f.forces = forces;
    add(runs, "forces_" + name, problem_of(f, 2.0, pendulum_start));
  };
  with_forces("fail", [](double t, const double*, const double*, double*) { return t > 0.7 ? 1 : 0; });
  with_forces("stop", [](double t, const double*, const double*, double*) { return t > 0.7 ? -3 : 0; });
  with_forces("nan", [](double t, const double*, const double*, double* f) {
    return f[0] = t > 0.7 ? std::nan("") : 0.0, 0;
  });
  Functions f = pendulum_functions();
  f.jacobian = [](double, const double*, double*) { return 1; };
  add(runs, "jacobian_fails", problem_of(f, 2.0, pendulum_start));
  f = pendulum_functions();
  f.constraints = [](double t, const double* q, double* g) {
    return g[0] = t > 0.5 ? inf : 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0), 0;
  };
  add(runs, "constraint_infinite", problem_of(f, 2.0, pendulum_start));
  f = pendulum_functions();
  f.curvature = [](double t, const double*, const double* v, double* gamma) {
    return gamma[0] = v[0] * v[0] + v[1] * v[1], t > 0.7 ? -1 : 0;
  };
  add(runs, "curvature_stops", problem_of(f, 2.0, pendulum_start));
}

void add_derivative_checks(Runs& runs) {
  for (std::size_t i = 0; i <= 4; ++i)
    runs.push_back({"check_multibody_" + std::to_string(i), [=](Trace& trace) {
                      std::vector<double> wrong(5, 0.0);
                      wrong[i] = 1e-4;
                      const Problem problem = problem_of(bead(wrong), 1.0, {0.6, 0.7, 1.5, -2.0});
                      Session session(trace, problem, options_of());
                      const double q[] = {0.6, 0.7}, v[] = {1.5, -2.0}, bad[] = {0.0, inf};
                      for (const double* velocity : {v, bad}) {
                        sfdae_derivative_check check;
                        sfdae_derivative_check_init(&check, sizeof check);
                        session.called("check",
                                       sfdae_check_multibody_derivatives(session.solver(), 0.3, q, velocity, &check));
                        trace_check(trace, check);
                      }
                    }});
}

struct DrivenPendulum : MechanicalSystem {
  DrivenPendulum() : MechanicalSystem({2, 1, 0}) {}
  template <class V>
  void mass(const V&, const V*, V* M) const {
    M[0] = M[3] = V(1.0);
  }
  template <class V>
  void force(const V& t, const V*, const V* v, V* f) const {
    using std::sin;
    f[0] = sin(t) - 0.1 * v[0];
    f[1] = V(-1.0);
  }
  template <class V>
  void constraints(const V& t, const V* q, V* g) const {
    using std::sin;
    const V x = q[0] - 0.2 * sin(2.0 * t);
    g[0] = x * x + q[1] * q[1] - 1.0;
  }
  template <class V>
  void gradient(const V& t, const V* q, V* G) const {
    using std::sin;
    G[0] = 2.0 * (q[0] - 0.2 * sin(2.0 * t));
    G[1] = 2.0 * q[1];
  }
};

void add_sequences(Runs& runs) {
  for (const Form form : {Form::recorded, Form::callbacks, Form::general, Form::extended})
    add(runs, "moving_pivot_" + std::to_string(static_cast<int>(form)),
        mechanical_problem(DrivenPendulum(), form, 0.0, 1.5, {0.6, -0.8, 0.0, 0.0}), nullptr,
        {.checkpoint = true, .events = true});
  for (const int method : methods)
    runs.push_back({std::string("multibody_sequence_") + name_of(method), [=](Trace& trace) {
                      const Problem problem = problem_of(pendulum_functions(2), 3.0, pendulum_start);
                      Session session(trace, problem, options_of(method));
                      session.advance(1.0);
                      session.describe();
                      session.start();
                      session.stop_after = 6;
                      session.outputs(1.0, 2);
                      session.stop_after = 0;
                      sfdae_statistics s;
                      sfdae_statistics_init(&s, sizeof s);
                      sfdae_get_statistics(session.solver(), &s);
                      for (const double part : {0.0, 0.4, 1.0})
                        session.interpolate(s.t_internal - (1.0 - part) * s.last_step);
                      std::vector<double> pushed = session.x;
                      pushed[2] += 1.0;
                      session.make_consistent(1.0, pushed);
                      session.start(1.0, 3.0, pushed);
                      session.outputs(2.0, 3);
                      session.set_options(options_of(SFDAE_METHOD_RADAU - method, 1e-9));
                      session.outputs(2.5, 2);
                      session.inspect(2.0, 1);
                      session.start(2.5, 0.0, session.x);
                      session.outputs(2.0, 2);
                      session.describe();
                    }});
}

}  // namespace

void add_multibody_option_runs(Runs& runs) {
  add_options(runs);
  add_initial_values(runs);
  add_redundancy(runs);
  add_singular_configurations(runs);
  add_other_systems(runs);
  add_failing_callbacks(runs);
  add_derivative_checks(runs);
  add_sequences(runs);
}

}  // namespace sfdae_bench
