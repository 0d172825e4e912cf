// Random linkages of point masses in curved coordinates, with redundant constraints and quasi-velocities, move as the
// same linkages do in Cartesian coordinates.
//
//     p = Phi(s),   s' = S(s) u,   p' = Phi'(s) S(s) u = W u
//     W^T M W u' = W^T (F - M W' u) - (g_p W)^T lambda,   0 = g(t, Phi(s))
//
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "family_run.h"
#include "multibody_run.h"
#include "sfdae/sfdae.hpp"

namespace sfdae::test {
namespace {

constexpr int most_unknowns = 12;

// A number with its derivatives by q and t.
struct Dual {
  Dual(double number = 0.0) : value(number) {}
  double value;
  double slope[most_unknowns + 1] = {};
};
Dual chain(const Dual& a, double value, double slope) {
  Dual result(value);
  for (int i = 0; i <= most_unknowns; ++i) result.slope[i] = slope * a.slope[i];
  return result;
}
Dual operator+(Dual a, const Dual& b) {
  a.value += b.value;
  for (int i = 0; i <= most_unknowns; ++i) a.slope[i] += b.slope[i];
  return a;
}
Dual operator*(const Dual& a, const Dual& b) {
  Dual result(a.value * b.value);
  for (int i = 0; i <= most_unknowns; ++i) result.slope[i] = a.slope[i] * b.value + a.value * b.slope[i];
  return result;
}
Dual operator-(const Dual& a, const Dual& b) { return a + Dual(-1.0) * b; }
Dual sin(const Dual& a) { return chain(a, std::sin(a.value), std::cos(a.value)); }

template <class Number>
using Numbers = std::vector<Number>;

std::size_t as_index(int i) { return static_cast<std::size_t>(i); }

struct LinkageBar {
  int from, to;  // to = -1: an anchor
  double length;
};

struct Linkage {
  int dimension = 2, bodies = 1;
  bool moves = false;  // the anchor
  std::vector<LinkageBar> bars;
  Numbers<double> masses;
  // Phi, S, and the constraints: units, and combinations of others, which come last.
  Numbers<double> enforce, frequency, phase, skew, units;
  int copies = 0;

  int size() const { return dimension * bodies; }
  int constraints() const { return static_cast<int>(bars.size()) + copies; }
  bool has_kinematics() const { return !skew.empty(); }

  template <class Number>
  Numbers<Number> position(const Numbers<Number>& s) const {
    using std::sin;
    Numbers<Number> p(s);
    const int n = size();
    for (int i = 0; i < n && !enforce.empty(); ++i)
      p[as_index(i)] = p[as_index(i)] +
                       Number(enforce[as_index(i)]) * sin(Number(frequency[as_index(i)]) * s[as_index((i + 1) % n)] +
                                                          Number(phase[as_index(i)]));
    return p;
  }

  template <class Number>
  Numbers<Number> residuals(const Number& t, const Numbers<Number>& s) const {
    using std::sin;
    const Numbers<Number> p = position(s);
    Numbers<Number> g;
    for (const LinkageBar& bar : bars) {
      Number sum(-bar.length * bar.length);
      for (int k = 0; k < dimension; ++k) {
        Number other(0.0);
        if (bar.to >= 0) other = p[as_index(bar.to * dimension + k)];
        else if (moves && k == 0) other = Number(0.1) * sin(Number(2.0) * t);
        const Number difference = p[as_index(bar.from * dimension + k)] - other;
        sum = sum + difference * difference;
      }
      g.push_back(Number(0.5) * sum);
    }
    const int independent = static_cast<int>(bars.size());
    for (int c = 0; c < copies; ++c) {
      Number sum(0.0);
      for (int k = 0; k < independent; ++k)
        sum = sum + (Number(1.0 + 0.3 * k) + Number(0.3) * sin(s[0] + Number(c))) * g[as_index(k)];
      g.push_back(sum);
    }
    for (std::size_t k = 0; k < g.size(); ++k) g[k] = Number(units[k]) * g[k];
    return g;
  }

  // S and its derivative along s' times u.
  template <class Number>
  Numbers<Number> kinematics(const Numbers<Number>& s) const {
    using std::cos;
    const int n = size();
    Numbers<Number> S(as_index(n * n), Number(0.0));
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        S[as_index(i + j * n)] = Number(i == j ? 1.0 : 0.0);
        if (has_kinematics())
          S[as_index(i + j * n)] = S[as_index(i + j * n)] + Number(skew[as_index(i + j * n)]) * cos(s[as_index(j)]);
      }
    return S;
  }

