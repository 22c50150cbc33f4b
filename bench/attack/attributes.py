#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every attribute that says what pixels mean or where they lie, changed in one slice (first, middle, last) and in all.

The attributes and what must happen are read from the table in docs/reference/dicom.md. A slice that says otherwise must be refused with one
line, or be told of; where the rule is `own`, the volume must be the one before and nothing be told."""
import hashlib
import pathlib
import re
import shutil
import struct

import common
import dicom

TABLE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "reference" / "dicom.md"
VALUES = {
    "ImageType": ["DERIVED\\SECONDARY\\AXIAL", "ORIGINAL\\PRIMARY\\LOCALIZER", "DERIVED\\PRIMARY\\MPR"],
    "SOPClassUID": ["1.2.840.10008.5.1.4.1.1.4", "1.2.840.10008.5.1.4.1.1.7", "1.2.3.4"],
    "Modality": ["MR", "PT", "OT"],
    "ImagePositionPatient": ["0\\0\\0", "5\\5\\500"],
    "ImageOrientationPatient": ["0\\1\\0\\1\\0\\0", "1\\0\\0\\0\\-1\\0", "1\\0\\0\\0\\0.99939\\0.0349"],
    "PixelSpacing": ["1\\2", "3\\3", "2.1\\2.1"],
    "PixelAspectRatio": ["2\\1", "1\\3"],
    "PhotometricInterpretation": ["MONOCHROME1", "PALETTE COLOR", "RGB"],
    "BurnedInAnnotation": ["YES"],
    "QualityControlImage": ["YES"],
    "LossyImageCompression": ["01"],
    "RescaleSlope": ["2", "-1", "0.5"],
    "RescaleIntercept": ["0", "-1000", "24"],
    "RescaleType": ["US", "OD", "Z_EFF"],
    "PatientPosition": ["FFS", "HFP", "HFDR"],
    "ConvolutionKernel": ["H70h", "B31f", "BONE"],
    "Rows": [39, 20], "Columns": [41, 20], "SamplesPerPixel": [3], "BitsAllocated": [8, 32], "BitsStored": [10, 15],
    "HighBit": [9, 14], "PixelRepresentation": [1], "PixelPaddingValue": [1018, 0], "PixelPaddingRangeLimit": [1030, 0],
}


def rows():
    found = re.findall(r"^\| (\w+) \| \(([0-9A-F]{4}),([0-9A-F]{4})\) \| (\w\w) \| [^|]+ \| (\w+) \|", TABLE.read_text(), re.M)
    assert len(found) > 80, "the table of docs/reference/dicom.md was not found"
    return [(name, (int(g, 16), int(e, 16)), vr, rule) for name, g, e, vr, rule in found]


def value_of(rnd, name, vr):
    if name in VALUES:
        return rnd.choice(VALUES[name])
    if vr in ("US", "SS"):
        return rnd.randrange(1, 200)
    if vr in ("DS", "IS"):
        return str(rnd.randrange(1, 500))
    if vr in ("FD", "FL"):
        return rnd.uniform(1, 100)
    return {"DA": "20190812", "TM": "010203", "DT": "20190812010203", "AS": "077Y", "UI": "1.2.3.9"}.get(vr, common.CANARY)


def encode(vr, value):
    if vr in ("US", "SS"):
        return struct.pack("<H", value)
    if vr in ("FD", "FL"):
        return struct.pack("<d" if vr == "FD" else "<f", value)
    return value.encode()


def put(elements, tag, vr, data):
    new = (tag, dicom.pack(tag, vr, data))
    return sorted([e for e in elements if e[0] != tag] + [new], key=lambda e: e[0])


def main():
    attack = common.Attack(__doc__, 400)
    head = attack.work / "head"
    attack.run("phantom", "phantom", head, "--columns-count", 40, "--rows-count", 40, "--slices-count", 10,
               "--field-of-view-mm", 80, "--slice-step-mm", 2, "--slice-thickness-mm", 1, "--centre-mm=0,-40,115",
               "--noise-hu", 3, "--mesh-step-mm", 0, "--no-labels", "--seed", attack.args.seed, "--quiet")
    slices = [(f.name, dicom.split(f.read_bytes())) for f in sorted((head / "dicom").iterdir())]
    out = attack.work / "out.nrrd"
    # What is said of the series as it is (so small a field cuts the head) tells nothing of what was changed.
    _, _, err = attack.run("the series as it is", "import", head / "dicom", "--output", out, allowed={0})
    known = set(err.splitlines())
    before = hashlib.sha256(out.read_bytes()).hexdigest()
    table = [row for row in rows() if row[2] not in ("SQ", "UR")]
    places = [(row, where) for row in table for where in ("first", "middle", "last", "all")]
    attack.random.shuffle(places)
    silent = {}
    for n in range(attack.args.count):
        (name, tag, vr, rule), where = places[n % len(places)]  # all of them before any twice
        value = value_of(attack.random, name, vr)
        folder = attack.work / "mutant"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(head / "dicom", folder)
        at = {"first": [0], "middle": [len(slices) // 2], "last": [len(slices) - 1], "all": range(len(slices))}[where]
        same_as_before = True
        for i in at:
            file, (meta, elements) = slices[i]
            changed = put(elements, tag, vr, encode(vr, value))
            same_as_before = same_as_before and dict(changed)[tag] == dict(elements).get(tag)
            (folder / file).write_bytes(dicom.join(meta, changed))
        what = f"{name} = {value!r} in {where}, rule {rule}"
        out.unlink(missing_ok=True)
        code, _, err = attack.run(what, "import", folder, "--output", out)
        if code != 0:
            if out.exists():
                attack.find(what + ": refused, but there is an output")
            continue
        same = hashlib.sha256(out.read_bytes()).hexdigest() == before
        told = any("warning" in line for line in set(err.splitlines()) - known)
        if same_as_before or where == "all":
            continue
        if rule == "own" and name != "ImagePositionPatient":
            if not same or told:
                attack.find(what + (": another volume" if not same else ": told of"))
        elif not told:
            silent[name] = silent.get(name, 0) + 1
            attack.find(what + (": read as before" if same else ": another volume") + ", without a word")
    print(f"{sum(silent.values())} of {attack.args.count} without a word, in {len(silent)} attributes: {', '.join(sorted(silent))}")
    attack.end()


if __name__ == "__main__":
    main()
