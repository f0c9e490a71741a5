#!/usr/bin/env python3
"""Writes the gripper: a soft fin-ray finger in the manner of the UMI gripper, a rigid base and two carriages.

The default cells give a mesh of some 2,300 nodes with 10-node elements. Under a pressure on the pad it is 9 % stiffer than
--layers 2 with every element split into eight (20,000 elements; small strain, Poisson's ratio 0.45).

The finger's true drawing is not public with its repository: this one is a parametric finger of the same kind. Frames:
  finger    x across, y from the pad (y = 0, facing -y) to the back, z from the foot (z = 0) to the tip
  carriage  origin on its top face, below the middle of the foot's pad side; same axes as the finger
  base      origin on the robot's flange, z along the fingers, the fingers close along y
"""
import argparse
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", ".."))
import asset_tools as tools  # noqa: E402

# lengths in metres
HEIGHT, WIDTH = 0.085, 0.022       # of the finger
FOOT_DEPTH, FOOT_HEIGHT = 0.030, 0.012
TIP_DEPTH, TIP_HEIGHT = 0.007, 0.009
FRONT_WALL, BACK_WALL = 0.0026, 0.0026
CHAMFER = 0.0012                   # of the corners between walls and ribs
N_RIBS, RIB, RIB_CELL = 5, 0.0020, 0.0030
BASE_TOP, CARRIAGE_GAP, CARRIAGE_HEIGHT = 0.046, 0.002, 0.010
FOOT_GAP = 0.002                   # foot above carriage: more than contact's activation distance, bridged by the stitches
PAD_AT_ZERO = 0.002                # the pad's distance from the middle plane at joint position 0
STROKE = 0.040


def finger(across, front_segments, back_segments, layers):
    """The profile in (y, z) as a sheet of quadrilaterals, extruded along x: its boundary is the finger's surface."""
    nodes, index, quads = [], {}, []

    def node(y, z):
        key = (round(y * 1e7), round(z * 1e7))
        if key not in index:
            index[key] = len(nodes)
            nodes.append((y, z))
        return index[key]

    def patch(a, b, c, d, along, up):
        """Corners counter-clockwise; `along`, `up`: shares from a to b and from a to d where cells end."""
        a, b, c, d = (np.array(p, float) for p in (a, b, c, d))
        grid = [[node(*((1 - t) * ((1 - s) * a + s * b) + t * ((1 - s) * d + s * c))) for t in up] for s in along]
        for i in range(len(along) - 1):
            for j in range(len(up) - 1):
                quads.append((grid[i][j], grid[i + 1][j], grid[i + 1][j + 1], grid[i][j + 1]))
        return grid

    def even(n):
        return np.linspace(0, 1, n + 1)

    def graded(length, n):
        """One cell as long as a chamfer at each end, n between."""
        c = CHAMFER / length
        return np.concatenate([[0], np.linspace(c, 1 - c, n + 1), [1]])

    def back(z):  # outer line of the back wall
        return FOOT_DEPTH + (TIP_DEPTH - FOOT_DEPTH) * (z - FOOT_HEIGHT) / (HEIGHT - FOOT_HEIGHT)

    slope = (FOOT_DEPTH - TIP_DEPTH) / (HEIGHT - FOOT_HEIGHT)
    wall = BACK_WALL * np.hypot(1, slope)  # the back wall's thickness along y
    top = HEIGHT - TIP_HEIGHT
    pitch = (top - FOOT_HEIGHT - N_RIBS * RIB) / (N_RIBS + 1)
    levels = [FOOT_HEIGHT]
    for _ in range(N_RIBS):
        levels += [levels[-1] + pitch, levels[-1] + pitch + RIB]
    levels.append(top)

    def cells(length):
        return max(2, round((length - 2 * CHAMFER) / RIB_CELL)) * layers

    through = even(layers)
    inside = [(FRONT_WALL, back(z) - wall) for z in levels]  # the inner faces of both walls at each level
    inside[0] = (FRONT_WALL, FOOT_DEPTH - wall)
    # rows of nodes on which the compartments between two ribs stand, and from which they hang
    floors, ceilings = [], []
    gap = inside[0][1] - inside[0][0]
    for y0, y1, along in ((0, FRONT_WALL, through), (*inside[0], graded(gap, cells(gap))),
                          (inside[0][1], FOOT_DEPTH, through)):
        grid = patch((y0, 0), (y1, 0), (y1, FOOT_HEIGHT), (y0, FOOT_HEIGHT), along, through)
        if y0 == FRONT_WALL:
            floors.append([column[-1] for column in grid])
    sides = []
    for k, (z0, z1) in enumerate(zip(levels, levels[1:])):
        is_rib = k % 2 == 1
        length = z1 - z0
        front = through if is_rib else graded(length, front_segments)
        rear = through if is_rib else graded(length, back_segments)
        left = patch((0, z0), (FRONT_WALL, z0), (FRONT_WALL, z1), (0, z1), through, front)
        right = patch((back(z0) - wall, z0), (back(z0), z0), (back(z1), z1), (back(z1) - wall, z1), through, rear)
        if is_rib:
            gap = inside[k][1] - inside[k][0]
            grid = patch((FRONT_WALL, z0), (inside[k][1], z0), (inside[k + 1][1], z1), (FRONT_WALL, z1),
                         graded(gap, cells(gap)), through)
            ceilings.append([column[0] for column in grid])
            floors.append([column[-1] for column in grid])
        else:
            sides.append((left[-1], right[0]))
    gap = inside[-1][1] - inside[-1][0]
    for y0, y1, u0, u1, along in ((0, 0, FRONT_WALL, FRONT_WALL, through),
                                  (FRONT_WALL, FRONT_WALL, back(top) - wall, back(HEIGHT) - wall,
                                   graded(gap, cells(gap))),
                                  (back(top) - wall, back(HEIGHT) - wall, back(top), back(HEIGHT), through)):
        grid = patch((y0, top), (u0, top), (u1, HEIGHT), (y1, HEIGHT), along, even(2 * layers))
        if y0 == FRONT_WALL:
            ceilings.append([column[0] for column in grid])
    # a chamfer in each corner of each compartment: printed corners are round, and a sharp one never converges
    for floor, ceiling, (left, right) in zip(floors, ceilings, sides):
        quads.extend([(floor[0], floor[1], left[1]), (floor[-2], floor[-1], right[1]),
                      (ceiling[0], left[-2], ceiling[1]), (ceiling[-1], ceiling[-2], right[-2])])
    return boundary_of_extrusion(np.array(nodes), quads, np.linspace(-WIDTH / 2, WIDTH / 2, across + 1))


