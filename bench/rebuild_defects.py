#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""rebuild_defects.py DEFECT IN.nrrd OUT.nrrd: rebuilds a defect that a scan from elsewhere had, in a volume that `trephine import`
wrote. The voxels change and the header's directions do not, as with a program that turns or mirrors pictures and keeps their tags.
The file says in a comment that it is rebuilt, and how. Read it with `--series OUT.nrrd --set import.volume_values=hu`.

  mirror-x, mirror-y, mirror-z   the voxels along one axis in the reverse order: a mirror image
  turn-x, turn-y, turn-z         half a turn about an axis: the two others are reversed
  quarter-z                      a quarter of a turn in the slices, which must be as wide as high
  no-offset                      1024 is added to every value, as where the offset of -1024 was not applied
"""
import array
import gzip
import sys

TYPES = {"short": "h", "int16": "h", "signed short": "h", "float": "f"}


def read(path):
    data = open(path, "rb").read()
    end = data.index(b"\n\n") + 2
    header = data[:end].decode("latin-1").split("\n")
    fields = dict(line.split(": ", 1) for line in header if ": " in line and not line.startswith("#"))
    body = data[end:]
    if fields["encoding"] in ("gzip", "gz"):
        body = gzip.decompress(body)
    voxels = array.array(TYPES[fields["type"]])
    voxels.frombytes(body)
    if fields.get("endian", "little") != sys.byteorder:
        voxels.byteswap()
    return header, fields, voxels


def write(path, header, voxels, how):
    lines = [line for line in header if line]
    lines.insert(1, "# rebuilt: " + how)
    text = "\n".join("encoding: raw" if line.startswith("encoding:") else line for line in lines)
    with open(path, "wb") as out:
        out.write(text.encode("latin-1") + b"\n\n")
        voxels.tofile(out)


def reversed_along(voxels, size, axes):
    nx, ny, nz = size
    out = array.array(voxels.typecode)
    for k in range(nz):
        from_k = nz - 1 - k if 2 in axes else k
        for j in range(ny):
            from_j = ny - 1 - j if 1 in axes else j
            begin = (from_k * ny + from_j) * nx
            row = voxels[begin : begin + nx]
            if 0 in axes:
                row.reverse()
            out.extend(row)
    return out


def quarter(voxels, size):
    nx, ny, nz = size
    if nx != ny:
        sys.exit("quarter-z: the slices must be as wide as high")
    out = array.array(voxels.typecode)
    for k in range(nz):
        slice_ = voxels[k * nx * ny : (k + 1) * nx * ny]
        for j in range(ny):
            out.extend(slice_[j::nx])  # column j becomes row j: then the rows are turned round
    return reversed_along(out, size, {0})


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    defect, source, target = sys.argv[1:]
    header, fields, voxels = read(source)
    size = [int(n) for n in fields["sizes"].split()]
    axis = {"x": 0, "y": 1, "z": 2}.get(defect[-1])
    if defect.startswith("mirror-") and axis is not None:
        voxels = reversed_along(voxels, size, {axis})
    elif defect.startswith("turn-") and axis is not None:
        voxels = reversed_along(voxels, size, {0, 1, 2} - {axis})
    elif defect == "quarter-z":
        voxels = quarter(voxels, size)
    elif defect == "no-offset":
        voxels = array.array(voxels.typecode, (v + 1024 for v in voxels))
    else:
        sys.exit(f"{defect}: no such defect\n{__doc__}")
    write(target, header, voxels, defect)


if __name__ == "__main__":
    main()
