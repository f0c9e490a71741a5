"""Soft experiments as ordinary differential equations of one dimension, written apart from the simulator: a weight on an
elastic bar, a cloth that hangs from a hand. Each model returns what a perfect sensor would see. SI units, radians, z up.
"""
from collections import namedtuple

import numpy as np
from scipy.integrate import solve_ivp

G = 9.81
Resolution = namedtuple("Resolution", "pieces smooth_rate tolerance links")  # of the bar; hysteresis' sign [1/s]; relative; of the cloth
FINE, COARSE = Resolution(12, 5e-4, 1e-6, 24), Resolution(4, 2e-2, 1e-4, 12)
resolution = FINE
SMOOTH_SPEED = 5e-4  # of the guide's [m/s]
FLOW_TIME = 1e-4  # in which strain beyond the yield limit flows away [s]
CHAIN_STEP = 1e-3  # of the classical Runge-Kutta method [s]


class TooStrong(Exception):
    """No motion solves the equations with effects as strong as these."""


class Bar:
    """A bar of 0.1 m that stretches along z alone, one end on a hand, a guided weight at the other, above (side 1) or below
    (-1) it. It starts unstrained and at rest; the hand follows its command. Seen: heights of its end and of its middle.

    Of a piece with stretch a along the bar and b across it the stable neo-Hookean energy is stationary in b where
      J - 1 = a b^2 - 1 = (a - 1) mu / (a l),  l = lambda + mu,   and its force per rest area is   P = mu (a - b^2 / a).
    What flows keeps a share of the stretch, a = a_elastic a_plastic, and acts with P(a_elastic) / a_plastic.
    """

    length, density, modulus = 0.1, 1000.0, 1e5  # and no lateral contraction

    def __init__(self, side, width, weight):
        self.side, self.section, self.weight = side, width**2, weight

    def see(self, start, times, effects, command):
        value = lambda name, otherwise: effects.get(name, {}).get("value", otherwise)
        mu = stiffened = value("retune_youngs_modulus", self.modulus) / 2
        density = value("retune_density", self.density)
        weight = value("retune_mass", self.weight) + effects.get("payload_mass", {}).get("mass", 0)
        gravity = value("retune_gravity", G)
        viscosity = effects.get("kelvin_voigt_damping", {}).get("viscosity", 0)
        braking = effects.get("mass_proportional_damping", {}).get("rate", 0)
        loss = effects.get("hysteretic_damping", {}).get("loss", 0)
        stiffening = effects.get("strain_stiffening", {}).get("stiffening", 0)
        limit = effects.get("plastic_yield", {}).get("yield_strain", 0)
        creep = effects.get("creep", {}).get("rate", 0)
        drag = effects.get("quadratic_drag", {}).get("drag", 0)  # of the weight
        viscous = effects.get("joint_viscous_friction", {}).get("damping", 0)  # of the guide
        dry = effects.get("joint_coulomb_friction", {}).get("effort", 0)
        magnet = effects.get("magnet", {}).get("strength", 0)  # draws the weight down where it hangs or lies

        n, side = resolution.pieces, self.side
        piece = self.length / n
        mass = np.full(n, density * self.section * piece)
        mass[-1] /= 2
        braked = mass * braking
        loads = -mass * gravity
        mass[-1] += weight
        loads[-1] -= weight * gravity

        # of each piece: its far end's displacement and velocity, upward, and the logarithm of its plastic stretch
        def rate(t, state):
            place, speed, plastic = state.reshape(n, 3).T
            hand_speed = (command(t + 1e-6) - command(t - 1e-6)) / 2e-6
            whole = 1 + side * np.diff(place, prepend=command(t)) / piece
            whole_rate = side * np.diff(speed, prepend=hand_speed) / piece
            flowed = np.exp(plastic)
            a = whole / flowed
            across = (1 + (a - 1) * mu / (a * stiffened)) / a  # b^2
            stress = mu * (a - across / a) / flowed
            strain, strain_rate = (whole**2 - 1) / 2, whole * whole_rate
            stress += whole * 2 * viscosity * strain_rate
            stress += whole * 2 * mu * loss * np.abs(strain) * strain_rate / np.sqrt(strain_rate**2 + resolution.smooth_rate**2)
            stress += whole * 4 * mu * stiffening * strain**3
            pull = side * stress * self.section  # of each piece on its nearer end, upward
            deviator = (np.log(a) - np.log(across) / 2) * 2 / 3
            flow = creep * deviator
            if limit > 0:
                excess = np.maximum(np.abs(deviator) - limit / np.sqrt(1.5), 0)
                flow = flow + np.sign(deviator) * excess / FLOW_TIME
            total = loads - pull - braked * speed
            total[:-1] += pull[1:]
            v = speed[-1]
            total[-1] -= (viscous + drag * abs(v)) * v + dry * v / np.sqrt(v * v + SMOOTH_SPEED**2)
            total[-1] -= magnet * np.exp(-(((place[-1] + 0.01) / 0.005) ** 2))
            return np.column_stack([speed, total / mass, flow]).ravel()

        found = solve_ivp(rate, (0, times[-1] + 1e-9), np.tile([command(0), 0, 0], n), method="LSODA", t_eval=times, lband=5, uband=5,
                          rtol=resolution.tolerance, atol=resolution.tolerance / 100, max_step=0.01)
        if not found.success:
            raise TooStrong("the bar gave way at " + str(found.t[-1]) + " s")
        ends = found.y.reshape(n, 3, -1)[:, 0]
        zero = np.zeros(len(times))
        return np.column_stack([zero, zero, side * self.length + ends[-1], zero, zero, side * self.length / 2 + ends[n // 2 - 1]])


class Swing:
    """A strip of cloth, 0.3 x 0.04 m and 0.3 kg/m^2, that hangs by its upper edge from a hand moving along x: a chain of
    links that do not stretch and resist bending, with the angles from the vertical as unknowns. It starts straight and at rest.
    Seen: its lower edge's and its middle's places."""

    length, mass, rigidity = 0.3, 0.3 * 0.3 * 0.04, 1.5e-5 * 0.04

    def see(self, start, times, effects, command):
        n = resolution.links
        link = self.length / n
        gravity = effects.get("retune_gravity", {}).get("value", G)
        tilt = effects.get("gravity_tilt", {}).get("about_y", 0)
        force = effects.get("constant_force", {"x": 0, "z": 0})
        linear = effects.get("linear_drag", {}).get("drag", 0) + self.mass * effects.get("mass_proportional_damping", {}).get("rate", 0)
        quadratic = effects.get("quadratic_drag", {}).get("drag", 0)
        fan = effects.get("fan", {}).get("strength", 0)  # blows on what is 0.2 to 0.3 m below the hand's height
        share = np.full(n, 1 / n)  # of the whole, at the links' lower ends
        share[-1] /= 2
        hung = np.cumsum(share[::-1])[::-1] * self.mass  # below the upper end of each link
        both = link**2 * np.minimum.outer(hung, hung)
        steady = np.array([-self.mass * gravity * np.sin(tilt) + force["x"], -self.mass * gravity * np.cos(tilt) + force["z"]])

        def matrix(angle):
            return both * np.cos(np.subtract.outer(angle, angle))

        def rate(state, hand_speed):
            angle, spin = state
            c, s = np.cos(angle), np.sin(angle)
            vx, vz = hand_speed + link * np.cumsum(c * spin), link * np.cumsum(s * spin)
            braking = linear + quadratic * np.hypot(vx, vz)
            depth = link * np.cumsum(c)
            fx = share * (steady[0] - braking * vx + fan * np.exp(-(((depth - 0.25) / 0.03) ** 2)))
            fz = share * (steady[1] - braking * vz)
            effort = link * (c * np.cumsum(fx[::-1])[::-1] + s * np.cumsum(fz[::-1])[::-1])
            effort -= (both * np.sin(np.subtract.outer(angle, angle))) @ spin**2
            bent = np.diff(angle) * self.rigidity / link
            effort[:-1] += bent
            effort[1:] -= bent
            return np.array([spin, np.linalg.solve(matrix(angle), effort)])

        state, t, hand_speed, seen = np.zeros((2, n)), 0.0, 0.0, []
        corners = np.arange(0, times[-1] + 0.01, 0.01)  # where the hand's speed jumps, as between lines
        for until in np.unique(np.concatenate([times, corners])):
            speed = (command(t + 2e-6) - command(t + 1e-6)) / 1e-6 if until > t else hand_speed
            if abs(speed - hand_speed) > 1e-9:
                jump = -link * hung * np.cos(state[0]) * (speed - hand_speed)
                state[1] += np.linalg.solve(matrix(state[0]), jump)
                hand_speed = speed
            while t < until - 1e-12:
                h = min(CHAIN_STEP, until - t)
                a = rate(state, hand_speed)
                b = rate(state + h / 2 * a, hand_speed)
                c = rate(state + h / 2 * b, hand_speed)
                d = rate(state + h * c, hand_speed)
                state = state + h / 6 * (a + 2 * b + 2 * c + d)
                t += h
            t = until
            x, z = command(t) + link * np.cumsum(np.sin(state[0])), -link * np.cumsum(np.cos(state[0]))
            seen.append((t, x[-1], 0, z[-1], x[n // 2 - 1], 0, z[n // 2 - 1]))
        seen = {row[0]: row[1:] for row in seen}
        return np.array([seen[time] for time in times])
