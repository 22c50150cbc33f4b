#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume files that say something wrong: keys of NIfTI, NRRD, MetaImage, VTK, GIPL and MINC exchanged, shifted, doubled, scaled or
contradicted, and bytes added or cut off.

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


NRRD_KEYS = [("type", "short"), ("dimension", "3"), ("space", "left-posterior-superior"), ("sizes", "12 10 8"),
             ("space directions", "({},0,0) (0,{},0) (0,0,{})".format(*SPACING)), ("endian", "little"), ("encoding", "raw"),
             ("space origin", "({},{},{})".format(*ORIGIN))]


def nrrd(rnd):
    wrong = [("spacings", "1 1 1"), ("axis mins", "0 0 0"), ("old min", "-1024"), ("oldmax", "3071"), ("kinds", "vector domain domain"), ("units", '"cm" "cm" "cm"'),
             ("space units", '"s" "mm" "mm"'), ("byte skip", "2"), ("line skip", "1"), ("space origin", "(1e30,0,0)"), ("sizes", "12 10 9"),
             ("space directions", "(0,0,0) (0,1,0) (0,0,1)"), ("endian", "middle"), ("encoding", "gzip")]
    plain = [("content", "HU"), ("spacings", "nan nan nan"), ("kinds", "domain domain domain"), ("space units", '"mm" "mm" "mm"'), ("what is this", "3")]
    sound = rnd.random() < 0.3
    key, value = rnd.choice(plain if sound else wrong)
    keys = [(k, v) for k, v in NRRD_KEYS if k != key] + [(key, value)]
    return nrrd_text(keys) + DATA, sound, f"nrrd {key}: {value}"


def nrrd_text(keys):
    return ("NRRD0005\n" + "".join(f"{k}: {v}\n" for k, v in keys) + "\n").encode()


def vtk(rnd):
    lines = ["DIMENSIONS " + " ".join(map(str, SIZE)), "SPACING " + " ".join(map(str, SPACING)), "ORIGIN " + " ".join(map(str, ORIGIN)),
             f"POINT_DATA {SIZE[0] * SIZE[1] * SIZE[2]}", "SCALARS s short 1", "LOOKUP_TABLE default"]
    wrong = ["DIMENSIONS 12 10 9", "DIMENSIONS 12 10", "SPACING 2.5 3 0", "SPACING 2.5 3", "SPACING nan 3 4", "ORIGIN 1e30 0 0", "ORIGIN 0 0", "POINT_DATA 961",
             "CELL_DATA 960", "SCALARS s short 3", "SCALARS s int 1", "SCALARS s long 1", "SCALARS s bit 1", "COLOR_SCALARS s 1", "VECTORS v short",
             "FIELD f 1", "METADATA", "DIRECTION 0 1 0 1 0 0 0 0 1", "voxel_spacing 1 1 1", "true_origin 1 1 1", "DATASET RECTILINEAR_GRID"]
    plain = ["ASPECT_RATIO " + " ".join(map(str, SPACING)), "scalars other_name short", "WINDOW_LEVEL 40 400", "dimensions " + " ".join(map(str, SIZE)), ""]
    big = b"".join(DATA[i + 1:i + 2] + DATA[i:i + 1] for i in range(0, len(DATA), 2))
    sound, tail = rnd.random() < 0.3, b""
    line = rnd.choice(plain if sound else wrong)
    key = line.split(" ")[0].upper()
    key = {"ASPECT_RATIO": "SPACING", "CELL_DATA": "POINT_DATA", "COLOR_SCALARS": "SCALARS", "VECTORS": "SCALARS"}.get(key, key)
    known = [l.split(" ")[0] for l in lines]
    if key in known and rnd.random() < (1 if sound else 0.8):
        lines[known.index(key)] = line
    else:  # doubled, or not known
        lines.insert(rnd.randrange(1, 4), line)
        if key in known:
            sound = False
    what = "vtk " + line
    if rnd.random() < 0.3:
        tail, good = rnd.choice([(b"x", False), (b"\n", True), (b"\nMETADATA\nINFORMATION 0\n\n", True), (b"\nSCALARS b short\n", False), (DATA, False)])
        sound, what = sound and good, what + f", then {tail[:9]!r}"
        if tail == DATA and line == "SCALARS s int 1":
            tail = DATA[2:]  # else it is a sound file of other voxels, of twice the bytes
    head = "# vtk DataFile Version 3.0\na scan\nBINARY\nDATASET STRUCTURED_POINTS\n" + "\n".join(lines) + "\n"
    return head.encode() + big + tail, sound, what


