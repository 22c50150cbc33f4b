#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the confidence of landmarks is earned: landmarks.py TREPHINE FOLDER [--probes FOLDER --data FOLDER] [NAME...]

Makes 45 phantoms once (n01 to n15 clinical, h01 to h15 and x01 to x10 hard, t01 to t05 with slices of 5 to 7 mm), with
256 x 256 pixels, and segments each with the values of pipelines/ventriculostomy.yaml; where a folder of points that a
reader placed is given, the real heads likewise. What was made stays in FOLDER, so that a second call runs `landmarks`
alone. It prints a row for each head, and at the end a row for each bin of confidence: how many landmarks lie in it, and
the share of them that lies within their radius (4 mm on phantoms, 8 mm in slices of 5 mm and more, the reader's on real
heads). With --svg FILE it draws that. Seconds are of the processor, user and system."""
import argparse
import json
import math
import os
import resource
import subprocess
import sys

PHANTOMS = """
n01 normal 101 12 1 192 0
n02 normal 102 8 2 96 0
n03 normal 103 20 3 64 0
n04 normal 104 16 1.5 128 0
n05 hydrocephalic 105 12 1 192 0
n06 hydrocephalic 106 20 2 96 0
n07 hydrocephalic 107 8 3 64 0
n08 shifted 108 20 1 192 0
n09 shifted 109 16 2 96 0
n10 shifted 110 8 3 64 0
n11 small 111 12 2 96 0
n12 small 112 20 1.5 128 0
n13 small 113 8 3 64 0
n14 normal 114 12 2 112 14
n15 shifted 115 16 1.5 150 -12
h01 normal 201 8 1 174 0 --mask --couch --clamps --burr-hole --field-of-view-mm 250 --centre-mm 0,20,42
h02 normal 202 5 3 90 0 --mask --couch --clamps --shoulders --field-of-view-mm 500 --centre-mm 0,40,-10
h03 hydrocephalic 203 20 1.5 128 0 --shunt --asymmetry-ratio 0.3 --fillings-count 3
h04 slit 204 10 1 192 0 --shunt --burr-hole --plexus
h05 small 205 25 2 96 0 --second-kernel-mm 0.6 --asymmetry-ratio 0.2
h06 normal 206 14 1 192 0 --kernel-mm 0.6 --sharpen-ratio 2 --plexus
h07 shifted 207 12 2 96 0 --blood subdural --couch --burr-hole
h08 normal 208 16 1.5 128 0 --blood intracerebral --contrast --motion-mm 2
h09 hydrocephalic 209 6 5 40 0 --blood intraventricular --couch --plexus
h10 shifted 210 15 1.5 128 0 --craniectomy --plexus --shunt
h11 normal 211 16 1 192 0 --field-of-view-mm 160 --round-field --asymmetry-ratio 0.35
h12 small 212 10 2 96 0 --clip --fillings-count 6 --streak-hu 400 --couch
h13 normal 213 12 2 96 0 --motion-mm 4 --mask --clamps --couch --field-of-view-mm 280
h14 hydrocephalic 214 60 1 192 0 --asymmetry-ratio 0.5 --slice-thickness-mm 2
h15 small 215 35 2.5 110 12 --shoulders --contrast --plexus --mask --field-of-view-mm 400 --centre-mm 0,20,0
x01 normal 2101 10 1.5 122 0 --field-of-view-mm 280 --centre-mm 0,25,42 --mask --couch --shunt --kernel-mm 1.4
x02 small 2102 9 2 92 0 --field-of-view-mm 250 --craniectomy --blood subdural --clip
x03 shifted 2103 14 1.5 122 0 --slice-thickness-mm 2.5 --kernel-mm 0.7 --sharpen-ratio 3 --plexus --burr-hole
x04 hydrocephalic 2104 8 3 70 0 --field-of-view-mm 400 --centre-mm 0,35,0 --mask --clamps --shoulders --blood intraventricular --couch
x05 slit 2105 12 1.5 122 0 --asymmetry-ratio 0.5 --contrast --couch --burr-hole
x06 normal 2106 28 2.5 76 -18 --fillings-count 5 --streak-hu 600 --mask
x07 hydrocephalic 2107 10 1.5 122 0 --field-of-view-mm 165 --round-field --shunt --plexus --blood intracerebral
x08 small 2108 12 2 92 0 --field-of-view-mm 260 --motion-mm 6 --motion-z-mm 70 --clamps --mask
x09 normal 2109 45 1.5 122 0 --craniectomy --shunt --clip --contrast
x10 shifted 2110 12 5 38 0 --field-of-view-mm 270 --clamps --couch --blood subdural --asymmetry-ratio 0.4
t01 normal 2201 8 5 38 0 --couch
t02 hydrocephalic 2202 6 5 40 -10 --blood intraventricular
t03 shifted 2203 7 6 32 0 --blood intracerebral --couch
t04 small 2204 8 7 28 0
t05 normal 2205 10 5 40 12 --blood subdural
"""
HARD = "hxt"
REAL = {  # where a scan is not one series of DICOM
    "head_toshiba_5mm": ["--series", "s4"],
    "head_mass_d2s": ["--volume-values", "hu"],
    "head_doe_ge": ["--series-rule", "best"],
}
BINS = [(0.0, 0.3), (0.3, 0.5), (0.5, 0.7), (0.7, 0.9), (0.9, 1.01)]
ASKED = {0.5: 0.5, 0.7: 0.7, 0.9: 0.9}


class Bench:
    def __init__(self, trephine):
        self.trephine = trephine

    def help_of_landmarks(self):
        return subprocess.run([self.trephine, "landmarks", "--help"], capture_output=True, text=True).stdout

    def run(self, *words, may_fail=False):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([self.trephine, *words, "--quiet"], stderr=subprocess.PIPE, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode and not may_fail:
            lines = [l for l in done.stderr.splitlines() if not l.startswith("warning")]
            raise RuntimeError(" ".join(words[:1]) + ": " + (lines[-1] if lines else "exit %d" % done.returncode))
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def once(self, made, *words, **more):
        """Runs a stage whose output is not there yet."""
        if os.path.exists(made):
            return 0.0
        return self.run(*words, "--output", made, **more)

    def segmented(self, at):
        """Skin, skull, and as far as the scan bears them brain and ventricles of FOLDER/volume.nrrd; the seconds."""
        f = lambda name: os.path.join(at, name + ".nrrd")
        s = self.once(f("body"), "body", f("volume"))
        s += self.once(f("head"), "head-region", f("body"))
        s += self.once(f("skin"), "segment", f("head"), *"--lower-hu -475 --open-mm 3 --components largest --fill "
                       "cavities_and_cut --fill-close-mm 6 --fill-max-ml 1000".split())
        s += self.once(f("skull"), "segment", f("head"), *"--lower-hu 226 --seed-lower-hu 400 --edge half_maximum "
                       "--min-component-ml 1 --fill cavities --fill-close-mm 2 --fill-max-ml 100 --within".split(), f("skin"))
        if not os.path.exists(os.path.join(at, "no_brain")):
            s += self.once(f("brain"), "brain", f("head"), "--skull", f("skull"), may_fail=True)
            if os.path.exists(f("brain")):
                s += self.once(f("ventricles"), "ventricles", f("head"), "--brain", f("brain"), may_fail=True)
            if not os.path.exists(f("ventricles")):
                open(os.path.join(at, "no_brain"), "w").close()
        return s

    def landmarks(self, at):
        f = lambda name: os.path.join(at, name + ".nrrd")
        words = ["landmarks", f("head"), "--skin", f("skin"), "--skull", f("skull")]
        if "--as-read" in self.help_of_landmarks():  # a program of before knows it not
            words += ["--as-read", f("volume")]
        for name in ("brain", "ventricles"):
            if os.path.exists(f(name)):
                words += ["--" + name, f(name)]
        out = os.path.join(at, "landmarks.json")
        try:
            seconds = self.run(*words, "--report", os.path.join(at, "report.json"), "--output", out)
        except RuntimeError as e:
            return None, str(e)
        with open(out) as file:
            return {m["name"]: m for m in json.load(file)["landmarks"]}, seconds


def phantom(bench, folder, row):
    name, variant, seed, noise, slice_mm, slices, tilt, *more = row.split()
    at = os.path.join(folder, name)
    seconds = 0.0
    if not os.path.exists(os.path.join(at, "volume.nrrd")):
        if "--field-of-view-mm" not in more:
            more += ["--field-of-view-mm", "240"]
        if "--slice-thickness-mm" not in more:
            more += ["--slice-thickness-mm", slice_mm]
        seconds = bench.run("phantom", at, "--level", "hard" if name[0] in HARD else "clinical", "--variant", variant,
                            "--seed", seed, "--noise-hu", noise, "--slice-step-mm", slice_mm, "--slices-count", slices,
                            "--tilt-deg", tilt, "--mesh-step-mm", "0", "--columns-count", "256", "--rows-count", "256",
                            "--subvoxel-mm", "0.9", *more)
        seconds += bench.run("import", os.path.join(at, "dicom"), "--series", "s1", "--output",
                             os.path.join(at, "volume.nrrd"))
    with open(os.path.join(at, "truth", "truth.json")) as file:
        truth = json.load(file)["landmarks_mm"]
    radius = 8.0 if float(slice_mm) >= 5 else 4.0
    return at, {n: (p, radius) for n, p in truth.items()}, seconds


def real(bench, folder, data, probe):
    with open(probe) as file:
        reference = json.load(file)
    name = os.path.splitext(os.path.basename(probe))[0]
    at = os.path.join(folder, name)
    os.makedirs(at, exist_ok=True)
    source = os.path.join(data, name)
    files = [os.path.join(root, f) for root, _, names in os.walk(source) for f in names]
    single = [f for f in files if f.endswith((".nii", ".nii.gz"))]
    seconds = 0.0
    volume = os.path.join(at, "volume.nrrd")
    if not os.path.exists(volume):
        seconds = bench.run("import", single[0] if single else source, *REAL.get(name, []), "--output", volume)
    marks = {n: (m["p"], m["radius_mm"]) for n, m in reference["landmarks"].items() if m}
    for n, m in reference["landmarks"].items():
        if m is None:
            marks[n] = (None, 0)  # a reader does not see it in the scan
    return at, marks, seconds


def draw(rows, path):
    """Share within the radius against confidence, with what is asked, as SVG."""
    w, h, left, top, size = 520, 380, 60, 20, 300
    x = lambda v: left + v * 400
    y = lambda v: top + (1 - v) * size
    out = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %d %d" font-family="sans-serif" font-size="12">' % (w, h),
           '<rect width="%d" height="%d" fill="white"/>' % (w, h)]
    for v in (0, .25, .5, .75, 1):
        out.append('<line x1="%g" y1="%g" x2="%g" y2="%g" stroke="#ddd"/>' % (x(0), y(v), x(1), y(v)))
        out.append('<text x="%g" y="%g" text-anchor="end">%d %%</text>' % (left - 6, y(v) + 4, 100 * v))
    for low, high, inside, count in rows:
        end = min(high, 1.0)
        if count:
            out.append('<rect x="%g" y="%g" width="%g" height="%g" fill="#5b8dc9"/>' % (
                x(low) + 1, y(inside / count), x(end) - x(low) - 2, y(0) - y(inside / count)))
            out.append('<text x="%g" y="%g" text-anchor="middle">%d of %d</text>' % (
                x((low + end) / 2), y(inside / count) - 5, inside, count))
        if low in ASKED:
            out.append('<line x1="%g" y1="%g" x2="%g" y2="%g" stroke="#c0392b" stroke-width="2"/>' % (
                x(low), y(ASKED[low]), x(end), y(ASKED[low])))
        out.append('<text x="%g" y="%g" text-anchor="middle">%g</text>' % (x(low), y(0) + 16, low))
    out.append('<text x="%g" y="%g" text-anchor="middle">1</text>' % (x(1), y(0) + 16))
    out.append('<text x="%g" y="%g" text-anchor="middle">confidence</text>' % (x(.5), y(0) + 36))
    out.append('<text x="%g" y="%g">share within the radius; red: asked</text></svg>' % (left, h - 8))
    with open(path, "w") as file:
        file.write("\n".join(out) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("trephine")
    parser.add_argument("folder")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--probes")
    parser.add_argument("--data")
    parser.add_argument("--svg")
    parser.add_argument("--ready", action="store_true", help="only heads that were made by an earlier call")
    args = parser.parse_args()
    bench = Bench(args.trephine)
    heads = [(row.split()[0], lambda row=row: phantom(bench, args.folder, row)) for row in PHANTOMS.strip().splitlines()]
    if args.probes:
        for file in sorted(os.listdir(args.probes)):
            if file.endswith(".json"):
                probe = os.path.join(args.probes, file)
                heads.append((file[:-5], lambda probe=probe: real(bench, args.folder, args.data, probe)))
    counts = {b: [0, 0] for b in BINS}
    for name, make in heads:
        if args.names and name not in args.names:
            continue
        if args.ready and not os.path.exists(os.path.join(args.folder, name, "skull.nrrd")):
            continue
        try:
            at, marks, made_s = make()
            made_s += bench.segmented(at)
        except RuntimeError as e:
            print("%-24s refused: %s" % (name, e))
            continue
        found, seconds = bench.landmarks(at)
        if found is None:
            print("%-24s no landmarks: %s" % (name, seconds))
            continue
        words = []
        for n, (p, radius) in marks.items():
            if n not in found:
                words.append("%s -" % n)
                continue
            c = found[n]["confidence"]
            off = math.dist(p, found[n]["position_mm"]) if p else math.inf
            for b in BINS:
                if b[0] <= c < b[1]:
                    counts[b][0] += off <= radius
                    counts[b][1] += 1
            beyond = "!" if off > radius and c >= 0.5 else "*" if off > radius else ""
            words.append("%s %.1f@%.2f%s" % (n, off, c, beyond))
        print("%-24s made %5.1f s, landmarks %4.1f s | %s" % (name, made_s, seconds, ", ".join(words)), flush=True)
    rows = []
    print("confidence    within their radius")
    for b in BINS:
        inside, count = counts[b]
        rows.append((b[0], b[1], inside, count))
        print("%.1f to %.1f    %3d of %3d%s" % (b[0], min(1, b[1]), inside, count,
                                            "  %3.0f %%" % (100 * inside / count) if count else ""))
    if args.svg:
        draw(rows, args.svg)
    return 0


if __name__ == "__main__":
    sys.exit(main())
