// SPDX-License-Identifier: BSD-3-Clause
// Rectifiers and charge pumps in SI units: diodes of 1e-14 A whose conductance ranges over 14 orders, capacitors of
// 1e-15 F beside 1e-6 F. Ranks found at the start hold at all times; no step and no output may say otherwise.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "nonlinear_run.h"

using sfdae::Expression;
using sfdae_test::NonlinearRun;
using sfdae_test::status_text;

namespace {

using Numbers = std::vector<double>;
std::size_t at(int i) { return static_cast<std::size_t>(i); }

constexpr double saturation = 1e-14, thermal = 0.0259;

enum class Kind { resistor, capacitor, diode, source };

// From node a to node b, 0 is ground. value: Ohm, Farad, unused, Volt (V sin(2 pi frequency t + phase)).
struct Element {
  Kind kind;
  int a, b;
  double value, frequency = 0.0, phase = 0.0;
  double voltage(double t, int order) const {
    const double speed = 6.283185307179586 * frequency;
    return value * std::pow(speed, order) * std::sin(speed * t + phase + order * 1.5707963267948966);
  }
};

// Modified nodal analysis: potentials of nodes 1, 2, ..., then currents of sources.
struct Circuit {
  std::string name;
  int nodes;
  std::vector<Element> elements;

  int sources() const {
    return static_cast<int>(
        std::count_if(elements.begin(), elements.end(), [](const Element& e) { return e.kind == Kind::source; }));
  }
  int n() const { return nodes + sources(); }

  void record(const Expression& t, const Expression* x, const Expression* xdot, Expression* F) const {
    for (int i = 0; i < n(); ++i) F[i] = Expression(0.0);
    int current = nodes;
    for (const Element& e : elements) {
      const auto difference = [&](const Expression* v) {
        return e.a == 0 ? -v[e.b - 1] : e.b == 0 ? v[e.a - 1] : v[e.a - 1] - v[e.b - 1];
      };
      Expression i(0.0);
      switch (e.kind) {
        case Kind::resistor: i = difference(x) / e.value; break;
        case Kind::capacitor: i = e.value * difference(xdot); break;
        case Kind::diode: i = saturation * (exp(difference(x) / thermal) - 1.0); break;
        case Kind::source:
          i = x[current];
          F[current] = difference(x) - e.value * sin(6.283185307179586 * e.frequency * t + e.phase);
          ++current;
      }
      if (e.a > 0) F[e.a - 1] = F[e.a - 1] + i;
      if (e.b > 0) F[e.b - 1] = F[e.b - 1] - i;
    }
  }

