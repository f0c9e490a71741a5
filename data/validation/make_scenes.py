#!/usr/bin/env python3
"""Writes the scene files whose numbers follow from a formula: ramp, stack, arch, card_house, and those of cloth."""
import math
import pathlib

FOLDER = pathlib.Path(__file__).parent


def numbers(values):
    return "[" + ", ".join("%.10g" % (0 if abs(v) < 1e-12 else v) for v in values) + "]"


def body(name, shape, position, rotation=(0, 0, 0), more="density: 1000", kind="rigid"):
    return (f"  - {{name: {name}, kind: {kind}, shape: {shape}, {more}{', ' if more else ''}"
            f"pose: {{position: {numbers(position)}, rotation: {numbers(rotation)}}}}}\n")


def box(*size):
    return f"{{box: {{size: {numbers(size)}}}}}"


def head(comment, name, step, duration, contact, solver):
    lines = "".join(f"# {line}\n" for line in comment)
    return (f"{lines}schema: 1\nname: {name}\ntime_step: {step}\nduration: {duration}\ngravity: [0, 0, -9.80665]\n"
            f"contact: {{{contact}}}\nsolver: {{{solver}}}\nbodies:\n")


CONTACT = "activation_distance: 1 mm, stiffness: 10 MPa"


def ramp():
    angle, away = math.radians(30), 0.050995
    text = head(["Eight cubes with a side of 0.1 m and coefficients k / 7 on a ramp of 30 degrees: 0.577 is critical."],
                "ramp", "10 ms", "1 s", CONTACT + ", friction_velocity: 1e-5",
                "velocity_tolerance: 1e-6")
    text += body("ramp", "{square: {size: 20}}", (0, 0, 0), (0, angle, 0), "", "static")
    for k in range(8):
        text += body(f"cube_{k}", box(0.1, 0.1, 0.1), (away * math.sin(angle), 0.2 * (k - 3.5), away * math.cos(angle)),
                     (0, angle, 0))
    text += "pair_friction:\n"
    for k in range(8):
        text += f"  - {{first: ramp, second: cube_{k}, coefficient: {k / 7:.16g}}}\n"
    return text


def stack():
    text = head(["Ten boxes with a side of 0.1 m on each other; the highest weighs 100 times what the lowest does."],
                "stack", "20 ms", "5 s", CONTACT + ", friction_velocity: 1e-5", "velocity_tolerance: 1e-5")
    text += body("floor", "{square: {size: 4}}", (0, 0, 0), more="friction: 0.5", kind="static")
    for k in range(10):
        text += body(f"box_{k}", box(0.1, 0.1, 0.1), (0, 0, 0.05 + 0.1 * k + 0.00095 * (k + 1)),
                     more=f"density: {100 * 100 ** (k / 9):.10g}, friction: 0.5")
    return text


def arch():
    n, inner, outer, depth, gap = 25, 0.9, 1.15, 0.3, 0.00095
    middle, half = (inner + outer) / 2, math.pi / n / 2
    corners = []
    for y in (-depth / 2, depth / 2):  # the side faces are the hexahedron's lower and upper ones
        ring = []
        for side, radius in ((-1, inner), (-1, outer), (1, outer), (1, inner)):
            x = side * (radius * math.sin(half) - gap / 2 * math.cos(half))
            z = radius * math.cos(half) + gap / 2 * math.sin(half)
            ring.append((x, y, z - middle))
        corners += ring if y < 0 else ring
    flat = [c for corner in corners for c in corner]  # counter-clockwise seen from +y
    text = head(["A round arch of 25 blocks, 0.9 m inside and 1.15 m outside. Thicker than 0.1075 of its mean radius, so that it",
                 "stands if nothing slides (Couplet 1730, Heyman 1969). The case sets the coefficient of friction."],
                "arch", "10 ms", "2 s", CONTACT + ", friction_velocity: 1e-4", "velocity_tolerance: 1e-4")
    text += body("floor", "{square: {size: 10}}", (0, 0, 0), more="friction: 0.5", kind="static")
    for k in range(n):
        angle = math.pi / 2 - (2 * k + 1) * half  # from the vertical, about y
        text += body(f"block_{k}", f"{{hexahedron: {{corners: {numbers(flat)}}}}}",
                     (middle * math.sin(angle), 0, middle * math.cos(angle) + gap / 2), (0, angle, 0),
                     "density: 1000, friction: 0.5")
    return text


