//! base 0.1.0
package 'BouncingBall'
  model 'BouncingBall' "A ball that loses part of its speed with each impact and comes to rest at last"
    parameter Real 'g'(unit = "m/s2") = 9.81 "gravity";
    parameter Real 'e' = 0.7 "restitution";
    parameter Real 'vmin'(unit = "m/s") = 0.05 "slower than this it stays on the ground";
    Real 'h'(fixed = true, start = 1.0, unit = "m") "height";
    Real 'v'(fixed = true, start = 0.0, unit = "m/s");
    discrete Real 'vnew'(fixed = true, start = 0.0, unit = "m/s") "after the impact";
    Integer 'n'(fixed = true, start = 0) "number of impacts";
    Boolean 'flying'(fixed = true, start = true);
    Boolean 'impact';
  equation
    der('h') = 'v';
    der('v') = if 'flying' then -'g' else 0.0;
    'impact' = 'h' <= 0.0 and 'v' < 0.0;
    when 'impact' then
      'vnew' = if 'e' * abs(pre('v')) > 'vmin' then -'e' * pre('v') else 0.0;
      'flying' = 'vnew' > 0.0;
      'n' = pre('n') + 1;
      reinit('v', 'vnew');
    end when;
    annotation(experiment(StartTime = 0.0, StopTime = 3.0, Tolerance = 1e-08));
  end 'BouncingBall';
end 'BouncingBall';
