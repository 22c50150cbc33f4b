# SPDX-License-Identifier: GPL-3.0-or-later
"""desk_walk.py [--zip SERIES.zip] [--config CASE.yaml] [--work FOLDER] [--pictures FOLDER]: the whole way in chromium with real clicks, from
a ZIP in an empty library to an approved case with a landmark moved, a burr hole placed, a horn of the ventricles painted and a snake grown in it;
then the written configuration makes the same bytes in an empty folder. By default on the sample phantom. With --pictures it leaves a picture of every page
there (docs/how-to/desk.md). TREPHINE is the program."""
import argparse
import contextlib
import json
import pathlib
import resource
import shutil
import tempfile
import time
import zipfile

from desk import CASE, SOURCE, Desk, Page, digest, no_console_errors, run
from small_picture import shrink
from webdriver import Browser, Checks

COARSE = "resample.spacing_mm: [1.6, 1.6, 1.6], haptic.spacing_mm: [2, 2, 2]"
HOLE = "burr_holes: [{at: kocher, side: right, diameter_mm: 14, toward: monro_right}]\n"
ABOUT = "# A head with a burr hole that is there already: the trainee passes the catheter.\n"


def make_root(folder, packed, config):
    root = folder / "root"
    (root / "scans").mkdir(parents=True)
    (root / "trephine.root").touch()
    for name in ("pipelines", "configs"):
        shutil.copytree(SOURCE / name, root / name)
    for file in (root / "configs").glob("*.yaml"):
        if file.name != "materials.yaml":
            file.unlink()  # what a site has is its own
    if packed:
        shutil.copyfile(packed, root / "scans/head.zip")
    else:
        with zipfile.ZipFile(root / "scans/head.zip", "w", zipfile.ZIP_DEFLATED) as z:
            for f in sorted((SOURCE / "sample_dicom").iterdir()):
                z.write(f, f.name)
    text = pathlib.Path(config).read_text() if config else ABOUT + CASE.split("\n", 1)[1] % ("ventriculostomy_drilled", COARSE) + HOLE
    (root / "configs/head.yaml").write_text(text)
    (root / "configs/LIBRARY.yaml").write_text("# The heads of our course.\ntrephine: 1\nconfig: head.yaml\ncases: []\n")
    return root


class Walk(Page):
    def __init__(self, browser, check, pictures):
        super().__init__(browser, check)
        self.pictures = pictures

    def take(self, name):
        if self.pictures:
            self.b.js("document.getElementById('hint').hidden = true")
            time.sleep(1.5)
            self.b.screenshot(self.pictures / f"desk_{name}.png")

    def opened(self):
        self.until("desk.page && desk.page.volume && desk.page.fields.includes('ventricles') && !document.getElementById('busy').textContent && document.documentElement.dataset.ready === 'case'", "the opened case", seconds=1500)

    def slices(self):
        self.until("desk.page.volume.planes.every(p => p.shown === desk.page.at[p.n])", "the slices")


def bring(page):
    page.until("document.documentElement.dataset.ready === 'library'", "the library's page")
    page.write("#who", "anna-2")
    page.click("#new")
    page.click("[data-path='0']")
    page.click("[data-path='0/scans']")
    page.click("[data-path='0/scans/head.zip']")
    page.until("!!document.querySelector('.thumb') && document.querySelector('.thumb').naturalWidth > 100", "the series with its middle slices", seconds=600)
    page.write("#token", "head-01")
    page.take("new")
    page.click("#create")
    page.until("document.documentElement.dataset.ready === 'library' && document.querySelectorAll('.card').length === 1", "the new case's card")
    page.click("#build")
    page.until("desk.page.building && document.querySelector('.job')", "the build")
    if page.pictures:
        time.sleep(8)
    page.take("building")
    page.until("!desk.page.building && desk.page.ended !== null", "the end of the build", seconds=1500)
    page.check(page.b.js("return desk.page.ended") == 0, "the case is built: " + page.b.js("return document.getElementById('log').textContent"))
    page.take("library")


def move_landmark(page):
    page.click("[data-tab=place]")
    name = page.b.js("return desk.page.info.built.landmarks.some(l => l.name === 'inion') ? 'inion' : 'nasion'")
    page.click(f"[data-landmark={name}]")
    page.click("[data-tool=landmark]")
    page.slices()
    at = page.b.js("return desk.page.volume.toIndex((desk.page.info.now.landmarks[arguments[0]]) || desk.page.info.built.landmarks.find(l => l.name === arguments[0]).position_mm)", name)
    step = page.b.js("return desk.page.volume.spacing.map(s => 1.5 / s)")
    page.b.drag(*page.place("sagittal", at), *page.place("sagittal", [at[0], at[1], at[2] + step[2]]))
    page.until("desk.page.info.journal.length === 1", "the landmark is saved")
    page.take("place")


