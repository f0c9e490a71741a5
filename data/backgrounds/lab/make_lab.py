#!/usr/bin/env python3
"""Writes a small laboratory as a captured room would come: one textured mesh, its light baked into one picture.

The mesh: the bench (its top at z = 0), floor, walls and ceiling. The picture is 2048 x 1024, sRGB, made from noise and soft shapes.
"""
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", ".."))
import asset_tools as tools  # noqa: E402

# parts of the picture, in pixels: left, top, right, bottom
PARTS = {"bench": (0, 0, 1024, 1024), "back": (1024, 0, 2048, 416), "side": (1024, 416, 2048, 704), "floor": (1024, 704, 2048, 1024)}
SIZE = (2048, 1024)
FINER = 2  # pixels of the walls' and the floor's designs


def noise(rng, height, width, cells_y, cells_x):
    """Smooth values in [0, 1]: random ones on a coarse lattice, cosine interpolation between."""
    lattice = rng.random((cells_y + 1, cells_x + 1))
    y, x = np.linspace(0, cells_y - 1e-6, height), np.linspace(0, cells_x - 1e-6, width)
    iy, ix = y.astype(int), x.astype(int)
    fy, fx = ((1 - np.cos(np.pi * (t - t.astype(int)))) / 2 for t in (y, x))
    rows = lattice[iy] * (1 - fy[:, None]) + lattice[iy + 1] * fy[:, None]
    return rows[:, ix] * (1 - fx) + rows[:, ix + 1] * fx


def blurred(image, radius):
    """Three box filters: close to a Gaussian."""
    for _ in range(3):
        for axis in (0, 1):
            padded = np.concatenate([np.repeat(np.take(image, [0], axis), radius + 1, axis), image,
                                     np.repeat(np.take(image, [-1], axis), radius, axis)], axis)
            total = np.cumsum(padded, axis)
            n = image.shape[axis]
            upper = np.take(total, range(2 * radius + 1, 2 * radius + 1 + n), axis)
            image = (upper - np.take(total, range(n), axis)) / (2 * radius + 1)
    return image


def painted(height, width, color):
    return np.ones((height, width, 1)) * np.array(color, float)


def glow(height, width, y, x, spread):
    """Soft light around a point given in shares of the picture."""
    gy, gx = np.mgrid[0:height, 0:width]
    return np.exp(-(((gy / height - y) ** 2 + (gx / width - x) ** 2) / spread ** 2))[:, :, None]


def bench(rng):
    """Boards of oiled oak along x, each with its own grain; linear reflectance times light."""
    n, boards = 1024, 8
    wide = n // boards
    rows = []
    for _ in range(boards):
        # growth rings: warped stripes along the board, closer toward one edge; pores: short dark strokes
        warp = noise(rng, wide, n, 3, 2) * 5 + noise(rng, wide, n, 5, 9) * 1.1 + noise(rng, wide, n, 16, 30) * 0.25
        across = np.linspace(0, rng.uniform(5, 9), wide)[:, None]
        rings = 0.5 + 0.5 * np.sin(2 * np.pi * (across + warp))
        fibres = noise(rng, wide, n, wide, 60) - 0.5
        pores = (noise(rng, wide, n, wide, 160) > 0.86) * (0.4 + 0.6 * (1 - rings))
        tone = rng.uniform(0.86, 1.04) + 0.17 * (rings ** 2 - 0.4) + 0.13 * fibres - 0.16 * pores
        tone[-2:] *= 0.55  # the joint between boards
        tone[:1] *= 0.80
        hue = np.array([0.43, 0.285, 0.165]) * (1 + rng.uniform(-0.03, 0.03) * np.array([0.2, 0.6, 1.4]))
        rows.append(tone[:, :, None] * hue)
    wood = np.concatenate(rows)
    return wood * (0.78 + 0.40 * glow(n, n, 0.5, 0.55, 0.6))


def back_wall(rng):
    """A plain wall with two shelves of bottles and boxes, a little out of focus."""
    height, width = (FINER * n for n in (208, 512))
    wall = painted(height, width, (0.62, 0.63, 0.60)) * (0.95 + 0.05 * noise(rng, height, width, 12, 30)[:, :, None])
    skirt = FINER * 150
    wall[skirt:] = np.array([0.30, 0.36, 0.38]) * (0.95 + 0.05 * noise(rng, height - skirt, width, 6, 30)[:, :, None])
    colors = [(0.45, 0.20, 0.08), (0.10, 0.22, 0.42), (0.62, 0.60, 0.52), (0.16, 0.34, 0.20), (0.55, 0.45, 0.12), (0.25, 0.26, 0.30)]
    for shelf in (FINER * 92, FINER * 126):
        x = FINER * 40
        while x < width - FINER * 60:
            wide, tall = FINER * int(rng.integers(7, 18)), FINER * int(rng.integers(10, 25))
            color = np.array(colors[int(rng.integers(len(colors)))])
            shade = 0.6 + 0.4 * np.sin(np.linspace(0.3, 2.6, wide))[None, :, None]
            wall[shelf - tall:shelf, x:x + wide] = color * shade
            wall[shelf - tall + FINER * 3:shelf - tall + FINER * 6, x:x + wide] = (0.7, 0.7, 0.66)
            x += wide + FINER * int(rng.integers(2, 16))
        board, below = FINER * 5, FINER * 12
        wall[shelf:shelf + board, FINER * 30:width - FINER * 50] = (0.42, 0.31, 0.20)
        wall[shelf + board:shelf + below, FINER * 30:width - FINER * 50] *= 0.72
    return blurred(wall, FINER) * (0.62 + 0.45 * glow(height, width, 0.1, 0.45, 0.7))


