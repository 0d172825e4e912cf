# SPDX-License-Identifier: BSD-3-Clause
# Milliseconds against correct digits, one SVG a problem, from the output of work_precision_nonlinear:
#
#   gnuplot -e "results='results.csv'" work_precision_nonlinear.gp
if (!exists("results")) results = "results.csv"
problems = "pendulum car_axis rigid_slider_crank slider_crank andrews fekete transistor_amplifier akzo nand"
series = '"IDA raw" "IDA raw tight" "IDA idx1" "IDA idx2" "IDA ggl2" "sfdae BDF" "sfdae Radau"'

set datafile separator comma
set terminal svg size 640,440 font "sans,11"
set logscale y
set xlabel "correct digits"
set ylabel "milliseconds"
set grid
set key left top

# Rows of sfdae carry no form in their title.
title_of(solver, form) = (solver[1:3] eq "IDA") ? solver." ".form : solver
kept(problem, series, digits) = \
  (strcol(1) eq problem && title_of(strcol(2), strcol(3)) eq series && digits > 0) ? digits : NaN

do for [problem in problems] {
  stats results using (strcol(1) eq problem && column(5) > 0 ? column(5) : NaN) nooutput name "problem"
  if (exists("problem_records") && problem_records > 0) {
    set output "work_precision_".problem.".svg"
    set title problem noenhanced
    plot for [s in series] results using (kept(problem, s, column(5))):6 with linespoints title s noenhanced
    unset output
  }
}
