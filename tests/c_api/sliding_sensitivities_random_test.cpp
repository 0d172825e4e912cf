// SPDX-License-Identifier: BSD-3-Clause
//
// Sensitivities of random piecewise linear systems with a surface (random_sliding.h), of strangeness index 1 and 2,
// against differences of the reference: by a parameter p of all that the system consists of, the surface and hidden
// constraints too; by a parameter r of one mode; by a start value. And gradients by the adjoint, against these of the
// same steps.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <sfdae/hybrid.hpp>
#include <string>
#include <vector>

#include "family_run.h"
#include "random_sliding.h"
#include "solver_options.h"

namespace {

using namespace sfdae_test::sliding;
using Parameters = std::array<double, 3>;  // p, r, the change of the start value
using RandomValues = std::vector<double>;

constexpr Parameters in_use = {0.3, 0.2, 0.0};

// At p the sample whose numbers are those of one plus p times those of another, times 1 / (1 + p / 5) where x' has
// that factor.
struct Family {
  Sample at_zero, by_p;
  bool has_acceleration;  // a seventh unknown z = v', which needs u'
  int size() const { return has_acceleration ? n + 1 : n; }
  Sample at(const Parameters& q) const {
    Sample result = at_zero;
    const auto move = [&](double& value, double by) { value += 0.3 * q[0] * by; };
    const auto move_all = [&](Vector& values, const Vector& by) {
      for (std::size_t i = 0; i < 3; ++i) move(values[i], by[i]);
    };
    for (std::size_t i = 0; i < 3; ++i) move_all(result.A[i], by_p.A[i]);
    for (std::size_t k = 0; k < 2; ++k) {
      move_all(result.p[k], by_p.p[k]);
      move(result.r[k], by_p.r[k]);
    }
    result.r[1] += q[1];
    move_all(result.b, by_p.b), move_all(result.k, by_p.k), move_all(result.c, by_p.c), move_all(result.q, by_p.q);
    move(result.h, by_p.h);
    for (std::size_t i = 0; i < 3; ++i) {
      for (double& a : result.A[i]) a /= 1 + q[0] / 5;
      result.b[i] /= 1 + q[0] / 5, result.k[i] /= 1 + q[0] / 5;
    }
    result.start[0] += q[2];
    return result;
  }
};

sfdae::Solver solver_of(const Family& family, int side, const sfdae::Options& options) {
  sfdae::NonlinearProblem problem(family.size(), family.size());
  problem.equations = [&family, side](const auto& t, auto y, auto ydot, auto F) {
    const auto k = static_cast<std::size_t>(side);
    const Sample &a = family.at_zero, &b = family.by_p;
    const sfdae::Expression p = sfdae::parameter(t, "p", in_use[0]);
    std::vector<sfdae::Expression> x(n, 0.0), xdot(n, 0.0), G(n, 0.0);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        x[i] = x[i] + a.columns[i][j] * y[static_cast<int>(j)];
        xdot[i] = xdot[i] + a.columns[i][j] * ydot[static_cast<int>(j)];
      }
    const auto number = [&](double at_zero, double by_p) { return at_zero + 0.3 * p * by_p; };
    const auto of = [&](const Vector& u, const Vector& v) {
      return number(u[0], v[0]) * x[0] + number(u[1], v[1]) * x[1] + number(u[2], v[2]) * x[2];
    };
    for (std::size_t i = 0; i < 3; ++i)
      G[i] = (1 + p / 5) * xdot[i] - of(a.A[i], b.A[i]) - number(a.b[i], b.b[i]) - number(a.k[i], b.k[i]) * x[3];
    G[3] = x[3] - of(a.p[k], b.p[k]) - number(a.r[k], b.r[k]);
    if (side == 1) G[3] = G[3] - sfdae::parameter(t, "r", in_use[1]);
    G[4] = x[4] - of(a.q, b.q);
    G[5] = xdot[4] - x[5];
    for (std::size_t i = 0; i < n; ++i) {
      sfdae::Expression sum = 0.0;
      for (std::size_t j = 0; j < n; ++j) sum = sum + a.rows[i][j] * G[j];
      F[static_cast<int>(i)] = sum;
    }
    if (family.has_acceleration) F[n] = xdot[5] - y[n] + G[0];
  };
  return sfdae::Solver(problem, options);
}

constexpr int outputs = 5;

