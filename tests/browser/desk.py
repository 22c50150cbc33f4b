# SPDX-License-Identifier: GPL-3.0-or-later
"""desk.py: the desk in chromium, with real clicks: a case of the sample phantom is opened, a landmark moved, a patch
painted, the case rebuilt and approved; what was written makes the same bytes in an empty folder. Then requests that nobody should
send (desk_requests.py). TREPHINE is the program."""
import hashlib
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

from webdriver import Browser, Checks

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TREPHINE = os.environ["TREPHINE"]
CASE = """# The sample phantom, coarse.
trephine: 1
pipeline: ../pipelines/ventriculostomy.yaml   # the recipe
scene: scenes/%s.yaml
landmarks:  # mm, LPS
  nasion: [0, -93.2, 40.1]
  inion: [0, 89.4, 5.8]
  tragus_left: [77.0, -1.6, 0]
  tragus_right: [-74.8, -4.2, 0]
  monro_right: [-2.7, -11.9, 53.5]
set: {%s}
"""
# The skull alone, on coarse voxels.
SMALL = ("skull", "skin.segment.fill: none, skin.segment.coarse_mm: 1.5, resample.spacing_mm: [2.5, 2.5, 2.5]")


def make_root(folder, what=SMALL):
    """A root with recipes, scenes, the sample's series and a library of one case."""
    root = folder / "root"
    root.mkdir()
    (root / "trephine.root").touch()
    for name in ("pipelines", "configs", "sample_dicom"):
        shutil.copytree(SOURCE / name, root / name)
    (root / "configs/coarse.yaml").write_text(CASE % what)
    (root / "configs/LIBRARY.yaml").write_text(
        "# A library of one.\ntrephine: 1\nconfig: coarse.yaml\ncases:\n  - {case: head-01, series: ../sample_dicom}  # the phantom\n")
    return root


def run(*words):
    done = subprocess.run([TREPHINE, *map(str, words)], capture_output=True, text=True, timeout=1500)
    if done.returncode:
        raise RuntimeError(f"{words}: {done.stderr}")


