// DGEERM: prints what a code of DGELDA means.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/messages.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>

#include "f77/routine.h"
#include "f77/user_functions.h"
#include "problem/failure.h"

namespace sfdae::f77 {

using core::format;

namespace {

struct Entry {
  int code;
  const char* what;
  const char* next;  // what to do
};

// Interrupted: T has been reached, the call may be repeated.
constexpr Entry interruptions[] = {
    {-1, "As many steps as one call may take have been taken before TOUT was reached.",
     "Call again with INFO(1) = 1 to go on, or allow more steps by INFO(14) = 1 and IWORK(20). Very many steps are a "
     "sign of a fast solution or of tolerances that are too small."},
    {-2, "The tolerances ask for more digits than the arithmetic has. RTOL and ATOL have been enlarged.",
     "Call again with INFO(1) = 1 to go on with the new ones."},
    {-3, "A component of the solution has vanished whose ATOL is zero: purely relative accuracy is impossible there.",
     "Set ATOL > 0 for it and call again with INFO(1) = 1."},
    {-6, "The error test failed with ever smaller steps, down to the smallest possible one.",
     "The solution may have a singularity here, or the functions may not be smooth or not be correct. Look at the "
     "solution near T; larger tolerances may help. INFO(1) = 1 tries again."},
    {-8, "The matrix of the step is singular, whatever the step size.",
     "The system may have no unique solution near T, or its coefficients may differ very much in size."},
    {-10,
     "A subroutine of the user returned IERR = -1, or NaN or Inf, again and again; smaller steps did not cure it.",
     "The solution or the coefficients may cease to exist here. Look at what EDIF, ADIF, FDIF do beyond T."},
    {-21, "A subroutine of the user returned IERR = -2: a derivative is needed that it does not provide.",
     "Provide derivatives of E, A and f up to the order of the strangeness index."},
    {-22,
     "The strangeness index could not be determined: it is above the limit, or a rank decision is not clear, or a "
     "subroutine of the user failed.",
     "If CVAL(1) = -1, raise the limit by INFO(10) = 1 and IWORK(4). Check the derivatives that EDIF and ADIF "
     "return; "
     "scale equations and unknowns to comparable size; start at another point if this one is exceptional."},
    {-23, "The system without strangeness could not be formed.",
     "Check that E, A and their derivatives are finite and not very different in size."},
    {-24,
     "There is no consistent initial value: the algebraic equations cannot be solved, or redundant equations "
     "contradict each other.",
     "Check the equations: where some follow from others, f has to fit. X must be finite."},
    {-25, "There is no initial derivative: the differential equations cannot be solved for it.", "Check E near T."},
    {-26, "The characteristic values have changed: the problem has another structure here than at the start.",
     "Start a new problem after this point (INFO(1) = 0) if the change is meant."}};

// Illegal input: nothing was done.
constexpr Entry refusals[] = {
    {-101, "An entry of INFO is neither 0 nor 1 (INFO(1): less than -1). INFO has 20 entries.",
     "Set all entries, INFO(1) = 0 at the first call."},
    {-102, "NEQ, the number of equations, is not positive.", ""},
    {-103, "INFO(9) = 1, but IWORK(3), the largest order, is not one of 1, ..., 5.", ""},
    {-104, "INFO(10) = 1, but IWORK(4), the largest index allowed, is negative.", ""},
    {-105, "RWORK is too short.", "Enlarge RWORK and LRW."},
    {-106, "IWORK is too short.", "Enlarge IWORK and LIW."},
    {-107, "A relative tolerance is negative.", ""},
    {-108, "An absolute tolerance is negative.", ""},
    {-109, "All tolerances are zero.", "Set RTOL or ATOL to the accuracy wanted."},
    {-110, "INFO(4) = 1, but TSTOP = RWORK(1) lies before TOUT.", "Set TSTOP at TOUT or after it."},
    {-111, "INFO(7) = 1, but the largest step size RWORK(2) is not positive.", ""},
    {-112, "TOUT lies before T in the direction of integration, or the first step size RWORK(3) points away from it.",
     "To turn round start a new problem with INFO(1) = 0."},
    {-113, "INFO(8) = 1, but the first step size RWORK(3) is zero.", ""},
    {-114, "The weight RTOL*abs(X(i))+ATOL of a component is not positive.", "Set ATOL > 0 for it."},
    {-115, "TOUT is too close to T to start.", "Choose TOUT at a larger distance."},
    {-116, "INFO(4) = 1, but TSTOP = RWORK(1) lies before T already.",
     "Set TSTOP at a larger distance, or INFO(4) = 0."},
    {-119, "TOUT equals T, which is allowed at the first call only.", "Set a new TOUT."},
    {-120, "INFO(14) = 1, but IWORK(20), the number of steps allowed, is not positive.", ""},
    {-121, "INFO(16) = 1, but RWORK(11) = SAFE does not lie between 0.001 and 1.", ""},
    {-122, "INFO(16) = 1, but RWORK(12) = FACL is less than 1, or RWORK(13) = FACR is greater than 1.", ""},
    {-123, "INFO(17) = 1, but RWORK(14) = QUOT1 <= 1 <= QUOT2 = RWORK(15) does not hold.", ""},
    {-132, "METHOD is neither 1 (BDF) nor 2 (Runge-Kutta).", ""},
    {-140, "The INTEGERs of the caller, or of EDIF, ADIF, FDIF, do not have the size that this entry expects.",
     "Compile all of them with the same option; DGELDA is for INTEGERs of 32 bits, DGELDA_64 for 64 bits."},
    {-998, "The last call ended with an error, and INFO(1) is -1 still: nothing has been done.",
     "Deal with that error, then set INFO(1) = 1 to go on or INFO(1) = 0 to start afresh."},
    {-999, "Illegal input has been found twice in a row.", "Correct the input before calling again."}};

const Entry* find(const Entry* first, const Entry* last, std::int64_t code) {
  const Entry* found = std::find_if(first, last, [=](const Entry& entry) { return entry.code == code; });
  return found == last ? nullptr : found;
}

std::string integer(const char* name, std::int64_t value) {
  return format("%s = %lld.", name, static_cast<long long>(value));
}

// The first tolerance below zero.
std::string negative_tolerance(const char* name, const double* values, std::int64_t count) {
  for (std::int64_t i = 0; i < count; ++i)
    if (std::isless(values[i], 0.0))
      return format("%s(%lld) = %.6g.", name, static_cast<long long>(i + 1), values[i]);
  return "";
}

std::string vanishing_weight(const CallFacts& facts) {
  for (std::int64_t i = 0; i < facts.neq; ++i) {
    const std::int64_t k = facts.tolerances() == 1 ? 0 : i;
    const double weight = facts.rtol[k] * std::fabs(facts.x[i]) + facts.atol[k];
    if (std::islessequal(weight, 0.0))
      return format("Component i = %lld: X(i) = %.6g, RTOL = %.6g, ATOL = %.6g.", static_cast<long long>(i + 1),
                    facts.x[i], facts.rtol[k], facts.atol[k]);
  }
  return "";
}

std::string bad_option(const CallFacts& facts) {
  if (facts.info[0] < -1) return integer("INFO(1)", facts.info[0]);
  for (std::size_t i = 1; i < facts.info.size(); ++i)
    if (facts.info[i] != 0 && facts.info[i] != 1)
      return format("INFO(%d) = %lld.", static_cast<int>(i + 1), static_cast<long long>(facts.info[i]));
  return "";
}

std::string characteristic_values(const CallFacts& facts) {
  if (facts.cval[0] < 0) return "New values: none, the index is above the limit.";
  return format("New values in CVAL: mu = %lld, d = %lld, a = %lld, u = %lld.", static_cast<long long>(facts.cval[0]),
                static_cast<long long>(facts.cval[1]), static_cast<long long>(facts.cval[2]),
                static_cast<long long>(facts.cval[3]));
}

std::string point_reached(const CallFacts& facts) {
  // At the start there is no step size yet.
  const bool may_be_at_start = facts.code <= -22 && facts.code >= -25;
  if (may_be_at_start || facts.lrw < 4) return format("T = %.15g.", facts.t);
  return format("Point reached: T = RWORK(4) = %.15g, step size H = RWORK(3) = %.6g.", facts.real(4), facts.real(3));
}

// The numbers that an interruption is about.
std::string interruption_numbers(const CallFacts& facts) {
  switch (facts.code) {
    case -1: return integer("Steps allowed: IWORK(20)", facts.max_steps);
    case -2: return format("RTOL(1) = %.6g, ATOL(1) = %.6g now.", facts.rtol[0], facts.atol[0]);
    case -3: return vanishing_weight(facts);
    case -22: return integer("Limit of the index: IWORK(4)", facts.max_index) + integer(" CVAL(1)", facts.cval[0]);
    case -26: return characteristic_values(facts);
    default: return "";
  }
}

std::string refusal_numbers(const CallFacts& facts) {
  switch (facts.code) {
    case -101: return bad_option(facts);
    case -102: return integer("NEQ", facts.neq);
    case -103: return integer("IWORK(3)", facts.max_order);
    case -104: return integer("IWORK(4)", facts.max_index);
    case -105: return integer("LRW", facts.lrw) + integer(" Needed: LRW", facts.needed);
    case -106: return integer("LIW", facts.liw) + integer(" Needed: LIW", facts.needed);
    case -107: return negative_tolerance("RTOL", facts.rtol, facts.tolerances());
    case -108: return negative_tolerance("ATOL", facts.atol, facts.tolerances());
    case -110:
    case -116: return format("T = %.15g, TOUT = %.15g, TSTOP = %.15g.", facts.t, facts.tout, facts.real(1));
    case -111: return format("RWORK(2) = %.6g.", facts.real(2));
    case -112: return format("T = %.15g, TOUT = %.15g, RWORK(3) = %.6g.", facts.t, facts.tout, facts.real(3));
    case -114: return vanishing_weight(facts);
    case -115:
    case -119: return format("T = %.15g, TOUT = %.15g.", facts.t, facts.tout);
    case -120: return integer("IWORK(20)", facts.max_steps);
    case -121: return format("RWORK(11) = %.6g.", facts.real(11));
    case -122: return format("RWORK(12) = %.6g, RWORK(13) = %.6g.", facts.real(12), facts.real(13));
    case -123: return format("RWORK(14) = %.6g, RWORK(15) = %.6g.", facts.real(14), facts.real(15));
    case -132: return integer("METHOD", facts.method);
    default: return "";
  }
}

constexpr std::size_t frame_width = 78;

// Words of the paragraph in lines between the sides of the frame.
void add_paragraph(const std::string& paragraph, std::string& text) {
  const std::size_t width = frame_width - 4;
  std::size_t first = 0;
  while (first < paragraph.size()) {
    std::size_t length = std::min(width, paragraph.size() - first);
    if (first + length < paragraph.size()) {
      const std::size_t space = paragraph.rfind(' ', first + length);
      if (space != std::string::npos && space > first) length = space - first;
    }
    text += "* " + paragraph.substr(first, length) + std::string(width - length, ' ') + " *\n";
    first += length;
    while (first < paragraph.size() && paragraph[first] == ' ') ++first;
  }
}

}  // namespace

std::string error_message(const CallFacts& facts) {
  if (facts.code >= 0) return "";
  std::string line(frame_width, '*');
  line += '\n';
  std::string text = line;
  add_paragraph(format("DGELDA: error number IERR = %lld", static_cast<long long>(facts.code)), text);
  if (const Entry* entry = find(std::begin(interruptions), std::end(interruptions), facts.code)) {
    add_paragraph(entry->what, text);
    add_paragraph(point_reached(facts), text);
    add_paragraph(interruption_numbers(facts), text);
    add_paragraph(entry->next, text);
  } else if (const Entry* refusal = find(std::begin(refusals), std::end(refusals), facts.code)) {
    add_paragraph(refusal->what, text);
    add_paragraph(refusal_numbers(facts), text);
    add_paragraph(refusal->next, text);
  } else {
    add_paragraph("This number is not one that DGELDA returns. Was IERR changed since, or is an argument missing?",
                  text);
  }
  return text + line;
}

}  // namespace sfdae::f77

