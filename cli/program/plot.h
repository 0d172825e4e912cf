// Curves as a picture, drawn by gnuplot.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "program/output_file.h"
#include "simulation/simulation.h"

namespace sfdae::cli {

// Throws ProgramError unless the path ends in .svg, .png or .pdf and gnuplot is installed.
void require_plotter(const std::string& path);

// One panel per unit, with its first curves. Returns a warning if curves were omitted, else "". Throws ProgramError if
// gnuplot fails.
std::string draw_plot(const Trajectory& trajectory, const std::string& title, OutputFile& file);

}  // namespace sfdae::cli
