// Analysis and solution of flat models.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "model/flat_model.h"

#include <sfdae/sfdae.hpp>

namespace sfdae::cli {

struct Settings {
  // NaN: the value of the model's experiment annotation, else 0, 1 and 1e-6.
  double start = std::numeric_limits<double>::quiet_NaN();
  double stop = std::numeric_limits<double>::quiet_NaN();
  double tolerance = std::numeric_limits<double>::quiet_NaN();  // relative; absolute ones follow from it and nominal
  int method = SFDAE_METHOD_AUTOMATIC;
  int num_outputs = 0;        // equidistant ones after the start; 0: the experiment's interval, else 500
  bool keeps_steps = false;   // every step is an output, too
  bool keeps_aliases = true;  // values of eliminated unknowns are in the results
  long max_steps = 0;         // between two outputs; 0: the library's default
  // In models with more unknowns after substitution, states that others give explicitly are eliminated, too; smaller
  // models keep all their constraints, so that the index analysis applies to the original equations. With 12 unknowns
  // that takes less than 50 ms at index 3, with 40 seven times as long.
  int reduce_above = 12;
  std::map<std::string, double> values;  // by name; replace parameters and start values of the model
  // Called repeatedly with the current time, step size and order; false stops the run.
  std::function<bool(double t, double h, int order)> progress;
};

// Values over time, of all variables but constants: t[k], values[k * names.size() + j]. At each event there are two
// rows with the same time, before and after.
struct Trajectory {
  std::vector<std::string> names, units, descriptions;
  std::vector<bool> is_discrete;
  std::vector<double> t, values;
};

struct HappenedEvent {
  double t = 0.0;
  std::string text;  // the condition that changed, or the when clause that acted, with its line
};

enum class Outcome {
  solved,         // reached the end, or terminate() of the model
  stopped,        // by the progress callback
  invalid_model,  // counts of equations, cyclic parameters, ...; read errors come before
  not_analyzed,   // ranks unclear, index too high, singular
  not_started,    // no consistent initial values
  not_finished    // integration, events or an assertion ended it
};

struct Result {
  Outcome outcome = Outcome::solved;
  int status = SFDAE_OK;  // of the library, if it returned one
  std::string message;    // why it is not solved; the message of terminate()
  std::vector<std::string> warnings;
  int num_unknowns = 0, num_eliminated = 0;  // of the system solved; unknowns found by substitution
  int num_replaced_states = 0;  // those of the latter whose derivatives occur: without them the index may be lower
  Characteristics characteristics{};
  std::vector<Decision> decisions;
  std::string report;       // from the library, with names of unknowns and equations instead of numbers
  Statistics statistics{};  // sums over all pieces between events
  Trajectory trajectory;
  std::map<std::string, double> parameters;  // values of constants and parameters; those computed are in trajectory
  std::vector<HappenedEvent> events;
};

// Index analysis at consistent initial values; the trajectory has one row if they were found. Errors caused by the
// model are returned in the result, never thrown.
Result analyze(const FlatModel& model, const Settings& settings);

// Solves from start to stop.
Result solve(const FlatModel& model, const Settings& settings);

}  // namespace sfdae::cli
