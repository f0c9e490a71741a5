"""Bodies that spin, slide and roll, as ordinary differential equations written apart from the simulator. See models.py; SI
units, radians, z up. What turns is seen as a rotation vector, of which `table` makes quaternions.
"""
import math

import numpy as np

from models import G, integrate, sign


def product(p, q):
    """Of quaternions x, y, z, w [n, 4]."""
    v = p[:, 3:] * q[:, :3] + q[:, 3:] * p[:, :3] + np.cross(p[:, :3], q[:, :3])
    return np.column_stack([v, p[:, 3] * q[:, 3] - (p[:, :3] * q[:, :3]).sum(axis=1)])


def quaternion(turn):
    """Of rotation vectors [n, 3]."""
    half = np.linalg.norm(turn, axis=1)[:, None] / 2
    return np.column_stack([turn / 2 * np.sinc(half / math.pi), np.cos(half)])


class Whirl:
    """A ball of 0.2 kg and radius 0.05 m that flies and spins; start: position, velocity, spin. Its spin falls as
    I omega' = -c omega, so that it turns by omega I / c (1 - exp(-c t / I)). A centre of mass at p of its frame flies, and the
    frame's origin, which is seen, goes round it."""

    mass, radius = 0.2, 0.05

    def see(self, start, times, effects, command=None):
        x, v, spin = np.reshape(start, (3, 3))
        inertia = 0.4 * self.mass * self.radius**2
        quadratic = effects.get("quadratic_drag", {}).get("drag", 0)
        braking = effects.get("spin_drag", {}).get("drag", 0) / inertia
        offset = effects.get("center_of_mass_offset", {"x": 0, "y": 0, "z": 0})
        offset = np.array([offset["x"], offset["y"], offset["z"]])
        turn = np.outer(-np.expm1(-braking * times) / braking if braking > 0 else times, spin)
        q = quaternion(turn)
        still = np.column_stack([np.tile(offset, (len(q), 1)), np.zeros(len(q))])
        carried = product(product(q, still), q * [-1, -1, -1, 1])[:, :3]  # the offset in the world

        def rate(t, y):
            w = y[3:]
            drag = quadratic * math.hypot(*w) / self.mass
            return (*w, -drag * w[0], -drag * w[1], -G - drag * w[2])

        centre = integrate(rate, [*(x + offset), *(v + np.cross(spin, offset))], times)[:, :3]
        return np.column_stack([centre - carried, turn])

    def table(self, seen, noise):
        """Place and quaternion x, y, z, w of a recording; the noise of a turn is a small one."""
        return np.column_stack([seen[:, :3] + noise[:, :3], product(quaternion(noise[:, 3:]), quaternion(seen[:, 3:]))])


class Wheel:
    """A wheel of 0.2 kg and radius r = 0.05 m that is set on a floor without spin, slides and then rolls; start: place along x,
    which is seen, and velocity. Rolling resistance: T = arm m g. With I = m r^2 / 2, of what brakes the body (f) and its spin (T):
      sliding   m v' = -mu m g - f,  I w' = mu m g r - T,        rolling   (m + I / r^2) v' = -f - T / r."""

    mass, radius, friction = 0.2, 0.05, 0.3

    def see(self, start, times, effects, command=None):
        r, mass = self.radius, self.mass
        inertia = 0.5 * mass * r * r
        mu = effects.get("retune_friction", {}).get("value", self.friction)
        arm = effects.get("rolling_resistance", {}).get("arm", 0)
        quadratic = effects.get("quadratic_drag", {}).get("drag", 0)
        felt = effects.get("felt", {}).get("arm", 0)  # a strip of it, from 0.1 to 0.2 m on both sides of the origin
        rolls = False

        def rate(t, y):
            x, v, w = y
            f = quadratic * abs(v) * v
            torque = (arm + felt * math.exp(-(((abs(x) - 0.15) / 0.05) ** 4))) * mass * G * sign(w, 5e-3)
            if rolls:
                a = -(f + torque / r) / (mass + inertia / (r * r))
                return v, a, a / r
            push = math.copysign(mu * mass * G, v - r * w)
            return v, -(f + push) / mass, (push * r - torque) / inertia

        y, slip, t, seen = [*start, 0.0], start[1], 0.0, []
        for until in times:
            while t < until - 1e-12:
                h = min(5e-4, until - t)
                after = integrate(rate, y, [h])[0]
                now = after[1] - r * after[2]
                if not rolls and now * slip <= 0:  # it grips within this step, where the slip is none
                    h *= slip / (slip - now)
                    after = integrate(rate, y, [h])[0]
                    after[2], rolls = after[1] / r, True
                y, slip, t = list(after), now, t + h
            seen.append(y[:1])
        return np.array(seen)
