"""Success over what a task is changed in, beside a control that says whether the change shows at all."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .evaluation import PolicyResult

__all__ = ["Curve", "Perturbed", "shuffled_control"]

N_SHUFFLES = 9999


@dataclass(frozen=True)
class Perturbed:
    """A quantity of `phyvisgen serve --perturb`, and the amounts at which success is looked at."""

    quantity: str
    amounts: tuple[float, ...]

    @staticmethod
    def read(text: str, n_points: int) -> Perturbed:
        """From NAME=LOW:HIGH; the amounts lie evenly, both ends among them."""
        name, equals, bounds = text.partition("=")
        try:
            low, high = (float(bound) for bound in bounds.split(":"))
        except ValueError:
            low, high = 0.0, 0.0
        if not name or not equals or not -np.inf < low < high < np.inf:
            raise ValueError(f"--perturb {text} is not NAME=LOW:HIGH, such as friction=0.5:2")
        if n_points < 2:
            raise ValueError(f"--points {n_points} is too few for a curve; name at least 2")
        return Perturbed(name, tuple(float(amount) for amount in np.linspace(low, high, n_points)))


@dataclass(frozen=True)
class Curve:
    perturbed: Perturbed
    results: list[PolicyResult]  # one per amount, all of the same starts

    def as_json(self) -> dict[str, Any]:
        successes = [[episode.success for episode in result.episodes] for result in self.results]
        points = [
            {"amount": amount, **result.as_json()} for amount, result in zip(self.perturbed.amounts, self.results)
        ]
        return {"quantity": self.perturbed.quantity, "points": points, "control": shuffled_control(successes)}


def shuffled_control(successes: ArrayLike, n_shuffles: int = N_SHUFFLES) -> dict[str, float]:
    """Whether success depends on the amount, by a permutation test.  [n_amounts, n_starts, bool]

    The spread of the success rates (standard deviation over the amounts) is compared with that where the amounts of
    each start's episodes are shuffled. p: how often a shuffle has at least the same spread, itself counted as one. A
    curve whose p is large says nothing of the quantity, whatever its shape.
    """
    table = np.asarray(successes, dtype=np.float64)
    generator = np.random.default_rng(0)
    spread = float(table.mean(axis=1).std())
    shuffled = np.array([generator.permuted(table, axis=0).mean(axis=1).std() for _ in range(n_shuffles)])
    p = (1 + np.count_nonzero(shuffled >= spread - 1e-12)) / (1 + n_shuffles)
    return {"spread": spread, "shuffled_spread_95": float(np.quantile(shuffled, 0.95)), "p": float(p)}
