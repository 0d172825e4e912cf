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
  // NaN: what the model's experiment annotation says, else 0, 1 and 1e-6.
  double start = std::numeric_limits<double>::quiet_NaN();
  double stop = std::numeric_limits<double>::quiet_NaN();
  double tolerance = std::numeric_limits<double>::quiet_NaN();  // relative; absolute ones follow from it and nominal
  int method = SFDAE_METHOD_AUTOMATIC;
  int num_outputs = 0;        // equidistant ones after the start; 0: the experiment's interval, else 500
  bool keeps_steps = false;   // every step is an output, too
  bool keeps_aliases = true;  // values of eliminated unknowns are in the results
  long max_steps = 0;         // between two outputs; 0: the library's default
  // Models with more unknowns, after substitution, also lose states that others give explicitly; smaller ones keep all
  // their constraints, so that the index analysis speaks of the equations as they stand. With 12 unknowns that takes
  // less than 50 ms at index 3, with 40 seven times as long.
  int reduce_above = 12;
  std::map<std::string, double> values;  // of parameters and start values, by name, instead of those of the model
  // Called now and then with the time, step size and order reached; false stops.
  std::function<bool(double t, double h, int order)> progress;
};

// Values over time, of all variables but constants: t[k], values[k * names.size() + j]. Where events happen there
// are two rows with the same time, before and after.
struct Trajectory {
  std::vector<std::string> names, units, descriptions;
  std::vector<bool> is_discrete;
  std::vector<double> t, values;
};

struct HappenedEvent {
  double t = 0.0;
  std::string text;  // which condition changed, or which when clause acted, with its line
};

enum class Outcome {
  solved,         // reached the end, or terminate() of the model
  stopped,        // by progress
  invalid_model,  // counts of equations, cyclic parameters, ...; read errors come before
  not_analyzed,   // ranks unclear, index too high, singular
  not_started,    // no consistent initial values
  not_finished    // integration, events or an assertion ended it
};

struct Result {
  Outcome outcome = Outcome::solved;
  int status = SFDAE_OK;  // of the library, where it said something
  std::string message;    // why it is not solved; what terminate() says
  std::vector<std::string> warnings;
  int num_unknowns = 0, num_eliminated = 0;  // of the system solved; unknowns found by substitution
  int num_replaced_states = 0;  // of the latter, those whose derivatives occur: without them the index may be lower
  Characteristics characteristics{};
  std::vector<Decision> decisions;
  std::string report;       // the library's own, names for numbers where it names unknowns and equations
  Statistics statistics{};  // sums over all pieces between events
  Trajectory trajectory;
  std::map<std::string, double> parameters;  // values of constants and parameters; those computed are in trajectory
  std::vector<HappenedEvent> events;
};

// Index analysis at consistent initial values; the trajectory has one row if they were found. Never throws for what
// the model may cause.
Result analyze(const FlatModel& model, const Settings& settings);

// Solves from start to stop.
Result solve(const FlatModel& model, const Settings& settings);

}  // namespace sfdae::cli
