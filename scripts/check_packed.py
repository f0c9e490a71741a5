"""Reads what `phyvisgen pack` wrote with h5py, pyarrow and zarr, as the loaders of each format do, and compares it with the
states files that it was made of. Arguments: episode set, folder with the packed sets lerobot, lerobot2, act, robomimic, zarr."""
import json
import re
import sys
from pathlib import Path

import h5py
import numpy as np
import pandas
import pyarrow.parquet
import zarr

SET, PACKED = Path(sys.argv[1]), Path(sys.argv[2])


def near(name, value, expected, tolerance=0.0):
    value, expected = np.asarray(value, float), np.asarray(expected, float)
    assert value.shape == expected.shape, f"{name}: shape {value.shape}, not {expected.shape}"
    error = np.abs(value - expected).max() if value.size else 0
    assert error <= tolerance, f"{name}: off by {error}"
    return error


class Source:
    """One episode of the set: what its rows must be, computed anew from states.h5."""

    def __init__(self, folder):
        with h5py.File(folder / "states.h5") as file:
            steps = file["frame_step"][:]
            names = [name.decode() for name in file["q"].attrs["names"]]
            links = [name.decode() for name in file["T_link"].attrs["names"]]
            bases = [i for i, name in enumerate(links) if name.split("/")[-1] == "gripper_base"]
            robots = [links[i][: -len("gripper_base")] for i in bases]  # "" or "left/", "right/"
            following = np.append(steps, steps[-1])  # of the start, then of each frame

            def rows(name):  # the start, then each frame
                return np.concatenate([file["start"][name][:][None], file[name][:][steps]])

            def numbers(rows):  # of each robot its arm's joints and its gripper's width
                columns = []
                for robot in robots:
                    own = [i for i, name in enumerate(names) if name.startswith(robot)]
                    slides = [i for i in own if names[i].endswith("_slide")]
                    columns += [rows[:, [i for i in own if i not in slides]], rows[:, slides].sum(1, keepdims=True)]
                return np.concatenate(columns, 1)

            self.state = numbers(rows("q"))
            self.action = numbers(file["a"][:][following])
            per_robot = self.state.shape[1] // len(robots)
            self.width = [self.state[:, (i + 1) * per_robot - 1] for i in range(len(robots))]
            base = [rows("T_link")[:, i] for i in bases]
            centers = re.findall(r"tool_center:\s+position: \[(.*?)\]", file.attrs["configuration"].decode())  # of each robot
            centers = [[float(x) for x in center.split(",")] for center in centers]
            assert len(centers) == len(base)
            self.tool = [b[:, :, :3] @ center + b[:, :, 3] for b, center in zip(base, centers)]
            self.tool_turn = [b[:, :, :3] for b in base]
            self.rigid = {name.decode(): rows("T_rigid")[:, i]
                          for i, name in enumerate(file["T_rigid"].attrs["names"])}
            self.pose = {name: np.concatenate([file["start/camera"][name]["T_world_camera"][:][None],
                                               file["camera"][name]["T_world_camera"][:]]) for name in file["camera"]}
        self.summary = json.loads((folder / "summary.json").read_text())
        self.n = len(steps) + 1


