// What the codes of DGELDA mean, in words.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace sfdae::f77 {

// What a message may speak of: arguments of DGELDA at the end of a call, of either width of INTEGER.
struct CallFacts {
  std::int64_t code = 0;  // IERR
  std::int64_t neq = 0, method = 0, liw = 0, lrw = 0;
  double t = 0.0, tout = 0.0;
  std::array<std::int64_t, 20> info{};
  std::array<std::int64_t, 4> cval{};
  // IWORK(3), IWORK(4), IWORK(20), IWORK(LIW); -1 where LIW does not reach so far.
  std::int64_t max_order = -1, max_index = -1, max_steps = -1, needed = -1;
  const double *x = nullptr, *rwork = nullptr, *rtol = nullptr, *atol = nullptr;

  // RWORK(position), 0 beyond LRW.
  double real(int position) const { return position <= lrw ? rwork[position - 1] : 0.0; }
  // Number of entries of RTOL and ATOL.
  std::int64_t tolerances() const { return info[1] == 1 ? neq : 1; }
};

// A framed text of several lines that ends with a newline; empty for code >= 0.
std::string error_message(const CallFacts& facts);

}  // namespace sfdae::f77
