"""A camera and what it sees of one body, written apart from the simulator: rays through a lens, tested against a box. The
body is the pendulum of models.py, pushed by a torque at its hinge. SI units, radians, z up.
"""
import functools
import math

import numpy as np

import models

FINE = 4  # rays per pixel, along each side
EDGE = 0.2  # how unsure a mask is of pixels that the body covers in part, one sigma of their share
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of linear red, green, blue


class Camera:
    """A pinhole that stands still, z of the world upwards in its pictures."""

    def __init__(self, width, height, field_of_view, position, look_at):
        """field_of_view: vertical."""
        self.width, self.height, self.position = width, height, np.array(position, float)
        self.focal = height / 2 / math.tan(field_of_view / 2)  # [pixels]
        forward = np.array(look_at) - self.position
        forward = forward / np.linalg.norm(forward)
        right = np.cross(forward, [0, 0, 1])
        right = right / np.linalg.norm(right)
        self.axes = np.array([right, np.cross(forward, right), forward])  # to the right, down, forward

    @functools.lru_cache(maxsize=4)
    def rays(self, k1):
        """Unit directions in the world [height FINE, width FINE, 3]; not a number where the lens sees nothing."""
        i, j = np.meshgrid(np.arange(self.width * FINE), np.arange(self.height * FINE))
        # no two rays of a pixel stand in one row or column, so that edges along the picture's are no worse than others
        x = ((i + (j % FINE + 0.5) / FINE) / FINE - self.width / 2) / self.focal
        y = ((j + (i % FINE + 0.5) / FINE) / FINE - self.height / 2) / self.focal
        seen = np.hypot(x, y)
        # seen = r (1 + k1 r^2), on the branch that begins at r = 0
        limit = math.sqrt(-1 / (3 * k1)) if k1 < 0 else math.inf
        r = np.minimum(seen, limit)
        for _ in range(50):
            r = np.clip(r - (r * (1 + k1 * r * r) - seen) / np.maximum(1 + 3 * k1 * r * r, 1e-9), 0, limit)
        r[abs(r * (1 + k1 * r * r) - seen) > 1e-9] = np.nan
        ratio = r / seen
        d = np.stack([x * ratio, y * ratio, np.ones_like(x)], axis=-1) @ self.axes
        return d / np.linalg.norm(d, axis=-1, keepdims=True)

    def coverage(self, k1, centre, turn, half):
        """Share of each pixel that a box covers [height, width]; turn: its axes as columns, half: of its sides."""
        rays = self.rays(k1)
        away = centre - self.position
        distance = np.linalg.norm(away)
        near = rays @ (away / distance) > math.sqrt(1 - (np.linalg.norm(half) / distance) ** 2)  # of its ball
        with np.errstate(divide="ignore"):
            slope = 1 / (rays[near] @ turn)
        a, b = (away @ turn - half) * slope, (away @ turn + half) * slope
        hit = np.zeros(near.shape)
        hit[near] = np.minimum(a, b).max(axis=1) < np.maximum(a, b).min(axis=1)
        return hit.reshape(self.height, FINE, self.width, FINE).mean(axis=(1, 3))

    def corner_distance(self):
        """Of the pixels' centres from the picture's [height, width], 1 in its corners."""
        x, y = np.arange(self.width) + 0.5 - self.width / 2, np.arange(self.height) + 0.5 - self.height / 2
        return np.hypot(*np.meshgrid(x, y)) / math.hypot(self.width / 2, self.height / 2)


class SeenPendulum(models.Pendulum):
    """The pendulum's cube as a camera sees it; what the camera has wrong is an effect, too."""

    def __init__(self, camera):
        self.camera = camera

    def pictures(self, start, times, effects, command):
        """Share of each pixel that the cube covers, one picture after the other [height, width]."""
        late = effects.get("clock_offset", {}).get("offset", 0)
        angles = models.Pendulum.see(self, start, np.maximum(times + late, 0), effects, command)[:, 0]
        k1 = effects.get("lens_distortion", {}).get("k1", 0)
        for q in angles:
            x, z = np.array([math.cos(q), 0, -math.sin(q)]), np.array([math.sin(q), 0, math.cos(q)])
            turn = np.column_stack([x, [0, 1, 0], z])
            yield self.camera.coverage(k1, -self.arm * z, turn, np.full(3, self.side / 2))


