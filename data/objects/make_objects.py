#!/usr/bin/env python3
"""Writes the objects of the tasks: a 250 ml beaker, a laboratory scale, a table. Lengths in metres, z up, origin at the foot."""
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, ".."))
import asset_tools as tools  # noqa: E402

RADIUS, HEIGHT, WALL, FLOOR = 0.034, 0.095, 0.0016, 0.002
GLASS_DENSITY = 2230.0  # borosilicate [kg/m^3]
PAN_TOP = 0.050         # of the scale


def arc(centre, radius, first, last, steps):
    """Points (radius, z) of an arc, angles in degrees from the +r axis."""
    angles = np.radians(np.linspace(first, last, steps + 1))
    return [(centre[0] + radius * np.cos(a), centre[1] + radius * np.sin(a)) for a in angles]


def beaker():
    """Low-poly, with its real wall. The bottom is hollow by half a millimetre, as a real one: it stands on its rim."""
    inner = RADIUS - WALL
    profile = [(0, 0.0005), (RADIUS - 0.006, 0.0), (RADIUS, 0.003), (RADIUS, HEIGHT / 2), (RADIUS, HEIGHT), (inner, HEIGHT),
               (inner, HEIGHT / 2), (inner, FLOOR + 0.0025), (inner - 0.004, FLOOR + 0.0005), (0, FLOOR + 0.0005)]
    return tools.turned(profile, 24)


def beaker_visual():
    """Rounded foot and rim, a slight flare and a spout toward +x."""
    inner = RADIUS - WALL
    profile = [(0, 0.0005), (RADIUS - 0.010, 0.0003)]
    profile += arc((RADIUS - 0.005, 0.005), 0.005, -90, 0, 5)
    profile += [(RADIUS, z) for z in (0.035, 0.070, 0.084, 0.089)] + [(RADIUS + 0.0008, 0.092)]
    profile += arc((RADIUS + 0.0008, HEIGHT - WALL / 2), WALL / 2, 0, 180, 5)
    profile += [(inner + 0.0008, 0.092), (inner, 0.089), (inner, 0.084), (inner, 0.070), (inner, 0.035)]
    profile += arc((inner - 0.004, FLOOR + 0.0045), 0.004, 0, -90, 4)[0:] + [(0, FLOOR + 0.0005)]
    surface = tools.turned(profile, 96, phase=0.0)
    x, y, z = surface.points.T
    angle, radius = np.arctan2(y, x), np.hypot(x, y)
    rise = np.clip((z - 0.080) / 0.015, 0, 1) ** 2
    bulge = 0.0045 * rise * np.exp(-(angle / 0.22) ** 2) * (radius > 0.02)
    surface.points[:, 0] += bulge * np.cos(angle)
    surface.points[:, 1] += bulge * np.sin(angle)
    return surface


def scale_outline(inset=0.0):
    """In (z, x), counter-clockwise; the display's slope faces +x."""
    corners = [(inset, -0.090 + inset), (0.036 - inset, -0.090 + inset), (0.036 - inset, 0.072), (0.014, 0.115 - inset),
               (inset, 0.115 - inset)]
    return corners[::-1]


def scale():
    """The housing and the pan as two closed parts."""
    body = tools.extruded(scale_outline(), -0.085, 0.085, axis=1)
    pan = tools.turned([(0, 0.040), (0.065, 0.040), (0.065, PAN_TOP), (0, PAN_TOP)], 24)
    return outward(tools.joined(outward(body), pan))


def outward(surface):
    return surface if tools.volume(surface) > 0 else surface.flipped()


def scale_body_visual():
    body = outward(tools.extruded(scale_outline(0.001), -0.084, 0.084, axis=1))
    feet = [tools.turned([(0, 0), (0.008, 0), (0.008, 0.002), (0, 0.002)], 16).moved(x, y, 0)
            for x in (-0.07, 0.09) for y in (-0.065, 0.065)]
    body.points[:, 2] = np.where(body.points[:, 2] < 0.0015, 0.0015, body.points[:, 2])
    return tools.joined(body, *feet)


def scale_pan_visual():
    """A polished pan with a rounded edge on its stem."""
    edge = arc((0.062, PAN_TOP - 0.003), 0.003, -90, 90, 8)
    return tools.turned([(0, 0.0345), (0.018, 0.0345), (0.020, 0.0430), (0.040, 0.044)] + edge + [(0, PAN_TOP)], 64)


def on_slope(y0, y1, s0, s1, lift):
    """A plate on the sloped front: y from y0 to y1, s along the slope from its top, `lift` above it."""
    top, foot = np.array([0.072, 0, 0.035]), np.array([0.1135, 0, 0.0140])
    along = (foot - top) / np.linalg.norm(foot - top)
    normal = np.array([-along[2], 0, along[0]])
    corners = []
    for height in (-0.001, lift):
        for y in (y0, y1):
            corners += [top + along * s + normal * height + [0, y, 0] for s in (s0, s1)]
    plate = tools.box((0, 0, 0), (1, 1, 1))
    plate.points = np.array(corners)
    return outward(plate)


def scale_display():
    return on_slope(-0.045, 0.030, 0.006, 0.036, 0.0006)


def scale_digits():
    """Seven-segment figures "0.00" on the display."""
    segments = {"0": "abcdef", ".": "."}
    places = {"a": (0.1, 0.9, 0.0, 0.12), "d": (0.1, 0.9, 0.88, 1.0), "f": (0.0, 0.16, 0.06, 0.46), "b": (0.84, 1.0, 0.06, 0.46),
              "e": (0.0, 0.16, 0.54, 0.94), "c": (0.84, 1.0, 0.54, 0.94), ".": (0.0, 0.16, 0.86, 1.0)}
    width, height, parts, y = 0.011, 0.020, [], -0.030
    for figure in "0.00":
        for name in segments[figure]:
            a, b, c, d = places[name]
            parts.append(on_slope(y + a * width, y + b * width, 0.011 + c * height, 0.011 + d * height, 0.0009))
        y += 0.006 if figure == "." else 0.0155
    return tools.joined(*parts)


def table():
    """Top at z = 0."""
    return tools.box((-0.40, -0.75, -0.04), (0.95, 0.75, 0.0))


def main():
    parts = {"beaker": beaker(), "beaker_visual": beaker_visual(), "scale": scale(), "scale_body_visual": scale_body_visual(),
             "scale_pan_visual": scale_pan_visual(), "scale_display": scale_display(), "scale_digits": scale_digits(), "table": table()}
    for name, part in parts.items():
        tools.write_obj(os.path.join(HERE, name + ".obj"), part, f"{name}, written by make_objects.py [m]")
        print(f"{name}: {len(part.points)} points, volume {tools.volume(part) * 1e6:.3f} cm^3")
    mass, centre, inertia = tools.mass_properties(parts["beaker"], GLASS_DENSITY)
    print(f"beaker: {mass * 1e3:.2f} g, centre at z = {centre[2] * 1e3:.2f} mm, inertia {np.diag(inertia)} kg m^2")


if __name__ == "__main__":
    main()
