#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Behaves to a client as the simulation channel of Haply's Inverse Service, without a device, for the tests of an adaptor.

haply_fake.py FOLDER [--fault NAME]: listens on a free port of 127.0.0.1, writes it to FOLDER/port, takes clients one after another,
and writes what it saw to FOLDER/log.json every 0.2 s, and where a connection ends. Ends with SIGTERM.

Written from public references alone, by somebody who had not read the adaptor. RFC 6455; of docs.haply.co/inverseSDK, version 3.5.x:
  service/realtime/websocket-protocol  port 10001; on connect the inventory (config, state, status), then one state a message
  service/api/simulation               a state holds state and status of all devices; probe_position, probe_orientation,
                                       force_render_full_state; the examples of verse_grip and of status are of its version 3.4.x
  service/realtime/control-commands    set_cursor_force: {"vector": {x, y, z}} in N, applied once; the other commands
  service/commons/json-conventions     groups and `session` as keys; text frames; unknown keys are ignored "currently"
  service/commons/basis                x right, y forward, z up, right-handed
  service/session-configuration/sessions  one connection is one session; a profile name on the first message is recommended
  service/migrations/3.5-migration     a wireless grip's entry is as in 3.4 unless the client asks for another shape
  service/tutorials/01, 03, 06         a grip's buttons.{a,b,c}, hall, battery_level; orientation w, x, y, z; it points along local +y
and isaac-sim/IsaacLab, isaaclab/devices/haply/se3_haply.py (2025), which sends "values" where 3.5 says "vector": here "values" alone
is a fault of the client, and beside an equal "vector" it is none.

The cursor goes along y from (0.02, -0.12, 0.15) m to (0.02, -0.06, 0.15) m and back at 30 mm/s, whatever the force, from the client's
first message on. Of two devices the second's x is -0.05 m. The grip is turned by Rz(25 degrees) Rx(-40) Ry(30). In each second its
buttons are none, a, b, c, for a quarter each. A ping comes each half second. What is not modelled (basis, preset, mount, filters,
positions, torques) is listed in `unmodelled`, and what breaks a reference in `bad`.

Faults. From the begin: no_device, two_devices (and no grip), no_grip, http (is no WebSocket), mute (no inventory), late (each answer
30 ms), fragments (each message in three frames, each in two pieces, with a ping between them). From a second after the first message:
silent (no answer any more), half (half a frame, then nothing), nan (the position is the word NaN), null (it is null), garbage (no JSON),
close, unplugged (an empty list of devices), big (one message of 3 MB, most of it white space, then as before)."""
import base64
import hashlib
import json
import math
import os
import signal
import socket
import struct
import sys
import time
from pathlib import Path

FAULTS = "none no_device two_devices no_grip http mute late fragments silent half nan null garbage close unplugged big".split()
MOST_N = 10  # of an Inverse3: more cannot be meant
TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10
GROUPS = {
    "inverse3": "set_cursor_force set_cursor_position set_angular_torques set_angular_position set_transform probe_position".split(),
    **{grip: ["probe_orientation"] for grip in ("verse_grip", "wireless_verse_grip", "custom_verse_grip")},
}
STARTS_M = {"04BA": (0.02, -0.12, 0.15), "1B3F": (-0.05, -0.12, 0.15)}


class Ended(Exception):
    """The connection's end, and why."""


def vec3(x, y, z):
    return {"x": x, "y": y, "z": z}


ORIENTATION = {"w": 0.905317410, "x": -0.375175448, "y": 0.165940982, "z": 0.110033456}
PLACE = {"position": vec3(0, 0, 0), "rotation": {"w": 1, **vec3(0, 0, 0)}, "scale": vec3(1, 1, 1)}


def along(t_s):
    """Of the path at that time: how far it went in m, and its speed in m/s."""
    t = t_s % 4
    return (0.03 * t, 0.03) if t < 2 else (0.03 * (4 - t), -0.03)


