// SPDX-License-Identifier: BSD-3-Clause
// DGEERM: a text for every code, with the numbers concerned, and nothing read beyond the ends of arrays.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "entries.h"

namespace sfdae_test {

namespace {

// Arrays exactly as long as declared: sanitizers see what is read beyond.
template <class I>
struct Arguments {
  I neq = 3;
  double t = 1.25, tout = 2.5;
  std::vector<double> x = {1.0, 0.0, 2.0}, xprime = {0.0, 0.0, 0.0};
  std::vector<I> cval = {1, 0, 3, 0};
  std::vector<I> iwork = std::vector<I>(26, 7);
  std::vector<double> rwork = std::vector<double>(60, 0.0);
  std::vector<double> rtol = {1e-3}, atol = {0.0};
  I method = 1;
  std::vector<I> info = std::vector<I>(20, 0);
  I iwarn = 0;

  std::string text(int code, decltype(dgeerm_64_)* wide = dgeerm_64_) const {
    const I liw = static_cast<I>(iwork.size()), lrw = static_cast<I>(rwork.size()), ierr = static_cast<I>(code);
    testing::internal::CaptureStdout();
    if constexpr (sizeof(I) == 4)
      dgeerm_(nullptr, nullptr, nullptr, &neq, &t, &tout, x.data(), xprime.data(), cval.data(), nullptr, nullptr,
              iwork.data(), &liw, rwork.data(), &lrw, rtol.data(), atol.data(), &method, info.data(), &iwarn, &ierr);
    else
      wide(nullptr, nullptr, nullptr, &neq, &t, &tout, x.data(), xprime.data(), cval.data(), nullptr, nullptr,
           iwork.data(), &liw, rwork.data(), &lrw, rtol.data(), atol.data(), &method, info.data(), &iwarn, &ierr);
    return testing::internal::GetCapturedStdout();
  }
};

constexpr std::array documented = {-1,   -2,   -3,   -6,   -8,   -10,  -21,  -22,  -23,  -24,  -25,  -26,  -101,
                                   -102, -103, -104, -105, -106, -107, -108, -109, -110, -111, -112, -113, -114,
                                   -115, -116, -119, -120, -121, -122, -123, -132, -140, -998, -999};

// Lines of one length between two lines of asterisks.
void expect_framed(const std::string& text) {
  std::istringstream lines(text);
  std::vector<std::string> all;
  for (std::string line; std::getline(lines, line);) all.push_back(line);
  ASSERT_GE(all.size(), 4u);
  EXPECT_EQ(all.front(), std::string(78, '*'));
  EXPECT_EQ(all.back(), std::string(78, '*'));
  for (const std::string& line : all) {
    EXPECT_EQ(line.size(), 78u) << line;
    EXPECT_EQ(line.substr(0, 1) + line.substr(77), "**");
  }
}

// The text with line breaks and frame removed.
std::string running(const std::string& text) {
  std::string result;
  for (char c : text) {
    const bool gap = c == ' ' || c == '\n' || c == '*';
    if (!gap) result += c;
    else if (!result.empty() && result.back() != ' ') result += ' ';
  }
  return result;
}

bool contains(const std::string& text, const std::string& part) {
  return running(text).find(part) != std::string::npos;
}

}  // namespace

TEST(Dgeerm, HasATextOfItsOwnForEveryDocumentedCode) {
  std::vector<std::string> texts;
  const std::string unknown = Arguments<std::int32_t>().text(-77);
  for (int code : documented) {
    const std::string text = Arguments<std::int32_t>().text(code);
    SCOPED_TRACE(code);
    expect_framed(text);
    EXPECT_TRUE(contains(text, "IERR = " + std::to_string(code)));
    EXPECT_FALSE(contains(text, "is not one that DGELDA returns"));
    EXPECT_EQ(Arguments<std::int64_t>().text(code), text);
    EXPECT_EQ(Arguments<std::int64_t>().text(code, dgeerm_64__), text);
  }
  for (int code : {-4, -5, -77, -117, -130, -131, -1000, -2147483647}) {
    const std::string text = Arguments<std::int32_t>().text(code);
    expect_framed(text);
    EXPECT_TRUE(contains(text, "is not one that DGELDA returns"));
  }
}

TEST(Dgeerm, PrintsNothingAfterSuccess) {
  for (int code : {0, 1, 2, 3, 4}) EXPECT_EQ(Arguments<std::int32_t>().text(code), "");
}

TEST(Dgeerm, NamesTheNumbersConcerned) {
  Arguments<std::int32_t> call;
  call.rwork[2] = 3.5e-7;
  call.rwork[3] = 1.125;
  EXPECT_TRUE(contains(call.text(-6), "T = RWORK(4) = 1.125, step size H = RWORK(3) = 3.5e-07."));
  EXPECT_TRUE(contains(call.text(-24), "T = 1.25."));
  call.iwork.back() = 4321;
  EXPECT_TRUE(contains(call.text(-105), "LRW = 60. Needed: LRW = 4321."));
  EXPECT_TRUE(contains(call.text(-106), "LIW = 26. Needed: LIW = 4321."));
  EXPECT_TRUE(contains(call.text(-26), "mu = 1, d = 0, a = 3, u = 0."));
  call.cval[0] = -1;
  EXPECT_TRUE(contains(call.text(-26), "none"));
  call.info[12] = 2;
  EXPECT_TRUE(contains(call.text(-101), "INFO(13) = 2."));
  call.info[0] = -5;
  EXPECT_TRUE(contains(call.text(-101), "INFO(1) = -5."));
  EXPECT_TRUE(contains(call.text(-3), "Component i = 2: X(i) = 0,"));
  call.info[1] = 1;
  call.rtol = {1e-3, 1e-3, -2.0};
  call.atol = {1.0, 1.0, 1.0};
  EXPECT_TRUE(contains(call.text(-107), "RTOL(3) = -2."));
  EXPECT_TRUE(contains(call.text(-114), "Component i = 3: X(i) = 2, RTOL = -2, ATOL = 1."));
  call.method = 17;
  EXPECT_TRUE(contains(call.text(-132), "METHOD = 17."));
  call.neq = -3;
  EXPECT_TRUE(contains(call.text(-102), "NEQ = -3."));
}

TEST(Dgeerm, ReadsNothingBeyondTheEndsOfArrays) {
  Arguments<std::int32_t> call;
  call.iwork.clear();
  call.iwork.shrink_to_fit();
  call.rwork.clear();
  call.rwork.shrink_to_fit();
  call.neq = -1;
  call.x.clear();
  for (int code : documented) expect_framed(call.text(code));
  call.iwork = {11};
  EXPECT_TRUE(contains(call.text(-106), "Needed: LIW = 11."));
  call.info[1] = 1;
  for (int code : documented) expect_framed(call.text(code));
  call.info[1] = 0;
  call.rtol = {std::nan("")};
  for (int code : documented) expect_framed(call.text(code));
}

}  // namespace sfdae_test
