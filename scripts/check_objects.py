#!/usr/bin/env python3
"""Breaks meshes in many ways, has `phyvisgen capture object` mend them, and checks the results by manifold3d and fTetWild.

  check_objects.py PHYVISGEN FOLDER [--count 300] [--seed 0] [--fineness 50] [--large]

Needs numpy, scipy, trimesh, rtree, manifold3d, pytetwild and pyvista, which the last one imports
(scripts/python_env.sh objects numpy scipy trimesh rtree manifold3d pytetwild pyvista). Prints a line per kind.
"""
import argparse
import json
import os
import pathlib
import subprocess

import manifold3d
import numpy as np
import pytetwild
import trimesh

BASES = [lambda: trimesh.creation.icosphere(3, 0.05), lambda: trimesh.creation.box((0.1, 0.06, 0.03)).subdivide().subdivide().subdivide(),
         lambda: trimesh.creation.cylinder(0.03, 0.1, sections=40), lambda: trimesh.creation.torus(0.05, 0.018),
         lambda: trimesh.creation.annulus(0.03, 0.034, 0.08, sections=40), lambda: trimesh.creation.cone(0.04, 0.08, sections=30)]


def holes(v, f, r): return v, f[r.random(len(f)) > 0.05]
def flipped(v, f, r): return v, np.where((r.random(len(f)) < 0.4)[:, None], f[:, [0, 2, 1]], f)
def doubled(v, f, r): return np.vstack([v, v]), np.vstack([f, f + len(v)])
def crossing(v, f, r): return np.vstack([v, v + r.uniform(-0.03, 0.03, 3)]), np.vstack([f, f + len(v)])
def fins(v, f, r):
    k = r.integers(len(f), size=15)
    return np.vstack([v, 1.15 * v[f[k, 0]]]), np.vstack([f, np.stack([f[k, 0], f[k, 1], len(v) + np.arange(15)], 1)])
def noise(v, f, r): return v + r.normal(0, 4e-4, v.shape), f
def shells(v, f, r): return np.vstack([v, 0.5 * v, 0.4 * v + [0.15, 0, 0]]), np.vstack([f, f + len(v), f + 2 * len(v)])
def soup(v, f, r): return v[f].reshape(-1, 3), np.arange(3 * len(f)).reshape(-1, 3)
def needles(v, f, r): return np.vstack([v, v[:30]]), np.vstack([f, np.stack([np.arange(30), len(v) + np.arange(30), np.arange(30)], 1)])
def merged(v, f, r): return holes(*flipped(*crossing(*noise(v, f, r), r), r), r)


KINDS = [holes, flipped, doubled, crossing, fins, noise, shells, soup, needles, merged]


def write_obj(path, v, f):
    path.write_text("".join("v %.9g %.9g %.9g\n" % tuple(p) for p in v) + "".join("f %d %d %d\n" % tuple(t + 1) for t in f))


def read_obj(path):
    lines = [line.split() for line in path.read_text().splitlines()]
    return (np.array([[float(x) for x in w[1:]] for w in lines if w[0] == "v"]),
            np.array([[int(x) - 1 for x in w[1:]] for w in lines if w[0] == "f"]))


def edges_are_paired(faces):
    """Every directed edge stands there once, and so does its opposite."""
    edges = {(f[k], f[(k + 1) % 3]) for f in faces.tolist() for k in range(3)}
    return len(edges) == 3 * len(faces) and all((b, a) in edges for a, b in edges)