class Desk:
    """Of a root that make_root made, or without one, of a library that is only looked at."""
    def __init__(self, root, library):
        self.root, self.library = root, library
        config = ["--config", str(root / "configs/LIBRARY.yaml")] if root else []
        self.process = subprocess.Popen([TREPHINE, "desk", str(library), *config, "--no-browser"], stdout=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        self.address = re.search(r"http://127\.0\.0\.1:(\d+)/#([0-9a-f]{32})", line)
        if not self.address:
            raise RuntimeError("the desk says: " + line)
        self.port, self.token = int(self.address[1]), self.address[2]
        self.url = self.address[0]

    def raw(self, data, patience=60, most=1 << 20, later=b""):
        """Sends bytes as they are, and more a moment later; returns what came back until then."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=60) as s:
            s.settimeout(patience)
            try:
                s.sendall(data)
                if later:
                    time.sleep(0.5)
                    s.sendall(later)
                got = b""
                while len(got) < most:
                    piece = s.recv(65536)
                    if not piece:
                        break
                    got += piece
            except (OSError, socket.timeout):
                return b""
            return got

    def head(self, method, path, **headers):
        """Of a request of the owner; with a header of None, without that one."""
        origin = f"http://127.0.0.1:{self.port}" if method == "POST" else None
        lines = {"Host": f"127.0.0.1:{self.port}", "Trephine-Desk": self.token, "Connection": "close", "Origin": origin, **{k.replace("_", "-"): v for k, v in headers.items()}}
        return (f"{method} /{path} HTTP/1.1\r\n" + "".join(f"{k}: {v}\r\n" for k, v in lines.items() if v is not None) + "\r\n").encode()

    def get(self, path, **headers):
        return self.raw(self.head("GET", path, **headers))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()

    def end(self):
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(timeout=300)


def no_console_errors(browser, check):
    """What the desk refuses (422) the browser logs as well; all else in its console is a fault."""
    severe = [e["message"] for e in browser.log("browser") if e["level"] == "SEVERE" and "422" not in e["message"]]
    check(not severe, f"no error in the console: {severe}")


class Page:
    """The desk's page, used as a person does."""
    def __init__(self, browser, check):
        self.b, self.check = browser, check

    def until(self, script, what, *arguments, seconds=300):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            got = self.b.js("const got = " + script + "; return got instanceof Object ? true : got", *arguments)
            if got:
                return got
            problem = self.b.js("return document.getElementById('problem').hidden ? '' : document.getElementById('problem-text').textContent")
            if problem and not self.b.js("return !!(" + script + ")", *arguments):  # which may have been what was waited for
                raise RuntimeError(f"waiting for {what}, the desk says: {problem}")
            time.sleep(0.1)
        raise RuntimeError("never: " + what)

    def box(self, selector):
        return self.b.js("const e = document.querySelector(arguments[0]); e.scrollIntoView({block: 'nearest'}); const b = e.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]", selector)

    def click(self, selector):
        self.until("!!document.querySelector(arguments[0]) && !document.querySelector(arguments[0]).disabled", selector, selector)
        x, y, w, h = self.box(selector)
        self.b.click(round(x + w / 2), round(y + h / 2))

    def write(self, selector, text):
        self.click(selector)
        self.b.js("document.querySelector(arguments[0]).select && document.querySelector(arguments[0]).select()", selector)
        actions = []
        for letter in text:
            actions += [{"type": "keyDown", "value": letter}, {"type": "keyUp", "value": letter}]
        self.b.act({"type": "key", "id": "keys", "actions": actions})

    def place(self, plane, at):
        """Where a place of the scan's lattice lies on the screen."""
        x, y, _, _ = self.box("#" + plane)
        u, v = self.b.js("const p = desk.page.volume.planes.find(p => p.id === arguments[0]), at = arguments[1]; return p.place(at[p.u], at[p.v])", plane, at)
        return round(x + u), round(y + v)


def digest(case):
    manifest = (case / "case.json").read_bytes()
    for f in json.loads(manifest)["files"]:
        assert hashlib.sha256((case / f["name"]).read_bytes()).hexdigest() == f["sha256"], f["name"]
    return hashlib.sha256(manifest).hexdigest()


def work(check, folder):
    root, library = make_root(folder), folder / "library"
    with Desk(root, library) as desk:
        with Browser("--enable-unsafe-swiftshader", "--lang=en", width=1600, height=1000) as browser:
            browser.open(desk.url)
            page = Page(browser, check)
            page.until("document.documentElement.dataset.ready === 'library' && !!document.querySelector('.card')", "the library's page")
            check("never built" in browser.js("return document.querySelector('.card').textContent"), "a case that was never built has a card")
            page.write("#who", "anna-2")
            page.click("#build")
            page.until("document.querySelector('.card .tag.good') && desk.cases.length === 1 && !desk.page.building", "the build")
            check((library / "head-01/case.json").exists(), "the build made the case")
            first = digest(library / "head-01")

            page.click(".card")
            page.until("desk.page && desk.page.volume && desk.page.fields.includes('skull') && !document.getElementById('busy').textContent && document.documentElement.dataset.ready === 'case'", "the opened case")
            browser.js("desk.page.go(desk.page.volume.toIndex([0, -20, 60]))")
            page.until("desk.page.volume.planes.every(p => p.shown === desk.page.at[p.n])", "the slices")
            check(browser.js("""const c = document.getElementById('axial'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data
                let n = 0; for (let i = 0; i < d.length; i += 4) n += d[i] > 60; return n""") > 5000, "the axial slice shows a head")

            # a measure and a profile over the head
            size = browser.js("return desk.page.volume.size")
            middle = [n // 2 for n in size]
            page.click("[data-tool=measure]")
            browser.drag(*page.place("axial", [size[0] * 0.3, middle[1], 0]), *page.place("axial", [size[0] * 0.7, middle[1], 0]))
            mm = page.until("desk.page.measures.length && desk.page.measures[0].mm", "a measure")
            spacing = browser.js("return desk.page.volume.spacing")
            check(abs(mm - size[0] * 0.4 * spacing[0]) < 3 * spacing[0], f"the measure is {mm} mm")
            page.click("[data-tool=profile]")
            browser.drag(*page.place("axial", [size[0] * 0.2, middle[1], 0]), *page.place("axial", [size[0] * 0.8, middle[1], 0]))
            page.until("+document.getElementById('chart').dataset.values > 50", "a profile")

            # a landmark: chosen in the list, dragged on a slice
            page.click("[data-tab=place]")
            page.click("[data-landmark=inion]")
            page.click("[data-tool=landmark]")
            at = browser.js("return desk.page.volume.toIndex(desk.page.info.now.landmarks.inion)")
            x, y = page.place("axial", at)
            browser.drag(x, y, *page.place("axial", [at[0] + 1, at[1] + 1, at[2]]))
            page.until("desk.page.info.journal.length === 1", "the landmark is saved")
            own = root / "configs/head-01.yaml"
            text = own.read_text()
            check("pipeline: ../pipelines/ventriculostomy.yaml   # the recipe\n" in text and "# The sample phantom, coarse.\n" in text, "comments and layout stay")
            check("  inion: [0, 89.4, 5.8]\n" not in text and "  inion: [" in text and "  nasion: [0, -93.2, 40.1]\n" in text, "one line is another")
            check((root / "configs/coarse.yaml").read_text().count("inion: [0, 89.4, 5.8]") == 1, "the shared configuration is as it was")
            check("{case: head-01, series: ../sample_dicom, config: head-01.yaml}  # the phantom" in (root / "configs/LIBRARY.yaml").read_text(), "LIBRARY.yaml names the case's own")
            page.click("#undo")
            page.until("desk.page.info.journal.length === 2", "undone")
            check("  inion: [0, 89.4, 5.8]\n" in own.read_text(), "undo brings the line back")
            page.click("#redo")
            page.until("desk.page.info.journal.length === 3", "redone")
            check(own.read_text() == text, "and redo the other")

            # a patch: a drag of the brush, beside the skull
            page.click("[data-tab=paint]")
            browser.js("const s = document.getElementById('anatomy'); s.value = 'skull'; s.dispatchEvent(new Event('change'))")
            page.click("[data-tool=add]")
            at = browser.js("return [...desk.page.at]")
            browser.drag(*page.place("axial", [size[0] * 0.35, middle[1], at[2]]), *page.place("axial", [size[0] * 0.6, middle[1] + 2, at[2]]))
            page.until("desk.stats.painted && desk.stats.painted[0] > 20", "painted voxels")
            print(f"brush to picture {browser.js('return desk.stats.brush'):.1f} ms, a plane drawn in {browser.js('return desk.stats.draw'):.1f} ms (a busy machine)")
            page.click("[data-tool=remove]")
            browser.drag(*page.place("axial", [size[0] * 0.35, middle[1], at[2]]), *page.place("axial", [size[0] * 0.38, middle[1], at[2]]))
            page.until("desk.stats.painted[1] > 0", "removed voxels")
            painted = browser.js("return desk.stats.painted")
            page.click("#undo")
            page.until("desk.stats.painted[1] === 0", "undo of a stroke")
            page.click("#redo")
            page.until("JSON.stringify(desk.stats.painted) === arguments[0]", "and redo", json.dumps(painted).replace(" ", ""))

            # the draft survives a reload, and a desk that is killed
            page.until("desk.stats.kept >= 1 && desk.page.volume", "the draft is kept")
            time.sleep(1.5)
            desk.process.kill()
            desk.process.wait()
            desk = Desk(root, library)
            browser.open(desk.url + "/case/head-01")
            page.until("desk.stats.painted && JSON.stringify(desk.stats.painted) === arguments[0]", "the draft is back", json.dumps(painted).replace(" ", ""))
            page.write("#who", "anna-2")
            page.until("desk.page.fields.includes('skull') && !document.getElementById('busy').textContent", "the fields")
            page.click("[data-tab=paint]")
            page.write("#why", "a bridge of bone")
            page.click("#save-patch")
            page.until("desk.page.info.journal.length === 4 && desk.stats.painted[0] === 0", "the patch is saved")
            check("corrections: {skull: head-01.desk/skull.nrrd}" in own.read_text(), "the configuration names it")
            check((root / "configs/head-01.desk/skull-4.nrrd").exists(), "the patch is a file of its own")

            # two desks: the other has not seen the change
            other = Desk(root, library)
            info = json.loads(other.get("api/case?case=head-01").split(b"\r\n\r\n", 1)[1])
            page.click("[data-tab=values]")
            page.write("#find-value", "skull.segment.lower_hu")
            page.until("document.querySelectorAll('[data-value]').length === 1", "one parameter")
            page.write("[data-value]", "230\ue007")
            page.until("desk.page.info.journal.length === 5", "a value is set")
            check("skull.segment.lower_hu: 230" in own.read_text(), "and stands in the configuration")
            body = json.dumps({"case": "head-01", "by": "b", "base": info["base"], "name": "nasion", "position_mm": [0, 0, 0]})
            told = other.raw(other.head("POST", "api/landmark", Content_Type="application/json", Content_Length=len(body)) + body.encode())
            check(b" 409 " in told.split(b"\r\n")[0] and b"changed meanwhile" in told, f"the second desk is told: {told[:300]}")
            check(other.end() == 0 and "nasion: [0, -93.2, 40.1]" in own.read_text(), "and has changed nothing")

            page.click("[data-tab=build]")
            page.click("#rerun")
            page.until("desk.stats.rebuilt >= 1 && desk.page.info.reasons.length === 0", "the rebuild")
            page.until("desk.page.fields.includes('skull') && !document.getElementById('busy').textContent", "the fields after it")
            page.click("#compare")
            page.until("!!document.getElementById('difference') && document.getElementById('difference').textContent.includes('skull')", "the comparison with what it was")
            second = digest(library / "head-01")
            check(second != first, "the case is another")
            recorded = json.loads((library / "head-01/case.json").read_text())["provenance"]["parameters"]
            check(recorded["skull.correct.added_ml"] > 0 and recorded["skull.segment.lower_hu"] == 230, "case.json records what was done")
            check("anna-2" not in (library / "head-01/case.json").read_text(), "and not who did it")

            page.click("[data-tab=approve]")
            check(browser.js("return document.getElementById('approve').disabled"), "no approval before every line is ticked")
            for line in browser.js("return [...document.querySelectorAll('[data-check]')].map(e => e.dataset.check)"):
                page.click(f"[data-check={line}]")
            page.until("!!document.querySelector('[data-lesson]')", "what the simulator says of lessons", seconds=300)
            check(browser.js("return document.getElementById('approve').disabled"), "nor before each lesson that it cannot serve is accepted")
            for lesson in browser.js("return [...document.querySelectorAll('[data-accept]')].map(e => e.dataset.accept)"):
                page.click(f"[data-accept={lesson}]")
            check(browser.js("return document.getElementById('approve').disabled"), "with a reason")
            page.write("#accept-why", "another part of the body")
            page.click("#approve")
            page.until("desk.cases[0].approval && desk.cases[0].approval.holds", "the approval")
            check(json.loads((library / "head-01/approved.json").read_text())["by"] == "anna-2", "signed by the token")
            check({a["reason"] for a in json.loads((library / "head-01/approved.json").read_text())["accepted"]} == {"another part of the body"}, "with the reasons")
            page.click("[data-tab=history]")
            page.until("document.querySelectorAll('#panel tr').length >= 6", "the history")

            # a new case of the same scan
            browser.js("location.hash = 'new'")
            page.click("[data-path='0']")
            page.click("[data-path='0/sample_dicom']")
            page.until("!document.querySelector(\"[data-path='0/sample_dicom']\")", "the folder of the series")
            page.click("#look-series")
            page.until("!!document.querySelector('.thumb') && document.querySelector('.thumb').naturalWidth > 100", "the middle slices")
            page.write("#token", "head-02")
            offered = browser.js("return [...document.getElementById('recipe').options].map(o => o.value)")
            check("coarse.yaml" in offered and "head-01.yaml" not in offered, f"one patient's configuration is no recipe for the next: {offered}")
            listed = (root / "configs/LIBRARY.yaml").read_text()
            browser.js("const s = document.getElementById('recipe'); s.add(new Option('x', 'head-01.yaml')); s.value = 'head-01.yaml'")
            page.click("#create")
            page.until("document.getElementById('problem-text').textContent.includes('of head-01 alone')", "nor is it taken")
            check((root / "configs/LIBRARY.yaml").read_text() == listed, "and LIBRARY.yaml is as it was")
            browser.js("document.getElementById('recipe').value = 'coarse.yaml'")
            page.click("#create")
            page.until("document.documentElement.dataset.ready === 'library' && document.querySelectorAll('.card').length === 2", "the new case's card")
            check(not browser.js("return document.body.textContent.includes('?t_')"), "every text is there")
            no_console_errors(browser, check)
            outside = [e for e in browser.log("performance") if '"Network.requestWillBeSent"' in e["message"] and "http" in e["message"]
                       and not re.search(r'"url":"(http://127\.0\.0\.1|blob:|data:|about:|chrome)', e["message"])]
            check(not outside, f"nothing is fetched from outside: {[e['message'][:300] for e in outside]}")
        # What was written makes the same bytes in an empty folder.
        run("library", "build", root / "configs/LIBRARY.yaml", "--out", folder / "again", "--case", "head-01", "--quiet", "--no-pictures")
        check(digest(folder / "again/head-01") == second, "the written configuration makes the same bytes")
        check(desk.end() == 0, "Ctrl-C ends the desk")


def main():
    check = Checks()
    with tempfile.TemporaryDirectory() as folder:
        work(check, pathlib.Path(folder))
    check.end()


if __name__ == "__main__":
    main()