class MaskedPendulum(SeenPendulum):
    """Masks of the cube. Strengths are told from their moments, in units of the noise that each has."""

    def moments(self, share):
        """Means over the picture of share x^p y^q, x to the right and y down, +-1 at its edges."""
        height, width = share.shape
        x, y = (2 * np.arange(width) + 1) / width - 1, (2 * np.arange(height) + 1) / height - 1
        columns, rows = share.mean(axis=0), share.mean(axis=1)
        return np.array([share.mean(), (columns * x).mean(), (rows * y).mean(), (columns * x * x).mean(),
                         y @ share @ x / share.size, (rows * y * y).mean()])

    def mask(self, share, rng):
        """Pixels that the sensor takes for the cube's: those covered by more than a half, as it sees it."""
        is_edge = (share > 0) & (share < 1)
        return share + is_edge * rng.normal(0, EDGE, share.shape) > 0.5

    @functools.cached_property
    def noise(self):
        """Of the moments: whole pixels, and edges that are unsure."""
        rng = np.random.default_rng(1)
        shares = [next(self.pictures((q, 0), np.zeros(1), {}, None)) for q in np.linspace(-0.8, 0.8, 100)]
        return np.sqrt(np.mean([(self.moments(self.mask(share, rng)) - self.moments(share)) ** 2 for share in shares], axis=0))

    def see(self, start, times, effects, command=None):
        return np.array([self.moments(share) for share in self.pictures(start, times, effects, command)]) / self.noise

    def record(self, start, times, effects, command, rng):
        """Arrays of a file of masks, and its attributes."""
        masks = [self.mask(share, rng) for share in self.pictures(start, times, effects, command)]
        return {"part": np.array(masks, np.uint8)}, {"names": np.array(["nothing", "cube"], "S")}


class FilmedPendulum(SeenPendulum):
    """Pictures of the cube, matte, under an even sky: whatever side of it is seen, it has the sky's light times its albedo."""

    def __init__(self, camera, sky, albedo, pixel_noise):
        """pixel_noise: of linear light, one sigma."""
        super().__init__(camera)
        self.sky, self.albedo, self.pixel_noise = sky, albedo, pixel_noise

    def light(self, start, times, effects, command):
        """Linear, what is behind the lens [height, width], one picture after the other."""
        gain = effects.get("exposure", {}).get("gain", 1)
        falloff = 1 + effects.get("vignetting", {}).get("v1", 0) * self.camera.corner_distance() ** 2
        for share in self.pictures(start, times, effects, command):
            yield gain * falloff * self.sky * (1 - share * (1 - self.albedo))

    def noise_of_cells(self):
        """Of the mean luminance in a cell, one sigma."""
        n = self.camera.width * self.camera.height / 12
        return self.pixel_noise * np.linalg.norm(LUMINANCE) / math.sqrt(n)

    def see(self, start, times, effects, command=None):
        """Mean luminance of 4 x 3 cells, cut at white."""
        height, width = self.camera.height, self.camera.width
        return np.array([np.minimum(light, 1).reshape(3, height // 3, 4, width // 4).mean(axis=(1, 3)).ravel()
                         for light in self.light(start, times, effects, command)])

    def record(self, start, times, effects, command, rng):
        """Arrays of a file of pictures, and its attributes."""
        pictures = []
        for light in self.light(start, times, effects, command):
            linear = np.clip(light[..., None] + rng.normal(0, self.pixel_noise, (*light.shape, 3)), 0, 1)
            srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
            pictures.append(np.round(255 * srgb))
        return {"rgb": np.array(pictures, np.uint8)}, {}
