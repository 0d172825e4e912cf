# SPDX-License-Identifier: BSD-3-Clause
# Milliseconds against correct digits, one SVG a problem, from the output of work_precision_multibody:
#
#   gnuplot -e "results='results.csv'" work_precision_multibody.gp
if (!exists("results")) results = "results.csv"
problems = "pendulum car_axis rigid_slider_crank slider_crank andrews fekete five_bar"
series = '"IDA idx1" "IDA idx2" "IDA ggl2" "multibody BDF" "multibody Radau" '.\
    '"general BDF" "general Radau" "structured BDF" "structured Radau" "extended BDF" "extended Radau"'

set datafile separator comma
set logscale y
set xlabel "correct digits"
set ylabel "milliseconds"
set grid
set key left top

# Rows of the library carry no form in their title.
title_of(solver, form) = (solver[1:3] eq "IDA") ? solver." ".form : solver
belongs(problem, one) = strcol(1) eq problem && title_of(strcol(2), strcol(3)) eq one && column(5) > 0

do for [problem in problems] {
  # The series that have points.
  present = ""
  set terminal unknown
  do for [one in series] {
    count = 0
    set table $rows
    plot [-1:1e9] [0.1:10] results using (count = count + (belongs(problem, one) ? 1 : 0), count):(1)
    unset table
    if (count > 0) { present = present.' "'.one.'"' }
  }
  if (strlen(present) > 0) {
    set terminal svg size 640,440 font "sans,11"
    set output "work_precision_multibody_".problem.".svg"
    set title problem noenhanced
    plot for [one in present] results using (belongs(problem, one) ? column(5) : NaN):6 with linespoints \
      title one noenhanced
    unset output
  }
}
