// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/linkage.h"

#include <algorithm>
#include <limits>

#include "multibody/callbacks.h"
#include "sfdae/expression.hpp"

namespace sfdae_test {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

struct Draw {
  explicit Draw(std::mt19937& its_engine) : engine(its_engine) {}
  double number(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine); }
  double power(double from, double to) { return std::pow(10.0, number(from, to)); }
  int between(int from, int to) { return std::uniform_int_distribution<int>(from, to)(engine); }
  bool happens(int one_in) { return between(1, one_in) == 1; }
  Linkage::Point direction(int dimension) {
    Linkage::Point p{};
    double sum = 0.0;
    while (!(sum > 0.01 && sum <= 1.0)) {
      sum = 0.0;
      for (std::size_t k = 0; k < at(dimension); ++k) sum += square(p[k] = number(-1.0, 1.0));
    }
    for (double& value : p) value /= std::sqrt(sum);
    return p;
  }
  std::mt19937& engine;
};

Linkage::Point sum(const Linkage::Point& a, double factor, const Linkage::Point& b) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}

double distance(const Linkage::Point& a, const Linkage::Point& b) {
  return std::sqrt(square(a[0] - b[0]) + square(a[1] - b[1]) + square(a[2] - b[2]));
}

// The joints of a chain of `bars` bars, neighbours at an angle with a sine above 0.2; the last bar closes the
// polygon with the second anchor.
std::vector<Linkage::Point> polygon(Linkage& linkage, int bars, Draw& draw) {
  constexpr double least_sine = 0.2;
  std::vector<Linkage::Point> joints = {sum({}, draw.power(-2.0, 1.0), draw.direction(linkage.dimension))};
  Linkage::Point before{};
  for (int k = 0; k < bars; ++k) {
    Linkage::Point along = draw.direction(linkage.dimension);
    double cosine = 1.0;
    while (k > 0 && std::abs(cosine) > std::sqrt(1.0 - least_sine * least_sine)) {
      along = draw.direction(linkage.dimension);
      cosine = along[0] * before[0] + along[1] * before[1] + along[2] * before[2];
    }
    linkage.lengths.push_back(draw.power(-2.0, 1.0));
    joints.push_back(sum(joints.back(), linkage.lengths.back(), along));
    before = along;
  }
  return joints;
}

// As if the first anchor were where it is at t0.
Linkage::Point seen_from_drive(const Linkage& linkage, Linkage::Point anchor) {
  anchor[0] -= linkage.drive * std::sin(linkage.frequency * linkage.t0);
  return anchor;
}

void place_particles(Linkage& linkage, const std::vector<Linkage::Point>& p, Draw& draw) {
  const int n = linkage.bodies, dimension = linkage.dimension;
  for (int i = 0; i < n; ++i)
    linkage.q0.insert(linkage.q0.end(), p[at(i + 1)].begin(), p[at(i + 1)].begin() + dimension);
  const auto bar = [&](int a, int b) {
    Linkage::Joint joint{a, b, {}, {}, distance(p[at(a + 1)], p[at(b + 1)])};
    if (a < 0) joint.at_a = seen_from_drive(linkage, p.front());
    if (b == n) joint.b = -1, joint.at_b = p.back();
    linkage.joints.push_back(joint);
  };
  for (int i = 0; i <= n; ++i) bar(i - 1, i);
  if (n > 2 && draw.happens(3)) {
    const int from = draw.between(0, n - 3);
    bar(from, from + 2);
  }
}

// Bars between joints become bodies with a center somewhere near the bar and any orientation.
void place_bodies(Linkage& linkage, const std::vector<Linkage::Point>& p, Draw& draw) {
  const bool is_plane = linkage.kind == LinkageKind::plane_bodies;
  std::vector<std::array<Linkage::Point, 2>> ends;
  for (int i = 0; i < linkage.bodies; ++i) {
    const double length = linkage.lengths[at(i)];
    Linkage::Point center = sum(p[at(i)], draw.number(0.2, 0.8), sum(p[at(i + 1)], -1.0, p[at(i)]));
    center = sum(center, 0.2 * length, draw.direction(linkage.dimension));
    std::array<Linkage::Point, 2> own;
    if (is_plane) {
      const double phi = draw.number(-3.0, 3.0), c = std::cos(phi), s = std::sin(phi);
      linkage.q0.insert(linkage.q0.end(), {center[0], center[1], phi});
      for (int k = 0; k < 2; ++k) {
        const Linkage::Point d = sum(p[at(i + k)], -1.0, center);
        own[at(k)] = {c * d[0] + s * d[1], -s * d[0] + c * d[1], 0.0};
      }
    } else {
      std::array<double, 4> e{};
      double norm = 0.0;
      while (norm < 0.1) {
        norm = 0.0;
        for (double& value : e) norm += square(value = draw.number(-1.0, 1.0));
      }
      for (double& value : e) value /= std::sqrt(norm);
      linkage.q0.insert(linkage.q0.end(), center.begin(), center.end());
      linkage.q0.insert(linkage.q0.end(), e.begin(), e.end());
      const std::array<double, 4> back = {e[0], -e[1], -e[2], -e[3]};
      for (int k = 0; k < 2; ++k) own[at(k)] = Linkage::rotated(back.data(), sum(p[at(i + k)], -1.0, center));
    }
    ends.push_back(own);
  }
  for (int i = 0; i <= linkage.bodies; ++i) {
    Linkage::Joint joint{i - 1, i, {}, {}, 0.0};
    joint.at_a = i > 0 ? ends[at(i - 1)][1] : seen_from_drive(linkage, p.front());
    if (i < linkage.bodies) joint.at_b = ends[at(i)][0];
    else joint.b = -1, joint.at_b = p.back();
    linkage.joints.push_back(joint);
  }
}

