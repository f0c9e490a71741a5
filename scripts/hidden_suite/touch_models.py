"""A plate on a soft floor as one ordinary differential equation, written apart from the simulator. See models.py; SI units."""
import math

import numpy as np
from scipy.integrate import solve_ivp

from models import G, joint_friction


class Plate:
    """A plate of 0.1 x 0.1 x 0.01 m and 0.4 kg that a guide along z leads above a floor; start: its coordinate, the gap being
    `rest_gap` at zero, and its speed. A command is where a spring with a damper draws it. With the gap g, d the activation distance and
    u = g' the force of the floor is
      N = kappa A |b'(g)| (1 - chi u),  b(g) = -(g - d)^2 ln(g / d) / d  for g < d        (Li et al. 2020; Hunt and Crossley 1975)
    or, where both stick together with the energy gamma per area, the same with d / 2 instead of d and
      N - gamma A 6 s (1 - s) / d,  s = g / d < 1.
    A: corners stand for shares of the whole surface, those that touch for half of it."""

    mass, area = 0.4, 0.012

    def __init__(self, distance, stiffness, rest_gap, spring=0.0, damping=0.0):
        self.distance, self.stiffness, self.rest_gap = distance, stiffness, rest_gap
        self.spring, self.damping = spring, damping

    def see(self, start, times, effects, command=None):
        value = lambda name, otherwise: effects.get(name, {}).get("value", otherwise)
        mass = value("retune_mass", self.mass) + effects.get("payload_mass", {}).get("mass", 0)
        gravity, stiffness = value("retune_gravity", G), value("retune_contact_stiffness", self.stiffness)
        dissipation = effects.get("contact_dissipation", {}).get("dissipation", 0)
        energy = effects.get("adhesion", {}).get("energy", 0)
        quadratic = effects.get("quadratic_drag", {}).get("drag", 0)
        tether = effects.get("tether", {}).get("stiffness", 0)  # is taut from 40 mm on
        d = self.distance
        reach = d / 2 if energy > 0 else d

        def rate(t, y):
            q, v = y
            g = q + self.rest_gap
            force = -mass * gravity - quadratic * abs(v) * v + joint_friction(effects, v)
            force -= tether * max(q - 0.04, 0.0)
            if 0 < g < reach:
                slope = (g - reach) * (2 * math.log(g / reach) + (g - reach) / g) / reach
                force += stiffness * self.area * slope * (1 - dissipation * v)
            if 0 < g < d:
                force -= energy * self.area * 6 * (g / d) * (1 - g / d) / d
            if command:
                climb = (command(t + 1e-5) - command(t - 1e-5)) / 2e-5
                force += self.spring * (command(t) - q) + self.damping * (climb - v)
            return v, force / mass

        found = solve_ivp(rate, (0, times[-1] + 1e-9), start or (0.0, 0.0), method="LSODA", t_eval=times, rtol=1e-8, atol=1e-10, max_step=2e-3)
        return found.y[:1].T
