// SPDX-License-Identifier: BSD-3-Clause
// Source text of models: it compiles without warnings, in C and Fortran, its Jacobian is that of its residual, and it
// can be integrated by whoever has it, without the library.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "linalg/matrix.h"
#include "nonlinear_run.h"

namespace sfdae_test {

namespace {

using sfdae::core::Matrix;

std::string source_of(sfdae_solver* solver, int language) {
  std::size_t needed = 0;
  EXPECT_EQ(sfdae_export_source(solver, language, "Model", nullptr, 0, &needed), SFDAE_OK) << sfdae_message(solver);
  std::string text(needed, '\0');
  EXPECT_EQ(sfdae_export_source(solver, language, "Model", text.data(), needed, nullptr), SFDAE_OK);
  text.resize(needed - 1);
  return text;
}

// The text, compiled and loaded.
class Compiled {
 public:
  Compiled(const std::string& text, int language) : is_c_(language == SFDAE_SOURCE_C) {
    static int number = 0;
    directory_ = std::filesystem::path(SFDAE_TEST_OUTPUT) / ("source_" + std::to_string(number++));
    std::filesystem::create_directories(directory_);
    const std::string file = is_c_ ? "model.c" : "model.f90";
    std::ofstream(directory_ / file) << text;
    const std::string command = is_c_ ? SFDAE_C_COMPILER " -std=c99 -pedantic -Wall -Wextra -Werror"
                                      : SFDAE_FORTRAN_COMPILER " -std=f2008 -Wall -Wextra -Werror";
    const std::string rest = " -O1 -shared -fPIC -o model.so " + file + (is_c_ ? " -lm" : "") + " > messages 2>&1";
    if (std::system(("cd '" + directory_.string() + "' && " + command + rest).c_str()) != 0) {
      std::ifstream messages(directory_ / "messages");
      ADD_FAILURE() << std::string(std::istreambuf_iterator<char>(messages), {}) << text;
      return;
    }
    library_ = dlopen((directory_ / "model.so").c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library_ == nullptr) ADD_FAILURE() << dlerror();
  }
  ~Compiled() {
    if (library_ != nullptr) dlclose(library_);
    std::filesystem::remove_all(directory_);
  }
  Compiled(const Compiled&) = delete;
  Compiled& operator=(const Compiled&) = delete;
  bool is_loaded() const { return library_ != nullptr; }

  void start(double& t, std::vector<double>& z, std::vector<double>& zdot, std::vector<double>& p) const {
    function<void (*)(double*, double*, double*, double*)>("start")(&t, z.data(), zdot.data(), p.data());
  }
  std::vector<double> residual(double t, const std::vector<double>& z, const std::vector<double>& zdot,
                               const std::vector<double>& p) const {
    std::vector<double> r(z.size());
    if (is_c_)
      function<void (*)(double, const double*, const double*, const double*, double*)>("residual")(
          t, z.data(), zdot.data(), p.data(), r.data());
    else
      function<void (*)(const double*, const double*, const double*, const double*, double*)>("residual")(
          &t, z.data(), zdot.data(), p.data(), r.data());
    return r;
  }
  void jacobian(double t, const std::vector<double>& z, const std::vector<double>& zdot, const std::vector<double>& p,
                Matrix& F_zdot, Matrix& F_z) const {
    if (is_c_)
      function<void (*)(double, const double*, const double*, const double*, double*, double*)>("jacobian")(
          t, z.data(), zdot.data(), p.data(), F_zdot.data(), F_z.data());
    else
      function<void (*)(const double*, const double*, const double*, const double*, double*, double*)>("jacobian")(
          &t, z.data(), zdot.data(), p.data(), F_zdot.data(), F_z.data());
  }

 private:
  template <class Function>
  Function function(const std::string& name) const {
    const std::string symbol = is_c_ ? "Model_" + name : "__model_model_MOD_model_" + name;
    void* const address = dlsym(library_, symbol.c_str());
    EXPECT_NE(address, nullptr) << symbol;
    return reinterpret_cast<Function>(address);
  }

