# SPDX-License-Identifier: GPL-3.0-or-later
# canaries.py put SERIES TO: copies a series' files, with canaries in names, IDs, dates, UIDs, comments and private tags.
# canaries.py seek SERIES FOLDER...: which of them are in the folders' files and their names, as they are, as UTF-16, in base64 or
# inside gzip; exit code 1 where there is any. That they are in SERIES is checked: else nothing is proved.
import base64, pathlib, struct, sys, zlib

words = [b"CANARY", b"18870611", b"18870612", b"130742.87", b"4711081511", b"ERIKA"]
texts = {  # group, element: VR, value
    (0x0008, 0x0020): (b"DA", b"18870611"), (0x0008, 0x0030): (b"TM", b"130742.87"),
    (0x0008, 0x0050): (b"SH", b"CANARYACCESSION"), (0x0008, 0x0080): (b"LO", b"CANARYHOSPITAL"),
    (0x0008, 0x0090): (b"PN", b"CANARYREFERRER^A"), (0x0008, 0x1030): (b"LO", b"CANARYSTUDY"),
    (0x0008, 0x103E): (b"LO", b"CANARYSERIES"), (0x0008, 0x1070): (b"PN", b"CANARYOPERATOR"),
    (0x0009, 0x0010): (b"LO", b"CANARYCREATOR"), (0x0009, 0x1001): (b"LO", b"CANARYPRIVATE"),
    (0x0010, 0x0010): (b"PN", b"CANARYNAME^ERIKA"), (0x0010, 0x0020): (b"LO", b"CANARYID4711"),
    (0x0010, 0x0030): (b"DA", b"18870612"), (0x0010, 0x4000): (b"LT", b"CANARYCOMMENT"),
    (0x0018, 0x1030): (b"LO", b"CANARYPROTOCOL"), (0x0020, 0x000D): (b"UI", b"1.2.3.4711081511.1"),
    (0x0020, 0x000E): (b"UI", b"1.2.3.4711081511.2"), (0x0020, 0x0010): (b"SH", b"CANARYSTUDYID"),
    (0x0020, 0x0052): (b"UI", b"1.2.3.4711081511.3"), (0x0020, 0x4000): (b"LT", b"CANARYIMAGECOMMENT"),
}


def put(source, to):
    long_form = {b"OB", b"OW", b"SQ", b"UN", b"UT"}

    def element(tag, vr, value):
        value += (b"\0" if vr == b"UI" else b" ") * (len(value) % 2)
        return struct.pack("<HH2sH", *tag, vr, len(value)) + value

    to.mkdir()
    for n, file in enumerate(sorted(source.iterdir())):
        b = file.read_bytes()
        meta = 132 + 12 + struct.unpack_from("<I", b, 140)[0]  # preamble, DICM, the group's length
        kept, at = [], meta
        while at < len(b):
            group, number, vr = struct.unpack_from("<HH2s", b, at)
            head = 12 if vr in long_form else 8
            length = struct.unpack_from("<I", b, at + 8)[0] if head == 12 else struct.unpack_from("<H", b, at + 6)[0]
            end = len(b) if length == 0xFFFFFFFF else at + head + length  # encapsulated pixels come last
            kept.append(((group, number), b[at:end]))
            at = end
        kept = [(t, e) for t, e in kept if t not in texts]
        kept += [(t, element(t, *v)) for t, v in texts.items()]
        kept.sort(key=lambda te: te[0])
        (to / f"CANARYFILE{n:04}.dcm").write_bytes(b[:meta] + b"".join(e for _, e in kept))


def all_forms():
    forms = {w: w.decode() for w in words}
    forms.update({w.decode().encode(u): w.decode() + " as " + u for w in words for u in ("utf-16-le", "utf-16-be")})
    for w in words:
        for shift in range(3):  # base64 of the word wherever it begins: without the ends that depend on its neighbours
            code = base64.b64encode(b"\0" * shift + w).rstrip(b"=")
            inner = code[(0, 2, 3)[shift]:-1]
            if len(inner) >= 6:
                forms[inner] = w.decode() + " in base64"
    return forms


def hits(folder):
    found, forms = [], all_forms()
    for path in sorted(pathlib.Path(folder).rglob("*")):
        if any(w.decode() in path.name for w in words):
            found.append(f"{path}: its name")
        if not path.is_file():
            continue
        contents = [path.read_bytes()]
        at = contents[0].find(b"\x1f\x8b\x08")
        if at >= 0:
            try:
                contents.append(zlib.decompressobj(31).decompress(contents[0][at:]))
            except zlib.error:
                pass
        found += [f"{path}: {name}" for data in contents for form, name in forms.items() if form in data]
    return found


if sys.argv[1] == "put":
    put(pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]))
else:
    assert len(hits(sys.argv[2])) > 5 * len(list(pathlib.Path(sys.argv[2]).iterdir())), "no canaries in the series"
    leaks = [h for folder in sys.argv[3:] for h in hits(folder)]
    print("\n".join(leaks))
    sys.exit(1 if leaks else 0)
