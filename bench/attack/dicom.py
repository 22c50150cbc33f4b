#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Semantic mutants of a CT series: files that are well-formed DICOM but say something wrong, contradictory, or of somebody else.

Every mutant must be refused with one line (64, 65, 81), or be read without a word of the patient. What is read with another volume
than the series as it was, and without a warning, is listed as silent; --strict makes that a finding."""
import hashlib
import shutil
import struct

import common

LONG = {b"OB", b"OW", b"OF", b"OD", b"SQ", b"UN", b"UT", b"UC", b"UR"}
TEXTS = {
    (0x0008, 0x0008): ("CS", ["DERIVED\\SECONDARY\\MIP", "ORIGINAL\\PRIMARY\\LOCALIZER", "", "DERIVED\\PRIMARY\\AXIAL"]),
    (0x0008, 0x0060): ("CS", ["MR", "PT", "", "CT\\MR"]),
    (0x0010, 0x0020): ("LO", [common.CANARY, common.CANARY + "2", ""]),
    (0x0018, 0x0060): ("DS", ["80", "140", ""]),
    (0x0018, 0x1120): ("DS", ["15", "-15"]),
    (0x0018, 0x1210): ("SH", ["H70h", "B30f", ""]),
    (0x0018, 0x5100): ("CS", ["FFS", "HFP", "XYZ"]),
    (0x0020, 0x000D): ("UI", ["1.2.3.999", "1.2.3.998"]),
    (0x0020, 0x000E): ("UI", ["1.2.3.777"]),
    (0x0020, 0x0012): ("IS", ["1", "2", "9"]),
    (0x0020, 0x0032): ("DS", ["0\\0\\0", "0\\0\\1e6", "1\\2", "nan\\0\\0", "0\\0\\500", "-120\\-120\\33.37"]),
    (0x0020, 0x0037): ("DS", ["0\\0\\0\\0\\0\\0", "1\\0\\0\\0\\-1\\0", "-1\\0\\0\\0\\1\\0", "0\\1\\0\\1\\0\\0", "1\\0\\0\\0\\0.9994\\0.0349"]),
    (0x0020, 0x0052): ("UI", ["1.2.3.555", "1.2.3.556"]),
    (0x0028, 0x0030): ("DS", ["0\\0", "1\\2", "-1\\-1", "100\\100", "0.5"]),
    (0x0028, 0x0301): ("CS", ["YES", "NO"]),
    (0x0028, 0x1052): ("DS", ["0", "-8192", "1e9", "5000", "nan", ""]),
    (0x0028, 0x1053): ("DS", ["0", "-1", "2", "1e-9", "40", "nan"]),
    (0x0028, 0x1054): ("LO", ["US", "OD", "Z_EFF", "ED", "HU", common.CANARY]),
}
NUMBERS = {
    (0x0028, 0x0002): [0, 2, 3],
    (0x0028, 0x0010): [0, 1, 39, 65535],
    (0x0028, 0x0011): [0, 1, 41, 65535],
    (0x0028, 0x0100): [8, 12, 32],
    (0x0028, 0x0101): [0, 10, 17],
    (0x0028, 0x0102): [0, 7, 15],
    (0x0028, 0x0103): [0, 1, 2],
    (0x0028, 0x0120): [0, 63536],
}


def pack(tag, vr, value):
    if len(value) % 2:
        value += b"\0" if vr == "UI" else b" "
    head = struct.pack("<HH", *tag) + vr.encode()
    long = vr.encode() in LONG
    return head + (b"\0\0" + struct.pack("<I", len(value)) if long else struct.pack("<H", len(value))) + value


def split(data):
    """The file meta, and the elements of an explicit little-endian data set as (tag, bytes), up to the pixels."""
    at = 132
    while data[at:at + 2] == b"\2\0":
        at += element_size(data, at)
    meta, out = data[:at], []
    while at < len(data):
        size = element_size(data, at)
        out.append((struct.unpack("<HH", data[at:at + 4]), data[at:at + size]))
        at += size
    return meta, out


def element_size(data, at):
    if data[at + 4:at + 6] in LONG:
        return 12 + struct.unpack("<I", data[at + 8:at + 12])[0]
    return 8 + struct.unpack("<H", data[at + 6:at + 8])[0]


def join(meta, elements):
    return meta + b"".join(e for _, e in elements)


def mutate(attack, meta, elements):
    """One mutation of one slice, and what it is."""
    rnd = attack.random
    kind = rnd.choice(["text", "text", "text", "number", "drop", "twice", "after", "two files", "second pixels", "order", "cut"])
    elements = list(elements)
    if kind in ("text", "twice", "after"):
        tag = rnd.choice(sorted(TEXTS))
        vr, values = TEXTS[tag]
        new = (tag, pack(tag, vr, rnd.choice(values).encode()))
        if kind == "text":
            elements = [e for e in elements if e[0] != tag] + [new]
            elements.sort(key=lambda e: e[0])
        elif kind == "twice":
            elements.insert(rnd.randrange(len(elements)), new)
        else:
            elements.append(new)
        what = f"{kind} {tag[0]:04x},{tag[1]:04x} {new[1][8:40]!r}"
    elif kind == "number":
        tag = rnd.choice(sorted(NUMBERS))
        value = rnd.choice(NUMBERS[tag])
        elements = sorted([e for e in elements if e[0] != tag] + [(tag, pack(tag, "US", struct.pack("<H", value)))],
                          key=lambda e: e[0])
        what = f"number {tag[0]:04x},{tag[1]:04x} {value}"
    elif kind == "drop":
        gone = rnd.choice(elements)[0]
        elements = [e for e in elements if e[0] != gone]
        what = f"drop {gone[0]:04x},{gone[1]:04x}"
    elif kind == "two files":
        return join(meta, elements) + join(meta, elements), kind
    elif kind == "second pixels":
        elements.append(elements[-1])
        what = kind
    elif kind == "order":
        rnd.shuffle(elements)
        what = kind
    else:
        data = join(meta, elements)
        return data[:rnd.randrange(1, len(data))], kind
    return join(meta, elements), what


def main():
    attack = common.Attack(__doc__, 200, {"--strict": {"action": "store_true"}})
    head = attack.work / "head"
    attack.run("phantom", "phantom", head, "--columns-count", 40, "--rows-count", 40, "--slices-count", 10,
               "--field-of-view-mm", 80, "--slice-step-mm", 2, "--slice-thickness-mm", 1, "--centre-mm=0,-40,115",
               "--noise-hu", 3, "--mesh-step-mm", 0, "--no-labels", "--seed", attack.args.seed, "--quiet")
    slices = [(f.name, split(f.read_bytes())) for f in sorted((head / "dicom").iterdir())]
    good = attack.work / "good.nrrd"
    attack.run("the series as it is", "import", head / "dicom", "--output", good, "--quiet", allowed={0})
    before = hashlib.sha256(good.read_bytes()).hexdigest()
    silent = 0
    for n in range(attack.args.count):
        folder = attack.work / "mutant"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(head / "dicom", folder)
        how_many = attack.random.choice([1, 1, 1, len(slices) // 2, len(slices)])
        state = attack.random.getstate()
        what = ""
        for i in attack.random.sample(range(len(slices)), how_many):
            attack.random.setstate(state)  # the same mutation of each of them
            name, (meta, elements) = slices[i]
            data, what = mutate(attack, meta, elements)
            (folder / name).write_bytes(data)
        what = f"mutant {n}, {how_many} slices: {what}"
        out = attack.work / "out.nrrd"
        out.unlink(missing_ok=True)
        code, said, err = attack.run(what, "import", folder, "--output", out)
        if code != 0:
            if out.exists():
                attack.find(what + ": refused, but there is an output")
            continue
        data = out.read_bytes()
        if common.CANARY.encode() in data:
            attack.find(what + ": an identifier is in the volume")
        if hashlib.sha256(data).hexdigest() != before and "warning" not in err:
            silent += 1
            print("silent: " + what)
            if attack.args.strict:
                attack.find(what + ": another volume, without a word")
    print(f"{silent} of {attack.args.count} were read as another volume without a warning")
    attack.end()


if __name__ == "__main__":
    main()
