//! base 0.1.0
package 'TransistorAmplifier'
  type 'Voltage' = Real(unit = "V", quantity = "ElectricPotential");
  type 'Current' = Real(unit = "A", quantity = "ElectricCurrent");
  type 'Resistance' = Real(unit = "Ohm", min = 0.0);
  type 'Capacitance' = Real(unit = "F", min = 0.0);
  model 'TransistorAmplifier' "Two transistors amplify a signal of 100 Hz (IVP test set): voltages of the nodes, index 1"
    constant Real 'pi' = 3.141592653589793;
    parameter 'Voltage' 'Ub' = 6.0 "supply";
    parameter 'Voltage' 'UF' = 0.026 "thermal voltage";
    parameter Real 'alpha' = 0.99 "share of the emitter current that the collector carries";
    parameter 'Current' 'beta' = 1e-06 "saturation current";
    parameter 'Resistance' 'R0' = 1000.0;
    parameter 'Resistance' 'R' = 9000.0 "all other resistors";
    parameter 'Capacitance' 'C' = 1e-06 "the first capacitor; the k-th is k times as large";
    'Voltage' 'Ue' "input";
    'Voltage' 'U[1]'(start = 0.0);
    'Voltage' 'U[2]'(start = 3.0, fixed = true);
    'Voltage' 'U[3]'(start = 3.0, fixed = true);
    'Voltage' 'U[4]'(start = 6.0);
    'Voltage' 'U[5]'(start = 3.0, fixed = true);
    'Voltage' 'U[6]'(start = 3.0, fixed = true);
    'Voltage' 'U[7]'(start = 6.0);
    'Voltage' 'U[8]'(start = 0.0, fixed = true) "output";
    'Current' 'T[1].i' "of the emitters";
    'Current' 'T[2].i';
  equation
    'Ue' = 0.1 * sin(200.0 * 'pi' * time);
    'T[1].i' = 'beta' * (exp(('U[2]' - 'U[3]') / 'UF') - 1.0);
    'T[2].i' = 'beta' * (exp(('U[5]' - 'U[6]') / 'UF') - 1.0);
    'C' * (der('U[2]') - der('U[1]')) = ('U[1]' - 'Ue') / 'R0';
    'C' * (der('U[1]') - der('U[2]')) = 'U[2]' / 'R' + ('U[2]' - 'Ub') / 'R' + (1.0 - 'alpha') * 'T[1].i';
    -2.0 * 'C' * der('U[3]') = 'U[3]' / 'R' - 'T[1].i';
    3.0 * 'C' * (der('U[5]') - der('U[4]')) = ('U[4]' - 'Ub') / 'R' + 'alpha' * 'T[1].i';
    3.0 * 'C' * (der('U[4]') - der('U[5]')) = 'U[5]' / 'R' + ('U[5]' - 'Ub') / 'R' + (1.0 - 'alpha') * 'T[2].i';
    -4.0 * 'C' * der('U[6]') = 'U[6]' / 'R' - 'T[2].i';
    5.0 * 'C' * (der('U[8]') - der('U[7]')) = ('U[7]' - 'Ub') / 'R' + 'alpha' * 'T[2].i';
    5.0 * 'C' * (der('U[7]') - der('U[8]')) = 'U[8]' / 'R';
    annotation(experiment(StartTime = 0.0, StopTime = 0.2, Tolerance = 1e-07, Interval = 0.0002));
  end 'TransistorAmplifier';
end 'TransistorAmplifier';