def tetrahedral_error(v, f):
    """By how much the tetrahedra that fTetWild fills the surface with differ from its volume, as a share; infinite where
    one of them is turned inside out. Its envelope of 0.1 % of the diagonal is the difference that is left."""
    nodes, tetrahedra = pytetwild.tetrahedralize(v, f.astype(np.int32), edge_length_fac=0.1, optimize=False, simplify=False,
                                                 num_threads=1)
    c = nodes[tetrahedra]
    volumes = np.einsum("ij,ij->i", c[:, 3] - c[:, 0], np.cross(c[:, 2] - c[:, 0], c[:, 1] - c[:, 0])) / 6
    enclosed = np.einsum("ij,ij->i", v[f[:, 0]], np.cross(v[f[:, 1]], v[f[:, 2]])).sum() / 6
    return abs(volumes.sum() / enclosed - 1) if volumes.min() >= 0 else np.inf


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("program")
    p.add_argument("folder", type=pathlib.Path)
    p.add_argument("--count", type=int, default=300)
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--fineness", type=float, default=50, help="details of the wrap along the size; 300 objects take some 5 min at 50")
    p.add_argument("--large", action="store_true", help="objects of 80 000 to 330 000 triangles instead")
    a = p.parse_args()
    a.folder.mkdir(parents=True, exist_ok=True)
    a.program, a.folder = pathlib.Path(a.program).resolve(), a.folder.resolve()
    os.chdir(a.folder)  # fTetWild leaves a file where it runs
    good, counts, worst, worst_filled = {}, {}, {}, 0
    for i in range(a.count):
        kind, random = KINDS[i % len(KINDS)], np.random.default_rng(a.seed + i)
        base = BASES[i // len(KINDS) % len(BASES)]()
        while a.large and len(base.faces) < 80000:
            base = base.subdivide()
        turn = trimesh.transformations.random_rotation_matrix(random.random(3))[:3, :3]
        v, f = kind(base.vertices @ turn.T, base.faces, random)
        source, out = a.folder / "source.obj", a.folder / "object"
        write_obj(source, v, f)
        run = subprocess.run([a.program, "capture", "object", source, "-o", out, "--density", "1000", "--triangles", "1500",
                              "--detail", "%g" % (1e3 * float(np.ptp(v, 0).max()) / a.fineness), "--json"],
                             capture_output=True, text=True)
        counts[kind.__name__] = counts.get(kind.__name__, 0) + 1
        if run.returncode != 0:
            print(f"{kind.__name__} {i}: {run.stderr.strip()[-200:]}", flush=True)
            continue
        report = json.loads(run.stdout)
        vertices, faces = read_obj(out / "simulation.obj")
        solid = manifold3d.Manifold(manifold3d.Mesh(vertices.astype(np.float32), faces.astype(np.uint32)))
        is_closed = edges_are_paired(faces)
        is_good = (is_closed and solid.status() == manifold3d.Error.NoError and solid.volume() > 0 and
                   report["mesh"]["self_intersections"] == 0)
        # four details of the wrap, which the program guarantees; sampled anew, since its own distances might be wrong
        size = float(np.ptp(v, 0).max())
        bound, told = 4 * size / a.fineness * (1 + 1e-4), report["distance"]
        samples = np.vstack([vertices, trimesh.sample.sample_surface(trimesh.Trimesh(vertices, faces, process=False), 2000, seed=i)[0]])
        far = float(trimesh.proximity.closest_point(trimesh.Trimesh(v, f, process=False), samples)[1].max())
        is_near = told["max"] <= told["bound"] <= bound and far <= 1.01 * told["bound"]  # a little between the program's own samples
        worst[kind.__name__] = max(worst.get(kind.__name__, 0), far / size)
        filled = tetrahedral_error(vertices, faces) if is_good else np.inf
        worst_filled = max(worst_filled, filled)
        if not (is_good and is_near and filled <= 0.01):
            print(f"{kind.__name__} {i}: closed {is_closed}, {solid.status()}, distance {told['max']:.3e}, sampled {far:.3e}, of "
                  f"{told['bound']:.3e}, tetrahedra {100 * filled:.2f} % off", flush=True)
            continue
        good[kind.__name__] = good.get(kind.__name__, 0) + 1
    for kind in counts:
        print(f"{kind}: {good.get(kind, 0)} of {counts[kind]}, at most {100 * worst.get(kind, 0):.2f} % of the size off", flush=True)
    print(f"{sum(good.values())} of {a.count}; volumes of fTetWild's tetrahedra at most {100 * worst_filled:.2f} % off")


main()
