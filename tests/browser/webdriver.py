# SPDX-License-Identifier: GPL-3.0-or-later
"""Debian's chromium, driven through chromedriver (W3C WebDriver) by the standard library alone."""
import base64
import json
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request


def skip(why):
    """In ./check, which installs what is missing, that is a failure."""
    if os.environ.get("TREPHINE_CHECK") == "1":
        sys.exit("FAILED: " + why)
    print("skipped: " + why)
    sys.exit(77)


class Browser:
    def __init__(self, *arguments, width=1400, height=900):
        for program in ("chromium", "chromedriver"):
            if not shutil.which(program):
                skip(program + " is not installed (packages-check.txt)")
        with socket.socket() as s:
            s.bind(("127.0.0.1", 0))
            port = s.getsockname()[1]
        self.driver = subprocess.Popen(["chromedriver", f"--port={port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.session = None
        root = f"http://127.0.0.1:{port}"
        for _ in range(3000):
            try:
                urllib.request.urlopen(root + "/status", timeout=5)
                break
            except OSError:
                time.sleep(0.1)
        flags = ["--headless=new", "--no-first-run", "--disable-background-networking", "--hide-scrollbars",
                 f"--window-size={width},{height}", *arguments]
        if os.geteuid() == 0:
            flags.append("--no-sandbox")  # chromium refuses to run as root otherwise, as in a container of a CI
        wanted = {"browserName": "chrome", "goog:chromeOptions": {"args": flags},
                  "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}
        try:
            answer = self._call(root + "/session", {"capabilities": {"alwaysMatch": wanted}})
        except Exception:
            self.close()
            raise
        self.session = root + "/session/" + answer["sessionId"]

    def _call(self, url, body=None, method=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(url, data=data, method=method or ("GET" if body is None else "POST"),
                                         headers={"Content-Type": "application/json"})
        try:
            with urllib.request.urlopen(request, timeout=900) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as e:
            raise RuntimeError(json.load(e)["value"]["message"].split("\n")[0]) from None

    def call(self, path, body=None, method=None):
        return self._call(self.session + path, body, method)

    def open(self, url):
        self.call("/url", {"url": url})

    def js(self, script, *arguments):
        return self.call("/execute/sync", {"script": script, "args": list(arguments)})

    def log(self, kind):
        return self.call("/se/log", {"type": kind})

    def screenshot(self, file):
        with open(file, "wb") as out:
            out.write(base64.b64decode(self.call("/screenshot")))

    def act(self, *sources):
        """Input as a person gives it. Each source is a dictionary of WebDriver's actions."""
        self.call("/actions", {"actions": list(sources)})

    def drag(self, x0, y0, x1, y1, button=0, shift=False):
        mouse = [{"type": "pointerMove", "x": x0, "y": y0}, {"type": "pointerDown", "button": button},
                 {"type": "pointerMove", "x": (x0 + x1) // 2, "y": (y0 + y1) // 2, "duration": 30},
                 {"type": "pointerMove", "x": x1, "y": y1, "duration": 30}, {"type": "pointerUp", "button": button}]
        sources = [{"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": mouse}]
        if shift:
            keys = [{"type": "keyDown", "value": "\ue008"}] + [{"type": "pause"}] * 4 + [{"type": "keyUp", "value": "\ue008"}]
            mouse.insert(0, {"type": "pause"})
            sources.append({"type": "key", "id": "keys", "actions": keys})
        self.act(*sources)

    def click(self, x, y):
        self.act({"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"},
                  "actions": [{"type": "pointerMove", "x": x, "y": y}, {"type": "pointerDown", "button": 0},
                              {"type": "pointerUp", "button": 0}]})

    def wheel(self, x, y, delta):
        self.act({"type": "wheel", "id": "wheel",
                  "actions": [{"type": "scroll", "x": x, "y": y, "deltaX": 0, "deltaY": delta, "origin": "viewport"}]})

    def pinch(self, x, y, before, after):
        """Two fingers about (x, y), from `before` to `after` pixels between them."""
        def finger(name, side):
            at = [{"type": "pointerMove", "x": x + side * before // 2, "y": y}, {"type": "pointerDown", "button": 0}]
            steps = [{"type": "pointerMove", "x": x + side * (before + (after - before) * i // 4) // 2, "y": y, "duration": 30}
                     for i in range(1, 5)]
            return {"type": "pointer", "id": name, "parameters": {"pointerType": "touch"},
                    "actions": at + steps + [{"type": "pointerUp", "button": 0}]}
        self.act(finger("finger 1", -1), finger("finger 2", 1))

    def key(self, value):
        self.act({"type": "key", "id": "keys", "actions": [{"type": "keyDown", "value": value}, {"type": "keyUp", "value": value}]})

    def close(self):
        try:
            if self.session:
                self.call("", method="DELETE")
        finally:
            self.driver.terminate()
            self.driver.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class Checks:
    """Counts what does not hold and says it."""
    def __init__(self):
        self.count = self.faults = 0

    def __call__(self, holds, what):
        self.count += 1
        if not holds:
            self.faults += 1
            print("FAILED: " + what, flush=True)

    def end(self):
        print(f"{self.count} checks, {self.faults} failed")
        sys.exit(1 if self.faults or not self.count else 0)