  bool is_c_;
  std::filesystem::path directory_;
  void* library_ = nullptr;
};

struct Point {
  double t;
  std::vector<double> z, zdot;
};

// Central differences of half the digits and more.
void expect_jacobian_of_residual(const Compiled& model, const Point& point, const std::vector<double>& p) {
  const int size = static_cast<int>(point.z.size());
  Matrix F_zdot(size, size), F_z(size, size);
  model.jacobian(point.t, point.z, point.zdot, p, F_zdot, F_z);
  for (const bool by_derivative : {false, true})
    for (int j = 0; j < size; ++j) {
      Point before = point, after = point;
      const double step = 6e-6 * std::max(1.0, std::fabs((by_derivative ? point.zdot : point.z)[std::size_t(j)]));
      (by_derivative ? before.zdot : before.z)[std::size_t(j)] -= step;
      (by_derivative ? after.zdot : after.z)[std::size_t(j)] += step;
      const std::vector<double> low = model.residual(before.t, before.z, before.zdot, p),
                                high = model.residual(after.t, after.z, after.zdot, p);
      for (int i = 0; i < size; ++i) {
        const double value = (by_derivative ? F_zdot : F_z)(i, j);
        const double slope = (high[std::size_t(i)] - low[std::size_t(i)]) / (2.0 * step);
        const double noise = (std::fabs(high[std::size_t(i)]) + 1.0) * 1e-16 / step;
        EXPECT_NEAR(value, slope, 1e-6 * std::fabs(value) + 1e-8 + 100.0 * noise)
            << i << " " << j << " " << by_derivative;
      }
    }
}

// The text in both languages: residual zero where it was made, equal to each other and with the right Jacobian near
// there.
void check_sources(NonlinearRun& run, std::size_t size, std::size_t num_parameters) {
  std::vector<double> in_c;
  const std::string c_text = source_of(run.solver(), SFDAE_SOURCE_C);
#ifdef SFDAE_FORTRAN_COMPILER
  const std::vector<int> languages{SFDAE_SOURCE_C, SFDAE_SOURCE_FORTRAN};
#else
  const std::vector<int> languages{SFDAE_SOURCE_C};
#endif
  for (int language : languages) {
    SCOPED_TRACE(language);
    const Compiled model(source_of(run.solver(), language), language);
    ASSERT_TRUE(model.is_loaded());
    Point point{0.0, std::vector<double>(size), std::vector<double>(size)};
    std::vector<double> p(num_parameters + 1);
    model.start(point.t, point.z, point.zdot, p);
    for (double r : model.residual(point.t, point.z, point.zdot, p)) EXPECT_NEAR(r, 0.0, 1e-9);
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> change(-0.1, 0.1);
    for (double& z : point.z) z += change(generator) * std::max(1.0, std::fabs(z));
    for (double& z : point.zdot) z += change(generator) * std::max(1.0, std::fabs(z));
    expect_jacobian_of_residual(model, point, p);
    const std::vector<double> r = model.residual(point.t, point.z, point.zdot, p);
    if (language == SFDAE_SOURCE_C) in_c = r;
    for (std::size_t i = 0; i < size; ++i) EXPECT_NEAR(r[i], in_c[i], 1e-12 * (1.0 + std::fabs(in_c[i])));
  }
}

// J x = r by Gaussian elimination, x in place of r.
void solve(Matrix& J, std::vector<double>& r) {
  const int size = J.rows();
  for (int k = 0; k < size; ++k) {
    int pivot = k;
    for (int i = k; i < size; ++i)
      if (std::fabs(J(i, k)) > std::fabs(J(pivot, k))) pivot = i;
    for (int j = 0; j < size; ++j) std::swap(J(k, j), J(pivot, j));
    std::swap(r[std::size_t(k)], r[std::size_t(pivot)]);
    for (int i = k + 1; i < size; ++i) {
      const double factor = J(i, k) / J(k, k);
      for (int j = k; j < size; ++j) J(i, j) -= factor * J(k, j);
      r[std::size_t(i)] -= factor * r[std::size_t(k)];
    }
  }
  for (int k = size - 1; k >= 0; --k) {
    for (int j = k + 1; j < size; ++j) r[std::size_t(k)] -= J(k, j) * r[std::size_t(j)];
    r[std::size_t(k)] /= J(k, k);
  }
}

// BDF of order 2 with constant steps, started with one of order 1: z' = (3 z - 4 z_1 + z_2) / (2 h).
std::vector<double> integrate(const Compiled& model, Point point, const std::vector<double>& p, double tend,
                              int steps) {
  const int size = static_cast<int>(point.z.size());
  const double h = (tend - point.t) / steps;
  std::vector<double> last = point.z, before_last = last;
  Matrix F_zdot(size, size), F_z(size, size);
  for (int step = 1; step <= steps; ++step) {
    before_last = last;
    last = point.z;
    const double t = point.t + step * h;
    const bool is_first = step == 1;
    const double c = (is_first ? 1.0 : 1.5) / h;
    for (int iteration = 0; iteration < 4; ++iteration) {
      for (std::size_t j = 0; j < point.z.size(); ++j)
        point.zdot[j] =
            is_first ? (point.z[j] - last[j]) / h : (3.0 * point.z[j] - 4.0 * last[j] + before_last[j]) / (2.0 * h);
      std::vector<double> r = model.residual(t, point.z, point.zdot, p);
      model.jacobian(t, point.z, point.zdot, p, F_zdot, F_z);
      Matrix J(size, size);
      for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j) J(i, j) = F_z(i, j) + c * F_zdot(i, j);
      solve(J, r);
      for (std::size_t j = 0; j < point.z.size(); ++j) point.z[j] -= r[j];
    }
  }
  return point.z;
}

// x1^2 + x2^2 = 1, as recorded: p' = v, v' = -x5 p + (0, -g).
void write_pendulum(sfdae_record* record, const Expression&, const Expression* x, const Expression* xdot,
                    Expression* F) {
  const Expression g = sfdae_parameter(record, "g", 9.81);
  F[0] = xdot[0] - x[2];
  F[1] = xdot[1] - x[3];
  F[2] = xdot[2] + x[0] * x[4];
  F[3] = xdot[3] + x[1] * x[4] + g;
  F[4] = x[0] * x[0] + x[1] * x[1] - 1.0;
}
NonlinearEquations pendulum() { return {5, 5, write_pendulum}; }

// A source of 5 V and 50 Hz, 1 uF parallel to it, and 100 Ohm, 10 mH, 1 uF in series.
NonlinearEquations circuit() {
  return {5, 5, [](sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
            constexpr double R = 100.0, L = 1e-2, C = 1e-6, w = 100.0 * std::numbers::pi;
            F[0] = C * xdot[0] + (x[0] - x[1]) / R + x[4];
            F[1] = (x[1] - x[0]) / R + x[3];
            F[2] = C * xdot[2] - x[3];
            F[3] = L * xdot[3] - (x[1] - x[2]);
            F[4] = x[0] - 5.0 * sin(w * t);
          }};
}

}  // namespace

