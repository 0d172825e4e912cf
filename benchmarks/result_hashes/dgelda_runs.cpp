// SPDX-License-Identifier: BSD-3-Clause
// DGELDA with all its options and failures, DGEERM, DGENRM, and the routines that it is made of.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <type_traits>

#include "fortran_call.h"
#include "random_family.h"
#include "testset_linear.h"

namespace sfdae_bench {

std::string printed(const std::function<void()>& routine) {
  std::fflush(stdout);
  const int kept = dup(STDOUT_FILENO);
  std::FILE* const file = std::tmpfile();
  if (kept < 0 || file == nullptr) throw std::runtime_error("no temporary file");
  dup2(fileno(file), STDOUT_FILENO);
  routine();
  std::fflush(stdout);
  dup2(kept, STDOUT_FILENO);
  close(kept);
  std::rewind(file);
  std::string text;
  for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) {
    const bool is_space = c == '*' || c == '\n' || c == ' ';
    if (!is_space) text += static_cast<char>(c);
    else if (!text.empty() && text.back() != ' ') text += ' ';
  }
  std::fclose(file);
  return text;
}

namespace {

using namespace sfdae_test;

LinearFunction function_of(const Family& family) {
  return [family](char which, double t, int order, double* values) {
    if (order > max_family_order) return SFDAE_ORDER_NOT_AVAILABLE;
    if (which == 'E') family->E(t, order, values);
    if (which == 'A') family->A(t, order, values);
    if (which == 'f') family->f(t, order, values);
    return 0;
  };
}

// x1' = -x1 + cos t, 0 = x1 - x2: x = (cos t + sin t) / 2.
LinearFunction decay() {
  return [](char which, double t, int order, double* values) {
    if (which == 'E' && order == 0) values[0] = 1.0;
    if (which == 'A' && order == 0) values[0] = -1.0, values[1] = 1.0, values[3] = -1.0;
    if (which == 'f') values[0] = std::cos(t + order * 1.5707963267948966);
    return 0;
  };
}

template <class I>
using Change = std::function<void(DgeldaCall<I>&)>;

template <class I = std::int32_t>
void add_family(Runs& runs, const std::string& name, const Family& family, double t0, double tf,
                const std::type_identity_t<Change<I>>& change = nullptr, int max_index = 3, int max_order = 5) {
  if (family->m() != family->n()) return;
  for (const int method : {1, 2})
    runs.push_back({"dgelda_" + name + (method == 1 ? "_bdf" : "_radau"), [=](Trace& trace) {
                      DgeldaCall<I> call(trace, family->n(), function_of(family), method, max_order, max_index);
                      std::fill(call.x.begin(), call.x.end(), 1.0);
                      if (family->has_exact()) family->exact(t0, call.x.data(), nullptr);
                      call.t = t0;
                      if (change) change(call);
                      integrate(call, tf, 3);
                    }});
}

void add_problems(Runs& runs) {
  for (LinearTestProblem& p : linear_testset()) {
    const Family family = std::move(p.family);
    add_family(runs, family->name(), family, p.t0, p.t0 + 0.5 * (p.tf - p.t0), nullptr, 5);
  }
  for (int mu = 0; mu <= 3; ++mu) {
    add_family(runs, "kron_6_" + std::to_string(mu), Family(kron(6, mu)), 0.0, 0.7);
    add_family<std::int64_t>(runs, "kron_5_1_wide_" + std::to_string(mu), Family(kron(5, mu, 0.5, 1)), 0.0, 0.7);
  }
  const Family links = chain(4, 1);
  using Call = DgeldaCall<std::int32_t>;
  const auto option = [&](const std::string& name, const Change<std::int32_t>& change, int max_order = 5) {
    add_family<std::int32_t>(runs, "option_" + name, links, 0.0, 1.0, change, 3, max_order);
  };
  option("none", nullptr);
  option("vectors", [](Call& c) { c.set(2), c.rtol[3] = 1e-9, c.atol[1] = 1e-3; });
  option("steps", [](Call& c) { c.set(3); });
  option("stop", [](Call& c) { c.real(4, 1, 1.0); });
  option("max_step", [](Call& c) { c.real(7, 2, 0.05); });
  option("first_step", [](Call& c) { c.real(8, 3, 1e-6); });
  option("order_2", nullptr, 2);
  option("x_consistent", [](Call& c) { c.set(11); });
  option("x_inconsistent", [](Call& c) { c.set(11), c.x[0] += 0.1; });
  option("keep_differential", [](Call& c) { c.set(12), c.x[0] += 0.1, c.x[8] = 3.0; });
  option("nearest", [](Call& c) { c.x[0] += 0.1, c.x[8] = 3.0; });
  option("max_steps", [](Call& c) { c.integer(14, 20, 4); });
  option("safety", [](Call& c) { c.real(16, 11, 0.5), c.real(16, 12, 4.0), c.real(16, 13, 0.2); });
  option("quotients", [](Call& c) { c.real(17, 14, 0.9), c.real(17, 15, 1.5); });
  option("tolerance_tiny", [](Call& c) { c.tolerance(1e-17); });
  option("tolerance_tight", [](Call& c) { c.tolerance(1e-11); });
  option("unused", [](Call& c) { c.set(6), c.set(13), c.set(15), c.set(18), c.set(19), c.set(20); });
  option("start_only", [](Call& c) { c.call(0.0), c.x[2] += 0.1; });
  option("weight_zero", [](Call& c) { c.atol[0] = 0.0, std::fill(c.x.begin(), c.x.end(), 0.0); });
  add_family<std::int32_t>(runs, "option_constant", Family(chain(4, 1, 0.0)), 0.0, 1.0, [](Call& c) { c.set(5); });
  add_family<std::int32_t>(runs, "option_constant_start", Family(kron(5, 1, 0.0)), 0.0, 1.0,
                           [](Call& c) { c.set(5), c.call(0.0); });
  add_family<std::int32_t>(runs, "backward", links, 1.0, -0.2);
  add_family<std::int32_t>(runs, "index_too_high", Family(kron(6, 3)), 0.0, 1.0, nullptr, 1);
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    RandomOptions kind;
    kind.max_size = 7, kind.max_mu = 3;
    if (seed % 6 == 0) kind.rho = 1e-3;
    add_family(runs, "random_" + std::to_string(seed), Family(random_family(seed, kind)), 0.0, 0.5);
  }
}

