// External functions of the standard library on strings, evaluated if the strings are known.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>

#include "modelica/built_in.h"
#include "modelica/expression_pool.h"

namespace sfdae::cli {

namespace {

const std::string& text_argument(const Elaboration& e, const Call& call, size_t k) {
  const Value& value = call.arguments[k].value;
  if (value.kind != Kind::string || !value.is_scalar() || !value.texts[0].is_exact)
    e.fail(call.at, "an argument of '" + call.name + "' is not a string that is known while the model is read");
  return value.texts[0].text;
}

}  // namespace

bool only_shows_text(const std::string& external) {
  constexpr std::array<std::string_view, 4> names = {"ModelicaInternal_print", "ModelicaMessage",
                                                     "ModelicaFormatMessage", "ModelicaWarning"};
  return std::find(names.begin(), names.end(), external) != names.end();
}

std::optional<Value> call_string_function(Elaboration& e, const Call& call) {
  if (call.name == "ModelicaStrings_length") {
    check_count(e, call, 1, 1);
    const auto length = static_cast<double>(text_argument(e, call, 0).size());
    return scalar_value(Kind::integer, e.pool.number(length, call.at));
  }
  if (call.name == "ModelicaStrings_substring") {
    check_count(e, call, 3, 3);
    const std::string& text = text_argument(e, call, 0);
    const int first = integer_argument(e, call, 1), last = integer_argument(e, call, 2);
    if (first < 1 || last < first || static_cast<size_t>(last) > text.size())
      e.fail(call.at, "a string of " + std::to_string(text.size()) + " characters has no part from " +
                          std::to_string(first) + " to " + std::to_string(last));
    return text_value(text.substr(static_cast<size_t>(first) - 1, static_cast<size_t>(last - first) + 1));
  }
  return std::nullopt;
}

}  // namespace sfdae::cli
