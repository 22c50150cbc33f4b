# SPDX-License-Identifier: GPL-3.0-or-later
"""desk_hand.py: what a technician does by hand at the desk, in chromium with real clicks: a build stopped and gone on with, another scene,
which cuts burr holes, a burr hole placed, checked and taken back, the brush as a ball, in a range of HU, filled, grown, rubbed out and carried between slices, patches
switched, a threshold previewed, the rebuild drawn over what it was, lessons that the case cannot serve, a ZIP and a folder brought in.
What was written makes the same bytes in an empty folder. TREPHINE is the program."""
import json
import math
import pathlib
import re
import tempfile
import time
import zipfile

from desk import SOURCE, Desk, Page, digest, make_root, no_console_errors, run
from webdriver import Browser, Checks

SCENE = """trephine: 1
anatomies:
  skull: {max_triangles: 40000, max_deviation_mm: 2.5}
burr_holes:
  skull: {}
face: {policy: keep, reason: only bone is shown; cases stay where the scans are kept}
"""
PLAIN = SCENE.replace("burr_holes:\n  skull: {}\n", "")
ROUGH = "skin.segment.fill: none, skin.segment.coarse_mm: 1.5, resample.spacing_mm: [2.5, 2.5, 2.5]"
# What the page has painted and not saved, as the desk keeps it: for each slice, how many voxels and their least and greatest HU.
PAINTED = """
const page = desk.page, bytes = new Uint8Array(await askBytes('draft', { case: page.token, what: 'paint' }))
if (bytes.length < 88) return { count: 0, slices: {} }
const box = new Int32Array(bytes.slice(64, 88).buffer), [x, y, z, nx, ny, nz] = box, out = { count: 0, slices: {}, low: 1e9, high: -1e9 }
for (let k = 0, n = 88; k < nz; ++k) {
  const hu = await page.volume.slice(2, z + k)
  for (let j = 0; j < ny; ++j) for (let i = 0; i < nx; ++i, ++n) if (bytes[n]) {
    const v = hu[(y + j) * page.volume.size[0] + x + i]
    ++out.count, out.slices[z + k] = (out.slices[z + k] || 0) + 1
    out.low = Math.min(out.low, v), out.high = Math.max(out.high, v)
  }
}
return out"""


class Hand(Page):
    def painted(self, at_least=0):
        """Once the draft that is kept is what is on the page."""
        for _ in range(600):
            got = self.b.call("/execute/async", {"script": f"const done = arguments[arguments.length - 1]; (async () => {{ {PAINTED} }})().then(done, e => done({{ fault: String(e) }}))", "args": []})
            if "fault" in got:
                raise RuntimeError(got["fault"])
            if got["count"] == sum(self.b.js("return desk.stats.painted || [0, 0]")) and got["count"] >= at_least:
                return got
        raise RuntimeError(f"the draft never was what is painted: {got}")

    def point(self, plane, at, button=0):
        x, y = self.place(plane, at)
        self.b.click(x, y)

    def go(self, at):
        self.b.js("desk.page.go(arguments[0])", at)
        self.until("desk.page.volume.planes.every(p => p.shown === desk.page.at[p.n])", "the slices")

    def choose_file(self, selector, *paths):
        element = self.b.call("/element", {"using": "css selector", "value": selector})
        self.b.call(f"/element/{next(iter(element.values()))}/value", {"text": "\n".join(map(str, paths))})


