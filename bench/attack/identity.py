#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Slices of two patients in one series: some of them say another ID, name, date of birth, sex or the like.

Every mixture must be refused with 65 and without a word of either patient; with a reason it must be read."""
import shutil

import attributes
import common
import dicom

WHO = {
    (0x0010, 0x0010): ("PN", [common.CANARY + "^ONE", common.CANARY + "^TWO", common.CANARY + "^THREE^X"]),
    (0x0010, 0x0020): ("LO", [common.CANARY + "1", common.CANARY + "2", "4711"]),
    (0x0010, 0x0021): ("LO", ["NORTH" + common.CANARY, "SOUTH" + common.CANARY]),
    (0x0010, 0x0030): ("DA", ["19610203", "19340511", "20010909"]),
    (0x0010, 0x0032): ("TM", ["120305", "070809"]),
    (0x0010, 0x0040): ("CS", ["M", "F"]),
    (0x0010, 0x1005): ("PN", [common.CANARY + "^B1", common.CANARY + "^B2"]),
    (0x0010, 0x1060): ("PN", [common.CANARY + "^M1", common.CANARY + "^M2"]),
}
SAYS_NOTHING = {"LO": ["ANONYMOUS", "", "0"], "PN": ["", "ANONYMOUS", "Anonymous^"]}


def main():
    attack = common.Attack(__doc__, 200)
    rnd = attack.random
    head = attack.work / "head"
    attack.run("phantom", "phantom", head, "--columns-count", 40, "--rows-count", 40, "--slices-count", 10,
               "--field-of-view-mm", 80, "--slice-step-mm", 2, "--slice-thickness-mm", 1, "--centre-mm=0,-40,115",
               "--noise-hu", 3, "--mesh-step-mm", 0, "--no-labels", "--seed", attack.args.seed, "--quiet")
    slices = [(f.name, dicom.split(f.read_bytes())) for f in sorted((head / "dicom").iterdir())]
    for n in range(attack.args.count):
        kept = rnd.choice(["as it is", "without an ID", "all anonymous"])
        tag = rnd.choice(sorted(WHO))
        vr, values = WHO[tag]
        one, other = rnd.sample(values, 2)
        where = rnd.choice(["first", "middle", "last", "half", "every other", "some"])
        some = set(rnd.sample(range(len(slices)), rnd.randrange(1, len(slices) - 1)))
        folder = attack.work / "mutant"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        for i, (file, (meta, elements)) in enumerate(slices):
            if kept != "as it is":
                elements = [e for e in elements if e[0][0] != 0x0010]
            if kept == "all anonymous":
                for t in ((0x0010, 0x0010), (0x0010, 0x0020)):
                    elements = attributes.put(elements, t, WHO[t][0], rnd.choice(SAYS_NOTHING[WHO[t][0]]).encode())
            is_other = {"first": i == 0, "middle": i == 5, "last": i == 9, "half": i > 4, "every other": i % 2 == 1,
                        "some": i in some}[where]
            elements = attributes.put(elements, tag, vr, (other if is_other else one).encode())
            (folder / file).write_bytes(dicom.join(meta, elements))
        what = f"{tag[0]:04x},{tag[1]:04x} of two patients, {where}, {kept}"
        out = attack.work / "out.nrrd"
        code, _, err = attack.run(what, "import", folder, "--output", out, allowed={0, 64, 65})
        if code == 0:
            attack.find(what + ": read" + (", with a warning" if "warning" in err else ", without a word"))
            continue
        if "same_patient_reason" not in err:
            attack.find(what + f": exit {code}, and no key is named")
            continue
        code, _, err = attack.run(what + ", with a reason", "import", folder, "--output", out, "--same-patient-reason",
                                  "looked up at the desk", allowed={0})
        if code == 0 and "reason given" not in err:
            attack.find(what + ": with a reason nothing is told")
    attack.end()


if __name__ == "__main__":
    main()
