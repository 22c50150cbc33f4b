#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""30 heads with fresh blood (each kind, 5 to 70 ml, slices of 1 to 5 mm, ten with contrast medium) and 30 without.

    bench/bleeds.py TREPHINE FOLDER [NAME ...]

Makes the phantoms once, runs a case of brain and ventricles from each, and prints a row of a table: how much blood there is, how the case's
verdict begins, Dice of the ventricles with the truth (blood in them belongs to them), the findings that are sure and not usual for that
head, and CPU seconds. Even numbers were kept back while the thresholds were chosen. The last lines count.
"""
import json
import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from thick_heads import ROOT, measured, trephine, used  # noqa: E402

KINDS = ["intracerebral", "subdural", "intraventricular"]
VARIANTS = ["normal", "hydrocephalic", "shifted", "small", "normal"]
SCENE = """trephine: 1
anatomies:
  brain: {max_triangles: 40000, max_deviation_mm: 1.5, stand_in: simple_brain}
  ventricles: {max_triangles: 25000, max_deviation_mm: 1.0, may_be_missing: true}
materials: materials.yaml
haptic:  # a coarse one, so that the skull is a part of the scene
  spacing_mm: [2, 2, 2]
  region_of: brain
  margin_mm: 15
  shapes: {skull: {material: bone}}
face: {policy: keep, reason: a phantom}
"""


def heads():
    draw = random.Random(57)
    for n in range(60):
        kind = KINDS[n % 3] if n < 30 else "none"
        ml = round(5 * 14 ** ((n // 3 % 10) / 9), 1) if n < 30 else 0
        step = [1, 2, 3, 4, 5][(n + n // 5) % 5]
        variant = "hydrocephalic" if kind == "intraventricular" and ml > 8 else VARIANTS[n // 2 % 5]
        yield {"name": f"b{n:02d}", "kind": kind, "ml": ml, "step": step, "variant": variant, "contrast": n % 30 % 3 == n % 30 // 10,
               "seed": 5701 + n, "noise": draw.choice([4, 6, 8, 10]) * (1.5 if step < 2 else 1), "tilt": draw.choice([0, 0, 0, -12, 10]),
               "more": draw.choice([[], [], ["--plexus"], ["--mask"], ["--couch"]])}


def made(program, at, h):
    if (at / "dicom").exists():
        return
    code, message = trephine(
        program, "phantom", at, "--level", "hard", "--variant", h["variant"], "--seed", h["seed"], "--noise-hu", h["noise"], "--slice-step-mm",
        h["step"], "--slice-thickness-mm", h["step"], "--slices-count", 184 // h["step"], "--tilt-deg", h["tilt"], "--columns-count", 256,
        "--rows-count", 256, "--field-of-view-mm", 240, "--mesh-step-mm", 0, "--no-labels", "--quiet", "--blood", h["kind"], "--blood-ml", h["ml"],
        *(["--contrast"] if h["contrast"] else []), *h["more"])
    if code:
        sys.exit(f"{h['name']}: {message}")


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    program, folder, names = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), sys.argv[3:]
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.yaml").write_text(SCENE)
    (folder / "pipeline.yaml").write_text((ROOT / "pipelines/ventriculostomy.yaml").read_text())
    (folder / "materials.yaml").write_text((ROOT / "configs/materials.yaml").read_text())
    (folder / "case.yaml").write_text("trephine: 1\npipeline: pipeline.yaml\nscene: scene.yaml\n")
    first = {k: [0, 0] for k in ["5 to 20 ml", "above 20 ml", "without"]}
    other = 0
    print("| head | | blood | verdict begins | Dice brain, ventricles | other sure findings | CPU s |\n|---|---|---|---|---|---|---|")
    for h in heads():
        if names and h["name"] not in names:
            continue
        at, keep = folder / h["name"], folder / h["name"] / "keep"
        made(program, at, h)
        before = used()
        code, message = trephine(program, "run", folder / "case.yaml", "--series", at / "dicom", "--out", folder / "library", "--case", h["name"],
                                 "--no-page", "--no-pictures", "--keep", keep, "--quiet")
        seconds = used() - before
        what = f"{h['variant']} {h['step']} mm{' contrast' if h['contrast'] else ''} {' '.join(h['more'])}"
        if code:
            print(f"| {h['name']} | {what} | {h['kind']} {h['ml']} ml | {code}: {message.strip().splitlines()[-1][:200]} | | | {seconds:.0f} |", flush=True)
            continue
        case = json.loads((folder / "library" / h["name"] / "case.json").read_text())
        verdict = dict(case["figures"])["verdict"] if isinstance(case["figures"], dict) else {f["name"]: f["value"] for f in case["figures"]}["verdict"]
        bleed = verdict.startswith("to be looked at first")
        of = first["without" if h["kind"] == "none" else "above 20 ml" if h["ml"] > 20 else "5 to 20 ml"]
        of[0] += bleed
        of[1] += 1
        usual = {"dense_tissue"} | ({"midline_shift"} if h["variant"] == "shifted" else set()) | (
            {"wide_ventricles"} if h["variant"] == "hydrocephalic" else set())
        sure = [f"{f['kind']} {f['figures'].get('volume_ml', '')}" for f in case.get("findings", []) if f["confidence"] >= 0.5 and f["kind"] not in usual]
        other += len(sure)
        dense = [f"{f['figures']['volume_ml']:.0f} ml {f['confidence']:.2f}" for f in case.get("findings", []) if f["kind"] == "dense_tissue"]
        dice = ", ".join(f"{measured(program, at, keep, a, 'dice_ratio'):.3f}" for a in ("brain", "ventricles"))
        print(f"| {h['name']} | {what} | {h['kind']} {h['ml']} ml | {'bleed' if bleed else 'no bleed'} ({', '.join(dense)}) | "
              f"{dice} | {', '.join(sure)} | {seconds:.0f} |", flush=True)
    for name, (yes, n) in first.items():
        print(f"{name}: the verdict begins with a bleed in {yes} of {n}")
    print(f"other sure findings: {other}")


if __name__ == "__main__":
    main()
