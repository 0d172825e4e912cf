// Arguments and options of DGELDA and SFNDAE: INFO, IWORK and RWORK as inputs, and what is wrong with them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "f77/integer_array.h"
#include "f77/user_functions.h"
#include "integrate/integration.h"

namespace sfdae::f77 {

inline constexpr int bdf_method = 1;
inline constexpr int radau_method = 2;
// Larger orders are a mistake, or an INTEGER of another width.
inline constexpr int largest_order = 5000;
inline constexpr int num_info = 20;
inline constexpr int max_cval = 5;
// IWORK is at least as long, else nothing in it is read; IWORK(5) keeps the last IERR.
inline constexpr int shortest_iwork = 20;
inline constexpr int last_ierr = 5;

namespace code {
inline constexpr int ok = 0;
inline constexpr int bad_info = -101, bad_order = -102, bad_max_order = -103, bad_max_index = -104;
inline constexpr int short_rwork = -105, short_iwork = -106, bad_rtol = -107, bad_atol = -108, no_tolerance = -109;
inline constexpr int stop_before_tout = -110, bad_max_step = -111, wrong_direction = -112, zero_first_step = -113;
inline constexpr int zero_weight = -114, tout_too_close = -115, stop_behind = -116, tout_is_t = -119;
inline constexpr int bad_max_steps = -120, bad_safety = -121, bad_ratios = -122, bad_quotients = -123;
inline constexpr int bad_method = -132, bad_equations = -133, wrong_width = wrong_integer_width;
// An input that is illegal, whatever the problem.
constexpr bool is_illegal_input(std::int64_t ierr) { return ierr <= -100 && ierr > -200; }
}  // namespace code

struct Arguments;
struct Options;

// Lengths of RWORK and IWORK that are asked for; the former as a number, since it may exceed any INTEGER.
struct Lengths {
  double rwork;
  std::int64_t iwork;
};

// What is different for the routines.
struct Routine {
  std::int64_t state_word;  // that their states begin with
  int num_cval;             // mu, d, a, u, and perhaps v
  bool knows_constants;     // INFO(5)
  bool warns;               // IWARN = 1 where the solution is not unique
  Lengths (*lengths)(const Arguments& arguments, const Options& options);
};
extern const Routine dgelda_routine, sfndae_routine, sfndaf_routine, sfmdae_routine;

// The arguments of a call but for the user's functions; pointers are the caller's.
struct Arguments {
  const Routine* routine;
  int m = 0, n = 0;
  int method = 0;
  bool may_be_wide = false;     // INTEGERs of the caller look as if they could have 64 bits, not 32
  int info[num_info + 1] = {};  // info[k] = INFO(k)
  std::int64_t liw = 0, lrw = 0;
  double tout = 0.0;
  double* t;
  double* x;
  double* xprime;
  double* rtol;
  double* atol;
  IntegerArray cval;
  IntegerArray iwork;
  double* rwork_values;

  double& rwork(std::int64_t position) const { return rwork_values[position - 1]; }
  bool flag(int k) const { return info[k] == 1; }
  double rtol_of(int i) const { return rtol[flag(2) ? i : 0]; }
  double atol_of(int i) const { return atol[flag(2) ? i : 0]; }
  double weight(int i, double xi) const { return rtol_of(i) * (xi < 0.0 ? -xi : xi) + atol_of(i); }
};

struct Options {
  int max_order = 5;
  int max_index = 3;
  std::int64_t max_steps = 10000;
  double max_step = 0.0;      // 0: none
  double initial_step = 0.0;  // H0 with its sign
  bool has_initial_step = false;
  std::optional<double> stop_time;
  core::StepOptions stepping;
};

// Reads and checks INFO(2..20), numbers of equations and unknowns, work arrays and tolerances in the documented
// order: code::ok or what is wrong.
// Values that are chosen by default are read from the work arrays after the first call.
int read_options(const Arguments& arguments, bool is_first_call, Options& options);
// Documented defaults, for the caller to see.
void store_options(const Arguments& arguments, const Options& options);

// What is wrong with TOUT, H0 and TSTOP where an integration starts at t from x.
int check_start(const Arguments& arguments, const Options& options, double t, const double* x);
// The same where one goes on from the output at t, the steps having reached t_internal.
int check_continuation(const Arguments& arguments, const Options& options, double t, double t_internal,
                       double direction);

core::IntegrationOptions integration_options(const Arguments& arguments, const Options& options);

}  // namespace sfdae::f77
