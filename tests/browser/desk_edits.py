# SPDX-License-Identifier: GPL-3.0-or-later
"""desk_edits.py: corrections that are no painting, in chromium with real clicks: a snake that is watched, paused and stepped back, a cut
by a plane, a place that is smoothed, a region of interest; a ZIP and a folder dropped on the page. What was written makes the same bytes
in an empty folder. TREPHINE is the program."""
import json
import pathlib
import tempfile
import zipfile

from desk import SOURCE, Desk, Page, digest, make_root, no_console_errors, run
from webdriver import Browser, Checks

# In the right ventricle of the phantom, of which the skull has nothing: what a snake adds there is seen.
SEED_MM = [-9, -22, 62]
LENGTH = """const v = desk.page.volume, p = v.planes[0], l = v.outline(arguments[0], p.n, desk.page.at[p.n])
if (!l || l.then) return null
let s = 0
for (let i = 0; i < l.length; i += 4) s += Math.hypot(l[i] - l[i + 2], l[i + 1] - l[i + 3])
return s + 1e-9"""


class Edits(Page):
    def go(self, at):
        self.b.js("desk.page.go(arguments[0])", at)
        self.until("desk.page.volume.planes.every(p => p.shown === desk.page.at[p.n])", "the slices")

    def point(self, plane, at):
        self.b.click(*self.place(plane, at))

    def length(self, name):
        """Of the outline on the axial slice, in voxels; once it is there."""
        for _ in range(3000):
            got = self.b.js(LENGTH, name)
            if got is not None:
                return got
        raise RuntimeError("the outline never came: " + name)

    def saved(self, entries, what):
        self.until(f"desk.page.info.journal.length === {entries}", what)

    def number(self, selector, value):
        self.write(selector, f"{value}\ue007")


def voxel(page, mm):
    return [round(v) for v in page.b.js("return desk.page.volume.toIndex(arguments[0])", mm)]


def looking(page, check):
    """A step on the way, two fingers, and a line that is drawn by keys."""
    browser = page.b
    page.click("[data-tab=look]")
    page.go(voxel(page, SEED_MM))
    browser.js("const s = document.getElementById('step-of'); s.value = 'skull.segment'; s.dispatchEvent(new Event('change'))")
    page.until("desk.page.tried === 'skull.segment'", "what the segmentation gives")
    step, last = page.length("~tried"), page.length("skull")
    check(step > 50 and last > 50, f"it is drawn: {step} and {last}")
    browser.js("const s = document.getElementById('step-of'); s.value = ''; s.dispatchEvent(new Event('change'))")
    x, y, w, h = page.box("#axial")
    x, y = round(x + w / 2), round(y + h / 2)
    browser.pinch(x, y, 60, 160)
    zoom = browser.js("return desk.page.volume.planes[0].zoom")
    check(1.5 < zoom < 4, f"two fingers that part enlarge: {zoom}")
    before = browser.js("return desk.page.at")
    browser.act(*[{"type": "pointer", "id": f"finger {n}", "parameters": {"pointerType": "touch"}, "actions": [
        {"type": "pointerMove", "x": x + side, "y": y}, {"type": "pointerDown", "button": 0},
        *[{"type": "pointerMove", "x": x + side, "y": y + 10 * i, "duration": 30} for i in range(1, 5)], {"type": "pointerUp", "button": 0}]}
        for n, side in ((1, -40), (2, 40))])
    after = browser.js("return desk.page.at")
    check(after[:2] == before[:2] and 2 <= after[2] - before[2] <= 6, f"two fingers that move down go through the slices: {before}, {after}")
    browser.js("desk.page.volume.planes[0].zoom = 1; desk.page.pick('measure'); document.getElementById('axial').focus()")
    for key in ("\ue007", *["\ue014"] * 6, "\ue007"):
        browser.key(key)
    page.until("desk.page.measures.length === 1 && desk.page.measures[0].mm > 0", "a measure by keys")
    mm, spacing = browser.js("return desk.page.measures[0].mm"), browser.js("return desk.page.volume.spacing[0]")
    check(abs(mm - 6 * spacing) < 0.01, f"six steps to the right: {mm}")