def side_wall(rng):
    """A wall with a window at dusk."""
    f = FINER
    height, width = f * 144, f * 512
    wall = painted(height, width, (0.60, 0.61, 0.59)) * (0.96 + 0.04 * noise(rng, height, width, 10, 30)[:, :, None])
    wall[f * 20:f * 84, f * 180:f * 330] = painted(f * 64, f * 150, (0.55, 0.66, 0.80)) * np.linspace(1.1, 0.8, f * 64)[:, None, None]
    for x in (178, 252, 327):
        wall[f * 18:f * 86, f * x:f * (x + 5)] = (0.7, 0.7, 0.68)
    for y in (18, 82):
        wall[f * y:f * (y + 4), f * 178:f * 332] = (0.7, 0.7, 0.68)
    return blurred(wall, f) * (0.6 + 0.4 * glow(height, width, 0.3, 0.5, 0.6))


def floor(rng):
    height, width = FINER * 160, FINER * 512
    tiles = painted(height, width, (0.30, 0.30, 0.29)) * (0.9 + 0.15 * noise(rng, height, width, 40, 120)[:, :, None])
    for k in range(FINER):
        tiles[k::FINER * 32] *= 0.75
        tiles[:, k::FINER * 32] *= 0.75
    return blurred(tiles, FINER) * (0.55 + 0.3 * glow(height, width, 0.5, 0.5, 0.5))


def encoded(linear, rng):
    """Linear reflectance -> sRGB in steps of 2, with a trace of grain: a photograph's look at a small file size."""
    linear = np.clip(linear + (rng.random(linear.shape[:2]) - 0.5)[:, :, None] * 0.006, 0, 1)
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return (np.round(srgb * 255 / 2) * 2).clip(0, 255).astype(np.uint8)


def part(name):
    left, top, right, bottom = PARTS[name]
    w, h = SIZE
    return ((left + 1) / w, (top + 1) / h, (right - 1) / w, (bottom - 1) / h)


def room():
    x0, x1, y0, y1, z0, z1 = -1.3, 2.6, -1.8, 1.8, -0.8, 1.9
    b = part("bench")
    foot = (b[0], b[3] - 0.06, b[2], b[3])
    side, side_back, ceiling = part("side"), part("side"), (0.6, 0.02, 0.61, 0.03)
    walls = [
        tools.rectangle((x0, y0, z1), (0, y1 - y0, 0), (0, 0, z0 - z1), part("back")),
        tools.rectangle((x0, y1, z1), (x1 - x0, 0, 0), (0, 0, z0 - z1), side),
        tools.rectangle((x1, y0, z1), (x0 - x1, 0, 0), (0, 0, z0 - z1), side_back),
        tools.rectangle((x1, y1, z1), (0, y0 - y1, 0), (0, 0, z0 - z1), side)]
    walls = [w.flipped() for w in walls]
    bench_top = tools.rectangle((-0.40, -0.75, 0.0), (1.35, 0, 0), (0, 1.5, 0), (b[0], b[3], b[2], b[1]))
    apron = [tools.rectangle((-0.40, -0.75, -0.04), (1.35, 0, 0), (0, 0, 0.04), foot),
             tools.rectangle((0.95, -0.75, -0.04), (0, 1.5, 0), (0, 0, 0.04), foot),
             tools.rectangle((0.95, 0.75, -0.04), (-1.35, 0, 0), (0, 0, 0.04), foot),
             tools.rectangle((-0.40, 0.75, -0.04), (0, -1.5, 0), (0, 0, 0.04), foot)]
    ground = tools.rectangle((x0, y0, z0), (x1 - x0, 0, 0), (0, y1 - y0, 0), part("floor"))
    top = tools.rectangle((x0, y0, z1), (0, y1 - y0, 0), (x1 - x0, 0, 0), ceiling)
    return tools.joined(bench_top, *apron, ground, top, *walls)


def main():
    rng = np.random.default_rng(7)
    picture = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
    for name, draw in (("bench", bench), ("back", back_wall), ("side", side_wall), ("floor", floor)):
        left, top, right, bottom = PARTS[name]
        picture[top:bottom, left:right] = encoded(draw(rng), rng)
    tools.write_png(os.path.join(HERE, "lab.png"), picture)
    tools.write_obj(os.path.join(HERE, "lab.obj"), room(), "a room with a bench, written by make_lab.py [m]")


if __name__ == "__main__":
    main()