def build(page, check, library):
    page.click("#build")
    page.until("desk.page.building", "a build that runs")
    page.click("#stop")
    page.until("!desk.page.building && desk.page.ended !== null", "the end of the stopped build")
    check(page.b.js("return desk.page.ended") == 130, f"it was stopped: {page.b.js('return desk.page.ended')}")
    check("The next build goes on where it was." in page.b.js("return document.getElementById('log').textContent"), "and says so in words")
    if (library / "head-01").exists():  # it was published before the stop came, and then it is whole
        run("library", "verify", library, "--quiet")
    check((library / "head-01").exists() == (library / "head-01/case.json").exists(), "nothing half made lies there")
    page.click("#build")
    page.until("desk.page.building", "the next build")
    page.b.js("problem('what a person was told')")
    time.sleep(1.5)  # in which the page asks several times how far the build is
    told = page.b.js("return document.getElementById('problem').hidden ? '' : document.getElementById('problem-text').textContent")
    check(told == "what a person was told", "a page that asks how far the build is takes away nothing that was told")
    page.b.js("problem('')")
    page.until("document.querySelector('.card .tag.good') && desk.cases.length === 1 && !desk.page.building", "the case")
    check((library / "head-01/case.json").exists(), "the next build goes on")


def another_scene(page, check, own):
    """The scene cuts no holes: another one is chosen where that is said, and the case opens and has none yet."""
    browser = page.b
    page.click("[data-tab=place]")
    check("cuts no burr holes" in browser.js("return document.getElementById('panel').textContent"), "no hole can be placed, and the page says so")
    check(browser.js("return [...document.querySelectorAll('[data-scene] option')].every(o => o.value.endsWith('skull_plain.yaml') || /drilled/.test(o.value))"), "scenes that cut holes are offered")
    browser.js("const s = document.querySelector('[data-scene]'); s.value = 'scenes/skull_drilled.yaml'; s.dispatchEvent(new Event('change'))")
    page.click("[data-set-scene]")
    page.until("desk.page.info.journal.length === 1 && desk.page.info.now.cuts_holes", "the other scene")
    text = own.read_text()
    check("scene: scenes/skull_drilled.yaml" in text and "burr_holes: []" in text, f"as two lines: {text[-300:]}")
    check("has none yet" in browser.js("return document.getElementById('panel').textContent"), "that there is none yet is said")
    page.until("desk.page.fields.includes('skull') && !document.getElementById('busy').textContent", "the case opens with it")
    check(browser.js("return document.getElementById('problem').hidden"), "without a fault")


