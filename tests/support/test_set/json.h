// SPDX-License-Identifier: BSD-3-Clause
// A reader for data files in JSON: what tests/data/ needs and no more (no escapes in strings).
#ifndef SFDAE_TESTS_JSON_H
#define SFDAE_TESTS_JSON_H

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sfdae_test {

struct Json {
  enum class Kind { null, number, text, list, object };
  Kind kind = Kind::null;
  double number = 0.0;
  std::string text = {};
  std::vector<Json> items = {};                            // of a list
  std::vector<std::pair<std::string, Json>> members = {};  // of an object, in the order of the file

  const Json* find(std::string_view key) const;  // null if there is none
  const Json& at(std::string_view key) const;    // throws std::runtime_error if there is none
};

// Throws std::runtime_error that tells the position.
Json read_json(std::string_view source);
Json read_json_file(const std::string& path);

}  // namespace sfdae_test

#endif
