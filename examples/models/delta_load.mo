//! base 0.1.0
package 'DeltaLoad'
  model 'DeltaLoad' "Three inductive lines feed a load in delta: index 2, though the pattern of the equations says 1"
    // The line currents add up to zero, whatever the numbers are: each phase current leaves one node and enters
    // another. No pattern of zeros shows this. The potentials follow from the derivative of the sum.
    parameter Real 'w'(unit = "rad/s") = 314.1592653589793 "50 Hz";
    parameter Real 'source[1].V'(unit = "V") = 325.0 "amplitudes: one phase is weak";
    parameter Real 'source[2].V'(unit = "V") = 325.0;
    parameter Real 'source[3].V'(unit = "V") = 280.0;
    parameter Real 'line.L'(unit = "H") = 0.02;
    parameter Real 'load.R'(unit = "Ohm") = 30.0;
    Real 'source[1].v'(unit = "V");
    Real 'source[2].v'(unit = "V");
    Real 'source[3].v'(unit = "V");
    Real 'line[1].i'(fixed = true, start = 1.0, unit = "A");
    Real 'line[2].i'(fixed = true, start = 0.5, unit = "A");
    Real 'line[3].i'(start = 0.0, unit = "A") "follows from the other two";
    Real 'node[1].v'(unit = "V");
    Real 'node[2].v'(unit = "V");
    Real 'node[3].v'(unit = "V");
    Real 'load[1].i'(unit = "A") "from node 1 to node 2";
    Real 'load[2].i'(unit = "A") "from node 2 to node 3";
    Real 'load[3].i'(unit = "A") "from node 3 to node 1";
  equation
    'source[1].v' = 'source[1].V' * sin('w' * time);
    'source[2].v' = 'source[2].V' * sin('w' * time - 2.0943951023931953);
    'source[3].v' = 'source[3].V' * sin('w' * time + 2.0943951023931953);
    'line.L' * der('line[1].i') = 'source[1].v' - 'node[1].v';
    'line.L' * der('line[2].i') = 'source[2].v' - 'node[2].v';
    'line.L' * der('line[3].i') = 'source[3].v' - 'node[3].v';
    'load.R' * 'load[1].i' = 'node[1].v' - 'node[2].v';
    'load.R' * 'load[2].i' = 'node[2].v' - 'node[3].v';
    'load.R' * 'load[3].i' = 'node[3].v' - 'node[1].v';
    'line[1].i' = 'load[1].i' - 'load[3].i';
    'line[2].i' = 'load[2].i' - 'load[1].i';
    'line[3].i' = 'load[3].i' - 'load[2].i';
    annotation(experiment(StartTime = 0.0, StopTime = 0.06, Tolerance = 1e-08, Interval = 0.0001));
  end 'DeltaLoad';
end 'DeltaLoad';
