# SPDX-License-Identifier: GPL-3.0-or-later
"""What the attackers of the desk share: a library of one case, the desk of the tests, and exchanges of bytes with it."""
import hashlib
import os
import pathlib
import shutil
import socket
import sys
import time

import common

BROWSER = pathlib.Path(__file__).resolve().parents[2] / "tests/browser"
CASE = "head-drilled"
FILES = {
    "trephine.root": "",
    "p.yaml": "trephine: 1\nanatomies:\n  skull:\n    shows_face: false\n    stages:\n"
              "      - segment: {lower_hu: 226}\n      - contour\n      - normals\n",
    "s.yaml": "trephine: 1\nanatomies:\n  skull: {max_triangles: 80000}\n",
    "a.yaml": "trephine: 1\npipeline: p.yaml\nscene: s.yaml\nlandmarks: {nasion: [0, -93.2, 40.1]}\n",
    "configs/LIBRARY.yaml": f"trephine: 1\ncases:\n  - {{case: {CASE}, series: ../scan, config: ../a.yaml}}\n",
}


def attack_of_desk(about, count, more=None):
    attack = common.Attack(about, count, more)
    beside = pathlib.Path(attack.args.trephine).resolve()
    os.environ["TREPHINE"], os.environ["PAGE_SAMPLES"] = str(beside), str(beside.parent / "page_samples")
    sys.path.append(str(BROWSER))
    return attack


def library_of_one(attack):
    """A root whose recipe is not run, and a library of one case."""
    root = attack.work / "root"
    for folder in ("scan", "configs", "library"):
        (root / folder).mkdir(parents=True)
    for name, text in FILES.items():
        (root / name).write_text(text)
    library = root / "library"
    shutil.copytree(attack.sample("made", "head_drilled"), library / CASE)
    (library / CASE / "report").mkdir(exist_ok=True)
    (library / CASE / "report/axial.png").write_bytes(b"\x89PNG\r\n\x1a\n")
    return root, library


def exchange(port, pieces, idle_s=0.5):
    """What comes back until the desk closes, or is silent for so long."""
    got = b""
    with socket.create_connection(("127.0.0.1", port), timeout=20) as s:
        try:
            for piece in pieces:
                s.sendall(piece)
                time.sleep(0.02)
            s.settimeout(idle_s)
            while len(got) < 1 << 22:
                piece = s.recv(65536)
                if not piece:
                    break
                got += piece
        except OSError:
            pass
    return got


def status_of(attack, got):
    status = got[9:12].decode("latin-1")
    attack.outcomes[status] = attack.outcomes.get(status, 0) + 1
    return status


def state_of(folder):
    """What lies below: links, kinds, modes and bytes."""
    out = {}
    for f in sorted(folder.rglob("*")):
        out[f] = os.readlink(f) if f.is_symlink() else hashlib.sha256(f.read_bytes()).hexdigest() if f.is_file() else f.stat().st_mode
    return out