def holes(page, check, own):
    browser = page.b
    top = browser.js("return desk.page.volume.toIndex([-27, -39, 120])")
    deep = browser.js("return desk.page.volume.toIndex([-3, -12, 55])")
    page.go([round(v) for v in top])
    page.click("[data-tool=entry]")
    page.point("coronal", top)
    page.go([round(v) for v in deep])
    page.click("[data-tool=target]")
    page.point("coronal", deep)
    page.until("!!document.querySelector('canvas.cut') && +document.querySelector('canvas.cut').dataset.drawn > 0", "the plane of the trajectory")
    shown = browser.js("const c = document.querySelector('canvas.cut'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let n = 0; for (let i = 0; i < d.length; i += 4) n += d[i] > 200; return n")
    check(shown > 300, f"the plane of the trajectory shows bone: {shown}")
    page.until("!!document.querySelector('[data-skull=coronal_suture]')", "the distance to the coronal suture")
    rows = {name: browser.js(f"return document.querySelector('[data-skull={name}]').textContent") for name in ("coronal_suture", "midline_sagittal")}
    mm = {name: float(re.search(r"\d+\.\d", said)[0]) for name, said in rows.items()}
    # The entry lies at -27, -39, 120, to a voxel's half; all three landmarks in the plane of x = 0. The angle is that of the bregma's radius.
    centre, bregma = ((-93.2 + 89.4) / 2, (40.1 + 5.8) / 2), (-12.0, 126.0)
    out = math.atan2(bregma[1] - centre[1], bregma[0] - centre[0])
    before = -math.sin(out) * (-39 - bregma[0]) + math.cos(out) * (120 - bregma[1])
    check(abs(mm["coronal_suture"] - before) < 1.5 and "before" in rows["coronal_suture"], f"to the suture: {rows}, {before}")
    check(abs(mm["midline_sagittal"] - 27) < 1.5 and "right" in rows["midline_sagittal"], f"beside the midline: {rows}")
    page.click("#check-hole")
    page.until("!!document.querySelector('#hole-tried.good, #hole-tried.bad, #hole-tried.warn')", "what the run makes of the hole")
    said = browser.js("return document.getElementById('panel').textContent")
    check(browser.js("return !document.querySelector('#hole-tried.bad')") and "bone thickness mm" in said, f"the hole can be placed: {said[-400:]}")
    check("burr_holes: []" in own.read_text(), "checking writes nothing")
    length = browser.js("return document.getElementById('hole').textContent")
    page.click("#save-hole")
    page.until("desk.page.info.journal.length === 2", "the hole is saved")
    text = own.read_text()
    what = browser.js("return desk.page.info.journal[1].what")
    check(re.fullmatch(r"1 burr hole: -2\d\.\d, -\d\d\.\d, 1\d\d\.\d mm \(LPS\), 14 mm", what), f"the history tells it in words: {what}")
    check("burr_holes: [{at: position" in text and text.count("target_mm: [") == 1 and "direction" not in text, f"as a line: {text[-300:]}")
    check(browser.js("return desk.page.allMarks().some(m => m.name.includes('not built yet'))"), "it is drawn before the case is built again")
    page.click("#undo")
    page.until("desk.page.info.journal.length === 3", "undo")
    check("burr_holes: []" in own.read_text(), "undo takes it out of the line")
    page.click("#redo")
    page.until("desk.page.info.journal.length === 4", "redo")
    check(own.read_text() == text, "redo writes the same line")
    page.click("[data-change='0']")
    page.until(f"document.getElementById('hole').textContent === {json.dumps(length)}", "Change, which shows the target that was saved")
    page.write("#diameter", "11\ue007")
    page.click("#save-hole")
    page.until("desk.page.info.journal.length === 5", "the changed hole")
    check(own.read_text() == text.replace("diameter_mm: 14", "diameter_mm: 11"), "a hole is changed in its place")
    # one that no skull is under
    size = browser.js("return desk.page.volume.size")
    page.go([2, 2, size[2] - 2])
    page.click("#entry-here")
    page.go([size[0] - 3, 2, size[2] - 2])
    page.click("#target-here")
    page.click("#check-hole")
    page.until("!!document.querySelector('#hole-tried.good, #hole-tried.bad')", "what is wrong with it")
    check(browser.js("return !!document.querySelector('#hole-tried.bad')"), "a hole that meets no bone is told before it is saved")
    # saved all the same, it does not hide what is to be said of another one
    page.click("#save-hole")
    page.until("desk.page.info.journal.length === 6", "a hole that cannot be")
    page.go([round(v) for v in browser.js("return desk.page.volume.toIndex([30, -39, 116])")])
    page.click("#entry-here")
    page.go([round(v) for v in browser.js("return desk.page.volume.toIndex([3, -12, 55])")])
    page.click("#target-here")
    page.click("#check-hole")
    page.until("!!document.querySelector('#hole-tried.good, #hole-tried.bad, #hole-tried.warn')", "what is said of the third")
    check(browser.js("return !document.querySelector('#hole-tried.bad')"), "another hole's fault is not told of this one: " + browser.js("return document.getElementById('hole-tried').textContent"))
    # beside the first, nearer than both are wide
    page.go([round(v) for v in browser.js("return desk.page.volume.toIndex([-20, -39, 119])")])
    page.click("#entry-here")
    page.click("#check-hole")
    page.until("!!document.querySelector('#hole-tried.good, #hole-tried.bad, #hole-tried.warn')", "what is said of a hole that overlaps another")
    check("overlaps burr hole 1" in browser.js("return document.getElementById('hole-tried').textContent"), "told: " + browser.js("return document.getElementById('hole-tried').textContent"))
    page.click("#cancel-hole")
    page.click("[data-remove='1']")
    page.until("desk.page.info.journal.length === 7", "the hole that cannot be is removed")


