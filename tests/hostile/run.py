"""Runs the hostile table (rows_*.py): each row in a folder of its own, with a copy of the fixtures that it needs.

Arguments: PROGRAM [--only WORD] [--jobs N] [--list]. A row fails where the exit code or the sentence is another, a
signal ended the program, it took more than 10 s, a message of a library shows, an input changed, or a file appeared
that the row does not name.
"""
import argparse
import concurrent.futures
import fnmatch
import glob
import hashlib
import importlib
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import fixtures
from table import DONE, TABLE

# what a program says of the rows that it cannot judge
LACKING = "this program was built without OpenCV and the AprilTag library"
# how libraries speak; none of it may reach a user
RAW = [r"\[json\.exception", r"filesystem error", r"std::", r"bad_alloc", r"libpng", r"libjpeg", r"vector::", r"_M_range_check",
       r"basic_string", r"terminate called", r"what\(\)", r"HDF5-DIAG", r"yaml-cpp", r"YAML::", r"tinygltf", r"bad conversion",
       r"bad file", r"Assertion", r"Sanitizer", r"core dumped", r"Segmentation", r"__n \(which", r"pocl error", r"\bCL_[A-Z_]{4,}",
       r"Error=XML_"]


def snapshot(folder):
    found = {}
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if path.is_symlink():
            found[name] = "link " + os.readlink(path)
        elif path.is_file():
            found[name] = hashlib.sha256(path.read_bytes()).hexdigest()
        else:
            found[name] = "folder"
    return found


def may(name, globs):
    return any(fnmatch.fnmatch(name, g) or fnmatch.fnmatch(name, g + "/*") for g in globs)


def is_ours(line):
    return line.startswith("phyvisgen: ")


def judge(row, code, out, err, seconds, before, after):
    """What is wrong with how the program answered, in sentences."""
    wrong = []
    text = err if row.code != DONE else out + err
    if seconds > row.seconds:
        wrong.append(f"took {seconds:.1f} s")
    if code < 0 or (code > 128 and code != row.code):
        wrong.append(f"was ended by signal {-code if code < 0 else code - 128}")
    elif code != row.code:
        wrong.append(f"exit code {code} instead of {row.code}")
    if not re.search(row.pattern, text, re.S):
        wrong.append(f"says nothing of /{row.pattern}/")
    for raw in RAW:
        if re.search(raw, out + err):
            wrong.append(f"shows a library's message: {raw}")
    sentences = [line for line in err.splitlines() if is_ours(line)]
    if row.code != DONE and not row.shell and not (1 <= len(sentences) <= 1 + row.notes):
        wrong.append(f"{len(sentences)} sentences instead of one")
    for name in sorted(before.keys() | after.keys()):
        if before.get(name) == after.get(name):
            continue
        if name not in before:
            if ".partial" in name or not may(name, row.makes):
                wrong.append(f"left {name} behind")
        elif not may(name, row.changes):
            wrong.append(f"{'changed' if name in after else 'removed'} {name}")
    return wrong


def run_row(row, program, store, scratch):
    # two levels down, so that what escapes by `..` is seen, too
    outer = pathlib.Path(tempfile.mkdtemp(dir=scratch))
    folder = outer / "in" / "here"
    folder.mkdir(parents=True)
    for need in row.needs:
        shutil.copytree(store / need, folder, dirs_exist_ok=True)
    try:
        for step in row.steps:
            step(folder)
    except Exception as error:  # the row itself is wrong
        return row, [f"could not be prepared: {error!r}"], "", "", 0.0
    before = snapshot(outer)
    before = {str(pathlib.Path(name).relative_to("in/here")) if name.startswith("in/here/") else "OUTSIDE/" + name: value
              for name, value in before.items()}
    environment = {**os.environ, "LC_ALL": "C.UTF-8", "B": program, **row.environment}
    environment = {key: value for key, value in environment.items() if value is not None}
    arguments = ["bash", "-c", row.shell] if row.shell else [program, *shlex.split(row.command)]
    start = time.monotonic()
    process = subprocess.Popen(arguments, cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
    try:
        out, err = process.communicate(timeout=1.2 * row.seconds)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)  # a session of its own, begun above
        out, err = process.communicate()
    seconds = time.monotonic() - start
    after = snapshot(outer)
    after = {str(pathlib.Path(name).relative_to("in/here")) if name.startswith("in/here/") else "OUTSIDE/" + name: value
             for name, value in after.items()}
    out, err = out.decode(errors="replace"), err.decode(errors="replace")
    wrong = judge(row, process.returncode, out, err, seconds, before, after)
    shutil.rmtree(outer, ignore_errors=True)
    return row, wrong, out, err, seconds


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--only", default="", help="rows whose name or command holds this")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--show", action="store_true", help="what each row answered, too")
    parser.add_argument("--times", action="store_true", help="the slowest rows")
    options = parser.parse_args()
    here = pathlib.Path(__file__).parent
    for file in sorted(glob.glob(str(here / "rows_*.py"))):
        importlib.import_module(pathlib.Path(file).stem)
    rows = [r for r in TABLE if options.only in r.name or options.only in r.command]
    seen = set()
    for r in rows:
        key = (r.name, r.command)
        assert key not in seen, f"two rows are the same: {key}"
        seen.add(key)
    if options.list:
        for r in rows:
            print(f"{r.code:3d}  {r.name}: {r.command}")
        print(len(rows), "rows")
        return 0
    scratch = pathlib.Path(tempfile.mkdtemp(prefix="pvg_hostile_"))
    start, n_bad, n_left_out, times = time.monotonic(), 0, 0, []
    try:
        program = str(pathlib.Path(options.program).resolve())
        fixtures.make_all(scratch / "fixtures", program)
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            for r, wrong, out, err, seconds in pool.map(
                    lambda r: run_row(r, program, scratch / "fixtures", scratch), rows):
                times.append((r, seconds))
                if wrong and LACKING in err:
                    n_left_out += 1
                    continue
                n_bad += bool(wrong)
                if wrong or options.show:
                    last = (err.strip() or out.strip())[-600:].replace("\n", "\n        ")
                    print(f"{'BAD ' if wrong else 'ok  '} {r.name}: {r.command}\n      {'; '.join(wrong)}\n        {last}",
                          flush=True)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    if options.times:
        for r, seconds in sorted(times, key=lambda entry: -entry[1])[:60]:
            print(f"{seconds:6.1f} s  {r.name}: {r.command}")
    if n_left_out:
        print(f"test_hostile: {n_left_out} rows are left out: {LACKING}; scripts/install_calibration.sh and build again")
    n_judged = len(rows) - n_left_out
    print(f"test_hostile: {n_judged - n_bad} of {n_judged} inputs are answered well, in {time.monotonic() - start:.0f} s")
    return 1 if n_bad else 0


if __name__ == "__main__":
    sys.exit(main())