// y at the outputs, and the times of the changes before.
struct Course {
  std::vector<RandomValues> y;
  std::vector<std::vector<double>> changes;
  std::vector<int> modes;  // at the outputs
  bool slides = false;
};
// v' = q x'', along the surface with the u for which its rate is zero.
double acceleration(const Sample& sample, int mode, const std::array<double, n>& values) {
  const Vector x = {values[0], values[1], values[2]};
  Vector slope, bend;
  for (std::size_t i = 0; i < 3; ++i) slope[i] = product(sample.A[i], x) + sample.b[i] + sample.k[i] * values[3];
  for (std::size_t i = 0; i < 3; ++i) bend[i] = product(sample.A[i], slope);
  const double du = mode == 2 ? -product(sample.c, bend) / product(sample.c, sample.k)
                              : product(sample.p[static_cast<std::size_t>(mode)], slope);
  return product(sample.q, bend) + product(sample.q, sample.k) * du;
}

Course course_of(const Family& family, const Parameters& q) {
  const Sample sample = family.at(q);
  Course course;
  Reference reference(sample, 1e-3);
  for (int k = 0; k <= outputs; ++k) {
    if (!reference.advance(sample.time * k / outputs)) break;
    course.y.push_back(mixed(sample, reference.values()));
    if (family.has_acceleration)
      course.y.back().push_back(acceleration(sample, reference.mode(), reference.values()));
    course.changes.push_back(reference.changes());
    course.modes.push_back(reference.mode());
  }
  course.slides = reference.visits_to_surface() > 0;
  return course;
}

// With its derivatives, as far as the courses beside it are those of the same modes.
struct Exact {
  Course course;
  std::array<std::vector<RandomValues>, 3> S, dt;  // dt: of the last change
};
Exact exact_course(const Family& family) {
  constexpr double step = 2e-4;
  Exact exact;
  exact.course = course_of(family, in_use);
  for (std::size_t j = 0; j < 3; ++j) {
    std::vector<Course> beside;
    for (const double by : {1.0, -1.0, 2.0, -2.0}) {
      Parameters q = in_use;
      q[j] += by * step;
      beside.push_back(course_of(family, q));
    }
    for (std::size_t k = 0; k < exact.course.y.size(); ++k) {
      const auto is_other = [&](const Course& other) {
        return other.y.size() <= k || other.modes[k] != exact.course.modes[k] ||
               other.changes[k].size() != exact.course.changes[k].size();
      };
      if (std::any_of(beside.begin(), beside.end(), is_other)) break;
      const auto along = [](double a, double b, double c, double d) { return (8 * (a - b) - (c - d)) / (12 * step); };
      RandomValues S, dt;
      for (std::size_t i = 0; i < exact.course.y[k].size(); ++i)
        S.push_back(along(beside[0].y[k][i], beside[1].y[k][i], beside[2].y[k][i], beside[3].y[k][i]));
      if (!exact.course.changes[k].empty())
        dt.push_back(along(beside[0].changes[k].back(), beside[1].changes[k].back(), beside[2].changes[k].back(),
                           beside[3].changes[k].back()));
      exact.S[j].push_back(S);
      exact.dt[j].push_back(dt);
    }
  }
  std::size_t known = exact.course.y.size();
  for (const auto& S : exact.S) known = std::min(known, S.size());
  exact.course.y.resize(known);
  return exact;
}

struct Outcome {
  // In tolerances, relative to the largest derivative or 1; of dt/dp, where the time itself is off by more, in errors
  // of the time.
  double error = 0.0, error_of_times = 0.0;
  int compared = 0, index_along = -1;
  std::string failure;
};

double error_of_slopes(const RandomValues& found, const RandomValues& exact, double tolerance) {
  double size = 1.0, error = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    size = std::max(size, std::fabs(exact[i]));
    error = std::max(error, std::fabs(found[i] - exact[i]));
  }
  return error / (size * tolerance);
}

// Courses beside it change on the other side of t.
bool is_near_change(const Exact& exact, double t) {
  constexpr double near = 2e-3;
  const std::vector<double>& changes = exact.course.changes.back();
  return std::any_of(changes.begin(), changes.end(), [&](double at) { return std::fabs(at - t) < near; });
}

// The modes below and above, and 2 along the surface.
struct Modes {
  Modes(const Family& family, const sfdae::Options& options)
      : below(solver_of(family, 0, options)), above(solver_of(family, 1, options)) {
    hybrid.add_mode(below);
    hybrid.add_mode(above);
    hybrid.add_switch(0, 1, [&family](const auto& t, auto y) {
      const sfdae::Expression p = sfdae::parameter(t, "p", 7);
      sfdae::Expression g = family.at_zero.h + 0.3 * p * family.by_p.h;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < n; ++j)
          g = g + (family.at_zero.c[i] + 0.3 * p * family.by_p.c[i]) * family.at_zero.columns[i][j] *
                      y[static_cast<int>(j)];
      return g;
    });
  }
  sfdae::Solver below, above;
  sfdae::Hybrid hybrid;
};

