#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Real heads with points, as another hospital would have scanned them: sampled otherwise, so that the reader's points stay valid.

    bench/other_hospital.py TREPHINE FOLDER --data DIR --probes DIR [NAME...]    makes and runs these cases (see CASES), all without a name
    bench/other_hospital.py TREPHINE FOLDER --tables                             makes nothing, and prints what was measured as a table

Each given head is imported once, its voxels are changed as the case's name says, and written as DICOM with tags that agree; what is written
stays in FOLDER. Points and landmarks outside of the new field are left out of the reader's. A case that has run is a line of FOLDER/rows.jsonl;
of one that ran twice the last line counts. Needs numpy (Debian: python3-numpy).

  given     as it is, for comparison: only written anew
  thick     slices of 5 mm, each the mean of what was scanned; thick-overlap: every 2.5 mm
  noise     20 HU of noise are added, with the spectrum of a soft kernel      sharp     a bone kernel: fine detail and noise raised 4 times
  narrow    the field is 180 mm wide and cuts the scalp at the sides          coarse    pixels of 1 mm, slices of 3 mm
  no-vertex the scan ends 30 mm below the vertex                              no-base   the scan begins at the orbits
  prone, feet-first, feet-first-prone   pixels, positions and tags of a patient who lies so; files in the reverse order
  oblique   the slices are turned by 12 degrees in their plane and tilted by 10, and begin where they are whole
  reformat  the same with what is left of the slices below, as a program that reformats stores it: the rest is padding
  round     the field is round, 170 mm wide, and cuts the head; beyond it lies padding
  clipped   all that is darker than -850 HU is -1000 HU, so that air has one value"""
import argparse
import hashlib
import json
import pathlib
import re
import struct
import subprocess
import sys

import head_cases as heads

# name, head, what is done, and where the field ends (z in LPS mm) if that is what is done
CASES = """
given-0051 head_invesalius_0051 given
given-c3n head_neuronav_C3N-01192 given
given-doe head_doe_ge given
given-cerebrix head_mask_cerebrix given
thick-0051 head_invesalius_0051 thick
thick-c3n head_neuronav_C3N-01192 thick
thick-doe head_doe_ge thick
overlap-cerebrix head_mask_cerebrix thick-overlap
overlap-c3n head_neuronav_C3N-01192 thick-overlap
noise-0051 head_invesalius_0051 noise
noise-cerebrix head_mask_cerebrix noise
noise-c3n head_neuronav_C3N-01192 noise
sharp-doe head_doe_ge sharp
sharp-cerebrix head_mask_cerebrix sharp
narrow-0051 head_invesalius_0051 narrow
narrow-c3n head_neuronav_C3N-01192 narrow
no-vertex-cerebrix head_mask_cerebrix no-vertex 165
no-vertex-c3n head_neuronav_C3N-01192 no-vertex 51
no-base-doe head_doe_ge no-base -25
no-base-0051 head_invesalius_0051 no-base 168
prone-0051 head_invesalius_0051 prone
feet-first-c3n head_neuronav_C3N-01192 feet-first
feet-first-prone-cerebrix head_mask_cerebrix feet-first-prone
oblique-0051 head_invesalius_0051 oblique
oblique-cerebrix head_mask_cerebrix oblique
reformat-doe head_doe_ge reformat
round-0051 head_invesalius_0051 round
round-c3n head_neuronav_C3N-01192 round
round-cerebrix head_mask_cerebrix round
clipped-doe head_doe_ge clipped
clipped-0051 head_invesalius_0051 clipped
coarse-c3n head_neuronav_C3N-01192 coarse
coarse-cerebrix head_mask_cerebrix coarse
coarse-doe head_doe_ge coarse
"""
padding = -2000  # what is written where nothing was scanned, as the tag PixelPaddingValue says
SOURCES = {"head_toshiba_5mm": ["--series", "s4"], "head_doe_ge": ["--series-rule", "best"]}


class Volume:
    """Voxels [z][y][x] in HU; columns of `axes` are the directions of x, y and z, `step` the spacing, `origin` the first voxel (LPS mm)."""

    def __init__(self, voxels, axes, step, origin, thickness):
        self.voxels, self.axes, self.step, self.origin, self.thickness = voxels, axes, step, origin, thickness
        self.position, self.kernel, self.backwards = "HFS", "STANDARD", False

    def like(self, voxels=None, **other):
        v = Volume(self.voxels if voxels is None else voxels, self.axes, self.step, self.origin, self.thickness)
        v.position, v.kernel, v.backwards = self.position, self.kernel, self.backwards
        for name, value in other.items():
            setattr(v, name, value)
        return v

    def index(self, p):
        """Of a point in LPS mm: x, y, z in voxels."""
        return np.linalg.inv(self.axes * self.step) @ (np.asarray(p, float) - self.origin)

    def holds(self, p):
        i = np.round(self.index(p)).astype(int)
        return all(0 <= i) and all(i < self.voxels.shape[::-1]) and self.voxels[tuple(i[::-1])] != padding


def read(path):
    data = path.read_bytes()
    end = data.index(b"\n\n") + 2
    fields = dict(line.split(": ", 1) for line in data[:end].decode("latin-1").splitlines() if ": " in line and line[0] != "#")
    size = [int(n) for n in fields["sizes"].split()]
    vectors = np.array([[float(n) for n in v.split(",")] for v in re.findall(r"\(([^)]*)\)", fields["space directions"])]).T
    step = np.linalg.norm(vectors, axis=0)
    kind = {"short": "<i2", "float": "<f4"}[fields["type"]]
    voxels = np.frombuffer(data, kind, offset=end).reshape(size[::-1]).astype(np.float32)
    origin = np.array([float(n) for n in fields["space origin"].strip("()").split(",")])
    return Volume(np.maximum(voxels, -1024), vectors / step, step, origin, step[2])


def mean_along(voxels, axis, middles, width):
    """Means of boxes of a width about middles, all in voxels along an axis."""
    moved = np.moveaxis(voxels, axis, 0)
    out = np.empty((len(middles),) + moved.shape[1:], np.float32)
    for n, middle in enumerate(middles):
        low, high = middle - width / 2, middle + width / 2
        weights = np.array([max(0.0, min(high, i + 0.5) - max(low, i - 0.5)) for i in range(len(moved))], np.float32)
        some = np.nonzero(weights)[0]
        out[n] = np.tensordot(weights[some] / weights[some].sum(), moved[some], 1)
    return np.moveaxis(out, 0, axis)


def sampled(v, axis, step_mm, width_mm):
    """Box means along one axis of the volume, as a wider detector or a larger pixel measures."""
    ratio, width = step_mm / v.step[axis], max(1.0, width_mm / v.step[axis])
    count = v.voxels.shape[2 - axis]
    middles = np.arange((width - 1) / 2, count - 1 - (width - 1) / 2 + 1e-6, ratio)
    step = v.step.copy()
    step[axis] = step_mm
    return v.like(mean_along(v.voxels, 2 - axis, middles, width), step=step, origin=v.origin + v.axes[:, axis] * v.step[axis] * middles[0],
                  thickness=width_mm if axis == 2 else v.thickness)


def frequencies(v):
    """Of a slice's Fourier transform, in line pairs a mm."""
    return np.hypot(np.fft.fftfreq(v.voxels.shape[1], v.step[1])[:, None], np.fft.rfftfreq(v.voxels.shape[2], v.step[0])[None, :])