def snake(page, check, own, desk):
    """The desk that serves from then on: this one is killed."""
    page.click("[data-tab=paint]")
    page.b.js("const s = document.getElementById('anatomy'); s.value = 'skull'; s.dispatchEvent(new Event('change'))")
    seed = voxel(page, SEED_MM)
    page.go(seed)
    page.click("[data-tool=snake]")
    page.point("axial", seed)
    page.until("!!document.getElementById('snake-run')", "a snake that can grow")
    page.number("[data-edit=seed_radius_mm]", 3)
    page.number("[data-edit=upper_hu]", 6)
    page.number("[data-edit=lower_hu]", -60)
    page.click("#snake-step")
    page.until("desk.stats.snake === 1", "its first step")
    first = page.length("~edit")
    page.click("#snake-run")
    page.until("desk.stats.snake >= 6", "its growth")
    page.click("#snake-pause") if page.b.js("return !!document.getElementById('snake-pause')") else None
    page.until("!!document.getElementById('snake-run')", "the pause")
    steps = page.b.js("return desk.stats.snake")
    grown = page.length("~edit")
    check(first > 5 and grown > 1.2 * first, f"it grows: {first} and, after {steps} steps, {grown}")
    page.click("#snake-back")
    page.until(f"desk.stats.snake === {steps - 1}", "one step back")
    page.until("document.getElementById('edit-said').classList.contains('good')", "what it says")
    before = page.length("~edit")
    page.click("#snake-step")
    page.until(f"desk.stats.snake === {steps}", "and on again")
    check(page.length("~edit") == grown, "back and on again it is the same to the bit")
    check(before <= grown and not own.exists(), "nothing is written yet")
    # a desk that is killed before it is saved
    page.until(f"desk.stats.snake === {steps}", "the step")
    page.b.js("desk.page.remember()")
    for _ in range(600):
        kept = page.b.call("/execute/async", {"script": "const done = arguments[0]; askBytes('draft', { case: 'head-01', what: 'view' }).then(b => done(JSON.parse(new TextDecoder().decode(b) || '{}')), e => done({}))", "args": []})
        if (kept.get("edit") or {}).get("steps") == steps:
            break
    desk.process.kill()
    desk.process.wait()
    desk = Desk(desk.root, desk.library)
    page.b.open(desk.url + "/case/head-01")
    page.until(f"desk.page && desk.page.volume && desk.page.fields.includes('skull') && !document.getElementById('busy').textContent && desk.stats.snake === {steps}", "the snake at another desk")
    check(page.length("~edit") == grown, "a killed desk loses nothing of it")
    page.write("#who", "anna-2")  # another port is another place to the browser
    page.click("[data-tab=paint]")
    page.write("#why", "a lost horn")
    page.click("#save-edit")
    page.saved(1, "the snake is saved")
    text = own.read_text()
    check("corrections: {skull: head-01.desk/skull.json}" in text, f"the configuration names it: {text[-200:]}")
    kept = json.loads((own.parent / "head-01.desk/skull.json").read_text())["edits"]
    check(len(kept) == 1 and kept[0]["snake"]["steps_count"] == steps and kept[0]["snake"]["upper_hu"] == 6, f"as what it is: {kept}")
    return desk


def cut_and_smooth(page, check, own):
    place = voxel(page, [-60, 0, 70])
    page.go(place)
    page.click("[data-tool=cut]")
    a, b = [place[0] - 8, place[1] - 1, place[2]], [place[0] + 8, place[1] - 1, place[2]]
    page.b.drag(*page.place("axial", a), *page.place("axial", b))
    page.until("desk.stats.previewed === 1", "what the cut would take")
    said = page.b.js("return document.getElementById('edit-said').textContent")
    check("removed" in said and "added" not in said, f"it takes something: {said}")
    whole, cut = page.length("skull"), page.length("~edit")
    check(abs(whole - cut) > 1, f"and is drawn: {whole} and {cut}")
    normal = page.b.js("return document.getElementById('edit-what').textContent")
    page.click("#flip")
    page.until("desk.stats.previewed === 2", "the other side")
    other = page.b.js("return document.getElementById('edit-said').textContent")
    check("removed" in other and other != said, f"the other side is another part: {other} ({normal})")
    page.click("#save-edit")
    page.saved(2, "the cut is saved")
    page.click("[data-tool=smooth]")
    page.point("axial", [place[0], place[1] + 12, place[2]])
    page.until("!!document.querySelector('[data-edit=sigma_mm]')", "a place to be smoothed")
    page.number("[data-edit=sigma_mm]", 4)
    page.click("#edit-preview")
    page.until("desk.stats.previewed === 3", "what smoothing would do")
    page.click("#save-edit")
    page.saved(3, "the smoothing is saved")
    list_ = own.parent / "head-01.desk/skull.json"
    kept = [next(iter(e)) for e in json.loads(list_.read_text())["edits"]]
    check(kept == ["snake", "cut", "smooth"], f"in their order: {kept}")
    # a painted patch among them, then one switched off and on, by its box and by undo
    page.click("[data-tool=add]")
    page.point("axial", [place[0] + 10, place[1], place[2]])
    page.until("desk.stats.painted[0] > 0", "a dab")
    page.click("#save-patch")
    page.saved(4, "the patch")
    all_of = list_.read_bytes()
    check([next(iter(e)) for e in json.loads(all_of)["edits"]] == ["snake", "cut", "smooth", "patch"], "the patch comes last")
    page.click("[data-tool=smooth]")
    page.click("#undo")
    page.saved(5, "undo")
    check([next(iter(e)) for e in json.loads(list_.read_text())["edits"]] == ["snake", "cut", "patch"], "undo switches the smoothing off")
    page.click("#redo")
    page.saved(6, "redo")
    check(list_.read_bytes() == all_of, "redo switches it on again")
    for n, (id_, names) in enumerate(((1, ["cut", "smooth", "patch"]), (2, ["smooth", "patch"]))):
        page.click(f"[data-patch='{id_}']")
        page.saved(7 + n, "one is switched off")
        check([next(iter(e)) for e in json.loads(list_.read_text())["edits"]] == names, f"without: {names}")
    for n, id_ in enumerate((1, 2)):
        page.click(f"[data-patch='{id_}']")
        page.saved(9 + n, "and on")
    check(list_.read_bytes() == all_of, "all on, it is what it was")


