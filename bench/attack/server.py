#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The desk's server: heads and bodies that contradict each other, with an owner's request hidden behind them, and slow and greedy
connections, of whoever reaches its port.

What is hidden in a body is never answered. The owner is answered beside them all, and they cost no memory."""
import time

import desk_of_one
from desk_of_one import CASE, exchange

PATIENCE_S, MOST_MB = 20, 64
LINES = [b"Broken\r\n", b"Content-Length : 3\r\n", b"Content-Length:\r\n 3\r\n", b"X: a\x00b\r\n", b"X: a\rb\r\n", b": x\r\n", b"X: y\n",
         b"Transfer-Encoding\r\n :chunked\r\n"]


def refused_heads(rnd, n):
    """Heads that no server may take for the begin of one request, or that the desk refuses."""
    any_length = rnd.choice([0, 1, n, n + 5, 1 << 20])
    odd = ["-1", "+5", "0x5", "", "1e2", "18446744073709551621", "5 5", "\u00b2", "5;"]
    length = {"Content_Length": any_length}
    return {
        "a length and chunks": {"Transfer_Encoding": "chunked", **length},
        "chunks": {"Transfer_Encoding": rnd.choice(["chunked", "gzip, chunked", "Chunked", "identity, chunked", "\x0bchunked"])},
        "another length": {"content_length": any_length + 1, **length},
        "lengths": {"Content_Length": f"{any_length}, {any_length + 1}"},
        "an odd length": {"Content_Length": rnd.choice(odd)},
        "no secret": {"Trephine_Desk": None, **length},
        "wrong secret": {"Trephine_Desk": "0" * 32, **length},
        "another origin": {"Origin": "http://evil.example", **length},
        "another host": {"Host": "evil.example", **length},
        "another type": {"Content_Type": "text/plain", **length},
        "a form": {"Content_Type": "application/x-www-form-urlencoded", **length},
        "no length": {},
    }


def heads_of_one(rnd, n):
    """Heads of a request whose body is all that follows."""
    return {
        "right": {"Content_Length": n},
        "blanks": {"Content_Length": f" {n} "},
        "expected": {"Content_Length": n, "Expect": "100-continue"},
        "the same twice": {"Content_Length": n, "content-length": n},
        "zeros": {"Content_Length": f"{n:012d}"},
        "long": {"Content_Length": n, "X_Long": "y" * rnd.choice([100, 9000, 70000])},
    }


def framed(rnd, desk, hidden):
    """A head, and what is odd about it."""
    refused, one = refused_heads(rnd, len(hidden)), heads_of_one(rnd, len(hidden))
    name = rnd.choice(sorted(refused) + sorted(one))
    headers = {"Content_Type": "application/json", "Connection": "keep-alive", **(refused.get(name) or one.get(name) or {})}
    of_any = name in refused and name not in ("another type", "a form", "no length")  # which say nothing of a GET
    head = desk.head(rnd.choice(["POST", "POST", "GET"]) if of_any else "POST", "api/stop", **headers)
    if rnd.random() < 0.25 and name in refused:
        line = rnd.choice(LINES)
        head, name = head[:-2] + line + b"\r\n", f"{name}, {line!r}"
    return head, name


def slow_begin(rnd, desk):
    return rnd.choice([b"", b"G", b"GET / HTTP/1.1\r\nX: ",
                       desk.head("POST", "api/stop", Content_Type="application/json", Content_Length=10 ** rnd.randrange(2, 8)),
                       desk.head("GET", "", Connection="keep-alive", Trephine_Desk=None) * rnd.randrange(1, 60)])


def greedy(rnd, desk):
    """A begin, and up to 4 MB of pieces that never end it."""
    piece = rnd.choice([b"y" * 65536, b"X: y\r\n" * 10000, b"GET / HTTP/1.1\r\n" * 4000, b"\r\n" * 30000,
                        b"100000\r\n" + bytes(1 << 20) + b"\r\n"])
    first = rnd.choice([b"GET / HTTP/1.1\r\nX: ", b"", b"\r\n",
                        desk.head("POST", f"api/keep?case={CASE}&what=view", Transfer_Encoding="chunked",
                                  Content_Type="application/octet-stream"),
                        desk.head("POST", "api/approve", Content_Length=1 << 40, Content_Type="application/json"),
                        desk.head("GET", "", Range="bytes=" + "0-," * 3000)])
    return [first] + [piece] * (1 + (4 << 20) // len(piece))


def main():
    attack = desk_of_one.attack_of_desk(__doc__, 300)
    from desk import Desk
    from desk_server import Slow, most_mb
    root, library = desk_of_one.library_of_one(attack)
    rnd = attack.random
    with Desk(root, library) as desk:
        hidden = desk.head("GET", "api/status", Connection="close")
        exchange(desk.port, [hidden], PATIENCE_S)
        before = most_mb(desk)
        for n in range(attack.args.count):
            kind = rnd.choice(["framed"] * 12 + ["slow", "greedy"])
            what = f"{n}: {kind}"
            if kind == "framed":
                head, odd = framed(rnd, desk, hidden)
                what += ": " + odd
                got = exchange(desk.port, [head + hidden] if rnd.random() < 0.5 else [head, hidden], 0.4)
                desk_of_one.status_of(attack, got)
                if got.count(b"HTTP/1.1 ") - got.count(b"HTTP/1.1 100") > 1 or b'"running"' in got:
                    attack.find(f"{what}: what is hidden in a body is answered: {got[:200]}")
            elif kind == "slow":
                first, count, began = slow_begin(rnd, desk), rnd.choice([10, 50, 200, 500]), time.monotonic()
                with Slow(desk.port, count, first):
                    if not exchange(desk.port, [hidden], PATIENCE_S).startswith(b"HTTP/1.1 200"):
                        attack.find(f"{what}: the owner is not answered beside {count} of {first[:40]} in {time.monotonic() - began:.0f} s")
            else:
                exchange(desk.port, greedy(rnd, desk), 1)
            if most_mb(desk) > before + MOST_MB:
                attack.find(f"{what}: {most_mb(desk):.0f} MB, before {before:.0f}")
                before = most_mb(desk)
            if desk.process.poll() is not None:
                attack.find(f"{what}: the desk ended with {desk.process.returncode}")
                attack.end()
        if not exchange(desk.port, [hidden], PATIENCE_S).startswith(b"HTTP/1.1 200") or desk.end() != 0:
            attack.find("the desk does not answer, or does not end, after all of it")
    attack.end()


if __name__ == "__main__":
    main()
