#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Wrong landmarks: a nasion, or tragi, that a person gave in a wrong place.

Each set must be refused (81), or the face that the found landmarks tell of must be gone: the gate is asked with the found landmarks
alone about the surface of the volume that was made with the given ones."""
import json
import math

import common

FACE = ["nasion", "tragus_left", "tragus_right"]


def main():
    attack = common.Attack(__doc__, 200, {"--series": {"help": "a head; without it a phantom is made"},
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
    attack.run("skin", *segment, skin, *attack.args.recipe_skin.split(), allowed={0})
    attack.run("skull", *segment, skull, "--lower-hu=226", "--seed-lower-hu=400", "--min-component-ml=1", allowed={0})
    attack.run("landmarks", "landmarks", volume, "--skin", skin, "--skull", skull, "--output", found, "--quiet", allowed={0, 80})
    truth = json.loads(found.read_text()) if found.exists() else {"landmarks": []}
    names = {l["name"]: l for l in truth["landmarks"]}
    if not all(n in names and names[n]["confidence"] >= 0.5 for n in FACE):
        print("the face's landmarks are not found for sure in this head: every given set must be refused")
    accepted = 0
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
        code, _, _ = attack.run(what, "deface", volume, "--skin", skin, "--landmarks", file, "--found", found, "--output", defaced,
                                "--quiet", allowed={0, 65, 81})
        if code != 0:
            continue
        accepted += 1
        attack.run(what, "segment", defaced, "--quiet", "--output", work / "left.nrrd", *attack.args.recipe_skin.split(), allowed={0})
        attack.run(what, "contour", work / "left.nrrd", "--output", surface, "--quiet", allowed={0})
        code, _, err = attack.run(what, "face-gate", skin, "--landmarks", found, "--surface", f"skin={surface}", "--quiet",
                                  allowed={0, 81})
        if code == 81:
            attack.find(what + ": a face is published: " + err.strip())
    print(f"{accepted} of {attack.args.count} sets were accepted")
    attack.end()


if __name__ == "__main__":
    main()
