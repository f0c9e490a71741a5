"""What the converters share: reading CSV tables, writing a recording's folder."""
import csv
import pathlib


def read_rows(file):
    """Rows of a CSV file as mappings of text."""
    with open(file, newline="") as stream:
        return list(csv.DictReader(stream))


def write_run(folder, name, header, rows):
    """rows: lists of numbers or text; None is a gap."""
    lines = [",".join(header)]
    for row in rows:
        lines.append(",".join("" if cell is None else cell if isinstance(cell, str) else f"{cell:.9g}" for cell in row))
    pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
    (pathlib.Path(folder) / name).write_text("\n".join(lines) + "\n")


def write_recording(folder, scene, runs, channels, inputs=(), initial="first_sample"):
    """scene: text of scene.yaml; runs: (file, role); channels, inputs: lines of YAML without their dash."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.yaml").write_text(scene)
    lines = ["schema: 1", "scene: scene.yaml", "runs:"]
    lines += [f"  - {{file: {name}, role: {role}}}" for name, role in runs]
    if inputs:
        lines += ["inputs:"] + [f"  - {line}" for line in inputs]
    lines += ["channels:"] + [f"  - {line}" for line in channels] + [f"initial: {initial}"]
    (folder / "recording.yaml").write_text("\n".join(lines) + "\n")
