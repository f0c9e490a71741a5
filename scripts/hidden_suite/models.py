"""Experiments as ordinary differential equations, written apart from the simulator: a pendulum, a body in flight, a
sliding block, a driven joint. Each model takes a mapping of effects {name: parameters} and returns what a perfect sensor
would see at the given times. SI units, radians, z up.
"""
import math

import numpy as np

G = 9.81
STEP = 5e-4  # of the classical Runge-Kutta method [s]


def integrate(rate, state, times):
    """State [n_times, n] of d state / dt = rate(t, state), from `state` at time 0; times ascend from 0 on."""
    states, t, y = [], 0.0, [float(value) for value in state]

    def moved(by, slope):
        return [value + by * s for value, s in zip(y, slope)]

    for until in times:
        while t < until - 1e-12:
            h = min(STEP, until - t)
            a = rate(t, y)
            b = rate(t + h / 2, moved(h / 2, a))
            c = rate(t + h / 2, moved(h / 2, b))
            d = rate(t + h, moved(h, c))
            y = moved(h / 6, [p + 2 * q + 2 * r + s for p, q, r, s in zip(a, b, c, d)])
            t += h
        states.append(y)
    return np.array(states)


def sign(v, width):
    """The direction of v, smooth within `width` of zero."""
    return v / math.sqrt(v * v + width * width)


def joint_friction(effects, rate):
    """Effort of a joint's own friction at this rate [N m]."""
    effort = 0.0
    if "joint_viscous_friction" in effects:
        effort -= effects["joint_viscous_friction"]["damping"] * rate
    if "joint_coulomb_friction" in effects:
        effort -= effects["joint_coulomb_friction"]["effort"] * sign(rate, 5e-4)
    if "joint_stribeck_friction" in effects:
        p = effects["joint_stribeck_friction"]
        effort -= (p["effort"] + p["extra"] * math.exp(-((rate / p["stribeck_velocity"]) ** 2))) * sign(rate, 5e-4)
    return effort


class Pendulum:
    """A cube of side 0.1 m and 1 kg whose centre hangs 0.2 m below a hinge about y; state: angle, rate. A command is a torque
    at the hinge."""

    mass, side, arm = 1.0, 0.1, 0.2

    def see(self, start, times, effects, command=None):
        mass = effects.get("retune_mass", {}).get("value", self.mass)
        offset = effects.get("center_of_mass_offset", {"x": 0, "y": 0, "z": 0})
        gravity = effects.get("retune_gravity", {}).get("value", G)
        tilt = effects.get("gravity_tilt", {"about_y": 0})["about_y"]
        centre = np.array([offset["x"], -self.arm + offset["z"]])  # x, z at angle 0
        centre = [float(value) for value in centre]
        inertia = mass * (self.side**2 / 6 + centre[0] ** 2 + centre[1] ** 2)
        spring = effects.get("joint_spring", {"stiffness": 0, "preload": 0})
        drag = effects.get("quadratic_drag", {}).get("drag", 0)
        linear = effects.get("linear_drag", {}).get("drag", 0)
        magnet = effects.get("magnet", {}).get("strength", 0)

        def rate(t, y):
            q, w = y
            # a turn by q about y takes (x, z) to (x cos q + z sin q, -x sin q + z cos q); torque about y: z fx - x fz
            x = centre[0] * math.cos(q) + centre[1] * math.sin(q)
            z = -centre[0] * math.sin(q) + centre[1] * math.cos(q)
            # the weight turned by `tilt` about y, as a vector
            fx, fz = -mass * gravity * math.sin(tilt), -mass * gravity * math.cos(tilt)
            torque = z * fx - x * fz
            torque += joint_friction(effects, w) + spring["preload"] - spring["stiffness"] * q
            torque -= (drag * self.arm**3 * abs(w) + linear * self.arm**2) * w
            torque -= magnet * math.sin(3 * q) * math.exp(-((q / 0.25) ** 2))
            if command:
                torque += command(t)
            return w, torque / inertia

        return integrate(rate, start, times)[:, :1]


class Flight:
    """A ball of 0.2 kg and radius 0.05 m; state: position, velocity."""

    mass = 0.2

    def see(self, start, times, effects, command=None):
        gravity = effects.get("retune_gravity", {}).get("value", G)
        tilt = effects.get("gravity_tilt", {"about_x": 0, "about_y": 0})
        ax, ay = tilt["about_x"], tilt["about_y"]
        rx = np.array([[1, 0, 0], [0, np.cos(ax), -np.sin(ax)], [0, np.sin(ax), np.cos(ax)]])
        ry = np.array([[np.cos(ay), 0, np.sin(ay)], [0, 1, 0], [-np.sin(ay), 0, np.cos(ay)]])
        g = [float(value) for value in ry @ rx @ np.array([0, 0, -gravity])]
        force = effects.get("constant_force", {"x": 0, "y": 0, "z": 0})
        force = (force["x"], force["y"], force["z"])
        linear = effects.get("linear_drag", {}).get("drag", 0)
        quadratic = effects.get("quadratic_drag", {}).get("drag", 0)
        swirl = effects.get("vortex", {}).get("strength", 0)
        tether = effects.get("tether", {"stiffness": 0, "length": 1})
        lift = effects.get("magnus", {}).get("lift", 0)  # of a spin about y that lasts: lift spin x v

        def rate(t, y):
            x, v = y[:3], y[3:]
            drag = linear + quadratic * math.hypot(*v)
            turn = swirl / (0.1 + x[0] ** 2 + x[1] ** 2)
            reach = math.hypot(*x)
            pull = tether["stiffness"] * max(reach - tether["length"], 0) / max(reach, 1e-9)
            spin = (-x[1] * turn + lift * v[2], x[0] * turn, -lift * v[0])
            return (*v, *(g[k] + (force[k] - drag * v[k] + spin[k] - pull * x[k]) / self.mass for k in range(3)))

        return integrate(rate, start, times)[:, :3]