TEST(Source, OfThePendulumIsRight) {
  NonlinearRun run(pendulum(), default_options());
  ASSERT_EQ(run.start(0.0, 1.0, {0.6, -0.8, 0.0, 0.0, 0.0}), SFDAE_OK);
  check_sources(run, 9, 1);
  ASSERT_EQ(run.advance(0.3), SFDAE_OK);
  check_sources(run, 9, 1);
  EXPECT_EQ(run.advance(0.6), SFDAE_OK);
}

TEST(Source, OfACircuitInUnitsOfThePhysicsIsRight) {
  NonlinearRun run(circuit(), default_options());
  ASSERT_EQ(run.start(0.0, 1.0, {0.0, 0.0, 0.0, 0.0, 0.0}), SFDAE_OK);
  check_sources(run, 6, 0);
  ASSERT_EQ(run.advance(0.003), SFDAE_OK);
  check_sources(run, 6, 0);
}

TEST(Source, OfEquationsWithManyKindsOfFormulasIsRight) {
  const auto equations = [](sfdae_record* record, const Expression& t, const Expression* x, const Expression* xdot,
                            Expression* F) {
    const Expression e = sfdae_parameter(record,
                                         "exponent */ \\ ?"
                                         "?/",
                                         1.5);
    F[0] = xdot[0] - x[1];
    F[1] = xdot[1] + x[2] - modulo(t + 0.1, Expression(7.0)) + floor(x[0] * 3.0) * max(x[1], x[0]);
    F[2] = xdot[3] + x[3] * abs(x[1] - 2.0) - pow(x[0] + 1.0, e);
    F[3] = x[0] * 2.0 + sinh(x[3]) / (2.0 + cos(x[0])) - atan2(x[0] + 1.0, t + 2.0) + log10(3.0 + x[0]) -
           min(x[0], Expression(5.0)) + tanh(x[3]) * 1e-3 - 1.0;
  };
  NonlinearRun run({4, 4, equations}, default_options());
  ASSERT_GE(run.start(0.0, 1.0, {0.5, 0.3, 0.1, 0.2}), SFDAE_OK) << run.message();
  check_sources(run, 8, 1);
}

