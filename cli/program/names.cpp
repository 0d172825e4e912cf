// SPDX-License-Identifier: BSD-3-Clause
#include "program/names.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <regex>
#include <set>
#include <utility>

#include "program/exit_codes.h"
#include "program/numbers.h"

namespace sfdae::cli {

namespace {

// Names are quoted in the file but not here, since shells often remove quotes.
std::string without_quotes(const std::string& name) {
  if (name.size() >= 2 && name.front() == '\'' && name.back() == '\'') return name.substr(1, name.size() - 2);
  return name;
}

// Parts between separators that are outside brackets and parentheses.
std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : text) {
    if (c == '[' || c == '(' || c == '{') ++depth;
    if (c == ']' || c == ')' || c == '}') --depth;
    if (c == separator && depth <= 0) parts.emplace_back();
    else parts.back() += c;
  }
  return parts;
}

// Levenshtein distance: insertions, deletions, replacements.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] != b[j] ? 1 : 0);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row[b.size()];
}

std::string suggestion(const std::string& name, const FlatModel& model) {
  const Variable* nearest = nullptr;
  std::size_t smallest = name.size() / 2 + 2;
  for (const Variable& variable : model.variables) {
    const std::size_t distance = edit_distance(name, variable.name);
    if (distance < smallest) nearest = &variable, smallest = distance;
  }
  return nearest != nullptr ? "; did you mean " + nearest->name + "?" : "; sfdae check MODEL --names lists them";
}

const Variable* find(const std::string& name, const FlatModel& model) {
  const auto found = std::find_if(model.variables.begin(), model.variables.end(),
                                  [&name](const Variable& variable) { return variable.name == name; });
  return found != model.variables.end() ? &*found : nullptr;
}

double parse_value(const std::string& text, const std::string& assignment) {
  if (text == "true") return 1.0;
  if (text == "false") return 0.0;
  const std::optional<double> value = parse_number(text);
  if (!value) throw ProgramError(wrong_use, "--set " + assignment + ": '" + text + "' is not a number");
  return *value;
}

// start + i step up to stop, with 15 digits: 0.5:0.1:2 means 0.8, not 0.8000000000000002.
std::vector<double> parse_range(const std::vector<std::string>& parts, const std::string& assignment) {
  constexpr double max_count = 1e7;  // far beyond a feasible sweep
  const double start = parse_value(parts.front(), assignment), stop = parse_value(parts.back(), assignment);
  const double step = parts.size() == 3 ? parse_value(parts[1], assignment) : 1.0;
  const double count = step != 0.0 ? std::floor((stop - start) / step * (1.0 + 1e-12) + 1e-9) + 1.0 : 0.0;
  if (!(count >= 1.0)) throw ProgramError(wrong_use, "--set " + assignment + ": the range START:STEP:STOP is empty");
  if (count > max_count) throw ProgramError(wrong_use, "--set " + assignment + ": more than 1e7 values");
  std::vector<double> values;
  for (double i = 0.0; i < count; ++i) values.push_back(*parse_number(short_text(start + i * step, 15)));
  return values;
}

std::vector<double> parse_values(const std::string& text, const std::string& assignment) {
  std::vector<double> values;
  for (const std::string& part : split(text, ',')) {
    const std::vector<std::string> bounds = split(part, ':');
    if (bounds.size() == 1) {
      values.push_back(parse_value(part, assignment));
    } else if (bounds.size() <= 3) {
      const std::vector<double> range = parse_range(bounds, assignment);
      values.insert(values.end(), range.begin(), range.end());
    } else {
      throw ProgramError(wrong_use, "--set " + assignment + ": a range is START:STEP:STOP");
    }
  }
  return values;
}

void require_changeable(const std::string& name, const FlatModel& model) {
  const Variable* const variable = find(name, model);
  if (variable == nullptr)
    throw ProgramError(wrong_use, "--set: the model has no '" + name + "'" + suggestion(name, model));
  if (variable->variability == Variability::constant)
    throw ProgramError(wrong_use, "--set: '" + name + "' is a constant of the model");
  if (variable->is_structural)
    throw ProgramError(wrong_use, "--set: '" + name +
                                      "' decides which equations there are and was used when the model was read; "
                                      "change it in the file");
}

