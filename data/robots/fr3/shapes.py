"""Shapes: signed distance functions and the closed meshes made of them. A mesh is (points [n, 3], normals [n, 3],
triangles [m, 3]), counter-clockwise from outside. Lengths in metres."""
import numpy as np


def clean_float(value):
    return repr(float(value)) if value != int(value) else str(int(value))


def _frame(axis):
    """Two unit vectors orthogonal to axis and to each other; with axis they are right-handed."""
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    u = np.cross(helper, axis)
    u /= np.linalg.norm(u)
    return u, np.cross(axis, u), axis


def cylinder(a, b, radius, rounding):
    """Distance to a cylinder from a to b whose edges are rounded."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    length = np.linalg.norm(b - a)
    axis = (b - a) / length

    def distance(p):
        along = (p - (a + b) / 2) @ axis
        across = np.linalg.norm(p - (a + b) / 2 - along[..., None] * axis, axis=-1)
        d = np.stack([across - radius + rounding, np.abs(along) - length / 2 + rounding], -1)
        return np.linalg.norm(np.maximum(d, 0), axis=-1) + np.minimum(d.max(-1), 0) - rounding
    return distance


def capsule(a, b, radius_a, radius_b):
    """Distance (near the surface) to a segment swept by a sphere whose radius changes evenly."""
    a, b = np.asarray(a, float), np.asarray(b, float)

    def distance(p):
        t = np.clip(((p - a) @ (b - a)) / ((b - a) @ (b - a)), 0, 1)
        return np.linalg.norm(p - a - t[..., None] * (b - a), axis=-1) - (radius_a + t * (radius_b - radius_a))
    return distance


class Part:
    """A smooth union: fillets of about the given width where the members meet; cut off below z = floor."""

    def __init__(self, members, fillet, floor=None):
        self.members, self.fillet, self.floor = members, fillet, floor

    def distance(self, p):
        d = self.members[0](p)
        for member in self.members[1:]:
            e = member(p)
            h = np.maximum(self.fillet - np.abs(d - e), 0) / self.fillet
            d = np.minimum(d, e) - self.fillet * h ** 3 / 6  # cubic smooth minimum
        return d if self.floor is None else np.maximum(d, self.floor - p[..., 2])

    def gradient(self, p, step=1e-5):
        return np.stack([self.distance(p + step * e) - self.distance(p - step * e) for e in np.eye(3)], -1) / (2 * step)


def surface_net(part, cell):
    """Isosurface 0 by naive surface nets: a vertex in every cell that the surface crosses, a quad on every crossed edge."""
    box = np.array([[-0.2, -0.25, -0.3], [0.2, 0.25, 0.2]])
    n = np.ceil((box[1] - box[0]) / cell).astype(int) + 1
    grid = np.stack(np.meshgrid(*[box[0][k] + cell * np.arange(n[k]) for k in range(3)], indexing="ij"), -1)
    value = part.distance(grid)
    inside = value < 0
    corners = [(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    view = lambda array, c: array[c[0]:n[0] - 1 + c[0], c[1]:n[1] - 1 + c[1], c[2]:n[2] - 1 + c[2]]  # noqa: E731
    count = sum(view(inside, c).astype(int) for c in corners)
    crossed = (count > 0) & (count < 8)
    number = np.full(crossed.shape, -1)
    number[crossed] = np.arange(crossed.sum())
    cells = np.argwhere(crossed)
    points = box[0] + cell * (cells + 0.5)
    quads = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        lo = tuple(slice(0, n[k] - (k == axis)) for k in range(3))
        hi = tuple(slice(1, None) if k == axis else slice(0, n[k]) for k in range(3))
        edges = np.argwhere(inside[lo] != inside[hi])
        flip = inside[lo][tuple(edges.T)]
        around = []
        for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
            c = edges.copy()
            c[:, u] -= du
            c[:, v] -= dv
            around.append(number[tuple(c.T)])
        quad = np.stack(around, 1)
        quads.append(np.where(flip[:, None], quad, quad[:, ::-1]))
    return points, np.concatenate(quads)


def net_of(part, n_triangles):
    """A closed mesh of at most n_triangles: net, drawn to the surface and evened out."""
    cell = 0.006
    while True:
        points, quads = surface_net(part, cell)
        if 2 * len(quads) <= n_triangles:
            break
        cell *= 1.04
    neighbours = np.concatenate([quads, np.roll(quads, 1, 1)]).reshape(-1)
    others = np.concatenate([np.roll(quads, -1, 1), np.roll(np.roll(quads, 1, 1), -1, 1)]).reshape(-1)

    def project(p):
        for _ in range(8):
            g = part.gradient(p)
            p = p - part.distance(p)[:, None] * g / np.maximum((g * g).sum(1), 0.05)[:, None]
        return p
    points = project(points)
    first = quads.reshape(-1)
    second = np.roll(quads, -1, 1).reshape(-1)
    for _ in range(30):  # each vertex toward the mean of its neighbours, then back onto the surface
        total, degree = np.zeros_like(points), np.zeros(len(points))
        for i, j in ((first, second), (second, first)):
            np.add.at(total, i, points[j])
            np.add.at(degree, i, 1)
        points = project(points + 0.5 * (total / degree[:, None] - points))
    normals = part.gradient(points, 3e-3)  # a wide difference, so that shading is calm
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    # split every quad along its shorter diagonal
    q = points[quads]
    short = np.linalg.norm(q[:, 0] - q[:, 2], axis=1) <= np.linalg.norm(q[:, 1] - q[:, 3], axis=1)
    a = np.where(short[:, None], quads[:, [0, 1, 2]], quads[:, [0, 1, 3]])
    b = np.where(short[:, None], quads[:, [0, 2, 3]], quads[:, [1, 2, 3]])
    return points, normals, np.concatenate([a, b])


def lathe(a, b, profile, segments=40):
    """Turns a profile of (share of the way from a to b, radius) about the line; flat ends; creases keep their edge."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    u, v, axis = _frame(b - a)
    angle = 2 * np.pi * np.arange(segments) / segments
    spoke = np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v
    length = np.linalg.norm(b - a)
    rings = [(t * length, r) for t, r in profile]
    rings = [(rings[0][0], 0.0)] + rings + [(rings[-1][0], 0.0)]
    points, normals, triangles = [], [], []
    for (z0, r0), (z1, r1) in zip(rings[:-1], rings[1:]):
        slope = np.array([z1 - z0, -(r1 - r0)]) / max(np.hypot(z1 - z0, r1 - r0), 1e-12)
        start = sum(map(len, points))
        for z, r in ((z0, r0), (z1, r1)):
            points.append(a + z * axis + r * spoke)
            normals.append(slope[0] * spoke + slope[1] * axis)
        i = np.arange(segments)
        j = (i + 1) % segments
        if r0 > 0:
            triangles.append(start + np.stack([i, j, i + segments], 1))
        if r1 > 0:
            triangles.append(start + np.stack([j, j + segments, i + segments], 1))
    return np.concatenate(points), np.concatenate(normals), np.concatenate(triangles)


