"""The smallest task, and what tests share."""

from pathlib import Path

TASK = Path(__file__).resolve().parents[1] / "small_task/push_beaker.yaml"
PERIODS = 5  # of an episode, where its end does not matter
