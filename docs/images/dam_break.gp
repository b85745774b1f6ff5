# Picture of docs/verification.md, from the root of the source:
#   gnuplot docs/images/dam_break.gp
# Runs build/release/bin/verification_tables; a second or two.
tables = "< build/release/bin/verification_tables "
set terminal svg size 1000,400 font "Helvetica,13" background "white"
set output "docs/images/dam_break.svg"
set multiplot layout 1,2 margins 0.06,0.985,0.18,0.9 spacing 0.08
set border 3 lw 1; set tics nomirror out scale 0.6; set grid lc rgb "#dddddd" lw 0.6
set key top left reverse Left samplen 2 spacing 1.15

set title "Column of Martin and Moyce, H/W = 2" font ",14"
set xlabel "t √(2g/W)"; set ylabel "front x/W"
set datafile separator " "
set xrange [0:4.6]; set yrange [0.9:7]
plot tables."column cubic relaxed 16 curve=1" w l lw 2 lc rgb "#0072b2" t "slip bed", \
     tables."column cubic relaxed 16 no_slip=1 curve=1" w l lw 2 lc rgb "#d55e00" t "no-slip bed", \
     "< grep -v '^[#t]' data/experiments/dam_break_martin_moyce.csv | tr ',' ' '" \
       w p pt 6 ps 1.1 lw 1.6 lc rgb "black" t "measured (1952)"

set key top right noreverse Right
set title "Long reservoir against Ritter" font ",14"
set xlabel "x/(c_0 t)"; set ylabel "depth/H"
set xrange [-1.5:2.1]; set yrange [0:1.1]
plot tables."ritter cubic relaxed 16 end=2 curve=1" u 1:2 w l lw 1.3 lc rgb "#56b4e9" t "T = 2", \
     tables."ritter cubic relaxed 16 end=8 curve=1" u 1:2 w l lw 1.8 lc rgb "#0072b2" t "T = 8", \
     tables."ritter cubic relaxed 16 end=8 curve=1" u 1:3 w l dt 2 lw 1.6 lc rgb "black" t "Ritter"
unset multiplot