def boundary_of_extrusion(nodes, quads, xs):
    edges = {}
    for q in quads:
        for a, b in zip(q, q[1:] + q[:1]):
            edges[(a, b)] = edges.get((a, b), 0) + 1
    border = [e for e in edges if (e[1], e[0]) not in edges]
    n = len(nodes)
    points = np.concatenate([np.column_stack([np.full(n, x), nodes]) for x in xs])
    last = (len(xs) - 1) * n
    faces = [q[::-1] for q in quads] + [tuple(i + last for i in q) for q in quads]
    for k in range(len(xs) - 1):
        for a, b in border:
            faces.append((a + k * n, b + k * n, b + (k + 1) * n, a + (k + 1) * n))
    used = sorted({i for f in faces for i in f})  # nodes inside the profile appear on the two caps only
    new = {old: i for i, old in enumerate(used)}
    return tools.Surface(points[used], [tuple(new[i] for i in f) for f in faces])


def base_collision():
    return tools.box((-0.030, -0.082, 0.010), (0.030, 0.082, BASE_TOP))


def base_visual():
    plate = tools.turned([(0, 0), (0.0315, 0), (0.0315, 0.012), (0, 0.012)], 48)
    body = tools.extruded(tools.rounded_rectangle(0.060, 0.164, 0.012), 0.010, BASE_TOP - 0.006, axis=2)
    rails = [tools.box((x - 0.004, -0.080, BASE_TOP - 0.006), (x + 0.004, 0.080, BASE_TOP)) for x in (-0.015, 0.015)]
    return tools.joined(plate, body, *rails)


def camera_visual():
    """Housing of the wrist camera, on the side of +x, tilted toward the fingers."""
    tilt = np.arctan2(CAMERA[0], TOOL_Z - CAMERA[2])
    housing = tools.extruded(tools.rounded_rectangle(0.020, 0.044, 0.004), -0.022, -0.003, axis=2)
    lens = tools.turned([(0, -0.003), (0.007, -0.003), (0.007, -0.0005), (0, -0.0005)], 32)
    part = tools.joined(housing, lens)
    c, s = np.cos(-tilt), np.sin(-tilt)
    part.points = part.points @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]).T + CAMERA
    # below what the camera sees
    arm = tools.box((0.028, -0.008, 0.002), (CAMERA[0] - 0.004, 0.008, 0.008))
    return tools.joined(part, arm)


def carriage_collision():
    return tools.box((-0.013, -0.001, -CARRIAGE_HEIGHT), (0.013, FOOT_DEPTH + 0.002, 0.0))


def carriage_visual():
    """The plate and a rim that hides the gap below the foot."""
    plate = tools.box((-0.0135, -0.0005, -CARRIAGE_HEIGHT), (0.0135, FOOT_DEPTH + 0.003, 0.0005))
    top = FOOT_GAP + 0.007
    walls = [tools.box((-0.0135, -0.0005, 0.0005), (-0.0115, FOOT_DEPTH + 0.003, top)),
             tools.box((0.0115, -0.0005, 0.0005), (0.0135, FOOT_DEPTH + 0.003, top)),
             tools.box((-0.0115, FOOT_DEPTH + 0.0007, 0.0005), (0.0115, FOOT_DEPTH + 0.003, top))]
    return tools.joined(plate, *walls)


