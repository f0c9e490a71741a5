"""A number with its noun, in the singular where there is one: "1 episode", "2 episodes", "0 vertices"."""

from __future__ import annotations

__all__ = ["counted"]


def counted(n: int, one: str, many: str = "") -> str:
    """many: the plural where it is not the noun with an s"""
    return f"{n} {one if n == 1 else many or one + 's'}"
