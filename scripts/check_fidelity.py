#!/usr/bin/env python3
"""Compares PSNR and SSIM of `phyvisgen evaluate fidelity` with scikit-image's on pairs of pictures.

    scripts/python_env.sh fidelity numpy scikit-image pillow
    .venv-fidelity/bin/python scripts/check_fidelity.py build/bin/phyvisgen [PAIRS]

Pictures are smooth noise of random scale, contrast and size, and the second of a pair is a blurred, shifted or noisy
copy of the first. Exit code 1 where SSIM differs by more than 1e-4 or PSNR by more than 1e-3 dB.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy
from PIL import Image
from skimage.filters import gaussian
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

LUMA = numpy.array([0.299, 0.587, 0.114])


def picture(random):
    """8-bit RGB"""
    height, width = random.integers(16, 120, 2)
    smooth = gaussian(random.random((height, width, 3)), random.uniform(0.3, 6), channel_axis=2)
    spread = smooth.max() - smooth.min()
    return (smooth - smooth.min()) / max(spread, 1e-9) * random.uniform(0.2, 1)


def worse(first, random):
    """a copy with errors"""
    kind = random.integers(3)
    if kind == 0:
        return gaussian(first, random.uniform(0.3, 3), channel_axis=2)
    if kind == 1:
        return numpy.roll(first, random.integers(1, 4), axis=1)
    return first + random.normal(0, random.uniform(0.002, 0.2), first.shape)


def main():
    program, n = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 100
    random = numpy.random.default_rng(1)
    most_psnr = most_ssim = 0.0
    with tempfile.TemporaryDirectory() as scratch:
        real, simulated = pathlib.Path(scratch, "real"), pathlib.Path(scratch, "simulated")
        expected = {}
        for i in range(n):
            first = picture(random)
            pair = [numpy.uint8(numpy.clip(p, 0, 1) * 255 + 0.5) for p in (first, worse(first, random))]
            for folder, pixels in zip((real, simulated), pair):
                folder.mkdir(exist_ok=True)
                Image.fromarray(pixels).save(folder / f"{i:06}.png")
            a, b = (p / 255.0 for p in pair)
            expected[f"{i:06}"] = (
                peak_signal_noise_ratio(a, b, data_range=1),
                structural_similarity(a @ LUMA, b @ LUMA, gaussian_weights=True, sigma=1.5, use_sample_covariance=False,
                                      data_range=1))
        report = pathlib.Path(scratch, "report")
        subprocess.run([program, "evaluate", "fidelity", real, simulated, "-o", report, "--shown", "0"], check=True,
                       stdout=subprocess.DEVNULL)
        for frame in json.loads((report / "report.json").read_text())["frames"]:
            psnr, ssim = expected.pop(frame["frame"])
            most_psnr = max(most_psnr, abs(frame["psnr"] - psnr))
            most_ssim = max(most_ssim, abs(frame["ssim"] - ssim))
        assert not expected, f"the report lacks {sorted(expected)}"
    print(f"{n} pairs: PSNR differs by at most {most_psnr:.2g} dB, SSIM by at most {most_ssim:.2g}")
    return 0 if most_psnr <= 1e-3 and most_ssim <= 1e-4 else 1


if __name__ == "__main__":
    sys.exit(main())
