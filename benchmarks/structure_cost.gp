# SPDX-License-Identifier: BSD-3-Clause
# Time against size and against error, side by side for each problem, from the output of structure_cost csv:
#
#   OPENBLAS_NUM_THREADS=1 structure_cost csv > structure_cost.csv
#   gnuplot structure_cost.gp
if (!exists("results")) results = "structure_cost.csv"
set datafile separator comma
set datafile missing NaN  # lines go on over rows of others
set logscale xy
set grid
set format x "10^{%L}"
set key left top
names = '"brusselator" "stokes"'
titles = '"Brusselator by lines" "Stokes, staggered grid"'
sizes = "2000 936"
belongs(name, solver) = strcol(1) eq name && strcol(3) eq solver

do for [k = 1:2] {
  name = word(names, k)
  size_of_errors = int(word(sizes, k))
  set terminal svg size 860,380 font "sans,11"
  set output "structure_cost_".name.".svg"
  set multiplot layout 1,2
  set title word(titles, k).", rtol = atol = 1e-6"
  set xlabel "unknowns"
  set ylabel "time, start included (ms)"
  plot for [solver in '"sfdae" "IDA KLU"'] results \
    using (belongs(name, solver) && column(4) == 1e-6 ? column(2) : NaN):5 with linespoints title solver
  set title word(titles, k).sprintf(", %d unknowns", size_of_errors)
  set xlabel "largest error relative to 1 + |x| (1)"
  plot for [solver in '"sfdae" "IDA KLU"'] results \
    using (belongs(name, solver) && column(2) == size_of_errors ? column(6) : NaN):5 with linespoints title solver
  unset multiplot
  unset output
}
