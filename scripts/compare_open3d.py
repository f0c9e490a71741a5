#!/usr/bin/env python3
"""Fuses the depth pictures of a folder in the layout of 7-Scenes by `phyvisgen capture room` and by Open3D's voxel blocks,
in turns, and prints the processor time of a frame. Both find the blocks near each picture's surface and integrate it into
them; no photo is used.

  compare_open3d.py PHYVISGEN FOLDER [--turns 3] [--voxel 5]

Needs open3d 0.20 (scripts/python_env.sh open3d open3d==0.20.0). Open3D's blocks have 16 samples to each side by default; 8
are tried as well, as ours have.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile
import time

import numpy as np
import open3d

MAX_DEPTH = 4.0  # [m]


def ours(program, folder, voxel):
    """Processor time [ms] of a frame; the folder without its photos."""
    with tempfile.TemporaryDirectory() as scratch:
        depths = pathlib.Path(scratch) / "depths"
        depths.mkdir()
        for file in folder.iterdir():
            if ".color." not in file.name:
                (depths / file.name).symlink_to(file.resolve())
        command = [program, "capture", "room", depths, "-o", f"{scratch}/room", "--voxel", str(voxel), "--json"]
        report = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    return report["fusion"]["cpu_ms_per_frame"]


def read_frames(folder):
    frames = []
    for pose in sorted(folder.glob("frame-*.pose.txt")):
        depth = open3d.t.io.read_image(str(pose).replace("pose.txt", "depth.png")).as_tensor().numpy().copy()
        depth[depth == 65535] = 0  # nothing was measured
        frames.append((open3d.t.geometry.Image(open3d.core.Tensor(depth)),
                       open3d.core.Tensor(np.linalg.inv(np.loadtxt(pose)), open3d.core.float64)))
    return frames


def theirs(frames, intrinsics, voxel, side):
    """Processor time [ms] of a frame with blocks of `side` samples to each side."""
    blocks = 20000 if side == 16 else 120000
    grid = open3d.t.geometry.VoxelBlockGrid(("tsdf", "weight"), (open3d.core.float32, open3d.core.float32), (1, 1), 1e-3 * voxel,
                                            side, blocks, open3d.core.Device("CPU:0"))
    start = time.process_time()
    for depth, world_to_camera in frames:
        near = grid.compute_unique_block_coordinates(depth, intrinsics, world_to_camera, 1000.0, MAX_DEPTH, 4.0)
        grid.integrate(near, depth, intrinsics, world_to_camera, 1000.0, MAX_DEPTH, 4.0)
    return 1e3 * (time.process_time() - start) / len(frames)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--voxel", type=float, default=5, help="[mm]")
    arguments = parser.parse_args()
    frames = read_frames(arguments.folder)
    intrinsics = open3d.core.Tensor(np.loadtxt(arguments.folder / "camera-intrinsics.txt"), open3d.core.float64)
    ours(arguments.program, arguments.folder, arguments.voxel)  # compiles the kernels
    print(f"{len(frames)} frames, processor time of a frame [ms], ratio to ours")
    for turn in range(arguments.turns):
        here = ours(arguments.program, arguments.folder, arguments.voxel)
        there = {side: theirs(frames, intrinsics, arguments.voxel, side) for side in (8, 16)}
        print(f"turn {turn + 1}: phyvisgen {here:.1f}; " + "; ".join(
            f"Open3D {open3d.__version__}, blocks of {side}: {ms:.1f}, {ms / here:.2f}" for side, ms in there.items()), flush=True)


if __name__ == "__main__":
    main()
