#!/usr/bin/env python3
"""Holds the words that only this project's authors would understand to no use in the tree and the docs.

    scripts/check_words.py [FOLDER]       FOLDER: of the project; exit code 1 where such a word stands

Each word has the field's own next to it. docs/measured and the changelog are records, which stay as they are.
"""
import pathlib
import re
import sys

WORDS = {  # pattern: what to write instead
    r"belie(f|fs|ved?|ves)": "prior, log prior",
    r"promis(e|es|ed)": "predicted reduction; guaranteed",
    r"louder": "noise scale",
    r"rivals?": "alternatives",
    r"dealt": "distributed, work packet",
    r"is_well": "has converged; is_intact",
    r"house rules?": "layers",
    r"yardsticks?": "baseline",
    r"way_search|WaySearch|way search": "path planner",
    r"(?<!noise )floors? [0-9]": "layer",
    r"check_floors": "check_layers",
}
FOLDERS = ["host", "pipeline", "kernels", "tests", "scripts", "docs", "data"]
ENDINGS = {".cpp", ".hpp", ".h", ".cl", ".md", ".py", ".sh", ".yaml", ".cmake", ".js", ".html", ".txt"}
LEFT_OUT = [
    "docs/measured", "docs/changelog.md", "scripts/check_words.py",
]
PATTERN = re.compile(r"(?<![A-Za-z])(" + "|".join(WORDS) + r")(?![A-Za-z])", re.I)


def instead_of(word):
    """the field's word"""
    return next(better for pattern, better in WORDS.items() if re.fullmatch(pattern, word, re.I))


def check(root):
    """the findings, a sentence each"""
    paths = [root / "README.md", root / "CMakeLists.txt"]
    for folder in FOLDERS:
        paths += sorted((root / folder).rglob("*"))
    findings = []
    for path in paths:
        name = path.relative_to(root).as_posix()
        if not path.is_file() or path.suffix not in ENDINGS or any(name.startswith(out) for out in LEFT_OUT):
            continue
        found = PATTERN.search(name)
        if found:
            findings.append(f"{name}: the file's name holds `{found[0]}`: {instead_of(found[0])}")
        for i, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
            findings += [f"{name}:{i}: `{word[0]}`: {instead_of(word[0])}" for word in PATTERN.finditer(line)]
    return findings


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)
    findings = check(root)
    for finding in findings:
        print(f"words: {finding}", file=sys.stderr)
    if findings:
        sys.exit(1)
    print("words: none that has to be explained")


if __name__ == "__main__":
    main()