Outcome run(const Family& family, const Exact& exact, int method, double tolerance) {
  Outcome outcome;
  if (exact.course.y.empty()) return outcome;
  const Sample sample = family.at(in_use);
  sfdae::Sensitivities wanted;
  wanted.parameters = {"p", "r", ""};
  const int size = family.size();
  wanted.directions = sfdae::Matrix(size, 3);
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < size; ++i) wanted.directions(i, j) = exact.S[std::size_t(j)][0][std::size_t(i)];
  sfdae::Point point{0.0, exact.course.y[0], {}};
  try {
    Modes modes(family, sfdae_test::solver_options(tolerance, method));
    sfdae::Hybrid& hybrid = modes.hybrid;
    hybrid.set_sensitivities(wanted);
    hybrid.start(exact.course.modes[0], point, sample.time);
    for (std::size_t k = 1; k < exact.course.y.size(); ++k) {
      const double t = sample.time * static_cast<double>(k) / outputs;
      hybrid.advance(t, point);
      if (is_near_change(exact, t)) continue;
      const sfdae::Matrix S = hybrid.sensitivities(t, false).S;
      ++outcome.compared;
      for (int j = 0; j < 3; ++j) {
        const RandomValues found(S.data() + j * size, S.data() + (j + 1) * size);
        outcome.error = std::max(outcome.error, error_of_slopes(found, exact.S[std::size_t(j)][k], tolerance));
        if (exact.dt[std::size_t(j)][k].empty()) continue;
        const double time = exact.course.changes[k].back(), found_time = hybrid.passage(hybrid.num_passages() - 1).t;
        const double off = std::fabs(found_time - time) / (tolerance * (1.0 + time));
        const RandomValues dt = {hybrid.passage_sensitivities()[std::size_t(j)]};
        const double error = error_of_slopes(dt, exact.dt[std::size_t(j)][k], tolerance);
        outcome.error_of_times = std::max(outcome.error_of_times, error / std::max(1.0, off));
      }
    }
    if (hybrid.mode(2).visits > 0) outcome.index_along = hybrid.mode(2).strangeness_index;
  } catch (const sfdae::Error& error) {
    outcome.failure = error.what();
  }
  return outcome;
}

TEST(RandomSlidingSensitivities, AgreeWithDifferencesOfFilippovsSolutions) {
  constexpr double allowed = 100.0;
  const int count = sfdae_test::scaled_count(100);
  std::mt19937 random(77);
  std::vector<Family> families;
  std::vector<Exact> exact;
  for (int k = 0; k < 864; ++k) {
    const Sample at_zero = random_sample(random), by_p = random_sample(random);
    // The last two: iterations for the values at the beginning along the surface overshoot.
    if (k >= count && k != 731 && k != 863) continue;
    families.push_back({at_zero, by_p, k % 2 == 1});
    exact.push_back(exact_course(families.back()));
  }
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    int compared = 0, sliding = 0, of_index_2 = 0, crossing = 0, failed = 0, wrong = 0;
    std::vector<double> errors, errors_of_times;
    for (std::size_t i = 0; i < families.size(); ++i) {
      const Outcome outcome = run(families[i], exact[i], method, 1e-7);
      if (!outcome.failure.empty()) {
        ++failed;
        std::printf("%zu: %s\n", i, outcome.failure.c_str());
        continue;
      }
      compared += outcome.compared;
      if (outcome.index_along == 2) ++of_index_2;
      if (exact[i].course.slides) ++sliding;
      else if (!exact[i].course.changes.back().empty()) ++crossing;
      errors.push_back(outcome.error);
      errors_of_times.push_back(outcome.error_of_times);
      if (outcome.error > allowed || outcome.error_of_times > allowed) {
        ++wrong;
        std::printf("%zu: %.3g tolerances, times %.3g, %zu changes\n", i, outcome.error, outcome.error_of_times,
                    exact[i].course.changes.back().size());
      }
    }
    std::sort(errors.begin(), errors.end());
    std::sort(errors_of_times.begin(), errors_of_times.end());
    std::printf(
        "%s: %d outputs compared, %d slide, %d with mu = 2, %d cross, %d failed; errors of S %.3g tolerances, median "
        "%.3g, of dt/dp %.3g, %.3g\n",
        method == SFDAE_METHOD_BDF ? "BDF" : "Radau", compared, sliding, of_index_2, crossing, failed, errors.back(),
        errors[errors.size() / 2], errors_of_times.back(), errors_of_times[errors_of_times.size() / 2]);
    EXPECT_EQ(failed, 0);
    EXPECT_EQ(wrong, 0);
    EXPECT_GE(sliding, count / 4);
    EXPECT_GE(crossing, count / 20);
  }
}

// ---- Gradients ---------------------------------------------------------------------------------------------------

struct Gradients {
  sfdae::Matrix values;  // of two functionals of values at the start and at the end
  std::string way;       // the modes that were entered
};

