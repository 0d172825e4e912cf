// SPDX-License-Identifier: BSD-3-Clause
// SFNDAE with all its options and failures.
#include <cmath>
#include <string>
#include <type_traits>

#include "../../tests/nonlinear/random_system.h"
#include "dual_jet.h"
#include "fortran_call.h"
#include "test_set/test_set.h"

namespace sfdae_bench {

namespace {

using namespace sfdae_test;

struct Equations {
  int m, n;
  TotalDerivative derivative;
  std::vector<double> x0;
  double tf = 1.0;
};

template <class Residual>
Equations equations(int m, std::vector<double> x0, double tf, Residual residual) {
  const int n = static_cast<int>(x0.size());
  return {m, n, total_derivative(m, n, residual), std::move(x0), tf};
}

Equations pendulum_equations() {
  return equations(5, pendulum().x0, 1.0, [](const auto& t, auto... a) { pendulum_residual(t, a...); });
}
// x1' = -x1^2, x2' = x1
Equations ode() {
  return equations(2, {1.0, 0.0}, 1.0, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] + x[0] * x[0];
    F[1] = xdot[1] - x[0];
  });
}
// x1' = -x1^2, x2 = x1^2, and again: 3 (x2 - x1^2) = contradiction.
Equations redundant(double contradiction) {
  return equations(3, {1.0, 1.0}, 1.0, [contradiction](const auto&, const auto* x, const auto* xdot, auto* F) {
    const auto gap = x[1] - x[0] * x[0];
    F[0] = xdot[0] + x[0] * x[0];
    F[1] = gap;
    F[2] = 3.0 * gap - contradiction;
  });
}
Equations path_control() {
  return equations(5, {0.1, 0.1, 0.9, 0.9, 0.1}, 1.0, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::sin;
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] - (x[1] - x[0] - sin(x[0]));
    F[3] = xdot[3] - (x[0] - x[1] + x[4]);
    F[4] = x[0] - sin(t);
  });
}
Equations free_component() {
  return equations(1, {1.0, 1.0}, 1.0, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] + x[0] * x[0] - x[1] + 1.0;
  });
}

using Call = SfndaeCall<std::int32_t>;
template <class I>
using Change = std::function<void(SfndaeCall<I>&)>;

template <class I = std::int32_t>
void add(Runs& runs, const std::string& name, const Equations& e,
         const std::type_identity_t<Change<I>>& change = nullptr, int max_index = 3, int max_order = 5) {
  for (const int method : {1, 2})
    runs.push_back({"sfndae_" + name + (method == 1 ? "_bdf" : "_radau"), [=](Trace& trace) {
                      SfndaeCall<I> call(trace, e.m, e.n, e.derivative, method, max_order, max_index);
                      call.x = e.x0;
                      if (change) change(call);
                      integrate(call, e.tf, 3);
                      if (call.ierr < 0) call.call(e.tf);
                    }});
}

void add_problems(Runs& runs) {
  add(runs, "pendulum", pendulum_equations());
  add<std::int64_t>(runs, "pendulum_wide", pendulum_equations());
  add(runs, "ode", ode());
  add(runs, "redundant", redundant(0.0));
  add(runs, "contradiction", redundant(0.1));
  add(runs, "path_control", path_control(), nullptr, 4);
  add(runs, "index_too_high", path_control());
  add(runs, "free_component", free_component());
  add(runs, "car_axis",
      equations(10, car_axis().x0, 0.3, [](const auto& t, auto... a) { car_axis_residual(t, a...); }));
  add(runs, "akzo", equations(6, akzo().x0, 5.0, [](const auto& t, auto... a) { akzo_residual(t, a...); }));
  add(runs, "slider_crank", equations(8, rigid_slider_crank().x0, 0.3, [](const auto& t, auto... a) {
        rigid_slider_crank_residual(t, a...);
      }));
  add(runs, "finite_escape", equations(1, {1.0}, 2.0, [](const auto&, const auto* x, const auto* xdot, auto* F) {
        F[0] = xdot[0] - x[0] * x[0];
      }));
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const RandomSystem system(RandomSystem::random_shape(seed), seed);
    std::vector<double> x, xdot;
    system.exact(0.0, x, xdot);
    add(runs, "random_" + std::to_string(seed),
        equations(system.m(), x, 0.5, [system](const auto& t, const auto* u, const auto* udot, auto* F) {
          system.residual(t, u, udot, F);
        }));
  }
}