void place_angles(Linkage& linkage, const std::vector<Linkage::Point>& p) {
  for (int i = 0; i < linkage.bodies; ++i)
    linkage.q0.push_back(std::atan2(p[at(i + 1)][1] - p[at(i)][1], p[at(i + 1)][0] - p[at(i)][0]));
  linkage.joints = {{-1, -1, seen_from_drive(linkage, p.front()), p.back(), 0.0}};
}

using Numbers = std::vector<sfdae::Expression>;

void write(const Numbers& from, sfdae_expression* to) {
  std::transform(from.begin(), from.end(), to, [](const sfdae::Expression& e) { return e.c(); });
}

int record(sfdae_record*, sfdae_expression t, const sfdae_expression* q, const sfdae_expression* v,
           const sfdae_multibody_formulas* formulas, void* user) {
  const Linkage& linkage = *static_cast<const Linkage*>(user);
  const int nq = linkage.positions(), nv = linkage.velocities();
  const Numbers positions(q, q + nq), velocities(v, v + nv);
  const auto none = [](int count) { return Numbers(at(count), sfdae::Expression(0.0)); };
  Numbers M = none(nv * nv), f = none(nv), g = none(linkage.holonomic()), S = none(nq * nv),
          H = none(linkage.nonholonomic() * nv);
  linkage.mass(positions.data(), M.data());
  linkage.force(positions.data(), velocities.data(), f.data());
  linkage.constraints(sfdae::Expression(t), positions.data(), g.data());
  linkage.nonholonomic(positions.data(), H.data());
  write(M, formulas->M);
  write(f, formulas->f);
  write(g, formulas->g);
  write(H, formulas->H);
  if (!linkage.has_kinematics()) return 0;
  linkage.kinematics(positions.data(), S.data());
  write(S, formulas->S);
  return 0;
}

}  // namespace

Linkage random_linkage(std::mt19937& engine) {
  Draw draw(engine);
  Linkage linkage;
  linkage.kind = static_cast<LinkageKind>(draw.between(0, 3));
  const bool is_particles = linkage.kind == LinkageKind::particles;
  if (linkage.has_kinematics() || (is_particles && draw.happens(2))) linkage.dimension = 3;
  linkage.bodies = draw.between(is_particles || linkage.has_kinematics() ? 2 : 3, linkage.has_kinematics() ? 3 : 5);
  linkage.t0 = draw.number(-3.0, 3.0);
  const int bars = linkage.bodies + (is_particles ? 1 : 0);
  const std::vector<Linkage::Point> p = polygon(linkage, bars, draw);
  if (draw.happens(3)) {
    linkage.drive = 0.3 * linkage.lengths.front();
    linkage.frequency = draw.number(0.5, 5.0);
  }
  for (int i = 0; i < linkage.bodies; ++i) {
    const double mass = draw.power(-3.0, 3.0), square_of_length = square(linkage.lengths[at(i)]);
    linkage.masses.push_back(mass);
    Linkage::Point J;
    for (double& value : J) value = mass * square_of_length * draw.number(0.05, 0.4);
    linkage.inertia.push_back(J);
  }
  if (is_particles) place_particles(linkage, p, draw);
  else if (linkage.kind == LinkageKind::angles) place_angles(linkage, p);
  else place_bodies(linkage, p, draw);
  const bool has_room = linkage.bodies > 3;
  if (linkage.kind == LinkageKind::plane_bodies && has_room && draw.happens(2))
    linkage.skate = draw.between(0, linkage.bodies - 1);
  const int independent = linkage.independent();
  for (int c = draw.happens(3) ? draw.between(1, 2) : 0; c > 0; --c) {
    std::vector<double> combination;
    for (int k = 0; k < independent; ++k) combination.push_back(draw.number(-1.0, 1.0));
    linkage.copies.push_back(combination);
  }
  return linkage;
}

