// Files that are damaged in every way give a model or an error, in bounded time and memory, and no crash (run it with
// -fsanitize=address,undefined and SFDAE_FUZZ_COUNT=100000 before a change of the reader is handed in).
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "reading.h"

namespace sfdae::cli::testing {

namespace {

int fuzz_count() {
  const char* text = std::getenv("SFDAE_FUZZ_COUNT");
  return text != nullptr ? std::atoi(text) : 600;
}

std::vector<std::string> sample_files() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(SFDAE_TEST_MODELS))
    if (entry.path().extension() == ".bmo") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> result;
  for (const auto& path : paths) {
    std::ifstream in(path, std::ios::binary);
    result.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return result;
}

class Mutation {
 public:
  Mutation(unsigned seed, const std::vector<std::string>& samples) : random_(seed), samples_(samples) {}

  std::string run() {
    std::string text = samples_[below(samples_.size())];
    const size_t rounds = 1 + below(4);
    for (size_t k = 0; k < rounds; ++k) mutate(text);
    return text;
  }

 private:
  size_t below(size_t n) { return n == 0 ? 0 : std::uniform_int_distribution<size_t>(0, n - 1)(random_); }

  // [begin, end) of a word or a single character.
  std::pair<size_t, size_t> token(const std::string& text) {
    size_t begin = below(text.size());
    const auto is_word = [&](size_t i) {
      return i < text.size() &&
             (std::isalnum(static_cast<unsigned char>(text[i])) || text[i] == '_' || text[i] == '\'');
    };
    while (begin > 0 && is_word(begin - 1) && is_word(begin)) --begin;
    size_t end = begin + 1;
    while (is_word(begin) && is_word(end)) ++end;
    return {begin, std::min(end, text.size())};
  }

  void mutate(std::string& text) {
    if (text.empty()) return;
    static const std::vector<std::string> words = {"end",
                                                   "(",
                                                   ")",
                                                   "[",
                                                   "]",
                                                   "{",
                                                   "}",
                                                   ";",
                                                   "=",
                                                   ":=",
                                                   ",",
                                                   ":",
                                                   "'x'",
                                                   "der(",
                                                   "pre(",
                                                   "1e999",
                                                   "1000000000",
                                                   "-1",
                                                   "0",
                                                   "if",
                                                   "then",
                                                   "else",
                                                   "for 'i' in 1:1000000000 loop",
                                                   "end for;",
                                                   "when",
                                                   "\"",
                                                   "'",
                                                   "/*",
                                                   "algorithm",
                                                   "equation",
                                                   "function",
                                                   "record",
                                                   "^",
                                                   "*",
                                                   "1:3",
                                                   "while true loop",
                                                   "end while;",
                                                   "initial",
                                                   "sum(",
                                                   "fill(1, 100000, 100000)",
                                                   "cat(",
                                                   ".",
                                                   "@1",
                                                   "'R'",
                                                   "not",
                                                   "\xff",
                                                   "size("};
    const auto [begin, end] = token(text);
    const auto [first, last] = token(text);
    switch (below(8)) {
      case 0: text[begin] = static_cast<char>(text[begin] ^ static_cast<char>(1U << below(8))); break;
      case 1: text[begin] = static_cast<char>(below(256)); break;
      case 2: text.erase(begin, end - begin); break;
      case 3: text.insert(first, text.substr(begin, end - begin) + " "); break;
      case 4: text.replace(first, last - first, text.substr(begin, end - begin)); break;
      case 5: text.insert(begin, " " + words[below(words.size())] + " "); break;
      case 6: {  // a piece of another file
        const std::string& other = samples_[below(samples_.size())];
        const size_t from = below(other.size());
        text.insert(begin, other.substr(from, below(200)));
        break;
      }
      default: text.erase(begin, below(200)); break;
    }
  }

  std::mt19937 random_;
  const std::vector<std::string>& samples_;
};

}  // namespace

TEST(DamagedFiles, GiveModelsOrErrorsWithAPlace) {
  const std::vector<std::string> samples = sample_files();
  ASSERT_GE(samples.size(), 10U);
  const int count = fuzz_count();
  int num_errors = 0;
  for (int k = 0; k < count; ++k) {
    const std::string text = Mutation(static_cast<unsigned>(k), samples).run();
    SCOPED_TRACE("seed " + std::to_string(k));
    try {
      read_model(text, "test.bmo");
    } catch (const ModelError& error) {
      ++num_errors;
      ASSERT_EQ(std::string(error.what()).rfind("test.bmo:", 0), 0U) << error.what();
    }
  }
  EXPECT_GT(num_errors, count / 3);
}

}  // namespace sfdae::cli::testing