def filtered(v, gain):
    shape = v.voxels.shape[1:]
    return v.like(np.stack([np.fft.irfft2(np.fft.rfft2(s) * gain, shape).astype(np.float32) for s in v.voxels]))


def noisy(v, hu):
    f = frequencies(v)
    gain = f * np.exp(-((f / 0.45) ** 2))  # the ramp of the back projection, and the roll-off of a soft kernel
    noise = filtered(v.like(np.random.default_rng(34).standard_normal(v.voxels.shape, np.float32)), gain).voxels
    return v.like(v.voxels + noise * (hu / noise.std()))


def cropped(v, axis, first, last):
    keep = [slice(None)] * 3
    keep[2 - axis] = slice(first, last + 1)
    return v.like(v.voxels[tuple(keep)], origin=v.origin + v.axes[:, axis] * v.step[axis] * first)


def flipped(v, axis):
    axes = v.axes.copy()
    axes[:, axis] *= -1
    return v.like(np.flip(v.voxels, 2 - axis), axes=axes, origin=v.origin + v.axes[:, axis] * v.step[axis] * (v.voxels.shape[2 - axis] - 1))


def oblique(v, turn_deg, tilt_deg, whole):
    """The whole volume on a grid that is turned about z and then tilted about x; padding where nothing was scanned."""
    a, b = np.radians([turn_deg, tilt_deg])
    axes = v.axes @ np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]) @ np.array(
        [[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    size = np.array(v.voxels.shape[::-1])
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * (size - 1)
    seen = (v.origin + corners @ (v.axes * v.step).T) @ axes  # along the new axes, mm
    low, high = seen.min(axis=0), seen.max(axis=0)
    middle = (low + high) / 2
    low[:2], high[:2] = middle[:2] - size[:2] * v.step[:2] / 2, middle[:2] + size[:2] * v.step[:2] / 2  # as wide as before
    count = np.floor((high - low) / v.step + 1e-6).astype(int)
    origin = axes @ low
    x, y = np.meshgrid(np.arange(count[0]), np.arange(count[1]))
    to_old = np.linalg.inv(v.axes * v.step)
    out = np.full((count[2], count[1], count[0]), padding, np.float32)
    tissue = (v.voxels > -300).any(axis=0)
    begins = 0
    for k in range(count[2]):
        at = (np.stack([x, y, np.full_like(x, k)], -1) * v.step) @ axes.T + origin - v.origin
        at = at @ to_old.T
        inside = np.all((at >= 0) & (at <= size - 1), axis=-1)
        under = (at[..., 2] < 0) & np.all((at[..., :2] >= 0) & (at[..., :2] <= size[:2] - 1), axis=-1)
        if tissue[tuple(at[under][:, 1::-1].astype(int).T)].any():
            begins = k + 1
        at = at[inside]
        base = np.minimum(at.astype(int), size - 2)
        f = at - base
        total = np.zeros(len(at))
        for c in range(8):
            d = np.array([c & 1, c >> 1 & 1, c >> 2])
            i = base + d
            total += np.prod(np.where(d, f, 1 - f), axis=1) * v.voxels[i[:, 2], i[:, 1], i[:, 0]]
        out[k][inside] = total
    filled = np.nonzero((out > -900).any(axis=(1, 2)))[0]
    first = max(filled[0], begins) if whole else filled[0]
    return v.like(out[first : filled[-1] + 1], axes=axes, origin=origin + axes[:, 2] * v.step[2] * first)


def changed(v, how, limit):
    if how == "given":
        return v
    if how in ("thick", "thick-overlap"):
        return sampled(v, 2, 2.5 if how == "thick-overlap" else 5, 5)
    if how == "noise":
        return noisy(v, 20)
    if how == "sharp":
        f = frequencies(v)
        return filtered(v, 1 + 3 * (1 - np.exp(-((f / 0.4) ** 2)))).like(kernel="BONE")
    if how == "narrow":
        n = int(180 / v.step[0])
        inside = np.nonzero((v.voxels > 200).any(axis=(0, 1)))[0]  # bone, and what holds the head
        first = int(np.clip((inside[0] + inside[-1] - n) // 2, 0, v.voxels.shape[2] - n))
        v = cropped(v, 0, first, first + n - 1)  # the height of the picture stays: a wide matrix
        return v
    if how in ("no-vertex", "no-base"):
        k = int(round((limit - v.origin[2]) / v.step[2]))
        return cropped(v, 2, 0, k) if how == "no-vertex" else cropped(v, 2, k, len(v.voxels) - 1)
    if how == "prone":
        return flipped(flipped(v, 0), 1).like(position="HFP", backwards=True)
    if how == "feet-first":
        return flipped(flipped(v, 0), 2).like(position="FFS", backwards=True)
    if how == "feet-first-prone":
        return flipped(flipped(v, 1), 2).like(position="FFP", backwards=True)
    if how in ("oblique", "reformat"):
        return oblique(v, 12, 10, how == "oblique")
    if how == "round":
        bone = np.nonzero((v.voxels > 400).any(axis=0))
        y, x = np.indices(v.voxels.shape[1:])
        beyond = np.hypot((x - np.median(bone[1])) * v.step[0], (y - np.median(bone[0])) * v.step[1]) > 85
        return v.like(np.where(beyond[None], np.float32(padding), v.voxels))
    if how == "clipped":
        return v.like(np.where(v.voxels < -850, np.float32(-1000), v.voxels))
    if how == "coarse":
        return sampled(sampled(sampled(v, 0, 1, 1), 1, 1, 1), 2, 3, 3)
    sys.exit(f"{how}: not known")


def element(group, number, kind, value):
    if isinstance(value, str):
        value = value.encode("ascii")
        value += b"" if len(value) % 2 == 0 else (b"\0" if kind == "UI" else b" ")
    long = kind in ("OB", "OW", "UN", "SQ")
    return struct.pack("<HH2s", group, number, kind.encode()) + struct.pack("<HI" if long else "<H", *((0, len(value)) if long else (len(value),))) + value


def write_dicom(v, folder, name):
    """One CT series, explicit little endian, of a made-up patient."""
    folder.mkdir(parents=True)
    root = "2.25." + str(int(hashlib.sha256(name.encode()).hexdigest()[:24], 16))
    stored = np.clip(np.round(v.voxels), padding, 32767).astype("<i2")
    numbers = lambda *values: "\\".join(f"{x:.6f}"[:16] for x in values)
    count = len(stored)
    for k in range(count):
        sop = f"{root}.3.{k + 1}"
        order = count - k if v.backwards else k + 1
        meta = b"".join([element(2, 1, "OB", b"\0\1"), element(2, 2, "UI", "1.2.840.10008.5.1.4.1.1.2"), element(2, 3, "UI", sop),
                         element(2, 0x10, "UI", "1.2.840.10008.1.2.1"), element(2, 0x12, "UI", "2.25.34")])
        rows = [(8, 8, "CS", "ORIGINAL\\PRIMARY\\AXIAL"), (8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2"), (8, 0x18, "UI", sop), (8, 0x60, "CS", "CT"),
                (0x10, 0x10, "PN", "REBUILT"), (0x10, 0x20, "LO", name), (0x18, 0x10, "LO", "NONE"), (0x18, 0x50, "DS", numbers(v.thickness)),
                (0x18, 0x1210, "SH", v.kernel), (0x18, 0x5100, "CS", v.position), (0x20, 0xD, "UI", root + ".1"), (0x20, 0xE, "UI", root + ".2"),
                (0x20, 0x13, "IS", str(order)), (0x20, 0x32, "DS", numbers(*(v.origin + v.axes[:, 2] * v.step[2] * k))),
                (0x20, 0x37, "DS", numbers(*v.axes[:, 0], *v.axes[:, 1])), (0x20, 0x52, "UI", root + ".4"),
                (0x28, 2, "US", struct.pack("<H", 1)), (0x28, 4, "CS", "MONOCHROME2"), (0x28, 0x10, "US", struct.pack("<H", stored.shape[1])),
                (0x28, 0x11, "US", struct.pack("<H", stored.shape[2])), (0x28, 0x30, "DS", numbers(v.step[1], v.step[0])),
                (0x28, 0x100, "US", struct.pack("<H", 16)), (0x28, 0x101, "US", struct.pack("<H", 16)), (0x28, 0x102, "US", struct.pack("<H", 15)),
                (0x28, 0x103, "US", struct.pack("<H", 1)), (0x28, 0x120, "SS", struct.pack("<h", padding)), (0x28, 0x1052, "DS", "0"), (0x28, 0x1053, "DS", "1"), (0x7FE0, 0x10, "OW", stored[k].tobytes())]
        (folder / f"{order:04d}.dcm").write_bytes(b"\0" * 128 + b"DICM" + element(2, 0, "UL", struct.pack("<I", len(meta))) + meta +
                                                  b"".join(element(*r) for r in rows))


def made(program, folder, data, probes, name, head, how, limit):
    at = folder / name
    if (at / "points.json").exists():
        return at
    source = folder / f"{head}.nrrd"
    if not source.exists():
        subprocess.run([program, "import", data / head, *SOURCES.get(head, []), "--output", source, "--quiet"], check=True)
    v = changed(read(source), how, limit)
    write_dicom(v, at / "dicom", name)
    reference = json.loads((probes / f"{head}.json").read_text())
    reference["points"] = [q for q in reference["points"] if v.holds(q["p"])]
    reference["landmarks"] = {n: m if m and v.holds(m["p"]) else None for n, m in reference["landmarks"].items()}
    if v.thickness >= 5:  # half a slice more of doubt than the reader had, as with phantoms
        for m in reference["landmarks"].values():
            if m:
                m["radius_mm"] = max(8.0, m["radius_mm"])
    reference["step_mm"] = float(v.step[2])
    (at / "points.json").write_text(json.dumps(reference))
    return at


def run(program, folder, probe, name, at):
    row = heads.case_of(program, folder, name, at / "dicom", [], folder / "keep")
    if row["code"] == 0:
        said = subprocess.run([sys.executable, probe, at / "points.json", folder / "library" / name], capture_output=True, text=True).stdout
        (at / "probe.txt").write_text(said)
        row["wrong"] = {a: [int(r), int(w)] for a, r, w in re.findall(r"^(\w+) +\| (?:GLB|haptic) +\| +(\d+) \| +(\d+) \|", said, re.M)}
        row["marks"] = [[n, float(off), float(radius), float(c)] for n, off, radius, c in
                        re.findall(r"^  (\w+) +([\d.]+) \(([\d.]+)\) .*confidence ([\d.]+)", said, re.M)]
        row["unseen"] = [n for n, m in json.loads((at / "points.json").read_text())["landmarks"].items()
                         if m is None and row["landmarks"].get(n, [0])[0] >= 0.5]
    return row


def text_of_row(r):
    if r["code"]:
        return f"| {r['name']} | {r['code']} | {r['said']} | | | | | | | {r['cpu_s']:.0f} |"
    shares = " | ".join(f"{w} of {n + w}" + (f" ({100 * w / (n + w):.1f} %)" if w else "") for n, w in r["wrong"].values())
    sure = [m for m in r["marks"] if m[3] >= 0.5]
    beyond = "; ".join(f"{n} {off:.1f} at {c:.2f}" for n, off, radius, c in sure if off > radius)
    told = "; ".join(text for kind, side, c, text, _ in r["findings"] if c >= 0.5)
    return (f"| {r['name']} | 0 | {r['verdict'].split('; to be looked at')[0]}; {r['class']} | {' | '.join(r['wrong'])}: {shares} | "
            f"{sum(m[1] <= m[2] for m in sure)} of {len(sure)}{': ' + beyond if beyond else ''}{' not in the scan: ' + ', '.join(r['unseen']) if r['unseen'] else ''} | "
            f"{told} | {r['cpu_s']:.0f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("trephine")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--probes", type=pathlib.Path)
    parser.add_argument("--data", type=pathlib.Path)
    parser.add_argument("--tables", action="store_true")
    args = parser.parse_intermixed_args()
    folder = args.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    record = folder / "rows.jsonl"
    if args.tables:
        rows = {r["name"]: r for r in map(json.loads, record.read_text().splitlines())}
        for name in (line.split()[0] for line in CASES.strip().splitlines()):
            if name in rows:
                print(text_of_row(rows[name]))
        return
    for name, head, how, *limit in (line.split() for line in CASES.strip().splitlines()):
        if args.names and name not in args.names:
            continue
        at = made(args.trephine, folder, args.data, args.probes, name, head, how, float(limit[0]) if limit else None)
        row = run(args.trephine, folder, args.probes / "probe", name, at)
        row["program"] = subprocess.run([args.trephine, "--version"], capture_output=True, text=True).stdout.splitlines()[0]
        with open(record, "a") as out:
            out.write(json.dumps(row) + "\n")
        print(text_of_row(row), flush=True)


if __name__ == "__main__":
    import numpy as np
    main()
