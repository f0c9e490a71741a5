"""Rates with intervals, and how well a simulation foretells reality."""

from __future__ import annotations

import math

__all__ = ["wilson"]

NORMAL_95 = 1.959963984540054  # quantile of the normal distribution, two-sided 95 %


def wilson(successes: int, n: int, z: float = NORMAL_95) -> tuple[float, float]:
    """Interval of a rate (Wilson 1927)."""
    if n == 0:
        return 0.0, 1.0
    rate, z2 = successes / n, z * z
    middle = (rate + z2 / (2 * n)) / (1 + z2 / n)
    half = z / (1 + z2 / n) * math.sqrt(rate * (1 - rate) / n + z2 / (4 * n * n))
    return max(0.0, middle - half), min(1.0, middle + half)
