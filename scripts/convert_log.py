#!/usr/bin/env python3
"""Makes a recording for `phyvisgen diagnose` of logs: ROS 1 and 2 (.bag, .db3, .mcap, a folder of a bag) and motion
capture (.c3d). Every log becomes a run.

    scripts/convert_log.py run_0.mcap run_1.mcap -o out/recording
    scripts/convert_log.py run_0.mcap -o out/recording --table /joint_command

Each topic becomes a CSV table (pictures an HDF5 file) with times in seconds from the log's first message:
RUN.csv is the topic of the commands, RUN_TOPIC.csv every other one. recording.yaml is a draft: joint states are its channels and commands its inputs,
all else stands there as a remark. Put the scene beside it as scene.yaml, name joints as the log does, and give or delete what you know better. The last run is
held out where there are two or more. Needs scripts/install_logs.sh."""
import argparse
import dataclasses
import os
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
COMMAND = re.compile(r"command|cmd|trajectory|desired|target|action", re.I)
KINDS = {"position": "position", "velocity": "rate", "effort": "torque"}  # of a JointState: a channel's


def use_environment():
    """Starts again with the interpreter of scripts/install_logs.sh unless this one has the packages."""
    try:
        import ezc3d, h5py, PIL, rosbags  # noqa: F401
    except ImportError:
        python = ROOT / ".venv-logs/bin/python"
        if not python.exists() or pathlib.Path(sys.prefix) == ROOT / ".venv-logs":
            sys.exit(f"convert_log.py needs the packages rosbags and ezc3d: run {ROOT}/scripts/install_logs.sh")
        os.execv(python, [str(python), *sys.argv])


def read_log(path):
    from logs import motion_capture, ros

    if not path.exists():
        sys.exit(f"{path} does not exist")
    if path.suffix.lower() == ".c3d":
        return motion_capture.read(path)
    if path.is_dir() or path.suffix in (".bag", ".db3", ".mcap"):
        return ros.read(path)
    sys.exit(f"{path} is no log that is known here: .bag, .db3, .mcap, a folder of a bag, .c3d")


def from_first(found):
    """The same with times from the first sample of any topic."""
    first = min(series.times[0] for series in found)
    return [dataclasses.replace(series, times=[time - first for time in series.times]) for series in found]


def main_table(found, asked, path):
    """The topic whose table is the run's: the one asked for, else commands, else the one with most samples."""
    tables = [series for series in found if series.columns]
    if not tables:
        sys.exit(f"{path} holds no topic with numbers")
    for series in tables:
        if asked == series.name:
            return series
    if asked:
        sys.exit(f"{path} has no topic {asked} with numbers; it has: {', '.join(series.name for series in tables)}")
    commands = [series for series in tables if COMMAND.search(series.name) and len(series.times) > 1]
    return max(commands or tables, key=lambda series: len(series.times))


def files_of(found, main):
    """Topic -> its file, where {run} stands for the run's name."""
    from logs.series import file_name

    return {series.name: "{run}.csv" if series is main else
            "{run}_" + file_name(series.name) + (".h5" if series.pictures else ".csv") for series in found}


def write_run(folder, run, found, main):
    from logs.series import write_pictures, write_table

    for series in found:
        path = folder / files_of(found, main)[series.name].replace("{run}", run)
        (write_pictures if series.pictures else write_table)(path, series)


def channel_lines(series, file, is_main):
    """Entries of `channels` and of `inputs` for a topic, as text of recording.yaml, and remarks."""
    channels, inputs, remarks = [], [], []
    place = "" if is_main else f', file: "{file}"'
    for column in series.columns:
        quantity, _, joint = column.partition("/")
        if series.kind.endswith("/JointState") and quantity in KINDS and joint:
            if is_main and COMMAND.search(series.name):
                if quantity != "effort":
                    inputs.append(f'{{column: "{column}", target: joint/{joint}/{quantity}}}')
            else:
                channels.append(f'{{column: "{column}", kind: {KINDS[quantity]}, joint: {joint}{place}, noise: unknown}}')
        elif is_main and column.startswith("points/positions/"):
            inputs.append(f'{{column: "{column}", target: joint/{column.split("/")[-1]}/position}}')
        else:
            remarks.append(column)
    return channels, inputs, remarks


def draft(runs, found, files, main):
    lines = ["# A draft of convert_log.py: name joints and bodies as the scene does, delete what the scene does not have.",
             "schema: 1", "scene: scene.yaml", "runs:"]
    for i, run in enumerate(runs):
        role = "held_out" if i + 1 == len(runs) and len(runs) > 1 else "fit"
        lines.append(f"  - {{file: {run}.csv, role: {role}}}")
    channels, inputs, remarks = [], [], []
    for series in found:
        more_channels, more_inputs, columns = channel_lines(series, files[series.name], series is main)
        channels += more_channels
        inputs += more_inputs
        late = "" if series.delay != series.delay else f", arrives {1e3 * series.delay:.1f} ms after its stamp (median)"
        remarks.append(f"# {series.name} ({series.kind}), {files[series.name]}: {len(series.times)} samples, "
                       f"{series.rate():.4g} Hz{late}" + (": " + ", ".join(columns[:24]) if columns else ""))
    if inputs:
        lines += ["inputs:"] + [f"  - {line}" for line in inputs]
    lines += ["channels:"] + [f"  - {line}" for line in channels] if channels else ["channels: []  # choose of these:"]
    return "\n".join(lines + ["initial: first_sample", "", "# What the logs hold:"] + remarks) + "\n"


def write_recording(folder, names, read):
    """read: of each log its name, topics and the one of the run's table; the draft, which comes last, is of the first log"""
    folder.mkdir(parents=True)
    for run, found, table in read:
        write_run(folder, run, found, table)
    _, found, table = read[0]
    (folder / "recording.yaml").write_text(draft(names, found, files_of(found, table), table))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("logs", nargs="+", type=pathlib.Path, metavar="LOG")
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path, help="a folder that does not exist yet")
    parser.add_argument("--table", help="the topic of the commands, whose times are those of the run's table")
    given = parser.parse_args()
    use_environment()
    if given.output.exists():
        sys.exit(f"{given.output} exists; convert_log.py overwrites nothing: give a folder that does not")
    names = [log.stem for log in given.logs]
    if len(set(names)) < len(names):
        sys.exit("two logs have the same name; runs are named by their files")
    read = []
    for log in given.logs:
        found, left_out = read_log(log)
        for sentence in left_out:
            print(f"note: {log}: {sentence}", file=sys.stderr)
        if not found:
            sys.exit(f"{log} holds nothing that can be measured")
        found = from_first(found)
        read.append((log.stem, found, main_table(found, given.table, log)))
    try:
        write_recording(given.output, names, read)
    except OSError as error:
        sys.exit(f"{given.output} cannot be written: {error.strerror or error}; what is there of it is not whole")
    print(given.output / "recording.yaml")


if __name__ == "__main__":
    main()
