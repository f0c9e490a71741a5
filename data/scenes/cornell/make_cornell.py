#!/usr/bin/env python3
"""Writes the meshes of Cornell's box with a turned block and a ball: quads and a sphere [m], z up.

Run in this folder: ./make_cornell.py
"""
import math


def write(name, points, faces):
    with open(name + ".obj", "w") as file:
        file.writelines("v %.9g %.9g %.9g\n" % point for point in points)
        file.writelines("f " + " ".join(str(i + 1) for i in face) + "\n" for face in faces)


def quad(name, corner, u, v):
    at = lambda s, t: tuple(c + s * a + t * b for c, a, b in zip(corner, u, v))
    write(name, [at(0, 0), at(1, 0), at(1, 1), at(0, 1)], [(0, 1, 2), (0, 2, 3)])


def block(name, size, angle, foot):
    c, s = math.cos(angle), math.sin(angle)
    points = []
    for i in range(8):
        x, y, z = ((i >> k & 1) - (0.5 if k < 2 else 0) for k in range(3))
        x, y, z = x * size[0], y * size[1], z * size[2]
        points.append((c * x - s * y + foot[0], s * x + c * y + foot[1], z + foot[2]))
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    write(name, points, [t for a, b, d, e in quads for t in ((a, b, d), (a, d, e))])


def ball(name, radius, centre, rows=48):
    points = [(centre[0], centre[1], centre[2] + radius)]
    for i in range(1, rows):
        for j in range(2 * rows):
            a, b = math.pi * i / rows, math.pi * j / rows
            points.append((centre[0] + radius * math.sin(a) * math.cos(b), centre[1] + radius * math.sin(a) * math.sin(b),
                           centre[2] + radius * math.cos(a)))
    points.append((centre[0], centre[1], centre[2] - radius))
    n, last = 2 * rows, len(points) - 1
    at = lambda i, j: 1 + i * n + j % n
    faces = [(0, at(0, j), at(0, j + 1)) for j in range(n)]
    for i in range(rows - 2):
        for j in range(n):
            faces += [(at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1))]
    faces += [(last, at(rows - 2, j + 1), at(rows - 2, j)) for j in range(n)]
    write(name, points, faces)


quad("floor", (-1, -1, 0), (2, 0, 0), (0, 2, 0))
quad("ceiling", (-1, -1, 2), (0, 2, 0), (2, 0, 0))
quad("back", (-1, 1, 0), (2, 0, 0), (0, 0, 2))
quad("left", (-1, -1, 0), (0, 2, 0), (0, 0, 2))
quad("right", (1, -1, 0), (0, 0, 2), (0, 2, 0))
block("block", (0.6, 0.6, 1.2), 0.3, (-0.35, 0.3, 0))
ball("ball", 0.3, (0.4, -0.2, 0.3))