def card_house():
    height, width, thick, lean, gap = 0.09, 0.06, 0.001, math.radians(20), 0.0004
    reach = math.cos(lean) * thick / 2 + math.sin(lean) * height / 2
    rise = math.sin(lean) * thick / 2 + math.cos(lean) * height / 2
    text = head(["A house of seven cards: two leaning pairs, a card across them, a pair on top."],
                "card_house", "10 ms", "5 s", "activation_distance: 0.5 mm, stiffness: 10 MPa, friction_velocity: 1e-5",
                "velocity_tolerance: 1e-5")
    text += body("floor", "{square: {size: 1}}", (0, 0, 0), more="friction: 0.6", kind="static")

    def pair(name, x, z):
        out = ""
        for side, which in ((-1, "left"), (1, "right")):
            out += body(f"{name}_{which}", box(thick, width, height), (x + side * (reach + gap / 2), 0, z + gap + rise),
                        (0, -side * lean, 0), "density: 1000, friction: 0.6")
        return out

    apart = height * math.sin(lean) + 0.01
    top = gap + 2 * rise
    text += pair("west", -apart, 0) + pair("east", apart, 0)
    text += body("roof", box(2 * apart + 0.05, width, thick), (0, 0, top + gap + thick / 2),
                 more="density: 1000, friction: 0.6")
    return text + pair("top", 0, top + gap + thick)


def heavy_cantilever_cloth():
    length, cells = 0.1, 40
    cell = length / (cells - 0.5)
    return f"""# A strip of cloth of 100 x 10 mm, held level at one end, bends under its own weight. Its first cells are pinned: the
# clamp takes effect in their middle, 100 mm from the other end. The case sets the areal density.
schema: 1
name: heavy_cantilever_cloth
time_step: 100 ms
duration: 10 s
gravity: [0, 0, -9.81]
contact: {{activation_distance: 0.02 mm}}
solver: {{velocity_tolerance: 1e-6, cg_tolerance: 1e-6}}
cloths:
  - name: strip
    shape: {{sheet: {{size: {numbers((cells * cell, 0.01))}, divisions: [{cells}, 4]}}}}
    material: {{area_density: 0.1, thickness: 0, stretch: 1e5, bending: 1e-3}}
    pinned:
      - {{low: [-1, -1, -1], high: [{-cells * cell / 2 + 1.01 * cell:.6g}, 1, 1]}}
"""


def drape():
    inner, outer, rings, n = 0.09, 0.15, 10, 72
    step = (outer - inner) / (rings - 0.5)
    lines = ["# A round fabric without what lies on the plate, written by make_scenes.py"]
    for ring in range(rings + 1):
        radius = inner + (ring - 0.5) * step
        for i in range(n):
            angle = 2 * math.pi * (i + 0.5 * (ring % 2)) / n
            # the free points stand some 10 um higher, unevenly, for the folds to begin with
            z = 0 if ring < 2 else 1e-5 * (1.1 + math.sin(12.9898 * i + 78.233 * ring))
            lines.append("v %.9g %.9g %.9g" % (radius * math.cos(angle), radius * math.sin(angle), z))
    for ring in range(rings):
        for i in range(n):
            a, b = 1 + ring * n + i, 1 + ring * n + (i + 1) % n
            c, d = a + n, b + n
            lines += (["f %d %d %d" % (a, c, b), "f %d %d %d" % (b, c, d)] if ring % 2 == 0 else
                      ["f %d %d %d" % (a, d, b), "f %d %d %d" % (a, c, d)])
    (FOLDER / "drape.obj").write_text("\n".join(lines) + "\n")
    return """# A round fabric of 300 mm between plates of 180 mm (Cusick's test). What lies between the plates is left out but for two
# circles of points, which are pinned: the clamp takes effect half way between them. The case sets areal density and
# bending rigidity. The shear stiffness is that of woven fabrics, 0.5 to 1 gf/cm per degree.
schema: 1
name: drape
time_step: 40 ms
duration: 4 s
gravity: [0, 0, -9.81]
contact: {activation_distance: 0.5 mm, stiffness: 10 kPa}
solver: {velocity_tolerance: 1 mm/s}
cloths:
  - name: fabric
    shape: {mesh: drape.obj}
    material: {area_density: 0.15, thickness: 0.3 mm, stretch: 1000, shear: 40, bending: 1e-5}
    friction: 0.3
    pinned:
      - {low: [-1, -1, -1], high: [1, 1, 0]}
"""


for scene in (ramp, stack, arch, card_house, heavy_cantilever_cloth, drape):
    (FOLDER / f"{scene.__name__}.yaml").write_text(scene())
