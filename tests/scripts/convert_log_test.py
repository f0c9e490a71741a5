#!/usr/bin/env python3
"""Tests of scripts/convert_log.py on logs that rosbags and ezc3d write. Argument: the program phyvisgen. Exit code 77 with the
reason where scripts/install_logs.sh was not run."""
import csv
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PYTHON = ROOT / ".venv-logs/bin/python"
CASE = ROOT / "data/hidden/driven_backlash_30x"
FIRST = 1_700_000_000_000_000_000  # of the logs [ns]
LATE = 4_000_000  # from stamp to arrival [ns]
if not PYTHON.exists():
    print("skipped: scripts/install_logs.sh was not run")
    sys.exit(77)
if pathlib.Path(sys.prefix) != ROOT / ".venv-logs":
    os.execv(PYTHON, [str(PYTHON), *sys.argv])

import ezc3d
import h5py
import numpy
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

PROGRAM = pathlib.Path(sys.argv.pop()).resolve()
STORE = get_typestore(Stores.ROS2_HUMBLE)
TYPE = STORE.types


def rows_of(path):
    with open(path, newline="") as stream:
        return [{name: float(cell) if cell else math.nan for name, cell in row.items()} for row in csv.DictReader(stream)]


def header(seconds):
    stamp = FIRST + round(1e9 * seconds)
    return TYPE["std_msgs/msg/Header"](TYPE["builtin_interfaces/msg/Time"](stamp // 10**9, stamp % 10**9), "base")


def joints(seconds, position):
    empty = numpy.zeros(0)
    return TYPE["sensor_msgs/msg/JointState"](header(seconds), ["shoulder"], numpy.array([position]), empty, empty)


def pose(seconds, x):
    point, turn = TYPE["geometry_msgs/msg/Point"](x, 0.5, -1.0), TYPE["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    return TYPE["geometry_msgs/msg/PoseStamped"](header(seconds), TYPE["geometry_msgs/msg/Pose"](point, turn))


def picture(seconds):
    blue_green_red = numpy.arange(24, dtype=numpy.uint8)
    return TYPE["sensor_msgs/msg/Image"](header(seconds), 2, 4, "bgr8", 0, 12, blue_green_red)


def write_bag(folder, run, plugin):
    """A run of the kept case as a robot would log it: joint states, commands, a pose every tenth sample, a picture."""
    rows = rows_of(CASE / run)
    with Writer(folder, version=9, storage_plugin=plugin) as bag:
        topics = {name: bag.add_connection(name, kind, typestore=STORE) for name, kind in {
            "/joint_states": "sensor_msgs/msg/JointState", "/joint_command": "sensor_msgs/msg/JointState",
            "/tip": "geometry_msgs/msg/PoseStamped", "/camera": "sensor_msgs/msg/Image"}.items()}
        messages = [(row["t"], "/joint_states", joints(row["t"], row["q"])) for row in rows if math.isfinite(row["q"])]
        messages += [(row["t"], "/joint_command", joints(row["t"], row["command"])) for row in rows]
        messages += [(row["t"], "/tip", pose(row["t"], row["command"])) for row in rows[::10]]
        messages += [(rows[0]["t"], "/camera", picture(rows[0]["t"])), (rows[9]["t"], "/camera", picture(rows[9]["t"]))]
        for time, topic, message in sorted(messages, key=lambda one: one[0]):
            raw = STORE.serialize_cdr(message, message.__msgtype__)
            bag.write(topics[topic], FIRST + round(1e9 * time) + LATE, raw)
    return rows


def convert(*arguments):
    return subprocess.run([str(ROOT / "scripts/convert_log.py"), *map(str, arguments)], text=True, capture_output=True)


class ConvertLog(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def converted(self, *arguments):
        done = convert(*arguments, "-o", self.folder / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.folder / "out"

    def test_bags_of_ros_become_a_recording_that_diagnose_reads(self):
        rows = write_bag(self.folder / "run_0", "run_0.csv", StoragePlugin.MCAP)
        write_bag(self.folder / "run_1", "run_3.csv", StoragePlugin.SQLITE3)
        out = self.converted(self.folder / "run_0/run_0.mcap", self.folder / "run_1")
        commands, measured = rows_of(out / "run_0.csv"), rows_of(out / "run_0_joint_states.csv")
        self.assertEqual([row["position/shoulder"] for row in commands], [row["command"] for row in rows])
        finite = [row for row in rows if math.isfinite(row["q"])]
        self.assertEqual([row["position/shoulder"] for row in measured], [row["q"] for row in finite])
        for read, row in zip(measured, finite):
            self.assertAlmostEqual(read["t"], row["t"] - rows[0]["t"], delta=1e-8)
        text = (out / "recording.yaml").read_text()
        self.assertIn("arrives 4.0 ms after its stamp", text)
        self.assertIn("{file: run_1.csv, role: held_out}", text)
        shutil.copy(CASE / "scene.yaml", out)
        checked = subprocess.run([str(PROGRAM), "diagnose", str(out), "--check"], text=True, capture_output=True)
        self.assertEqual(checked.returncode, 0, checked.stderr)

    def test_poses_and_pictures_keep_their_numbers(self):
        rows = write_bag(self.folder / "run_0", "run_0.csv", StoragePlugin.MCAP)
        out = self.converted(self.folder / "run_0/run_0.mcap")
        poses = rows_of(out / "run_0_tip.csv")
        self.assertEqual([row["pose/position/x"] for row in poses], [row["command"] for row in rows[::10]])
        self.assertEqual({row["pose/orientation/w"] for row in poses}, {1.0})
        with h5py.File(out / "run_0_camera.h5") as video:
            self.assertEqual(video["rgb"].shape, (2, 2, 4, 3))
            self.assertEqual(video["rgb"][0, 1, 0].tolist(), [14, 13, 12])  # blue first in the message
            self.assertAlmostEqual(video["time"][1], rows[9]["t"] - rows[0]["t"], delta=1e-8)

    def test_stamps_of_another_clock_give_way_to_arrivals(self):
        with Writer(self.folder / "run_0", version=9, storage_plugin=StoragePlugin.MCAP) as bag:
            topic = bag.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=STORE)
            for i in range(3):
                message = joints(1e6 + i, 0.5 * i)
                raw = STORE.serialize_cdr(message, message.__msgtype__)
                bag.write(topic, FIRST + 250_000_000 * i, raw)
        done = convert(self.folder / "run_0", "-o", self.folder / "out")
        self.assertIn("/joint_states: its stamps are 1e+06 s away from the log's clock; arrivals are used", done.stderr)
        self.assertEqual([row["t"] for row in rows_of(self.folder / "out/run_0.csv")], [0, 0.25, 0.5])

    def test_motion_capture_becomes_metres_with_gaps(self):
        log = ezc3d.c3d()
        log["parameters"]["POINT"]["RATE"]["value"] = [100]
        log["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
        log["parameters"]["POINT"]["LABELS"]["value"] = ["tip"]
        points = numpy.ones((4, 1, 5))
        points[:3, 0, :] = [[1000, 1010, numpy.nan, 1030, 1040], [0, 0, numpy.nan, 0, 0], [500, 500, numpy.nan, 500, 500]]
        log["data"]["points"] = points
        log.write(str(self.folder / "walk.c3d"))
        rows = rows_of(self.converted(self.folder / "walk.c3d") / "walk.csv")
        self.assertEqual([row["t"] for row in rows], [0, 0.01, 0.02, 0.03, 0.04])
        for read, metres in zip([row["tip/x"] for row in rows], [1.0, 1.01, math.nan, 1.03, 1.04]):
            self.assertTrue(math.isnan(read) if math.isnan(metres) else abs(read - metres) < 1e-7, read)

    def test_what_is_wrong_is_said_in_a_sentence(self):
        (self.folder / "text.mcap").write_text("no log")
        (self.folder / "text.c3d").write_text("no log")
        (self.folder / "text.txt").write_text("no log")
        write_bag(self.folder / "run_0", "run_0.csv", StoragePlugin.MCAP)
        log, out = self.folder / "run_0/run_0.mcap", self.folder / "out"
        for arguments, words in ((["text.mcap"], "cannot be read as a log of ROS"), (["text.c3d"], "as a C3D file"),
                                 (["text.txt"], "is no log that is known here"), (["none.mcap"], "does not exist"),
                                 ([log, "--table", "/joints"], "has no topic /joints"),
                                 ([log, log], "two logs have the same name")):
            done = convert(self.folder / arguments[0], *arguments[1:], "-o", out)
            self.assertEqual(done.returncode, 1, arguments)
            self.assertIn(words, done.stderr)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertFalse(out.exists())
        done = convert(log, "-o", self.folder / "text.txt/out")
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        self.assertIn("cannot be written", done.stderr)
        done = convert(log, "-o", self.folder)
        self.assertIn("overwrites nothing", done.stderr)


if __name__ == "__main__":
    unittest.main()