// A capacitor between two nodes: the derivatives in both equations are the same, and the sum of the equations takes
// the place of one of them.
TEST(Source, OfReplacedEquationsIsRight) {
  const auto equations = [](sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot,
                            Expression* F) {
    F[0] = 2.0 * (xdot[0] - xdot[1]) + x[0] + exp(x[0]) - 1.0;
    F[1] = -2.0 * (xdot[0] - xdot[1]) + 3.0 * x[1] - sin(t);
  };
  NonlinearRun run({2, 2, equations}, default_options());
  ASSERT_GE(run.start(0.0, 1.0, {0.5, 0.3}), SFDAE_OK) << run.message();
  check_sources(run, 3, 0);
}

// x1'^2 = 1 + x1^2 has two solutions through every point; 0 = x2 - x1 x1'.
TEST(Source, KeepsTheBranchOfTheSolution) {
  const auto equations = [](sfdae_record*, const Expression&, const Expression* x, const Expression* xdot,
                            Expression* F) {
    F[0] = xdot[0] * xdot[0] - 1.0 - x[0] * x[0];
    F[1] = x[1] - x[0] * xdot[0];
  };
  for (const double slope : {1.0, -1.0}) {
    sfdae_options options = default_options();
    options.xdot_is_guess = 1;
    NonlinearRun run({2, 2, equations}, options);
    run.xdot = {slope, 0.0};
    ASSERT_GE(run.start(0.0, 1.0, {0.0, 0.0}), SFDAE_OK) << run.message();
    ASSERT_EQ(run.advance(0.5), SFDAE_OK);
    const Compiled model(source_of(run.solver(), SFDAE_SOURCE_C), SFDAE_SOURCE_C);
    Point point{0.0, std::vector<double>(2), std::vector<double>(2)};
    std::vector<double> p(1);
    model.start(point.t, point.z, point.zdot, p);
    EXPECT_NEAR(point.zdot[0], slope * std::cosh(point.t), 1e-4);
    for (double r : model.residual(point.t, point.z, point.zdot, p)) EXPECT_NEAR(r, 0.0, 1e-12);
  }
}

// The exported text is all that is used from the start on; error of BDF 2: C h^2.
TEST(Source, OfThePendulumCanBeIntegratedWithoutTheLibrary) {
  NonlinearRun run(pendulum(), options_with(1e-10));
  ASSERT_EQ(run.start(0.0, 0.3, {0.6, -0.8, 0.0, 0.0, 0.0}), SFDAE_OK);
  const Compiled model(source_of(run.solver(), SFDAE_SOURCE_C), SFDAE_SOURCE_C);
  ASSERT_TRUE(model.is_loaded());
  ASSERT_EQ(run.advance(0.3), SFDAE_OK);
  Point start{0.0, std::vector<double>(9), std::vector<double>(9)};
  std::vector<double> p(1);
  model.start(start.t, start.z, start.zdot, p);
  double errors[2] = {};
  for (int k = 0; k < 2; ++k) {
    const std::vector<double> z = integrate(model, start, p, 0.3, 100 << k);
    for (std::size_t j = 0; j < 5; ++j) errors[k] = std::max(errors[k], std::fabs(z[j] - run.x[j]));
    EXPECT_NEAR(z[0] * z[0] + z[1] * z[1], 1.0, 1e-12);
    EXPECT_NEAR(z[0] * z[2] + z[1] * z[3], 0.0, 1e-12);
  }
  EXPECT_LT(errors[1], 1e-3);
  EXPECT_NEAR(errors[0] / errors[1], 4.0, 1.0);
}

TEST(Source, OfACircuitCanBeIntegratedWithoutTheLibrary) {
  NonlinearRun run(circuit(), options_with(1e-9));
  ASSERT_EQ(run.start(0.0, 2e-3, {0.0, 0.0, 0.0, 0.0, 0.0}), SFDAE_OK);
  const Compiled model(source_of(run.solver(), SFDAE_SOURCE_C), SFDAE_SOURCE_C);
  ASSERT_TRUE(model.is_loaded());
  ASSERT_EQ(run.advance(2e-3), SFDAE_OK);
  Point start{0.0, std::vector<double>(6), std::vector<double>(6)};
  std::vector<double> p(1);
  model.start(start.t, start.z, start.zdot, p);
  double errors[2] = {};
  for (int k = 0; k < 2; ++k) {
    const std::vector<double> z = integrate(model, start, p, 2e-3, 1000 << k);
    for (std::size_t j = 0; j < 5; ++j) errors[k] = std::max(errors[k], std::fabs(z[j] - run.x[j]));
  }
  EXPECT_LT(errors[1], 1e-4);
  EXPECT_NEAR(errors[0] / errors[1], 4.0, 1.0);
}

}  // namespace sfdae_test
