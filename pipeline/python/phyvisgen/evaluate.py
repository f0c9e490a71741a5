"""`phyvisgen evaluate policy`: success of a policy in the loop, beside baselines."""

from __future__ import annotations

import argparse
import json
import re
import sys
from pathlib import Path
from typing import Any, NoReturn, Sequence

from .connection import RefusedError
from .counted import counted
from .evaluation import PolicyResult, evaluate, planned_length
from .environment import EVALUATION_SEED, chosen_cameras
from .film import film_failures
from .perturbation import Curve, Perturbed
from .policies import BlindMean, Demonstrations, Expert, NearestDemonstration, Policy
from .server import ServeError, Server

EXAMPLE = (
    "Examples: phyvisgen evaluate policy push.yaml --policy ws://localhost:8000 -n 20 --perturb friction=0.5:2 --points 3; "
    "phyvisgen evaluate policy push.yaml --policy blind --baseline expert --videos out/failures; "
    "phyvisgen evaluate policy push.yaml --policy expert -n 10 --baseline none --check-intersections"
)
BASELINES = ("blind", "nearest", "expert")
N_VIDEOS = 3  # of the first failures


class _Parser(argparse.ArgumentParser):
    """What is wrong in one sentence, without a page of usage before it."""

    def error(self, message: str) -> NoReturn:
        flag = re.fullmatch(r"argument (\S+): ignored explicit argument '(.*)'", message)
        if flag:
            message = f"{flag[1].split('/')[-1]} takes no value, but is given `{flag[2]}`; write it alone, or leave it out"
        self.exit(2, f"phyvisgen: {message}; `{self.prog} TASK --help` shows how\n")


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number from 1, but is `{text}`")
    return int(text)


def _share(text: str) -> float:
    try:
        share = float(text)
    except ValueError:
        share = 0.0
    if not 0 < share <= 1:
        raise argparse.ArgumentTypeError(f"must be above 0 and at most 1, but is `{text}`")
    return share


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="phyvisgen evaluate policy", description=__doc__, epilog=EXAMPLE)
    parser.add_argument("task", help="task file, or the name of one of the program's own")
    parser.add_argument("--policy", required=True, help="ws://HOST:PORT of an OpenPI server, lerobot:CHECKPOINT, or a baseline's name")
    parser.add_argument(
        "--baseline",
        action="append",
        choices=(*BASELINES, "none"),
        help="beside it; may be repeated (else expert and, with --demonstrations, blind and nearest)",
    )
    parser.add_argument("--demonstrations", help="episode set that blind and nearest go by")
    parser.add_argument("-n", "--episodes", type=_count, help="so many; else 10 to 200, until the interval is narrow")
    parser.add_argument("--width", type=_share, default=0.14, help="of the 95 %% interval at which to stop (0.14)")
    parser.add_argument("--length", type=_count, help="periods of an episode; else a quarter more than the planned motion")
    parser.add_argument("--camera", action="append", default=[], help="whose pictures the policy sees; may be repeated")
    parser.add_argument("--executed", type=_count, help="actions of each chunk that are done before the policy is asked")
    parser.add_argument("--instruction", help="what the robot is told; else the task's name in words")
    parser.add_argument("--picture-width", type=_count, help="[pixels]")
    parser.add_argument("--picture-height", type=_count, help="[pixels]")
    parser.add_argument("--samples", type=_count, help="per pixel")
    parser.add_argument("--fps", type=float, help="actions per second")
    parser.add_argument("--gripper", choices=("soft", "rigid"))
    parser.add_argument(
        "--perturb",
        action="append",
        default=[],
        metavar="NAME=LOW:HIGH",
        help="success over light, camera, friction, mass, stiffness, texture, background, latency or backlash, the same "
        "starts at each amount; may be repeated",
    )
    parser.add_argument("--points", type=_count, default=5, help="amounts from LOW to HIGH (5)")
    parser.add_argument(
        "--check-intersections",
        action="store_true",
        help="look after each period whether surfaces intersect, by an exact test: event `intersected`",
    )
    parser.add_argument("--videos", metavar="FOLDER", help=f"of the policy's first {N_VIDEOS} failures, by the first camera")
    parser.add_argument("--json", action="store_true")
    return parser


