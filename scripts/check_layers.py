#!/usr/bin/env python3
"""Holds every #include of the project against the table of host/libraries.cmake, and looks for cycles of folders.

    scripts/check_layers.py [FOLDER]      FOLDER: of the project; exit code 1 where an include breaks a rule

Rules: a library includes its own headers and those of the libraries in its row; kernels include kernels alone; OpenCL's
headers stay in host/device; libraries of others stay in the folders named below; physics sees nothing of what is seen;
no folder has more than 40 files. README.md names the folders of kernels, host, pipeline and data.
"""
import collections
import pathlib
import re
import sys

OTHERS = {  # header of another library: the folders that may include it
    "CL/": ["host/device"],
    "yaml-cpp/": ["host/robot", "host/load", "host/load/fields", "host/load/recording", "host/identify/data", "host/identify/candidates", "host/identify/report"],
    "hdf5": ["host/hdf5"],
    "libdeflate": ["host/hdf5"],
    "assimp/": ["host/formats", "host/robot"],
    "OpenImageIO/": ["host/formats"],
    "tiny_gltf": ["host/formats"],
    "urdf": ["host/robot"],
    "ompl/": ["host/robot"],
    "fcl/": ["host/robot"],
    "oneapi/": ["pipeline/graph"],
    "tbb/": ["pipeline/graph"],
    "CLI/": ["pipeline/command_line"],
}
HIDDEN = {  # header: the folder whose libraries may not include it, though they may use its library
    "host/model/appearance.hpp": "host/physics/",
    "host/model/scene.hpp": "host/physics/",
}
LARGEST_FOLDER = 40  # source files
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]', re.M)


def read_table(path):
    """{folder: set of folders that it may include} of the rows of libraries.cmake"""
    text = re.sub(r"#.*", "", path.read_text())
    lists, folder_of, table = {}, {}, {}
    for name, words in re.findall(r"\b(set|pvg_library)\s*\(([^)]*)\)", text):
        words = [w for word in words.split() for w in (lists[word[2:-1]] if word.startswith("${") else [word])]
        if name == "set":
            lists[words[0]] = words[1:]
            continue
        folder_of[re.sub("^(host|pipeline)/", "", words[0])] = words[0]
        table[words[0]] = {words[0]} | {folder_of[used] for used in words[1:]}
    return table


def find_cycle(edges):
    """a list of folders that include each other in a ring, or None"""
    done, path = set(), []

    def visit(folder):
        if folder in path:
            return path[path.index(folder):] + [folder]
        if folder in done:
            return None
        path.append(folder)
        for other in sorted(edges[folder]):
            found = visit(other)
            if found:
                return found
        path.pop()
        done.add(folder)
        return None

    return next((ring for ring in map(visit, sorted(edges)) if ring), None)


def check(root):
    """the findings, a sentence each"""
    table = read_table(root / "host/libraries.cmake")
    findings, sizes, edges = [], collections.Counter(), collections.defaultdict(set)
    for top in ("kernels", "host", "pipeline", "tests"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix not in (".cpp", ".hpp", ".h", ".cl"):
                continue
            folder = path.parent.relative_to(root).as_posix()
            sizes[folder] += 1
            for mark, name in INCLUDE.findall(path.read_text(errors="replace")):
                where = f"{path.relative_to(root)} includes {name}"
                target = name.rsplit("/", 1)[0]
                ours = name.startswith(("host/", "pipeline/", "tests/"))
                if mark == '"' and ours and top != "tests":
                    edges[folder].add(target) if target != folder else None
                    if top == "kernels":
                        findings.append(f"{where}: kernels include kernels alone")
                    elif target not in table.get(folder, set()):
                        findings.append(f"{where}: {folder} may not use {target} (host/libraries.cmake)")
                if folder.startswith(HIDDEN.get(name, "-")):
                    findings.append(f"{where}: physics reads host/model/physical_scene.hpp alone")
                for prefix, homes in OTHERS.items():
                    if mark == "<" and name.startswith(prefix) and folder not in homes and top != "tests":
                        findings.append(f"{where}: it stays in {', '.join(homes)}")
                if name.startswith("CL/") and top == "tests":
                    findings.append(f"{where}: it stays in host/device")
    findings += [f"{folder} holds {n} source files, more than {LARGEST_FOLDER}: divide it"
                 for folder, n in sorted(sizes.items()) if n > LARGEST_FOLDER]
    libraries = {folder for folder in sizes if folder.startswith(("host/", "pipeline/"))}
    findings += [f"{folder} is in no row of host/libraries.cmake" for folder in sorted(libraries - set(table))]
    ring = find_cycle(edges)
    if ring:
        findings.append("folders include each other: " + " -> ".join(ring))
    return findings


def check_listing(root):
    """folders that README.md's section of folders does not name"""
    section = (root / "README.md").read_text().split("## Folders")[1].split("\n##")[0]
    parts = dict(re.findall(r"^    (\w+)/ +(.*(?:\n {8,}.*)*)", section, re.M))
    missing = []
    for top in ("kernels", "host", "pipeline", "data"):
        for folder in sorted(p.name for p in (root / top).iterdir() if p.is_dir() and not p.name.startswith(("_", "."))):
            if not re.search(rf"\b{folder}\b", parts.get(top, "")):
                missing.append(f"README.md's section of folders does not name {top}/{folder}")
    return missing


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)
    findings = check(root) + check_listing(root)
    for finding in findings:
        print(f"layers: {finding}", file=sys.stderr)
    if findings:
        sys.exit(1)
    print("layers: every include is in the table, every folder in the README")


if __name__ == "__main__":
    main()
