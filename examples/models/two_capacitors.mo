//! base 0.1.0
package 'TwoCapacitors'
  model 'TwoCapacitors' "Two capacitors in parallel are charged: only one voltage is free, index 2"
    parameter Real 'V0'(unit = "V") = 10.0 "supply";
    parameter Real 'R.R'(unit = "Ohm") = 1000.0;
    parameter Real 'C[1].C'(unit = "F") = 1e-06;
    parameter Real 'C[2].C'(unit = "F") = 2.0 * 'C[1].C';
    Real 'C[1].v'(fixed = true, start = 0.0, unit = "V");
    Real 'C[2].v'(unit = "V");
    Real 'C[1].i'(unit = "A");
    Real 'C[2].i'(unit = "A");
    Real 'R.i'(unit = "A");
  equation
    'V0' = 'R.R' * 'R.i' + 'C[1].v';
    'C[1].i' = 'C[1].C' * der('C[1].v');
    'C[2].i' = 'C[2].C' * der('C[2].v');
    'C[1].v' = 'C[2].v' "parallel";
    'R.i' = 'C[1].i' + 'C[2].i' "Kirchhoff";
    annotation(experiment(StartTime = 0.0, StopTime = 0.02, Tolerance = 1e-08));
  end 'TwoCapacitors';
end 'TwoCapacitors';
