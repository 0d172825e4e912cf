//! base 0.1.0
package 'Pendulum'
  model 'Pendulum' "Pendulum in Cartesian coordinates, released from the horizontal: index 3"
    parameter Real 'm'(unit = "kg") = 1.0 "mass";
    parameter Real 'L'(unit = "m") = 1.0 "length of the rod";
    parameter Real 'g'(unit = "m/s2") = 9.81 "gravity";
    Real 'x'(start = 1.0, unit = "m") "a guess: it follows from y and L";
    Real 'y'(fixed = true, start = 0.0, unit = "m") "height";
    Real 'vx'(unit = "m/s");
    Real 'vy'(fixed = true, start = 0.0, unit = "m/s");
    Real 'F'(unit = "N/m") "force of the rod over its length";
    Real 'energy'(unit = "J") "constant";
  equation
    der('x') = 'vx';
    der('y') = 'vy';
    'm' * der('vx') = -'F' * 'x';
    'm' * der('vy') = -'F' * 'y' - 'm' * 'g';
    'x' ^ 2 + 'y' ^ 2 = 'L' ^ 2;
    'energy' = 0.5 * 'm' * ('vx' ^ 2 + 'vy' ^ 2) + 'm' * 'g' * 'y';
    annotation(experiment(StartTime = 0.0, StopTime = 10.0, Tolerance = 1e-08, Interval = 0.02));
  end 'Pendulum';
end 'Pendulum';
