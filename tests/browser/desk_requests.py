# SPDX-License-Identifier: GPL-3.0-or-later
"""desk_requests.py [COUNT [SEED]]: requests that nobody should send to the desk, COUNT of them made by a generator: other origins and
hosts, names that lead out of the library, broken heads and bodies. No file outside of the library is read or written, and the desk
lives. TREPHINE is the program."""
import os
import pathlib
import random
import sys
import tempfile
import time

from desk import Desk, make_root
from webdriver import Checks

CANARY = "canary-5d1f0c"


def state_of(folder):
    """Of every file but those that were dropped on the page, which have a folder of their own."""
    return {str(f): (f.stat().st_size, f.stat().st_mtime_ns) for f in sorted(folder.rglob("*")) if f.is_file() and "/configs/dropped/" not in str(f)}


class Generator:
    def __init__(self, desk, seed):
        self.r, self.desk = random.Random(seed), desk
        self.host = f"127.0.0.1:{desk.port}"
        self.paths = ["", "api/library", "api/plan", "api/status", "api/log?case=head-01", "api/case?case=head-01", "api/open?case=nobody",
                      "api/slice?case=head-01&axis=0&index=1", "api/field?case=head-01&name=skull&axis=0&index=1", "api/draft?case=head-01&what=view",
                      "api/folders?path=0", "api/series?path=0/configs", "api/picture?path=0/configs&series=s1", "api/page?case=nobody",
                      "api/overview?case=head-01&name=axial.png", "api/plane?case=head-01&side=5", "api/grow?case=head-01&i=0&j=0&k=0",
                      "api/tried?case=head-01", "api/cut?case=head-01&which=was&name=skull&axis=0&index=1", "api/lessons?case=head-01"]
        self.posts = ["api/landmark", "api/holes", "api/value", "api/patch?case=head-01&anatomy=skull&by=x&why=&base=", "api/switch", "api/approve",
                      "api/keep?case=head-01&what=view", "api/new", "api/stop", "api/try", "api/snake", "api/try_edit", "api/edit",
                      "api/between?case=head-01&axis=2&value=1", "api/drop?drop=0123456789abcdef&file=0&offset=0", "api/dropped"]
        self.ways = ["../", "..%2f", "%2e%2e/", "..\\", "....//", "/etc/", "%00", "0/../..", "0/outside", "./", "//", "%c0%ae%c0%ae/", "file:///", "0/link", "-1", "1e9",
                     "outside/secret.txt", "..%252f", "nan", "a" * 3000]
        self.values = [None, True, -1, 1e300, "", "../outside/secret", "head-01", "a: b\nc: d", "[1", {"a": {"b": 1}}, [], [[[[1]]]], [1, 2, 3], "x" * 2000, "${HOME}", "\u0000"]

    def target(self, path):
        r = self.r
        kind = r.randrange(8)
        if kind < 3:  # a way out in the middle of it
            at = r.randrange(len(path) + 1)
            path = path[:at] + r.choice(self.ways) * r.randrange(1, 4) + path[at:]
        elif kind == 3:
            path = "".join(r.choice("abc/.%?&=\\0123456789\x7f\xff ") for _ in range(r.randrange(60)))
        elif kind == 4 and "=" in path:
            head, _, tail = path.rpartition("=")
            path = head + "=" + r.choice(self.ways) + tail
        return "/" + path

    def body(self):
        import json
        r = self.r
        if r.random() < 0.3:
            return bytes(r.randrange(256) for _ in range(r.randrange(200)))
        if r.random() < 0.1:
            return b"[" * 5000
        keys = ["case", "by", "why", "base", "name", "position_mm", "holes", "path", "value", "id", "on", "recipe", "series", "difficulty_level", "only", "checks", "drop", "files", "archive", "anatomy", "edit", "snake", "steps", "values"]
        return json.dumps({k: r.choice(self.values) for k in keys if r.random() < 0.8}).encode()

    def request(self):
        """The request; whether the desk may answer it with anything but a refusal; whether it is whole."""
        r = self.r
        post = r.random() < 0.4
        path = r.choice(self.posts if post else self.paths)
        lines, honest, whole = {"Host": self.host, "Trephine-Desk": self.desk.token}, True, True
        if r.random() < 0.15:
            lines["Trephine-Desk"], honest = r.choice(["", "x", "0" * 32, self.desk.token[:-1], self.desk.token + "0"]), False
        if post:
            lines.update({"Origin": "http://" + self.host, "Content-Type": r.choice(["application/json", "application/octet-stream"])})
        attack = r.randrange(6)
        if attack == 0:
            lines["Host"], honest = r.choice(["evil.example", f"evil.example:{self.desk.port}", "127.0.0.1", "127.0.0.1:1", "", "localhost.evil.example:80", "[::1]:80"]), False
        elif attack == 1:
            lines["Origin"], honest = r.choice(["http://evil.example", "null", "http://127.0.0.1", "https://" + self.host, f"http://localhost:{self.desk.port}", "file://"]), False
        elif attack == 2:
            lines["Sec-Fetch-Site"], honest = r.choice(["cross-site", "same-site", "x"]), False
        elif attack == 3 and post:
            lines.pop("Origin")
            honest = False
        elif attack == 4:
            lines[r.choice(["Range", "Expect", "Transfer-Encoding", "Content-Encoding", "Cookie", "X-HTTP-Method-Override", "Content-Length", "Accept-Encoding", "Connection", "Upgrade"])] = \
                r.choice(["bytes=0-1,2-3", "bytes=" + "0-1," * 900, "chunked", "gzip", "100-continue", "-1", "99999999999999999999", "websocket", "\x80", "DELETE"])
            whole = False
        body = self.body() if post else b""
        if post and "Content-Length" not in lines and "Transfer-Encoding" not in lines:
            if r.random() < 0.9:
                lines["Content-Length"] = str(len(body))
            else:
                lines["Content-Length"], whole = str(r.choice([0, 1, len(body) + 5])), False
        lines["Connection"] = "close"
        method = ("POST" if post else "GET") if r.random() < 0.95 else r.choice(["PUT", "DELETE", "OPTIONS", "HEAD", "TRACE", "CONNECT", "PRI", "G ET"])
        target = self.target(path)
        if any(c <= " " or c == "\x7f" for c in target) or " " in method or target.count("?") > 1 or len(target) > 8000:
            whole = False  # no request line: the desk waits for a better one
        head = f"{method} {target} HTTP/1.1\r\n" + "".join(f"{k}: {v}\r\n" for k, v in lines.items()) + "\r\n"
        data = head.encode("latin-1") + body
        if r.random() < 0.05:  # broken anywhere
            data = bytearray(data)
            for _ in range(r.randrange(1, 6)):
                data[r.randrange(len(data))] = r.randrange(256)
            data, honest, whole = bytes(data), True, False
        return data, honest, whole


