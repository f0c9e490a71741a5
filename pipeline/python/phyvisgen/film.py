"""Videos of episodes that failed: an evaluation is bit-exact, so the same starts run again, now with pictures."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from .environment import EVALUATION_SEED
from .evaluation import PolicyResult, run_episode
from .policies import Policy
from .server import Answer, ServeError, Server

__all__ = ["Filmed", "film_failures", "write_video"]


class Filmed:
    """A policy that acts as `policy` does, and keeps a picture of `camera` after each period."""

    def __init__(self, policy: Policy, camera: str) -> None:
        self.name, self.cameras = policy.name, policy.cameras
        self.pictures: list[NDArray[np.uint8]] = []  # [height, width, 3] sRGB each
        self._policy, self._camera = policy, camera

    def reset(self, start: Answer) -> None:
        self._policy.reset(start)

    def step(self, server: Server, seen: Answer) -> Answer:
        answer = self._policy.step(server, seen)
        self.pictures.append(server.observe([self._camera]).pictures[self._camera])
        return answer


def write_video(path: Path, pictures: Sequence[NDArray[np.uint8]], frames_per_second: float) -> None:
    """H.264 by the program ffmpeg; sizes are made even, as yuv420p wants. [n_frames, height, width, 3] sRGB"""
    height, width, _ = pictures[0].shape
    words = ["ffmpeg", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}"]
    words += ["-r", str(frames_per_second), "-i", "-", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-c:v", "libx264"]
    words += ["-bf", "0", "-pix_fmt", "yuv420p", str(path)]
    frames = b"".join(np.ascontiguousarray(picture).tobytes() for picture in pictures)
    try:
        done = subprocess.run(words, input=frames, capture_output=True)
    except FileNotFoundError as error:
        raise ServeError("videos are written by the program ffmpeg, which was not found; install it") from error
    if done.returncode != 0:
        raise ServeError(f"{path} could not be written: {done.stderr.decode(errors='replace').strip()}")


def film_failures(
    server: Server, policy: Policy, result: PolicyResult, folder: Path, camera: str, length: int, most: int
) -> list[Path]:
    """One video for each of the first `most` episodes of `result` that failed, `folder`/failure_START_CAMERA.mp4.

    server: renders, and serves the task that `result` was judged in. A policy that does not repeat what it did is an error.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for episode in [each for each in result.episodes if not each.success][:most]:
        filmed = Filmed(policy, camera)
        again = run_episode(server, filmed, episode.seed, length, EVALUATION_SEED)
        if again != episode:
            raise ServeError(
                f"{policy.name} did not repeat start {episode.seed} ({again.reason or 'it succeeds now'}; judged was: "
                f"{episode.reason}), so there is no video of its failure; let the policy draw no random numbers"
            )
        files.append(folder / f"failure_{episode.seed}_{camera}.mp4")
        write_video(files[-1], filmed.pictures, server.facts.frames_per_second)
    return files