def place_hole(page):
    page.click("[data-change='0']")
    page.slices()
    page.click("[data-tool=entry]")
    entry = page.b.js("return desk.page.volume.toIndex(desk.page.info.built.holes[0].position_mm)")
    step = page.b.js("return desk.page.volume.spacing.map(s => 3 / s)")
    page.b.drag(*page.place("axial", entry), *page.place("axial", [entry[0], entry[1] + step[1], entry[2]]))
    page.click("#check-hole")
    page.until("!!document.querySelector('#hole-tried.good, #hole-tried.bad, #hole-tried.warn')", "what the run makes of the hole", seconds=900)
    said = page.b.js("return document.getElementById('hole-tried').textContent")
    page.check(page.b.js("return !document.querySelector('#hole-tried.bad')"), "the hole can be placed: " + said)
    page.b.js("document.getElementById('hole').scrollIntoView({ block: 'start' })")
    page.take("hole")
    page.click("#save-hole")
    page.until("desk.page.info.journal.length === 2", "the hole is saved")


def paint_horn(page):
    page.click("[data-tab=paint]")
    page.b.js("const s = document.getElementById('anatomy'); s.value = 'ventricles'; s.dispatchEvent(new Event('change'))")
    page.b.call("/execute/async", {"script": "const done = arguments[0]; goToField(desk.page, 'ventricles').then(done, done)", "args": []})
    page.slices()
    page.until("desk.page.volume.outline('ventricles', 2, desk.page.at[2]).length > 8", "the outline of the ventricles")
    # the foremost point of the outline, on that slice
    tip = page.b.js("const l = desk.page.volume.outline('ventricles', 2, desk.page.at[2]); let best = 0; for (let i = 0; i < l.length; i += 2) if (l[i + 1] < l[best + 1]) best = i; return [l[best], l[best + 1], desk.page.at[2]]")
    page.b.js("desk.page.go(arguments[0])", tip)
    page.slices()
    page.b.js("desk.page.volume.planes[0].zoom = 2.2; desk.page.redraw()")
    page.write("#radius", "2.5\ue007")
    page.click("#ball")
    page.click("[data-tool=add]")
    step = page.b.js("return desk.page.volume.spacing.map(s => 4 / s)")
    time.sleep(0.5)
    page.b.drag(*page.place("axial", tip), *page.place("axial", [tip[0], tip[1] - step[1], tip[2]]))
    page.until("desk.stats.painted && desk.stats.painted[0] > 0", "a painted horn")
    page.write("#why", "the tip of the horn")
    page.take("paint")
    page.click("#save-patch")
    page.until("desk.page.info.journal.length === 3 && desk.stats.painted[0] === 0", "the patch is saved")


def grow_snake(page):
    """From a place in the painted horn, over what has the HU that the scan has there."""
    seed, hu = page.b.js("""const v = desk.page.volume, at = [...desk.page.at], s = v.spacing, data = v.has(2, at[2])
        at[1] = Math.round(at[1] + 4 / s[1])
        let sum = 0, n = 0
        for (let j = -2; j <= 2; ++j) for (let i = -2; i <= 2; ++i) sum += data[(at[1] + j) * v.size[0] + at[0] + i], ++n
        return [at, sum / n]""")
    page.b.js("desk.page.setWindow(arguments[0] + 20, 120)", hu)
    page.click("[data-tool=snake]")
    page.b.click(*page.place("axial", seed))
    page.until("!!document.getElementById('snake-run')", "a snake that can grow")
    page.write("[data-edit=lower_hu]", f"{round(hu) - 60}\ue007")
    page.write("[data-edit=upper_hu]", f"{round(hu) + 12}\ue007")
    page.write("[data-edit=within_mm]", "12\ue007")
    page.click("#snake-run")
    page.until("desk.stats.snake >= 6", "its growth", seconds=600)
    page.b.js("const b = document.getElementById('snake-pause'); if (b) b.click()")
    page.until("!!document.getElementById('snake-run')", "the pause")
    grown = page.b.js("return desk.stats.snake")
    page.click("#snake-back")
    page.until(f"desk.stats.snake === {grown - 1}", "a step back", seconds=600)
    page.b.js("document.getElementById('edit-what').scrollIntoView({ block: 'start' })")
    page.take("snake")
    print("the snake:", page.b.js("return document.getElementById('edit-said').textContent"))
    page.click("#save-edit")
    page.until("desk.page.info.journal.length === 4", "the snake is saved")
    page.b.js("desk.page.setWindow(40, 400)")


