"""A strip of rubber with a weight that stretches it to about twice its length: a model of its own, what the simulator is told,
what is done and measured. See experiments.py."""
import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

import soft_models
from experiments import Cases, Experiment, chirp, steps
from soft_experiments import BAR, COLUMNS, markers

MODULUS, POISSON_RATIO = 1.5e5, 0.45
WIDTH, WEIGHT, DAMPING = 0.01, 0.6, 2.0  # [m], [kg], of the guide [N s/m]


class Strip:
    """A strip of 0.1 m between a hand and a guided weight below it; it starts unstrained and at rest, and may grow thinner at its
    ends, too. Seen: heights of its end and of its middle. Of a piece with stretch a along and b across, J = a b^2, l = lambda + mu,
    the energy per rest volume is stationary in b:
      W = mu/2 (a^2 + 2 b^2 - 3) - mu (J - 1) + l/2 (J - 1)^2 + V(a / b)
      Yeoh: V = mu/2 (second y^2 + third y^3), y = q^(4/3) + 2 q^(-2/3) - 3;  Ogden: V = 2 mu m / n^2 (q^(2n/3) + 2 q^(-n/3) - 3)
    """

    length, density = 0.1, 1000.0

    def see(self, start, times, effects, command):
        value = lambda name, otherwise: effects.get(name, {}).get("value", otherwise)
        modulus = value("retune_youngs_modulus", MODULUS)
        mu = modulus / (2 * (1 + POISSON_RATIO))
        stiffened = modulus * POISSON_RATIO / ((1 + POISSON_RATIO) * (1 - 2 * POISSON_RATIO)) + mu
        weight = value("retune_mass", WEIGHT)
        yeoh, ogden = effects.get("yeoh_terms", {"second": 0, "third": 0}), effects.get("ogden_term", {"modulus": 0, "exponent": 2})
        viscosity = effects.get("kelvin_voigt_damping", {}).get("viscosity", 0)

        def by_ratio(q):  # dV/dq
            y = q ** (4 / 3) + 2 * q ** (-2 / 3) - 3
            n = ogden["exponent"]
            return (mu / 2 * (2 * yeoh["second"] * y + 3 * yeoh["third"] * y * y) * 4 / 3 * (q ** (1 / 3) - q ** (-5 / 3))
                    + 4 * mu * ogden["modulus"] / (3 * n) * (q ** (2 * n / 3 - 1) - q ** (-n / 3 - 1)))

        def across(a):  # b, by Newton's method
            force = lambda b: 2 * mu * b * (1 - a) + 2 * stiffened * (a * b * b - 1) * a * b - by_ratio(a / b) * a / b**2
            b = 1 / np.sqrt(a)
            for _ in range(50):
                step = force(b) * 1e-6 / (force(b + 5e-7) - force(b - 5e-7))
                b = np.clip(b - step, 0.7 * b, 1.4 * b)
                if np.max(np.abs(step)) < 1e-10:
                    break
            return b

        stretches = np.geomspace(0.2, 10, 4000)
        b = across(stretches)
        elastic = CubicSpline(stretches, mu * (stretches - b * b) + stiffened * (stretches * b * b - 1) * b * b + by_ratio(stretches / b) / b)

        n = soft_models.resolution.pieces
        piece, section = self.length / n, WIDTH**2
        mass = np.full(n, self.density * section * piece)
        mass[-1] /= 2
        mass[-1] += weight

        # of each piece: its far end's displacement and velocity, upward
        def rate(t, state):
            place, speed = state.reshape(n, 2).T
            hand_speed = (command(t + 1e-6) - command(t - 1e-6)) / 2e-6
            a = 1 - np.diff(place, prepend=command(t)) / piece
            a_rate = -np.diff(speed, prepend=hand_speed) / piece
            stress = elastic(np.clip(a, 0.2, 10)) + a * 2 * viscosity * a * a_rate
            pull = -stress * section
            total = -mass * soft_models.G - pull
            total[:-1] += pull[1:]
            total[-1] -= DAMPING * speed[-1]
            return np.column_stack([speed, total / mass]).ravel()

        tolerance = soft_models.resolution.tolerance
        found = solve_ivp(rate, (0, times[-1] + 1e-9), np.tile([command(0), 0], n), method="LSODA", t_eval=times, lband=4, uband=4,
                          rtol=tolerance, atol=tolerance / 100, max_step=0.01)
        if not found.success:
            raise soft_models.TooStrong("the strip gave way at " + str(found.t[-1]) + " s")
        ends = found.y.reshape(n, 2, -1)[:, 0]
        if not -0.9 * self.length < np.min(-ends[-1]) < np.max(-ends[-1]) < 8 * self.length:
            raise soft_models.TooStrong("the strip is crushed or torn")
        zero = np.zeros(len(times))
        return np.column_stack([zero, zero, -self.length + ends[-1], zero, zero, -self.length / 2 + ends[n // 2 - 1]])


def rubber_experiments():
    scene = BAR.format(name="rubber", weight=WEIGHT, width=WIDTH, end=-0.11, middle=-0.05, turn="90 deg")
    scene = scene.replace("youngs_modulus: 100 kPa, poisson_ratio: 0}", f"youngs_modulus: {MODULUS / 1000:g} kPa, poisson_ratio: {POISSON_RATIO}}}")
    scene = scene.replace("velocity_tolerance: 1e-5", "velocity_tolerance: 1e-5, integrator: bdf2").replace("time_step: 10 ms", "time_step: 5 ms")
    scene = scene.replace("child: weight, axis: [0, 0, 1]}", f"child: weight, axis: [0, 0, 1], damping: {DAMPING:g}}}")
    return {"rubber": Experiment(
        "rubber", Strip(), scene,
        [((), 0.8, steps([0, 0], 1), "fit"), ((), 0.8, steps([0, 0.02, -0.01], 0.4), "fit"), ((), 0.8, chirp(0.004, 1, 4, 1.5), "fit"),
         ((), 0.8, steps([0, -0.02, 0.01, 0.0], 0.3, 0.12), "held_out")],
        COLUMNS, markers("bar", 0.05, 0, 2e-4), 2e-4, "bar", "bar", ["driven", "free"], ("body/hand/position", ["hand_x", "hand_y", "hand_z"], 2))}


RUBBER = Cases(
    singles=[
        ("rubber", "yeoh_terms", None, {"second": -0.05, "third": 0.03}, []),
        ("rubber", "ogden_term", None, {"modulus": 0.05, "exponent": 7.0}, []),
        ("rubber", "kelvin_voigt_damping", None, {"viscosity": 30.0}, []),
    ],
    retunes=[("rubber", "retune_youngs_modulus", None, {"value": 5e3}, MODULUS, [])],
    off_library=[],
    pairs=[],
)