void add_refusals(Runs& runs) {
  using Call = DgeldaCall<std::int32_t>;
  const auto add = [&runs](const std::string& name, const std::function<void(Call&)>& change, double tout = 1.0) {
    for (const int method : {1, 2})
      runs.push_back({"dgelda_refused_" + name + (method == 1 ? "_bdf" : "_radau"), [=](Trace& trace) {
                        Call call(trace, 2, decay(), method);
                        call.x = {0.5, 0.5};
                        change(call);
                        call.call(tout);
                        call.call(tout);
                      }});
  };
  for (const int k : {1, 2, 7, 12, 20})
    add("info_" + std::to_string(k), [=](Call& c) { c.info[size(k - 1)] = k == 1 ? -2 : 2; });
  add("never_started", [](Call& c) { c.info[0] = 1; });
  add("neq", [](Call& c) { c.n = 0; });
  add("order", [](Call& c) { c.integer(9, 3, 6); });
  add("index", [](Call& c) { c.integer(10, 4, -1); });
  add("lrw", [](Call& c) { --c.lrw; });
  add("liw", [](Call& c) { --c.liw; });
  add("liw_3", [](Call& c) { c.liw = 3; });
  add("max_step", [](Call& c) { c.real(7, 2, 0.0); });
  add("max_steps", [](Call& c) { c.integer(14, 20, 0); });
  add("safe", [](Call& c) { c.real(16, 11, 1.0), c.real(16, 12, 5.0), c.real(16, 13, 0.1); });
  add("factors", [](Call& c) { c.real(16, 11, 0.9), c.real(16, 12, 0.5), c.real(16, 13, 0.1); });
  add("quotients", [](Call& c) { c.real(17, 14, 1.5), c.real(17, 15, 2.0); });
  add("rtol", [](Call& c) { c.rtol[0] = -1.0; });
  add("atol", [](Call& c) { c.atol[0] = std::nan(""); });
  add("tolerances", [](Call& c) { c.rtol[0] = c.atol[0] = 0.0; });
  add("method", [](Call& c) { c.method = 3; });
  add(
      "near", [](Call& c) { c.t = 1.0; }, 1.0 + 4e-16);
  add("t_nan", [](Call& c) { c.t = std::nan(""); });
  add("weight", [](Call& c) { c.atol[0] = 0.0, c.x = {0.0, 0.0}; });
  add("first_step", [](Call& c) { c.real(8, 3, -0.1); });
  add("first_step_zero", [](Call& c) { c.real(8, 3, 0.0); });
  add("stop_behind", [](Call& c) { c.real(4, 1, -1.0); });
  add("stop_before", [](Call& c) { c.real(4, 1, 0.5); });
  add("tout_again", [](Call& c) { c.call(1.0); });
  add("tout_backward", [](Call& c) { c.call(1.5); });
  add("stop_passed", [](Call& c) { c.call(0.5), c.real(4, 1, 0.2); });
  add("state_damaged", [](Call& c) { c.call(0.5), c.rwork[40] += 1.0; });
  add("method_changed", [](Call& c) { c.call(0.5), c.method = 3 - c.method; });
}

