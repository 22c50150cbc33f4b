#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Wrong landmarks: a nasion, or tragi, that a person gave in a wrong place.

Each set must be refused (81), by the removal or by the gate as a case asks it, or the face must be gone from the volume that is
published. With --points a person says where the face is: places on the skin of eyes, nose and mouth, {"tip of the nose": [x, y, z], ...}
in mm, LPS, of which none may have anything but air within --clear-mm. Without them it is where the found landmarks alone say: the gate
is asked with them about the surface of the volume that was made with the given ones."""
import array
import gzip
import json
import math
import sys

import common

FACE = ["nasion", "tragus_left", "tragus_right"]


class Volume:
    """A NRRD as the program writes it: int16 or float, of which single voxels are looked at."""

    def __init__(self, path):
        head, _, self.body = path.read_bytes().partition(b"\n\n")
        keys = dict(line.split(": ", 1) for line in head.decode().split("\n") if ": " in line)
        if keys["encoding"] == "gzip":
            self.body = gzip.decompress(self.body)
        assert keys["encoding"] in ("raw", "gzip") and sys.byteorder == "little", keys
        self.values = array.array({"short": "h", "int16": "h", "float": "f"}[keys["type"]])
        self.values.frombytes(self.body)
        self.size = [int(n) for n in keys["sizes"].split()]
        numbers = lambda text: [float(n) for n in text.strip("() ").split(",")]
        self.steps = [numbers(v) for v in keys["space directions"].split(") (")]
        self.origin = numbers(keys["space origin"])
        self.spacing = [math.sqrt(sum(c * c for c in step)) for step in self.steps]

    def near(self, point, reach_mm):
        """The values within reach of a place."""
        off = [p - o for p, o in zip(point, self.origin)]
        middle = [sum(a * b for a, b in zip(off, s)) / w / w for s, w in zip(self.steps, self.spacing)]
        span = [range(max(0, math.ceil(m - reach_mm / w)), min(n - 1, math.floor(m + reach_mm / w)) + 1)
                for m, w, n in zip(middle, self.spacing, self.size)]
        for k in span[2]:
            for j in span[1]:
                for i in span[0]:
                    if sum(((a - m) * w) ** 2 for a, m, w in zip((i, j, k), middle, self.spacing)) <= reach_mm * reach_mm:
                        yield self.values[(k * self.size[1] + j) * self.size[0] + i]


def shown(volume, points, clear_mm, air_hu=-700):
    """The points of the face that have something else than air near them."""
    return [name for name, at in points.items() if any(v > air_hu for v in volume.near(at, clear_mm))]


def main():
    attack = common.Attack(__doc__, 200, {"--series": {"help": "a head; without it a phantom is made"},
                                          "--points": {"help": "JSON of places on the skin of the face, placed by looking"},
                                          "--clear-mm": {"type": float, "default": 2, "help": "what must be air about each"},
                                          "--spacing-mm": {"type": float, "default": 0, "help": "voxels of this size, for speed"},
                                          "--believe": {"default": "both", "help": "given: what a scene that says so lets pass"},
                                          "--recipe-skin": {"default": "--lower-hu=-475 --open-mm=3 --components=largest "
                                                                      "--fill=cavities_and_cut --fill-close-mm=6"}})
    work, rnd = attack.work, attack.random
    attack.args.timeout_s = max(attack.args.timeout_s, 1200)
    series = attack.args.series
    if not series:
        attack.run("phantom", "phantom", work / "head", "--columns-count", 160, "--rows-count", 160, "--slices-count", 96,
                   "--field-of-view-mm", 240, "--slice-step-mm", 2, "--slice-thickness-mm", 2, "--mesh-step-mm", 0, "--no-labels",
                   "--seed", attack.args.seed, "--quiet", allowed={0})
        series = work / "head" / "dicom"
    volume, skin, skull, found = (work / n for n in ("volume.nrrd", "skin.nrrd", "skull.nrrd", "found.json"))
    segment = ["segment", volume, "--quiet", "--output"]
    attack.run("import", "import", series, "--output", volume, "--quiet", allowed={0})
    if attack.args.spacing_mm > 0:
        attack.run("resample", "resample", volume, "--spacing-mm", ",".join(["{:g}".format(attack.args.spacing_mm)] * 3), "--output", volume, "--quiet", allowed={0})
    points = json.loads(open(attack.args.points).read()) if attack.args.points else {}
    attack.run("skin", *segment, skin, *attack.args.recipe_skin.split(), allowed={0})
    attack.run("skull", *segment, skull, "--lower-hu=226", "--seed-lower-hu=400", "--min-component-ml=1", allowed={0})
    attack.run("landmarks", "landmarks", volume, "--skin", skin, "--skull", skull, "--output", found, "--quiet", allowed={0, 80})
    truth = json.loads(found.read_text()) if found.exists() else {"landmarks": []}
    names = {l["name"]: l for l in truth["landmarks"]}
    if not all(n in names and names[n]["confidence"] >= 0.5 for n in FACE):
        print("the face's landmarks are not found for sure in this head: every given set must be refused")
    if points:
        seen = shown(Volume(volume), points, 1.5)
        print(f"{len(seen)} of {len(points)} points lie on something in the scan")
        assert len(seen) == len(points), "a point hangs in the air: " + ", ".join(sorted(set(points) - set(seen)))
    believe = [] if attack.args.believe == "both" else ["--believe", attack.args.believe, "--believe-reason", "an attack"]
    accepted, refused, passed = 0, {"removal": 0, "gate": 0}, 0
    for n in range(attack.args.count):
        given = json.loads(json.dumps(truth))
        most = rnd.choice([8, 14, 30, 72])
        for landmark in given["landmarks"]:
            if landmark["name"] not in FACE or rnd.random() < 0.4:
                continue
            way = [rnd.gauss(0, 1) for _ in range(3)]
            length = math.sqrt(sum(w * w for w in way)) or 1
            landmark["position_mm"] = [p + w / length * rnd.uniform(0, most)
                                       for p, w in zip(landmark["position_mm"], way)]
            landmark["source"] = "given"
        if rnd.random() < 0.25:
            forward = rnd.uniform(10, 60)
            for landmark in given["landmarks"]:
                if landmark["name"].startswith("tragus"):
                    landmark["position_mm"][1] -= forward
                    landmark["source"] = "given"
        file, defaced, surface = work / "given.json", work / "defaced.nrrd", work / "surface.vtp"
        file.write_text(json.dumps(given))
        what = f"set {n}, up to {most} mm off"
        code, _, _ = attack.run(what, "deface", volume, "--skin", skin, "--landmarks", file, "--found", found, *believe, "--output",
                                defaced, "--quiet", allowed={0, 65, 81})
        if code != 0:
            refused["removal"] += 1
            continue
        code, _, _ = attack.run(what, "face-gate", skin, "--landmarks", file, "--found", found, *believe, "--ct", defaced, "--quiet",
                                allowed={0, 81})
        if code != 0:
            refused["gate"] += 1
            continue
        accepted += 1
        if points:
            left = shown(Volume(defaced), points, attack.args.clear_mm)
            if left:
                passed += 1
                attack.find(f"{what}: of the face are published: " + ", ".join(left))
            continue
        attack.run(what, "segment", defaced, "--quiet", "--output", work / "left.nrrd", *attack.args.recipe_skin.split(), allowed={0})
        attack.run(what, "contour", work / "left.nrrd", "--output", surface, "--quiet", allowed={0})
        code, _, err = attack.run(what, "face-gate", skin, "--landmarks", found, "--surface", f"skin={surface}", "--quiet",
                                  allowed={0, 81})
        if code == 81:
            passed += 1
            attack.find(what + ": a face is published: " + err.strip())
    print(f"{attack.args.count} sets: {refused['removal']} refused by the removal, {refused['gate']} by the gate, {accepted} accepted, "
          f"of which {passed} let a face pass")
    attack.end()


if __name__ == "__main__":
    main()
