//! base 0.1.0
package 'Tank'
  type 'Level' = enumeration('low', 'normal', 'high');
  model 'Tank' "A tank that is to start in steady state: the size of its outlet follows"
    parameter Real 'outlet.k'(fixed = false, start = 1.0, unit = "m2.5/s") "found from the initial equations";
    parameter Real 'h0'(unit = "m") = 0.5 "level at the start";
    parameter Real 'A'(unit = "m2") = 2.0 "area";
    Real 'h'(start = 0.4, min = 0.0, unit = "m") "level";
    Real 'inlet.q'(unit = "m3/s");
    Real 'outlet.q'(unit = "m3/s");
    Real 'outlet.opening' "closes to a half after 5 s";
    'Level' 'level';
  initial equation
    'h' = 'h0';
    der('h') = 0.0;
  equation
    'inlet.q' = 1.0 + 0.2 * sin(2.0 * time);
    'outlet.q' = 'outlet.k' * 'outlet.opening' * (if noEvent('h' > 0.0) then sqrt('h') else 0.0);
    'A' * der('h') = 'inlet.q' - 'outlet.q';
    if time < 5.0 then
      'outlet.opening' = 1.0;
    else
      'outlet.opening' = 0.5 + 0.5 * exp(-(time - 5.0));
    end if;
    'level' = if 'h' < 0.4 then 'Level'.'low' elseif 'h' < 0.8 then 'Level'.'normal' else 'Level'.'high';
    annotation(experiment(StartTime = 0.0, StopTime = 20.0, Tolerance = 1e-08, Interval = 0.05));
  end 'Tank';
end 'Tank';