TOOL_Z = BASE_TOP + CARRIAGE_GAP + CARRIAGE_HEIGHT + FOOT_GAP + HEIGHT * 2 / 3
COLORS = (("gripper_body", "0.23 0.23 0.25"), ("gripper_carriage", "0.62 0.63 0.65"), ("camera_body", "0.09 0.09 0.1"))
CAMERA = np.array([0.078, 0.0, 0.012])


def box_inertia(mass, x, y, z):
    return mass / 12 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])


def inertial(mass, centre, diagonal):
    return (f'    <inertial>\n      <origin xyz="{centre[0]:.6g} {centre[1]:.6g} {centre[2]:.6g}" rpy="0 0 0"/>\n'
            f'      <mass value="{mass:.6g}"/>\n'
            f'      <inertia ixx="{diagonal[0]:.6g}" iyy="{diagonal[1]:.6g}" izz="{diagonal[2]:.6g}" ixy="0" ixz="0" iyz="0"/>\n'
            "    </inertial>\n")


def shapes(visuals, collision):
    seen = [f'    <visual><geometry><mesh filename="{file}"/></geometry><material name="{material}"/></visual>\n'
            for file, material in visuals]
    return "".join(seen) + f'    <collision><geometry><mesh filename="{collision}"/></geometry></collision>\n'


def urdf():
    base_mass, carriage_mass = 0.70, 0.06
    carriage_size = (0.026, FOOT_DEPTH + 0.003, CARRIAGE_HEIGHT)
    text = ['<?xml version="1.0"?>\n<!-- written by make_gripper.py -->\n<robot name="umi_finray">\n'
            + "".join(f'  <material name="{name}"><color rgba="{color} 1"/></material>\n' for name, color in COLORS) +
            '  <link name="gripper_base">\n',
            inertial(base_mass, (0, 0, BASE_TOP / 2), box_inertia(base_mass, 0.060, 0.164, BASE_TOP)),
            shapes([("base_visual.obj", "gripper_body"), ("camera_visual.obj", "camera_body")], "base.obj"), "  </link>\n"]
    for name, turn in (("left", 0.0), ("right", np.pi)):
        text += [f'  <link name="{name}_carriage">\n',
                 inertial(carriage_mass, (0, FOOT_DEPTH / 2, -CARRIAGE_HEIGHT / 2), box_inertia(carriage_mass, *carriage_size)),
                 shapes([("carriage_visual.obj", "gripper_carriage")], "carriage.obj"), "  </link>\n",
                 f'  <joint name="{name}_slide" type="prismatic">\n    <parent link="gripper_base"/>\n'
                 f'    <child link="{name}_carriage"/>\n'
                 f'    <origin xyz="0 {PAD_AT_ZERO if turn == 0 else -PAD_AT_ZERO:.6g} {BASE_TOP + CARRIAGE_GAP + CARRIAGE_HEIGHT:.6g}"'
                 f' rpy="0 0 {turn:.12g}"/>\n    <axis xyz="0 1 0"/>\n'
                 f'    <limit lower="0" upper="{STROKE}" velocity="0.15" effort="60"/>\n'
                 '    <dynamics damping="0" friction="0"/>\n  </joint>\n']
    return "".join(text) + "</robot>\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--across", type=int, default=1, help="cells across the finger's width")
    parser.add_argument("--front", type=int, default=3, help="cells of the front wall between two ribs")
    parser.add_argument("--back", type=int, default=3, help="cells of the back wall between two ribs")
    parser.add_argument("--layers", type=int, default=1, help="cells through a wall")
    parser.add_argument("--finger-only", metavar="FILE", help="write only the finger's surface, to this file")
    given = parser.parse_args()
    surface = finger(given.across, given.front, given.back, given.layers)
    comment = "fin-ray finger, written by make_gripper.py [m]"
    if given.finger_only:
        tools.write_obj(given.finger_only, surface, comment)
        return
    for name, part in (("finger", surface), ("base", base_collision()), ("base_visual", base_visual()),
                       ("camera_visual", camera_visual()), ("carriage", carriage_collision()),
                       ("carriage_visual", carriage_visual())):
        tools.write_obj(os.path.join(HERE, name + ".obj"), part, comment if name == "finger" else f"{name}, written by make_gripper.py [m]")
        print(f"{name}: {len(part.points)} points, volume {tools.volume(part) * 1e6:.3f} cm^3")
    with open(os.path.join(HERE, "gripper.urdf"), "w") as file:
        file.write(urdf())
    print(f"tool centre at z = {TOOL_Z:.6f} m of the base")


if __name__ == "__main__":
    main()