def brush(page, check, own):
    browser = page.b
    spacing = browser.js("return desk.page.volume.spacing")
    mm3 = spacing[0] * spacing[1] * spacing[2]
    page.click("[data-tab=paint]")
    browser.js("const s = document.getElementById('anatomy'); s.value = 'skull'; s.dispatchEvent(new Event('change'))")
    browser.js("document.getElementById('anatomy').focus()")
    browser.key("b")
    own_range = browser.js("return ['low', 'high'].map(id => +document.getElementById(id).value)")
    said = browser.js("return desk.page.info.now.values.filter(v => v.path.startsWith('skull.') && v.path.endsWith('.lower_hu')).map(v => +v.value).pop()")
    check(own_range[0] == said and own_range[1] > 1000, f"the range of HU is the skull's own: {own_range}, {said}")
    check(browser.js("return desk.page.tool + ' ' + document.getElementById('anatomy').value") == "add skull", "a tool's key in the list of anatomies is the tool's")
    middle = [round(v) for v in browser.js("return desk.page.volume.toIndex([0, 0, 60])")]
    page.go(middle)
    page.write("#radius", "9\ue007")
    page.click("#ball")
    page.click("[data-tool=add]")
    page.point("axial", middle)
    ball = page.painted(1)
    check(abs(ball["count"] * mm3 / (4 / 3 * math.pi * 9 ** 3) - 1) < 0.25 and len(ball["slices"]) >= 3, f"a ball: {ball['count']} voxels in {len(ball['slices'])} slices")
    page.click("#undo")
    check(page.painted()["count"] == 0, "undo of the ball")
    # a ball at the skull, in its range of HU alone
    bone = [round(v) for v in browser.js("return desk.page.volume.toIndex([-68, 0, 60])")]
    page.click("#within")
    page.go(bone)
    page.point("axial", bone)
    ranged = page.painted(1)
    check(ranged["low"] >= 226 and 0 < ranged["count"] < 0.9 * ball["count"] and len(ranged["slices"]) >= 3, f"a ball in a range of HU: {ranged}")
    page.click("[data-tool=erase]")
    page.point("axial", bone)
    check(page.painted()["count"] < ranged["count"], "rubbed out")
    page.click("#undo")
    page.click("#throw")
    check(page.painted()["count"] == 0, "thrown away")
    page.click("#undo")
    back = page.painted(1)["count"]
    check(back == ranged["count"], f"and undo brings it back: {back} of {ranged['count']}")
    page.click("#throw")
    page.click("[data-tool=grow]")
    seed = browser.js("""const v = desk.page.volume, at = arguments[0], hu = v.has(2, at[2])
        for (let i = 0; i < v.size[0] / 2; ++i) if (hu[at[1] * v.size[0] + i] > 700) return [i, at[1], at[2]]""", bone)
    page.point("axial", seed)
    grown = page.painted(1)
    check(grown["low"] >= 226 and len(grown["slices"]) >= 3, f"grown within the ball and the range: {grown}")
    page.click("#throw")
    page.click("#within")
    # a frame by four strokes, filled
    page.click("#ball")
    page.write("#radius", "1\ue007")
    page.go(middle)
    page.click("[data-tool=add]")
    a, b = 6, 5
    corners = [[middle[0] + x, middle[1] + y, middle[2]] for x, y in ((-a, -b), (a, -b), (a, b), (-a, b), (-a, -b))]
    for p, q in zip(corners, corners[1:]):
        browser.drag(*page.place("axial", p), *page.place("axial", q))
    frame = page.painted(30)["count"]
    page.click("[data-tool=fill]")
    page.point("axial", middle)
    filled = page.painted(frame + 1)
    check(filled["count"] >= (2 * a + 1) * (2 * b + 1), f"filled: {frame} and then {filled['count']}")
    page.point("axial", [middle[0] + 20, middle[1], middle[2]])
    page_problem = "document.getElementById('problem').hidden ? '' : document.getElementById('problem-text').textContent"
    for _ in range(600):
        if browser.js("return " + page_problem):
            break
    check("reaches the edge" in browser.js("return " + page_problem) and page.painted()["count"] == filled["count"], "what has no border is not filled")
    page.click("#problem-close")
    # the same shape five slices on, and between them
    page.go([middle[0], middle[1], middle[2] + 5])
    page.click("[data-tool=add]")
    page.write("#radius", "6\ue007")
    page.point("axial", [middle[0] + 2, middle[1], middle[2] + 5])
    two = page.painted(filled["count"] + 1)
    check(len(two["slices"]) == 2, f"two painted slices: {two['slices']}")
    page.click("#between")
    all_of = page.painted(two["count"] + 1)
    least = min(two["slices"].values())
    check(sorted(map(int, all_of["slices"])) == list(range(middle[2], middle[2] + 6)) and min(all_of["slices"].values()) >= 0.7 * least, f"the slices between are filled: {all_of['slices']}")
    page.click("#undo")
    check(page.painted()["count"] == two["count"], "and undone in one step")
    page.click("#redo")
    page.write("#why", "a bridge")
    page.click("#save-patch")
    page.until("desk.page.info.journal.length === 8 && desk.stats.painted[0] === 0", "the patch")
    union = own.parent / "head-01.desk/skull.nrrd"
    one = union.read_bytes()
    page.point("axial", [middle[0] - 12, middle[1], middle[2] + 5])
    page.painted(1)
    page.click("#save-patch")
    page.until("desk.page.info.journal.length === 9", "a second patch")
    page.until("desk.page.fields.includes('skull') && !document.getElementById('busy').textContent", "the outlines with both patches")
    # A hole that is saved meanwhile leaves the surface fewer triangles, and its field as it is.
    text = own.read_text()
    page.click("[data-tool=cross]")
    page.click("[data-tab=place]")
    page.click("[data-change='0']")
    page.write("#diameter", "12\ue007")
    page.click("#save-hole")
    page.until("desk.page.info.journal.length === 10", "a wider hole")
    page.click("#undo")
    page.until("desk.page.info.journal.length === 11", "and back")
    check(own.read_text() == text, "undo of it")
    page.click("[data-remove='0']")
    page.until("desk.page.info.journal.length === 12", "no hole")
    page.click("[data-tab=paint]")
    page.click("[data-tool=add]")
    page.go([middle[0], middle[1], middle[2] + 5])
    page.until("desk.page.volume.has(2, desk.page.at[2]) && desk.page.volume.outline('skull', 2, desk.page.at[2]).length > 100", "the skull's outline")
    page.point("axial", [middle[0] - 12, middle[1], middle[2] + 5])
    page.painted(1)
    page.click("#save-patch")
    page.until("!document.getElementById('problem').hidden", "what is said of a patch that changes nothing")
    check("is so already" in browser.js("return document.getElementById('problem-text').textContent"), "painted twice, it is told: " + browser.js("return document.getElementById('problem-text').textContent"))
    page.click("#problem-close")
    page.click("#throw")
    both = union.read_bytes()
    page.click("[data-tool=cross]")
    page.click("[data-tab=place]")
    page.click("#undo")
    page.until("desk.page.info.journal.length === 13 && desk.page.info.now.said_holes.length === 1", "the hole again")
    page.click("[data-tab=paint]")
    check(both != one and "corrections: {skull: head-01.desk/skull.nrrd}" in own.read_text(), "both count")
    page.click("[data-patch='9']")
    page.until("desk.page.info.journal.length === 14", "the second is switched off")
    check(union.read_bytes() == one, "switched off, it has no effect")
    page.click("[data-patch='8']")
    page.until("desk.page.info.journal.length === 15", "the first too")
    check("corrections" not in own.read_text(), "none counts: no line")
    page.click("[data-patch='8']")
    page.until("desk.page.info.journal.length === 16", "on again")
    check(union.read_bytes() == one and "corrections: {skull: head-01.desk/skull.nrrd}" in own.read_text(), "on again, it is what it was")