def _policy(name: str, words: argparse.Namespace, server: Server) -> Policy:
    if name.startswith(("ws://", "wss://")):
        from .openpi import OpenPiPolicy

        cameras = tuple(words.camera)
        prompt = words.instruction or server.facts.task.replace("_", " ")
        return OpenPiPolicy(name, prompt, cameras, words.executed)
    if name.startswith("lerobot:"):
        try:
            from .lerobot_policy import LeRobotPolicy
        except ImportError as error:
            raise ValueError(
                f"--policy {name} needs a Python with lerobot, and {sys.executable} lacks {error.name or error}: run "
                "scripts/install_lerobot.sh and name its interpreter in PVG_PYTHON"
            ) from error

        return LeRobotPolicy(name.removeprefix("lerobot:"), words.instruction or server.facts.task.replace("_", " "))
    if name == "expert":
        return Expert()
    if name not in BASELINES:
        raise ValueError(f"--policy {name} is neither ws://HOST:PORT nor lerobot:CHECKPOINT nor one of {', '.join(BASELINES)}")
    if not words.demonstrations:
        raise ValueError(f"{name} goes by demonstrations: name a set with --demonstrations")
    demonstrations = Demonstrations(words.demonstrations, server.facts)
    return BlindMean(demonstrations) if name == "blind" else NearestDemonstration(demonstrations)


def _baselines(words: argparse.Namespace) -> list[str]:
    """Names of the baselines beside the policy, each once."""
    if words.baseline is None:
        known = BASELINES if words.demonstrations else ("expert",)
        return [name for name in known if name != words.policy]
    if "none" not in words.baseline:
        return list(dict.fromkeys(words.baseline))
    if len(words.baseline) > 1:
        raise ValueError("--baseline none stands beside another --baseline; leave one of the two out")
    return []


def _sentence(result: PolicyResult) -> str:
    told = result.as_json()
    events = ", ".join(f"{name} {count}" for name, count in told["events"].items())
    return (
        f"{result.policy}: {result.n_successes} of {told['episodes']} succeeded, {100 * told['success']:.1f} % "
        f"(95 % interval by Wilson: {100 * told['low']:.1f} to {100 * told['high']:.1f} %)"
        + (f"; {events}" if events else "")
    )


def _difference(result: PolicyResult, other: PolicyResult) -> str:
    told = result.above(other)
    return (
        f"{result.policy} above {other.policy}: {100 * told['difference']:+.1f} % "
        f"(95 %: {100 * told['low']:+.1f} to {100 * told['high']:+.1f} %; gains {counted(told['gained'], 'start')}, "
        f"loses {told['lost']}; sign test p = {told['p']:.4f})"
    )


def _shows_pictures(words: argparse.Namespace) -> bool:
    """To the policy."""
    return bool(words.camera) or words.policy.startswith("lerobot:")


def _check_pictures(words: argparse.Namespace) -> None:
    """Whoever gave an option of pictures expects pictures."""
    if _shows_pictures(words) or words.videos:
        return
    for option in ("picture_width", "picture_height", "samples"):
        if getattr(words, option) is not None:
            raise ValueError(
                f"--{option.replace('_', '-')} is for pictures, and none are made; leave it out, or ask for pictures with "
                "--camera or --videos"
            )


def _server(words: argparse.Namespace, perturb: dict[str, float] | None = None, render: bool = False) -> Server:
    render = render or _shows_pictures(words)
    of_pictures = {"width": words.picture_width, "height": words.picture_height, "samples": words.samples}
    return Server(
        words.task,
        render=render,
        **(of_pictures if render else {}),
        fps=words.fps,
        gripper=words.gripper,
        perturb=perturb,
    )