def main():
    count, seed = (int(sys.argv[1]) if len(sys.argv) > 1 else 3000), (int(sys.argv[2]) if len(sys.argv) > 2 else 1)
    check = Checks()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        root, library = make_root(folder), folder / "library"
        outside = folder / "outside"
        outside.mkdir()
        (outside / "secret.txt").write_text(CANARY)
        (outside / "secret").write_text(CANARY)
        (root / "link").symlink_to(outside)
        report = library / "head-01/report"
        report.mkdir(parents=True)
        (report / "axial.png").symlink_to(outside / "secret.txt")  # a link in the library that leads out of it
        (report / "view.html").write_text("<p>a page</p>")
        (library / "evil").symlink_to(outside)
        with Desk(root, library) as desk:
            before = state_of(outside), state_of(root)
            good = desk.get("api/status")
            check(good.startswith(b"HTTP/1.1 200"), "the desk answers")
            page = desk.get("")
            check(b"default-src 'none'" in page and b"frame-ancestors 'none'" in page and b"unsafe" not in page.split(b"\r\n\r\n")[0], "the page's policy")
            check(not desk.get("case/head-01/report/view.html").startswith(b"HTTP/1.1 200"), "no file of a case is a page of the desk's origin")
            check(not desk.get("api/overview?case=head-01&name=axial.png").startswith(b"HTTP/1.1 200"), "a link that leads out is not followed")
            check(desk.get("api/overview?case=evil&name=secret.png").startswith((b"HTTP/1.1 404", b"HTTP/1.1 422")), "nor is a case that is a link")
            check(desk.get("api/overview?case=head-01&name=view.html").startswith((b"HTTP/1.1 404", b"HTTP/1.1 422")), "a page is no picture")
            for headers in ({"Host": "evil.example"}, {"Origin": "http://evil.example"}, {"Sec_Fetch_Site": "cross-site"}):
                check(desk.get("api/library", **headers).startswith(b"HTTP/1.1 403"), f"refused: {headers}")
            check(desk.get("api/library", Trephine_Desk="0" * 32).startswith(b"HTTP/1.1 404"), "another token")
            generator, answers, leaks, wrong = Generator(desk, seed), {}, 0, []
            for i in range(count):
                data, honest, whole = generator.request()
                began = time.monotonic()
                answer = desk.raw(data, 60 if whole else 0.2)  # what is not whole may leave the desk waiting for the rest
                if time.monotonic() - began > 5:
                    print(f"request {i} of seed {seed} took {time.monotonic() - began:.1f} s: {data[:400]}", flush=True)
                status = answer[9:12].decode("latin-1")
                answers[status] = answers.get(status, 0) + 1
                leaks += CANARY.encode() in answer
                if not honest and status == "200" and b"Trephine desk</title>" not in answer and b"image/png" not in answer:  # for anybody
                    wrong.append(data[:200])
                if desk.process.poll() is not None:
                    check(False, f"request {i} of seed {seed} ended the desk with {desk.process.returncode}: {data[:400]}")
                    break
            print(count, "requests:", dict(sorted(answers.items())))
            check(not wrong, f"answered: {wrong[:3]}")
            check(leaks == 0, f"{leaks} answers hold what lies outside")
            check((state_of(outside), state_of(root)) == before, "no file outside of the library was written")
            check(answers.get("200", 0) > count // 50, "some requests were answered")
            check(desk.process.poll() is not None or desk.get("api/status").startswith(b"HTTP/1.1 200"), "the desk still answers")
            check(desk.process.poll() is not None or desk.end() == 0, "and ends by Ctrl-C")
    check.end()


if __name__ == "__main__":
    main()