  // W, and F - M W' u in its place in `force`.
  template <class Number>
  Numbers<Number> directions(const Numbers<Number>& s, const Numbers<Number>& u, Numbers<Number>& force) const {
    using std::cos;
    using std::sin;
    const int n = size();
    const Numbers<Number> S = kinematics(s);
    Numbers<Number> W(S), rates(as_index(n), Number(0.0)), bends(as_index(n), Number(0.0)), accelerations;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) rates[as_index(i)] = rates[as_index(i)] + S[as_index(i + j * n)] * u[as_index(j)];
    for (int i = 0; i < n && has_kinematics(); ++i)
      for (int j = 0; j < n; ++j)
        bends[as_index(i)] = bends[as_index(i)] - Number(skew[as_index(i + j * n)]) * sin(s[as_index(j)]) *
                                                      rates[as_index(j)] * u[as_index(j)];
    accelerations = bends;
    for (int i = 0; i < n && !enforce.empty(); ++i) {
      const int next = (i + 1) % n;
      const Number w(frequency[as_index(i)]), angle = w * s[as_index(next)] + Number(phase[as_index(i)]);
      const Number slope = Number(enforce[as_index(i)]) * w * cos(angle);
      for (int j = 0; j < n; ++j) W[as_index(i + j * n)] = W[as_index(i + j * n)] + slope * S[as_index(next + j * n)];
      accelerations[as_index(i)] =
          accelerations[as_index(i)] + slope * bends[as_index(next)] -
          Number(enforce[as_index(i)]) * w * w * sin(angle) * rates[as_index(next)] * rates[as_index(next)];
    }
    for (int i = 0; i < n; ++i) {
      const double mass = masses[as_index(i / dimension)], weight = i % dimension == dimension - 1 ? -mass : 0.0;
      force[as_index(i)] = Number(weight) - Number(mass) * accelerations[as_index(i)];
    }
    return W;
  }

  template <class Number>
  void equations(const Numbers<Number>& s, const Numbers<Number>& u, Numbers<Number>& M, Numbers<Number>& f) const {
    const int n = size();
    Numbers<Number> force(as_index(n), Number(0.0));
    const Numbers<Number> W = directions(s, u, force);
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        f[as_index(j)] = f[as_index(j)] + W[as_index(k + j * n)] * force[as_index(k)];
        for (int i = 0; i < n; ++i)
          M[as_index(i + j * n)] = M[as_index(i + j * n)] + W[as_index(k + i * n)] *
                                                                Number(masses[as_index(k / dimension)]) *
                                                                W[as_index(k + j * n)];
      }
  }
};

const Linkage& linkage_of(void* user) { return *static_cast<const Linkage*>(user); }
Numbers<double> numbers(const double* from, int count) { return Numbers<double>(from, from + count); }

int record(sfdae_record*, sfdae_expression t, const sfdae_expression* q, const sfdae_expression* v,
           const sfdae_multibody_formulas* formulas, void* user) {
  const Linkage& linkage = linkage_of(user);
  const int n = linkage.size();
  const Numbers<Expression> s(q, q + n), u(v, v + n);
  Numbers<Expression> M(as_index(n * n)), f(as_index(n));
  linkage.equations(s, u, M, f);
  const Numbers<Expression> g = linkage.residuals(Expression(t), s), S = linkage.kinematics(s);
  for (int i = 0; i < n * n; ++i) formulas->M[i] = M[as_index(i)].c();
  for (int i = 0; i < n * n && linkage.has_kinematics(); ++i) formulas->S[i] = S[as_index(i)].c();
  for (int i = 0; i < n; ++i) formulas->f[i] = f[as_index(i)].c();
  for (int i = 0; i < linkage.constraints(); ++i) formulas->g[i] = g[as_index(i)].c();
  return 0;
}

Numbers<Dual> differentiated(const Linkage& linkage, double t, const double* q) {
  const int n = linkage.size();
  Numbers<Dual> s(q, q + n);
  for (int i = 0; i < n; ++i) s[as_index(i)].slope[i] = 1.0;
  Dual time(t);
  time.slope[most_unknowns] = 1.0;
  return linkage.residuals(time, s);
}