class Slide:
    """A block of 0.1 x 0.1 x 0.04 m and 0.4 kg that slides on the floor; state: x, y, velocity."""

    mass, friction, height = 0.4, 0.3, 0.02

    def see(self, start, times, effects, command=None):
        mu = effects.get("retune_friction", {}).get("value", self.friction)
        dependent = effects.get("velocity_dependent_friction", {"change": 0, "velocity": 0.1})
        across = effects.get("anisotropic_friction", {}).get("change", 0)
        linear = effects.get("linear_drag", {}).get("drag", 0)
        quadratic = effects.get("quadratic_drag", {}).get("drag", 0)
        tilt = effects.get("gravity_tilt", {"about_x": 0, "about_y": 0})
        force = effects.get("constant_force", {"x": 0, "y": 0, "z": 0})
        normal = self.mass * G * np.cos(tilt["about_x"]) * np.cos(tilt["about_y"]) - force["z"]
        push = np.array([-np.cos(tilt["about_x"]) * np.sin(tilt["about_y"]), np.sin(tilt["about_x"])]) * self.mass * G
        push = [float(push[0] + force["x"]), float(push[1] + force["y"])]
        ripple = effects.get("rough_strip", {}).get("extra", 0)

        def rate(t, y):
            v = y[2:]
            speed = math.hypot(*v)
            d = [part / math.sqrt(speed**2 + 1e-8) for part in v]
            m = mu * (1 + dependent["change"] * (1 - math.exp(-speed / dependent["velocity"])))
            m *= math.sqrt(d[0] ** 2 + (1 + across) ** 2 * d[1] ** 2) if speed > 1e-6 else 1
            m += ripple * math.exp(-(((math.hypot(y[0], y[1]) - 0.12) / 0.03) ** 2))
            drag = linear + quadratic * speed
            return (*v, *((push[k] - m * normal * d[k] - drag * v[k]) / self.mass for k in range(2)))

        seen = integrate(rate, start, times)[:, :2]
        return np.column_stack([seen, np.full(len(seen), self.height)])


class DrivenJoint:
    """The pendulum's cube at 0.15 m on a drive of 20 N m/rad and 0.6 N m s/rad about a vertical axis; no weight acts.
    State: angle, rate, lagged command."""

    mass, side, arm, stiffness, damping = 1.0, 0.1, 0.15, 20.0, 0.6

    def see(self, start, times, effects, command=None):
        mass = effects.get("retune_mass", {}).get("value", self.mass)
        inertia = mass * (self.side**2 / 6 + self.arm**2)
        inertia += effects.get("payload_mass", {}).get("mass", 0) * self.arm**2
        if "payload_mass" in effects:
            inertia += effects["payload_mass"]["mass"] * self.side**2 / 6 * 0
        stiffness = effects.get("retune_drive_stiffness", {}).get("value", self.stiffness)
        damping = effects.get("retune_drive_damping", {}).get("value", self.damping)
        play = effects.get("backlash", {}).get("play", 0)
        gain = effects.get("actuator_gain", {}).get("gain", 1)
        lag = effects.get("actuator_lag", {}).get("time_constant", 0)
        delay = effects.get("actuator_delay", {}).get("delay", 0)
        spring = effects.get("joint_spring", {"stiffness": 0, "preload": 0})
        ripple = effects.get("cogging", {}).get("strength", 0)
        bumper = effects.get("bumper", {}).get("stiffness", 0)  # of rubber that the arm meets at 0.3 rad
        linear = effects.get("linear_drag", {}).get("drag", 0)

        def rate(t, y):
            q, w, c = y
            wanted = command(t - delay)
            change = (command(t - delay + 1e-4) - command(t - delay - 1e-4)) / 2e-4
            if lag > 0:
                follow = (wanted - c) / lag
                wanted, change = c, follow
            else:
                follow = 0.0
            error = wanted - q
            error -= min(max(error, -play / 2), play / 2)
            effort = gain * (stiffness * error + damping * (change - w))
            effort += joint_friction(effects, w) + spring["preload"] - spring["stiffness"] * q
            effort += ripple * math.sin(24 * q) - linear * self.arm**2 * w - bumper * max(q - 0.3, 0.0)
            return w, effort / inertia, follow

        return integrate(rate, [start[0], start[1], command(-delay)], times)[:, :1]
