//! base 0.1.0
package 'RlcLadder'
  model 'RlcLadder' "A ladder of inductors and capacitors; the first capacitor is at the source: index 2"
    parameter Real 'source.V'(unit = "V") = 10.0 "amplitude";
    parameter Real 'source.w'(unit = "rad/s") = 2000.0 "angular frequency";
    parameter Real 'R'(unit = "Ohm") = 5.0 "in series with each inductor";
    parameter Real 'L'(unit = "H") = 0.01;
    parameter Real 'C'(unit = "F") = 1e-05;
    parameter Real 'load.R'(unit = "Ohm") = 100.0;
    Real 'source.i'(unit = "A") "out of the source: needs the derivative of its voltage";
    Real 'C[0].v'(unit = "V");
    Real 'C[0].i'(unit = "A");
    Real 'C[1].v'(fixed = true, start = 1.0, unit = "V");
    Real 'C[1].i'(unit = "A");
    Real 'C[2].v'(fixed = true, start = 0.0, unit = "V");
    Real 'C[2].i'(unit = "A");
    Real 'L[1].i'(fixed = true, start = 0.0, unit = "A");
    Real 'L[1].v'(unit = "V");
    Real 'L[2].i'(fixed = true, start = 0.0, unit = "A");
    Real 'L[2].v'(unit = "V");
    Real 'load.i'(unit = "A");
  equation
    'C[0].v' = 'source.V' * cos('source.w' * time);
    'C[0].i' = 'C' * der('C[0].v');
    'C[1].i' = 'C' * der('C[1].v');
    'C[2].i' = 'C' * der('C[2].v');
    'L[1].v' = 'L' * der('L[1].i');
    'L[2].v' = 'L' * der('L[2].i');
    'C[0].v' = 'R' * 'L[1].i' + 'L[1].v' + 'C[1].v';
    'C[1].v' = 'R' * 'L[2].i' + 'L[2].v' + 'C[2].v';
    'C[2].v' = 'load.R' * 'load.i';
    'source.i' = 'C[0].i' + 'L[1].i' "Kirchhoff";
    'L[1].i' = 'C[1].i' + 'L[2].i';
    'L[2].i' = 'C[2].i' + 'load.i';
    annotation(experiment(StartTime = 0.0, StopTime = 0.02, Tolerance = 1e-08));
  end 'RlcLadder';
end 'RlcLadder';
