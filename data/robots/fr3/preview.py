"""Draws the arm at its home posture from four sides, shaded by its normals, into a PNG: a look at the meshes."""
import struct
import zlib

import numpy as np

HOME = (0.0, -0.35, 0.0, -2.2, 0.0, 1.9, 0.785)


def _transform(xyz, roll, angle):
    c, s = np.cos(roll), np.sin(roll)
    tilt = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.eye(4)
    matrix[:3, :3] = tilt @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    matrix[:3, 3] = xyz
    return matrix


def _fill(image, depth, points, colors):
    """One triangle with colours at its corners into image and depth; points in pixels and depth."""
    low = np.maximum(np.floor(points[:, :2].min(0)).astype(int), 0)
    high = np.minimum(np.ceil(points[:, :2].max(0)).astype(int) + 1, [image.shape[1], image.shape[0]])
    if (high <= low).any():
        return
    x, y = np.meshgrid(np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1]) + 0.5)
    (ax, ay), (bx, by), (cx, cy) = points[:, :2]
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if abs(area) < 1e-9:
        return
    w1 = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
    w2 = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
    w0 = 1 - w1 - w2
    z = w0 * points[0, 2] + w1 * points[1, 2] + w2 * points[2, 2]
    window = depth[low[1]:high[1], low[0]:high[0]]
    hit = (w0 >= 0) & (w1 >= 0) & (w2 >= 0) & (z > window)
    window[hit] = z[hit]
    color = w0[..., None] * colors[0] + w1[..., None] * colors[1] + w2[..., None] * colors[2]
    image[low[1]:high[1], low[0]:high[0]][hit] = color[hit]


def draw(file, joints, meshes, height=900, width=680):
    frames = [np.eye(4)]
    for (xyz, roll, *_), q in zip(joints, HOME):
        frames.append(frames[-1] @ _transform(xyz, roll, q))
    light = np.array([0.4, -0.5, 0.77])
    panels = []
    for azimuth, parts in ((-50, "visual"), (-10, "visual"), (120, "visual"), (-50, "collision")):
        a, e = np.radians(azimuth), np.radians(15)
        forward = np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
        right = np.array([-np.sin(a), np.cos(a), 0])
        up = np.cross(forward, right)
        image, depth = np.full((height, width, 3), 0.35), np.full((height, width), -1e9)
        for frame, (white, dark, hull) in zip(frames, meshes):
            chosen = [(white, 0.9), (dark, 0.15)] if parts == "visual" else [(hull, 0.8)]
            for (points, normals, triangles), albedo in chosen:
                world = points @ frame[:3, :3].T + frame[:3, 3]
                screen = np.stack([width / 2 + 900 * ((world - [0.22, 0, 0.42]) @ right),
                                   height / 2 - 900 * ((world - [0.22, 0, 0.42]) @ up), world @ forward], 1)
                if normals is None:
                    corner = world[triangles]
                    flat = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
                    n = np.repeat((flat / np.linalg.norm(flat, axis=1)[:, None])[:, None], 3, 1)
                else:
                    n = (normals @ frame[:3, :3].T)[triangles]
                shade = albedo * (0.25 + 0.75 * np.maximum(n @ light, 0)) + 0.3 * np.maximum(n @ forward, 0) ** 30
                for t, s in zip(triangles, shade):
                    _fill(image, depth, screen[t], np.repeat(s[:, None], 3, 1))
        panels.append(image)
    pixels = (255 * np.clip(np.concatenate(panels, 1), 0, 1) ** (1 / 2.2)).astype(np.uint8)
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    chunk = lambda tag, data: struct.pack(">I", len(data)) + tag + data + struct.pack(">I", zlib.crc32(tag + data))  # noqa
    header = struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 8, 2, 0, 0, 0)
    with open(file, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
