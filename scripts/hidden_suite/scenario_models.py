"""Independent models of new_scenarios.py, solved by LSODA: a pendulum and a double pendulum of bars, a joint on a drive, a
mass on a spring, a flywheel, a sliding block, a body in flight. `numbers` are those of nature, `effects` {name: parameters}
what the scene does not have. SI units, radians, z up; a turn by q about y takes what hangs to -x.
"""
import math

import numpy as np
from scipy.integrate import odeint

G = 9.81
STICKING = 1e-4  # rate over which dry friction turns its sign [rad/s, m/s]


def solve(rate, start, times, accuracy=1e-9):
    """States [n_times, n] at ascending times >= 0, of d state / dt = rate(t, state), from `start` at time 0."""
    grid = np.concatenate([[0.0], np.maximum(times, 0) + 1e-12 * np.arange(1, len(times) + 1)])
    return odeint(rate, start, grid, tfirst=True, rtol=accuracy, atol=accuracy, hmax=0.02, mxstep=100000)[1:]


def direction(v):
    return v / math.sqrt(v * v + STICKING * STICKING)


def joint_effort(effects, joint, q, w):
    """What acts at a joint beside weight and drive: its friction and a spring [N m, N]. Effects are those at this joint."""
    effort = 0.0
    for (name, target), p in effects.items():
        if target != joint:
            continue
        if name == "joint_viscous_friction":
            effort -= p["damping"] * w
        elif name == "joint_coulomb_friction":
            effort -= p["effort"] * direction(w)
        elif name == "joint_stribeck_friction":
            effort -= (p["effort"] + p["extra"] * math.exp(-((w / p["stribeck_velocity"]) ** 2))) * direction(w)
        elif name == "joint_spring":
            effort += p["preload"] - p["stiffness"] * q
        elif name == "unknown_ripple":
            effort += p["strength"] * math.sin(p["waves"] * q)
        elif name == "unknown_magnet":
            effort -= p["strength"] * math.sin(3 * q) * math.exp(-((q / p["width"]) ** 2))
        elif name == "unknown_bumper":
            effort -= p["stiffness"] * max(q - p["at"], 0.0)
        elif name == "unknown_cubic":
            effort -= p["stiffness"] * q**3
    return effort


def of(effects, name, key, usual=0.0):
    """A parameter of an effect of which there is one place only."""
    return next((p.get(key, usual) for (effect, _), p in effects.items() if effect == name), usual)


class Pendulum:
    """A bar [m] that hangs from one end; states: angle, rate."""

    def solve(self, numbers, effects, start, times, command=None):
        m, length, width = numbers["mass"], numbers["length"], numbers["width"]
        arm = length / 2 - of(effects, "center_of_mass_offset", "z")
        aside = of(effects, "center_of_mass_offset", "x")
        added = of(effects, "payload_mass", "mass")
        inertia = m * ((length**2 + width**2) / 12 + arm**2 + aside**2) + added * (arm**2 + aside**2)
        tilt, g = of(effects, "gravity_tilt", "about_y"), numbers["gravity"]
        linear, quadratic = of(effects, "linear_drag", "drag"), of(effects, "quadratic_drag", "drag")

        def rate(t, y):
            q, w = y
            torque = -(m + added) * g * (arm * math.sin(q - tilt) + aside * math.cos(q - tilt))
            torque += joint_effort(effects, "hinge", q, w) - numbers["damping"] * w
            torque -= (linear * arm**2 + quadratic * arm**3 * abs(w)) * w
            return w, torque / inertia

        return solve(rate, start, times)


class DoublePendulum:
    """Two bars, the second hangs from the end of the first; states: both joints' angles, both rates."""

    def solve(self, numbers, effects, start, times, command=None):
        m1, m2, l1, l2, width = (numbers[key] for key in ("mass_1", "mass_2", "length_1", "length_2", "width"))
        a1, a2, g = l1 / 2, l2 / 2, numbers["gravity"]
        i1, i2 = m1 * ((l1**2 + width**2) / 12 + a1**2), m2 * ((l2**2 + width**2) / 12 + a2**2)
        added = of(effects, "payload_mass", "mass")
        i2 += added * a2**2
        m2a2, m2 = (m2 + added) * a2, m2 + added

        def rate(t, y):
            q1, q2, w1, w2 = y
            first, second = q1, q1 + q2  # against the vertical
            u1, u2 = w1, w1 + w2
            t1, t2 = joint_effort(effects, "shoulder", q1, w1), joint_effort(effects, "elbow", q2, w2)
            c, s = math.cos(first - second), math.sin(first - second)
            a, b, d = i1 + m2 * l1**2, m2a2 * l1 * c, i2
            p = t1 - t2 - m2a2 * l1 * s * u2**2 - (m1 * a1 + m2 * l1) * g * math.sin(first)
            q = t2 + m2a2 * l1 * s * u1**2 - m2a2 * g * math.sin(second)
            det = a * d - b * b
            v1, v2 = (d * p - b * q) / det, (a * q - b * p) / det
            return w1, w2, v1, v2 - v1

        return solve(rate, start, times)


