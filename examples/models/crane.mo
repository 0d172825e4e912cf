//! base 0.1.0
package 'Crane'
  model 'Crane' "Overhead crane whose load follows a path: which forces of trolley and winch does it take? index 5"
    constant Real 'pi' = 3.141592653589793;
    parameter Real 'g'(unit = "m/s2") = 9.81 "gravity";
    parameter Real 'trolley.m'(unit = "kg") = 10.0 "mass of the trolley";
    parameter Real 'winch.J'(unit = "kg.m2") = 0.1 "moment of inertia of the winch";
    parameter Real 'winch.r'(unit = "m") = 0.1 "radius of the winch";
    parameter Real 'load.m'(unit = "kg") = 100.0 "mass of the load";
    parameter Real 'path.w'(unit = "rad/s") = 1.2 "angular frequency of the path";
    Real 'trolley.s'(start = 0.5, unit = "m") "position";
    Real 'trolley.v'(unit = "m/s");
    Real 'trolley.F'(start = 0.0, unit = "N", nominal = 100.0) "force of the drive";
    Real 'rope.l'(start = 4.0, unit = "m") "length";
    Real 'rope.v'(unit = "m/s");
    Real 'rope.T'(start = 1000.0, unit = "N", nominal = 1000.0) "tension";
    Real 'rope.phi'(start = 0.1, unit = "rad") "angle from the vertical";
    Real 'winch.M'(start = 100.0, unit = "N.m", nominal = 100.0) "torque of the drive, against the load";
    Real 'load.x'(start = 0.5, unit = "m") "horizontal position";
    Real 'load.z'(start = -4.0, unit = "m") "height below the trolley";
    Real 'load.vx'(unit = "m/s");
    Real 'load.vz'(unit = "m/s");
  equation
    der('trolley.s') = 'trolley.v';
    der('rope.l') = 'rope.v';
    der('load.x') = 'load.vx';
    der('load.z') = 'load.vz';
    'trolley.m' * der('trolley.v') = 'trolley.F' + 'rope.T' * sin('rope.phi');
    'winch.J' / 'winch.r' * der('rope.v') = 'winch.r' * 'rope.T' - 'winch.M';
    'load.m' * der('load.vx') = -'rope.T' * sin('rope.phi');
    'load.m' * der('load.vz') = 'rope.T' * cos('rope.phi') - 'load.m' * 'g';
    'load.x' = 'trolley.s' + 'rope.l' * sin('rope.phi');
    'load.z' = -'rope.l' * cos('rope.phi');
    'load.x' = 1.0 + sin('path.w' * time - 0.25 * 'pi') "the path";
    'load.z' = -4.0 + 0.5 * cos('path.w' * time + 0.3);
    annotation(experiment(StartTime = 0.0, StopTime = 5.0, Tolerance = 1e-07, Interval = 0.01));
  end 'Crane';
end 'Crane';
