# Compares what two platforms made of the same scenes: pendulum.h5, grasp.h5 and picture.png in two folders.
# A pendulum: every number within 1e-12 (SI units). A grasp, whose contacts amplify rounding: within 1e-9 of the largest
# of its data set; counts (Newton iterations, contacts, kinds) are the same. A picture: within 1 of 255.
import sys
from pathlib import Path

import h5py
import numpy
from PIL import Image


def numbers(path):
    """All data sets of numbers in a file, by name."""
    found = {}

    def add(name, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu":
            found[name] = item[()]

    with h5py.File(path) as file:
        file.visititems(add)
    return found


def differences(first, second):
    """Of each data set: its name, the largest difference, the largest number; infinite where they do not match."""
    a, b = numbers(first), numbers(second)
    for name in sorted(a.keys() | b.keys()):
        if name not in a or name not in b or a[name].shape != b[name].shape:
            yield name, numpy.inf, 0.0
        elif a[name].dtype.kind in "iu":
            yield name, numpy.inf if (a[name] != b[name]).any() else 0.0, 0.0
        elif a[name].size:
            # what is infinite or no number has to be that in both
            finite = numpy.isfinite(a[name])
            if not numpy.array_equal(a[name][~finite], b[name][~finite], equal_nan=True):
                yield name, numpy.inf, 0.0
            elif finite.any():
                values = a[name][finite]
                yield name, numpy.abs(values - b[name][finite]).max(), numpy.abs(values).max()


def main():
    first, second = (Path(folder) for folder in sys.argv[1:])
    failed = False
    for scene, absolute, relative in (("pendulum", 1e-12, 0.0), ("grasp", 1e-12, 1e-9)):
        worst, where = 0.0, "nowhere"
        for name, off, largest in differences(first / f"{scene}.h5", second / f"{scene}.h5"):
            if not off <= absolute + relative * largest:
                print(f"{scene}: {name} differs by {off:.3g}")
                failed = True
            if off > worst:
                worst, where = off, name
        print(f"{scene}: largest difference {worst:.3g} in {where}")
    pictures = [numpy.asarray(Image.open(folder / "picture.png")).astype(int) for folder in (first, second)]
    off = numpy.abs(pictures[0] - pictures[1])
    print(f"picture: {numpy.count_nonzero(off)} of {off.size} values differ, by at most {off.max()} of 255")
    sys.exit(1 if failed or off.max() > 1 else 0)


main()
