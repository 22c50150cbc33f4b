# SPDX-License-Identifier: GPL-3.0-or-later
# overlap.py A.nrrd B.nrrd LEAST: Dice of what is positive in two fields on one raster (parts of it), at least LEAST.
# overlap.py --halve A.nrrd OUT.nrrd: what is positive as a label map of voxels twice as large in the slices (of four, two).
import array
import re
import sys
import zlib


def read(name):
    data = open(name, "rb").read()
    at = data.index(b"\n\n")
    head = dict(line.split(": ", 1) for line in data[:at].decode().split("\n") if ": " in line and line[0] != "#")
    body = zlib.decompress(data[at + 2:], 31) if head["encoding"].startswith("gz") else data[at + 2:]
    values = array.array({"float": "f"}[head["type"]])
    values.frombytes(body)
    size = [int(s) for s in head["sizes"].split()]
    origin = [float(v) for v in head["space origin"].strip("()").split(",")]
    spacing = [float(d.split(",")[a]) for a, d in enumerate(re.findall(r"\(([^)]*)\)", head["space directions"]))]
    first = [round(o / s * 4) for o, s in zip(origin, spacing)]
    inside = {(v % size[0], v // size[0] % size[1], v // (size[0] * size[1])) for v, f in enumerate(values) if f > 0}
    return inside, first, spacing


if sys.argv[1] == "--halve":
    inside, first, spacing = read(sys.argv[2])
    counts = {}
    for i, j, k in inside:
        cell = (i // 2, j // 2, k)
        counts[cell] = counts.get(cell, 0) + 1
    n = [max(c[a] for c in counts) + 2 for a in range(3)]
    values = bytearray(n[0] * n[1] * n[2])
    for (i, j, k), c in counts.items():
        values[i + n[0] * (j + n[1] * k)] = c >= 2
    origin = [f * s / 4 + (s / 2 if a < 2 else 0) for a, (f, s) in enumerate(zip(first, spacing))]
    with open(sys.argv[3], "wb") as out:
        out.write(("NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: %d %d %d\n"
                   "space directions: (%r,0,0) (0,%r,0) (0,0,%r)\nkinds: domain domain domain\nencoding: raw\n"
                   "space origin: (%r,%r,%r)\n\n" % (*n, 2 * spacing[0], 2 * spacing[1], spacing[2], *origin)).encode())
        out.write(values)
else:
    (a, at, _), (b, bt, _) = read(sys.argv[1]), read(sys.argv[2])
    shift = [round((q - p) / 4) for p, q in zip(at, bt)]
    b = {(i + shift[0], j + shift[1], k + shift[2]) for i, j, k in b}
    dice = 2 * len(a & b) / (len(a) + len(b))
    print("dice %.3f" % dice)
    sys.exit(not dice >= float(sys.argv[3]))
