// Problems whose stiffness falls by many orders of magnitude during the integration: gains that come and go,
// regularized Coulomb friction, rectifiers. Each is written in several forms.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef SFDAE_TESTS_NONLINEAR_KEPT_GAINS_CASES_H
#define SFDAE_TESTS_NONLINEAR_KEPT_GAINS_CASES_H

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "kept_gains_problem.h"
#include "program.h"

namespace sfdae_test::kept_gains {

// ---- x' = 1 - g(t, u) law(x / width), g up to exp(45) --------------------------------------------------------

enum class Gain {
  exp_of_sine,
  exp_of_minimum,
  power_of_unknown,
  exp_of_sine_of_unknown,
  exp_of_unknown,
  differential_unknown,
  algebraic_unknown,
  exp_of_sum,
  exp_of_product,
  exp_of_quotient,
  exp_of_table,
  callback
};
inline constexpr std::array<const char*, 12> gain_names = {"exp(A sin t)",
                                                           "exp(min(A sin t, 0.9 A))",
                                                           "u^A, u' = u cos t",
                                                           "exp(A sin u), u' = 1",
                                                           "exp(u)",
                                                           "G' = A G cos t",
                                                           "0 = G - exp(A sin t)",
                                                           "exp(A sin t + 2 cos t)",
                                                           "exp(A sin t cos 0.3 t)",
                                                           "exp(A sin t / (1 + 0.1 t))",
                                                           "exp(table(t))",
                                                           "callback"};
// The gain of the first four stands in the equation of x alone. The others have an unknown that is g law(x), with
// roundoff that the gain magnifies, so that many runs end with an error.
enum class Form {
  explicit_equation,
  law_unknown,
  guided_velocity,
  guided_position,
  flow_unknown,
  slope_unknown,
  joined,
  rod
};
inline constexpr std::array<const char*, 8> form_names = {
    "x' = 1 - g law",      "algebraic y = law", "p = sin t, p' = x + force",        "p = sin t, p'' = x + force",
    "algebraic i = g law", "y = x, z = y'",     "x = z, a force between x' and z'", "two bodies and a rod"};
inline constexpr int first_form_with_force = static_cast<int>(Form::flow_unknown);

constexpr double gain_begin = 0.5, gain_end = 3.2;  // the reference and the library count from gain_begin

// The gain in terms of t and states of the reference, and as it stands in the equations.
struct GainFormulas {
  Formula known, written;
};

struct GainState {
  Formula unknown, rate;
};
inline Formula gain_time(Writer& writer) { return gain_begin + writer.time(); }
inline bool has_state(Gain gain) { return gain >= Gain::power_of_unknown && gain <= Gain::exp_of_unknown; }
inline GainState add_gain_state(Writer& writer, Gain gain, int A) {
  const Formula t = gain_time(writer);
  if (gain == Gain::exp_of_sine_of_unknown) return {writer.state("u", gain_begin), writer.number(1.0)};
  if (gain == Gain::exp_of_unknown)
    return {writer.state("u", A * std::sin(gain_begin)), static_cast<double>(A) * cos(t)};
  const Formula u = writer.state("u", std::exp(std::sin(gain_begin)));
  return {u, cos(t) * u};
}

inline campaign::Spline table_of_sine(double A) {
  std::vector<double> t, y;
  for (double knot = gain_begin - 0.05; knot < gain_end + 0.2; knot += 0.1) {
    t.push_back(knot);
    y.push_back(A * std::sin(knot));
  }
  return campaign::make_spline(3, t, y);
}

inline GainFormulas add_gain(Writer& writer, Gain gain, int power, Formula u) {
  const Formula t = gain_time(writer);
  const double A = power;
  const Formula plain = exp(A * sin(t));
  const auto same = [](Formula g) { return GainFormulas{g, g}; };
  switch (gain) {
    case Gain::exp_of_sine: return same(plain);
    case Gain::exp_of_minimum: return same(exp(minimum(A * sin(t), writer.number(0.9 * A))));
    case Gain::power_of_unknown: return same(campaign::power(u, power));
    case Gain::exp_of_sine_of_unknown: return same(exp(A * sin(u)));
    case Gain::exp_of_unknown: return same(exp(u));
    case Gain::differential_unknown: {
      const Formula G = writer.value("G", plain);
      writer.equation(writer.slope(G) - A * cos(t) * G);
      return {plain, G};
    }
    case Gain::algebraic_unknown: {
      const Formula G = writer.value("G", plain);
      writer.equation(G - plain);
      return {plain, G};
    }
    case Gain::exp_of_sum: return same(exp(A * sin(t) + 2.0 * cos(t)));
    case Gain::exp_of_product: return same(exp(A * sin(t) * cos(0.3 * t)));
    case Gain::exp_of_quotient: return same(exp(A * sin(t) / (1.0 + 0.1 * t)));
    case Gain::exp_of_table: return same(exp(t.owner->add_table(t, table_of_sine(A))));
    case Gain::callback: {
      campaign::OpaqueFunction function{"gain", std::make_shared<Formulas>(), -1};
      function.root = exp(A * sin(function.formulas->unknown(0))).node;
      return same(t.owner->add_opaque(t, plain, function));
    }
  }
  return same(plain);
}

struct GainData {
  LawOfCase law;
  Gain gain;
  Form form;
  int A;
  double width;
};

// A body of position p and, if it has a mass, velocity w follows sin t; the force that holds it there contains x.
inline void add_guided_body(Writer& writer, Formula x, bool has_mass) {
  const Formula t = writer.time(), p = writer.value("p", sin(t));
  if (has_mass) {
    const Formula w = writer.value("w", cos(t)), force = writer.value("force", 0.0 - sin(t) - x);
    writer.equation(writer.slope(p) - w);
    writer.equation(writer.slope(w) - x - force);
  } else {
    const Formula force = writer.value("force", cos(t) - x);
    writer.equation(writer.slope(p) - x - force);
  }
  writer.equation(p - sin(t));
}

// Forms with an unknown that is a part of the rate of x. q: the position of which x is the velocity, with a rod.
inline void add_form_with_force(Writer& writer, Form form, Formula x, Formula q, Formula flow, Formula rate) {
  if (form == Form::flow_unknown) {
    const Formula i = writer.value("i", 1.0 - rate);
    writer.equation(writer.slope(x) - (1.0 - i));
    writer.equation(i - flow);
  } else if (form == Form::slope_unknown) {
    const Formula y = writer.value("y", x), z = writer.value("z", rate);
    writer.equation(writer.slope(x) - (1.0 - flow));
    writer.equation(y - x);
    writer.equation(z - writer.slope(y));
  } else if (form == Form::joined) {
    const Formula z = writer.value("z", x), force = writer.value("force", rate);
    writer.equation(writer.slope(x) - (2.0 - flow - force));
    writer.equation(writer.slope(z) - force);
    writer.equation(x - z);
  } else {
    const Formula q2 = writer.value("q2", 1.0 + q), v2 = writer.value("v2", x), force = writer.value("force", rate);
    writer.equation(writer.slope(q) - x);
    writer.equation(writer.slope(q2) - v2);
    writer.equation(writer.slope(x) - (2.0 - flow - force));
    writer.equation(writer.slope(v2) - force);
    writer.equation(q2 - q - 1.0);
  }
}

inline SmallProblem gain_problem(const GainData& data) {
  Writer writer;
  const bool is_rod = data.form == Form::rod, is_joined = is_rod || data.form == Form::joined;
  const Formula x = writer.state("x", 0.0);
  const Formula q = is_rod ? writer.state("q", 0.0) : x;
  GainState u{x, x};
  if (has_state(data.gain)) u = add_gain_state(writer, data.gain, data.A);
  const GainFormulas g = add_gain(writer, data.gain, data.A, u.unknown);
  const Formula law = apply(data.law, x / data.width);
  const Formula rate = 1.0 - (is_joined ? 0.5 : 1.0) * g.known * law;
  writer.reference(rate);
  if (is_rod) writer.reference(x);
  if (has_state(data.gain)) {
    writer.reference(u.rate);
    writer.equation(writer.slope(u.unknown) - u.rate);
  }
  if (static_cast<int>(data.form) >= first_form_with_force) {
    add_form_with_force(writer, data.form, x, q, g.written * law, rate);
    return writer.finish(0.05);
  }
  Formula y = law;
  if (data.form == Form::law_unknown) {
    y = writer.value("y", law);
    writer.equation(y - law);
  }
  writer.equation(writer.slope(x) - (1.0 - g.written * y));
  if (data.form > Form::law_unknown) add_guided_body(writer, x, data.form == Form::guided_position);
  return writer.finish(0.05);
}

// Number 0: A = 40, exp(A sin t), in the first of the forms.
inline Problem gain_case_of_forms(const LawOfCase& law, RandomNumbers& random, int number, int first_form) {
  Problem problem;
  const auto any = [&](int count) { return number == 0 ? 0 : random.integer(0, count - 1); };
  GainData data{law, static_cast<Gain>(any(gain_names.size())), static_cast<Form>(first_form + any(4)), 40, 1.0};
  problem.text = std::string(gain_names[static_cast<std::size_t>(data.gain)]) + "; " +
                 form_names[static_cast<std::size_t>(data.form)];
  problem.data.end = gain_end - gain_begin;
  problem.data.outputs = {2.3, 2.6, problem.data.end};
  problem.reference_tolerance = 2e-12;
  problem.data.num_copies = number == 0 ? 1 : random_copies(random);
  for (int k = 0; k < problem.data.num_copies; ++k) {
    if (number > 0) data.A = random.integer(20, 45);
    if (number > 0 && random.chance(0.6))
      data.width = campaign::is_bounded(law.law) ? random.log_uniform(1e-3, 1.0) : random.uniform(0.5, 2.0);
    problem.data.copies.push_back(gain_problem(data));
    problem.text += "; A " + std::to_string(data.A) + " width " + text(data.width);
  }
  return problem;
}
inline Problem gain_case(const LawOfCase& law, RandomNumbers& random, int number) {
  return gain_case_of_forms(law, random, number, 0);
}
inline Problem force_case(const LawOfCase& law, RandomNumbers& random, int number) {
  return gain_case_of_forms(law, random, number, first_form_with_force);
}

// ---- q'' = a sin(0.1 t) - law(q' / eps) from rest ------------------------------------------------------------

enum class FrictionForm { two_unknowns, acceleration_unknown, multibody, multibody_on_line, velocity_unknown, rod };
inline constexpr std::array<const char*, 6> friction_form_names = {"q' = v, v' = f",
                                                                   "algebraic acceleration",
                                                                   "multibody",
                                                                   "multibody, held on a line",
                                                                   "w = v, a force between v' and w'",
                                                                   "two masses and a rod"};

inline SmallProblem friction_problem(const LawOfCase& law, FrictionForm form, double amplitude, double eps) {
  Writer writer;
  const Formula q = writer.state("q", 0.0), v = writer.state("v", 0.0);
  const Formula f = amplitude * sin(0.1 * writer.time()) - apply(law, v / eps);
  const bool is_joined = form == FrictionForm::velocity_unknown || form == FrictionForm::rod;
  const Formula half = amplitude * sin(0.1 * writer.time()) - 0.5 * apply(law, v / eps);
  writer.reference(v);
  writer.reference(is_joined ? half : f);
  writer.equation(writer.slope(q) - v);
  if (form == FrictionForm::acceleration_unknown) {
    const Formula a = writer.value("a", f);
    writer.equation(writer.slope(v) - a);
    writer.equation(a - f);
  } else if (is_joined) {
    const bool is_rod = form == FrictionForm::rod;
    const Formula q2 = is_rod ? writer.value("q2", 1.0 + q) : q;
    const Formula v2 = writer.value("v2", v), force = writer.value("force", half);
    writer.equation(writer.slope(v) - (f + amplitude * sin(0.1 * writer.time()) - force));
    writer.equation(writer.slope(v2) - force);
    if (is_rod) writer.equation(writer.slope(q2) - v2);
    writer.equation(is_rod ? q2 - q - 1.0 : v2 - v);
  } else {
    writer.equation(writer.slope(v) - f);
  }
  return writer.finish(0.4);
}

// Number 0: amplitude 1.05, eps 1e-7.
inline Problem friction_case(const LawOfCase& law, RandomNumbers& random, int number) {
  Problem problem;
  const int forms = static_cast<int>(friction_form_names.size());
  const auto form = static_cast<FrictionForm>(number == 0 ? 0 : random.integer(0, forms - 1));
  const double eps = number == 0 ? 1e-7 : std::pow(10.0, -random.integer(3, 7));
  // Two masses share the friction of one.
  const double factor = form == FrictionForm::velocity_unknown || form == FrictionForm::rod ? 0.5 : 1.0;
  problem.is_multibody = form == FrictionForm::multibody || form == FrictionForm::multibody_on_line;
  problem.data.family = problem.is_multibody ? campaign::Family::friction_multibody : campaign::Family::friction;
  problem.data.on_line = form == FrictionForm::multibody_on_line;
  problem.data.end = 22.0;
  problem.data.outputs = {5.0, 15.0, 18.0, 22.0};
  problem.data.num_copies = number == 0 ? 1 : random_copies(random);
  problem.text =
      std::string(friction_form_names[static_cast<std::size_t>(form)]) + ", eps " + text(eps) + ", amplitudes";
  for (int k = 0; k < problem.data.num_copies; ++k) {
    const double amplitude = k == 0 ? 1.05 : random.uniform(0.9, 1.6);
    problem.data.copies.push_back(friction_problem(law, form, factor * amplitude, eps));
    problem.text += " " + text(amplitude);
  }
  return problem;
}

// ---- C v' = sum of diode currents - v / R --------------------------------------------------------------------

struct Rectifier {
  LawOfCase law;
  double amplitude, capacitance, load, series;  // series: the resistance between source and diode, 0 if there is none
  int diodes;
  bool shows_currents;

