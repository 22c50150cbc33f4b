#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A haptic device for `trephine-sim servo CASE --device udp`, version 2 of its packets (docs/reference/udp-device.md), in Python's own library.

    udp_client.py ADDRESS PORT SECONDS X Y Z DX DY DZ DEPTH_MM [LOG [PEDALS]]

The device is a mass of 0.2 kg that a spring draws from X Y Z (mm, LPS) along DX DY DZ, DEPTH_MM far, while the hand turns it about its
axis. To drive another, use Link alone: link.pose(tip, turn) each millisecond, link.force() for what the hand shall feel. It does what
udp_client.c does, with the same arguments, log, messages and exit codes."""
import math
import os
import socket
import struct
import sys
import time

POSE = struct.Struct("<4sHHIIQd3d4dIHH")  # 96 bytes
FORCE = struct.Struct("<4sHHIIQdd3d3d3d4diiII")  # 160 bytes
VERSION, BUSY, HOLD_S, DECAY_S = 2, 1, 0.005, 0.010


class Link:
    """Poses to the servo, and forces from it. Positions are mm and directions LPS; forces N, torques N mm."""

    def __init__(self, address, port):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect((address, port))
        self.socket.setblocking(False)
        self.session, self.begin = os.getpid(), time.monotonic()
        self.sequence = self.answered = self.answers = self.faults = self.events = 0
        self.busy, self.heard = False, self.begin
        self.last_n = self.torque_n_mm = (0.0, 0.0, 0.0)

    def pose(self, tip_mm, turn=(0, 0, 0, 1), pedals=0):
        """turn: a unit quaternion x, y, z, w from the tool's axes (tip at 0, tail towards +z) to LPS."""
        self.sequence += 1
        now = time.monotonic() - self.begin
        packet = POSE.pack(b"TRPP", VERSION, 0, self.session, 0, self.sequence, now, *tip_mm, *turn, pedals, 0, 0)
        try:
            self.socket.send(packet)
        except OSError:
            pass  # where nobody listens the force decays
        return self.sequence

    def take(self):
        """The sequence of the pose that the next waiting answer is of; None where there is none."""
        while True:
            try:
                packet = self.socket.recv(FORCE.size + 1)
            except OSError:
                return None
            if len(packet) != FORCE.size:
                continue
            magic, version, flags, session, faults, of, _, _, *rest = FORCE.unpack(packet)
            if (magic, version, session) != (b"TRPF", VERSION, self.session):
                continue
            self.busy = self.busy or bool(flags & BUSY)
            if self.busy or not self.answered < of <= self.sequence or not all(map(math.isfinite, rest[:3])):
                continue
            self.last_n, self.torque_n_mm = tuple(rest[:3]), tuple(rest[3:6])
            self.faults |= faults
            self.new_events = rest[15]
            self.events |= self.new_events
            self.answered, self.answers, self.heard = of, self.answers + 1, time.monotonic()
            return of

    def force(self):
        """What nobody renews is held, then decays: a servo that stalls neither kicks nor pushes on."""
        age = time.monotonic() - self.heard
        share = 1 if age <= HOLD_S else math.exp((HOLD_S - age) / DECAY_S)
        return [share * n for n in self.last_n]


def turn_to(way, angle_rad=0.0):
    """From +z to where the tail points, against the way, and by the angle about the axis before that."""
    x, y, z = (-w for w in way)
    w = math.sqrt(max(0.0, 0.5 * (1 + z)))
    over = (-0.5 * y / w, 0.5 * x / w, 0.0, w) if w > 1e-6 else (1.0, 0.0, 0.0, 0.0)
    s, c = math.sin(0.5 * angle_rad), math.cos(0.5 * angle_rad)
    return (over[0] * c + over[1] * s, over[1] * c - over[0] * s, over[3] * s, over[3] * c)


def number(word):
    """NAN where the word is none."""
    try:
        return float(word)
    except ValueError:
        return math.nan


def refuse(code, word, what):
    print(f"udp_client: {word}: {what}", file=sys.stderr)
    return code


def main(arguments):
    if len(arguments) < 10:
        print("udp_client ADDRESS PORT SECONDS X Y Z DX DY DZ DEPTH_MM [LOG [PEDALS]]", file=sys.stderr)
        return 64
    address = arguments[0]
    for word in arguments[1:10] + arguments[11:]:
        if not math.isfinite(number(word)):
            return refuse(64, word, "is no number")
    port, seconds, *pose, depth_mm = map(number, arguments[1:10])
    start, way = pose[:3], pose[3:]
    pedals = int(number(arguments[11])) if len(arguments) > 11 else 0
    if not 1 <= port <= 65535:
        return refuse(64, arguments[1], "is no port, 1 to 65535")
    if not 0 <= pedals <= 3:
        return refuse(64, arguments[11], "are no pedals, 0 to 3")
    try:
        socket.inet_pton(socket.AF_INET, address)
    except OSError:
        return refuse(64, address, "is no IPv4 address in numbers")
    if not any(way):
        return refuse(64, "DX DY DZ", "must have a length")
    way = [w / math.hypot(*way) for w in way]
    try:
        link = Link(address, int(port))
    except OSError as error:
        return refuse(74, address, error.strerror)
    try:
        log = open(arguments[10], "w") if len(arguments) > 10 else None
    except OSError as error:
        return refuse(73, arguments[10], error.strerror)
    position, velocity, sent, most_n = list(start), [0.0] * 3, {}, 0.0
    mass_kg, spring, damping, steps = 0.2, 0.4, 0.006, 8  # N/mm, N s/mm
    began = last = time.monotonic()
    while time.monotonic() < began + seconds:
        now = time.monotonic()
        dt, last, force = min(now - last, 0.01) / steps, now, link.force()
        if link.answers == 0:
            pressed = now  # it waits for the servo's first answer
        aim = min(depth_mm, 20 * (now - pressed))  # mm/s
        for _ in range(steps):
            for a in range(3):
                pull = spring * (start[a] + way[a] * aim - position[a])
                velocity[a] += (pull + force[a] - damping * velocity[a]) * 1000 / mass_kg * dt
                position[a] += velocity[a] * dt
        sent[link.pose(position, turn_to(way, now - pressed), pedals)] = tuple(position)  # by 1 rad/s
        while (of := link.take()) is not None:
            most_n = max(most_n, math.hypot(*link.last_n))
            if log:
                figures = " ".join(x.hex() for x in (*sent[of], *link.last_n, *link.torque_n_mm))
                print(of, figures, link.new_events, file=log)
            sent = {n: tip for n, tip in sent.items() if n > of}
        time.sleep(max(0.0, now + 0.001 - time.monotonic()))
    if log:
        log.close()
    other = ", another client is there" if link.busy else ""
    print(f"{link.sequence} poses, {link.answers} answers, force at most {most_n:.3f} N{other}, events {link.events}, faults {link.faults}")
    return 2 if link.busy or link.faults else 1 if link.answers == 0 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