class Connection:
    def __init__(self, link, fault, save):
        self.link, self.fault, self.save = link, fault, save
        self.first, self.last_ping = None, time.monotonic()  # when the first message came, and the last ping went
        self.buffer, self.masks = b"", set()
        self.inverses = [] if fault == "no_device" else list(STARTS_M)[:2 if fault == "two_devices" else 1]
        self.grips = [] if fault in ("two_devices", "no_grip") else ["61548"]
        self.dead = self.faulted = self.big_is_out = False
        self.force = {}  # that of this tick
        self.log = {"handshake": {}, "messages": 0, "answers": 0, "forces": {}, "bad": [], "bads": 0,
                    "unmodelled": [], "profile": "", "sessions": 0, "pings": 0, "pongs": 0, "close_code": None, "end": ""}

    def must(self, good, what):
        if not good:
            self.log["bads"] += 1
            if len(self.log["bad"]) < 20 and what not in self.log["bad"]:
                self.log["bad"].append(what)
        return good

    # Bytes.
    def more(self):
        """Waits for bytes, pings, and saves. Raises Ended where the client is gone."""
        try:
            got = self.link.recv(65536)
        except (TimeoutError, BlockingIOError):
            got = None
        except OSError as e:
            raise Ended("no close frame: " + type(e).__name__)
        if got == b"":
            raise Ended("no close frame: the connection ended")
        self.buffer += got or b""
        self.save(self)
        now = time.monotonic()
        if self.first is not None and not self.dead and now - self.last_ping > 0.5:
            self.last_ping = now
            self.log["pings"] += 1
            self.send(PING, b"p%d" % self.log["pings"])
        if self.first is not None and self.fault == "close" and now - self.first > 1:
            self.send(CLOSE, struct.pack("!H", 1001))
            raise Ended("closed by the fake")

    def take(self, n):
        while len(self.buffer) < n:
            self.more()
        got, self.buffer = self.buffer[:n], self.buffer[n:]
        return got

    def push(self, data):
        self.link.settimeout(5)
        try:
            self.link.sendall(data)
        except OSError:
            self.dead = True  # what the client sent before it went is still read
        self.link.settimeout(0.05)

    @staticmethod
    def frame(opcode, data, last=True):
        n = len(data)
        size = bytes([n]) if n < 126 else struct.pack("!BH", 126, n) if n < 65536 else struct.pack("!BQ", 127, n)
        return bytes([(0x80 if last else 0) | opcode]) + size + data

    def send(self, opcode, data):
        if not self.dead:
            self.push(self.frame(opcode, data))

    # The handshake.
    def shake(self):
        while b"\r\n\r\n" not in self.buffer:
            if len(self.buffer) > 16384:
                raise Ended("a handshake without an end")
            self.more()
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        # A request without Upgrade is one of the service's HTTP interface, which the fake has not.
        first, *lines = head.decode("latin-1").split("\r\n")
        fields = {}
        for line in lines:
            name, colon, value = line.partition(":")
            self.must(colon and name and name == name.strip(), f"handshake: the line {line!r} is no header")
            self.must(name.lower() not in fields, f"handshake: {name} twice")
            fields[name.lower()] = value.strip()
        self.log["handshake"] = {"request": first, **fields}
        if "upgrade" not in fields or self.fault == "http":
            self.push(b"HTTP/1.1 404 Not Found\r\nContent-Type: text/html\r\nContent-Length: 13\r\nConnection: close\r\n\r\n<html></html>")
            raise Ended("http")
        port = self.link.getsockname()[1]
        key = fields.get("sec-websocket-key", "")
        try:
            good_key = len(base64.b64decode(key, validate=True)) == 16
        except ValueError:
            good_key = False
        for name, good in (("request", first == "GET / HTTP/1.1"),  # of ws://localhost:10001
                           ("host", fields.get("host") in (f"127.0.0.1:{port}", f"localhost:{port}")),
                           ("upgrade", fields["upgrade"].lower() == "websocket"),
                           ("connection", "upgrade" in [t.strip().lower() for t in fields.get("connection", "").split(",")]),
                           ("sec-websocket-version", fields.get("sec-websocket-version") == "13"),
                           ("sec-websocket-key", good_key)):
            self.must(good, f"handshake: {name} is {self.log['handshake'].get(name)!r}")
        self.must(not self.buffer, "handshake: frames came before the answer")
        accept = base64.b64encode(hashlib.sha1((key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11").encode()).digest())
        self.push(b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                  b"Sec-WebSocket-Accept: " + accept + b"\r\n\r\n")

    # Frames of the client.
    def one_frame(self):
        """last, opcode, data"""
        first, second = self.take(2)
        last, opcode, size = bool(first & 0x80), first & 15, second & 127
        self.must(first & 0x70 == 0, "frame: reserved bits are set")
        if size >= 126:
            bytes_of_it, least = (2, 126) if size == 126 else (8, 65536)
            size = int.from_bytes(self.take(bytes_of_it), "big")
            self.must(size >= least, "frame: its length is not in the shortest form")
        if size > 1 << 20:
            self.must(False, f"frame: of {size} bytes")
            raise Ended("a frame too large")
        mask = self.take(4) if self.must(second & 0x80, "frame: is not masked") else bytes(4)
        self.masks.add(mask)
        data = bytes(b ^ mask[n & 3] for n, b in enumerate(self.take(size)))
        self.must(opcode < 8 or (size <= 125 and last), "frame: a control frame that is long or in parts")
        return last, opcode, data

    def message(self):
        """The next text; control frames are answered."""
        parts = None
        while True:
            last, opcode, data = self.one_frame()
            if opcode == CLOSE:
                self.log["close_code"] = int.from_bytes(data[:2], "big") if len(data) >= 2 else 1005
                self.must(not data or len(data) >= 2 and 1000 <= self.log["close_code"] <= 1011, f"close: the code is {data[:2]!r}")
                self.send(CLOSE, data[:2])
                raise Ended("closed by the client")
            if opcode == PING:
                self.send(PONG, data)
            elif opcode == PONG:
                self.must(not data or data.startswith(b"p"), f"pong: {data!r} is not what the ping had")
                self.log["pongs"] += 1
            elif opcode in (0, TEXT, BINARY):
                self.must((opcode == 0) == (parts is not None), "frame: a part without a begin, or a message within another")
                self.must(opcode != BINARY, "frame: binary, where messages are text")
                parts = (parts or b"") + data
                if last:
                    return parts
            else:
                self.must(False, f"frame: opcode {opcode}")

    # What it says.
    def check(self, data):
        try:
            m = json.loads(data.decode(), parse_constant=lambda name: self.must(False, f"message: {name} is no JSON"))
        except ValueError as e:
            return self.must(False, f"message: no JSON in UTF-8: {data[:80]!r}: {e}")
        for key, value in m.items() if self.must(isinstance(m, dict), "message: is no object") else ():
            if key == "session":
                self.check_session(value)
            elif self.must(key in GROUPS and isinstance(value, list), f"message: the key {key!r} is not of the reference, or no list"):
                for entry in value:
                    self.check_device(key, entry)

    def check_session(self, value):
        self.log["sessions"] += 1
        for key, inner in value.items() if self.must(isinstance(value, dict), "session: is no object") else ():
            if key == "configure" and isinstance(inner, dict):
                for name, what in inner.items():
                    if name == "profile" and isinstance(what, dict) and isinstance(what.get("name"), str) and what["name"]:
                        self.log["profile"] = what["name"]
                    elif what != {"permutation": "XYZ"} or name != "basis":
                        self.unmodelled(f"session.configure.{name}: {json.dumps(what)}")
            elif key != "force_render_full_state":
                self.unmodelled(f"session.{key}")

    def unmodelled(self, what):
        if what not in self.log["unmodelled"] and len(self.log["unmodelled"]) < 20:
            self.log["unmodelled"].append(what)

    def check_device(self, group, entry):
        if not isinstance(entry, dict) or not isinstance(entry.get("device_id"), str):
            return self.must(False, f"{group}: an entry without device_id, which is a text")
        there = {"inverse3": self.inverses, "wireless_verse_grip": self.grips}.get(group, [])
        if entry["device_id"] not in there:
            return self.must(False, f"{group}: there is no device {entry['device_id']!r}")
        for key, value in entry.items():
            if key == "configure":
                self.unmodelled(f"{group}.configure: {json.dumps(value)}")
            elif key == "commands" and isinstance(value, dict):
                for name, what in value.items():
                    if not self.must(name in GROUPS[group], f"{group}: the command {name!r} is not of the reference"):
                        continue
                    if name == "set_cursor_force":
                        self.check_force(entry["device_id"], what)
                    elif name.startswith("probe_"):
                        self.must(what == {}, f"{name}: holds data")
                    else:
                        self.unmodelled(name)
            elif key != "device_id":
                self.must(False, f"{group}: the key {key!r} is not of the reference, or no object")

    def check_force(self, device, what):
        if not (isinstance(what, dict) and isinstance(what.get("vector"), dict)):
            return self.must(False, f"set_cursor_force: without the object `vector`: {json.dumps(what)[:80]}")
        for key, value in what.items():
            self.must(key in ("vector", "values") and value == what["vector"], f"set_cursor_force: {key!r} is not of the reference")
        n = [what["vector"].get(a) for a in "xyz"]
        if len(what["vector"]) != 3 or not all(type(c) in (int, float) and math.isfinite(c) for c in n):
            return self.must(False, f"set_cursor_force: {what['vector']} are not three finite numbers")
        self.must(math.hypot(*n) <= MOST_N, f"set_cursor_force: {n} N")
        f = self.log["forces"].setdefault(device, {"count": 0, "not_zero": 0, "largest_n": [0, 0, 0], "last_n": None})
        f["count"] += 1
        f["not_zero"] += any(n)
        f["last_n"] = n
        self.force[device] = n
        f["largest_n"] = max(f["largest_n"], n, key=lambda v: math.hypot(*v))

    # What is answered.
    def state(self, full):
        t = 0 if self.first is None else time.monotonic() - self.first
        far, speed = along(t)
        m = {"session_id": 7, "inverse3": [], "verse_grip": [], "wireless_verse_grip": []}
        for device in [] if self.faulted and self.fault == "unplugged" else self.inverses:
            x, y, z = STARTS_M[device]
            position = vec3(x, y + far, z)
            if self.faulted and self.fault in ("nan", "null"):
                position = vec3(*[math.nan if self.fault == "nan" else None] * 3)
            none, angles, entry = vec3(0.0, 0.0, 0.0), {"a0": 0.0, "a1": 0.0, "a2": 0.0}, {"device_id": device}
            if full:
                entry["config"] = {
                    "type": "inverse3", "port": "/dev/ttyACM0", "extended_device_id": "2D35F80DD9005F599B68F49944CB" + device,
                    "device_info": {"major_version": 7, "minor_version": 4, "id": device, "device_type": 4, "uuid": device},
                    "gravity_compensation": {"enabled": True, "scaling_factor": 1.0}, "handedness": "right",
                    "torque_scaling": {"enabled": True}, "home_return": {"enabled": False}, "preset": "defaults",
                    "basis": {"permutation": "XYZ"}, "mount": PLACE, "filters": {"damping": {"scalar": 0.0}}}
            force = vec3(*self.force.get(device, (0.0, 0.0, 0.0)))
            entry["state"] = {
                "cursor_position": position, "cursor_velocity": vec3(0.0, speed, 0.0), "angular_position": angles,
                "angular_velocity": angles, "body_orientation": {"w": 0.6, "x": 0.0, "y": -0.8, "z": 0.0},
                "current_cursor_force": force, "current_cursor_position": none, "current_angular_torques": angles,
                "current_angular_position": angles, "control_domain": "cartesian", "control_mode": "force" if self.force else "idle",
                "transform": PLACE}
            entry["status"] = {"calibrated": True, "in_use": bool(self.force), "power_supply": True, "ready": True, "started": True}
            m["inverse3"].append(entry)
        for grip in self.grips:
            entry = {"device_id": grip}
            if full:
                entry["config"] = {"type": "wireless_verse_grip", "port": "/dev/ttyACM1"}
            buttons = {b: int(t % 1 * 4) == n for n, b in enumerate("abc", 1)}
            entry["state"] = {"orientation": ORIENTATION, "buttons": buttons, "hall": 0, "battery_level": 0.8}
            entry["status"] = {"ready": True, "connected": True}
            m["wireless_verse_grip"].append(entry)
        self.force = {}  # applied once
        return json.dumps(m).encode()

    def answer(self, full=False):
        self.faulted = self.first is not None and time.monotonic() - self.first > 1
        data = self.state(full)
        if self.fault == "mute" or self.faulted and self.fault in ("silent", "half"):
            if self.fault == "half" and not self.dead:
                self.push(self.frame(TEXT, data)[:len(data) // 2])
            self.dead = True
            return
        if self.faulted and self.fault == "big" and not self.big_is_out:
            self.big_is_out = True
            data = data[:-1] + b" " * 3000000 + b"}"
        if self.faulted and self.fault == "garbage":
            data = b'{"session_id": 7, "inverse3": [{"device_id": "04BA", "state": {"cursor_position": {"x": 0.0, "y": '
        if self.fault == "late" and not full:
            time.sleep(0.03)
        if self.fault == "fragments":
            third = len(data) // 3
            self.log["pings"] += 1
            whole = b"".join((self.frame(TEXT, data[:third], False), self.frame(PING, b"p-between"),
                              self.frame(0, data[third:-third], False), self.frame(0, data[-third:])))
            self.push(whole[:third // 2])
            time.sleep(0.001)
            self.push(whole[third // 2:])
        else:
            self.send(TEXT, data)
        self.log["answers"] += 1

    def serve(self):
        self.link.settimeout(0.05)
        self.link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        try:
            self.shake()
            self.answer(full=True)
            while True:
                data = self.message()
                if self.first is None:
                    self.first = time.monotonic()
                self.log["messages"] += 1
                self.check(data)
                self.answer(full=b"force_render_full_state" in data)
        except Ended as e:
            self.log["end"] = str(e)
        self.must(len(self.masks) != 1 or self.log["messages"] < 9, "frame: one mask for all, where each must be a new one")


def main():
    folder, fault = Path(sys.argv[1]), sys.argv[3] if sys.argv[2:3] == ["--fault"] else "none"
    if fault not in FAULTS:
        sys.exit(f"{fault}: must be one of {', '.join(FAULTS)}")
    connections, saved = [], [0.0]

    def write(name, text):
        (folder / (name + ".tmp")).write_text(text)
        os.replace(folder / (name + ".tmp"), folder / name)

    def save(connection=None):
        if connection and time.monotonic() - saved[0] < 0.2:
            return
        saved[0] = time.monotonic()
        for c in connections:
            c.log["last_zero"] = all(f["last_n"] == [0, 0, 0] for f in c.log["forces"].values())
        write("log.json", json.dumps({"fault": fault, "connections": [c.log for c in connections]}))

    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    with socket.create_server(("127.0.0.1", 0), backlog=8) as server:
        save()
        write("port", str(server.getsockname()[1]))
        try:
            while True:
                link, _ = server.accept()
                with link:
                    connections.append(Connection(link, fault, save))
                    connections[-1].serve()
                save()
        finally:
            save()


if __name__ == "__main__":
    main()
