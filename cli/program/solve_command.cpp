// sfdae solve and sfdae analyze: one run and its results.
// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <memory>

#include "program/child_process.h"
#include "program/commands.h"
#include "program/interruption.h"
#include "program/names.h"
#include "program/numbers.h"
#include "program/output_file.h"
#include "program/plot.h"
#include "program/presentation.h"
#include "program/progress_bar.h"
#include "program/run.h"

namespace sfdae::cli {

namespace {

// Output files, opened before the work begins; none: not requested.
struct Outputs {
  std::unique_ptr<OutputFile> csv, json, html, plot;

  explicit Outputs(const Arguments& arguments) {
    if (!arguments.plot.empty()) require_plotter(arguments.plot);
    const auto opened = [](const std::string& path) {
      return path.empty() ? nullptr : std::make_unique<OutputFile>(path);
    };
    csv = opened(arguments.csv), json = opened(arguments.json), html = opened(arguments.html);
    plot = opened(arguments.plot);
  }
};

bool is_to_standard_output(const Arguments& arguments) {
  return arguments.csv == "-" || arguments.json == "-" || arguments.html == "-";
}

bool has_files(const Arguments& arguments) {
  return !arguments.csv.empty() || !arguments.json.empty() || !arguments.html.empty() || !arguments.plot.empty();
}

// Files first, because standard output may be closed early. Tables and curves only if there are values.
void write_files(const Arguments& arguments, Outputs& outputs, const Presentation& presentation) {
  const Trajectory& trajectory = presentation.trajectory;
  if (outputs.csv && !trajectory.t.empty()) outputs.csv->commit(csv_text(trajectory));
  if (outputs.json) outputs.json->commit(json_text(presentation));
  if (outputs.html) outputs.html->commit(html_text(presentation));
  if (!outputs.plot || trajectory.t.empty()) return;
  const std::string warning = draw_plot(trajectory, presentation.model.name, *outputs.plot);
  if (!warning.empty()) print_warnings(arguments, {warning});
}

// Requires a screen: a text-mode browser would block on the terminal.
void show_page(const Arguments& arguments) {
  const std::string opener = find_program("xdg-open");
  const bool has_screen = std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
  if (has_screen && !opener.empty() && start_program(opener, {arguments.html})) return;
  print_warnings(arguments, {"--show: there is no xdg-open or no screen to start a browser; open " + arguments.html});
}

void write_standard_output(const Arguments& arguments, const Presentation& presentation) {
  if (is_to_standard_output(arguments)) return;
  if (arguments.command == Command::analyze) {
    if (!arguments.is_quiet) write_to_standard_output(analysis_text(presentation));
  } else if (!is_standard_output_terminal() && !has_files(arguments)) {
    if (!presentation.trajectory.t.empty()) write_to_standard_output(csv_text(presentation.trajectory));
  } else if (!arguments.is_quiet) {
    write_to_standard_output(summary_text(presentation));
  }
}

// A run with a progress bar that Ctrl-C can interrupt.
Result run(const Arguments& arguments, const FlatModel& model, Settings settings) {
  ProgressBar bar(!arguments.is_quiet && is_standard_error_terminal());
  const double start = start_of(settings, model), stop = stop_of(settings, model);
  settings.progress = [&bar, start, stop](double t, double h, int order) {
    bar.show((t - start) / (stop - start), "t = " + short_text(t, 5) + " of " + short_text(stop, 5) + ", step " +
                                               short_text(h, 2) + ", order " + std::to_string(order));
    return !was_interrupted();
  };
  return arguments.command == Command::analyze ? analyze(model, settings) : solve(model, settings);
}

}  // namespace

int solve_command(const Arguments& arguments) {
  if (arguments.shows_page && (arguments.html.empty() || arguments.html == "-"))
    throw ProgramError(wrong_use, "--show needs a file: --html FILE");
  const FlatModel model = read_model_of(arguments);
  print_warnings(arguments, model.warnings);
  const std::map<std::string, bool> wanted = wanted_variables(arguments.variables, model);
  Settings settings = arguments.settings;
  settings.values = single_values(parse_assignments(arguments.assignments, model));
  Outputs outputs(arguments);
  note_interruptions();
  const Result result = run(arguments, model, settings);
  print_warnings(arguments, result.warnings);
  const Trajectory trajectory = selected(model, result, wanted);
  const Presentation presentation{model, result, trajectory, settings.values};
  write_files(arguments, outputs, presentation);
  if (arguments.shows_page) show_page(arguments);
  print_reason(model, result);
  write_standard_output(arguments, presentation);
  return exit_code_of(result.outcome);
}

int analyze_command(const Arguments& arguments) { return solve_command(arguments); }

}  // namespace sfdae::cli
