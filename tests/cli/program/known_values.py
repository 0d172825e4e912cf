"""What is known of the models in examples/models.

Values: exact solutions evaluated with 30 digits, or ordinary differential equations in other coordinates solved with 30
digits (pendulum: the angle; tank, transistor amplifier and squeezer: reference solutions in quadruple precision, the
latter two of the IVP test set). `scale` is the size that errors are relative to where the value itself is small.
"""

# model: (strangeness index, number of free initial values, end time, {variable: (value, scale)}, tolerance of the test)
KNOWN = {
    # Angle th: th'' = -g / L sin(th), th(0) = pi / 2, x = sin(th), y = -cos(th), F = th'^2 + g cos(th).
    "pendulum": (2, 2, 10.0, {
        "x": (0.27508746257611686, 1), "y": (-0.96141920509912506, 1), "vx": (-4.1755981009517288, 1),
        "vy": (-1.1947490545604753, 1), "F": (28.294567206067251, 1), "energy": (0.0, 1)}, 1e-6),
    # tan(phi) = -X'' / (Z'' + g), l = -Z / cos(phi), s = X + Z tan(phi), and the forces from s'' and l''.
    "crane": (4, 0, 5.0, {
        "trolley.s": (0.60947587626136363, 1), "rope.l": (3.5336505624254101, 1), "rope.phi": (-0.13797083515759744, 1),
        "rope.T": (917.73127442044839, 1), "trolley.F": (132.27947307639302, 1), "winch.M": (91.121690916600908, 1),
        "load.x": (0.12348048567061698, 1)}, 1e-6),
    # v = V0 (1 - exp(-t / (R (C1 + C2)))). Index 1 once C[2].v is substituted.
    "two_capacitors": (0, 1, 0.02, {
        "C[1].v": (9.9872736619866019, 1), "C[2].v": (9.9872736619866019, 1), "R.i": (1.2726338013398083e-5, 0.01)},
        1e-6),
    # Each phase alone: L i' = u - mean(u) - R / 3 i. Potentials: v = (R i + sum(u)) / 3.
    "delta_load": (1, 2, 0.06, {
        "line[1].i": (-13.371298273198972, 1), "line[2].i": (-11.589873740154663, 1),
        "line[3].i": (24.961172013353635, 1), "node[1].v": (-146.70336378875631, 1),
        "node[3].v": (236.62133907676976, 1), "load[1].i": (-0.59380817768143655, 1)}, 1e-6),
    # Every position is a multiple of the wanted one.
    "servo_chain": (6, 0, 6.0, {
        "s[1]": (0.001483893138247068, 0.1), "s[2]": (0.0021430743017154775, 0.1), "v[1]": (-0.089813047704594221, 0.1),
        "F": (-0.029706006099792283, 1)}, 1e-6),
    # Forced oscillation and matrix exponential; source.i = L1.i + C V'.
    "rlc_ladder": (1, 4, 0.02, {
        "C[1].v": (4.9919632880081614, 1), "C[2].v": (13.442832183760458, 1), "L[1].i": (-0.35818282877055841, 0.1),
        "L[2].i": (-0.11528696172455517, 0.1), "source.i": (-0.50720546086642816, 0.1)}, 1e-6),
    # Matrix exponentials between the 19 instants at which diodes switch.
    "rectifier": (0, 2, 0.1, {
        "C[1].v": (-16.573834906845744, 1), "C[2].v": (29.79763797032568, 1), "source.i": (1.1295675507617402e-4, 0.1),
        "node.v": (20.546656738971541, 1)}, 1e-6),
    # IVP test set, confirmed in quadruple precision.
    "transistor_amplifier": (0, 5, 0.2, {
        "U[1]": (-0.5562145012262709e-2, 0.1), "U[2]": (0.3006522471903042e1, 1), "U[3]": (0.2849958788608128e1, 1),
        "U[4]": (0.2926422536206241e1, 1), "U[5]": (0.2704617865010554e1, 1), "U[6]": (0.2761837778393145e1, 1),
        "U[7]": (0.4770927631616772e1, 1), "U[8]": (0.1236995868091548e1, 1)}, 1e-5),
    # IVP test set, in quadruple precision.
    "squeezer": (2, 2, 0.03, {
        "beta": (15.81077119515370710, 1), "Theta": (-15.75637105841183947, 1), "gamma": (0.0408222401196458049, 0.1),
        "Phi": (-0.534730116342079594, 1), "delta": (0.524409965879954069, 1), "Omega": (0.534730116342079594, 1),
        "epsilon": (1.048080741041937873, 1), "lambda[1]": (199.175348104538628, 1),
        "lambda[2]": (-29.7553099749717633, 1)}, 1e-5),
    # Parabolas; the speed is 0.7 of that before, 13 impacts.
    "bouncing_ball": (-1, 2, 3.0, {"h": (0.0, 1), "v": (0.0, 1), "n": (13.0, 1), "flying": (0.0, 1)}, 1e-6),
    # k = sqrt(2) by hand; h' = (q - k opening sqrt(h)) / A.
    "tank": (-1, 1, 20.0, {"h": (1.8125357368800358, 1), "outlet.k": (1.4142135623730951, 1), "level": (3.0, 1)}, 1e-6),
    # Exponentials between switching times, of which the first is 1e4 ln(20 / 14).
    "thermostat": (0, 1, 20000.0, {"room.T": (20.358059385882982, 1), "switches": (13.0, 1), "heater.on": (0.0, 1)}, 1e-6),
    # x = exp(-Ts) x + (1 - exp(-Ts)) u, the controller as written, 51 samples.
    "sampled_controller": (0, 1, 5.05, {"plant.x": (0.99985611671178779, 1), "u": (1.0002313594382604, 1)}, 1e-6),
}
