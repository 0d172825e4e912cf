//! base 0.1.0
package 'Rectifier'
  model 'Rectifier' "Two ideal diodes and two capacitors double the peak of an alternating voltage"
    parameter Real 'source.V'(unit = "V") = 20.0 "amplitude";
    parameter Real 'source.w'(unit = "rad/s") = 314.1592653589793 "50 Hz";
    parameter Real 'source.R'(unit = "Ohm") = 5.0;
    parameter Real 'C[1].C'(unit = "F") = 0.001;
    parameter Real 'C[2].C'(unit = "F") = 0.0005;
    parameter Real 'load.R'(unit = "Ohm") = 400.0;
    parameter Real 'Ron'(unit = "Ohm") = 0.01 "of a diode that conducts";
    parameter Real 'Goff'(unit = "S") = 1e-05 "of a diode that blocks";
    Real 'source.v'(unit = "V");
    Real 'source.i'(unit = "A");
    Real 'node.v'(unit = "V") "potential between the diodes";
    Real 'C[1].v'(fixed = true, start = 1.0, unit = "V");
    Real 'C[2].v'(fixed = true, start = 2.0, unit = "V") "output";
    Real 'D[1].v'(unit = "V") "from ground to the node";
    Real 'D[1].i'(unit = "A");
    Real 'D[1].s' "along the characteristic: current if it conducts, voltage if it blocks";
    Boolean 'D[1].off'(start = true);
    Real 'D[2].v'(unit = "V") "from the node to the output";
    Real 'D[2].i'(unit = "A");
    Real 'D[2].s' "along the characteristic: current if it conducts, voltage if it blocks";
    Boolean 'D[2].off'(start = true);
  equation
    'source.v' = 'source.V' * sin('source.w' * time + 0.2);
    'source.v' = 'source.R' * 'source.i' + 'C[1].v' + 'node.v';
    'C[1].C' * der('C[1].v') = 'source.i';
    'D[1].off' = 'D[1].s' < 0.0;
    'D[1].v' = 'D[1].s' * (if 'D[1].off' then 1.0 else 'Ron');
    'D[1].i' = 'D[1].s' * (if 'D[1].off' then 'Goff' else 1.0);
    'D[2].off' = 'D[2].s' < 0.0;
    'D[2].v' = 'D[2].s' * (if 'D[2].off' then 1.0 else 'Ron');
    'D[2].i' = 'D[2].s' * (if 'D[2].off' then 'Goff' else 1.0);
    'D[1].v' = -'node.v';
    'D[2].v' = 'node.v' - 'C[2].v';
    'source.i' + 'D[1].i' = 'D[2].i' "Kirchhoff";
    'C[2].C' * der('C[2].v') = 'D[2].i' - 'C[2].v' / 'load.R';
    annotation(experiment(StartTime = 0.0, StopTime = 0.1, Tolerance = 1e-08, Interval = 0.0002));
  end 'Rectifier';
end 'Rectifier';