void add_failures(Runs& runs) {
  using Call = DgeldaCall<std::int32_t>;
  const auto failing = [&runs](const std::string& name, int answer, char function, double after, double value) {
    for (const int method : {1, 2})
      runs.push_back({"dgelda_failing_" + name + (method == 1 ? "_bdf" : "_radau"), [=](Trace& trace) {
                        bool fails = true;
                        LinearFunction f = [&fails, answer, function, after, value](char which, double t, int order,
                                                                                    double* values) {
                          decay()(which, t, order, values);
                          if (!fails || which != function || t <= after) return 0;
                          values[0] += value;
                          return answer;
                        };
                        Call call(trace, 2, f, method);
                        call.x = {0.5, 0.5};
                        integrate(call, 1.0, 2);
                        fails = false;
                        call.info[0] = 1;
                        integrate(call, 1.0, 2);
                      }});
  };
  failing("late", 1, 'A', 0.6, 0.0);
  failing("at_start", 1, 'E', -1.0, 0.0);
  failing("missing", SFDAE_ORDER_NOT_AVAILABLE, 'f', -1.0, 0.0);
  failing("missing_late", SFDAE_ORDER_NOT_AVAILABLE, 'f', 0.6, 0.0);
  failing("nan", 0, 'f', 0.6, std::nan(""));
}

// ---- The routines for one point ----

using S = LinearSubroutines<I32>;

struct Arrays {
  Arrays(const Family& family, int levels)
      : functions(function_of(family)),
        rpar(rpar_of(functions)),
        n(family->n()),
        lmax(levels),
        ld(family->n() * (levels + 1)),
        AH(square()),
        EQ(square()),
        AQ(square()),
        ZQ(square()),
        FQ(size(ld)),
        E(size(n * n)),
        A(size(n * n)),
        Z1(size(n * n)),
        F(size(n)),
        lrwork(3 * ld * ld + 6 * ld) {}
  Arrays(const Arrays&) = delete;
  std::vector<double> square() const { return std::vector<double>(size(ld * ld)); }
  void trace_all(Trace& trace, const char* routine) const {
    trace.text("routine", routine);
    for (const I32 value : {ierr, m, d, a, u, ireq}) trace.integer("value", value);
    for (const auto& array : {AH, EQ, AQ, ZQ, FQ, E, A, Z1, F}) trace.numbers("array", array);
  }

