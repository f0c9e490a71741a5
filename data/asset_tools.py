"""What the asset scripts share: closed surfaces of boxes, turned profiles and extrusions; OBJ and PNG writers.

Lengths in metres, triangles counter-clockwise seen from outside. Run the scripts with a python3 that has numpy.
"""
import struct
import zlib

import numpy as np


class Surface:
    """points [n, 3, m], faces: triangles or quadrilaterals as tuples of indices, uvs [n, 2] or None (v = 0 at the top)."""

    def __init__(self, points, faces, uvs=None):
        self.points = np.asarray(points, float).reshape(-1, 3)
        self.faces = [tuple(int(i) for i in f) for f in faces]
        self.uvs = None if uvs is None else np.asarray(uvs, float).reshape(-1, 2)

    def moved(self, x=0.0, y=0.0, z=0.0):
        return Surface(self.points + [x, y, z], self.faces, self.uvs)

    def flipped(self):
        return Surface(self.points, [f[::-1] for f in self.faces], self.uvs)


def joined(*surfaces):
    points, faces, uvs, first = [], [], [], 0
    has_uvs = all(s.uvs is not None for s in surfaces)
    for s in surfaces:
        points.append(s.points)
        faces += [tuple(i + first for i in f) for f in s.faces]
        uvs.append(s.uvs if has_uvs else np.zeros((0, 2)))
        first += len(s.points)
    return Surface(np.concatenate(points), faces, np.concatenate(uvs) if has_uvs else None)


def box(low, high):
    (x0, y0, z0), (x1, y1, z1) = low, high
    points = [(x, y, z) for z in (z0, z1) for y in (y0, y1) for x in (x0, x1)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return Surface(points, faces)


def rectangle(corner, u, v, uv_box):
    """A rectangle with normal cross(u, v); uv_box: (u at corner, v at corner, u at far end, v at far end)."""
    corner, u, v = (np.asarray(a, float) for a in (corner, u, v))
    a, b, c, d = uv_box
    return Surface([corner, corner + u, corner + u + v, corner + v], [(0, 1, 2, 3)], [(a, b), (c, b), (c, d), (a, d)])


def turned(profile, segments, phase=0.5):
    """The profile [(radius, z), ...] turned about z. It starts and ends on the axis and has the solid on its left."""
    points, rings = [], []
    for radius, z in profile:
        if radius == 0:
            rings.append([len(points)] * segments)
            points.append((0.0, 0.0, z))
        else:
            angles = 2 * np.pi * (np.arange(segments) + phase) / segments
            rings.append(list(range(len(points), len(points) + segments)))
            points += [(radius * np.cos(a), radius * np.sin(a), z) for a in angles]
    faces = []
    for a, b in zip(rings, rings[1:]):
        for i in range(segments):
            j = (i + 1) % segments
            face = list(dict.fromkeys((a[i], a[j], b[j], b[i])))
            if len(face) > 2:
                faces.append(tuple(face))
    return Surface(points, faces)


def extruded(outline, low, high, axis=0):
    """A convex outline, counter-clockwise in the two axes after `axis`, extruded from low to high along `axis`."""
    n = len(outline)
    points = np.zeros((2 * n, 3))
    for k, level in enumerate((low, high)):
        points[k * n:(k + 1) * n, axis] = level
        points[k * n:(k + 1) * n, (axis + 1) % 3] = [p[0] for p in outline]
        points[k * n:(k + 1) * n, (axis + 2) % 3] = [p[1] for p in outline]
    faces = [tuple(range(n - 1, -1, -1)), tuple(range(n, 2 * n))]
    faces += [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return Surface(points, faces)


def rounded_rectangle(width, height, radius, steps=5):
    """Outline about the origin, counter-clockwise."""
    outline = []
    for k, (sx, sy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        for t in np.linspace(0, np.pi / 2, steps + 1):
            a = t + k * np.pi / 2
            outline.append((sx * (width / 2 - radius) + radius * np.cos(a), sy * (height / 2 - radius) + radius * np.sin(a)))
    return outline


def with_triangles(surface):
    """Quadrilaterals split along their shorter diagonal, larger polygons into a fan."""
    p, faces = surface.points, []
    for f in surface.faces:
        if len(f) == 4 and np.linalg.norm(p[f[1]] - p[f[3]]) < np.linalg.norm(p[f[0]] - p[f[2]]) - 1e-12:
            faces += [(f[0], f[1], f[3]), (f[1], f[2], f[3])]
        else:
            faces += [(f[0], f[i], f[i + 1]) for i in range(1, len(f) - 1)]
    return Surface(p, faces, surface.uvs)


def volume(surface):
    s = with_triangles(surface)
    a, b, c = (s.points[[f[k] for f in s.faces]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def mass_properties(surface, density):
    """mass [kg], centre [m], inertia about the centre [kg m^2] of a closed surface filled evenly."""
    s = with_triangles(surface)
    mass, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for f in s.faces:
        corners = s.points[list(f)]
        v = np.dot(corners[0], np.cross(corners[1], corners[2])) / 6 * density
        total = corners.sum(0)
        mass += v
        first += v * total / 4
        second += v / 20 * (np.outer(total, total) + corners.T @ corners)
    centre = first / mass
    second -= mass * np.outer(centre, centre)
    return mass, centre, np.trace(second) * np.eye(3) - second


def write_obj(path, surface, comment):
    s = with_triangles(surface)
    with open(path, "w") as file:
        file.write(f"# {comment}\n")
        for p in s.points:
            file.write("v %s\n" % " ".join(f"{c:.7g}" for c in p + 0.0))
        if s.uvs is not None:
            for u, v in s.uvs:
                file.write(f"vt {u:.6g} {1 - v:.6g}\n")  # OBJ counts v from the bottom
        for f in s.faces:
            file.write("f %s\n" % " ".join(f"{i + 1}/{i + 1}" if s.uvs is not None else str(i + 1) for i in f))


def write_png(path, rgb):
    """rgb [height, width, 3] uint8. Each row takes the filter (Sub, Up, Paeth) with the smallest sum of differences."""
    height, width, _ = rgb.shape
    flat = rgb.reshape(height, width * 3).astype(np.int16)
    above = np.vstack([np.zeros((1, width * 3), np.int16), flat[:-1]])
    left = np.hstack([np.zeros((height, 3), np.int16), flat[:, :-3]])
    corner = np.hstack([np.zeros((height, 3), np.int16), above[:, :-3]])
    estimate = left + above - corner
    da, db, dc = (np.abs(estimate - n) for n in (left, above, corner))
    paeth = np.where((da <= db) & (da <= dc), left, np.where(db <= dc, above, corner))
    kinds = {1: flat - left, 2: flat - above, 4: flat - paeth}
    costs = np.stack([np.abs(((d + 128) & 255) - 128).sum(1) for d in kinds.values()])
    rows = bytearray()
    for y, best in enumerate(costs.argmin(0)):
        kind = list(kinds)[best]
        rows += bytes([kind]) + (kinds[kind][y] & 255).astype(np.uint8).tobytes()

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)))
        file.write(chunk(b"sRGB", b"\0") + chunk(b"IDAT", zlib.compress(bytes(rows), 9)) + chunk(b"IEND", b""))
