//! base 0.1.0
package 'ServoChain'
  model 'ServoChain' "Three masses in a row, joined by springs: which force on the first moves the last as wanted? index 7"
    parameter Real 'm[1]'(unit = "kg") = 1.0;
    parameter Real 'm[2]'(unit = "kg") = 2.0;
    parameter Real 'm[3]'(unit = "kg") = 3.0;
    parameter Real 'k[1]'(unit = "N/m") = 40.0 "spring between the masses 1 and 2";
    parameter Real 'k[2]'(unit = "N/m") = 50.0 "spring between the masses 2 and 3";
    parameter Real 'w'(unit = "rad/s") = 1.5 "of the wanted oscillation";
    Real 's[1]'(unit = "m") "positions";
    Real 's[2]'(unit = "m");
    Real 's[3]'(unit = "m");
    Real 'v[1]'(unit = "m/s");
    Real 'v[2]'(unit = "m/s");
    Real 'v[3]'(unit = "m/s");
    Real 'F'(unit = "N") "force on the first mass";
  equation
    der('s[1]') = 'v[1]';
    der('s[2]') = 'v[2]';
    der('s[3]') = 'v[3]';
    'm[1]' * der('v[1]') = 'k[1]' * ('s[2]' - 's[1]') + 'F';
    'm[2]' * der('v[2]') = 'k[1]' * ('s[1]' - 's[2]') + 'k[2]' * ('s[3]' - 's[2]');
    'm[3]' * der('v[3]') = 'k[2]' * ('s[2]' - 's[3]');
    's[3]' = 0.1 * sin('w' * time + 0.4) "wanted";
    annotation(experiment(StartTime = 0.0, StopTime = 6.0, Tolerance = 1e-08, Interval = 0.02));
  end 'ServoChain';
end 'ServoChain';
