"""What a log holds of one topic, and the files that it becomes: times and named columns, or pictures."""
import dataclasses
import math
import pathlib
import sys


@dataclasses.dataclass
class Series:
    """name: of the topic; times [n, s], ascending; columns: name -> [n] numbers, NaN where nothing was measured;
    pictures: [n] arrays [height, width, 3], 8-bit sRGB, in place of columns; delay: median time [s] from the stamp to
    the arrival, where both are known; kind: the type of the messages."""

    name: str
    kind: str
    times: list
    columns: dict
    pictures: list = dataclasses.field(default_factory=list)
    delay: float = math.nan

    def rate(self):
        """[Hz], of the samples"""
        return (len(self.times) - 1) / (self.times[-1] - self.times[0]) if len(self.times) > 1 else math.nan


def in_order(series):
    """The same by ascending times; of several samples of one time the last one stays."""
    rows = sorted({time: row for row, time in enumerate(series.times)}.items())
    left_out = len(series.times) - len(rows)
    if left_out:
        print(f"note: {series.name}: samples left out, which have the time of another one: {left_out}; the last of each stays",
              file=sys.stderr)
    pick = [row for _, row in rows]
    return dataclasses.replace(series, times=[time for time, _ in rows],
                               columns={name: [values[row] for row in pick] for name, values in series.columns.items()},
                               pictures=[series.pictures[row] for row in pick] if series.pictures else [])


def file_name(name):
    """A topic as a part of a file's name: /joint_states becomes joint_states."""
    return "".join(letter if letter.isalnum() else "_" for letter in name).strip("_")


def write_table(path, series):
    """path: a CSV file with the column `t` [s] and one per column; an empty cell is a gap."""
    lines = [",".join(["t", *series.columns])]
    for row, time in enumerate(series.times):
        cells = [values[row] for values in series.columns.values()]
        lines.append(",".join([f"{time:.9f}"] + ["" if math.isnan(cell) else f"{cell:.12g}" for cell in cells]))
    pathlib.Path(path).write_text("\n".join(lines) + "\n")


def write_pictures(path, series):
    """path: an HDF5 file with /rgb [n, height, width, 3] and /time [n, s]."""
    import h5py
    import numpy

    shape = series.pictures[0].shape
    other = next((picture.shape for picture in series.pictures if picture.shape != shape), None)
    if other:
        sys.exit(f"{series.name}: its pictures are of {shape[1]} x {shape[0]} and of {other[1]} x {other[0]} pixels; "
                 "a video has one size")
    with h5py.File(path, "w") as out:
        out.create_dataset("rgb", data=numpy.stack(series.pictures), compression="gzip", shuffle=True)
        out["time"] = series.times
