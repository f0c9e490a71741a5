"""Closed-loop evaluation: episodes of starts that no training has seen, rates with intervals, events, baselines."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass, field
from typing import Any, Iterable

from .environment import EVALUATION_SEED, planned_length
from .policies import Policy
from .server import Server
from .statistics import beta_interval, paired_difference, wilson

__all__ = ["EpisodeResult", "PolicyResult", "evaluate", "planned_length", "run_episode"]

LEAST_EPISODES, MOST_EPISODES = 10, 200  # of an evaluation that stops by itself


@dataclass(frozen=True)
class EpisodeResult:
    seed: int  # number of the start
    success: bool
    reason: str  # what speaks against success, a sentence; empty: nothing
    events: list[str] = field(default_factory=list)
    periods: int = 0


@dataclass(frozen=True)
class PolicyResult:
    policy: str
    episodes: list[EpisodeResult]

    @property
    def n_successes(self) -> int:
        return sum(episode.success for episode in self.episodes)

    def above(self, other: PolicyResult) -> dict[str, float | int]:
        """Paired difference to another policy, which had the same starts."""
        if [episode.seed for episode in self.episodes] != [episode.seed for episode in other.episodes]:
            raise ValueError(f"{self.policy} and {other.policy} had other starts; judge both on the same")
        return paired_difference([each.success for each in self.episodes], [each.success for each in other.episodes])

    def as_json(self) -> dict[str, Any]:
        n = len(self.episodes)
        low, high = wilson(self.n_successes, n)
        events = Counter(event for episode in self.episodes for event in set(episode.events))
        return {
            "episodes": n,
            "success": self.n_successes / n if n else 0.0,
            "low": low,
            "high": high,
            "beta": list(beta_interval(self.n_successes, n)),
            "events": dict(sorted(events.items())),
            "episodes_detail": [asdict(episode) for episode in self.episodes],
        }


def run_episode(
    server: Server, policy: Policy, start: int, length: int, set_seed: int, check_intersections: bool = False
) -> EpisodeResult:
    """From the start to `length` periods, or to a step that cannot be simulated. check_intersections: of surfaces,
    after each period."""
    seen = server.reset(set_seed, start, policy.cameras)
    policy.reset(seen)
    periods = 0
    is_intersected = False
    while periods < length and not seen.is_over:
        seen = policy.step(server, seen)
        periods += 1
        is_intersected = is_intersected or (check_intersections and server.intersection() != "")
    names = [event["name"] for event in seen.events]
    if server.facts.grasps and "grasped" not in names:
        names.append("never_grasped")
    if is_intersected:
        names.append("intersected")
    if seen.is_over:
        names.append("step_failed")
    return EpisodeResult(start, seen.is_success, seen.failure, names, periods)


def evaluate(
    server: Server,
    policy: Policy,
    episodes: int | None = None,
    width: float = 0.14,
    length: int | None = None,
    set_seed: int = EVALUATION_SEED,
    starts: Iterable[int] | None = None,
    check_intersections: bool = False,
) -> PolicyResult:
    """So many episodes, of starts 0, 1, ...; without a number until the 95 % interval (Wilson) is no wider than
    `width`, at least 10 and at most 200."""
    length = length or planned_length(server, set_seed)
    results: list[EpisodeResult] = []
    chosen = list(starts) if starts is not None else list(range(episodes or MOST_EPISODES))
    for start in chosen:
        results.append(run_episode(server, policy, start, length, set_seed, check_intersections))
        if episodes is None and starts is None and len(results) >= LEAST_EPISODES:
            low, high = wilson(sum(result.success for result in results), len(results))
            if high - low <= width:
                break
    return PolicyResult(policy.name, results)
