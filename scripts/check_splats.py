#!/usr/bin/env python3
"""Makes Gaussian splats of a mesh, has `phyvisgen capture object` find the surface, and measures how far it is off.

  check_splats.py PHYVISGEN FOLDER [--mesh MESH] [--splats 20000]

Needs numpy, scipy, trimesh and plyfile (scripts/python_env.sh splats numpy scipy trimesh plyfile). The mesh is a bumpy
ball with a handle unless --mesh names one. Written are a file of 3DGS (round and flat splats with noise), one of 2DGS (two scales) and
one of TSGS, whose splats are glass: 30 % opaque, with an opaque ball inside that only a first surface leaves out.
Exits with 1 where a surface is off by more than 1 % of the size on the mean.
"""
import argparse
import json
import pathlib
import subprocess
import sys

import numpy as np
import plyfile
import trimesh
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation


def bumpy_ball():
    ball = trimesh.creation.icosphere(5, 0.05)
    ball.vertices *= (1 + 0.12 * np.sin(70 * ball.vertices[:, :1]) * np.cos(60 * ball.vertices[:, 1:2]))
    return ball


def write_splats(path, points, normals, spread, opacity, kind, random):
    """One splat per point, flat along the normal; opacity [n]."""
    n = len(points)
    z = normals / np.linalg.norm(normals, axis=1)[:, None]
    x = np.cross(z, random.normal(size=z.shape))
    x /= np.linalg.norm(x, axis=1)[:, None]
    q = Rotation.from_matrix(np.stack([x, np.cross(z, x), z], 2)).as_quat()  # x y z w
    color = np.clip(0.5 + 8 * points, 0.05, 0.95)
    columns = {"x": points[:, 0], "y": points[:, 1], "z": points[:, 2], "nx": np.zeros(n), "ny": np.zeros(n), "nz": np.zeros(n)}
    for k in range(3):
        columns[f"f_dc_{k}"] = (color[:, k] - 0.5) / 0.28209479177387814
    for k in range(45):
        columns[f"f_rest_{k}"] = random.normal(0, 0.01, n)
    columns["opacity"] = np.log(opacity / (1 - opacity))
    if kind == "TSGS":
        columns["transparency"] = np.zeros(n)
    columns["scale_0"] = np.log(spread * random.uniform(0.8, 1.2, n))
    columns["scale_1"] = np.log(spread * random.uniform(0.8, 1.2, n))
    if kind != "2DGS":
        columns["scale_2"] = np.log(spread * random.uniform(0.02, 0.2, n))
    for k, axis in enumerate([3, 0, 1, 2]):
        columns[f"rot_{k}"] = 2.5 * q[:, axis]  # files are not normalised
    if kind == "TSGS":
        for k in range(24):
            columns[f"f_asg_{k}"] = random.normal(size=n)
    table = np.empty(n, dtype=[(name, "f4") for name in columns])
    for name, values in columns.items():
        table[name] = values
    plyfile.PlyData([plyfile.PlyElement.describe(table, "vertex")]).write(str(path))


def read_obj(path):
    lines = [line.split() for line in path.read_text().splitlines()]
    return trimesh.Trimesh([[float(x) for x in w[1:]] for w in lines if w[0] == "v"],
                           [[int(x) - 1 for x in w[1:]] for w in lines if w[0] == "f"], process=False)


def distances(a, b):
    """Of points on a to b."""
    tree = cKDTree(trimesh.sample.sample_surface(b, 400000, seed=1)[0])
    return tree.query(trimesh.sample.sample_surface(a, 20000, seed=2)[0])[0]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("program")
    p.add_argument("folder", type=pathlib.Path)
    p.add_argument("--mesh")
    p.add_argument("--splats", type=int, default=20000)
    a = p.parse_args()
    a.folder.mkdir(parents=True, exist_ok=True)
    mesh = trimesh.load(a.mesh, force="mesh") if a.mesh else bumpy_ball()
    size = float(np.ptp(mesh.vertices, 0).max())
    points, faces = trimesh.sample.sample_surface(mesh, a.splats, seed=0)
    normals = mesh.face_normals[faces]
    spread = 0.8 * np.sqrt(mesh.area / a.splats)
    is_good = True
    for kind in ("3DGS", "2DGS", "TSGS"):
        random = np.random.default_rng(5)
        at, turned = points + random.normal(0, 0.002 * size, points.shape) * (kind == "3DGS"), normals
        opacity = np.full(len(points), 0.9)
        if kind == "TSGS":
            inner = trimesh.creation.icosphere(4, 0.2 * size)
            inner_points, inner_faces = trimesh.sample.sample_surface(inner, 3000, seed=3)
            at = np.vstack([at, inner_points + mesh.center_mass])
            turned = np.vstack([turned, inner.face_normals[inner_faces]])
            opacity = np.concatenate([0.12 * np.ones(len(points)), 0.95 * np.ones(len(inner_points))])
        source, out = a.folder / f"{kind}.ply", a.folder / kind
        write_splats(source, at, turned, spread, opacity, kind, random)
        run = subprocess.run([a.program, "capture", "object", source, "-o", out, "--density", "1000", "--json"], capture_output=True, text=True)
        if run.returncode != 0:
            print(f"{kind}: {run.stderr.strip()[-300:]}")
            is_good = False
            continue
        report = json.loads(run.stdout)
        visual = trimesh.load(out / "visual.glb", force="mesh", process=False)
        visual.vertices = visual.vertices[:, [0, 2, 1]] * [1, -1, 1]  # y up to z up
        solid = read_obj(out / "simulation.obj")
        seen, simulated = distances(visual, mesh), distances(solid, mesh)
        print(f"{kind}: surface off by {100 * seen.mean() / size:.2f} % of the size on the mean, {100 * np.percentile(seen, 95) / size:.2f} % at 95 %; "
              f"simulation mesh {100 * simulated.mean() / size:.2f} % ({report['mesh']['triangles']} triangles, volume {solid.volume / mesh.volume:.3f} of the truth)")
        is_good = is_good and seen.mean() < 0.01 * size and simulated.mean() < 0.01 * size
    sys.exit(0 if is_good else 1)


main()
