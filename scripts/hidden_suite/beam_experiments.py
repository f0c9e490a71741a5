"""A soft beam that a hand holds by one end: its model, a sum of the modes of a slender beam, written apart from the simulator,
and the experiment. See experiments.py; SI units, z up."""
import math

import numpy as np
from scipy.integrate import solve_ivp

from experiments import Cases, Experiment, chirp, steps
from models import G
from soft_experiments import COLUMNS, markers

LENGTH, WIDTH, DENSITY, MODULUS, BRAKING = 0.1, 0.01, 1000.0, 5e6, 20.0
BEAM = f"""schema: 1
name: beam
time_step: 5 ms
duration: 1 s
solver: {{velocity_tolerance: 1e-5}}
bodies:
  - {{name: hand, kind: moving, shape: {{box: {{size: [0.01, 0.05, 0.05]}}}}, collides: false, path: [{{time: 0, position: [0, 0, 0]}}]}}
  - name: bar
    kind: soft
    shape: {{bar: {{size: [{LENGTH}, {WIDTH}, {WIDTH}], divisions: [8, 1, 1], nodes_per_element: 10}}}}
    pose: {{position: [{LENGTH / 2}, 0, 0]}}
    material: {{density: {DENSITY}, youngs_modulus: {MODULUS}, poisson_ratio: 0}}
stitches:
  - {{soft: bar, rigid: hand, low: [-0.0501, -1, -1], high: [-0.0499, 1, 1], stiffness: 1e6}}
effects:  # air and skin, as was measured before
  - {{effect: mass_proportional_damping, target: bar, rate: {BRAKING}}}
"""
ROOTS = (1.875104, 4.694091, 7.854757, 10.995541)  # of cos cosh = -1


def mode(root, s):
    """Deflection at the shares s of its length of a beam that is held at s = 0."""
    ratio = (math.cosh(root) + math.cos(root)) / (math.sinh(root) + math.sin(root))
    return np.cosh(root * s) - np.cos(root * s) - ratio * (np.sinh(root * s) - np.sin(root * s))


class Beam:
    """Euler and Bernoulli's beam, straight along x when weightless, which a hand moves up and down; it starts so, at rest. Of
    each mode phi with share b = int phi / int phi^2 and p its coordinate in the world, h the hand's height:
      p'' + c p' + w^2 (1 + 2 eta / E d/dt) (p - b h) = -b g,    w = root^2 sqrt(E I / (rho A L^4))
    A beam that is bent by the curvature k when nothing acts on it has k x^2 / 2 more everywhere. Seen: places of its end and
    of its middle."""

    def see(self, start, times, effects, command):
        modulus = effects.get("retune_youngs_modulus", {}).get("value", MODULUS)
        gravity = effects.get("retune_gravity", {}).get("value", G)
        viscous = 2 * effects.get("kelvin_voigt_damping", {}).get("viscosity", 0) / modulus
        bent = effects.get("rest_shape_error", {"curvature_1": 0, "curvature_2": 0})
        s = (np.arange(2000) + 0.5) / 2000
        shares = np.array([mode(root, s).sum() / (mode(root, s) ** 2).sum() for root in ROOTS])
        squares = np.array(ROOTS) ** 4 * modulus * WIDTH**2 / (12 * DENSITY * LENGTH**4)

        def rate(t, y):
            p, v = y[:4], y[4:]
            climb = (command(t + 1e-6) - command(t - 1e-6)) / 2e-6
            pull = squares * (p - shares * command(t) + viscous * (v - shares * climb))
            return np.concatenate([v, -pull - BRAKING * v - shares * gravity])

        first = np.concatenate([shares * command(0), np.zeros(4)])
        found = solve_ivp(rate, (0, times[-1] + 1e-9), first, method="LSODA", t_eval=times, rtol=1e-7, atol=1e-10, max_step=5e-3)
        height = np.array([command(t) for t in times])
        columns = []
        for at in (1.0, 0.5):
            shape = np.array([mode(root, at) for root in ROOTS])
            z = height + shape @ (found.y[:4] - shares[:, None] * height)
            x = at * LENGTH
            columns += [np.full(len(times), x), np.full(len(times), bent["curvature_1"] * x * x / 2), z + bent["curvature_2"] * x * x / 2]
        return np.column_stack(columns)


def beam_experiments():
    return {
        "beam": Experiment(
            "beam", Beam(), BEAM,
            [((), 0.8, steps([0, 0], 1), "fit"), ((), 0.8, steps([0, 0.03, -0.01], 0.3), "fit"), ((), 0.8, chirp(0.01, 1, 5, 0.8), "held_out")],
            COLUMNS, markers("bar", LENGTH / 2, 0, 3e-4), 3e-4, "bar", "bar", ["driven", "free"],
            ("body/hand/position", ["hand_x", "hand_y", "hand_z"], 2)),
    }


BENT = Cases(
    singles=[
        ("beam", "rest_shape_error", None, {"curvature_1": 0.3, "curvature_2": -0.5}, []),
        ("beam", "kelvin_voigt_damping", None, {"viscosity": 1000.0}, []),
    ],
    retunes=[("beam", "retune_youngs_modulus", None, {"value": 5e5}, MODULUS, ["retune_density"])],
    off_library=[],
    pairs=[],
)
