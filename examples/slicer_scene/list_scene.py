#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists what `trephine export CASE --format slicer-mrb` wrote, with the standard library and numpy, as 3D Slicer would find it.

    python3 list_scene.py CASE.mrb     models, segments with their codes and ml, the CT, and points in RAS, as Slicer shows them"""
import json
import sys
import xml.etree.ElementTree as ET
import zipfile
import zlib

import numpy as np

bundle = zipfile.ZipFile(sys.argv[1])
scene_file = next(name for name in bundle.namelist() if name.endswith(".mrml"))
nodes = {node.get("id"): node for node in ET.fromstring(bundle.read(scene_file))}


def stored(node):
    """The storage node of a node, and the bytes of its file."""
    storage = nodes[node.get("storageNodeRef")]
    return storage, bundle.read(scene_file.rsplit("/", 1)[0] + "/" + storage.get("fileName"))


def nrrd(data):
    """Fields and keys of a NRRD, and its voxels as [k, j, i] or, of a segmentation of several layers, [k, j, i, layer]."""
    header, voxels = data.split(b"\n\n", 1)
    lines = header.decode().splitlines()[1:]
    field = dict(line.split(":=", 1) if ":=" in line else line.split(": ", 1) for line in lines)
    kind = {"unsigned char": "u1", "short": "<i2"}[field["type"]]
    return field, np.frombuffer(zlib.decompress(voxels, 31), kind).reshape([int(n) for n in field["sizes"].split()][::-1])


for node in nodes.values():
    if node.tag == "Model":
        shown = nodes[node.get("displayNodeRef")]
        print(f"model {node.get('name')}: colour {shown.get('color')}, opacity {shown.get('opacity')}, in {stored(node)[0].get('coordinateSystem')}")
    elif node.tag == "Volume":
        field, voxels = nrrd(stored(node)[1])
        print(f"volume {node.get('name')}: {voxels.shape[::-1]} voxels, HU {voxels.min()} to {voxels.max()}")
    elif node.tag == "Segmentation":
        field, voxels = nrrd(stored(node)[1])
        axes = np.array([[float(c) for c in v.strip("()").split(",")] for v in field["space directions"].split() if v != "none"])
        ml = abs(np.linalg.det(axes)) / 1000
        layers = voxels[..., None] if voxels.ndim == 3 else voxels
        for n in range(sum(key.endswith("_ID") for key in field)):
            word = lambda key: field[f"Segment{n}_{key}"]
            count = (layers[..., int(word("Layer"))] == int(word("LabelValue"))).sum()
            scheme, code, meaning = word("Tags").split("~")[2].split("^")
            print(f"segment {word('Name')}: {meaning} ({scheme} {code}), {count * ml:.2f} ml")
    elif node.tag.startswith("Markups") and node.get("storageNodeRef"):
        for point in json.loads(stored(node)[1])["markups"][0]["controlPoints"]:
            x, y, z = point["position"]
            print(f"{node.get('name')} {point['label']}: {-x:.2f} {-y:.2f} {z:.2f} mm RAS")
