#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Libraries and helpers that lie beside a copy of the program, with owners, modes, links and places drawn by chance.

One is used only where the file, its folder and any link on the way belong to root or to the owner of the program's file, and nobody
else may write to them; else one line names both (70). The first place that holds one counts, and no other. A planted one is no
library, or a script that leaves a mark: neither may be loaded or run. As root owners are drawn too, else modes alone."""
import os
import pathlib
import shutil
import stat

import common

SCAN = b"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n" \
       b"Offset = 0 0 0\nElementSpacing = 1 1 1\nDimSize = 8 8 8\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" + bytes(1024)
OTHERS = [0, 65534, 1234]  # root, nobody and another user


def trusted(path, program):
    """Whether nobody but root and the program's owner may write there, as this script understands it."""
    for s in (os.lstat(path), os.stat(path)):
        if s.st_uid not in (0, program.st_uid):
            return False
        group = s.st_mode & stat.S_IWGRP and not (s.st_gid == program.st_gid and program.st_mode & stat.S_IWGRP)
        if not stat.S_ISLNK(s.st_mode) and (group or s.st_mode & stat.S_IWOTH):
            return False
    return True


class Installed:
    """A program in a folder of its own, with one library or helper that it needs, in the place or places that are drawn."""

    def __init__(self, attack, n):
        self.attack, self.rnd = attack, attack.random
        self.root = attack.work / "root"
        shutil.rmtree(self.root, ignore_errors=True)
        self.bin, self.lib = self.root / "bin", self.root / "lib/trephine"
        self.bin.mkdir(parents=True)
        self.lib.mkdir(parents=True)
        source = pathlib.Path(attack.args.trephine).resolve().parent
        self.program = self.bin / "trephine"
        shutil.copy(source / "trephine", self.program)
        self.name = self.rnd.choice(["dicom_codecs.so", "trephine-itk"])
        helper = self.name == "trephine-itk"
        self.good = source / self.name if helper else source.parent / "lib/trephine" / self.name
        self.places = [self.lib, self.bin] if not helper else [self.bin]
        self.mark = attack.work / "mark"
        self.words = ["import", attack.work / "v.mha", "--volume-values", "any", "--output", attack.work / "v.nrrd"]
        if not helper:
            self.words = ["phantom", attack.work / "phantom", "--columns-count", 16, "--rows-count", 16, "--slices-count", 2, "--mesh-step-mm", 0,
                          "--no-labels"]

    def bad(self, file):
        file.write_bytes(f"#!/bin/sh\ntouch '{self.mark}'\n".encode())
        file.chmod(0o755)

    def put(self, place):
        """The file as it should be, or behind a link, in that place. Returns whether it is a good one."""
        good = self.rnd.random() < 0.7
        file = place / self.name
        way = self.rnd.choice(["file", "file", "link", "links", "folder"])
        if way == "folder" and place == self.lib:  # the folder itself is a link
            real = self.root / "elsewhere"
            place.rename(real)
            place.symlink_to(self.rnd.choice([real, "../elsewhere"]))
        if way == "folder":
            way = "file"
        real = file if way == "file" else self.root / "kept" / (place.name + "-" + self.name)
        real.parent.mkdir(exist_ok=True)
        if good:
            shutil.copy(self.good, real)
        else:
            self.bad(real)
        if way == "links":
            between = self.root / "kept" / ("between-" + place.name)
            between.symlink_to(real)
            real = between
        if way in ("link", "links"):
            file.symlink_to(real)
        return good

    def spoil(self):
        """Owners and modes of anything on the way, of the program too."""
        paths = [p for p in self.root.rglob("*")] + [self.root / "lib"]
        for path in self.rnd.sample(paths, min(len(paths), self.rnd.choice([0, 1, 1, 2, 3]))):
            if not path.is_symlink():
                path.chmod(self.rnd.choice([0o755, 0o775, 0o757, 0o777, 0o1777, 0o700, 0o2775]))
            if os.geteuid() == 0:
                os.lchown(path, self.rnd.choice(OTHERS), self.rnd.choice(OTHERS))

    def wanted(self, held):
        """used or refused: by the first place that holds one, of which the program looks at every link on the way too."""
        program = self.program.stat()
        for place in self.places:
            file = place / self.name
            if not file.exists():
                continue
            ways, at = [], file
            while at.parent.is_symlink() or at.is_symlink():
                link = at.parent if at.parent.is_symlink() else at
                ways += [link, link.parent]
                at = link.parent / os.readlink(link) / ("" if link == at else at.name)
            ways += [at, at.parent]
            return ("used" if held[place] else "bad") if all(trusted(p, program) for p in ways) else "refused"
        return "missing"


def main():
    attack = common.Attack(__doc__, 200)
    os.umask(0o022)
    (attack.work / "v.mha").write_bytes(SCAN)
    attack.work.chmod(0o755)
    seen = {}
    for n in range(attack.args.count):
        one = Installed(attack, n)
        held = {place: one.put(place) for place in one.places if attack.random.random() < 0.8}
        one.spoil()
        strange = attack.work / "strange"  # the working folder is no place for it
        strange.mkdir(exist_ok=True)
        one.bad(strange / one.name)
        wanted = one.wanted(held)
        one.mark.unlink(missing_ok=True)
        what = f"{n}: {one.name}: " + "; ".join(f"{p.relative_to(one.root)} {oct(p.lstat().st_mode & 0o7777)} {p.lstat().st_uid}"
                                                 for p in sorted(one.root.rglob("*")))
        code, _, err = attack.run(what, *one.words, "--quiet", program=one.program, allowed={0, 65, 70}, cwd=strange)
        seen[wanted] = seen.get(wanted, 0) + 1
        refused = code == 70 and ": owner: " in err
        if wanted != "bad" and one.mark.exists():
            attack.find(what + ": a planted program was run")
        if (wanted == "used") != (code == 0) or (wanted == "refused") != refused:
            attack.find(f"{what}: should be {wanted}, and ends with {code}: {err.strip()[-200:]}")
        if refused and (one.name not in err or "chmod go-w" not in err or len(err.strip().splitlines()) != 1):
            attack.find(f"{what}: one line does not name what is wrong: {err.strip()[-300:]}")
    print(", ".join(f"{count} {what}" for what, count in sorted(seen.items())))
    attack.end()


if __name__ == "__main__":
    main()