using namespace sfdae::f77;

// Prints on standard output what IERR of DGELDA means, with the numbers concerned and what can be done, in a frame of
// asterisks; nothing for IERR >= 0. The arguments are those of that call; none is changed, nothing beyond LIW and LRW
// is read, and the program goes on. The text is written through the C library: a Fortran program that wants it among
// its own output in sequence flushes its unit first.
SFDAE_F77_ROUTINE(void, dgeerm,
                  (MatrixFunction<Integer>, MatrixFunction<Integer>, VectorFunction<Integer>, const Integer* neq,
                   const double* t, const double* tout, const double* x, const double*, const Integer* cval,
                   const Integer*, const double*, const Integer* iwork, const Integer* liw, const double* rwork,
                   const Integer* lrw, const double* rtol, const double* atol, const Integer* method,
                   const Integer* info, const Integer*, const Integer* ierr),
                  (nullptr, nullptr, nullptr, neq, t, tout, x, nullptr, cval, nullptr, nullptr, iwork, liw, rwork,
                   lrw, rtol, atol, method, info, nullptr, ierr)) {
  if (*ierr >= 0) return;
  (void)guarded([&] {
    CallFacts facts;
    facts.code = *ierr;
    // Of INTEGERs of the wrong size, none can be trusted.
    if (*ierr != wrong_integer_width) {
      const auto entry = [&](std::int64_t position) {
        return position >= 1 && position <= *liw ? std::int64_t{iwork[position - 1]} : -1;
      };
      facts.neq = *neq, facts.method = *method, facts.liw = *liw, facts.lrw = *lrw;
      facts.t = *t, facts.tout = *tout;
      std::copy_n(info, facts.info.size(), facts.info.begin());
      std::copy_n(cval, facts.cval.size(), facts.cval.begin());
      facts.max_order = entry(3), facts.max_index = entry(4), facts.max_steps = entry(20), facts.needed = entry(*liw);
      facts.x = x, facts.rwork = rwork, facts.rtol = rtol, facts.atol = atol;
    }
    const std::string text = error_message(facts);
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
    return 0;
  });
}