std::optional<std::regex> pattern(const std::string& text) {
  try {
    return std::regex(text);
  } catch (const std::regex_error&) {
    return std::nullopt;
  }
}

}  // namespace

std::vector<ParameterChoice> parse_assignments(const std::vector<std::string>& texts, const FlatModel& model) {
  std::vector<ParameterChoice> assignments;
  std::set<std::string> names;
  for (const std::string& text : texts) {
    // Names may contain '=', values do not.
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
      throw ProgramError(wrong_use, "--set " + text + ": has to be NAME=VALUE");
    ParameterChoice assignment{without_quotes(text.substr(0, equals)), parse_values(text.substr(equals + 1), text)};
    require_changeable(assignment.name, model);
    if (!names.insert(assignment.name).second)
      throw ProgramError(wrong_use, "--set: '" + assignment.name + "' is set twice");
    assignments.push_back(std::move(assignment));
  }
  return assignments;
}

std::map<std::string, double> single_values(const std::vector<ParameterChoice>& assignments) {
  std::map<std::string, double> values;
  for (const ParameterChoice& assignment : assignments) {
    if (assignment.values.size() != 1)
      throw ProgramError(wrong_use, "--set: '" + assignment.name + "' has several values; that is for sfdae sweep");
    values[assignment.name] = assignment.values.front();
  }
  return values;
}

std::map<std::string, bool> wanted_variables(const std::vector<std::string>& names, const FlatModel& model) {
  std::map<std::string, bool> wanted;
  for (const Variable& variable : model.variables)
    wanted[variable.name] = names.empty() && variable.variability >= Variability::discrete;
  for (const std::string& list : names) {
    // A name may itself contain commas.
    const bool is_name = wanted.contains(without_quotes(list));
    for (const std::string& text : is_name ? std::vector<std::string>{list} : split(list, ',')) {
      const auto named = wanted.find(without_quotes(text));
      if (named != wanted.end()) {
        named->second = true;
        continue;
      }
      const std::optional<std::regex> expression = pattern(text);
      int count = 0;
      for (auto& [name, is_wanted] : wanted)
        if (expression && std::regex_match(name, *expression)) is_wanted = true, ++count;
      if (count == 0)
        throw ProgramError(wrong_use,
                           "--variables: '" + text + "' is no name and matches none" + suggestion(text, model));
    }
  }
  return wanted;
}

Trajectory selected(const FlatModel& model, const Result& result, const std::map<std::string, bool>& wanted) {
  const Trajectory& all = result.trajectory;
  std::map<std::string, std::size_t> column_of;
  for (std::size_t j = 0; j < all.names.size(); ++j) column_of[all.names[j]] = j;
  Trajectory chosen;
  chosen.t = all.t;
  std::vector<std::size_t> columns;  // of `all`; all.names.size(): no column
  std::vector<double> constants;     // values without a column
  for (const Variable& variable : model.variables) {
    if (!wanted.at(variable.name)) continue;
    const auto column = column_of.find(variable.name);
    const auto constant = result.parameters.find(variable.name);
    columns.push_back(column != column_of.end() ? column->second : all.names.size());
    constants.push_back(constant != result.parameters.end() ? constant->second
                                                            : std::numeric_limits<double>::quiet_NaN());
    chosen.names.push_back(variable.name);
    chosen.units.push_back(variable.unit);
    chosen.descriptions.push_back(variable.description);
    chosen.is_discrete.push_back(variable.variability != Variability::continuous);
  }
  chosen.values.reserve(all.t.size() * columns.size());
  for (std::size_t k = 0; k < all.t.size(); ++k)
    for (std::size_t j = 0; j < columns.size(); ++j)
      chosen.values.push_back(columns[j] < all.names.size() ? all.values[k * all.names.size() + columns[j]]
                                                            : constants[j]);
  return chosen;
}

}  // namespace sfdae::cli
