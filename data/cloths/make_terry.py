#!/usr/bin/env python3
"""Writes terry.png (shade of a terry towel's loops, multiplies its colour) and terry_normal.png (their slopes).

One tile is 50 mm of cloth and repeats without a seam: rows of loops 1.6 mm apart along y, each loop a small bump of random
height and lean. Needs numpy.
"""
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, ".."))
import asset_tools as tools  # noqa: E402

SIZE, LOOPS = 256, 32  # pixels of the tile, loops along each side
DEPTH = 2.5            # of the loops, in pixels: how steep the normals are


def heights(rng):
    """[SIZE, SIZE] in [0, 1]: the highest of the loops that cover a pixel"""
    height = np.zeros((SIZE, SIZE))
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    pitch = SIZE / LOOPS
    for row in range(LOOPS):
        for column in range(LOOPS):
            cy = (row + 0.5 + rng.normal(0, 0.12)) * pitch
            cx = (column + 0.5 * (row % 2) + 0.5 + rng.normal(0, 0.15)) * pitch
            dy, dx = ((d + SIZE / 2) % SIZE - SIZE / 2 for d in (y - cy, x - cx))
            lean = rng.normal(0, 0.35)
            r2 = ((dx - lean * dy) / (0.42 * pitch)) ** 2 + (dy / (0.62 * pitch)) ** 2
            height = np.maximum(height, rng.uniform(0.7, 1.0) * np.sqrt(np.clip(1 - r2, 0, None)))
    return height


def main():
    height = heights(np.random.default_rng(5))
    shade = 0.62 + 0.38 * height
    srgb = (1.055 * shade ** (1 / 2.4) - 0.055) * 255
    tools.write_png(os.path.join(HERE, "terry.png"), np.repeat(srgb[:, :, None], 3, 2).round().astype(np.uint8))
    slope_x = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) * DEPTH / 2
    slope_y = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) * DEPTH / 2
    normal = np.stack([-slope_x, slope_y, np.ones_like(height)], 2)  # green up: v grows downward in the picture
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    tools.write_png(os.path.join(HERE, "terry_normal.png"), ((normal + 1) * 127.5).round().astype(np.uint8))


if __name__ == "__main__":
    main()