def gipl(rnd):
    big = b"".join(DATA[i + 1:i + 2] + DATA[i:i + 1] for i in range(0, len(DATA), 2))
    h = bytearray(256)
    struct.pack_into(">5H", h, 0, *SIZE, 1, 15)
    struct.pack_into(">4f", h, 10, *SPACING, 0)
    struct.pack_into(">4d", h, 204, *ORIGIN, 0)
    struct.pack_into(">I", h, 252, 4026526128)
    kind = rnd.choice(["none", "patient", "display", "calibrated by 1", "axial", "matrix", "orientation", "offset", "scale", "gap", "volumes", "type", "origin",
                       "spacing", "size", "longer", "shorter", "magic"])
    sound = kind in ("none", "patient", "display", "calibrated by 1", "axial")
    at, form, values = {"patient": (26, "80s", [b"somebody"]), "display": (188, "2d", [-5]), "calibrated by 1": (240, "f", [1]), "axial": (186, "B", [9, 8, 1]),
                        "matrix": (106 + 4 * rnd.randrange(20), "f", [1, 0.5]), "orientation": (186, "B", [2, 10, 11, 12, 77]), "offset": (236, "f", [-1024, 1]),
                        "scale": (240, "f", [2, -1, 0.5]), "gap": (244, "f", [0.5, -1]), "volumes": (6, "H", [2]), "type": (8, "H", [1, 8, 31, 64, 144, 200]),
                        "origin": (204 + 8 * rnd.randrange(3), "d", [1e30, float("nan")]), "spacing": (10 + 4 * rnd.randrange(3), "f", [0, -2, float("nan")]),
                        "size": (2 * rnd.randrange(3), "H", [0, 9, 11, 60000]), "magic": (252, "I", [0, 815555000])}.get(kind, (0, "", [None]))
    value = rnd.choice(values)
    if form:
        struct.pack_into(">" + form, h, at, *([value] * (2 if form == "2d" else 1)))
    data = big + bytes(rnd.choice([1, 2, 400])) if kind == "longer" else big[:-rnd.choice([1, 2, 400])] if kind == "shorter" else big
    return bytes(h) + data, sound, f"gipl {kind} {value}"


def minc(rnd, good):
    """Of a file of ours: words of the same length in its attributes, and bytes added or cut off."""
    kind = rnd.choice(["none", "longer", "shorter", *[b"centre start_", b"regular__ irregular", b"true_ false", b"mm cm", b"zspace,yspace,xspace xspace,yspace,zspace",
                       b"valid_range wrong_range", b"image-max image-mix", b"step stop", b"start stara", b"direction_cosines direction_co_ines"]])
    if kind == "none":
        return good, True, "minc none"
    if kind == "longer":
        return good + b"x", None, "minc longer"
    if kind == "shorter":
        return good[:-rnd.choice([1, 400])], False, "minc shorter"
    before, after = kind.split(b" ")
    return good.replace(before + b"\0", after + b"\0"), False, "minc " + kind.decode()


def main():
    attack = common.Attack(__doc__, 400)
    rnd = attack.random
    base, made = attack.work / "base.nrrd", attack.work / "base.mnc"
    base.write_bytes(nrrd_text(NRRD_KEYS) + DATA)
    attack.run("a MINC file", "convert", base, "--output", made, "--quiet", allowed={0})
    good_minc = made.read_bytes()
    for n in range(attack.args.count):
        make, ending = rnd.choice([(nifti, ".nii"), (nifti, ".nii.gz"), (meta, ".mha"), (nrrd, ".nrrd"), (vtk, ".vtk"), (gipl, ".gipl"), (gipl, ".gipl.gz"),
                                   (lambda r: minc(r, good_minc), ".mnc")])
        data, sound, what = make(rnd)
        if ending.endswith(".gz"):
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
