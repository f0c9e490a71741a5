#!/usr/bin/env python3
"""Breaks meshes in many ways, has `phyvisgen capture object` mend them, and checks the results by manifold3d and fTetWild.

  check_objects.py PHYVISGEN FOLDER [--count 300] [--seed 0] [--fineness 50] [--large [N]] [--sound N]

Needs numpy, scipy, trimesh, rtree, manifold3d, pytetwild and pyvista, which the last one imports
(scripts/python_env.sh objects numpy scipy trimesh rtree manifold3d pytetwild pyvista). Prints a line per fault and per kind.
The same command continues a run that was stopped: FOLDER/cases.jsonl keeps what every case gave.
"""
import argparse
import hashlib
import json
import os
import pathlib
import resource
import subprocess
import time

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


def broken_mesh(kind, index, arguments):
    """Points and faces of a case, from its own random numbers alone."""
    random = np.random.default_rng(arguments.seed + index)
    base = BASES[index // len(KINDS) % len(BASES)]()
    while len(base.faces) < arguments.large:
        base = base.subdivide()
    turn = trimesh.transformations.random_rotation_matrix(random.random(3))[:3, :3]
    return kind(base.vertices @ turn.T, base.faces, random)


def bumpy_ball(n):
    """A sound ball of 0.1 m with bumps of 5 % of its radius and at least n triangles (20 times a power of 4)."""
    ball = trimesh.creation.icosphere(max(0, int(np.ceil(np.log(n / 20) / np.log(4)))), 1)
    x, y, z = ball.vertices.T
    return 0.05 * ball.vertices * (1 + 0.05 * np.sin(9 * x) * np.sin(8 * y) * np.cos(7 * z))[:, None], ball.faces


def check_mesh(name, index, v, f, bound, options, arguments):
    """Mends one mesh and checks it. bound: that the program must keep, as a share of the size.
    {index, kind, fault (none: ""), far (share of the size), filled, triangles, seconds (of processor), clock [s]}."""
    source, out = arguments.folder / "source.obj", arguments.folder / "object"
    write_obj(source, v, f)
    size, before, start = float(np.ptp(v, 0).max()), resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    run = subprocess.run([arguments.program, "capture", "object", source, "-o", out, "--density", "1000", "--json", *options],
                         capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    case = {"index": index, "kind": name, "fault": "", "far": 0, "filled": 0, "triangles": len(f),
            "seconds": after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, "clock": time.monotonic() - start}
    if run.returncode != 0:
        return case | {"fault": run.stderr.strip()[-200:] or f"exit code {run.returncode}"}
    report = json.loads(run.stdout)
    vertices, faces = read_obj(out / "simulation.obj")
    solid = manifold3d.Manifold(manifold3d.Mesh(vertices.astype(np.float32), faces.astype(np.uint32)))
    is_closed = edges_are_paired(faces)
    is_good = (is_closed and solid.status() == manifold3d.Error.NoError and solid.volume() > 0 and
               report["mesh"]["self_intersections"] == 0)
    # sampled anew, since the program's own distances might be wrong
    told = report["distance"]
    samples = np.vstack([vertices, trimesh.sample.sample_surface(trimesh.Trimesh(vertices, faces, process=False), 2000, seed=index)[0]])
    far = float(trimesh.proximity.closest_point(trimesh.Trimesh(v, f, process=False), samples)[1].max())
    # a little between the program's own samples
    is_near = told["max"] <= told["bound"] <= bound * size * (1 + 1e-4) and far <= 1.01 * told["bound"]
    filled = tetrahedral_error(vertices, faces) if is_good else np.inf
    case |= {"far": far / size, "filled": filled}
    if not (is_good and is_near and filled <= 0.01):
        case["fault"] = (f"closed {is_closed}, {solid.status()}, distance {told['max']:.3e}, sampled {far:.3e}, of "
                         f"{told['bound']:.3e}, tetrahedra {100 * filled:.2f} % off")
    return case


def check_broken(index, arguments):
    kind = KINDS[index % len(KINDS)]
    v, f = broken_mesh(kind, index, arguments)
    detail = float(np.ptp(v, 0).max()) / arguments.fineness
    # four details of the wrap, which the program guarantees
    return check_mesh(kind.__name__, index, v, f, 4 / arguments.fineness, ["--triangles", "1500", "--detail", "%g" % (1e3 * detail)], arguments)


def known_cases(arguments):
    """Cases of an earlier run that was stopped. cases.jsonl holds what was asked, then a line per case."""
    record = arguments.folder / "cases.jsonl"
    asked = {"seed": arguments.seed, "fineness": arguments.fineness, "large": arguments.large,
             "program": hashlib.sha256(arguments.program.read_bytes()).hexdigest()}
    if not record.exists():
        record.write_text(json.dumps(asked) + "\n")
    lines = [json.loads(line) for line in record.read_text().splitlines()]
    if lines[0] != asked:
        raise SystemExit(f"{record} belongs to another program or other options ({lines[0]}): take another folder")
    return {case["index"]: case for case in lines[1:]}


def tell(cases):
    for kind in dict.fromkeys(case["kind"] for case in cases):
        of_kind = [case for case in cases if case["kind"] == kind]
        print(f"{kind}: {sum(not case['fault'] for case in of_kind)} of {len(of_kind)}, at most "
              f"{100 * max(case['far'] for case in of_kind):.2f} % of the size off")
    print(f"{sum(not case['fault'] for case in cases)} of {len(cases)}; volumes of fTetWild's tetrahedra at most "
          f"{100 * max(case['filled'] for case in cases):.2f} % off; at most "
          f"{max(case['seconds'] for case in cases):.1f} s of processor time, {max(case['clock'] for case in cases):.1f} s by the "
          f"clock, {max(case['triangles'] for case in cases)} triangles")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("program", type=pathlib.Path)
    p.add_argument("folder", type=pathlib.Path)
    p.add_argument("--count", type=int, default=300)
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--fineness", type=float, default=50, help="details of the wrap along the size; 300 objects take some 5 min at 50")
    p.add_argument("--large", type=int, nargs="?", const=80000, default=0, metavar="N",
                   help="objects of at least N (80 000) triangles instead, less than four times as many")
    p.add_argument("--sound", type=int, metavar="N", help="instead: a sound bumpy ball of at least N triangles to 5000")
    a = p.parse_args()
    a.folder.mkdir(parents=True, exist_ok=True)
    a.program, a.folder = a.program.resolve(), a.folder.resolve()
    os.chdir(a.folder)  # fTetWild leaves a file where it runs
    if a.sound:
        case = check_mesh("sound", 0, *bumpy_ball(a.sound), 0.02, ["--triangles", "5000"], a)
        print(case["fault"], flush=True)
        tell([case])
        return
    known = known_cases(a)
    for i in range(a.count):
        if i in known:
            continue
        known[i] = check_broken(i, a)
        if known[i]["fault"]:
            print(f"{known[i]['kind']} {i}: {known[i]['fault']}", flush=True)
        with open("cases.jsonl", "a") as record:
            record.write(json.dumps(known[i]) + "\n")
    tell([known[i] for i in range(a.count)])


main()
