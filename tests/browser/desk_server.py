# SPDX-License-Identifier: GPL-3.0-or-later
"""desk_server.py: what whoever reaches the desk's ports may cost: heads that never end, hundreds of slow connections, bodies that are no
requests, bodies without an announced length, thousands of ranges. TREPHINE is the program."""
import pathlib
import socket
import tempfile
import threading

from desk import Desk
from webdriver import Checks

MB = 1 << 20


class Slow:
    """Connections that send a byte each second after their first bytes, and read nothing."""
    def __init__(self, port, count, first):
        self.over, self.sockets = threading.Event(), []
        for _ in range(count):
            try:
                s = socket.create_connection(("127.0.0.1", port), timeout=20)
                s.sendall(first)
                self.sockets.append(s)
            except OSError:
                pass  # the server has no place for it, or has ended it already
        threading.Thread(target=self.drip, daemon=True).start()

    def drip(self):
        while not self.over.wait(1):
            for s in self.sockets:
                try:
                    s.send(b"x", socket.MSG_DONTWAIT)
                except OSError:
                    pass

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.over.set()
        for s in self.sockets:
            s.close()


def most_mb(desk):
    status = pathlib.Path(f"/proc/{desk.process.pid}/status").read_text()
    return int(status.split("VmHWM:")[1].split()[0]) / 1024


def pushed(desk, first, piece, most):
    """Sends pieces until the desk ends the connection; how many bytes it took, and what it said."""
    taken, said = 0, b""
    with socket.create_connection(("127.0.0.1", desk.port), timeout=60) as s:
        try:
            s.sendall(first)
            while taken < most:
                s.sendall(piece)
                taken += len(piece)
        except OSError:
            pass
        s.settimeout(10)
        try:
            said = s.recv(65536)
        except OSError:
            pass
    return taken, said


def answered(desk):
    return desk.get("api/status").startswith(b"HTTP/1.1 200")


def memory(check, desk):
    before = most_mb(desk)
    lines = b"X-Long: " + b"y" * 4000 + b"\r\n"
    taken, _ = pushed(desk, b"GET / HTTP/1.1\r\n", lines * 64, 64 * MB)
    check(taken < 16 * MB, f"{taken >> 20} MB of a head were taken")
    taken, _ = pushed(desk, b"GET / HTTP/1.1\r\nX: ", b"y" * 65536, 64 * MB)
    check(taken < 16 * MB, f"{taken >> 20} MB of one line were taken")
    kind = {"Content_Type": "application/octet-stream"}
    chunk = b"100000\r\n" + b"z" * 0x100000 + b"\r\n"
    taken, said = pushed(desk, desk.head("POST", "api/keep?case=marked&what=view", Transfer_Encoding="chunked", **kind), chunk, 300 * MB)
    check(taken < 16 * MB, f"{taken >> 20} MB of a body of unsaid length were taken: {said[:40]}")
    said = desk.raw(desk.head("POST", "api/keep?case=marked&what=view", Content_Length=300 * MB, **kind))
    check(said.startswith(b"HTTP/1.1 413"), f"a body of 300 MB is refused before it comes: {said[:40]}")
    plain = desk.get("")
    ranges = desk.get("", Range="bytes=" + ",".join(["0-"] * 2600))
    check(len(ranges) == len(plain) and ranges.startswith(b"HTTP/1.1 200"), f"ranges give {len(ranges)} bytes of {len(plain)}")
    check(most_mb(desk) < before + 40, f"the desk took {most_mb(desk):.0f} MB, before {before:.0f}")


def framing(check, desk):
    hidden = desk.head("GET", "api/status")
    kind = {"Content_Type": "application/json", "Connection": "keep-alive", "Content_Length": len(hidden)}
    for what, head in {"another origin": desk.head("POST", "api/stop", Origin="http://evil.example", **kind),
                       "no secret": desk.head("POST", "api/stop", Trephine_Desk=None, **kind),
                       "another type": desk.head("POST", "api/stop", **{**kind, "Content_Type": "text/plain"}),
                       "a body of a GET": desk.head("GET", "api/status", **kind),
                       "two lengths": desk.head("POST", "api/stop", content_length=0, **kind),
                       "a length and chunks": desk.head("POST", "api/stop", Transfer_Encoding="chunked", **kind),
                       "a folded length": desk.head("POST", "api/stop", **{**kind, "Content_Length": f"\r\n {len(hidden)}"}),
                       "a length folded by a tab": desk.head("POST", "api/stop", **{**kind, "Content_Length": f"\r\n\t{len(hidden)}"}),
                       "no length": desk.head("POST", "api/stop", **{**kind, "Content_Length": None})}.items():
        said = desk.raw(head, later=hidden)
        check(said.count(b"HTTP/1.1 ") == 1 and said.startswith(b"HTTP/1.1 4"), f"{what}: nothing behind a refused head is a request: {said[:60]}, {said.count(b'HTTP/1.1 ')} answers")
    check(desk.raw(desk.head("POST", "api/stop", Content_Type="application/json", Content_Length=2) + b"{}").startswith(b"HTTP/1.1 200"), "a body is read")
    check(desk.raw(desk.head("POST", "api/stop", Content_Type="application/json", Content_Length=2), later=b"{}").startswith(b"HTTP/1.1 200"), "also where it comes later")
    both = desk.raw(desk.head("GET", "api/status", Connection="keep-alive"), later=hidden)
    check(both.count(b"HTTP/1.1 200") == 2, "two requests behind each other are two")


def places(check, desk):
    kind = {"Content_Type": "application/json", "Content_Length": 1000000}
    for what, count, first in (("heads", 40, b"GET / HTTP/1.1\r\nX: "), ("heads", 600, b"GET / HTTP/1.1\r\nX: "), ("silence", 600, b""),
                               ("pages that nobody reads", 600, desk.head("GET", "", Connection="keep-alive", Trephine_Desk=None) * 40),
                               ("bodies", 600, desk.head("POST", "api/stop", **kind))):
        before = most_mb(desk)
        with Slow(desk.port, count, first):
            for _ in range(3):
                check(answered(desk), f"the owner is answered beside {count} connections of slow {what}")
        check(most_mb(desk) < before + 40, f"{count} connections of slow {what} took {most_mb(desk) - before:.0f} MB")


def main():
    check = Checks()
    with tempfile.TemporaryDirectory() as folder:
        library = pathlib.Path(folder) / "library"
        library.mkdir()
        with Desk(None, library) as desk:
            check(answered(desk), "the desk answers")
            framing(check, desk)
            places(check, desk)
            memory(check, desk)
            check(answered(desk) and desk.end() == 0, "and ends by Ctrl-C")
    check.end()


if __name__ == "__main__":
    main()