  Formula current(Formula voltage) const {
    switch (law.law == Law::opaque ? law.hidden : law.law) {
      case Law::exponential: return 1e-12 * apply(law, voltage / 0.026);
      case Law::smooth_diode: return 1e-12 * apply(law, voltage);
      default: return 1e-3 * apply(law, voltage / amplitude);
    }
  }
};

// The value of the unknown of that index, between -size and size, at which a formula that decreases with it is zero.
// t = 0.
inline double zero_of(Formula formula, int index, std::vector<double> x, double size) {
  const campaign::Program program(*formula.owner, {formula});
  double low = -size, high = size;
  double& middle = x[static_cast<std::size_t>(index)];
  for (int i = 0; i < 200; ++i) {
    middle = 0.5 * (low + high);
    double value = 0.0;
    program.evaluate(0.0, x.data(), nullptr, &value);
    (value > 0.0 ? low : high) = middle;
  }
  return middle;
}

// The capacitor starts at the highest of the voltages of the sources, so that no charge rushes in.
inline SmallProblem rectifier_problem(const Rectifier& rectifier) {
  Writer writer;
  const auto phase = [&](int k) { return -2.0 * std::numbers::pi * k / rectifier.diodes; };
  double highest = 0.0;
  for (int k = 0; k < rectifier.diodes; ++k) highest = std::max(highest, rectifier.amplitude * std::sin(phase(k)));
  const Formula v = writer.state("v", highest);
  std::vector<Formula> currents, balances;
  std::vector<double> start = {highest};
  Formula sum = writer.number(0.0) - v / rectifier.load, written = sum;
  for (int k = 0; k < rectifier.diodes; ++k) {
    const Formula source = rectifier.amplitude * sin(2.0 * std::numbers::pi * 50.0 * writer.time() + phase(k));
    Formula node = source;
    if (rectifier.series > 0.0) {
      node = writer.state("a" + std::to_string(k), 0.0, false);
      start.push_back(0.0);
    }
    currents.push_back(rectifier.current(node - v));
    sum = sum + currents.back();
    if (rectifier.series == 0.0) continue;
    balances.push_back((source - node) / rectifier.series);
    start.back() = zero_of(balances.back() - currents.back(), k + 1, start, 2.0 * rectifier.amplitude);
    writer.start_at(k + 1, start.back());
  }
  writer.reference(sum / rectifier.capacitance);
  for (std::size_t k = 0; k < currents.size(); ++k) {
    Formula i = currents[k];
    if (!balances.empty()) writer.reference(balances[k] - i);
    if (rectifier.shows_currents) {
      i = writer.value("i" + std::to_string(k), currents[k]);
      writer.equation(i - currents[k]);
    }
    if (!balances.empty()) writer.equation(balances[k] - i);
    written = written + i;
  }
  writer.equation(rectifier.capacitance * writer.slope(v) - written);
  return writer.finish(1e-3);
}

// Number 0: one diode with a resistor of 1 Ohm before it, 325 V.
inline Problem rectifier_case(const LawOfCase& law, RandomNumbers& random, int number) {
  constexpr std::array<int, 3> counts = {1, 5, 7};
  Problem problem;
  Rectifier rectifier{law, 325.0, 1e-4, 1e3, 1.0, 1, true};
  bool is_joint = true;
  int count = 1;
  if (number > 0) {
    count = counts[static_cast<std::size_t>(random.integer(0, 2))];
    is_joint = random.chance(0.5);
    rectifier = {law,
                 random.uniform(100.0, 1000.0),
                 random.log_uniform(1e-6, 1e-3),
                 random.log_uniform(1e2, 1e5),
                 random.chance(0.5) ? random.log_uniform(0.1, 100.0) : 0.0,
                 is_joint ? count : 1,
                 random.chance(0.6)};
  }
  problem.data.family = campaign::Family::rectifier;
  problem.max_step_of_callbacks = 2e-4;
  problem.data.end = number == 0 ? 0.02 : random.uniform(0.02, 0.06);
  problem.data.outputs = {0.3 * problem.data.end, 0.7 * problem.data.end, problem.data.end};
  problem.data.num_copies = is_joint ? 1 : count;
  problem.has_sum = !is_joint && count > 1;
  problem.text = std::to_string(count) + (is_joint ? " diodes at one capacitor" : " rectifiers") + ", C " +
                 text(rectifier.capacitance) + ", R " + text(rectifier.load) + ", resistor " +
                 text(rectifier.series) + (rectifier.shows_currents ? ", currents unknown" : "") + ", amplitudes";
  for (int k = 0; k < problem.data.num_copies; ++k) {
    if (k > 0) rectifier.amplitude = random.uniform(100.0, 1000.0);
    problem.data.copies.push_back(rectifier_problem(rectifier));
    problem.text += " " + text(rectifier.amplitude);
  }
  return problem;
}

}  // namespace sfdae_test::kept_gains

#endif
