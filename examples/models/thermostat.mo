//! base 0.1.0
package 'Thermostat'
  model 'Thermostat' "A room between two temperatures at which the heater is switched"
    parameter Real 'T_outside'(unit = "degC") = 5.0;
    parameter Real 'T_low'(unit = "degC") = 19.0 "the heater goes on below";
    parameter Real 'T_high'(unit = "degC") = 21.0 "the heater goes off above";
    parameter Real 'room.C'(unit = "J/K") = 1000000.0 "heat capacity";
    parameter Real 'room.G'(unit = "W/K") = 100.0 "loss through the walls";
    parameter Real 'heater.P'(unit = "W") = 3000.0;
    Real 'room.T'(fixed = true, start = 15.0, unit = "degC");
    Real 'heater.Q'(unit = "W") "heat flow";
    Boolean 'heater.on'(fixed = true, start = true);
    Integer 'switches'(fixed = true, start = 0) "how often the heater was switched";
  equation
    'room.C' * der('room.T') = 'heater.Q' - 'room.G' * ('room.T' - 'T_outside');
    'heater.Q' = if 'heater.on' then 'heater.P' else 0.0;
    when 'room.T' > 'T_high' then
      'heater.on' = false;
      'switches' = pre('switches') + 1;
    elsewhen 'room.T' < 'T_low' then
      'heater.on' = true;
      'switches' = pre('switches') + 1;
    end when;
    annotation(experiment(StartTime = 0.0, StopTime = 20000.0, Tolerance = 1e-08, Interval = 20.0));
  end 'Thermostat';
end 'Thermostat';