Linkage plane_chain(LinkageKind kind, const std::vector<Linkage::Point>& p, std::mt19937& engine) {
  Draw draw(engine);
  Linkage linkage;
  linkage.kind = kind;
  const int bars = static_cast<int>(p.size()) - 1;
  linkage.bodies = bars - (kind == LinkageKind::particles ? 1 : 0);
  for (int k = 0; k < bars; ++k) linkage.lengths.push_back(distance(p[at(k)], p[at(k + 1)]));
  for (int k = 0; k < linkage.bodies; ++k) {
    linkage.masses.push_back(draw.power(-0.5, 0.5));
    const double J = linkage.masses.back() * square(linkage.lengths[at(k)]) * draw.number(0.1, 0.3);
    linkage.inertia.push_back({J, J, J});
  }
  if (kind == LinkageKind::angles) {
    place_angles(linkage, p);
    return linkage;
  }
  if (kind == LinkageKind::plane_bodies) {
    place_bodies(linkage, p, draw);
    return linkage;
  }
  for (int k = 0; k <= linkage.bodies; ++k) {
    Linkage::Joint bar{k - 1, k, {}, {}, linkage.lengths[at(k)]};
    if (k == 0) bar.at_a = p.front();
    if (k == linkage.bodies) bar.b = -1, bar.at_b = p.back();
    else linkage.q0.insert(linkage.q0.end(), {p[at(k + 1)][0], p[at(k + 1)][1]});
    linkage.joints.push_back(bar);
  }
  return linkage;
}

sfdae_multibody_problem Linkage::problem() const {
  sfdae_multibody_problem problem;
  sfdae_multibody_problem_init(&problem, sizeof problem);
  problem.num_positions = positions();
  problem.num_velocities = velocities();
  problem.num_constraints = holonomic();
  problem.num_nonholonomic = nonholonomic();
  problem.equations = record;
  problem.user = const_cast<Linkage*>(this);
  return problem;
}

LinkageTerms::LinkageTerms(const Linkage& linkage, double t, const double* q) {
  const int nq = linkage.positions(), nv = linkage.velocities(), nl = linkage.holonomic(),
            nk = linkage.nonholonomic();
  std::vector<Jet> path(at(nq)), row(at(nl));
  const auto differentiate = [&](int direction, double* slopes) {
    for (int j = 0; j < nq; ++j) path[at(j)] = along(q[j], j == direction ? 1.0 : 0.0, 1);
    linkage.constraints(along(t, direction < 0 ? 1.0 : 0.0, 1), path.data(), row.data());
    for (int i = 0; i < nl; ++i) slopes[i] = row[at(i)][1];
  };
  g.resize(at(nl)), g_t.resize(at(nl)), g_q.resize(at(nl * nq));
  linkage.constraints(t, q, g.data());
  differentiate(-1, g_t.data());
  for (int j = 0; j < nq; ++j) differentiate(j, g_q.data() + nl * j);
  S.assign(at(nq * nv), 0.0), M.assign(at(nv * nv), 0.0), C.assign(at((nl + nk) * nv), 0.0);
  if (linkage.has_kinematics()) linkage.kinematics(q, S.data());
  else
    for (int j = 0; j < nv; ++j) S[at(j * (nq + 1))] = 1.0;
  linkage.mass(q, M.data());
  std::vector<double> H(at(nk * nv), 0.0);
  linkage.nonholonomic(q, H.data());
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nl; ++i)
      for (int k = 0; k < nq; ++k) C[at(i + (nl + nk) * j)] += g_q[at(i + nl * k)] * S[at(k + nq * j)];
    for (int i = 0; i < nk; ++i) C[at(nl + i + (nl + nk) * j)] = H[at(i + nk * j)];
  }
  r = g_t;
  r.resize(at(nl + nk), 0.0);
  // Of the largest coordinate, the longest bar, and the anchors.
  double size = 0.0;
  for (int j = 0; j < nq; ++j) size = std::max(size, std::abs(q[j]));
  for (const double length : linkage.lengths) size = std::max(size, length);
  for (const Linkage::Joint& joint : linkage.joints)
    for (std::size_t k = 0; k < 3; ++k) size = std::max({size, std::abs(joint.at_a[k]), std::abs(joint.at_b[k])});
  rounding.assign(at(nl), 0.0);
  const double unit = 16.0 * std::numeric_limits<double>::epsilon() * size;
  for (int i = 0; i < nl; ++i)
    for (int j = 0; j < nq; ++j) rounding[at(i)] += unit * std::abs(g_q[at(i + nl * j)]);
  for (std::size_t c = 0; c < linkage.copies.size(); ++c)
    for (std::size_t k = 0; k < linkage.copies[c].size(); ++k)
      rounding[at(linkage.independent()) + c] += std::abs(linkage.copies[c][k]) * rounding[k];
}

}  // namespace sfdae_test