def ring_sweep(rings, segments):
    """Closed surface through rings (centre, axis, radius). The polygons have the area of their circles."""
    factor = np.sqrt(2 * np.pi / (segments * np.sin(2 * np.pi / segments)))
    direction = np.asarray(rings[-1][0], float) - np.asarray(rings[0][0], float)
    u0, _, _ = _frame(direction)
    points = []
    for center, axis, radius in rings:
        axis = np.asarray(axis, float) / np.linalg.norm(axis)
        axis = axis if axis @ direction > 0 else -axis
        u = u0 - (u0 @ axis) * axis
        u /= np.linalg.norm(u)
        v = np.cross(axis, u)
        angle = 2 * np.pi * (np.arange(segments) + 0.5) / segments
        points.append(np.asarray(center, float) + radius * factor * (np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v))
    triangles = []
    i = np.arange(segments)
    j = (i + 1) % segments
    for k in range(len(rings) - 1):
        lo, hi = k * segments, (k + 1) * segments
        triangles += [np.stack([lo + i, lo + j, hi + i], 1), np.stack([lo + j, hi + j, hi + i], 1)]
    fan = np.stack([np.zeros(segments - 2, int), i[1:-1], i[2:]], 1)
    triangles += [fan[:, ::-1], (len(rings) - 1) * segments + fan]
    return np.concatenate(points), None, np.concatenate(triangles)


def merge(meshes):
    points, normals, triangles, start = [], [], [], 0
    for p, n, t in meshes:
        points.append(p)
        normals.append(n)
        triangles.append(t + start)
        start += len(p)
    return np.concatenate(points), None if normals[0] is None else np.concatenate(normals), np.concatenate(triangles)


def write_obj(file, title, mesh, normals=True):
    points, directions, triangles = mesh
    lines = [f"# {title} [m]"]
    lines += ["v %.5f %.5f %.5f" % tuple(p) for p in points]
    if normals:
        lines += ["vn %.3f %.3f %.3f" % tuple(n) for n in directions]
        lines += ["f " + " ".join(f"{i}//{i}" for i in t + 1) for t in triangles]
    else:
        lines += ["f %d %d %d" % tuple(t + 1) for t in triangles]
    file.write_text("\n".join(lines) + "\n")