  LinearFunction functions;
  double rpar;
  I32 n, lmax, ld;
  std::vector<double> AH, EQ, AQ, ZQ, FQ, E, A, Z1, F;
  I32 lrwork, m = 55, d = 55, a = 55, u = 55, ireq = 55, ierr = 33;
};

// From the reduced system found, and from the problem.
void trace_initial_values(Trace& trace, const Family& family, double t, const Arrays& found, I32 method) {
  const int n = family->n();
  I32 ierr = 0;  // stays if there is nothing to be done
  std::vector<double> x(size(n), 0.7);
  dnfini_(&found.n, &found.d, &found.a, &found.u, x.data(), found.E.data(), &found.n, found.A.data(), &found.n,
          found.F.data(), nullptr, nullptr, nullptr, &found.lrwork, &method, &ierr);
  trace.integer("DNFINI", ierr);
  trace.numbers("x", x);
  Arrays start(family, found.lmax);
  std::vector<double> guess(size(n), 0.7), xdot(size(n));
  dgeini_(S::matrix<'E'>, S::matrix<'A'>, S::vector, &start.n, &t, &start.lmax, guess.data(), xdot.data(), &start.m,
          &start.d, &start.a, &start.u, &start.ireq, start.EQ.data(), &start.ld, start.AQ.data(), &start.ld,
          start.FQ.data(), start.E.data(), &start.n, start.A.data(), &start.n, start.F.data(), start.Z1.data(),
          &start.n, start.ZQ.data(), &start.ld, nullptr, start.AH.data(), &start.ld, nullptr, nullptr, &start.rpar,
          nullptr, &start.lrwork, &method, &start.ierr);
  start.trace_all(trace, "DGEINI");
  trace.numbers("x", guess);
  trace.numbers("xdot", xdot);
  trace.number("DGENRM", dgenrm_(&start.n, guess.data(), xdot.data()));
}

void trace_routines(Trace& trace, const Family& family, double t, int levels) {
  {
    Arrays arrays(family, levels);
    for (I32 l = 0; l <= arrays.lmax; ++l)
      dnfpen_(S::matrix<'E'>, S::matrix<'A'>, S::vector, &arrays.n, &t, &l, arrays.AH.data(), &arrays.ld,
              arrays.EQ.data(), &arrays.ld, arrays.AQ.data(), &arrays.ld, arrays.FQ.data(), nullptr, &arrays.rpar,
              &arrays.ierr);
    arrays.trace_all(trace, "DNFPEN");
    I32 r = -1, s = -1;
    dnfval_(&arrays.n, &arrays.ld, arrays.EQ.data(), &arrays.ld, arrays.AQ.data(), &arrays.ld, &r, &arrays.a, &s,
            &arrays.d, &arrays.u, arrays.ZQ.data(), &arrays.ld, nullptr, &arrays.lrwork, &arrays.ierr);
    arrays.trace_all(trace, "DNFVAL");
    trace.integer("r", r);
    trace.integer("s", s);
  }
  Arrays found(family, levels);
  dnfind_(S::matrix<'E'>, S::matrix<'A'>, S::vector, &found.n, &t, &found.lmax, &found.m, &found.d, &found.a,
          &found.u, &found.ireq, found.AH.data(), &found.ld, found.EQ.data(), &found.ld, found.AQ.data(), &found.ld,
          found.FQ.data(), found.ZQ.data(), &found.ld, nullptr, &found.rpar, nullptr, &found.lrwork, &found.ierr);
  found.trace_all(trace, "DNFIND");
  if (found.ierr != 0 || found.m < 0) return;
  const I32 rows = found.n * (found.m + 1);
  std::vector<double> Z2 = found.ZQ, Z1 = found.Z1;
  I32 ierr = 33;
  dnfotr_(&found.n, &rows, &found.d, &found.a, &found.ireq, found.EQ.data(), &found.ld, found.AQ.data(), &found.ld,
          Z2.data(), &found.ld, Z1.data(), &found.n, nullptr, &found.ld, nullptr, &found.lrwork, &ierr);
  trace.integer("DNFOTR", ierr);
  trace.numbers("Z2", Z2);
  trace.numbers("Z1", Z1);
  dnfred_(&found.n, &rows, &found.d, &found.a, &found.u, &found.ireq, found.EQ.data(), &found.ld, found.AQ.data(),
          &found.ld, found.FQ.data(), found.ZQ.data(), &found.ld, found.Z1.data(), &found.n, found.E.data(), &found.n,
          found.A.data(), &found.n, found.F.data(), found.AH.data(), &found.ld, nullptr, &found.lrwork, &found.ierr);
  found.trace_all(trace, "DNFRED");

  Arrays again(family, levels);
  for (const I32 constant : {0, 1}) {
    const double later = t + 0.1;
    dnfix1_(S::matrix<'E'>, S::matrix<'A'>, S::vector, &again.n, &later, &again.lmax, &found.m, &found.d, &found.a,
            &found.u, &again.ireq, &again.m, &again.d, &again.a, &again.u, again.E.data(), &again.n, again.A.data(),
            &again.n, again.F.data(), again.EQ.data(), &again.ld, again.AQ.data(), &again.ld, again.FQ.data(),
            again.Z1.data(), &again.n, again.ZQ.data(), &again.ld, again.AH.data(), &again.ld, nullptr, &again.rpar,
            nullptr, &again.lrwork, &constant, &again.ierr);
    again.trace_all(trace, "DNFIX1");
  }
  for (const I32 method : {0, 1, 2}) trace_initial_values(trace, family, t, found, method);
}