void set_callbacks(sfdae_multibody_problem& problem, const Linkage& linkage) {
  problem.mass = [](double, const double* q, double* M, void* user) {
    const int n = linkage_of(user).size();
    Numbers<double> result(as_index(n * n)), f(as_index(n));
    linkage_of(user).equations(numbers(q, n), Numbers<double>(as_index(n)), result, f);
    std::copy(result.begin(), result.end(), M);
    return 0;
  };
  problem.forces = [](double, const double* q, const double* v, double* f, void* user) {
    const int n = linkage_of(user).size();
    Numbers<double> M(as_index(n * n)), result(as_index(n));
    linkage_of(user).equations(numbers(q, n), numbers(v, n), M, result);
    std::copy(result.begin(), result.end(), f);
    return 0;
  };
  problem.constraints = [](double t, const double* q, double* g, void* user) {
    const Numbers<double> result = linkage_of(user).residuals(t, numbers(q, linkage_of(user).size()));
    std::copy(result.begin(), result.end(), g);
    return 0;
  };
  problem.constraint_jacobian = [](double t, const double* q, double* g_q, void* user) {
    const Numbers<Dual> g = differentiated(linkage_of(user), t, q);
    for (std::size_t i = 0; i < g.size(); ++i)
      for (int j = 0; j < linkage_of(user).size(); ++j) g_q[i + as_index(j) * g.size()] = g[i].slope[j];
    return 0;
  };
  if (linkage.moves)
    problem.constraint_rate = [](double t, const double* q, double* g_t, void* user) {
      for (const Dual& g : differentiated(linkage_of(user), t, q)) *g_t++ = g.slope[most_unknowns];
      return 0;
    };
  if (linkage.has_kinematics())
    problem.kinematics = [](double, const double* q, double* S, void* user) {
      const Numbers<double> result = linkage_of(user).kinematics(numbers(q, linkage_of(user).size()));
      std::copy(result.begin(), result.end(), S);
      return 0;
    };
}

sfdae_multibody_problem problem_of(Linkage& linkage, bool recorded) {
  sfdae_multibody_problem problem = multibody_problem_of(linkage.size(), linkage.constraints());
  problem.user = &linkage;
  if (recorded) problem.equations = record;
  else set_callbacks(problem, linkage);
  return problem;
}

// Solves a small system by elimination with pivots.
Numbers<double> solution(Numbers<double> A, Numbers<double> b) {
  const int n = static_cast<int>(b.size());
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (std::fabs(A[as_index(i + k * n)]) > std::fabs(A[as_index(pivot + k * n)])) pivot = i;
    for (int j = 0; j < n; ++j) std::swap(A[as_index(k + j * n)], A[as_index(pivot + j * n)]);
    std::swap(b[as_index(k)], b[as_index(pivot)]);
    for (int i = 0; i < n; ++i) {
      if (i == k) continue;
      const double factor = A[as_index(i + k * n)] / A[as_index(k + k * n)];
      for (int j = k; j < n; ++j) A[as_index(i + j * n)] -= factor * A[as_index(k + j * n)];
      b[as_index(i)] -= factor * b[as_index(k)];
    }
  }
  for (int k = 0; k < n; ++k) b[as_index(k)] /= A[as_index(k + k * n)];
  return b;
}

struct Draw {
  explicit Draw(unsigned seed) : engine(seed) {}
  double number(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine); }
  int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(engine); }
  Numbers<double> some(int count, double size) {
    Numbers<double> result;
    for (int i = 0; i < count; ++i) result.push_back(number(-size, size));
    return result;
  }
  std::mt19937 engine;
};

