#!/usr/bin/env python3
"""Writes the objects of the tasks: a 250 ml beaker, a conical flask, a dish, a plate, a mat, a laboratory scale, a cabinet with
a door, a table, and towels. Lengths in metres, z up, origin at the foot; the door's origin is on its hinge."""
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, ".."))
import asset_tools as tools  # noqa: E402

RADIUS, HEIGHT, WALL, FLOOR = 0.034, 0.095, 0.0016, 0.002
GLASS_DENSITY = 2230.0  # borosilicate [kg/m^3]
PAN_TOP = 0.050         # of the scale
FLASK_RADIUS, NECK_RADIUS, SHOULDER, FLASK_HEIGHT = 0.036, 0.016, 0.085, 0.125
DISH_RIM, DISH_FOOT, DISH_HEIGHT, DISH_WALL = 0.037, 0.025, 0.030, 0.002
PLATE_RADIUS, PLATE_TOP = 0.085, 0.012
CABINET = (0.25, 0.31, 0.50)         # depth, width, height
DOOR = (0.016, 0.30, 0.36)           # thickness, width, height; it begins DOOR_FOOT above the cabinet's foot
DOOR_FOOT, HANDLE_AT, HANDLE_OUT, HANDLE_RADIUS, HANDLE_LENGTH = 0.12, 0.26, 0.040, 0.007, 0.16


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


def flask():
    """Low-poly, with its real wall; hollow below by half a millimetre."""
    r, n, w = FLASK_RADIUS, NECK_RADIUS, WALL
    profile = [(0, 0.0005), (r - 0.005, 0.0), (r, 0.005), (n, SHOULDER), (n, (SHOULDER + FLASK_HEIGHT) / 2), (n, FLASK_HEIGHT),
               (n - w, FLASK_HEIGHT), (n - w, (SHOULDER + FLASK_HEIGHT) / 2), (n - w, SHOULDER), (r - w, 0.006),
               (r - 0.005, FLOOR + 0.0005), (0, FLOOR + 0.0005)]
    return tools.turned(profile, 24)


def flask_visual():
    """Rounded heel, a soft shoulder and a bead at the mouth."""
    r, n, w, top = FLASK_RADIUS, NECK_RADIUS, WALL, FLASK_HEIGHT
    slope = (r - n) / (SHOULDER - 0.005)
    cone = [(r - slope * (z - 0.005), z) for z in (0.012, 0.030, 0.050, 0.070, 0.079)]
    outer = [(0, 0.0005), (r - 0.010, 0.0003)] + arc((r - 0.0055, 0.0055), 0.0055, -90, 0, 6) + cone
    outer += [(n + 0.0008, 0.0830), (n + 0.0001, 0.0875), (n, 0.095), (n, top - 0.004)]
    bead = [(n + 0.0012, top - 0.003)] + arc((n + 0.0006, top - 0.0016), 0.0016, -40, 180, 8)
    inner = [(n - w, top - 0.004), (n - w, 0.095), (n - w + 0.0001, 0.0870)] + [(a - w, z) for a, z in cone[::-1]]
    return tools.turned(outer + bead + inner + arc((r - w - 0.0045, FLOOR + 0.005), 0.0045, 0, -90, 5) + [(0, FLOOR + 0.0005)], 96)


def dish():
    """Low-poly: it widens toward a thicker rim and stands on a ring."""
    r, f, h, w = DISH_RIM, DISH_FOOT, DISH_HEIGHT, DISH_WALL
    profile = [(0, 0.0005), (f - 0.004, 0.0), (f, 0.001), (r - 0.0015, h - 0.005), (r, h - 0.004), (r, h), (r - 0.003, h),
               (r - 0.001 - w, h - 0.006), (f - 0.001, w + 0.002), (f - 0.004, w + 0.0005), (0, w + 0.0005)]
    return tools.turned(profile, 24)


def dish_visual():
    """A round rim, walls that bulge, a foot ring."""
    r, f, h, w = DISH_RIM, DISH_FOOT, DISH_HEIGHT, DISH_WALL

    def bulge(t, inset):
        return f + 0.001 + (r - 0.0025 - f) * (1 - (1 - t) ** 1.35) - inset

    heights = [0.0035, 0.008, 0.013, 0.018, 0.022, 0.025]
    outer = [(0, 0.0007), (f - 0.006, 0.0006)] + arc((f - 0.002, 0.002), 0.002, -90, 0, 4)
    outer += [(bulge(z / 0.026, 0), z) for z in heights]
    rim = arc((r - 0.0019, h - 0.0019), 0.0019, -60, 190, 12)
    inner = [(bulge(z / 0.026, w), z) for z in heights[:0:-1]] + [(f - 0.003, w + 0.0012), (0, w + 0.0006)]
    return tools.turned(outer + rim + inner, 96)


def plate():
    """What lies under things: a disc with a bevel."""
    return tools.turned([(0, 0), (PLATE_RADIUS - 0.010, 0), (PLATE_RADIUS, 0.008), (PLATE_RADIUS, PLATE_TOP), (0, PLATE_TOP)], 24)


def plate_visual():
    profile = [(0, 0.0), (PLATE_RADIUS - 0.030, 0.0), (PLATE_RADIUS - 0.012, 0.002)]
    profile += arc((PLATE_RADIUS - 0.003, PLATE_TOP - 0.003), 0.003, -60, 90, 8) + [(0, PLATE_TOP)]
    return tools.turned(profile, 96)


def mat_visual():
    """Where the dish goes: a thin mark on the table."""
    return tools.turned([(0, 0), (0.055, 0), (0.055, 0.0004), (0, 0.0004)], 64)