void add_routines(Runs& runs) {
  const auto add = [&runs](const std::string& name, const Family& family, double t) {
    if (family->m() == family->n())
      runs.push_back({"routines_" + name, [=](Trace& trace) { trace_routines(trace, family, t, 3); }});
  };
  for (int mu = 0; mu <= 3; ++mu) add("kron_" + std::to_string(mu), Family(kron(5, mu)), 0.3);
  add("kron_free", Family(kron(6, 1, 0.5, 2)), 0.3);
  add("chain", Family(chain(2, 1)), 0.2);
  for (LinearTestProblem& p : linear_testset()) {
    const Family family = std::move(p.family);
    add(family->name(), family, p.t0 + 0.2);
  }
}

void add_messages(Runs& runs) {
  runs.push_back({"dgeerm_every_code", [](Trace& trace) {
                    const I32 neq = 3, liw = 26, lrw = 60, method = 1, iwarn = 0;
                    const double t = 1.25, tout = 2.5, x[] = {1.0, 0.0, 2.0}, slope[] = {0.0, 0.0, 0.0};
                    const I32 cval[] = {1, 0, 3, 0};
                    const std::vector<I32> iwork(26, 7), info(20, 0);
                    const std::vector<double> rwork(60, 0.5), rtol(3, 1e-3), atol(3, 0.0);
                    for (I32 ierr = 4; ierr > -1001; ierr == -150 ? ierr = -996 : --ierr)
                      trace.text(std::to_string(ierr).c_str(), printed([&] {
                                   dgeerm_(nullptr, nullptr, nullptr, &neq, &t, &tout, x, slope, cval, nullptr,
                                           nullptr, iwork.data(), &liw, rwork.data(), &lrw, rtol.data(), atol.data(),
                                           &method, info.data(), &iwarn, &ierr);
                                 }));
                  }});
}

}  // namespace

void add_dgelda_runs(Runs& runs) {
  add_problems(runs);
  add_refusals(runs);
  add_failures(runs);
  add_routines(runs);
  add_messages(runs);
}

}  // namespace sfdae_bench
