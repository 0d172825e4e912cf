# Draws squeezer.csv, which the program squeezer writes:  gnuplot squeezer.gp
set terminal svg size 900,600 font 'Helvetica,14' background 'white'
set output 'squeezer.svg'
set datafile separator ','
set multiplot
set lmargin 10
set rmargin 16
set grid lc rgb '#dddddd'
set key outside right top
set border 3
set tics nomirror
set xrange [0:0.03]
data = 'squeezer.csv'
colors = '#1b6ca8 #57a0d3 #2e8b57 #8fbc5a #d95f02 #b03060 #7b5ea7'
set title "Angles of Andrews' squeezing mechanism"
set origin 0,0.5
set size 1,0.5
set format x ''
set ylabel 'angle (rad)'
plot for [i=2:3] data using 1:i with lines lw 2 lc rgb word(colors, i-1) title columnheader(i)
unset title
set origin 0,0
set size 1,0.53
set xlabel 'time (s)'
set format x '%g'
plot for [i=4:8] data using 1:i with lines lw 2 lc rgb word(colors, i-1) title columnheader(i)
