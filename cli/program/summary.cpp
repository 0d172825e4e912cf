// Text for people.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "program/numbers.h"
#include "program/presentation.h"

namespace sfdae::cli {

namespace {

constexpr std::size_t max_rows = 30;  // per table of values, about a screen

std::string padded(const std::string& text, std::size_t width) {
  return text + std::string(width > text.size() ? width - text.size() : 0, ' ');
}

using Row = std::vector<std::string>;

std::string after_empty_line(const std::string& text) { return text.empty() ? "" : "\n" + text; }

}  // namespace

std::string aligned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const Row& row : rows)
    for (std::size_t j = 0; j < row.size(); ++j) widths[j] = std::max(widths[j], row[j].size());
  std::string text;
  for (const Row& row : rows) {
    std::string line = " ";
    for (std::size_t j = 0; j < row.size(); ++j) line += " " + padded(row[j], widths[j] + 1);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

namespace {

std::string values_text(const Trajectory& trajectory) {
  if (trajectory.t.empty() || trajectory.names.empty()) return "";
  const std::size_t columns = trajectory.names.size(), last = trajectory.t.size() - 1;
  const bool has_units = std::any_of(trajectory.units.begin(), trajectory.units.end(),
                                     [](const std::string& unit) { return !unit.empty(); });
  const auto row = [&](const std::string& name, const std::string& unit, double first, double final) {
    Row cells{name};
    if (has_units) cells.push_back(unit);
    cells.push_back(short_text(first, 9));
    if (last > 0) cells.push_back(short_text(final, 9));
    return cells;
  };
  std::vector<Row> rows{row("time", "s", trajectory.t.front(), trajectory.t.back())};
  for (std::size_t j = 0; j < std::min(columns, max_rows); ++j)
    rows.push_back(
        row(trajectory.names[j], trajectory.units[j], trajectory.values[j], trajectory.values[last * columns + j]));
  std::string text = "\n" + aligned(rows);
  if (columns > max_rows) text += "  ... and " + std::to_string(columns - max_rows) + " more; --variables chooses\n";
  return text;
}

}  // namespace

std::string index_text(const Result& result) {
  std::string text;
  for (const std::string& sentence : index_in_words(result)) text += "  " + sentence + "\n";
  const std::string safety = safety_in_words(result);
  return safety.empty() ? text : text + "  " + safety + "\n";
}

std::string headline(const Presentation& presentation) {
  const Result& result = presentation.result;
  const std::vector<double>& t = result.trajectory.t;
  std::string text = presentation.model.name + ": " + name_of(result.outcome);
  if (t.size() > 1) text += " from " + short_text(t.front()) + " to " + short_text(t.back()) + " s";
  if (result.statistics.steps > 0) text += ", " + counted(result.statistics.steps, "step", "steps");
  if (!result.events.empty()) text += ", " + counted(result.events.size(), "event", "events");
  return text;
}

std::string summary_text(const Presentation& presentation) {
  std::string text = headline(presentation) + "\n";
  // The message of a model that terminates itself; reasons for failures go to standard error.
  if (presentation.result.outcome == Outcome::solved && !presentation.result.message.empty())
    text += "  " + presentation.result.message + "\n";
  return text + after_empty_line(index_text(presentation.result)) + values_text(presentation.trajectory);
}

std::string analysis_text(const Presentation& presentation) {
  const Result& result = presentation.result;
  std::string text = presentation.model.name + ": " +
                     (result.outcome == Outcome::solved ? std::string("analyzed") : name_of(result.outcome)) + "\n" +
                     after_empty_line(index_text(result)) + after_empty_line(result.report);
  return text + values_text(presentation.trajectory);
}

}  // namespace sfdae::cli