// Steps are the same, as there is one time only, at which they end, and states are chosen from the array.
Gradients gradients_of(const Family& family, int method, double tolerance, bool by_adjoint, long max_kept_steps = 0) {
  const int size = family.size();
  const Sample sample = family.at(in_use);
  sfdae::Options options = sfdae_test::solver_options(tolerance, method);
  options.structure = SFDAE_STRUCTURE_OFF;
  options.use_stop_time = 1;
  options.stop_time = sample.time;
  Modes modes(family, options);
  sfdae::Hybrid& hybrid = modes.hybrid;
  sfdae::Sensitivities wanted;
  wanted.parameters = {"p", "r", "", ""};
  wanted.adjoint = by_adjoint;
  wanted.max_kept_steps = max_kept_steps;
  wanted.directions = sfdae::Matrix(size, 4);
  for (int j = 2; j < 4; ++j)
    for (int i = 0; i < size; ++i) wanted.directions(i, j) = std::cos(3.0 * i + j);
  hybrid.set_sensitivities(wanted);
  const Reference reference(sample);
  sfdae::Point point{0.0, mixed(sample, reference.values()), {}};
  if (family.has_acceleration) point.x.push_back(acceleration(sample, reference.mode(), reference.values()));
  hybrid.start(reference.mode(), point, sample.time);
  const sfdae::Matrix at_start = by_adjoint ? sfdae::Matrix() : hybrid.sensitivities(0.0, false).S;
  hybrid.advance(sample.time, point);
  sfdae::Matrix weights(size, 4);
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < size; ++i) weights(i, k) = std::sin(1.0 + 2.3 * i + 1.7 * k);
  Gradients result;
  for (long k = 0; k < hybrid.num_passages(); ++k) result.way += std::to_string(hybrid.passage(k).to);
  if (by_adjoint) {
    result.values = hybrid.gradient({0.0, sample.time}, weights);
    return result;
  }
  const sfdae::Matrix at_end = hybrid.sensitivities(sample.time, false).S;
  result.values = sfdae::Matrix(4, 2);
  for (int q = 0; q < 2; ++q)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < size; ++i)
        result.values(j, q) += at_start(i, j) * weights(i, 2 * q) + at_end(i, j) * weights(i, 1 + 2 * q);
  return result;
}

TEST(RandomSlidingGradients, AreThoseOfForwardSensitivities) {
  // As many that leave the surface, that slide to the end, and that cross it.
  const int count = sfdae_test::scaled_count(6);
  std::mt19937 random(91);
  int sliding = 0, leaving = 0, crossing = 0;
  std::array<int, 3> runs{};
  std::vector<double> errors;
  for (int k = 0; k < 1000 && std::min({runs[0], runs[1], runs[2]}) < count; ++k) {
    const Family family{random_sample(random), random_sample(random), k % 2 == 1};
    const Course course = course_of(family, in_use);
    if (course.changes.back().empty()) continue;
    int& runs_of_kind = runs[!course.slides ? 0 : course.modes.back() == 2 ? 1 : 2];
    if (runs_of_kind++ >= count) continue;
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      SCOPED_TRACE("system " + std::to_string(k) + ", method " + std::to_string(method));
      const Gradients forward = gradients_of(family, method, 1e-7, false),
                      adjoint = gradients_of(family, method, 1e-7, true);
      EXPECT_EQ(adjoint.way, forward.way);
      // The same in every bit with steps that are made again.
      if (runs_of_kind == 1) {
        const Gradients again = gradients_of(family, method, 1e-7, true, 2);
        for (int q = 0; q < 2; ++q)
          for (int j = 0; j < 4; ++j) EXPECT_EQ(again.values(j, q), adjoint.values(j, q));
      }
      double size = 1.0, error = 0.0;
      for (int q = 0; q < 2; ++q)
        for (int j = 0; j < 4; ++j) {
          size = std::max(size, std::fabs(forward.values(j, q)));
          error = std::max(error, std::fabs(adjoint.values(j, q) - forward.values(j, q)));
        }
      EXPECT_LE(error / size, 1e-8) << forward.way;
      errors.push_back(error / size);
      const std::size_t met = forward.way.find('2');
      if (met != std::string::npos) ++sliding;
      else if (!forward.way.empty()) ++crossing;
      if (met != std::string::npos && met + 1 < forward.way.size()) ++leaving;
    }
  }
  std::sort(errors.begin(), errors.end());
  std::printf("%d slide, %d leave the surface, %d cross; largest difference %.3g, median %.3g\n", sliding, leaving,
              crossing, errors.back(), errors[errors.size() / 2]);
  EXPECT_GE(sliding, 3 * count);
  EXPECT_GE(leaving, count);
  EXPECT_GE(crossing, count);
}

}  // namespace