def check_lerobot(sources, root, version):
    info = json.loads((root / "meta/info.json").read_text())
    assert info["codebase_version"] == version
    assert info["total_episodes"] == len(sources) and info["total_frames"] == sum(s.n for s in sources)
    if version == "v3.0":
        tasks = pandas.read_parquet(root / "meta/tasks.parquet")
        assert tasks.index[0] == sources[0].summary["task"].replace("_", " "), tasks
        episodes = pyarrow.parquet.read_table(root / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
        stats = json.loads((root / "meta/stats.json").read_text())
        near("mean", stats["action"]["mean"], np.concatenate([s.action for s in sources]).mean(0), 1e-9)
    else:
        episodes = [json.loads(line) for line in (root / "meta/episodes.jsonl").read_text().splitlines()]
        lines = (root / "meta/episodes_stats.jsonl").read_text().splitlines()
        for source, line in zip(sources, lines):
            near("max", json.loads(line)["stats"]["action"]["max"], source.action.max(0), 1e-12)
    files = 0
    start = 0
    for i, source in enumerate(sources):
        place = dict(chunk_index=0, file_index=i, episode_chunk=0, episode_index=i)
        table = pyarrow.parquet.read_table(root / info["data_path"].format(**place))
        columns = table.to_pydict()
        assert set(columns) | {f"observation.images.{c}" for c in source.pose} == set(info["features"])
        near("state", columns["observation.state"], source.state, 1e-6)
        near("action", columns["action"], source.action, 1e-6)
        near("timestamp", columns["timestamp"], np.arange(source.n) / info["fps"], 1e-6)
        near("index", columns["index"], start + np.arange(source.n))
        near("episode_index", columns["episode_index"], np.full(source.n, i))
        assert episodes[i]["length"] == source.n and episodes[i]["episode_index"] == i
        for camera, pose in source.pose.items():
            near("pose", columns[f"camera.{camera}.T_world_camera"], pose.reshape(-1, 16), 1e-6)
            key = f"observation.images.{camera}"
            video = root / info["video_path"].format(video_key=key, **place)
            assert video.stat().st_size > 0
            if version == "v3.0":
                assert episodes[i][f"videos/{key}/from_timestamp"] == 0
        start += source.n
    for file in root.rglob("*.parquet"):
        pyarrow.parquet.read_table(file)
        files += 1
    return f"{files} Parquet files"


def check_act(sources, root):
    rows = max(s.n for s in sources)
    for i, source in enumerate(sources):
        # as ACT's EpisodicDataset and get_norm_stats read it
        with h5py.File(root / f"episode_{i}.hdf5") as file:
            assert file.attrs["sim"]
            qpos, qvel, action = file["/observations/qpos"][()], file["/observations/qvel"][()], file["/action"][()]
            assert qpos.shape == qvel.shape == action.shape == (rows, source.state.shape[1])
            near("qpos", qpos[: source.n], source.state, 1e-6)
            near("action", action[: source.n], source.action, 1e-6)
            near("padding", qpos[source.n :], np.repeat(qpos[source.n - 1 : source.n], rows - source.n, 0))
            assert file["is_pad"][()].sum() == rows - source.n
            for camera, size in source.summary["cameras"].items():
                image = file[f"/observations/images/{camera}"]
                assert image.shape == (rows, size["height"], size["width"], 3) and image.dtype == np.uint8
                assert image[rows // 2].std() > 0
    return f"{len(sources)} episodes of {rows} rows"


def check_robomimic(sources, root):
    with h5py.File(root / "demo.hdf5") as file:
        json.loads(file["data"].attrs["env_args"])
        assert file["data"].attrs["total"] == sum(s.n for s in sources)
        offset, scale = file["action_offset"][()], file["action_scale"][()]
        for i, source in enumerate(sources):
            demo = file[f"data/demo_{i}"]
            assert demo.attrs["num_samples"] == source.n
            actions = demo["actions"][()]
            assert np.abs(actions).max() <= 1
            near("actions", actions * scale + offset, source.action, 1e-9)
            near("next", demo["next_obs/robot0_joint_pos"][:-1], demo["obs/robot0_joint_pos"][1:])
            near("joints", demo["obs/robot0_joint_pos"], source.state, 1e-12)
            for robot, tool in enumerate(source.tool):
                near("hand", demo[f"obs/robot{robot}_eef_pos"], tool, 1e-6)
            assert demo["dones"][-1] == 1 and demo["dones"][()].sum() == 1
            for camera, size in source.summary["cameras"].items():
                image = demo[f"obs/{camera}_image"]
                assert image.shape == (source.n, size["height"], size["width"], 3)
                near("images", demo[f"next_obs/{camera}_image"][:-1], image[1:])
            for name, poses in source.rigid.items():
                near("object", demo[f"datagen_info/object_poses/{name}"][:, :3], poses, 1e-12)
            assert demo["datagen_info/eef_pose"].shape == (source.n, 4, 4)
        demos = {name.decode() for mask in file["mask"].values() for name in mask[()]}
        assert demos == set(file["data"].keys())
    return f"{len(sources)} demos"


def check_zarr(sources, root):
    with zarr.ZipStore(str(root / "dataset.zarr.zip"), mode="r") as store:
        data = zarr.open_group(store, mode="r")
        ends = data["meta/episode_ends"][:]
        near("ends", ends, np.cumsum([s.n for s in sources]))
        for robot in range(len(sources[0].tool)):
            of = f"data/robot{robot}_"
            near("position", data[of + "eef_pos"][:], np.concatenate([s.tool[robot] for s in sources]), 1e-6)
            near("width", data[of + "gripper_width"][:, 0], np.concatenate([s.width[robot] for s in sources]), 1e-6)
            turns = data[of + "eef_rot_axis_angle"][:].astype(float)
            for turn, expected in zip(turns, np.concatenate([s.tool_turn[robot] for s in sources])):
                angle = np.linalg.norm(turn)
                x, y, z = turn / max(angle, 1e-12)
                cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
                near("turn", np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross, expected, 1e-4)
            near("start", data[of + "demo_start_pose"][ends[-1] - 1, :3], sources[-1].tool[robot][0], 1e-6)
        image = data["data/camera0_rgb"]
        assert image.shape == (ends[-1], 224, 224, 3) and image.chunks == (1, 224, 224, 3)
        assert image[int(ends[-1]) - 1].std() > 0
    return f"{ends[-1]} rows"


sources = [Source(folder) for folder in sorted(SET.glob("episode_??????"))]
for name, check in {
    "lerobot": lambda root: check_lerobot(sources, root, "v3.0"),
    "lerobot2": lambda root: check_lerobot(sources, root, "v2.1"),
    "act": lambda root: check_act(sources, root),
    "robomimic": lambda root: check_robomimic(sources, root),
    "zarr": lambda root: check_zarr(sources, root),
}.items():
    print(f"check_packed: {name}: {check(PACKED / name)}, equal to the states files")
