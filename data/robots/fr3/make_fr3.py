#!/usr/bin/python3
"""Makes fr3.urdf and the meshes beside it: a Franka Research 3 from its published figures, shapes of our own design.

Kinematics, limits, masses and inertias are the maker's figures (frankarobotics/franka_description, robots/fr3/*.yaml;
position-dependent velocity limits: libfranka, rate_limiting.h); rotor inertia and the like are left out. The shapes
follow the outer sizes of the real arm: housings (round cylinders about the joints) joined by tubes.
  visual/     the isosurface 0 of a smooth union of distance functions, made by surface nets: white shell, dark trim
  collision/  closed sweeps of octagons
Lengths in metres, in the frame of the link. Needs numpy:  python3 make_fr3.py [--preview FILE.png]
"""
import pathlib
import sys

import numpy as np

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER))
sys.dont_write_bytecode = True
from shapes import (Part, capsule, clean_float, cylinder, lathe, merge, net_of, ring_sweep, write_obj)  # noqa: E402

X, Y, Z = np.eye(3)
R = 0.0565  # radius of the large housings and tubes

# joint: origin xyz, roll; lower, upper [rad], velocity [rad/s], effort [N m]; velocity envelope offset, slope, upper, lower
JOINTS = [
    ((0, 0, 0.333), 0.0, -2.7437, 2.7437, 2.62, 87, (0.30, 12.0, 2.7501, 2.7501)),
    ((0, 0, 0), -np.pi / 2, -1.7837, 1.7837, 2.62, 87, (0.20, 5.17, 1.7918, 1.7918)),
    ((0, -0.316, 0), np.pi / 2, -2.9007, 2.9007, 2.62, 87, (0.20, 7.0, 2.9065, 2.9065)),
    ((0.0825, 0, 0), np.pi / 2, -3.0421, -0.1518, 2.62, 87, (0.30, 8.0, -0.1458, 3.0481)),
    ((-0.0825, 0.384, 0), -np.pi / 2, -2.8065, 2.8065, 5.26, 12, (0.35, 34.0, 2.8101, 2.8101)),
    ((0, 0, 0), np.pi / 2, 0.5445, 4.5169, 4.18, 12, (0.35, 11.0, 4.5205, -0.54092)),
    ((0.088, 0, 0), np.pi / 2, -3.0159, 3.0159, 5.26, 12, (0.35, 34.0, 3.0196, 3.0196)),
]
ACCELERATION, JERK = 10, 5000  # of every joint [rad/s^2, rad/s^3]
FLANGE = 0.107                 # of link 8 beyond joint 7

# link: mass [kg], centre of mass [m], inertia about it xx xy xz yy yz zz [kg m^2]
INERTIALS = [
    (2.3966, (-0.0172, 0.0004, 0.0745), (0.0090, 0.0, 0.0020, 0.0115, 0.0, 0.0085)),
    (2.9274653454, (0.0000004128, -0.0181251324, -0.0386035970),
     (0.023927316485107913, 1.3317903455714081e-05, -0.00011404774918616684, 0.0224821613275756,
      -0.0019950320628240115, 0.006350098258530016)),
    (2.9355370338, (0.0031828864, -0.0743221644, 0.0088146084),
     (0.041938946257609425, 0.00020257331521090626, 0.004077784227179924, 0.02514514885014724,
      -0.0042252158006570156, 0.06170214472888839)),
    (2.2449013699, (0.0407015686, -0.0048200565, -0.0289730823),
     (0.02410142547240885, 0.002404694559042109, -0.002856269270114313, 0.01974053266708178,
      -0.002104212683891874, 0.019044494482244823)),
    (2.6155955791, (-0.0459100965, 0.0630492960, -0.0085187868),
     (0.03452998321913202, 0.01322552265982813, 0.01015142998484113, 0.028881621933049058,
      -0.0009762833870704552, 0.04125471171146641)),
    (2.3271207594, (-0.0016039605, 0.0292536262, -0.0972965990),
     (0.051610278463662895, -0.005715173387783472, -0.0035673167625872135, 0.04787729713371481,
      0.010673985108535986, 0.016423625579357254)),
    (1.8170376524, (0.0597131221, -0.0410294666, -0.0101692726),
     (0.005412333594383447, 0.006193456360285834, 0.0014219289306117652, 0.014058329545509979,
      -0.0013140753741120031, 0.016080817924212554)),
    (0.6271432862, (0.0045225817, 0.0086261921, -0.0161633251),
     (0.00021092389150104718, -2.433299114461931e-05, 4.564480393778983e-05, 0.00017718568002411474,
      8.744070223226438e-05, 5.993190599659971e-05)),
]

# pairs that cannot meet, or meet only out of the working range (the maker's SRDF leaves out the same ones)
NONCOLLIDING = "0-2 0-3 0-4 1-3 1-4 2-4 2-6 3-5 3-6 3-7 4-6 4-7 5-7".split()