def browser_ml(page):
    return page.b.js("return [...document.querySelectorAll('#tried tr')].map(r => r.textContent.match(/volume .* ml(\\d+\\.?\\d*)$/)).filter(m => m).map(m => m[1])")


def preview(page, check, own):
    before = own.read_text()
    page.click("[data-tab=values]")
    page.write("#find-value", "skull.segment.lower_hu")
    page.until("document.querySelectorAll('[data-value]').length === 1", "one parameter")
    page.write("[data-value]", "600")
    page.until("desk.stats.tried >= 1 && !!document.querySelector('#tried .good')", "the preview while one types")
    page.until("desk.page.volume.has(2, desk.page.at[2]) && desk.page.volume.outline('~tried', 2, desk.page.at[2]).length > 100", "its outline")
    sizes = page.b.js("const v = desk.page.volume, k = desk.page.at[2]; return [v.outline('~tried', 2, k), v.outline('skull', 2, k)].map(l => { let s = 0; for (let i = 0; i < l.length; i += 4) s += Math.hypot(l[i] - l[i + 2], l[i + 1] - l[i + 3]); return s })")
    check(sizes[0] > 20 and sizes[0] != sizes[1], f"it is another outline: {sizes}")
    check(own.read_text() == before, "a preview writes nothing")
    ml = [float(v) for v in browser_ml(page)]
    check(len(ml) == 2 and ml[0] > ml[1] > 10, f"it tells the volume before and after: {ml}")
    page.click("#no-preview")
    page.write("[data-value]", "-5e9")
    page.until("!!document.querySelector('#tried .bad') || !document.getElementById('problem').hidden || null", "a value that cannot be")
    check(own.read_text() == before, "nor does one that cannot be")