void add_options(Runs& runs) {
  const auto option = [&runs](const std::string& name, const Change<std::int32_t>& change, int max_order = 5) {
    add<std::int32_t>(runs, "option_" + name, pendulum_equations(), change, 3, max_order);
  };
  option("vectors", [](Call& c) { c.set(2), c.rtol[3] = 1e-9, c.atol[4] = 1e-3; });
  option("steps", [](Call& c) { c.set(3); });
  option("stop", [](Call& c) { c.real(4, 1, 1.0); });
  option("max_step", [](Call& c) { c.real(7, 2, 0.03); });
  option("first_step", [](Call& c) { c.real(8, 3, 1e-6); });
  option("order_2", nullptr, 2);
  option("consistent", [](Call& c) { c.set(11); });
  option("inconsistent", [](Call& c) { c.set(11), c.x[0] = 0.9; });
  option("keep_differential", [](Call& c) { c.set(12), c.x[1] = 0.05, c.x[4] = 7.0; });
  option("nearest", [](Call& c) { c.x[1] = 0.05, c.x[4] = 7.0; });
  option("max_steps", [](Call& c) { c.integer(14, 20, 5); });
  option("safety", [](Call& c) { c.real(16, 11, 0.5), c.real(16, 12, 4.0), c.real(16, 13, 0.2); });
  option("quotients", [](Call& c) { c.real(17, 14, 0.9), c.real(17, 15, 1.5); });
  option("tolerance_tiny", [](Call& c) { c.tolerance(1e-17); });
  option("tolerance_tight", [](Call& c) { c.tolerance(1e-10); });
  option("start_only", [](Call& c) { c.call(0.0), c.x[1] = 0.1; });
  option("backward", [](Call& c) { c.t = 1.5; });
  option("refused_constant", [](Call& c) { c.set(5); });
  option("refused_info", [](Call& c) { c.info[2] = 2; });
  option("refused_n", [](Call& c) { c.n = 0; });
  option("refused_m", [](Call& c) { c.m = 5001; });
  option("refused_order", [](Call& c) { c.integer(9, 3, 0); });
  option("refused_lrw", [](Call& c) { --c.lrw; });
  option("refused_liw", [](Call& c) { c.liw = 19; });
  option("refused_rtol", [](Call& c) { c.rtol[0] = -1.0; });
  option("refused_method", [](Call& c) { c.method = 0; });
  option("refused_x", [](Call& c) { c.x[2] = std::nan(""); });
  option("refused_state", [](Call& c) { c.call(0.2), c.rwork[45] += 1.0; });
  option("refused_tout", [](Call& c) { c.call(0.2), c.call(0.2); });
}

void add_failures(Runs& runs) {
  const auto failing = [&runs](const std::string& name, int answer, double after, int order_from, double value) {
    Equations e = pendulum_equations();
    const TotalDerivative right = e.derivative;
    e.derivative = [=](double t, int order, const double* jet, double* F, double* F_x, double* F_xdot) {
      right(t, order, jet, F, F_x, F_xdot);
      if (t <= after || order < order_from) return 0;
      F[2] += value;
      return answer;
    };
    add(runs, "failing_" + name, e);
  };
  failing("late", 1, 0.6, 0, 0.0);
  failing("at_start", 1, -1.0, 0, 0.0);
  failing("missing_2", SFDAE_ORDER_NOT_AVAILABLE, -1.0, 2, 0.0);
  failing("missing_3", SFDAE_ORDER_NOT_AVAILABLE, -1.0, 3, 0.0);
  failing("missing_late", SFDAE_ORDER_NOT_AVAILABLE, 0.6, 1, 0.0);
  failing("nan", 0, 0.6, 0, std::nan(""));
  failing("nan_at_start", 0, -1.0, 1, std::nan(""));
  failing("jump", 0, 0.6, 0, 0.5);
}

}  // namespace

void add_sfndae_runs(Runs& runs) {
  add_problems(runs);
  add_options(runs);
  add_failures(runs);
}

}  // namespace sfdae_bench