  // Total derivatives of order 0, 1, 2; x: n x (order + 2).
  int differentiate(double t, int order, const double* x, double* F, double* F_x, double* F_xdot) const {
    if (order > 2) return SFDAE_ORDER_NOT_AVAILABLE;
    int current = nodes;
    const auto stamp = [&](const Element& e, double* J, double value) {
      for (int row : {e.a, e.b})
        for (int col : {e.a, e.b})
          if (J != nullptr && row > 0 && col > 0) J[row - 1 + (col - 1) * n()] += row == col ? value : -value;
    };
    for (const Element& e : elements) {
      const auto u = [&](int k) {
        return (e.a > 0 ? x[e.a - 1 + k * n()] : 0.0) - (e.b > 0 ? x[e.b - 1 + k * n()] : 0.0);
      };
      double i = 0.0;
      switch (e.kind) {
        case Kind::resistor:
          i = u(order) / e.value;
          if (order == 0) stamp(e, F_x, 1.0 / e.value);
          break;
        case Kind::capacitor:
          i = e.value * u(order + 1);
          if (order == 0) stamp(e, F_xdot, e.value);
          break;
        case Kind::diode: {
          if (u(0) > 700.0 * thermal) return 1;  // exp would overflow
          const double g = saturation / thermal * std::exp(u(0) / thermal), r = u(1) / thermal;
          i = order == 0 ? g * thermal - saturation : order == 1 ? g * u(1) : g * (u(2) + r * u(1));
          stamp(e, F_x, order == 0 ? g : order == 1 ? g * r : g * (u(2) / thermal + r * r));
          break;
        }
        case Kind::source:
          i = x[current + order * n()];
          F[current] = u(order) - e.voltage(t, order);
          for (int q : {0, 1}) {
            const int node = q == 0 ? e.a : e.b;
            const double sign = q == 0 ? 1.0 : -1.0;
            if (node == 0 || order > 0 || F_x == nullptr) continue;
            F_x[current + (node - 1) * n()] = sign;
            F_x[node - 1 + current * n()] = sign;
          }
          ++current;
      }
      if (e.a > 0) F[e.a - 1] += i;
      if (e.b > 0) F[e.b - 1] -= i;
    }
    return 0;
  }
};

// 5 V, 1 kHz through 50 Ohm and a diode onto 1 uF || 10 kOhm; the diode with its capacitance.
Circuit rectifier(double junction) {
  return {"rectifier",
          3,
          {{Kind::source, 1, 0, 5.0, 1e3},
           {Kind::resistor, 1, 2, 50.0},
           {Kind::diode, 2, 3, 0},
           {Kind::capacitor, 2, 3, junction},
           {Kind::capacitor, 3, 0, 1e-6},
           {Kind::resistor, 3, 0, 1e4}}};
}

// Four diodes; the source floats, so that one node of the load is ground.
Circuit bridge(double junction) {
  Circuit c{"bridge",
            4,
            {{Kind::source, 1, 2, 10.0, 1e3},
             {Kind::resistor, 1, 3, 10.0},
             {Kind::capacitor, 4, 0, 1e-6},
             {Kind::resistor, 4, 0, 1e4},
             {Kind::resistor, 2, 0, 1e7}}};
  for (const auto& [a, b] : {std::pair{3, 4}, {2, 4}, {0, 3}, {0, 2}}) {
    c.elements.push_back({Kind::diode, a, b, 0});
    c.elements.push_back({Kind::capacitor, a, b, junction});
  }
  return c;
}

// Without capacitances: nothing but 1 GOhm beside each diode determines where the floating source is while all of
// them block.
Circuit leaky_bridge() {
  Circuit c{"leaky bridge",
            3,
            {{Kind::source, 1, 2, 10.0, 50.0}, {Kind::capacitor, 3, 0, 1e-4}, {Kind::resistor, 3, 0, 1e3}}};
  for (const auto& [a, b] : {std::pair{1, 3}, {2, 3}, {0, 1}, {0, 2}}) {
    c.elements.push_back({Kind::diode, a, b, 0});
    c.elements.push_back({Kind::resistor, a, b, 1e9});
  }
  return c;
}

// Dickson's charge pump of three stages, clocks of opposite phase through 1 nF.
Circuit charge_pump(double junction) {
  Circuit c{"charge pump",
            8,
            {{Kind::source, 1, 0, 3.0, 1e5},
             {Kind::source, 2, 0, 3.0, 1e5, 3.141592653589793},
             {Kind::resistor, 1, 3, 100.0},
             {Kind::resistor, 2, 4, 100.0},
             {Kind::capacitor, 3, 5, 1e-9},
             {Kind::capacitor, 4, 6, 1e-9},
             {Kind::capacitor, 3, 7, 1e-9},
             {Kind::capacitor, 8, 0, 1e-6},
             {Kind::resistor, 8, 0, 1e6}}};
  for (const auto& [a, b] : {std::pair{0, 5}, {5, 6}, {6, 7}, {7, 8}}) {
    c.elements.push_back({Kind::diode, a, b, 0});
    c.elements.push_back({Kind::capacitor, a, b, junction});
  }
  return c;
}

struct Choice {
  int method;
  bool by_callbacks;
  int outputs;
};

struct Result {
  int status = SFDAE_INTERNAL;
  std::string message;
  Numbers x;
};

Result solve(const Circuit& circuit, double tf, const Choice& choice) {
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = circuit.n();
  problem.user = const_cast<Circuit*>(&circuit);
  if (choice.by_callbacks)
    problem.total_derivative = [](double t, int order, const double* x, double* F, double* F_x, double* F_xdot,
                                  void* user) {
      return static_cast<const Circuit*>(user)->differentiate(t, order, x, F, F_x, F_xdot);
    };
  else
    problem.equations = [](sfdae_record*, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                           sfdae_expression* residual, void* user) {
      const Circuit& c = *static_cast<const Circuit*>(user);
      const std::vector<Expression> unknowns(x, x + c.n()), slopes(xdot, xdot + c.n());
      std::vector<Expression> F(at(c.n()));
      c.record(Expression(t), unknowns.data(), slopes.data(), F.data());
      for (int i = 0; i < c.n(); ++i) residual[i] = F[at(i)].c();
      return 0;
    };
  sfdae_options options = sfdae_test::options_with(1e-5, choice.method);
  // Currents of sources are 1e-3 of voltages.
  Numbers atol(at(circuit.n()), 1e-5);
  for (int i = circuit.nodes; i < circuit.n(); ++i) atol[at(i)] = 1e-6;
  options.atol_vector = atol.data();
  sfdae_solver* solver = nullptr;
  Result result;
  result.status = sfdae_create_nonlinear(&solver, &problem, &options);
  if (result.status != SFDAE_OK) return result;
  result.x.assign(at(circuit.n()), 0.0);
  result.status = sfdae_start(solver, 0.0, tf, result.x.data(), nullptr);
  for (int i = 1; i <= choice.outputs && result.status >= SFDAE_OK; ++i) {
    double t = 0.0;
    result.status = sfdae_advance(solver, tf * i / choice.outputs, &t, result.x.data(), nullptr);
  }
  result.message = sfdae_message(solver);
  sfdae_destroy(&solver);
  return result;
}

// Sources that have this frequency, and a phase more.
Circuit driven(Circuit circuit, double frequency, double phase) {
  for (Element& e : circuit.elements) {
    if (e.kind != Kind::source) continue;
    e.frequency = frequency;
    e.phase += phase;
  }
  return circuit;
}

// Three periods, in every way; all give the same voltages.
void expect_solved(const Circuit& circuit, double frequency, const std::string& name) {
  Numbers reference;
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const bool by_callbacks : {false, true})
      for (const int outputs : {1, 60}) {
        const Result result = solve(circuit, 3.0 / frequency, {method, by_callbacks, outputs});
        const std::string what = name + ", method " + std::to_string(method) +
                                 (by_callbacks ? ", callbacks, " : ", recorded, ") + std::to_string(outputs) +
                                 " outputs";
        EXPECT_EQ(result.status, SFDAE_OK) << what << ": " << result.message;
        if (result.status != SFDAE_OK) continue;
        if (reference.empty()) reference = result.x;
        for (int i = 0; i < circuit.nodes; ++i)
          EXPECT_NEAR(result.x[at(i)], reference[at(i)], 1e-3 * (1.0 + std::fabs(reference[at(i)]))) << what;
      }
}

}  // namespace

