"""Reads C3D files of motion capture by the package ezc3d: markers in metres, with gaps, and analogue channels in the
units that the file tells."""
import math
import sys

from logs.series import Series

METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}


def labels_of(group, n):
    labels = list(group.get("LABELS", {}).get("value", []))
    return [str(label).replace(",", " ").strip() or f"column_{i}" for i, label in enumerate(labels)][:n] + [
        f"column_{i}" for i in range(len(labels), n)]


def read(path):
    """Returns the Series of markers and of analogue channels and what was left out, with reasons."""
    import ezc3d

    try:
        log = ezc3d.c3d(str(path))
    except Exception as error:
        sys.exit(f"{path} cannot be read as a C3D file: {error}")
    point, analog = log["parameters"].get("POINT", {}), log["parameters"].get("ANALOG", {})
    found, left_out = [], []
    places, signals = log["data"]["points"], log["data"]["analogs"][0]
    unit = str((point.get("UNITS", {}).get("value") or ["mm"])[0]).strip() or "mm"
    if places.shape[1] and places.shape[2]:
        if unit not in METRES:
            sys.exit(f"{path}: markers are in the unit `{unit}`; {', '.join(METRES)} are read")
        rate = float(log["header"]["points"]["frame_rate"])
        columns = {}
        for i, label in enumerate(labels_of(point, places.shape[1])):
            for k, axis in enumerate("xyz"):
                columns[f"{label}/{axis}"] = [METRES[unit] * value if math.isfinite(value) else math.nan
                                              for value in places[k, i, :].tolist()]
        found.append(Series("markers", "C3D", [row / rate for row in range(places.shape[2])], columns))
    else:
        left_out.append("markers: there are none")
    if signals.shape[0] and signals.shape[1]:
        rate = float(log["header"]["analogs"]["frame_rate"])
        columns = {label: signals[i].tolist() for i, label in enumerate(labels_of(analog, signals.shape[0]))}
        found.append(Series("analog", "C3D", [row / rate for row in range(signals.shape[1])], columns))
    return found, left_out
