# Draws constrained_chain.csv, which the program constrained_chain writes:  gnuplot constrained_chain.gp
set terminal svg size 900,700 font 'Helvetica,14' background 'white'
set output 'constrained_chain.svg'
set datafile separator ','
set multiplot
set lmargin 10
set rmargin 18
set grid lc rgb '#dddddd'
set key outside right top
set border 3
set tics nomirror
data = 'constrained_chain.csv'
colors = '#1b6ca8 #57a0d3 #2e8b57 #8fbc5a #d95f02 #b03060'

set title 'Ten masses, two turning constraints'
set origin 0,0.35
set size 1,0.65
set yrange [-1.1:1.1]
set format x ''
set ylabel 'position, force'
plot for [i=2:7] data using 1:i with lines lw 2 lc rgb word(colors, i-1) title columnheader(i)

unset title
set xlabel 'time (no units: masses and springs of size 1)'
set ylabel 'error / tolerance'
set logscale y
set origin 0,0
set size 1,0.38
set yrange [0.01:20]
set format x '%g'
plot data using 1:8 with lines lw 2 lc rgb '#444444' title columnheader(8)