def links(page, check):
    """A finding that is sure is acknowledged by itself, and warnings lead to their places and tools; the sample has none, so they are given to the page."""
    browser = page.b
    browser.js("""const { built, warnings } = desk.page.info
        built.findings.push({ text: 'the vault has a gap of 5.1 cm2', confidence: .9, position_mm: [0, 0, 60] }, { text: 'perhaps a sinus', confidence: .3, position_mm: [0, 0, 0] })
        warnings.push('to be looked at: the vault has a gap of 5.1 cm2, right (skull may be wrong because of it)', "inion is doubtful (confidence 0.40); look at it, or give it in the case's configuration: landmarks: {inion: [x, y, z]}, mm, LPS")
        desk.page.show_('approve')""")
    listed = browser.js("return [...document.querySelectorAll('[data-check]')].map(e => e.dataset.check)")
    check("finding_1" in listed and "finding_2" not in listed, f"the sure finding has a line of its own: {listed}")
    for line in listed:
        check(browser.js("return document.getElementById('approve').disabled"), f"no approval before {line}")
        page.click(f"[data-check={line}]")
    page.until("!!document.querySelector('[data-lesson]')", "what the simulator says of lessons", seconds=300)
    for lesson in browser.js("return [...document.querySelectorAll('[data-accept]')].map(e => e.dataset.accept)"):
        page.click(f"[data-accept={lesson}]")
    page.write("#accept-why", "another part of the body")
    check(browser.js("return !document.getElementById('approve').disabled"), "all ticked, and what it cannot serve accepted")
    warn = "[...document.querySelectorAll('#panel p.warn')].find(p => p.textContent.includes(arguments[0]))"
    browser.js("desk.page.go([0, 0, 0])")
    browser.js(f"{warn}.querySelector('a').click()", "gap of 5.1")
    page.until("String(desk.page.at) === String(desk.page.volume.toIndex([0, 0, 60]).map(Math.round))", "the finding's place")
    check("landmarks:" not in browser.js(f"return {warn}.textContent", "inion is doubtful"), "no line of YAML where there is a tool")
    browser.js(f"[...{warn}.querySelectorAll('a')].pop().click()", "inion is doubtful")
    page.until("desk.page.tab === 'place' && desk.page.tool === 'landmark' && !!document.querySelector('tr.chosen[data-landmark=inion]')", "the tool for it")
    # A refusal leads to what it names.
    browser.js("document.body.append(Object.assign(refusalLine(desk.page, '80: burr_hole_1: removes nothing (skull.segment); move it, or lower `lower_hu` of its `segment`'), { id: 'refused' }))")
    go = "[...document.querySelectorAll('#refused a')].find(a => a.textContent.includes(arguments[0])).click()"
    browser.js(go, "Change the hole")
    page.until("desk.page.tab === 'place' && !!document.querySelector('[data-change]')", "the holes, from a refusal")
    browser.js(go, "lower_hu")
    page.until("desk.page.tab === 'values' && [...document.querySelectorAll('[data-value]')].map(e => e.dataset.value).join() === 'skull.segment.lower_hu'", "the value that a refusal names")
    browser.js("document.getElementById('refused').remove()")
    # A landmark on the side of its pair is saved, and told.
    page.click("[data-tab=place]")
    page.click("tr[data-landmark=tragus_left]")
    browser.js("desk.page.goWorld([-80, 0, 0])")
    page.click("#here")
    page.until("document.getElementById('problem-text').textContent.includes('lies on the other side of tragus right')", "a landmark on the wrong side")
    page.click("[data-tool=cross]")
    page.click("#undo")
    page.until("desk.page.info.now.landmarks.tragus_left[0] === 77", "the landmark where it was")