def cabinet():
    depth, width, height = CABINET
    return tools.box((0, -width / 2, 0), (depth, width / 2, height))


def cabinet_visual():
    """A carcass with a shelf: the room behind the door is seen when it opens."""
    depth, width, height = CABINET
    t, half = 0.014, width / 2
    sides = [tools.box((0, s * half - (t if s > 0 else 0), 0), (depth, s * half + (0 if s > 0 else t), height)) for s in (-1, 1)]
    shelves = [tools.box((0.001, -half + t, z), (depth, half - t, z + t)) for z in (DOOR_FOOT - t, (DOOR_FOOT + height) / 2, height - t)]
    back = tools.box((depth - 0.006, -half + t, 0), (depth - 0.001, half - t, height - t))
    plinth = tools.box((0.012, -half + t, 0), (0.024, half - t, DOOR_FOOT - t))
    return tools.joined(*sides, *shelves, back, plinth)


def handle(segments, gap):
    """A bar and its two posts. gap: what the posts leave free of bar and door, so that the parts stay apart."""
    out = -DOOR[0] - HANDLE_OUT
    middle = DOOR[2] / 2
    bar = tools.turned([(0, 0), (HANDLE_RADIUS, 0), (HANDLE_RADIUS, HANDLE_LENGTH), (0, HANDLE_LENGTH)], segments)
    bar = bar.moved(out, -HANDLE_AT, middle - HANDLE_LENGTH / 2)
    posts = [tools.box((out + HANDLE_RADIUS + gap, -HANDLE_AT - 0.005, z - 0.005), (-DOOR[0] - gap, -HANDLE_AT + 0.005, z + 0.005))
             for z in (middle - HANDLE_LENGTH / 2 + 0.012, middle + HANDLE_LENGTH / 2 - 0.012)]
    return tools.joined(bar, *posts)


def door():
    thick, width, height = DOOR
    return tools.joined(tools.box((-thick, -width, 0), (0, 0, height)), handle(16, 0.0005))


def door_visual():
    thick, width, height = DOOR
    frame, inset = 0.045, 0.004
    panel = tools.box((-thick + inset, -width + frame, frame), (-inset, -frame, height - frame))
    stiles = [tools.box((-thick, y, 0), (0, y + frame, height)) for y in (-width, -frame)]
    rails = [tools.box((-thick, -width + frame, z), (0, -frame, z + frame)) for z in (0, height - frame)]
    return tools.joined(panel, *stiles, *rails)


def handle_visual():
    return handle(48, -0.001)


def towel(xs, ys):
    """A sheet in the plane z = 0 with grid lines at xs and ys, its diagonals turned in a checkered order."""
    points = [(x, y, 0) for y in ys for x in xs]
    n, faces = len(xs), []
    for j in range(len(ys) - 1):
        for i in range(n - 1):
            a, b, c, d = j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i
            faces += [(a, b, c), (a, c, d)] if (i + j) % 2 == 0 else [(a, b, d), (b, c, d)]
    return tools.Surface(points, faces)


def graded(low, high, fine, coarse, n_low, n_high=0):
    """Grid lines from low to high: n_low cells of about `fine` at the low end, n_high at the high end, else about `coarse`."""
    middle = high - low - (n_low + n_high) * fine
    cells = max(1, round(middle / coarse))
    return np.concatenate([low + fine * np.arange(n_low), np.linspace(low + fine * n_low, high - fine * n_high, cells + 1),
                           high - fine * np.arange(n_high)[::-1]])


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


def table():
    """Top at z = 0."""
    return tools.box((-0.40, -0.75, -0.04), (0.95, 0.75, 0.0))


def main():
    parts = {"beaker": beaker(), "beaker_visual": beaker_visual(), "flask": flask(), "flask_visual": flask_visual(),
             "dish": dish(), "dish_visual": dish_visual(), "plate": plate(), "plate_visual": plate_visual(),
             "mat_visual": mat_visual(), "cabinet": cabinet(), "cabinet_visual": cabinet_visual(), "door": door(),
             "door_visual": door_visual(), "handle_visual": handle_visual(), "scale": scale(), "scale_body_visual": scale_body_visual(),
             "scale_pan_visual": scale_pan_visual(), "scale_display": scale_display(), "table": table()}
    for name, part in parts.items():
        tools.write_obj(os.path.join(HERE, name + ".obj"), part, f"{name}, written by make_objects.py [m]")
        print(f"{name}: {len(part.points)} points, volume {tools.volume(part) * 1e6:.3f} cm^3")
    towels = {"towel": towel(*2 * [graded(-0.15, 0.15, 0.005, 0.016, 12)]),
              "towel_coarse": towel(*2 * [graded(-0.15, 0.15, 0.006, 0.024, 7)]),
              "towel_large": towel(graded(-0.15, 0.15, 0.005, 0.020, 10), graded(-0.20, 0.20, 0.005, 0.020, 10, 10)),
              "towel_large_coarse": towel(graded(-0.15, 0.15, 0.007, 0.030, 5), graded(-0.20, 0.20, 0.007, 0.033, 5, 5))}
    os.makedirs(os.path.join(HERE, "..", "cloths"), exist_ok=True)
    for name, sheet in towels.items():
        tools.write_obj(os.path.join(HERE, "..", "cloths", name + ".obj"), sheet, f"{name}, written by make_objects.py [m]")
        print(f"{name}: {len(sheet.points)} points")
    for name in ("beaker", "flask", "dish"):
        mass, centre, inertia = tools.mass_properties(parts[name], GLASS_DENSITY)
        print(f"{name}: {mass * 1e3:.2f} g, centre at z = {centre[2] * 1e3:.2f} mm, inertia {np.diag(inertia)} kg m^2")


if __name__ == "__main__":
    main()