def region(page, check, own):
    page.click("[data-tab=place]")
    before = own.read_text()
    page.b.js("const s = document.getElementById('region-of'); s.value = 'skull.segment.roi'; s.dispatchEvent(new Event('change'))")
    low, high = voxel(page, [-70, -80, 30]), voxel(page, [70, 80, 30])
    page.go(voxel(page, [0, 0, 60]))
    page.click("[data-tool=region]")
    axial = [[v[0], v[1], page.b.js("return desk.page.at[2]")] for v in (low, high)]
    page.b.drag(*page.place("axial", axial[0]), *page.place("axial", axial[1]))
    page.until("document.getElementById('region').textContent.includes('∞')", "a box on two axes")
    c0, c1 = voxel(page, [-70, 0, 20]), voxel(page, [70, 0, 110])
    at = page.b.js("return desk.page.at")
    page.b.drag(*page.place("coronal", [c0[0], at[1], c0[2]]), *page.place("coronal", [c1[0], at[1], c1[2]]))
    page.until("!document.getElementById('region').textContent.includes('∞')", "a box on all three")
    check(own.read_text() == before, "drawing writes nothing")
    page.click("#region-set")
    page.saved(11, "the region")
    text = own.read_text()
    check("skull.segment.roi_min_mm: [" in text and "skull.segment.roi_max_mm: [" in text, f"two lines: {text[-300:]}")
    page.click("#undo")
    page.saved(12, "undo of the region")
    check(own.read_text() == before, "undo takes both away at once")
    page.click("#redo")
    page.saved(13, "redo of the region")
    check(own.read_text() == text, "redo writes both")


def dropped(page, check, root, folder):
    """Files as the system hands them to a page: chromium makes the DataTransfer of them."""
    browser = page.b
    packed = folder / "Name of a patient.zip"
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as z:
        for f in sorted((SOURCE / "sample_dicom").iterdir()):
            z.write(f, f.name)
    for what, files in (("ZIP", [packed]), ("folder", [root / "sample_dicom"])):
        browser.js("location.hash = 'library'")
        page.until("document.documentElement.dataset.ready === 'library'", "the library's page")
        browser.js("location.hash = 'new'")
        page.until("!!document.getElementById('drop')", "the page of a new case")
        x, y, w, h = page.box("#drop")
        for kind in ("dragEnter", "dragOver", "drop"):
            browser.call("/goog/cdp/execute", {"cmd": "Input.dispatchDragEvent", "params": {
                "type": kind, "x": x + w / 2, "y": y + 10, "data": {"items": [], "files": [str(f) for f in files], "dragOperationsMask": 1}}})
        page.until("!!document.querySelector('.thumb') && document.querySelector('.thumb').naturalWidth > 100", f"the series of the dropped {what} with its middle slices")
    lying = list((root / "configs/dropped").iterdir())
    check(sorted(f.is_dir() for f in lying) == [False, True] and not any("patient" in f.name for f in lying), f"both lie under names of their content: {lying}")


def main():
    check = Checks()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        root, library = make_root(folder), folder / "library"
        own = root / "configs/head-01.yaml"
        run("library", "build", root / "configs/LIBRARY.yaml", "--out", library, "--quiet", "--no-pictures")
        first = digest(library / "head-01")
        with Desk(root, library) as desk:
            with Browser("--enable-unsafe-swiftshader", "--lang=en", width=1600, height=1000) as browser:
                browser.open(desk.url)
                page = Edits(browser, check)
                page.until("document.documentElement.dataset.ready === 'library' && !!document.querySelector('.card')", "the library's page")
                page.write("#who", "anna-2")
                page.click(".card")
                page.until("desk.page && desk.page.volume && desk.page.fields.includes('skull') && !document.getElementById('busy').textContent && document.documentElement.dataset.ready === 'case'", "the opened case")
                looking(page, check)
                desk = snake(page, check, own, desk)
                cut_and_smooth(page, check, own)
                region(page, check, own)
                page.click("[data-tab=build]")
                page.click("#rerun")
                page.until("desk.stats.rebuilt >= 1 && desk.page.info.reasons.length === 0", "the rebuild")
                made = digest(library / "head-01")
                recorded = json.loads((library / "head-01/case.json").read_text())["provenance"]["parameters"]
                check(made != first and recorded["skull.correct.added_ml"] > 0.05 and recorded["skull.correct.removed_ml"] > 0, f"the case has them: {[v for v in recorded.items() if '.correct.' in v[0]]}")
                dropped(page, check, root, folder)
                no_console_errors(browser, check)
            run("library", "build", root / "configs/LIBRARY.yaml", "--out", folder / "again", "--quiet", "--no-pictures")
            check(digest(folder / "again/head-01") == made, "the written configuration makes the same bytes")
            check(desk.end() == 0, "Ctrl-C ends the desk")
    check.end()


if __name__ == "__main__":
    main()
