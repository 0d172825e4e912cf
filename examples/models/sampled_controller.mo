//! base 0.1.0
package 'SampledController'
  model 'SampledController' "A first-order plant with a PI controller that computes every tenth of a second"
    parameter Real 'Ts'(unit = "s") = 0.1 "sampling interval";
    parameter Real 'K' = 2.0 "gain";
    parameter Real 'Ti'(unit = "s") = 0.5 "integral time";
    parameter Real 'plant.T'(unit = "s") = 1.0 "time constant";
    parameter Real 'reference' = 1.0;
    Real 'plant.x'(fixed = true, start = 0.2);
    discrete Real 'e'(fixed = true, start = 0.0) "control error";
    discrete Real 'I'(fixed = true, start = 0.0) "its integral";
    discrete Real 'u'(fixed = true, start = 0.0) "input of the plant";
  equation
    'plant.T' * der('plant.x') = -'plant.x' + 'u';
    when sample(0.0, 'Ts') then
      'e' = 'reference' - 'plant.x';
      'I' = pre('I') + 'Ts' / 'Ti' * 'e';
      'u' = 'K' * ('e' + 'I');
    end when;
    annotation(experiment(StartTime = 0.0, StopTime = 5.05, Tolerance = 1e-08));
  end 'SampledController';
end 'SampledController';
