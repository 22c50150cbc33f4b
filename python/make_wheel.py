#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the built package as a wheel (PEP 427, PyPA's binary distribution format 1.0).

    make_wheel.py PACKAGE_FOLDER VERSION OUT_FOLDER

The wheel is for the Python and the machine that it was made on, and for no other distribution: its module links Debian's
libraries by their names. The same files give the same bytes.
"""
import base64
import hashlib
import pathlib
import sys
import sysconfig
import zipfile

package, version, out = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
python = f"cp{sys.version_info.major}{sys.version_info.minor}"
tag = f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
info = f"trephine-{version}.dist-info"

files = {f"trephine/{file.name}": (file.read_bytes(), file.stat().st_mode & 0o111)
         for file in sorted(package.iterdir()) if file.is_file()}
files[f"{info}/METADATA"] = (f"""Metadata-Version: 2.1
Name: trephine
Version: {version}
Summary: Patient models from CT for surgical simulation, read, felt and drilled
License: GPL-3.0-or-later
Requires-Python: =={sys.version_info.major}.{sys.version_info.minor}.*
Requires-Dist: numpy
""".encode(), 0)
files[f"{info}/WHEEL"] = (f"""Wheel-Version: 1.0
Generator: trephine
Root-Is-Purelib: false
Tag: {tag}
""".encode(), 0)
record = "".join(
    f"{name},sha256={base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip('=')},{len(data)}\n"
    for name, (data, _) in files.items())
files[f"{info}/RECORD"] = (f"{record}{info}/RECORD,,\n".encode(), 0)

out.mkdir(parents=True, exist_ok=True)
wheel = out / f"trephine-{version}-{tag}.whl"
part = wheel.with_suffix(".part")
with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
    for name, (data, executable) in files.items():
        entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
        entry.external_attr = (0o100755 if executable else 0o100644) << 16
        entry.compress_type = zipfile.ZIP_DEFLATED
        archive.writestr(entry, data)
part.replace(wheel)
print(wheel)