def finished(page, check):
    """What was built is shown with its hole; the field that it was made of has none."""
    browser = page.b
    browser.js("desk.page.goWorld(desk.page.info.built.holes[0].position_mm)")
    # The length of line (mm) within 4 mm of the hole's middle on the axial slice.
    near = """const v = desk.page.volume, p = v.planes.find(p => p.id === 'axial'), at = v.toIndex(desk.page.info.built.holes[0].position_mm), line = %s
      if (line.then) return -1
      const [lo, hi] = p.u < p.v ? [p.u, p.v] : [p.v, p.u]
      let mm = 0
      for (let i = 0; i < line.length; i += 4) {
        const a = [(line[i] - at[lo]) * v.spacing[lo], (line[i + 1] - at[hi]) * v.spacing[hi]], b = [(line[i + 2] - at[lo]) * v.spacing[lo], (line[i + 3] - at[hi]) * v.spacing[hi]]
        if (Math.hypot(a[0], a[1]) < 4 && Math.hypot(b[0], b[1]) < 4) mm += Math.hypot(a[0] - b[0], a[1] - b[1])
      }
      return mm"""
    lines = {"field": near % "v.outline('skull', p.n, desk.page.at[p.n])", "built": near % "v.cut('built', 'skull', p.n, desk.page.at[p.n])"}
    page.click("[data-tab=look]")
    page.click("#as-built")
    found = {}
    for name, line in lines.items():
        page.until(f"(() => {{ {line} }})() >= 0", f"the line of the {name}")
        found[name] = browser.js(line)
    check(found["field"] > 3 and found["built"] < 0.5, f"the finished skull is open at its hole, the field is not: {found}")
    page.click("#as-built")


