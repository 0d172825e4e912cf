#include "trace.h"
namespace sfdae_bench {
void add_nonlinear_runs(Runs&) {}
void add_nonlinear_option_runs(Runs&) {}
void add_multibody_runs(Runs&) {}
void add_multibody_option_runs(Runs&) {}
void add_argument_runs(Runs&) {}
void add_wrapper_runs(Runs&) {}
void add_dgelda_runs(Runs&) {}
void add_sfndae_runs(Runs&) {}
void add_cost_runs(Runs&) {}
}  // namespace sfdae_bench
