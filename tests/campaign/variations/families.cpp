// SPDX-License-Identifier: BSD-3-Clause
#include "families.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace campaign {

namespace {

struct GainData {
  double rate, amplitude, frequency, phase;
  int power;
};

GainData random_gain_data(const Case& problem, RandomNumbers& random) {
  // Exponents reach 40 in x' = b - g law(x); devices and friction vary by less.
  const bool strong = problem.family == Family::gain_equation;
  GainData data{};
  data.amplitude = random.log_uniform(1.0, strong ? 40.0 : 5.0);
  data.rate = random.sign() * data.amplitude / problem.end;
  data.frequency = random.uniform(0.5, 2.0);
  if (problem.family == Family::pulses) data.frequency /= 100.0;
  data.phase = random.uniform(-std::numbers::pi, 0.3);
  data.power = random.integer(2, 5);
  return data;
}

// x: the unknown that the gain depends on, if it depends on one.
Formula gain(Gain kind, const GainData& data, Formula x, bool own) {
  const Formula t = x.owner->time();
  const Formula angle = data.frequency * t + data.phase;
  switch (kind) {
    case Gain::one: return t.owner->number(1.0);
    case Gain::exp_of_time: return exp(data.rate * t);
    case Gain::exp_of_minimum: return exp(minimum(std::abs(data.rate) * t, t.owner->number(0.6 * data.amplitude)));
    case Gain::exp_of_sum: return exp(data.rate * t + 0.3 * data.amplitude * sin(angle));
    case Gain::exp_of_product: return exp(data.rate * t * sin(angle));
    case Gain::exp_of_quotient: return exp(data.amplitude * t / (1.0 + t));
    case Gain::exp_of_sine: return own ? exp(data.amplitude * sin(angle)) : exp(data.amplitude * sin(x));
    case Gain::power_of_unknown: return power(x, data.power);
    case Gain::unknown: return x;
    case Gain::sine_of_unknown: return 1.2 + sin(x);
  }
  return x;
}

bool needs_unknown(Gain kind) { return kind >= Gain::exp_of_sine; }
bool needs_angle(Gain kind) { return kind == Gain::exp_of_sine || kind == Gain::sine_of_unknown; }

// The unknown that gains depend on: an angle, r' = w, or a size, r' = c r.
void add_gain_state(Model& model, const Case& problem, const GainData& data) {
  model.names.push_back("r");
  model.differential.push_back(1);
  model.start.push_back(needs_angle(problem.gain) ? data.phase : 1.0);
}
Formula gain_state_rate(const Case& problem, const GainData& data, Formula r) {
  if (needs_angle(problem.gain)) return r.owner->number(data.frequency);
  return data.rate / data.power * r;
}

double gain_feature(const Case& problem, const GainData& data) {
  if (problem.gain == Gain::one) return problem.end;
  return 1.0 / (data.frequency * std::sqrt(1.0 + data.amplitude));
}

// Sizes at which a law does something: of its argument, of the currents that it gives.
struct Sizes {
  double argument, result;
};

Sizes device_sizes(Law law, RandomNumbers& random) {
  switch (law) {
    case Law::exponential:
    case Law::hyperbolic_sine: return {0.0259 * random.uniform(1.0, 3.0), random.log_uniform(1e-10, 1e-4)};
    case Law::smooth_diode: return {1.0, random.log_uniform(1e-12, 1e-6)};
    case Law::power_25: return {random.uniform(0.3, 1.0), random.log_uniform(1e-2, 1.0)};
    case Law::cubic: return {random.uniform(0.1, 1.0), random.uniform(1.0, 10.0)};
    case Law::table:
    case Law::opaque: return {random.log_uniform(1e-2, 1.0), random.uniform(1.0, 20.0)};
    default: return {random.log_uniform(1e-4, 1e-1), random.uniform(1.0, 20.0)};
  }
}

Model gain_equation(Case& problem, RandomNumbers& random) {
  Model model;
  const GainData data = random_gain_data(problem, random);
  const LawOfCase& law = problem.law;
  const double b = random.uniform(0.5, 2.0);
  const double width = is_bounded(law.law) ? random.log_uniform(1e-4, 1.0) : random.uniform(0.5, 2.0);
  const bool own = problem.own_gain || !needs_unknown(problem.gain);
  const bool own_angle = own && needs_angle(problem.gain);
  model.names = {"x"};
  model.differential = {1};
  model.start = {random.chance(0.3) ? 0.0 : random.uniform(0.0, 1.0)};
  if (!own) add_gain_state(model, problem, data);
  const Gain kind = problem.gain;
  model.f = [=](const std::vector<Formula>& x) {
    const Formula argument = own ? x[0] : x[1];
    std::vector<Formula> f = {b - gain(kind, data, argument, own_angle) * apply(law, x[0] / width)};
    Case same;
    same.gain = kind;
    if (!own) f.push_back(gain_state_rate(same, data, x[1]));
    return f;
  };
  model.feature = gain_feature(problem, data);
  problem.largest_gain_exponent = std::max(problem.largest_gain_exponent, data.amplitude);
  problem.smallest_width = std::min(problem.smallest_width, width);
  return model;
}

struct Source {
  double amplitude, frequency;
  Formula at(Formula t) const { return amplitude * sin(frequency * t); }
};

// C v' = i - v / R, i = g I law((a - v) / u), where a is the source or, after a resistor, 0 = (e - a) / R_s - i.
Model rectifier(Case& problem, RandomNumbers& random) {
  Model model;
  const GainData data = random_gain_data(problem, random);
  const bool peak = problem.family == Family::peak_rectifier, resistor = problem.has_resistor;
  const LawOfCase& law = problem.law;
  const Sizes sizes = device_sizes(law.law, random);
  const double C = random.log_uniform(0.1, 10.0), R = peak ? random.log_uniform(1e2, 1e6) : random.uniform(0.3, 3.0);
  const double R_s = random.log_uniform(1e-3, 1.0);
  const Source source{random.uniform(1.0, 10.0), random.uniform(3.0, 8.0)};
  const bool own = !needs_unknown(problem.gain);
  model.names = {"v"};
  model.differential = {1};
  model.start = {0.0};
  if (resistor) {
    model.names.push_back("a");
    model.differential.push_back(0);
    model.start.push_back(0.0);
  }
  if (!own) add_gain_state(model, problem, data);
  const Gain kind = problem.gain;
  const auto current = [=](const std::vector<Formula>& x) {
    const Formula before = resistor ? x[1] : source.at(x[0].owner->time());
    return sizes.result * gain(kind, data, x.back(), false) * apply(law, (before - x[0]) / sizes.argument);
  };
  model.f = [=](const std::vector<Formula>& x) {
    const Formula i = current(x);
    std::vector<Formula> f = {(i - x[0] / R) / C};
    if (resistor) f.push_back((source.at(x[0].owner->time()) - x[1]) / R_s - i);
    Case same;
    same.gain = kind;
    if (!own) f.push_back(gain_state_rate(same, data, x.back()));
    return f;
  };
  model.value_names = {"i"};
  model.values = [=](const std::vector<Formula>& x) { return std::vector<Formula>{current(x)}; };
  model.feature = std::min(gain_feature(problem, data), 0.4 / source.frequency);
  problem.smallest_width = std::min(problem.smallest_width, sizes.argument);
  return model;
}

// q' = v, v' = a sin(w t) - g law(v / eps), from rest.
Model friction(Case& problem, RandomNumbers& random) {
  Model model;
  const GainData data = random_gain_data(problem, random);
  const LawOfCase& law = problem.law;
  double eps = random.uniform(0.2, 1.0);
  if (is_bounded(law.law)) eps = random.log_uniform(1e-6, 1e-1);
  if (law.law == Law::table || law.law == Law::opaque) eps = random.log_uniform(1e-4, 1e-1);
  const Source source{random.chance(0.2) ? random.uniform(0.3, 0.9) : random.uniform(1.1, 3.0),
                      random.uniform(0.5, 2.0)};
  const bool own = !needs_unknown(problem.gain);
  model.names = {"q", "v"};
  model.differential = {1, 1};
  model.start = {0.0, 0.0};
  if (!own) add_gain_state(model, problem, data);
  const Gain kind = problem.gain;
  model.f = [=](const std::vector<Formula>& x) {
    const Formula force = source.at(x[0].owner->time()) - gain(kind, data, x.back(), false) * apply(law, x[1] / eps);
    std::vector<Formula> f = {x[1], force};
    Case same;
    same.gain = kind;
    if (!own) f.push_back(gain_state_rate(same, data, x.back()));
    return f;
  };
  model.feature = std::min(gain_feature(problem, data), 0.4 / source.frequency);
  problem.smallest_width = std::min(problem.smallest_width, eps);
  return model;
}

// 0 far from u = 0, about 1 there.
Formula pulse(const LawOfCase& law, double sharpness, Formula u) {
  Formulas& owner = *u.owner;
  switch (law.law) {
    case Law::exponential: return exp(0.0 - u * u);
    case Law::power_25: return 1.0 / (1.0 + power(u, 26));
    case Law::smooth_diode: return exp(0.0 - sqrt(u * u + 1e-4));
    case Law::hyperbolic_sine:  // cosh must not overflow
      return 1.0 / apply(Operation::cosh, maximum(minimum(u, owner.number(300.0)), owner.number(-300.0)));
    case Law::cubic: return 1.0 / (1.0 + power(u + power(u, 3), 2));
    default: return 0.5 * (apply(law, sharpness * (u + 1.0)) - apply(law, sharpness * (u - 1.0)));
  }
}

Model pulses(Case& problem, RandomNumbers& random) {
  Model model;
  const GainData data = random_gain_data(problem, random);
  const LawOfCase& law = problem.law;
  // Steps are limited by the width where the library cannot see it: not too many.
  const bool opaque = law.law == Law::opaque;
  const double width = random.log_uniform(opaque ? 3.0 : 0.3, 20.0);
  const double sharpness = random.log_uniform(1.0, opaque ? 2.0 : 8.0);
  const double center = random.uniform(0.05, 0.9) * problem.end, height = random.uniform(0.2, 2.0) / width;
  const double leak = 1.0 / problem.end;
  model.names = {"x"};
  model.differential = {1};
  model.start = {random.chance(0.5) ? 0.0 : random.uniform(0.0, 1.0)};
  const Gain kind = problem.gain;
  model.f = [=](const std::vector<Formula>& x) {
    const Formula u = (x[0].owner->time() - center) / width;
    return std::vector<Formula>{height * gain(kind, data, x[0], true) * pulse(law, sharpness, u) - leak * x[0]};
  };
  model.feature = 0.5 * width / sharpness;
  model.windows = {{center - 8.0 * width, center + 8.0 * width, width / (4.0 * sharpness)}};
  problem.smallest_width = std::min(problem.smallest_width, width / sharpness);
  return model;
}

Model model_of(Case& problem, RandomNumbers& random) {
  switch (problem.family) {
    case Family::gain_equation: return gain_equation(problem, random);
    case Family::rectifier:
    case Family::peak_rectifier: return rectifier(problem, random);
    case Family::pulses: return pulses(problem, random);
    default: return friction(problem, random);
  }
}

Family random_family(RandomNumbers& random) {
  constexpr std::array<double, 6> shares = {0.35, 0.15, 0.1, 0.15, 0.1, 0.15};
  double rest = random.uniform();
  for (std::size_t k = 0; k < shares.size(); ++k) {
    rest -= shares[k];
    if (rest < 0.0) return static_cast<Family>(k);
  }
  return Family::pulses;
}

Gain random_gain(Family family, RandomNumbers& random) {
  if (family == Family::gain_equation) return static_cast<Gain>(random.integer(1, 9));
  if (random.chance(0.6)) return Gain::one;
  if (family == Family::friction_multibody) return static_cast<Gain>(random.integer(1, 5));
  if (family == Family::pulses) return static_cast<Gain>(random.integer(1, 6));
  return static_cast<Gain>(random.integer(1, 9));
}

void choose_addition(Case& problem, RandomNumbers& random) {
  if (problem.family == Family::friction_multibody) {
    problem.on_line = random.chance(0.5);
    return;
  }
  if (random.chance(0.45)) return;
  problem.addition = static_cast<Addition>(random.integer(1, 4));
  // Where laws or inputs have kinks, second derivatives jump.
  const bool has_kinks =
      (problem.law.law == Law::table && problem.law.spline.degree == 1) || problem.gain == Gain::exp_of_minimum;
  if (problem.addition == Addition::second_slope && has_kinks) problem.addition = Addition::slope;
  const bool no_path = problem.family != Family::gain_equation && problem.family != Family::friction;
  const bool further_state = needs_unknown(problem.gain) && !problem.own_gain;
  if (problem.addition == Addition::path && (no_path || further_state)) problem.addition = Addition::slope;
}

void choose_times(Case& problem, RandomNumbers& random) {
  switch (problem.family) {
    case Family::pulses: problem.end = 1000.0; break;
    case Family::rectifier:
    case Family::peak_rectifier: problem.end = random.uniform(1.0, 4.0); break;
    default: problem.end = random.uniform(2.0, 15.0); break;
  }
  const int count = random.chance(0.2) ? 40 : random.integer(1, 6);
  for (int k = 1; k < count; ++k) problem.outputs.push_back(random.uniform(0.02, 0.98) * problem.end);
  problem.outputs.push_back(problem.end);
  std::sort(problem.outputs.begin(), problem.outputs.end());
}

int random_copies(RandomNumbers& random) {
  const double u = random.uniform();
  if (u < 0.6) return 1;
  if (u < 0.82) return 5;
  if (u < 0.94) return 7;
  return u < 0.99 ? 20 : 100;
}

}  // namespace

Case random_case(int number, int seed) {
  RandomNumbers random(static_cast<std::uint64_t>(seed) + 1000, static_cast<std::uint64_t>(number));
  Case problem;
  problem.family = random_family(random);
  problem.law = random_law(static_cast<Law>(random.integer(0, static_cast<int>(law_names.size()) - 1)), random);
  problem.gain = random_gain(problem.family, random);
  problem.own_gain = problem.family == Family::gain_equation && random.chance(0.5);
  choose_addition(problem, random);
  choose_times(problem, random);
  problem.has_resistor = problem.family == Family::rectifier && random.chance(0.5);
  problem.num_copies = random_copies(random);
  constexpr int most_data = 20;  // references are needed of so many copies only
  const bool second_order = problem.family == Family::friction || problem.family == Family::friction_multibody;
  for (int k = 0; k < std::min(problem.num_copies, most_data); ++k)
    problem.copies.push_back(with_addition(model_of(problem, random), problem.addition, second_order));
  return problem;
}

}  // namespace campaign