class Driven:
    """A bar on a drive, about the vertical (`weight` 0) or hanging (1), or a carriage on a rail; states: coordinate, rate,
    lagged command. Drives act as stiffness (target - q) + damping (target' - q')."""

    def __init__(self, joint, weight):
        self.joint, self.weight = joint, weight

    def solve(self, numbers, effects, start, times, command):
        m, added = numbers["mass"], of(effects, "payload_mass", "mass")
        if "length" in numbers:
            arm = numbers["length"] / 2
            inertia = m * ((numbers["length"] ** 2 + numbers["width"] ** 2) / 12 + arm**2) + added * arm**2
        else:
            arm, inertia = 1.0, m + added
        stiffness, damping = numbers["stiffness"], numbers["damping"]
        play, gain = of(effects, "backlash", "play"), of(effects, "actuator_gain", "gain", 1.0)
        lag, delay = of(effects, "actuator_lag", "time_constant"), of(effects, "actuator_delay", "delay")
        linear = of(effects, "linear_drag", "drag")
        weight = self.weight * (m + added) * numbers["gravity"] * arm

        def rate(t, y):
            q, w, c = y
            wanted, change = command(t - delay)
            follow = 0.0
            if lag > 0:
                follow = (wanted - c) / lag
                wanted, change = c, follow
            error = wanted - q
            error -= min(max(error, -play / 2), play / 2)
            effort = gain * (stiffness * error + damping * (change - w)) - weight * math.sin(q)
            effort += joint_effort(effects, self.joint, q, w) - linear * arm**2 * w
            return w, effort / inertia, follow

        return solve(rate, [*start, command(-delay)[0]], times, 1e-8)


class Hung:
    """A mass on a spring, which guides it along the vertical; states: height above the spring's rest, rate."""

    def solve(self, numbers, effects, start, times, command=None):
        m = numbers["mass"] + of(effects, "payload_mass", "mass")
        linear, quadratic = of(effects, "linear_drag", "drag"), of(effects, "quadratic_drag", "drag")

        def rate(t, y):
            s, v = y
            force = -numbers["stiffness"] * s - numbers["damping"] * v - m * numbers["gravity"]
            force += joint_effort(effects, "guide", s, v) - (linear + quadratic * abs(v)) * v
            return v, force / m

        return solve(rate, start, times)


class Flywheel:
    """A square plate on a spindle that a known torque turns; states: angle, rate."""

    def solve(self, numbers, effects, start, times, command):
        inertia = numbers["mass"] * numbers["side"] ** 2 / 6

        def rate(t, y):
            return y[1], (command(t)[0] + joint_effort(effects, "spindle", y[0], y[1]) - numbers["damping"] * y[1]) / inertia

        return solve(rate, start, times, 1e-8)


class Slide:
    """A block that slides on a plane, in the plane's frame; `gravity_vector` is that of the run. States: x, y, velocity."""

    def solve(self, numbers, effects, start, times, command=None):
        m, mu = numbers["mass"], numbers["friction"]
        g = tilted(numbers["gravity_vector"], effects)
        change, velocity = of(effects, "velocity_dependent_friction", "change"), of(effects, "velocity_dependent_friction", "velocity", 1)
        across, quadratic = of(effects, "anisotropic_friction", "change"), of(effects, "quadratic_drag", "drag")
        ripple = of(effects, "unknown_strip", "extra")

        def rate(t, y):
            vx, vy = y[2], y[3]
            speed = math.hypot(vx, vy)
            dx, dy = vx / math.sqrt(speed**2 + 1e-8), vy / math.sqrt(speed**2 + 1e-8)
            k = mu * (1 + change * (1 - math.exp(-speed / velocity))) * math.sqrt(dx**2 + ((1 + across) * dy) ** 2 if speed > 1e-6 else 1)
            k += ripple * math.exp(-(((math.hypot(y[0], y[1]) - 0.12) / 0.03) ** 2))
            return vx, vy, g[0] + k * g[2] * dx - quadratic * speed * vx / m, g[1] + k * g[2] * dy - quadratic * speed * vy / m

        return solve(rate, start, times, 1e-8)


class Flight:
    """A ball in the air; states: place, velocity."""

    def solve(self, numbers, effects, start, times, command=None):
        m, g = numbers["mass"], tilted([0, 0, -numbers["gravity"]], effects)
        linear, quadratic = of(effects, "linear_drag", "drag"), of(effects, "quadratic_drag", "drag")
        force = [of(effects, "constant_force", key) for key in "xyz"]
        lift, swirl = of(effects, "unknown_magnus", "lift"), of(effects, "unknown_vortex", "strength")
        tether, reach = of(effects, "unknown_tether", "stiffness"), of(effects, "unknown_tether", "length", 1)

        def rate(t, y):
            x, v = y[:3], y[3:]
            drag = linear + quadratic * math.hypot(*v)
            turn = swirl / (0.1 + x[0] ** 2 + x[1] ** 2)
            far = math.hypot(*x)
            pull = tether * max(far - reach, 0) / max(far, 1e-9)
            aside = (-x[1] * turn + lift * v[2], x[0] * turn, -lift * v[0])
            return [*v, *(g[k] + (force[k] - drag * v[k] + aside[k] - pull * x[k]) / m for k in range(3))]

        return solve(rate, start, times)


def tilted(g, effects):
    """Gravity turned about x, then about y."""
    ax, ay = of(effects, "gravity_tilt", "about_x"), of(effects, "gravity_tilt", "about_y")
    x, y, z = g
    y, z = y * math.cos(ax) - z * math.sin(ax), y * math.sin(ax) + z * math.cos(ax)
    x, z = x * math.cos(ay) + z * math.sin(ay), -x * math.sin(ay) + z * math.cos(ay)
    return x, y, z
