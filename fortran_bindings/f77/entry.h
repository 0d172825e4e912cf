// Folder fortran_bindings/f77: DGELDA, SFNDAE and their kin, a front end on the models of src/ beside c_api.
//
// The way from the arguments of DGELDA or SFNDAE, INTEGERs of either width, to a call and back.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <initializer_list>

#include "f77/call_options.h"

namespace sfdae::f77 {

// All arguments but the user's subroutines and what is handed to them.
template <class Integer>
struct Parameters {
  const Integer* n;
  const Integer* m;  // null: as many equations as unknowns
  // An INTEGER of the caller's like n, where n and m are none.
  const Integer* width = nullptr;
  double* t;
  const double* tout;
  double* x;
  double* xprime;
  Integer* cval;
  Integer* iwork;
  const Integer* liw;
  double* rwork;
  const Integer* lrw;
  double* rtol;
  double* atol;
  const Integer* method;
  Integer* info;
  Integer* iwarn;
  Integer* ierr;
};

// How many of the numbers look like INTEGERs of 32 bits read as ones of 64. LRW may be as large as that.
template <class Integer>
int count_wide(const Parameters<Integer>& p) {
  const auto is_wide = [](std::int64_t value) { return value < INT32_MIN || value > INT32_MAX; };
  int count = 0;
  for (const Integer* number : {p.width != nullptr ? p.width : p.n, p.m, p.method, p.liw})
    if (number != nullptr && is_wide(*number)) ++count;
  for (int k = 0; k < num_info; ++k) count += is_wide(p.info[k]) ? 1 : 0;
  return count;
}

// Whether the caller's INTEGERs may have 64 bits: the word behind each of those of 32 is a zero, in the same eight
// bytes. That is no proof, but with INTEGERs of 64 bits it is so.
#if defined(__GNUC__)
__attribute__((no_sanitize("address", "undefined")))
#endif
inline bool
may_be_wide(std::initializer_list<const std::int32_t*> numbers) {
  for (const std::int32_t* number : numbers) {
    if (reinterpret_cast<std::uintptr_t>(number) % sizeof(std::int64_t) != 0) return false;
    const volatile std::int32_t* behind = number + 1;
    if (*behind != 0) return false;
  }
  return true;
}
inline bool may_be_wide(std::initializer_list<const std::int64_t*>) { return false; }

// INFO(1) and IERR of a caller with INTEGERs of 64 bits who called the entry for 32.
inline void report_to_wide(std::int32_t* info, std::int32_t* ierr) {
  const std::int64_t failed = -1, wrong_width = code::wrong_width;
  std::memcpy(info, &failed, sizeof failed);
  std::memcpy(ierr, &wrong_width, sizeof wrong_width);
}
inline void report_to_wide(std::int64_t*, std::int64_t*) {}

template <class Integer>
bool has_wide_look(const Parameters<Integer>& p) {
  const bool is_aligned = reinterpret_cast<std::uintptr_t>(p.info) % sizeof(std::int64_t) == 0 &&
                          reinterpret_cast<std::uintptr_t>(p.ierr) % sizeof(std::int64_t) == 0;
  return is_aligned && may_be_wide({p.width != nullptr ? p.width : p.n, p.method, p.liw, p.lrw});
}

template <class Integer, class Run>
int solve(const Parameters<Integer>& p, const Routine& routine, Run run) {
  Arguments arguments{.routine = &routine,
                      .m = static_cast<int>(p.m != nullptr ? *p.m : *p.n),
                      .n = static_cast<int>(*p.n),
                      .method = static_cast<int>(*p.method),
                      .may_be_wide = has_wide_look(p),
                      .liw = *p.liw,
                      .lrw = *p.lrw,
                      .tout = *p.tout,
                      .t = p.t,
                      .x = p.x,
                      .xprime = p.xprime,
                      .rtol = p.rtol,
                      .atol = p.atol,
                      .cval = IntegerArray(p.cval),
                      .iwork = IntegerArray(p.iwork),
                      .rwork_values = p.rwork};
  for (int k = 0; k < num_info; ++k) arguments.info[k + 1] = static_cast<int>(p.info[k]);
  const int ierr = run(arguments);
  const bool is_repeated = arguments.info[1] == -1;
  if (arguments.liw >= shortest_iwork && !is_repeated) arguments.iwork.set(last_ierr, ierr);
  return ierr;
}

// run: does what the Arguments ask for, returns IERR and never throws.
template <class Integer, class Run>
void solve_and_report(const Parameters<Integer>& p, const Routine& routine, Run run) {
  const int num_wide = count_wide(p);
  if (num_wide > 1) {
    // INFO(1) and IERR have 32 bits, then.
    const std::int32_t failed = -1, wrong_width = code::wrong_width;
    std::memcpy(p.info, &failed, sizeof failed);
    std::memcpy(p.ierr, &wrong_width, sizeof wrong_width);
    return;
  }
  const int ierr = num_wide == 1 ? static_cast<int>(code::wrong_width) : solve(p, routine, run);
  if (ierr == code::wrong_width && has_wide_look(p)) {
    report_to_wide(p.info, p.ierr);
    return;
  }
  p.info[0] = ierr < 0 ? -1 : ierr == 4 ? 2 : 1;
  *p.ierr = ierr;
  const Integer iwarn = ierr > 0 && routine.warns && p.cval[3] > 0 ? 1 : 0;
  // Some callers of DGELDA hand over a constant zero, which may not be written.
  if (routine.warns || *p.iwarn != 0) *p.iwarn = iwarn;
}

}  // namespace sfdae::f77
