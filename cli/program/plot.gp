# Draws one panel for each unit. What comes before this makes: the datablock $data (time, then a column for each curve),
# the array title, the arrays unit, first and last (of panels: columns of their first and last curve), output.
# SPDX-License-Identifier: BSD-3-Clause
set encoding utf8
set datafile missing "nan"
set style data lines
set linetype 1 linecolor rgb "#2a78d6" linewidth 1.5
set linetype 2 linecolor rgb "#d9541e" linewidth 1.5
set linetype 3 linecolor rgb "#12976a" linewidth 1.5
set linetype 4 linecolor rgb "#b98300" linewidth 1.5
set linetype 5 linecolor rgb "#4a3aa7" linewidth 1.5
set linetype 6 linecolor rgb "#d64a86" linewidth 1.5
set linetype 7 linecolor rgb "#0c7f8f" linewidth 1.5
set linetype 8 linecolor rgb "#8a5a2b" linewidth 1.5
set linetype cycle 8
set grid linetype -1 linecolor rgb "#cccccc" linewidth 0.5
set border linecolor rgb "#888888"
set tics textcolor rgb "#333333"
set key outside top right horizontal reverse Left noenhanced
set lmargin 12
set rmargin 4
stats $data using 1 nooutput
set xrange [STATS_min : STATS_max == STATS_min ? STATS_min + 1 : STATS_max]
set multiplot layout |unit|, 1 title model noenhanced
do for [panel = 1:|unit|] {
  set ylabel unit[panel] noenhanced
  if (panel == |unit|) { set xlabel "time in s" }
  plot for [k = first[panel]:last[panel]] $data using 1:k title title[k - 1] noenhanced
}
unset multiplot
