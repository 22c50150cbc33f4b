#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume files that say something wrong: keys of NIfTI, NRRD and MetaImage exchanged, shifted, doubled, scaled or contradicted, and
bytes added or cut off.

A file is refused (65) with one line, or what is read has the voxels that were written, where the header as a reader of this script
understands it puts them. A refusal of what this script takes for sound is a finding too."""
import gzip
import struct

import common

SIZE, SPACING, ORIGIN = (12, 10, 8), (2.5, 3.0, 4.0), (-30.0, -41.5, 12.25)

def voxels():
    return [-1000 + (i * 7 + j * 31 + k * 101) % 1900 for k in range(SIZE[2]) for j in range(SIZE[1]) for i in range(SIZE[0])]


DATA = struct.pack(f"<{SIZE[0] * SIZE[1] * SIZE[2]}h", *voxels())


def nifti(rnd):
    """The bytes, whether they are sound, and what was changed."""
    h = bytearray(352)
    struct.pack_into("<i", h, 0, 348)
    struct.pack_into("<8h", h, 40, 3, *SIZE, 1, 1, 1, 1)
    struct.pack_into("<2h", h, 70, 4, 16)
    struct.pack_into("<8f", h, 76, 1, *SPACING, 0, 0, 0, 0)
    struct.pack_into("<f", h, 108, 352)
    struct.pack_into("<2f", h, 112, 1, 0)
    h[123] = 2
    struct.pack_into("<2h", h, 252, 0, 1)
    struct.pack_into("<12f", h, 280, -SPACING[0], 0, 0, -ORIGIN[0], 0, -SPACING[1], 0, -ORIGIN[1], 0, 0, SPACING[2], ORIGIN[2])
    h[344:348] = b"n+1\0"
    kind = rnd.choice(["none", "vox_offset", "origin", "dim", "longer", "shorter", "slope", "units", "type", "place"])
    data, sound = DATA, kind == "none"
    if kind == "vox_offset":
        offset = rnd.choice([0, 1, 2, 100, 344, 348, 349, 350, 351, 353, 354, 356, 368, 400])
        struct.pack_into("<f", h, 108, offset)
    elif kind == "origin":
        struct.pack_into("<f", h, rnd.choice([292, 308, 324]), rnd.choice([1e30, -1e30, 2e6, float("nan"), float("inf")]))
    elif kind == "dim":
        struct.pack_into("<h", h, 40 + 2 * rnd.randrange(8), rnd.choice([-1, 0, 2, 9, 11, 13, 32767]))
        sound = None
    elif kind == "longer":
        data += bytes(rnd.choice([1, 2, 400]))
    elif kind == "shorter":
        data = data[:-rnd.choice([1, 2, 400])]
    elif kind == "slope":
        struct.pack_into("<2f", h, 112, float("inf"), 0)
    elif kind == "units":
        h[123] = rnd.choice([4, 5, 6, 7])
    elif kind == "type":
        struct.pack_into("<2h", h, 70, rnd.choice([32, 128, 1792, 99]), 16)
    elif kind == "place":
        struct.pack_into("<f", h, 280 + 4 * rnd.randrange(3), rnd.choice([0.0, 40.0, float("nan")]))
        sound = None  # sheared, or scaled along an axis
    return bytes(h) + data, sound, "nifti " + kind


def meta(rnd):
    keys = [("ObjectType", "Image"), ("NDims", "3"), ("BinaryData", "True"), ("BinaryDataByteOrderMSB", "False"), ("CompressedData", "False"),
            ("TransformMatrix", "1 0 0 0 1 0 0 0 1"), ("Offset", " ".join(map(str, ORIGIN))), ("CenterOfRotation", "0 0 0"),
            ("ElementSpacing", " ".join(map(str, SPACING))), ("DimSize", " ".join(map(str, SIZE))), ("ElementType", "MET_SHORT")]
    wrong = [("ElementToIntensityFunctionSlope", "2"), ("ElementToIntensityFunctionOffset", "-1024"), ("DistanceUnits", "cm"), ("DistanceUnits", "um"),
             ("ElementByteOrderMSB", "True"), ("CenterOfRotation", "1 2 3"), ("Modality", "MET_MOD_MR"), ("HeaderSize", "2"), ("HeaderSize", "-1"),
             ("ElementNumberOfChannels", "3"), ("Position", "0 0 0"), ("Orientation", "0 1 0 1 0 0 0 0 1"), ("ObjectType", "Mesh"),
             ("Offset", "1e30 0 0"), ("ElementSpacing", "2.5 3 0"), ("DimSize", "12 10 9"), ("ElementType", "MET_USHORT_ARRAY"), ("BinaryData", "False")]
    plain = [("Comment", "a scan"), ("AnatomicalOrientation", "RAI"), ("Modality", "MET_MOD_CT"), ("ElementMin", "-5"), ("DistanceUnits", "mm"),
             ("WhatIsThis", "3"), ("ElementToIntensityFunctionSlope", "1")]
    sound = rnd.random() < 0.3
    key, value = rnd.choice(plain if sound else wrong)
    keys = [(k, v) for k, v in keys if k != key]
    keys.insert(rnd.randrange(1, len(keys)), (key, value))
    text = "".join(f"{k} = {v}\n" for k, v in keys) + "ElementDataFile = LOCAL\n"
    return text.encode() + DATA, sound, f"meta {key} = {value}"


def nrrd(rnd):
    directions = "({},0,0) (0,{},0) (0,0,{})".format(*SPACING)
    keys = [("type", "short"), ("dimension", "3"), ("space", "left-posterior-superior"), ("sizes", "12 10 8"), ("space directions", directions),
            ("endian", "little"), ("encoding", "raw"), ("space origin", "({},{},{})".format(*ORIGIN))]
    wrong = [("spacings", "1 1 1"), ("axis mins", "0 0 0"), ("old min", "-1024"), ("oldmax", "3071"), ("kinds", "vector domain domain"), ("units", '"cm" "cm" "cm"'),
             ("space units", '"s" "mm" "mm"'), ("byte skip", "2"), ("line skip", "1"), ("space origin", "(1e30,0,0)"), ("sizes", "12 10 9"),
             ("space directions", "(0,0,0) (0,1,0) (0,0,1)"), ("endian", "middle"), ("encoding", "gzip")]
    plain = [("content", "HU"), ("spacings", "nan nan nan"), ("kinds", "domain domain domain"), ("space units", '"mm" "mm" "mm"'), ("what is this", "3")]
    sound = rnd.random() < 0.3
    key, value = rnd.choice(plain if sound else wrong)
    keys = [(k, v) for k, v in keys if k != key] + [(key, value)]
    return ("NRRD0005\n" + "".join(f"{k}: {v}\n" for k, v in keys) + "\n").encode() + DATA, sound, f"nrrd {key}: {value}"


def main():
    attack = common.Attack(__doc__, 400)
    rnd = attack.random
    for n in range(attack.args.count):
        make, ending = rnd.choice([(nifti, ".nii"), (nifti, ".nii.gz"), (meta, ".mha"), (nrrd, ".nrrd")])
        data, sound, what = make(rnd)
        if ending == ".nii.gz":
            data = gzip.compress(data, 1, mtime=0)
            if rnd.random() < 0.2:
                data, sound, what = data + b"x" if rnd.random() < 0.5 else data[:-2], False, what + ", stream"
        file, out = attack.work / ("volume" + ending), attack.work / "out.nrrd"
        file.write_bytes(data)
        out.unlink(missing_ok=True)
        values = "hu" if "Modality" in what else "any"
        code, _, _ = attack.run(f"mutant {n}: {what}", "import", file, "--volume-values", values, "--output", out, allowed={0, 65})
        if values == "hu" and code == 65 and sound:
            continue  # these values are no patient's
        if sound and code != 0:
            attack.find(f"mutant {n}: {what}: refused, and sound")
        if sound is False and code == 0:
            attack.find(f"mutant {n}: {what}: read")
        if code == 0:
            head, _, body = out.read_bytes().partition(b"\n\n")
            if sound and (body != DATA or "({},{},{})".format(*map(short, ORIGIN)).encode() not in head.replace(b" ", b"")):
                attack.find(f"mutant {n}: {what}: other voxels, or another place")
            if not sound and sorted(body) != sorted(DATA):
                attack.find(f"mutant {n}: {what}: other voxels")
    attack.end()


def short(number):
    return repr(number).removesuffix(".0")


if __name__ == "__main__":
    main()
