// Models whose index or number of states changes from mode to mode.
// SPDX-License-Identifier: BSD-3-Clause
#include "model_builder.h"

namespace sfdae::cli::test {
namespace {

// Mass 1 on dry friction of force 1, driven by F = 3 sin t, with the equations of the Modelica Standard Library: it is
// stuck, starts, or slides.
TEST(Modes, FrictionSticksAndSlides) {
  Builder b;
  const Term v = b.real("v", {.start = 0.0, .fixed = true}), F = b.real("F"), f = b.real("f"), a = b.real("a"),
             s = b.real("s");
  const Term mode = b.integer("mode", {.start = 0.0, .fixed = true}),
             locked = b.boolean("locked", {.start = 1.0, .fixed = true});
  const Term starts_forward = b.boolean("starts_forward"), starts_backward = b.boolean("starts_backward");
  const Term was_stuck = equal(pre(mode), 0.0), was_forward = equal(pre(mode), 1.0),
             was_backward = equal(pre(mode), -1.0);
  b.equation(F, 3.0 * function(Operation::sin, time_now()));
  b.equation(der(v), a);
  b.equation(a, F - f);
  b.equation(a, choose(locked, 0.0,
                       choose(starts_forward, s - 1.0,
                              choose(starts_backward, s + 1.0, choose(was_forward, s - 1.0, s + 1.0)))));
  b.equation(f, choose(locked, s,
                       choose(starts_forward, 1.0, choose(starts_backward, -1.0, choose(was_forward, 1.0, -1.0)))));
  b.equation(starts_forward, both(was_stuck, either(s > 1.0, both(pre(starts_forward), s > 1.0))));
  b.equation(starts_backward, both(was_stuck, either(s < -1.0, both(pre(starts_backward), s < -1.0))));
  b.equation(locked, inverse(either(either(was_forward, starts_forward), either(was_backward, starts_backward))));
  b.equation(mode, choose(both(either(was_forward, starts_forward), v > 0.0), 1.0,
                          choose(both(either(was_backward, starts_backward), v < 0.0), -1.0, 0.0)));
  const Result result = solve(b.model, until(8.0, 1e-9));
  EXPECT_SOLVED(result);
  // Slides from t1 = asin(1/3): v = 3 (cos t1 - cos t) - (t - t1), until v = 0 at t2, where F < -1: it turns at once,
  // v = 3 (cos t2 - cos t) + (t - t2), until t3, where F > 1.
  const double t1 = std::asin(1.0 / 3.0);
  const auto forward = [&](double t) { return 3.0 * (std::cos(t1) - std::cos(t)) - (t - t1); };
  double t2 = 3.0, high = 5.0;
  for (int k = 0; k < 60; ++k) (forward(0.5 * (t2 + high)) > 0.0 ? t2 : high) = 0.5 * (t2 + high);
  ASSERT_LT(3.0 * std::sin(t2), -1.0);
  const auto backward = [&](double t) { return 3.0 * (std::cos(t2) - std::cos(t)) + (t - t2); };
  double t3 = 6.0, end = 8.5;
  for (int k = 0; k < 60; ++k) (backward(0.5 * (t3 + end)) < 0.0 ? t3 : end) = 0.5 * (t3 + end);
  const auto exact = [&](double t) {
    return t < t1 ? 0.0 : t < t2 ? forward(t) : t < t3 ? backward(t) : 3.0 * (std::cos(t3) - std::cos(t)) - (t - t3);
  };
  EXPECT_LE(largest_error(result, "v", exact), 1e-6);
  EXPECT_EQ(value(result, "mode", 2), 0.0);
  EXPECT_EQ(last(result, "mode"), t3 < 8.0 ? 1.0 : -1.0);
}

// Rectifier: source sin t, resistor 1, inductor 1 and an ideal diode in series; s is the current while it conducts, its
// voltage while it blocks, which fixes the inductor's current (index 2). While it conducts i' + i = sin t: i = (sin t -
// cos t + e^-t) / 2, until i = 0; then it blocks until 2 pi.
TEST(Modes, IdealDiodeChangesTheIndex) {
  Builder b;
  const Term i = b.real("i", {.start = 0.0}), u = b.real("u"), uL = b.real("uL"), s = b.real("s", {.start = 1.0});
  b.equation(function(Operation::sin, time_now()), i + uL + u);
  b.equation(uL, der(i));
  b.equation(i, choose(s < 0.0, 0.0, s));
  b.equation(u, choose(s < 0.0, s, 0.0));
  b.initial(i, 0.0);
  const Result result = solve(b.model, until(6.0, 1e-9));
  EXPECT_SOLVED(result);
  const auto current = [](double t) { return 0.5 * (std::sin(t) - std::cos(t) + std::exp(-t)); };
  double low = 3.0, high = 5.0;
  for (int k = 0; k < 60; ++k) (current(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
  EXPECT_LE(largest_error(result, "i", [&](double t) { return t < low ? current(t) : 0.0; }), 1e-6);
  EXPECT_NEAR(last(result, "u"), std::sin(6.0), 1e-6);
}

// Ideal diodes by a parameter s: u = s, i = 0 for s < 0; i = s, u = 0 for s >= 0. A bridge of four, a resistor of 1 and
// the source sin t with an inner resistance of 1: the load has |sin t| / 2.
TEST(Modes, BridgeOfFourDiodesRectifies) {
  Builder b;
  std::vector<Term> u, i;
  for (int k = 0; k < 4; ++k) {
    const std::string n = std::to_string(k);
    const Term s = b.real("s" + n), uk = b.real("u" + n), ik = b.real("i" + n);
    b.equation(uk, choose(s < 0.0, s, 0.0));
    b.equation(ik, choose(s < 0.0, 0.0, s));
    u.push_back(uk);
    i.push_back(ik);
  }
  const Term source = b.real("source"), in = b.real("in"), load = b.real("load"), plus = b.real("plus"),
             a = b.real("a"), c = b.real("c");
  // Nodes: a and c at the source, plus and 0 at the load. Diodes: a to plus, c to plus, 0 to a, 0 to c.
  b.equation(source, function(Operation::sin, time_now()));
  b.equation(a - c, source - in);
  b.equation(u[0], a - plus);
  b.equation(u[1], c - plus);
  b.equation(u[2], -a);
  b.equation(u[3], -c);
  b.equation(in + i[2], i[0]);
  b.equation(i[3], i[1] + in);
  b.equation(i[0] + i[1], load);
  b.equation(plus, load);
  const Result result = solve(b.model, until(6.0));
  EXPECT_SOLVED(result);
  EXPECT_LE(largest_error(result, "load", [](double t) { return 0.5 * std::fabs(std::sin(t)); }), 1e-9);
}

// if c then x = sin t else y = 0; x + y = 1.
TEST(Modes, BranchesOfEquationsMayDetermineDifferentUnknowns) {
  Builder b;
  const Term x = b.real("x"), y = b.real("y");
  b.equation(choose(time_now() < 1.0, x - function(Operation::sin, time_now()), y), 0.0);
  b.equation(x + y, 1.0);
  const Result result = solve(b.model, until(2.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(value(result, "y", 10), 1.0 - std::sin(0.4), 1e-12);
  EXPECT_EQ(last(result, "x"), 1.0);
}

// A pendulum of length 1 from (1, 0), one of whose states is set at t = 0.3.
enum class State { x, vx };
Result pendulum_with(State state, double value) {
  Builder b;
  const Term x = b.real("x", {.start = 1.0}), y = b.real("y", {.start = 0.0, .fixed = true}), vx = b.real("vx"),
             vy = b.real("vy", {.start = 0.0, .fixed = true}), F = b.real("F");
  b.equation(der(x), vx);
  b.equation(der(y), vy);
  b.equation(der(vx), -(F * x));
  b.equation(der(vy), -(F * y) - 9.81);
  b.equation(square(x) + square(y), 1.0);
  b.when({{{time_now() >= 0.3}, {reinit(state == State::x ? x : vx, value)}}});
  return solve(b.model, until(0.5));
}

// A pendulum is hit: vx is set, vy follows from the hidden constraint x vx + y vy = 0.
TEST(Modes, ReinitOfAConstrainedStateKeepsTheConstraints) {
  const Result result = pendulum_with(State::vx, 1.0);
  EXPECT_SOLVED(result);
  for (std::size_t k = 1; k < result.trajectory.t.size(); ++k) {
    EXPECT_NEAR(value(result, "x", k) * value(result, "vx", k) + value(result, "y", k) * value(result, "vy", k), 0.0,
                1e-10);
    if (result.trajectory.t[k] != 0.3 || result.trajectory.t[k - 1] != 0.3) continue;
    EXPECT_EQ(value(result, "vx", k), 1.0);
    EXPECT_EQ(value(result, "x", k), value(result, "x", k - 1));
  }
}

// A position of a pendulum is set: the other one has to follow, on the circle, and the velocity stays tangential.
TEST(Modes, ReinitOfAPositionMovesTheOtherOne) {
  const Result result = pendulum_with(State::x, 0.8);
  EXPECT_SOLVED(result);
  for (std::size_t k = 1; k < result.trajectory.t.size(); ++k) {
    const double xk = value(result, "x", k), yk = value(result, "y", k);
    EXPECT_NEAR(xk * xk + yk * yk, 1.0, 1e-10);
    EXPECT_NEAR(xk * value(result, "vx", k) + yk * value(result, "vy", k), 0.0, 1e-10);
    if (result.trajectory.t[k] != 0.3 || result.trajectory.t[k - 1] != 0.3) continue;
    EXPECT_EQ(xk, 0.8);
    EXPECT_NEAR(yk, -0.6, 1e-10);
  }
}

// The pulse of the Modelica Standard Library, its counter and its width by time events that events move: 0.2 on, 0.3
// off from 0.25 on. A timer counts from each rise.
TEST(Modes, PulsesAndTimersFollowTheirOwnEvents) {
  Builder b;
  const Term count = b.integer("count"), rise = b.discrete("rise"), entry = b.discrete("entry", {.start = 0.0}),
             y = b.real("y"), timer = b.real("timer"), x = b.real("x", {.start = 0.0, .fixed = true}),
             on = b.boolean("on");
  const Term t = time_now(), periods = function(Operation::integer, (t - 0.25) / 0.5);
  b.initial(count, periods);
  b.initial(rise, 0.25 + count * 0.5);
  b.when({{{periods > pre(count)}, {assign(count, pre(count) + 1.0), assign(rise, t)}}});
  b.equation(y, choose(t < 0.25, 0.0, choose(t < rise + 0.2, 1.0, 0.0)));
  b.equation(on, y > 0.5);
  b.when({{{on}, {assign(entry, t)}}});
  b.equation(timer, choose(on, t - entry, 0.0));
  b.equation(der(x), timer);
  const Result result = solve(b.model, until(2.2));
  EXPECT_SOLVED(result);
  EXPECT_EQ(last(result, "count"), 3.0);
  EXPECT_NEAR(last(result, "x"), 4.0 * 0.5 * 0.2 * 0.2, 1e-9);
}

TEST(Modes, TerminalConditionsActAtTheEnd) {
  Builder b;
  const Term x = b.real("x", {.start = 0.0, .fixed = true}),
             last_x = b.discrete("last_x", {.start = 0.0, .fixed = true});
  b.equation(der(x), 1.0);
  b.when({{{finally()}, {assign(last_x, x)}}});
  const Result result = solve(b.model, until(2.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "last_x"), 2.0, 1e-9);
}

}  // namespace
}  // namespace sfdae::cli::test
