// sfdae sweep: many runs, on threads and processes, and the table of their results.
// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <thread>

#include "program/commands.h"
#include "program/interruption.h"
#include "program/numbers.h"
#include "program/output_file.h"
#include "program/presentation.h"
#include "program/progress_bar.h"
#include "program/run.h"
#include "program/sweep.h"

namespace sfdae::cli {

namespace {

// Adds the rank to a path: out.csv of process 3 is out.rank3.csv.
std::string path_of_rank(const std::string& path, Share share) {
  if (share.size == 1 || path.empty() || path == "-") return path;
  std::filesystem::path part(path);
  part.replace_extension(".rank" + std::to_string(share.rank) + part.extension().string());
  return part.string();
}

Instance solved_instance(std::size_t number, const FlatModel& model, Settings settings, const Grid& grid,
                         const std::map<std::string, bool>& wanted) {
  Instance instance;
  instance.number = number;
  instance.given = grid.values(number);
  for (std::size_t k = 0; k < instance.given.size(); ++k)
    settings.values[grid.assignments()[k].name] = instance.given[k];
  settings.progress = [](double, double, int) { return !was_interrupted(); };
  const bool keeps_end_only = settings.num_outputs == 0;
  if (keeps_end_only) settings.num_outputs = 1;
  const Result result = solve(model, settings);
  instance.outcome = result.outcome;
  instance.status = result.status;
  instance.message = result.message;
  instance.warnings = result.warnings;
  instance.steps = result.statistics.steps;
  instance.trajectory = selected(model, result, wanted);
  Trajectory& trajectory = instance.trajectory;
  if (keeps_end_only && trajectory.t.size() > 1) {
    const auto columns = static_cast<std::ptrdiff_t>(trajectory.names.size());
    trajectory.t.erase(trajectory.t.begin(), trajectory.t.end() - 1);
    trajectory.values.erase(trajectory.values.begin(), trajectory.values.end() - columns);
  }
  return instance;
}

std::vector<std::string> wanted_names(const std::map<std::string, bool>& wanted, const FlatModel& model) {
  std::vector<std::string> names;
  for (const Variable& variable : model.variables)
    if (wanted.at(variable.name)) names.push_back(variable.name);
  return names;
}

std::string table_head(const Grid& grid, const std::vector<std::string>& names) {
  std::string text = "instance";
  for (const ParameterChoice& assignment : grid.assignments()) text += "," + csv_field(assignment.name);
  text += ",outcome,time";
  for (const std::string& name : names) text += "," + csv_field(name);
  return text + "\n";
}

// A row for each output; one row with empty cells for an instance without outputs.
std::string table_rows(const Instance& instance, std::size_t columns) {
  std::string front = std::to_string(instance.number + 1), text;
  for (const double value : instance.given) front += "," + full_text(value);
  front += "," + name_of(instance.outcome);
  const Trajectory& trajectory = instance.trajectory;
  if (trajectory.t.empty()) return front + std::string(columns + 1, ',') + "\n";
  for (std::size_t k = 0; k < trajectory.t.size(); ++k) {
    text += front + "," + full_text(trajectory.t[k]);
    for (std::size_t j = 0; j < columns; ++j) text += "," + full_text(trajectory.values[k * columns + j]);
    text += "\n";
  }
  return text;
}

// For people: only the first variables and the first instances.
std::string table_text(const std::vector<Instance>& instances, const Grid& grid,
                       const std::vector<std::string>& names) {
  constexpr std::size_t max_columns = 6, max_rows = 200;
  const std::size_t columns = std::min(names.size(), max_columns);
  bool is_cut = false;
  std::vector<std::vector<std::string>> rows(1, {"instance"});
  for (const ParameterChoice& assignment : grid.assignments()) rows[0].push_back(assignment.name);
  rows[0].insert(rows[0].end(), {"outcome", "time"});
  rows[0].insert(rows[0].end(), names.begin(), names.begin() + static_cast<std::ptrdiff_t>(columns));
  for (const Instance& instance : instances) {
    const Trajectory& trajectory = instance.trajectory;
    for (std::size_t k = 0; k < std::max<std::size_t>(trajectory.t.size(), 1); ++k) {
      if (rows.size() > max_rows) {
        is_cut = true;
        break;
      }
      std::vector<std::string> row{std::to_string(instance.number + 1)};
      for (const double value : instance.given) row.push_back(short_text(value, 9));
      row.push_back(name_of(instance.outcome));
      const bool has_values = k < trajectory.t.size();
      row.push_back(has_values ? short_text(trajectory.t[k], 9) : "");
      for (std::size_t j = 0; j < columns; ++j)
        row.push_back(has_values ? short_text(trajectory.values[k * names.size() + j], 9) : "");
      rows.push_back(std::move(row));
    }
  }
  std::string text = aligned(rows);
  if (columns < names.size())
    text += "  " + counted(names.size() - columns, "more variable is", "more variables are") +
            " left out; --variables chooses\n";
  if (is_cut) text += "  only the first rows; --csv FILE writes all\n";
  return text;
}

std::string sweep_json(const FlatModel& model, const Grid& grid, const std::vector<Instance>& instances) {
  using Json = nlohmann::ordered_json;
  Json list = Json::array();
  for (const Instance& instance : instances) {
    Json given = Json::object(), values = Json::object();
    for (std::size_t k = 0; k < instance.given.size(); ++k) given[grid.assignments()[k].name] = instance.given[k];
    const Trajectory& trajectory = instance.trajectory;
    for (std::size_t j = 0; j < trajectory.names.size(); ++j)
      for (std::size_t k = 0; k < trajectory.t.size(); ++k)
        values[trajectory.names[j]].push_back(trajectory.values[k * trajectory.names.size() + j]);
    list.push_back({{"instance", instance.number + 1},
                    {"given", given},
                    {"outcome", name_of(instance.outcome)},
                    {"status", sfdae_status_name(instance.status)},
                    {"message", instance.message},
                    {"warnings", instance.warnings},
                    {"steps", instance.steps},
                    {"time", trajectory.t},
                    {"values", values}});
  }
  const Json json{{"sfdae", sfdae_version()}, {"model", model.name}, {"file", model.file}, {"instances", list}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

// Prints each warning once, with the number of its first instance.
void print_warnings_of(const std::vector<Instance>& instances) {
  constexpr std::size_t max_warnings = 10;
  std::set<std::string> known;
  for (const Instance& instance : instances)
    for (const std::string& warning : instance.warnings)
      if (known.insert(warning).second && known.size() <= max_warnings)
        std::fprintf(stderr, "warning: instance %zu: %s\n", instance.number + 1, warning.c_str());
  if (known.size() > max_warnings)
    std::fprintf(stderr, "warning: ... and %s; --json FILE has all\n",
                 counted(known.size() - max_warnings, "more", "more").c_str());
}

// For people: the number of solved instances, and the reasons for the others.
int report(const std::vector<Instance>& instances, std::size_t expected, bool is_quiet) {
  constexpr std::size_t max_reasons = 10;
  if (!is_quiet) print_warnings_of(instances);
  std::size_t num_failed = 0;
  for (const Instance& instance : instances) {
    if (instance.outcome == Outcome::solved || instance.outcome == Outcome::stopped) continue;
    if (++num_failed <= max_reasons)
      std::fprintf(stderr, "sfdae: instance %zu is %s: %s\n", instance.number + 1, name_of(instance.outcome).c_str(),
                   instance.message.c_str());
  }
  if (num_failed > max_reasons)
    std::fprintf(stderr, "sfdae: ... and %s not solved\n",
                 counted(num_failed - max_reasons, "more instance is", "more instances are").c_str());
  if (was_interrupted()) {
    std::fprintf(stderr, "sfdae: interrupted; %zu of %zu instances were begun\n", instances.size(), expected);
    return interrupted;
  }
  if (!is_quiet && is_standard_error_terminal())
    std::fprintf(stderr, "%zu of %zu instances solved\n", instances.size() - num_failed, instances.size());
  return num_failed == 0 ? solved : not_solved;
}

}  // namespace

int sweep_command(const Arguments& arguments) {
  const FlatModel model = read_model_of(arguments);
  print_warnings(arguments, model.warnings);
  const std::map<std::string, bool> wanted = wanted_variables(arguments.variables, model);
  const Grid grid(parse_assignments(arguments.assignments, model));
  if (grid.assignments().empty()) throw ProgramError(wrong_use, "sweep needs --set NAME=START:STEP:STOP");
  const Share share = share_of_process();
  const std::string csv_path = path_of_rank(arguments.csv, share), json_path = path_of_rank(arguments.json, share);
  std::unique_ptr<OutputFile> csv, json;
  if (!csv_path.empty()) csv = std::make_unique<OutputFile>(csv_path);
  if (!json_path.empty()) json = std::make_unique<OutputFile>(json_path);
  const bool is_table_shown = csv_path.empty() && json_path.empty();
  const bool is_for_people = is_table_shown && is_standard_output_terminal();
  const std::vector<std::string> names = wanted_names(wanted, model);
  const std::string head = table_head(grid, names);
  if (is_table_shown && !is_for_people && share.rank == 0) write_to_standard_output(head);

  note_interruptions();
  const std::size_t expected = (grid.count() + share.size - 1 - share.rank) / share.size;
  std::vector<Instance> instances;
  {
    ProgressBar bar(!arguments.is_quiet && is_standard_error_terminal());
    const int processors = static_cast<int>(std::thread::hardware_concurrency());
    instances = run_sweep(
        grid.count(), share, arguments.jobs > 0 ? arguments.jobs : processors,
        [&](std::size_t number) { return solved_instance(number, model, arguments.settings, grid, wanted); },
        [&](std::size_t done) {
          bar.show(static_cast<double>(done) / static_cast<double>(expected),
                   std::to_string(done) + " of " + std::to_string(expected) + " instances");
        });
  }
  std::string rows;
  for (const Instance& instance : instances) rows += table_rows(instance, names.size());
  if (csv) csv->commit(head + rows);
  if (json) json->commit(sweep_json(model, grid, instances));
  if (is_table_shown) write_to_standard_output(is_for_people ? table_text(instances, grid, names) : rows);
  return report(instances, expected, arguments.is_quiet);
}

}  // namespace sfdae::cli
