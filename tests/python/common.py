# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the Python package share. SIM, TREPHINE and WRITE_CASE are programs, SOURCE the repository."""
import atexit
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import trephine

SOURCE = pathlib.Path(os.environ["SOURCE"])
SIM, TREPHINE = os.environ["SIM"], os.environ["TREPHINE"]
sys.path.insert(0, str(SOURCE / "examples" / "python_reader"))
WORK = pathlib.Path(tempfile.mkdtemp())
atexit.register(shutil.rmtree, WORK, ignore_errors=True)


def sample_case(kind=""):
    """The folder of a case of tests/write_sample_case.cpp."""
    folder = WORK / f"case_{kind or 'sample'}"
    if not folder.exists():
        subprocess.run([os.environ["WRITE_CASE"], folder, kind], check=True)
    return folder


def run(*command, code=0):
    """Runs a program and gives what it says."""
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    assert done.returncode == code, (command, done.returncode, done.stdout, done.stderr)
    return done.stdout


def ball(radius_mm=20.0, size=32, spacing_mm=2.0, origin_mm=(-31.0, -31.0, 69.0)):
    """A field of a ball, positive inside, about (0, 0, 100)."""
    i = np.arange(size) * spacing_mm
    k, j, i = np.meshgrid(i + origin_mm[2], i + origin_mm[1], i + origin_mm[0], indexing="ij")
    field = radius_mm - np.sqrt(i ** 2 + j ** 2 + (k - 100) ** 2)
    return trephine.Volume(field.astype(np.float32), np.full(3, spacing_mm), np.array(origin_mm))


def write_nrrd(file, volume):
    kind = {"float32": "float", "int16": "short"}[str(volume.voxels.dtype)]
    axes = (volume.direction * volume.spacing_mm).T
    vector = lambda v: "(" + ",".join(repr(float(x)) for x in v) + ")"
    head = (f"NRRD0005\ntype: {kind}\ndimension: 3\nspace: left-posterior-superior\n"
            f"sizes: {' '.join(map(str, volume.voxels.shape[::-1]))}\nspace directions: {' '.join(map(vector, axes))}\n"
            f"kinds: domain domain domain\nendian: little\nencoding: raw\nspace origin: {vector(volume.origin_mm)}\n\n")
    file.write_bytes(head.encode() + np.ascontiguousarray(volume.voxels).tobytes())


class Case(unittest.TestCase):
    def refuses(self, code, pattern, function, *args, **kwargs):
        """An exception of the package with that exit code, and one line that matches."""
        with self.assertRaisesRegex(trephine.Error, pattern) as caught:
            function(*args, **kwargs)
        self.assertEqual(caught.exception.exit_code, code)
        self.assertEqual(str(caught.exception).count("\n"), 0)
        self.assertEqual(isinstance(caught.exception, ValueError), code in (64, 65, 78))
        return caught.exception