def preview(page):
    page.b.js("desk.page.volume.planes[0].zoom = 1; desk.page.go(desk.page.at)")
    page.click("[data-tab=values]")
    page.write("#find-value", "skull.segment.lower_hu")
    page.until("document.querySelectorAll('[data-value]').length === 1", "one parameter")
    page.write("[data-value]", "500")
    page.until("!!document.querySelector('#tried .good, #tried .bad')", "the preview", seconds=900)
    page.take("values")
    page.click("#no-preview")


def rerun_and_approve(page, library):
    page.click("[data-tool=cross]")
    page.click("[data-tab=build]")
    page.click("#rerun")
    page.until("desk.stats.rebuilt >= 1", "the rebuild", seconds=1500)
    page.opened()
    page.check(page.b.js("return desk.page.info.reasons.length") == 0, "the rebuilt case is up to date: " + page.b.js("return document.getElementById('rerun-log').textContent"))
    page.click("#compare")
    page.until("!!document.getElementById('changes')", "the comparison", seconds=600)
    page.slices()
    page.b.js("document.getElementById('changes').scrollIntoView({ block: 'start' }); desk.page.volume.planes[0].zoom = 2.2; desk.page.redraw()")
    page.take("rerun")
    page.b.js("desk.page.volume.planes[0].zoom = 1; desk.page.redraw()")
    page.click("[data-tab=approve]")
    page.until("!!document.querySelector('[data-lesson]')", "what the simulator says of lessons", seconds=300)
    served = page.b.js("return [...document.querySelectorAll('[data-lesson]')].map(e => e.textContent)")
    print("lessons:", *served, sep="\n  ")
    for line in page.b.js("return [...document.querySelectorAll('[data-check]')].map(e => e.dataset.check)"):
        page.click(f"[data-check={line}]")
    for lesson in page.b.js("return [...document.querySelectorAll('[data-accept]')].map(e => e.dataset.accept)"):
        page.click(f"[data-accept={lesson}]")
    page.write("#accept-why", "another part of the body")
    page.take("approve")
    page.click("#approve")
    page.until("desk.cases[0].approval && desk.cases[0].approval.holds", "the approval")
    page.click("[data-tab=history]")
    page.until("document.querySelectorAll('#panel tr').length >= 5", "the history")
    page.take("history")
    page.b.js("location.hash = 'library'")
    page.until("document.documentElement.dataset.ready === 'library' && !!document.querySelector('.card')", "the library at last")
    page.take("approved")


def main():
    parser = argparse.ArgumentParser()
    for name in ("--zip", "--config", "--work", "--pictures"):
        parser.add_argument(name)
    given = parser.parse_args()
    check, begin = Checks(), time.monotonic()
    with contextlib.ExitStack() as stack:
        folder = pathlib.Path(given.work or stack.enter_context(tempfile.TemporaryDirectory()))
        pictures = pathlib.Path(given.pictures).resolve() if given.pictures else None
        root, library = make_root(folder, given.zip, given.config), folder / "library"
        library.mkdir()
        with Desk(root, library) as desk:
            with Browser("--enable-unsafe-swiftshader", "--lang=en", width=1500, height=940) as browser:
                browser.open(desk.url)
                page = Walk(browser, check, pictures)
                bring(page)
                page.click(".card")
                page.opened()
                if pictures:
                    time.sleep(20)  # for the surfaces, where a processor draws them
                browser.call("/execute/async", {"script": "const done = arguments[0]; goToField(desk.page, 'ventricles').then(done, done)", "args": []})
                page.slices()
                page.take("look")
                move_landmark(page)
                place_hole(page)
                paint_horn(page)
                grow_snake(page)
                preview(page)
                rerun_and_approve(page, library)
                no_console_errors(browser, check)
                if pictures:
                    browser.open("about:blank")
                    for picture in sorted(pictures.glob("desk_*.png")):
                        shrink(browser, picture)
            manifest = json.loads((library / "head-01/case.json").read_text())
            recorded = manifest["provenance"]["parameters"]
            check(recorded["ventricles.correct.added_ml"] > 0, "the horn is in the case")
            check(len(manifest["burr_holes"]) == 1 and "at: position" in (root / "configs/head-01.yaml").read_text(), "so is the hole, by hand")
            check(json.loads((library / "head-01/approved.json").read_text())["by"] == "anna-2", "and it is approved")
            print((root / "configs/head-01.yaml").read_text())
            run("library", "build", root / "configs/LIBRARY.yaml", "--out", folder / "again", "--quiet", "--no-pictures")
            check(digest(folder / "again/head-01") == digest(library / "head-01"), "the written configuration makes the same bytes in an empty folder")
            check(desk.end() == 0, "Ctrl-C ends the desk")
    cpu = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{time.monotonic() - begin:.0f} s, {cpu.ru_utime + cpu.ru_stime:.0f} CPU s")
    check.end()


if __name__ == "__main__":
    main()