// Bodies hang on the anchor or on one before; some bars more close loops.
Linkage plain_linkage(Draw& draw, Numbers<double>& p) {
  Linkage linkage;
  linkage.dimension = 2 + draw.below(2);
  linkage.bodies = 1 + draw.below(linkage.dimension == 2 ? 5 : 4);
  linkage.moves = draw.below(4) == 0;
  for (int i = 0; i < linkage.bodies; ++i) {
    linkage.masses.push_back(std::pow(10.0, draw.number(-1.0, 1.0)));
    for (int k = 0; k < linkage.dimension; ++k) p.push_back(draw.number(-0.5, 0.5) + (k == 0 ? i + 1.0 : 0.0));
    linkage.bars.push_back({i, draw.below(i + 1) - 1, 0.0});
  }
  if (linkage.bodies > 2 && draw.below(3) == 0) linkage.bars.push_back({linkage.bodies - 1, draw.below(2) - 1, 0.0});
  const auto same = [&](const LinkageBar& bar) {
    return std::count_if(linkage.bars.begin(), linkage.bars.end(),
                         [&](const LinkageBar& other) { return other.from == bar.from && other.to == bar.to; }) > 1;
  };
  if (same(linkage.bars.back())) linkage.bars.pop_back();
  for (LinkageBar& bar : linkage.bars) {
    double sum = 0.0;
    for (int k = 0; k < linkage.dimension; ++k) {
      const double other = bar.to < 0 ? 0.0 : p[as_index(bar.to * linkage.dimension + k)];
      sum += std::pow(p[as_index(bar.from * linkage.dimension + k)] - other, 2);
    }
    bar.length = std::sqrt(sum);
  }
  linkage.units.assign(linkage.bars.size(), 1.0);
  return linkage;
}

Linkage disguised(const Linkage& plain, Draw& draw) {
  Linkage linkage = plain;
  const int n = linkage.size();
  if (draw.below(3) > 0) {
    linkage.enforce = draw.some(n, 0.3);
    linkage.frequency = draw.some(n, 1.5);
    linkage.phase = draw.some(n, 3.0);
  }
  if (draw.below(2) > 0) linkage.skew = draw.some(n * n, 0.5 / n);
  linkage.copies = draw.below(3);
  const double size = draw.below(2) > 0 ? 6.0 : 0.0;
  linkage.units.clear();
  for (int k = 0; k < linkage.constraints(); ++k) linkage.units.push_back(std::pow(10.0, draw.number(-size, size)));
  return linkage;
}

// s and u of p and p'.
Numbers<double> seen_from(const Linkage& linkage, const double* x) {
  const int n = linkage.size();
  const Numbers<double> p = numbers(x, n);
  Numbers<double> s(p), force(as_index(n));
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Numbers<double> there = linkage.position(s);
    for (int i = 0; i < n; ++i) s[as_index(i)] += p[as_index(i)] - there[as_index(i)];
  }
  const Numbers<double> u = solution(linkage.directions(s, force, force), numbers(x + n, n));
  s.insert(s.end(), u.begin(), u.end());
  return s;
}

TEST(RandomLinkages, MoveAsInCartesianCoordinates) {
  const int count = sfdae_test::scaled_count(40);
  constexpr double end = 1.0, tol = 1e-7;
  for (int seed = 0; seed < count; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(static_cast<unsigned>(seed));
    Numbers<double> x;
    Linkage plain = plain_linkage(draw, x);
    const Numbers<double> v = draw.some(plain.size(), 1.0);
    x.insert(x.end(), v.begin(), v.end());
    MultibodyRun reference(problem_of(plain, true), options_of(SFDAE_METHOD_RADAU, 1e-11));
    ASSERT_EQ(reference.start(0.0, end, x), SFDAE_VALUES_CHANGED) << reference.message();
    const Numbers<double> begin = reference.x;
    ASSERT_EQ(reference.advance(end), SFDAE_OK) << reference.message();
    Linkage linkage = disguised(plain, draw);
    const bool recorded = draw.below(2) == 0;
    sfdae_multibody_problem problem = problem_of(linkage, recorded);
    problem.coordinates = draw.below(2);
    MultibodyRun run(problem, options_of(draw.below(2), tol));
    ASSERT_EQ(run.start(0.0, end, seen_from(linkage, begin.data())), SFDAE_OK) << run.message();
    EXPECT_EQ(run.report().redundant, linkage.copies);
    ASSERT_EQ(run.advance(end), SFDAE_OK) << run.message();
    const Numbers<double> p = linkage.position(numbers(run.x.data(), linkage.size()));
    double error = 0.0;
    for (int i = 0; i < linkage.size(); ++i)
      error = std::max(error, std::fabs(p[as_index(i)] - reference.x[as_index(i)]));
    // The factor is that of neighbouring motions that part.
    EXPECT_LE(error, 1e3 * tol);
    EXPECT_LE(run.report().position_residual, 1e-12);
  }
}

}  // namespace
}  // namespace sfdae::test