// At rest at t = 0.
TEST(StiffCircuits, KeepTheirRanksInStepsAndAtOutputs) {
  for (const double junction : {1e-13, 1e-12}) {
    const std::string name = ", " + std::to_string(junction * 1e15) + " fF";
    expect_solved(driven(rectifier(junction), 1e3, 0.0), 1e3, "rectifier" + name);
    expect_solved(driven(bridge(junction), 1e3, 0.0), 1e3, "bridge" + name);
  }
  expect_solved(driven(charge_pump(1e-12), 1e5, 0.0), 1e5, "charge pump");
}

// Switched on at a voltage: diodes conduct at once, with the ranks of an analysis in the units of time that it chose.
// In those of the first points decisions are not clear, but the whole analysis there finds the same values.
TEST(StiffCircuits, KeepTheirRanksWhereOneScalingDoubtsThem) {
  struct Start {
    double junction, phase;
  };
  for (const Start& start : {Start{1e-13, 0.3}, Start{1e-12, 0.3}, Start{1e-12, 1.0}, Start{1e-11, 0.3}})
    expect_solved(driven(bridge(start.junction), 1e5, start.phase), 1e5,
                  "bridge, " + std::to_string(start.junction * 1e15) + " fF, phase " + std::to_string(start.phase));
}

// A step that fails leaves a linearization at a guess where a diode would conduct 1e15 times as much: with that one
// every shorter step converged at once, to its own guess.
TEST(StiffCircuits, AreSolvedWhereDiodesTurnOn) {
  struct Drive {
    double junction, frequency, phase;
  };
  for (const Drive& drive : {Drive{8.5901036564543783e-14, 27908.932499949959, 4.0595386166026683},
                             Drive{2.9751507354010826e-15, 158517.92794947303, 3.7417092239734409}})
    expect_solved(driven(rectifier(drive.junction), drive.frequency, drive.phase), drive.frequency,
                  "rectifier, " + std::to_string(drive.junction * 1e15) + " fF");
}

// The conductances by which ranks are decided fall by eight orders, stay there and rise again, without a zero.
TEST(StiffCircuits, AreSolvedWhereAllDiodesBlockForAWhile) {
  for (const double phase : {0.0, 0.05})
    expect_solved(driven(leaky_bridge(), 50.0, phase), 50.0, "leaky bridge, phase " + std::to_string(phase));
}
