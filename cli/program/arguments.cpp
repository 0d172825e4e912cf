// SPDX-License-Identifier: BSD-3-Clause
#include "program/arguments.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>

#include "program/exit_codes.h"
#include "program/numbers.h"

namespace sfdae::cli {

namespace {

constexpr const char* footer =
    R"(MODEL is a file in flat (Base) Modelica, as OpenModelica exports it, or - for standard input.

Where output goes:
  to a terminal     a summary for people, and a progress bar
  to a pipe, file   CSV: all values over time, or one row for each instance of a sweep;
                    the summary, if --csv, --json, --html or --plot say where values go
  to errors         warnings, and the reason why something is not solved
Files are written completely or not at all; - as a file is standard output.

Exit codes:
  0    solved (check, analyze: nothing is wrong)
  1    not solved: the integration ended early, or some instances of a sweep failed
  2    wrong use, or a model that cannot be read or has too many or too few equations
  3    not analyzed: the index cannot be determined
  4    not started: no consistent initial values
  5    results cannot be written
  130  interrupted by Ctrl-C; what there is has been written

Examples:
  sfdae solve pendulum.mo --to 10 --html pendulum.html --show
  sfdae solve pendulum.mo --set g=1.62 --variables x,y --csv moon.csv
  sfdae sweep pendulum.mo --set L=0.5:0.1:2 --jobs 2 > lengths.csv
  sfdae analyze pendulum.mo
)";

// A finite number; CLI11's own conversion depends on the locale.
void add_number(CLI::App& app, const std::string& name, double& value, const std::string& what, bool is_positive) {
  app.add_option_function<std::string>(
         name,
         [&value, name, is_positive](const std::string& text) {
           const std::optional<double> number = parse_number(text);
           if (!number) throw CLI::ValidationError(name, "'" + text + "' is not a number");
           if (is_positive && !(*number > 0.0)) throw CLI::ValidationError(name, "must be positive");
           value = *number;
         },
         what)
      ->type_name("NUMBER");
}

void add_model(CLI::App& app, Arguments& arguments) {
  app.add_option("MODEL", arguments.model, "file in flat (Base) Modelica, - for standard input")
      ->required()
      ->type_name("");
  app.add_flag("-q,--quiet", arguments.is_quiet, "no summary, no progress bar, no warnings");
}

void add_values(CLI::App& app, Arguments& arguments, const std::string& what) {
  app.add_option("--set", arguments.assignments, what)->type_name("NAME=VALUE")->expected(1)->take_all();
}

void add_start(CLI::App& app, Arguments& arguments) {
  add_number(app, "--from", arguments.settings.start, "time to start at; else of the model, else 0", false);
  add_number(app, "--tol", arguments.settings.tolerance, "relative tolerance; else of the model, else 1e-6", true);
}

void add_integration(CLI::App& app, Arguments& arguments) {
  Settings& settings = arguments.settings;
  add_start(app, arguments);
  add_number(app, "--to", settings.stop, "time to end at; else of the model, else 1", false);
  const std::map<std::string, int> methods{
      {"bdf", SFDAE_METHOD_BDF}, {"radau", SFDAE_METHOD_RADAU}, {"automatic", SFDAE_METHOD_AUTOMATIC}};
  app.add_option("--method", settings.method, "bdf, radau or automatic (default)")
      ->transform(CLI::CheckedTransformer(methods, CLI::ignore_case).description(""))
      ->type_name("NAME");
  app.add_option("--max-steps", settings.max_steps, "limit of steps between two outputs")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("N");
}

void add_selection(CLI::App& app, Arguments& arguments) {
  app.add_option("--variables", arguments.variables,
                 "which: names or regular expressions of whole names, separated by commas; may be repeated")
      ->type_name("NAMES")
      ->expected(1)
      ->take_all();
}

void add_file(CLI::App& app, const std::string& name, std::string& path, const std::string& what) {
  app.add_option(name, path, what)->type_name("FILE");
}

void add_outputs(CLI::App& app, Arguments& arguments, const std::string& what) {
  app.add_option("--outputs", arguments.settings.num_outputs, what)
      ->check(CLI::Range(1, 100000000).description(""))
      ->type_name("N");
}

void add_commands(CLI::App& app, Arguments& arguments) {
  CLI::App& check = *app.add_subcommand("check", "Reads a model, counts, and reports what is wrong with it");
  CLI::App& analyze = *app.add_subcommand("analyze", "Finds consistent initial values and the index");
  CLI::App& solve = *app.add_subcommand("solve", "Solves a model over time");
  CLI::App& sweep = *app.add_subcommand(
      "sweep",
      "Solves a model for many values of its parameters; started by mpirun or srun, the processes share them");
  for (CLI::App* command : {&check, &analyze, &solve, &sweep}) {
    add_model(*command, arguments);
    command->footer("Where output goes, exit codes, examples: sfdae --help");
  }

  const std::string value = "value of a parameter, or start value of a variable; may be repeated";
  for (CLI::App* command : {&check, &analyze}) {
    add_values(*command, arguments, value);
    add_start(*command, arguments);
  }
  check.add_flag("--names", arguments.lists_names, "lists all variables with units and descriptions");
  add_file(check, "--json", arguments.json, "counts, index, warnings");
  add_selection(analyze, arguments);
  add_file(analyze, "--json", arguments.json, "index, rank decisions, initial values");
  add_file(analyze, "--html", arguments.html, "the same as a page");
  analyze.add_flag("--show", arguments.shows_page, "opens the page of --html in the browser");

  add_values(solve, arguments, value);
  add_integration(solve, arguments);
  add_outputs(solve, arguments, "equidistant outputs after the start; else of the model, else 500");
  solve.add_flag("--every-step", arguments.settings.keeps_steps, "every step is an output, too");
  add_selection(solve, arguments);
  add_file(solve, "--csv", arguments.csv, "values over time");
  add_file(solve, "--json", arguments.json, "everything: values, index, rank decisions, statistics, events");
  add_file(solve, "--html", arguments.html, "a page for the browser with curves and reports");
  solve.add_flag("--show", arguments.shows_page, "opens the page of --html in the browser");
  add_file(solve, "--plot", arguments.plot, "curves by gnuplot; .svg, .png or .pdf");

  add_values(sweep, arguments,
             "values of a parameter: start:step:stop, or a list separated by commas; repeated: all combinations, the "
             "last --set varies fastest");
  add_integration(sweep, arguments);
  add_outputs(sweep, arguments, "equidistant outputs of each instance; else its end only");
  add_selection(sweep, arguments);
  add_file(sweep, "--csv", arguments.csv, "the table; FILE.rankN of each process under mpirun");
  add_file(sweep, "--json", arguments.json, "the table with messages");
  sweep.add_option("-j,--jobs", arguments.jobs, "threads; else as many as there are processors")
      ->check(CLI::Range(1, 100000).description(""))
      ->type_name("N");
}

bool has_command(const CLI::App& app, const std::string& name) {
  const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
  return std::any_of(commands.begin(), commands.end(),
                     [&name](const CLI::App* command) { return command->get_name() == name; });
}

}  // namespace

std::variant<Arguments, int> parse_arguments(int count, char** arguments) {
  Arguments result;
  CLI::App app("Solves differential-algebraic equations of arbitrary index from model files.", "sfdae");
  app.set_version_flag("--version", std::string("sfdae ") + sfdae_version(), "Version of program and library");
  app.require_subcommand(1);
  app.footer(footer);
  app.get_formatter()->column_width(24);
  add_commands(app, result);
  if (count > 1 && arguments[1][0] != '-' && !has_command(app, arguments[1])) {
    std::cerr << "sfdae: there is no command '" << arguments[1] << "', only check, analyze, solve and sweep\n";
    return static_cast<int>(wrong_use);
  }
  try {
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? static_cast<int>(solved) : static_cast<int>(wrong_use);
  }
  const std::string name = app.get_subcommands().front()->get_name();
  result.command = name == "check"     ? Command::check
                   : name == "analyze" ? Command::analyze
                   : name == "solve"   ? Command::solve
                                       : Command::sweep;
  return result;
}

}  // namespace sfdae::cli
