#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that a recipe calls something else: of a head with two scans, of which the first may have lost its face elsewhere, surfaces by
any threshold, of either scan, in any box, under any name, and the scan itself.

What is published is measured by this script alone: with `deface` or `crop` nothing of it lies at the face's skin, as the phantom has it;
without a word of the face no surface shows most of it. Everything else is refused (81 or 80)."""
import json
import math
import pathlib
import shutil
import subprocess

import common
import landmarks

ROOT = pathlib.Path(__file__).resolve().parents[2]
NEAR_MM = 1.5  # of the skin: decimation may move a surface by less


def points_of(path):
    """The vertices of an OBJ file."""
    return [tuple(map(float, line.split()[1:4])) for line in path.read_text().split("\n") if line.startswith("v ")]


class Near:
    """Whether any of the points lies within reach."""

    def __init__(self, points, reach_mm):
        self.reach, self.cells = reach_mm, {}
        for p in points:
            self.cells.setdefault(tuple(math.floor(c / reach_mm) for c in p), []).append(p)

    def holds(self, p):
        i, j, k = (math.floor(c / self.reach) for c in p)
        return any(math.dist(p, q) <= self.reach for a in (-1, 0, 1) for b in (-1, 0, 1) for c in (-1, 0, 1)
                   for q in self.cells.get((i + a, j + b, k + c), ()))


def prepare(attack):
    """The head, its scan with and without the face, the truth of its landmarks, and places on nose and mouth."""
    work, quiet = attack.work, {"allowed": {0}}
    head = pathlib.Path(attack.args.head) if attack.args.head else work / "head"
    if not attack.args.head:
        subprocess.run(["bash", ROOT / "tests/program/head_with_mr.sh", head], check=True,
                       env={"TREPHINE": attack.args.trephine, "PATH": "/usr/bin:/bin"})
    truth = json.loads((head / "truth/truth.json").read_text())["landmarks_mm"]
    ct, skin = work / "ct.nrrd", work / "skin.nrrd"
    attack.run("import", "import", head / "dicom", "--output", ct, "--quiet", **quiet)
    attack.run("skin", "segment", ct, "--lower-hu", -475, "--open-mm", 3, "--components", "largest", "--fill", "cavities", "--fill-close-mm", 6,
               "--output", skin, "--quiet", **quiet)
    attack.run("skin", "contour", skin, "--output", work / "skin.vtp", "--quiet", **quiet)
    attack.run("skin", "decimate", work / "skin.vtp", "--max-deviation-mm", 0.3, "--output", work / "small.vtp", "--quiet", **quiet)
    attack.run("skin", "export", work / "small.vtp", "--format", "obj", "--out", work / "obj", "--quiet", **quiet)
    n = truth["nasion"]
    face = [p for p in points_of(next((work / "obj").glob("*.obj"))) if abs(p[0] - n[0]) < 22 and p[1] < n[1] + 15 and -62 < p[2] - n[2] < -8]
    three = {name: truth[name] for name in ("nasion", "tragus_left", "tragus_right")}
    (work / "marks.json").write_text(json.dumps({"midsagittal": {"point_mm": n, "normal": [1, 0, 0], "confidence": 1}, "landmarks": [
        {"name": name, "position_mm": p, "confidence": 1, "source": "found"} for name, p in three.items()]}))
    attack.run("deface", "deface", ct, "--skin", skin, "--landmarks", work / "marks.json", "--depth-mm", 40, "--side-depth-mm", 40, "--output",
               work / "defaced.nrrd", "--quiet", **quiet)
    root = work / "root"
    for name in ("pipelines", "configs"):
        shutil.copytree(ROOT / name, root / name)
    (root / "trephine.root").touch()
    shutil.copy(head / "second/truth.tfm", root / "configs")
    print(f"{len(face)} places on the face")
    assert len(face) > 100
    return head, three, face


def recipe(rnd, n):
    """One more anatomy of either scan, as somebody might write it who wants the face, or does not know of it."""
    scan = rnd.choice(["mr", "mr", "mr", ""])
    step = {"components": rnd.choice(["largest", "largest", "all"])}
    lower = rnd.choice([30, 80, 150, 300]) if scan else rnd.choice([-800, -475, -200, 20, 226])
    step["lower_hu"] = lower
    if scan:
        step["scan"] = scan
    if rnd.random() < 0.3:
        step["upper_hu"] = lower + rnd.choice([150, 400, 900])
    if rnd.random() < 0.3:
        step["open_mm"] = rnd.choice([1, 3])
    if rnd.random() < 0.6:  # a box about the face, or part of it
        low = [n[0] - rnd.uniform(15, 60), n[1] - rnd.uniform(20, 70), n[2] - rnd.uniform(50, 100)]
        high = [n[0] + rnd.uniform(15, 60), n[1] + rnd.uniform(5, 60), n[2] + rnd.uniform(-15, 30)]
        step["roi_min_mm"], step["roi_max_mm"] = ([round(c, 1) for c in v] for v in (low, high))
    name = rnd.choice(["more", "tumour", "vessel", "sinus", "implant"])
    stages = [{"segment": step}, "contour", {"decimate": {"max_deviation_mm": rnd.choice([0.2, 0.8])}}] + rnd.choice([[], ["smooth"]]) + ["normals"]
    return name, {"shows_face": False, "stages": stages}


def main():
    attack = common.Attack(__doc__, 40, {"--head": {"help": "what tests/program/head_with_mr.sh made; else it is made"}})
    rnd, work = attack.random, attack.work
    head, three, face = prepare(attack)
    configs, counts = work / "root/configs", {}
    for n in range(attack.args.count):
        name, anatomy = recipe(rnd, three["nasion"])
        deep = {"shows_face": False, "stages": [{"segment": {"lower_hu": 226, "min_component_ml": 1}}, "contour", "decimate", "normals"]}
        bare = rnd.random() < 0.3  # a scene, and a recipe, without a word of the face
        skin = (ROOT / "pipelines/head_ct_mr.yaml").read_text()
        text = json.dumps({"trephine": 1, "anatomies": {name: anatomy, "deep": deep}})
        if not bare:
            text = skin.replace("anatomies:\n", f"anatomies:\n  {name}: {json.dumps(anatomy)}\n  deep: {json.dumps(deep)}\n", 1)
        (work / "root/pipelines/attack.yaml").write_text(text)
        policy = rnd.choice(["deface", "deface", "crop"])
        scene = {"trephine": 1, "anatomies": rnd.choice([{name: {}}, {name: {}, "deep": {}}])}
        config = {"trephine": 1, "case": "face", "pipeline": "../pipelines/attack.yaml", "scene": "attack_scene.yaml",
                  "import": {"volume_values": "hu"},
                  "scans": {"mr": {"modality": "mr", "register": {"given": "truth.tfm", "largest_given_mm": 3}}}}
        if not bare:
            scene["face"] = {"policy": policy, "believe": "given", "believe_reason": "the face was taken off before"}
            off = rnd.choice([0, 0, 0, 5])
            config["landmarks"] = {k: [c + rnd.uniform(-off, off) for c in p] for k, p in three.items()}
        if rnd.random() < 0.3:
            scene["ct"] = {}
        (configs / "attack_scene.yaml").write_text(json.dumps(scene))
        (configs / "attack.yaml").write_text(json.dumps(config))
        series = rnd.choice([work / "defaced.nrrd", work / "defaced.nrrd", work / "ct.nrrd"])
        shutil.rmtree(work / "out", ignore_errors=True)
        what = f"{n}: {name} {json.dumps(anatomy['stages'][0])}, {'no word of the face' if bare else policy}, {series.stem}, {list(scene)[2:]}"
        code, _, _ = attack.run(what, "run", configs / "attack.yaml", "--series", series, "--scan", f"mr={head / 'second/scan.nrrd'}", "--out",
                                work / "out", "--quiet", "--no-page", "--no-pictures", allowed={0, 65, 78, 80, 81})
        if code == 0:
            case = work / "out/face"
            manifest = json.loads((case / "case.json").read_text())
            shutil.rmtree(work / "obj", ignore_errors=True)
            attack.run(what + ": export", "export", case, "--format", "obj", "--out", work / "obj", "--quiet", allowed={0})
            most = 0.6 if bare else 0.05
            for file in sorted((work / "obj").glob("*.obj")):
                near = Near(points_of(file), NEAR_MM)
                share = sum(near.holds(p) for p in face) / len(face)
                if share > most:
                    attack.find(f"{what}: {file.stem} shows {100 * share:.0f} % of the face")
            ct = manifest.get("ct") or {}
            if ct.get("file") and not bare:
                volume = landmarks.Volume(case / ct["file"])
                some = dict(enumerate(rnd.sample(face, 60)))
                left = landmarks.shown(volume, some, 1.5)
                if len(left) > 3:
                    attack.find(f"{what}: the scan shows {len(left)} of 60 places on the face")
        counts[code] = counts.get(code, 0) + 1
    print(", ".join(f"{count} end with {code}" for code, count in sorted(counts.items())))
    attack.end()


if __name__ == "__main__":
    main()
