#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys, signatures and recordings as a participant would like them: keys that others may read, or of another kind; links, pipes and
folders where a signature belongs; signatures and recordings changed, exchanged or signed by somebody else.

`sign` signs with a private key of Ed25519 that its owner alone may use, and changes nothing but the signature's own file. `score` says
"signed" of what the teacher signed, and of nothing else."""
import json
import os
import pathlib
import shutil
import subprocess

import common

SCRIPT = {"module": "ventriculostomy", "steps": [{"take": {"tool": "catheter"}},
                                                 {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}}, "finish"]}
RUBRIC = pathlib.Path(__file__).resolve().parents[2] / "configs/rubrics/ventriculostomy.yaml"
KINDS = {"rsa": ["-algorithm", "RSA", "-pkeyopt", "rsa_keygen_bits:1024"], "ed448": ["-algorithm", "ed448"], "x25519": ["-algorithm", "x25519"],
         "ec": ["-algorithm", "EC", "-pkeyopt", "ec_paramgen_curve:P-256"]}


def openssl(*words):
    subprocess.run(["openssl", *map(str, words)], check=True, capture_output=True)


def make_keys(folder):
    """The teacher's and another's pair, and what is no private key of Ed25519."""
    for name in ("teacher", "other"):
        openssl("genpkey", "-algorithm", "ed25519", "-out", folder / (name + ".key"))
        openssl("pkey", "-in", folder / (name + ".key"), "-pubout", "-out", folder / (name + ".pub"))
    for name, words in KINDS.items():
        openssl("genpkey", *words, "-out", folder / (name + ".key"))
    openssl("pkey", "-in", folder / "teacher.key", "-outform", "DER", "-out", folder / "der.key")
    openssl("pkey", "-in", folder / "teacher.key", "-aes256", "-passout", "pass:x", "-out", folder / "locked.key")
    good = (folder / "teacher.key").read_bytes()
    (folder / "cut.key").write_bytes(good[:60])
    (folder / "empty.key").write_bytes(b"")
    (folder / "long.key").write_bytes(bytes(1 << 20) + good)
    return sorted(f for f in folder.glob("*") if f.name not in ("teacher.key", "other.key"))


def plant(rnd, sig, folder, key):
    """What lies where the signature belongs. Returns its name, and the files that must remain as they are."""
    victim = folder / "marks.txt"
    victim.write_text("of the teacher")
    kind = rnd.choice(["nothing", "nothing", "link", "links", "dangling", "hard link", "folder", "pipe", "read-only", "link to the key",
                       "link to the recording", "link to itself"])
    if kind in ("link", "links"):
        to = victim
        if kind == "links":
            to = folder / "between"
            to.symlink_to(rnd.choice([victim, victim.name]))
        sig.symlink_to(to)
    elif kind == "dangling":
        sig.symlink_to(folder / "made.txt")
    elif kind == "hard link":
        os.link(victim, sig)
    elif kind == "folder":
        sig.mkdir()
    elif kind == "pipe":
        os.mkfifo(sig)
    elif kind == "read-only":
        sig.write_text("old")
        sig.chmod(0o444)
    elif kind.startswith("link to"):
        sig.symlink_to({"key": key, "recording": sig.with_suffix(""), "itself": sig}[kind.split()[-1]])
    return kind, [victim, key, sig.with_suffix("")]


def changed(rnd, recording, sig, others, by_other):
    """Something is done to a signed recording. Returns what, and whether it is still what the teacher signed."""
    data = bytearray(recording.read_bytes())
    text = json.loads(sig.read_text())
    kind = rnd.choice(["nothing", "nothing", "byte", "cut", "longer", "other recording", "other signature", "by another", "digit", "upper case",
                       "version", "more keys", "other hash", "empty", "both"])
    if kind == "byte":
        data[rnd.randrange(len(data))] ^= 1 << rnd.randrange(8)
    elif kind == "cut":
        del data[-rnd.choice([1, 64, 4096]):]
    elif kind == "longer":
        data += bytes(rnd.choice([1, 64]))
    elif kind in ("other recording", "both"):
        data = bytearray(rnd.choice(others).read_bytes())
    if kind == "digit":
        key, at = rnd.choice(["signature", "recording_sha256"]), rnd.randrange(64)
        text[key] = text[key][:at] + ("0" if text[key][at] != "0" else "1") + text[key][at + 1:]
    elif kind == "upper case":
        text["signature"] = text["signature"].upper()
    elif kind == "version":
        text["trephine_signature"] = rnd.choice([0, 2, "1", None])
    elif kind == "more keys":
        text["signed"] = True
    elif kind == "other hash":
        text["recording_sha256"] = "0" * 64
    elif kind in ("other signature", "both"):
        text = json.loads(rnd.choice([o.with_name(o.name + ".sig") for o in others]).read_text())
    elif kind == "by another":
        text = by_other
    recording.write_bytes(bytes(data))
    sig.write_text("" if kind == "empty" else json.dumps(text))
    return kind, kind in ("nothing", "upper case", "more keys")


def main():
    attack = common.Attack(__doc__, 100)
    rnd, sim, work = attack.random, attack.args.sim, attack.work
    case = attack.sample("head", "head_drilled")
    rubric, script = work / "rubric.json", work / "script.json"
    attack.run("a rubric", "rubric", RUBRIC, "--output", rubric, allowed={0})
    script.write_text(json.dumps(SCRIPT))
    keys = work / "keys"
    keys.mkdir()
    no_keys = make_keys(keys)
    seen = [work / f"{n}.lesson" for n in range(3)]
    for n, file in enumerate(seen):
        attack.run("a lesson", "lesson", case, "--rubric", rubric, "--script", script, "--record", file, "--participant", "r-01",
                   "--aim-noise-mm", 2, "--seed", n + 1, program=sim, allowed={0})
        attack.run("the other's signature", "sign", file, "--key", keys / "other.key", program=sim, allowed={0})
        file.with_name(file.name + ".other").write_bytes(file.with_name(file.name + ".sig").read_bytes())
        attack.run("the teacher's", "sign", file, "--key", keys / "teacher.key", program=sim, allowed={0})
    signed_bytes = {file.read_bytes() for file in seen}
    counts = {}
    for n in range(attack.args.count):
        folder = work / "folder"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        source = rnd.choice(seen)
        recording, sig, key = folder / "one.lesson", folder / "one.lesson.sig", folder / "key"
        shutil.copy(source, recording)
        chosen = keys / "teacher.key" if rnd.random() < 0.7 else rnd.choice(no_keys)
        shutil.copy(chosen, key)
        mode = rnd.choice([0o600, 0o600, 0o400, 0o700, rnd.randrange(0o1000) | 0o400])
        key.chmod(mode)
        given = key
        if rnd.random() < 0.2:
            given = folder / "link"
            given.symlink_to(key)
        planted, kept = plant(rnd, sig, folder, key)
        before = {f: f.read_bytes() for f in kept}
        what = f"{n}: {chosen.name} of mode {mode:o}, {planted}"
        code, out, err = attack.run(what, "sign", recording, "--key", given, program=sim, allowed={0, 65, 73, 74})
        good = chosen.name == "teacher.key" and mode & 0o077 == 0 and planted != "folder"
        if (code == 0) != good:
            attack.find(f"{what}: {'is refused' if good else 'is signed'}: {code}: {err.strip()}")
        if any(not f.is_file() or f.read_bytes() != before[f] for f in kept) or (folder / "made.txt").exists():
            attack.find(what + ": another file is changed")
        if code == 0 and (sig.is_symlink() or not sig.is_file()):
            attack.find(what + ": the signature is no file of its own")
        if b"PRIVATE" in (out + err).encode():
            attack.find(what + ": the key is printed")
        if code != 0:
            continue
        by_other = json.loads(source.with_name(source.name + ".other").read_text())
        change, holds = changed(rnd, recording, sig, [o for o in seen if o != source], by_other)
        what += ", then " + change
        code, out, err = attack.run(what, "score", recording, "--case", case, "--rubric", rubric, "--signed-by", keys / "teacher.pub", program=sim,
                                    allowed={0, 65, 80})
        said = "signed" in out.splitlines()
        counts["signed" if said else "not signed"] = counts.get("signed" if said else "not signed", 0) + 1
        if said and not (holds or change == "both" and recording.read_bytes() in signed_bytes):
            attack.find(what + ": it is said to be signed")
        if change == "nothing" and not said:
            attack.find(f"{what}: is not said to be signed: {code}: {err.strip()}")
    print(", ".join(f"{count} {what}" for what, count in sorted(counts.items())))
    attack.end()


if __name__ == "__main__":
    main()
