//! base 0.1.0
package 'Squeezer'
  model 'Squeezer' "Andrews' squeezing mechanism (IVP test set): seven bodies, six loop conditions, index 3"
    parameter Real 'm[1]'(unit = "kg") = 0.04325 "masses";
    parameter Real 'm[2]'(unit = "kg") = 0.00365;
    parameter Real 'm[3]'(unit = "kg") = 0.02373;
    parameter Real 'm[4]'(unit = "kg") = 0.00706;
    parameter Real 'm[5]'(unit = "kg") = 0.0705;
    parameter Real 'm[6]'(unit = "kg") = 0.00706;
    parameter Real 'm[7]'(unit = "kg") = 0.05498;
    parameter Real 'J[1]'(unit = "kg.m2") = 2.194e-06 "moments of inertia";
    parameter Real 'J[2]'(unit = "kg.m2") = 4.41e-07;
    parameter Real 'J[3]'(unit = "kg.m2") = 5.255e-06;
    parameter Real 'J[4]'(unit = "kg.m2") = 5.667e-07;
    parameter Real 'J[5]'(unit = "kg.m2") = 1.169e-05;
    parameter Real 'J[6]'(unit = "kg.m2") = 5.667e-07;
    parameter Real 'J[7]'(unit = "kg.m2") = 1.912e-05;
    parameter Real 'xa'(unit = "m") = -0.06934 "fixed points";
    parameter Real 'ya'(unit = "m") = -0.00227;
    parameter Real 'xb'(unit = "m") = -0.03635;
    parameter Real 'yb'(unit = "m") = 0.03273;
    parameter Real 'xc'(unit = "m") = 0.014;
    parameter Real 'yc'(unit = "m") = 0.072;
    parameter Real 'd'(unit = "m") = 0.028 "lengths and distances of the bodies";
    parameter Real 'da'(unit = "m") = 0.0115;
    parameter Real 'e'(unit = "m") = 0.02;
    parameter Real 'ea'(unit = "m") = 0.01421;
    parameter Real 'rr'(unit = "m") = 0.007;
    parameter Real 'ra'(unit = "m") = 0.00092;
    parameter Real 'l0'(unit = "m") = 0.07785 "its length at rest";
    parameter Real 'ss'(unit = "m") = 0.035;
    parameter Real 'sa'(unit = "m") = 0.01874;
    parameter Real 'sb'(unit = "m") = 0.01043;
    parameter Real 'sc'(unit = "m") = 0.018;
    parameter Real 'sd'(unit = "m") = 0.02;
    parameter Real 'ta'(unit = "m") = 0.02308;
    parameter Real 'tb'(unit = "m") = 0.00916;
    parameter Real 'u'(unit = "m") = 0.04;
    parameter Real 'ua'(unit = "m") = 0.01228;
    parameter Real 'ub'(unit = "m") = 0.00449;
    parameter Real 'zf'(unit = "m") = 0.02;
    parameter Real 'zt'(unit = "m") = 0.04;
    parameter Real 'fa'(unit = "m") = 0.01421;
    parameter Real 'c0'(unit = "N/m") = 4530.0 "stiffness of the spring";
    parameter Real 'mom'(unit = "N.m") = 0.033 "torque of the motor";
    Real 'beta'(start = -0.06171389001427645, unit = "rad");
    Real 'Theta'(fixed = true, start = 0.0, unit = "rad");
    Real 'gamma'(start = 0.45527981916307037, unit = "rad");
    Real 'Phi'(start = 0.22266839016588588, unit = "rad");
    Real 'delta'(start = 0.48736497954384256, unit = "rad");
    Real 'Omega'(start = -0.22266839016588588, unit = "rad");
    Real 'epsilon'(start = 1.2305474445498212, unit = "rad");
    Real 'v.beta'(unit = "rad/s");
    Real 'v.Theta'(fixed = true, start = 0.0, unit = "rad/s");
    Real 'v.gamma'(unit = "rad/s");
    Real 'v.Phi'(unit = "rad/s");
    Real 'v.delta'(unit = "rad/s");
    Real 'v.Omega'(unit = "rad/s");
    Real 'v.epsilon'(unit = "rad/s");
    Real 'lambda[1]'(nominal = 100.0, unit = "N") "forces of the loop conditions";
    Real 'lambda[2]'(nominal = 100.0, unit = "N");
    Real 'lambda[3]'(nominal = 100.0, unit = "N");
    Real 'lambda[4]'(nominal = 100.0, unit = "N");
    Real 'lambda[5]'(nominal = 100.0, unit = "N");
    Real 'lambda[6]'(nominal = 100.0, unit = "N");
    Real 'x'(unit = "m") "where the bodies meet";
    Real 'y'(unit = "m");
    Real 'spring.x'(unit = "m");
    Real 'spring.y'(unit = "m");
    Real 'spring.L'(unit = "m");
    Real 'spring.F'(unit = "N/m") "force over length";
  equation
    der('beta') = 'v.beta';
    der('Theta') = 'v.Theta';
    der('gamma') = 'v.gamma';
    der('Phi') = 'v.Phi';
    der('delta') = 'v.delta';
    der('Omega') = 'v.Omega';
    der('epsilon') = 'v.epsilon';
    ('m[1]' * 'ra' ^ 2 + 'm[2]' * ('rr' ^ 2 - 2.0 * 'da' * 'rr' * cos('Theta') + 'da' ^ 2) + 'J[1]' + 'J[2]') *
        der('v.beta') + ('m[2]' * ('da' ^ 2 - 'da' * 'rr' * cos('Theta')) + 'J[2]') * der('v.Theta') = 'mom' -
        'm[2]' * 'da' * 'rr' * 'v.Theta' * ('v.Theta' + 2.0 * 'v.beta') * sin('Theta') - ('lambda[1]' +
        'lambda[3]' + 'lambda[5]') * ('d' * sin('beta' + 'Theta') - 'rr' * sin('beta')) - ('lambda[2]' +
        'lambda[4]' + 'lambda[6]') * ('rr' * cos('beta') - 'd' * cos('beta' + 'Theta'));
    ('m[2]' * ('da' ^ 2 - 'da' * 'rr' * cos('Theta')) + 'J[2]') * der('v.beta') + ('m[2]' * 'da' ^ 2 + 'J[2]') *
        der('v.Theta') = 'm[2]' * 'da' * 'rr' * 'v.beta' ^ 2 * sin('Theta') - ('lambda[1]' + 'lambda[3]' +
        'lambda[5]') * 'd' * sin('beta' + 'Theta') + ('lambda[2]' + 'lambda[4]' + 'lambda[6]') * 'd' * cos('beta'
        + 'Theta');
    ('m[3]' * ('sa' ^ 2 + 'sb' ^ 2) + 'J[3]') * der('v.gamma') = 'spring.F' * (('spring.x' - 'xc') * ('sc' *
        cos('gamma') - 'sd' * sin('gamma')) + ('spring.y' - 'yc') * ('sd' * cos('gamma') + 'sc' * sin('gamma'))) +
        'ss' * ('lambda[1]' * cos('gamma') + 'lambda[2]' * sin('gamma'));
    ('m[4]' * ('e' - 'ea') ^ 2 + 'J[4]') * der('v.Phi') + ('m[4]' * (('e' - 'ea') ^ 2 + 'zt' * ('e' - 'ea') *
        sin('Phi')) + 'J[4]') * der('v.delta') = 'm[4]' * 'zt' * ('e' - 'ea') * 'v.delta' ^ 2 * cos('Phi') + 'e' *
        ('lambda[3]' * cos('Phi' + 'delta') + 'lambda[4]' * sin('Phi' + 'delta'));
    ('m[4]' * (('e' - 'ea') ^ 2 + 'zt' * ('e' - 'ea') * sin('Phi')) + 'J[4]') * der('v.Phi') + ('m[4]' * ('zt' ^ 2
        + 2.0 * 'zt' * ('e' - 'ea') * sin('Phi') + ('e' - 'ea') ^ 2) + 'm[5]' * ('ta' ^ 2 + 'tb' ^ 2) + 'J[4]' +
        'J[5]') * der('v.delta') = -'m[4]' * 'zt' * ('e' - 'ea') * 'v.Phi' * ('v.Phi' + 2.0 * 'v.delta') *
        cos('Phi') + 'lambda[3]' * ('e' * cos('Phi' + 'delta') - 'zt' * sin('delta')) + 'lambda[4]' * ('e' *
        sin('Phi' + 'delta') + 'zt' * cos('delta'));
    ('m[6]' * ('zf' - 'fa') ^ 2 + 'J[6]') * der('v.Omega') + ('m[6]' * (('zf' - 'fa') ^ 2 - 'u' * ('zf' - 'fa') *
        sin('Omega')) + 'J[6]') * der('v.epsilon') = -'m[6]' * 'u' * ('zf' - 'fa') * 'v.epsilon' ^ 2 *
        cos('Omega') - 'zf' * ('lambda[5]' * sin('Omega' + 'epsilon') - 'lambda[6]' * cos('Omega' + 'epsilon'));
    ('m[6]' * (('zf' - 'fa') ^ 2 - 'u' * ('zf' - 'fa') * sin('Omega')) + 'J[6]') * der('v.Omega') + ('m[6]' *
        (('zf' - 'fa') ^ 2 - 2.0 * 'u' * ('zf' - 'fa') * sin('Omega') + 'u' ^ 2) + 'm[7]' * ('ua' ^ 2 + 'ub' ^ 2)
        + 'J[6]' + 'J[7]') * der('v.epsilon') = 'm[6]' * 'u' * ('zf' - 'fa') * 'v.Omega' * ('v.Omega' + 2.0 *
        'v.epsilon') * cos('Omega') - 'lambda[5]' * ('zf' * sin('Omega' + 'epsilon') - 'u' * cos('epsilon')) +
        'lambda[6]' * ('zf' * cos('Omega' + 'epsilon') + 'u' * sin('epsilon'));
    'x' = 'rr' * cos('beta') - 'd' * cos('beta' + 'Theta');
    'y' = 'rr' * sin('beta') - 'd' * sin('beta' + 'Theta');
    'spring.x' = 'sd' * cos('gamma') + 'sc' * sin('gamma') + 'xb';
    'spring.y' = 'sd' * sin('gamma') - 'sc' * cos('gamma') + 'yb';
    'spring.L' = sqrt(('spring.x' - 'xc') ^ 2 + ('spring.y' - 'yc') ^ 2);
    'spring.F' = -'c0' * ('spring.L' - 'l0') / 'spring.L';
    'x' - 'ss' * sin('gamma') = 'xb';
    'y' + 'ss' * cos('gamma') = 'yb';
    'x' - 'e' * sin('Phi' + 'delta') - 'zt' * cos('delta') = 'xa';
    'y' + 'e' * cos('Phi' + 'delta') - 'zt' * sin('delta') = 'ya';
    'x' - 'zf' * cos('Omega' + 'epsilon') - 'u' * sin('epsilon') = 'xa';
    'y' - 'zf' * sin('Omega' + 'epsilon') + 'u' * cos('epsilon') = 'ya';
    annotation(experiment(StartTime = 0.0, StopTime = 0.03, Tolerance = 1e-08, Interval = 0.0001));
  end 'Squeezer';
end 'Squeezer';