def shells():
    """White shells, one per link: distance functions and the width of the fillets between them."""
    c, k = cylinder, capsule
    return [
        Part([c((0, 0, 0.0), (0, 0, 0.052), 0.090, 0.014), k((-0.11, 0, 0.045), (0, 0, 0.045), 0.044, 0.052),
              c((0, 0, 0.03), (0, 0, 0.139), 0.064, 0.012)], 0.030, floor=0.0),
        Part([c((0, 0, -0.191), (0, 0, -0.069), R, 0.010), c((0, -0.128, 0), (0, -0.003, 0), R + 0.003, 0.014),
              k((0, -0.014, -0.085), (0, -0.062, -0.015), 0.044, 0.050)], 0.035),
        Part([c((0, -0.192, 0), (0, -0.069, 0), R, 0.010), c((0, 0, 0.003), (0, 0, 0.128), R + 0.003, 0.014),
              k((0, -0.085, 0.014), (0, -0.015, 0.062), 0.044, 0.050)], 0.035),
        Part([c((0, 0, -0.1215), (0, 0, -0.045), R, 0.010), c((0.0825, 0.003, 0), (0.0825, 0.110, 0), 0.055, 0.014),
              k((0, 0, -0.045), (0.045, 0.035, -0.012), 0.050, 0.047)], 0.035),
        Part([c((-0.0825, 0.123, 0), (-0.0825, 0.045, 0), R, 0.010), c((0, 0, 0.003), (0, 0, 0.109), 0.055, 0.014),
              k((-0.0825, 0.045, 0), (-0.045, 0.012, 0.035), 0.050, 0.047)], 0.035),
        Part([c((0, 0, -0.2575), (0, 0, -0.19), R, 0.010), k((0, 0, -0.19), (0, 0.072, -0.055), 0.050, 0.036),
              c((0, 0.052, 0), (0, 0.131, 0), 0.050, 0.014)], 0.040),
        Part([c((0, 0, -0.044), (0, 0, 0.055), 0.0485, 0.012), c((0.088, -0.0495, 0), (0.088, 0.078, 0), 0.0435, 0.012),
              k((0.01, 0, 0), (0.08, 0.005, 0), 0.038, 0.036)], 0.025),
        Part([c((0, 0, 0.056), (0, 0, 0.0905), 0.0425, 0.008), k((0, 0, 0.073), (0.048, 0.048, 0.073), 0.018, 0.016)],
             0.012),
    ]


def trims():
    """Dark trim: (from, to, profile of (share of the way, radius)) turned about the line from -> to."""
    def seam(center, axis, radius, half=0.006):
        c, a = np.asarray(center, float), np.asarray(axis, float)
        return c - half * a, c + half * a, [(0, radius - 0.004), (0, radius), (1, radius), (1, radius - 0.004)]

    def cap(center, axis, radius, height=0.004):
        c, a = np.asarray(center, float), np.asarray(axis, float)
        return c - 0.006 * a, c + height * a, [(0, radius), (0.75, radius), (0.93, radius - 0.0015), (1, radius - 0.005)]

    return [
        [seam((0, 0, 0.140), Z, R - 0.0015)],
        [seam((0, 0, 0), Y, R - 0.001), cap((0, -0.128, 0), -Y, 0.040)],
        [seam((0, -0.193, 0), -Y, R - 0.0015), cap((0, 0, 0.128), Z, 0.040)],
        [seam((0.0825, 0, 0), Y, 0.0525), cap((0.0825, 0.110, 0), Y, 0.037)],
        [seam((-0.0825, 0.124, 0), Y, R - 0.0015), cap((0, 0, 0.109), Z, 0.037)],
        [seam((0, 0.0485, 0), Y, 0.0465, 0.008), cap((0, 0.131, 0), Y, 0.034)],
        [seam((0.088, -0.053, 0), Y, 0.0405), cap((0, 0, 0.055), Z, 0.033), cap((0.088, 0.078, 0), Y, 0.028)],
        [(np.array([0, 0, 0.084]), np.array([0, 0, FLANGE]), [(0, 0.0315), (0.93, 0.0315), (1, 0.030)])],
    ]


