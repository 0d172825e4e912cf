#include "trace.h"
namespace sfdae_bench {
void add_argument_runs(Runs&) {}
void add_wrapper_runs(Runs&) {}
void add_dgelda_runs(Runs&) {}
void add_sfndae_runs(Runs&) {}
void add_cost_runs(Runs&) {}
}  // namespace sfdae_bench
