#!/usr/bin/env python3
"""Prints the table of left-out photographs from the report of `capture room FOLDER --hold-out N --json`."""
import json
import math
import pathlib
import sys


def main():
    photos = json.loads(pathlib.Path(sys.argv[1]).read_text())["photos"]
    placed = photos["placement"]
    photos |= {"psnr_lut_before": placed["psnr_lut_before"], "ssim_lut_before": placed["ssim_lut_before"]}
    rows = [
        ("relit: the captured surface as a diffuse one under an even sky, denoised", "psnr_diffuse", "ssim_diffuse"),
        ("relit, with a table", "psnr_diffuse_lut", "ssim_diffuse_lut"),
        ("receiver; with nothing that stands there emissive is the same", "psnr", "ssim"),
        ("receiver, with a table", "psnr_lut", "ssim_lut"),
        ("the same from where the capture has the cameras", "psnr_lut_before", "ssim_lut_before"),
    ]
    print(f"| {photos['frames']} left-out photographs | PSNR [dB] | SSIM |\n|---|---|---|")
    for name, psnr, ssim in rows:
        print(f"| {name} | {photos[psnr]:.2f} | {photos[ssim]:.3f} |")
    print(f"Cameras were moved by {1e3 * placed['mean_shift']:.1f} mm and {math.degrees(placed['mean_turn']):.2f} degrees on the mean, "
          f"by {1e3 * placed['largest_shift']:.1f} mm and {math.degrees(placed['largest_turn']):.2f} degrees at most.")
    print(f"Receiver with a table above relit: {photos['psnr_lut'] - photos['psnr_diffuse']:.2f} dB, "
          f"{photos['ssim_lut'] - photos['ssim_diffuse']:.3f}; above relit with a table: "
          f"{photos['psnr_lut'] - photos['psnr_diffuse_lut']:.2f} dB, {photos['ssim_lut'] - photos['ssim_diffuse_lut']:.3f}")


if __name__ == "__main__":
    main()