def collisions():
    """Two closed sweeps per link: lists of rings (centre, axis, radius)."""
    def tube(a, b, radius, chamfer=0.012):
        a, b = np.asarray(a, float), np.asarray(b, float)
        n = (b - a) / np.linalg.norm(b - a)
        return [(a, n, radius - chamfer), (a + chamfer * n, n, radius), (b - chamfer * n, n, radius), (b, n, radius - chamfer)]

    return [
        [tube((0, 0, 0.002), (0, 0, 0.140), 0.075, 0.010), tube((-0.152, 0, 0.049), (-0.02, 0, 0.049), 0.044, 0.015)],
        [tube((0, 0, -0.190), (0, 0, -0.030), 0.0565), tube((0, -0.130, 0), (0, 0, 0), 0.0595)],
        [tube((0, -0.192, 0), (0, -0.030, 0), 0.0565), tube((0, 0, 0), (0, 0, 0.130), 0.0595)],
        [tube((0, 0, -0.121), (0, 0, 0.012), 0.058), tube((0.0825, 0, 0), (0.0825, 0.112, 0), 0.056)],
        [tube((-0.0825, 0.123, 0), (-0.0825, -0.012, 0), 0.058), tube((0, 0, 0), (0, 0, 0.111), 0.056)],
        [[((0, 0, -0.257), Z, 0.046), ((0, 0, -0.246), Z, 0.0565), ((0, 0.004, -0.185), Z, 0.0565),
          ((0, 0.062, -0.085), Y * 0.6 + Z * 0.8, 0.042), ((0, 0.09, -0.03), Z, 0.036)],
         tube((0, 0.0485, 0), (0, 0.133, 0), 0.051)],
        [tube((0, 0, -0.046), (0, 0, 0.056), 0.050), tube((0.088, -0.050, 0), (0.088, 0.080, 0), 0.0455)],
        [tube((0, 0, 0.054), (0, 0, FLANGE), 0.044, 0.006), tube((0.02, 0.02, 0.073), (0.062, 0.062, 0.073), 0.0185, 0.005)],
    ]


def urdf():
    lines = ['<?xml version="1.0"?>',
             '<!-- Made by make_fr3.py. Figures as published by the maker, shapes of our own. SI units, radians. -->',
             '<robot name="fr3">',
             '  <material name="robot_white"><color rgba="0.93 0.93 0.92 1"/></material>',
             '  <material name="robot_dark"><color rgba="0.20 0.21 0.23 1"/></material>']
    for i, (mass, com, inertia) in enumerate(INERTIALS):
        names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        tensor = " ".join(f'{n}="{clean_float(v)}"' for n, v in zip(names, inertia))
        xyz = " ".join(clean_float(v) for v in com)
        lines += [f'  <link name="fr3_link{i}">', f'    <inertial><origin xyz="{xyz}"/><mass value="{clean_float(mass)}"/>',
                  f'      <inertia {tensor}/></inertial>']
        for kind, color in (("shell", "white"), ("trim", "dark")):
            lines.append(f'    <visual><geometry><mesh filename="visual/link{i}_{kind}.obj"/></geometry>'
                         f'<material name="robot_{color}"/></visual>')
        lines += [f'    <collision><geometry><mesh filename="collision/link{i}.obj"/></geometry></collision>', '  </link>']
    for i, (xyz, roll, lower, upper, velocity, effort, envelope) in enumerate(JOINTS, 1):
        origin = " ".join(clean_float(v) for v in xyz)
        offset, slope, high, low = (clean_float(v) for v in envelope)
        lines += [f'  <joint name="fr3_joint{i}" type="revolute">',
                  f'    <parent link="fr3_link{i - 1}"/><child link="fr3_link{i}"/>',
                  f'    <origin xyz="{origin}" rpy="{roll!r} 0 0"/><axis xyz="0 0 1"/>',
                  f'    <limit lower="{lower}" upper="{upper}" velocity="{velocity}" effort="{effort}" '
                  f'acceleration="{ACCELERATION}" jerk="{JERK}"/>',
                  f'    <velocity_envelope offset="{offset}" slope="{slope}" upper="{high}" lower="{low}"/>',
                  '  </joint>']
    lines += ['  <link name="fr3_link8"/>', '  <joint name="fr3_joint8" type="fixed">',
              f'    <parent link="fr3_link7"/><child link="fr3_link8"/><origin xyz="0 0 {FLANGE}"/>', '  </joint>']
    for pair in NONCOLLIDING:
        a, b = pair.split("-")
        lines.append(f'  <disable_collisions link1="fr3_link{a}" link2="fr3_link{b}"/>')
    return "\n".join(lines + ["</robot>", ""])


def main():
    (FOLDER / "visual").mkdir(exist_ok=True)
    (FOLDER / "collision").mkdir(exist_ok=True)
    (FOLDER / "fr3.urdf").write_text(urdf())
    meshes = []
    for i, (shell, trim, collision) in enumerate(zip(shells(), trims(), collisions())):
        white = net_of(shell, n_triangles=2300)
        dark = merge([lathe(*t) for t in trim])
        hull = merge([ring_sweep(rings, 8) for rings in collision])
        write_obj(FOLDER / f"visual/link{i}_shell.obj", f"link {i}: shell", white)
        write_obj(FOLDER / f"visual/link{i}_trim.obj", f"link {i}: trim", dark)
        write_obj(FOLDER / f"collision/link{i}.obj", f"link {i}: collision", hull, normals=False)
        meshes.append((white, dark, hull))
        print(f"link {i}: {len(white[2])} + {len(dark[2])} triangles to see, {len(hull[2])} to collide")
    if "--preview" in sys.argv:
        import preview
        preview.draw(sys.argv[sys.argv.index("--preview") + 1], JOINTS, meshes)


if __name__ == "__main__":
    main()