def _curve(words: argparse.Namespace, policy: Policy, perturbed: Perturbed, starts: list[int], length: int) -> Curve:
    """The policy over the amounts, on the same starts; an episode lasts as long as in the task as it is."""
    results = []
    for amount in perturbed.amounts:
        with _server(words, {perturbed.quantity: amount}) as server:
            results.append(evaluate(server, policy, length=length, starts=starts))
    return Curve(perturbed, results)


def _videos(words: argparse.Namespace, policy: Policy, result: PolicyResult, length: int) -> list[str]:
    with _server(words, render=True) as server:
        cameras = words.camera or list(server.facts.cameras)
        if not cameras:
            raise ValueError(f"--videos: the task {server.facts.task} has no camera; give it one")
        return [str(file) for file in film_failures(server, policy, result, Path(words.videos), cameras[0], length, N_VIDEOS)]


def main(arguments: Sequence[str] | None = None) -> int:
    words = _parser().parse_args(arguments)
    try:
        _check_pictures(words)
        perturbed = [Perturbed.read(text, words.points) for text in words.perturb]
        with _server(words) as server:
            return _run(words, server, perturbed)
    except (ValueError, FileNotFoundError) as error:
        print(f"phyvisgen: {error}", file=sys.stderr)
        return 2
    except RefusedError:  # the program has said it
        return 1
    except ServeError as error:
        print(f"phyvisgen: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("phyvisgen: stopped; an evaluation keeps nothing, the same command begins again", file=sys.stderr)
        return 75


def _run(words: argparse.Namespace, server: Server, perturbed: list[Perturbed]) -> int:
    chosen_cameras(server.facts, words.camera)  # refuses one that there is not, also where the policy looks at none
    for each in perturbed:  # what the program refuses is said before the policy is judged
        _server(words, {each.quantity: each.amounts[0]}).close()
    length = words.length or planned_length(server, EVALUATION_SEED)
    policy = _policy(words.policy, words, server)
    baselines = {name: _policy(name, words, server) for name in _baselines(words)}
    if words.baseline is None and not words.demonstrations:
        print("phyvisgen: blind and nearest are left out; name a set with --demonstrations, by which they go", file=sys.stderr)
    checks = words.check_intersections
    result = evaluate(server, policy, words.episodes, words.width, length, check_intersections=checks)
    starts = [episode.seed for episode in result.episodes]  # the same for all, so that differences are paired
    beside = {name: evaluate(server, each, length=length, starts=starts, check_intersections=checks) for name, each in baselines.items()}
    curves = [_curve(words, policy, each, starts, length).as_json() for each in perturbed]
    videos = _videos(words, policy, result, length) if words.videos else []
    if words.json:
        told: dict[str, Any] = {"schema": 1, "task": server.facts.task, "policy": policy.name, **result.as_json()}
        told["baselines"] = {
            name: {**each.as_json(), "policy_above": result.above(each)} for name, each in beside.items()
        }
        told["perturbed"] = curves
        told["videos"] = videos
        print(json.dumps(told, indent=2))
        return 0
    for each in [result, *beside.values()]:
        print(_sentence(each))
    for each in beside.values():
        print(_difference(result, each))
    for episode in result.episodes:
        if not episode.success:
            print(f"  start {episode.seed}: {episode.reason}")
    for video in videos:
        print(f"  {video}")
    for curve in curves:
        for point in curve["points"]:
            print(f"{curve['quantity']} {point['amount']:g}: {100 * point['success']:.1f} % "
                  f"({100 * point['low']:.1f} to {100 * point['high']:.1f} %)")
        control = curve["control"]
        print(f"{curve['quantity']}: spread of rates {control['spread']:.3f}, of shuffled ones at most "
              f"{control['shuffled_spread_95']:.3f} in 95 of 100; p = {control['p']:.4f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
