#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The smallest shift of a second scan that the check of a given transform finds, by how much of the head lies in both scans.

A phantom's MR is cut to a slab of the upper head and moved along an axis; the true transform of the scan as it was is given. Prints
a table for docs/validation/second-scan.md: the share of the head in both, the shift, how far the images say that they lie apart, and the
exit code (0 taken, 80 refused).

    bench/given_shift.py --trephine build/release/bin/trephine --overlaps 1 0.6 0.4 0.25 --shifts-mm 0 0.5 1 2 4"""
import argparse
import array
import json
import pathlib
import subprocess
import tempfile


def read(path):
    head, _, body = path.read_bytes().partition(b"\n\n")
    lines = head.decode().split("\n")
    keys = dict(line.split(": ", 1) for line in lines if ": " in line)
    values = array.array("h" if keys["type"] in ("short", "int16") else "f")
    values.frombytes(body)
    size = [int(n) for n in keys["sizes"].split()]
    steps = [[float(n) for n in v.strip("() ").split(",")] for v in keys["space directions"].split(") (")]
    origin = [float(n) for n in keys["space origin"].strip("() ").split(",")]
    return lines, values, size, steps, origin


def write(path, lines, values, size, origin):
    texts = {"sizes": " ".join(map(str, size)), "space origin": "({})".format(",".join(map(repr, origin)))}
    head = [f"{key}: {texts[key]}" if (key := line.split(": ")[0]) in texts else line for line in lines if ":=" not in line]
    path.write_bytes("\n".join(head).encode() + b"\n\n" + values.tobytes())


def slab(values, size, axis, keep):
    """The slices of `keep` along an axis."""
    inner = size[0] if axis > 0 else 1
    for a in range(1, axis):
        inner *= size[a]
    block = inner * size[axis]
    out = array.array(values.typecode)
    for at in range(0, len(values), block):
        out.extend(values[at + inner * keep.start:at + inner * keep.stop])
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trephine", default="trephine")
    parser.add_argument("--overlaps", type=float, nargs="+", default=[1, 0.6, 0.4, 0.25])
    parser.add_argument("--shifts-mm", type=float, nargs="+", default=[0, 0.5, 1, 2, 4])
    parser.add_argument("--axes", type=int, nargs="+", default=[0, 2], help="patient axes: 0 left, 1 back, 2 up")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--voxel-mm", type=float, default=2)
    parser.add_argument("--least-overlap-ratio", type=float, default=0.5)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        measure(args, pathlib.Path(folder))


def measure(args, work):
    def trephine(*words):
        return subprocess.run([args.trephine, *map(str, words), "--quiet"], capture_output=True, text=True)

    columns, slices = round(240 / args.voxel_mm), round(200 / args.voxel_mm)
    made = trephine("phantom", work / "head", "--seed", args.seed, "--level", "clinical", "--columns-count", columns, "--rows-count", columns,
                    "--field-of-view-mm", 240, "--slices-count", slices, "--slice-step-mm", args.voxel_mm, "--slice-thickness-mm",
                    args.voxel_mm, "--noise-hu", 12, "--mesh-step-mm", 0, "--no-labels", "--second-scan", "mr", "--second-voxel-mm",
                    args.voxel_mm)
    assert made.returncode == 0, made.stderr
    ct, second, out = work / "ct.nrrd", work / "mr.nrrd", work / "out.nrrd"
    assert trephine("import", work / "head/dicom", "--output", ct).returncode == 0
    lines, values, size, steps, origin = read(work / "head/second/scan.nrrd")
    up = max(range(3), key=lambda a: abs(steps[a][2]))
    print("| share cut to | share of the head | axis | shift, mm | images say, mm | exit |\n|---|---|---|---|---|---|")
    for share in args.overlaps:
        count = round(size[up] * share)
        keep = range(size[up] - count, size[up]) if steps[up][2] > 0 else range(0, count)
        cut = slab(values, size, up, keep)
        corner = [o + keep.start * s for o, s in zip(origin, steps[up])]
        for axis in args.axes:
            for shift in args.shifts_mm:
                if shift == 0 and axis != args.axes[0]:
                    continue
                moved = [c + shift * (a == axis) for a, c in enumerate(corner)]
                write(second, lines, cut, [count if a == up else n for a, n in enumerate(size)], moved)
                report = work / "report.json"
                report.unlink(missing_ok=True)
                done = trephine("register", ct, second, "--given", work / "head/second/truth.tfm", "--least-overlap-ratio",
                                args.least_overlap_ratio, "--report", report, "--output", out)
                figures = json.loads(report.read_text()) if report.exists() else {}
                print(f"| {share} | {figures.get('overlap_ratio', '')} | {'xyz'[axis]} | {shift} | {figures.get('given_apart_mm', '')} | "
                      f"{done.returncode}: {' '.join(done.stderr.split())[:200]} |", flush=True)


if __name__ == "__main__":
    main()
