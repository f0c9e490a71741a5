"""Rates with intervals, and how well a simulation foretells reality."""

from __future__ import annotations

import math
from typing import Sequence

from .counted import counted

__all__ = ["beta_interval", "paired_difference", "wilson"]

NORMAL_95 = 1.959963984540054  # quantile of the normal distribution, two-sided 95 %


def wilson(successes: int, n: int, z: float = NORMAL_95) -> tuple[float, float]:
    """Interval of a rate (Wilson 1927)."""
    if n == 0:
        return 0.0, 1.0
    rate, z2 = successes / n, z * z
    middle = (rate + z2 / (2 * n)) / (1 + z2 / n)
    half = z / (1 + z2 / n) * math.sqrt(rate * (1 - rate) / n + z2 / (4 * n * n))
    return max(0.0, middle - half), min(1.0, middle + half)


def beta_interval(successes: int, n: int, level: float = 0.95) -> tuple[float, float]:
    """Equal-tailed interval of a rate under Beta(k + 1, n - k + 1), the posterior of an even prior.

    For whole numbers the distribution function is that of a binomial one: I_x(k + 1, n - k + 1) is the probability of
    more than k successes in n + 1 trials (Johnson, Kotz, Balakrishnan 1995, Continuous Univariate Distributions 2, 25.2).
    """

    def below(rate: float) -> float:
        return sum(math.comb(n + 1, i) * rate**i * (1 - rate) ** (n + 1 - i) for i in range(successes + 1, n + 2))

    def quantile(probability: float) -> float:
        low, high = 0.0, 1.0
        for _ in range(60):  # halvings, to the last bit
            middle = (low + high) / 2
            low, high = (middle, high) if below(middle) < probability else (low, middle)
        return (low + high) / 2

    return quantile((1 - level) / 2), quantile((1 + level) / 2)


def paired_difference(first: Sequence[bool], second: Sequence[bool], z: float = NORMAL_95) -> dict[str, float | int]:
    """How much more often `first` succeeds than `second` on the same starts.

    gained, lost: starts at which only the first or only the second succeeds. low, high: Wald interval of the difference
    of paired rates with one start added to each of the two kinds (Bonett and Price 2012). p: two-sided sign test (McNemar, exact).
    """
    if len(first) != len(second):
        raise ValueError(f"{len(first)} and {counted(len(second), 'episode')} are no pairs; judge both on the same starts")
    n = len(first)
    gained = sum(a and not b for a, b in zip(first, second))
    lost = sum(b and not a for a, b in zip(first, second))
    more, less = (gained + 1) / (n + 2), (lost + 1) / (n + 2)
    half = z * math.sqrt((more + less - (more - less) ** 2) / (n + 2))
    tail = sum(math.comb(gained + lost, i) for i in range(min(gained, lost) + 1)) / 2 ** (gained + lost)
    return {
        "difference": (gained - lost) / n if n else 0.0,
        "low": max(-1.0, more - less - half),
        "high": min(1.0, more - less + half),
        "gained": gained,
        "lost": lost,
        "p": min(1.0, 2 * tail),
    }
