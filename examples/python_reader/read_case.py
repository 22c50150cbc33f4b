#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a case of Trephine with numpy and the standard library; docs/reference/case-package.md is the specification.

    python3 read_case.py CASE            lists what is in the case
    case = read_case.load("CASE")        for programs: see Case

Positions are DICOM patient LPS in millimetres. Every file is read once, and the bytes that were hashed are the bytes that
are parsed. A checksum says that a file is what was written, not that who wrote it meant well, so counts are checked too.
"""
import gzip
import hashlib
import io
import json
import pathlib
import re
import struct
import sys

import numpy as np

MAJOR = 2
MOST_JSON_BYTES = 4 << 20


class CaseError(ValueError):
    """The folder holds no case that this program can read; the message names file and field."""


class Surface:
    """points (n, 3) float64 LPS mm, normals (n, 3) float32, triangles (m, 3) uint32."""

    def __init__(self, points, normals, triangles):
        self.points, self.normals, self.triangles = points, normals, triangles

    def volume_ml(self):
        a, b, c = (self.points[self.triangles[:, i]] - self.points.mean(axis=0) for i in range(3))
        return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6000)

    def area_cm2(self):
        a, b, c = (self.points[self.triangles[:, i]] for i in range(3))
        return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 200)


class Volume:
    """voxels[k, j, i]; position in LPS mm of voxel (i, j, k): origin + i * axes[0] + j * axes[1] + k * axes[2]."""

    def __init__(self, voxels, origin, axes):
        self.voxels, self.origin, self.axes = voxels, origin, axes

    def position(self, i, j, k):
        return self.origin + np.array([i, j, k], float) @ self.axes


class Case:
    """manifest: case.json as it is. surfaces: by anatomy. haptic, hardness, ct: Volume or None."""

    def __init__(self, manifest, surfaces, haptic, hardness, ct):
        self.manifest, self.surfaces = manifest, surfaces
        self.haptic, self.hardness, self.ct = haptic, hardness, ct

    def points(self):
        """Landmarks and targets by name, LPS mm."""
        m = self.manifest
        return {p["name"]: np.array(p["position_mm"], float) for p in m["landmarks"] + m["targets"]}

    def shape(self, name):
        """Mask over haptic.voxels: what belongs to that shape."""
        for s in self.manifest["haptic"]["shapes"]:
            if s["name"] == name:
                low, high = s["window"]
                return (self.haptic.voxels >= low) & (self.haptic.voxels <= high)
        raise KeyError(name)


def refuse(where, what):
    raise CaseError(f"{where}: {what}")


def read_manifest(folder):
    file = folder / "case.json"
    with open(file, "rb") as f:
        data = f.read(MOST_JSON_BYTES + 1)
    if len(data) > MOST_JSON_BYTES:
        refuse(file, "is longer than 4 MiB")
    version = re.match(rb'{\n "format": "trephine-case ([0-9]{1,4})\.([0-9]{1,4})",', data)
    if version is None:
        refuse(file, "format: not a case.json of Trephine")
    major, minor = map(int, version.groups())
    if major != MAJOR:
        remedy = "make the case again with `trephine run`" if major < MAJOR else "take a newer reader"
        refuse(file, f"format: version {major}.{minor}, this program reads versions {MAJOR}.*: {remedy}")
    mark = b',\n "checksum": "'
    at = data.rfind(mark)
    if at < 0 or data[at + len(mark):] != hashlib.sha256(data[:at]).hexdigest().encode() + b'"\n}\n':
        refuse(file, "checksum: the file is damaged, or was edited by hand")
    return json.loads(data)


def read_files(folder, manifest):
    """The bytes of every file of the case, by name; the large ones too, so a case of 100 MB takes 100 MB."""
    files = {}
    for entry in manifest["files"]:
        name = entry["name"]
        if name.startswith("/") or ".." in name.split("/"):
            refuse("case.json", f"files: {name} leads out of the case")
        with open(folder / name, "rb") as f:
            data = f.read(entry["bytes"] + 1)
        if len(data) != entry["bytes"] or hashlib.sha256(data).hexdigest() != entry["sha256"]:
            refuse(folder / name, "is not what case.json says: damaged, or another version")
        files[name] = data
    return files


def parse_glb(name, data):
    """One mesh of one primitive, float32 mm about the case's centre (the node's extras)."""
    try:
        magic, version, total, json_bytes, json_kind = struct.unpack_from("<4sIII4s", data)
        if magic != b"glTF" or version != 2 or total != len(data) or json_kind != b"JSON":
            refuse(name, "is no binary glTF 2.0")
        gltf = json.loads(data[20:20 + json_bytes])
        size, kind = struct.unpack_from("<I4s", data, 20 + json_bytes)
        binary = data[28 + json_bytes:28 + json_bytes + size]
        if kind != b"BIN\0" or len(binary) != size:
            refuse(name, "its binary chunk is cut short")
        primitive = gltf["meshes"][0]["primitives"][0]

        def array(accessor, dtype, columns):
            a = gltf["accessors"][accessor]
            view = gltf["bufferViews"][a["bufferView"]]
            begin = view.get("byteOffset", 0) + a.get("byteOffset", 0)
            count = a["count"] * columns
            if count < 0 or begin < 0 or begin + count * np.dtype(dtype).itemsize > len(binary) or "byteStride" in view:
                refuse(name, f"accessor {accessor} does not fit")
            return np.frombuffer(binary, dtype, count, begin).reshape(-1, columns) if columns > 1 else \
                np.frombuffer(binary, dtype, count, begin)

        position = array(primitive["attributes"]["POSITION"], "<f4", 3)
        normal = array(primitive["attributes"]["NORMAL"], "<f4", 3)
        index_type = {5123: "<u2", 5125: "<u4"}[gltf["accessors"][primitive["indices"]]["componentType"]]
        triangles = array(primitive["indices"], index_type, 1).astype(np.uint32).reshape(-1, 3)
        node = gltf["nodes"][0]
        if node["extras"]["frame"] != "LPS" or node["extras"]["unit"] != "mm":
            refuse(name, "is not in LPS, mm")
        centre = np.array(node["extras"]["center_mm"], float)
    except (KeyError, IndexError, struct.error, UnicodeDecodeError, json.JSONDecodeError) as e:
        refuse(name, f"is not a surface of a case: {e!r}")
    if not np.isfinite(position).all() or (triangles.size and triangles.max() >= len(position)):
        refuse(name, "points that are not finite, or triangles of points that are not there")
    return Surface(position.astype(float) + centre, normal, triangles)


def parse_nrrd(name, data):
    """One attached NRRD of three axes, raw or gzip, little endian, LPS, as Trephine writes it."""
    head, _, body = data.partition(b"\n\n")
    lines = head.decode("ascii", "replace").split("\n")
    if not lines[0].startswith("NRRD"):
        refuse(name, "is no NRRD file")
    field = dict(line.split(": ", 1) for line in lines[1:] if ": " in line and not line.startswith("#"))
    try:
        if field["dimension"] != "3" or field["space"] != "left-posterior-superior":
            refuse(name, "must have three axes in left-posterior-superior")
        size = [int(n) for n in field["sizes"].split()]
        dtype = {"int16": "<i2", "short": "<i2", "uint8": "u1", "unsigned char": "u1", "float": "<f4"}[field["type"]]
        axes = np.array([[float(x) for x in v.strip("()").split(",")] for v in field["space directions"].split()])
        origin = np.array([float(x) for x in field["space origin"].strip("()").split(",")])
        if np.dtype(dtype).itemsize > 1 and field["endian"] != "little":
            refuse(name, "must be little endian")
        encoding = field["encoding"]
    except (KeyError, ValueError) as e:
        refuse(name, f"header: {e!r}")
    count = int(np.prod(size, dtype=object)) * np.dtype(dtype).itemsize
    if encoding in ("gzip", "gz"):
        with gzip.open(io.BytesIO(body)) as stream:
            body = stream.read(count + 1)
    elif encoding != "raw":
        refuse(name, f"encoding {encoding}")
    if len(body) != count or len(size) != 3 or min(size) < 1:
        refuse(name, "sizes and data disagree")
    return Volume(np.frombuffer(body, dtype).reshape(size[::-1]), origin, axes)


def load(folder):
    folder = pathlib.Path(folder)
    manifest = read_manifest(folder)
    files = read_files(folder, manifest)
    surfaces = {a["name"]: parse_glb(a["file"], files[a["file"]]) for a in manifest["anatomies"] if a.get("file")}

    def volume(part, key="file"):
        name = manifest.get(part, {}).get(key)
        return parse_nrrd(name, files[name]) if name else None

    return Case(manifest, surfaces, volume("haptic"), volume("haptic", "hardness_file"), volume("ct"))


def main(words):
    if len(words) != 2:
        print("usage: read_case.py CASE", file=sys.stderr)
        return 64
    try:
        case = load(words[1])
    except CaseError as e:
        print(e, file=sys.stderr)
        return 65
    except OSError as e:
        print(e, file=sys.stderr)
        return 66
    for name, s in case.surfaces.items():
        low, high = s.points.min(axis=0), s.points.max(axis=0)
        print(f"{name}: {len(s.triangles)} triangles, {s.volume_ml():.3f} ml, {s.area_cm2():.2f} cm2, "
              f"from {np.round(low, 2).tolist()} to {np.round(high, 2).tolist()} mm")
    for name, at in case.points().items():
        print(f"{name}: {np.round(at, 2).tolist()} mm")
    if case.haptic:
        voxel_ml = abs(np.linalg.det(case.haptic.axes)) / 1000
        for s in case.manifest["haptic"]["shapes"]:
            print(f"haptic {s['name']}: {int(case.shape(s['name']).sum())} voxels of {voxel_ml:.6f} ml")
    if case.ct:
        print(f"ct: {case.ct.voxels.shape[::-1]} voxels, {case.ct.voxels.min()} to {case.ct.voxels.max()} HU")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