def main():
    check = Checks()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        root, library = make_root(folder, ("skull_plain", ROUGH)), folder / "library"
        (root / "configs/scenes/skull_drilled.yaml").write_text(SCENE)
        (root / "configs/scenes/skull_plain.yaml").write_text(PLAIN)
        coarse = root / "configs/coarse.yaml"
        coarse.write_text(coarse.read_text().replace("  inion:", "  bregma: [0, -12.0, 126.0]\n  inion:"))
        own = root / "configs/head-01.yaml"
        with Desk(root, library) as desk:
            with Browser("--enable-unsafe-swiftshader", "--lang=en", width=1600, height=1000) as browser:
                browser.open(desk.url)
                page = Hand(browser, check)
                page.until("document.documentElement.dataset.ready === 'library' && !!document.querySelector('.card')", "the library's page")
                page.write("#who", "anna-2")
                build(page, check, library)
                page.click(".card")
                page.until("desk.page && desk.page.volume && desk.page.fields.includes('skull') && !document.getElementById('busy').textContent && document.documentElement.dataset.ready === 'case'", "the opened case")
                another_scene(page, check, own)
                holes(page, check, own)
                brush(page, check, own)
                preview(page, check, own)
                browser.js("problem('')")

                page.click("[data-tab=build]")
                page.click("#rerun")
                page.until("desk.stats.rebuilt >= 1 && desk.page.info.reasons.length === 0", "the rebuild")
                page.click("#compare")
                page.until("!!document.getElementById('changes')", "the comparison")
                page.until("!!document.querySelector('[data-drawn=skull]') && document.querySelector('[data-drawn=skull]').checked", "the skull is drawn as it was and is")
                page.until("['was', 'is'].every(w => desk.page.volume.cut(w, 'skull', 2, desk.page.at[2]).length > 100)", "both lines on the slice")
                manifest = json.loads((library / "head-01/case.json").read_text())
                check([h["diameter_mm"] for h in manifest["burr_holes"]] == [11], "the case has the hole")
                finished(page, check)
                page.click("[data-tab=approve]")
                page.until("!!document.querySelector('[data-lesson=ventriculostomy]')", "what the simulator says of lessons")
                check("cannot serve" in browser.js("return document.querySelector('[data-lesson=ventriculostomy]').textContent"), "a skull alone serves no ventriculostomy, and that is said before approval")
                links(page, check)
                made = digest(library / "head-01")

                # a ZIP, and a folder, from this computer
                packed = folder / "Name of a patient.zip"
                with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as z:
                    for f in sorted((SOURCE / "sample_dicom").iterdir()):
                        z.write(f, f.name)
                browser.js("location.hash = 'new'")
                page.until("!!document.getElementById('pick-zip')", "the page of a new case")
                page.choose_file("#pick-zip", packed)
                page.until("!!document.querySelector('.thumb') && document.querySelector('.thumb').naturalWidth > 100", "the series of the ZIP with its middle slices")
                lying = [f.name for f in (root / "configs/dropped").iterdir()]
                check(len(lying) == 1 and lying[0].endswith(".zip") and "patient" not in lying[0] and (root / "configs/dropped" / lying[0]).read_bytes() == packed.read_bytes(), f"it lies under a name of its content: {lying}")
                words = browser.js("return document.querySelector('#recipe option[value=\"coarse.yaml\"]').textContent")
                names = browser.js("return [...document.getElementById('recipe').options].map(o => o.value)")
                check(words == "The sample phantom, coarse (coarse.yaml)" and "ct_head.yaml" in names and "sample.yaml" not in names, f"a recipe in words; one that names its series is a case, not a recipe: {words}, {names}")
                page.write("#token", "head-02")
                listed = (root / "configs/LIBRARY.yaml").read_text()
                browser.js("document.getElementById('recipe').value = 'head_ct_mr.yaml'")
                page.click("#create")
                page.until("document.getElementById('problem-text').textContent.includes('it needs a further scan')", "a recipe that cannot be used")
                check((root / "configs/LIBRARY.yaml").read_text() == listed, "and LIBRARY.yaml is as it was")
                browser.js("document.getElementById('recipe').value = 'coarse.yaml'")
                page.click("#create")
                page.until("document.documentElement.dataset.ready === 'library' && document.querySelectorAll('.card').length === 2", "the new case's card")
                check(f"series: dropped/{lying[0]}" in (root / "configs/LIBRARY.yaml").read_text(), "LIBRARY.yaml names it")
                browser.js("location.hash = 'new'")
                page.until("!!document.getElementById('pick-folder')", "the page of a new case again")
                page.choose_file("#pick-folder", root / "sample_dicom")
                page.until("!!document.querySelector('.thumb') && document.querySelector('.thumb').naturalWidth > 100", "the series of the folder")
                check(len([f for f in (root / "configs/dropped").iterdir() if f.is_dir()]) == 1, "a folder is there too")
                no_console_errors(browser, check)
            run("library", "build", root / "configs/LIBRARY.yaml", "--out", folder / "again", "--case", "head-01", "--quiet", "--no-pictures")
            check(digest(folder / "again/head-01") == made, "the written configuration makes the same bytes")
            check(desk.end() == 0, "Ctrl-C ends the desk")
    check.end()


if __name__ == "__main__":
    main()
