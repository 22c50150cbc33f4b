# SPDX-License-Identifier: GPL-3.0-or-later
"""page.py MODE: a case's page in chromium, as its user meets it. MODE is webgl2, processor (asked for by the address) or
no-3d (a browser that has no 3D at all). TREPHINE and PAGE_SAMPLES are the programs."""
import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import time

from webdriver import Browser, Checks

MODES = {"webgl2": ["--enable-unsafe-swiftshader"], "processor": ["--enable-unsafe-swiftshader"], "no-3d": ["--disable-3d-apis"]}
PIXELS = """const c = document.getElementById(arguments[0]), t = document.createElement('canvas'); t.width = t.height = 240
if (arguments[0] === 'solid') trephine.render(); else trephine.slices()
const x = t.getContext('2d', {willReadFrequently: true}); x.drawImage(c, 0, 0, 240, 240); return [...x.getImageData(0, 0, 240, 240).data]"""


def wait(browser):
    for _ in range(6000):
        if browser.js("return document.documentElement.dataset.ready === '1' || !document.getElementById('problem').hidden"):
            return
        time.sleep(0.1)
    raise RuntimeError("the page never became ready")


def settle(browser):
    browser.call("/execute/async", {"script": "requestAnimationFrame(() => requestAnimationFrame(arguments[0]))", "args": []})


def differ(a, b):
    return sum(abs(a[i] - b[i]) + abs(a[i + 1] - b[i + 1]) + abs(a[i + 2] - b[i + 2]) > 24 for i in range(0, len(a), 4))


def read_glb(file, center):
    """Points (LPS mm) and triangles of a GLB of ours."""
    data = file.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    doc, body = json.loads(data[20:20 + length]), data[28 + length:]
    def values(accessor, code, size, n):
        a = doc["accessors"][accessor]
        view = doc["bufferViews"][a["bufferView"]]
        at = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        return struct.unpack_from(f"<{a['count'] * n}{code}", body, at)
    primitive = doc["meshes"][0]["primitives"][0]
    index = doc["accessors"][primitive["indices"]]
    flat = values(primitive["attributes"]["POSITION"], "f", 4, 3)
    corners = values(primitive["indices"], "H" if index["componentType"] == 5123 else "I", 0, 1)
    points = [tuple(flat[i + k] + center[k] for k in range(3)) for i in range(0, len(flat), 3)]
    return points, [corners[i:i + 3] for i in range(0, len(corners), 3)]


def cut(points, triangles, axis, mm):
    """The ends of the exact cut's segments, in the two other coordinates."""
    u, v = [k for k in range(3) if k != axis]
    ends = []
    for t in triangles:
        for i in range(3):
            p, q = points[t[i]], points[t[(i + 1) % 3]]
            if (p[axis] > mm) != (q[axis] > mm):
                f = (mm - p[axis]) / (q[axis] - p[axis])
                ends.append((p[u] + f * (q[u] - p[u]), p[v] + f * (q[v] - p[v])))
    return ends


def farthest(a, b):
    """How far a point of a lies from b at most."""
    grid = {}
    for p in b:
        grid.setdefault((math.floor(p[0]), math.floor(p[1])), []).append(p)
    worst = 0
    for p in a:
        near = [math.dist(p, q) for i in (-1, 0, 1) for j in (-1, 0, 1) for q in grid.get((math.floor(p[0]) + i, math.floor(p[1]) + j), [])]
        worst = max(worst, min(near, default=9))
    return worst


# Rays of the page cast again one by one: how far their colours are off, of 255, where either sees anything.
REFERENCE = """
const v = trephine.viewer, { functions, shift, of, shape } = v.cast, { voxels, shares, size, spacing, origin } = trephine.page[of], hu = v.hu
const canvas = document.getElementById('solid'), w = canvas.width, h = canvas.height
trephine.render()
const flat = document.createElement('canvas'); flat.width = w; flat.height = h
const g = flat.getContext('2d', { willReadFrequently: true }); g.drawImage(canvas, 0, 0)
const ground = document.documentElement.classList.contains('light') ? [0.95, 0.96, 0.97] : [0.1, 0.11, 0.13]
const clampTo = (x, n) => Math.max(0, Math.min(n - 1, x))
// The sum of f(voxel) over the eight around a place, by weight.
const trilinear = (p, f) => {
  const b = p.map(Math.floor), t = p.map((x, a) => x - b[a])
  let sum = 0
  for (let n = 0; n < 8; ++n) {
    const o = [n & 1, (n >> 1) & 1, n >> 2], [i, j, k] = b.map((x, a) => clampTo(x + o[a], size[a]))
    sum += o.reduce((s, x, a) => s * (x ? t[a] : 1 - t[a]), 1) * f(i + size[0] * (j + size[1] * k))
  }
  return sum
}
const shapes = trephine.data.felt ? trephine.data.felt.shapes : [], share = (at, n) =>
  (voxels[at] === n ? shares[at] : shares[voxels.length + at] === n ? 255 - shares[at] : 0) * 1000 / 255
let one = 0 // the shape that entryAt found
const huAt = p => trilinear(p, of === 'ct' ? at => hu[voxels[at]] : at => share(at, one))
const entry = x => {
  const points = functions[0]
  x = Math.max(-1024, Math.min(3071, x)) - shift
  if (x <= points[0][0]) return points[0].slice(1)
  for (let n = 1; n < points.length; ++n)
    if (x < points[n][0]) {
      const f = (x - points[n - 1][0]) / (points[n][0] - points[n - 1][0])
      return [1, 2, 3, 4].map(k => points[n - 1][k] + f * (points[n][k] - points[n - 1][k]))
    }
  return points[points.length - 1].slice(1)
}
const entryAt = p => {
  if (of === 'ct') return entry(huAt(p))
  const found = shapes.find(s => { one = s.number; return huAt(p) >= 500 })
  return found && (!shape || shape === found.number) ? [1, ...found.colour_rgb] : [0, 0, 0, 0]
}
const off = [], s0 = 0.5 * Math.min(...spacing)
for (let n = 0; n < arguments[0]; ++n) {
  const x = Math.floor(((n * 0.754877666) % 1) * w), y = Math.floor(((n * 0.569840291) % 1) * h)
  const { eye, d } = trephine.cam.ray(x + 0.5, y + 0.5, w, h), f = trephine.cam.basis().forward
  const along = d[0] * f[0] + d[1] * f[1] + d[2] * f[2], [near, far] = trephine.cam.reach()
  let begin = near / along, end = far / along, light = 1, sum = [0, 0, 0]
  const from = eye.map((e, a) => (e - origin[a]) / spacing[a]), step = d.map((e, a) => e / spacing[a])
  for (let a = 0; a < 3; ++a) {
    const p = (-0.5 - from[a]) / step[a], q = (size[a] - 0.5 - from[a]) / step[a]
    begin = Math.max(begin, Math.min(p, q)); end = Math.min(end, Math.max(p, q))
  }
  if (trephine.clip.axis >= 0) {
    const a = trephine.clip.axis, t = (trephine.clip.mm - eye[a]) / d[a]
    if (trephine.clip.keep * d[a] > 0) begin = Math.max(begin, t); else end = Math.min(end, t)
  }
  for (let k = Math.floor(begin / s0); k * s0 < end && light > 0.005; ++k) {
    const low = Math.max(begin, k * s0), high = Math.min(end, (k + 1) * s0)
    if (high <= low) continue
    const p = from.map((e, a) => e + step[a] * 0.5 * (low + high)), [opacity, ...rgb] = entryAt(p)
    if (opacity <= 0) continue
    const grad = [0, 1, 2].map(a => { const e = [0, 0, 0]; e[a] = 1
      return (huAt(p.map((x, k) => x + e[k])) - huAt(p.map((x, k) => x - e[k]))) / (2 * spacing[a]) })
    const steep = Math.hypot(...grad), lit = Math.min(1, steep / 50), c = Math.abs(grad[0] * d[0] + grad[1] * d[1] + grad[2] * d[2]) / Math.max(1e-6, steep)
    const alpha = 1 - Math.pow(Math.max(1e-6, 1 - opacity), high - low)
    sum = sum.map((x, k) => x + light * alpha * (rgb[k] * (0.7 + lit * (0.28 + 0.72 * c - 0.7)) + 0.12 * lit * c ** 24))
    light *= 1 - alpha
  }
  const shown = g.getImageData(x, y, 1, 1).data, covered = light < 0.98 || ground.some((e, k) => Math.abs(shown[k] - 255 * e) > 3)
  if (covered) off.push(Math.max(...sum.map((e, k) => Math.abs(Math.min(255, 255 * (e + light * ground[k])) - shown[k]))))
}
off.sort((a, b) => a - b)
return { covered: off.length, median: off[off.length >> 1], p95: off[Math.floor(off.length * 0.95)], most: off[off.length - 1] }
"""


class Page:
    def __init__(self, browser, check, case, mode):
        self.b, self.check, self.case, self.mode = browser, check, case, mode
        self.manifest = json.loads((case / "case.json").read_text())

    def pixels(self, canvas="solid"):
        return self.b.js(PIXELS, canvas)

    def cam(self):
        return self.b.js("const c = trephine.cam; return {az: c.az, el: c.el, dist: c.dist, pan: [...c.pan]}")

    def set(self, id, value):
        event = self.b.js("""const e = document.getElementById(arguments[0])
            if (e.type === 'checkbox' || e.tagName === 'BUTTON') { e.click(); return }
            e.value = arguments[1]; e.dispatchEvent(new Event('input')); e.dispatchEvent(new Event('change'))""", id, value)
        settle(self.b)
        return event

    def opens(self):
        url = self.case.joinpath("report/view.html").as_uri()
        self.b.open(url + ("#processor" if self.mode == "processor" else ""))
        wait(self.b)
        severe = [e["message"] for e in self.b.log("browser") if e["level"] == "SEVERE"]
        self.check(not severe, f"no error in the console: {severe}")
        asked = [json.loads(e["message"])["message"] for e in self.b.log("performance")]
        urls = {m["params"]["request"]["url"] for m in asked if m["method"] == "Network.requestWillBeSent"}
        self.check({u.split("#")[0] for u in urls} <= {url}, f"no request but itself: {urls}")
        self.check(self.b.js("return trephine.kind") == ("webgl2" if self.mode == "webgl2" else "processor"), "drawn by the right painter")
        self.check(self.b.js("return document.getElementById('problem').hidden"), "no problem is told")
        self.check(len(set(self.pixels()[::4])) > 40, "something is drawn")
        self.check(self.b.js("return document.documentElement.classList.contains('light') === matchMedia('(prefers-color-scheme: light)').matches"), "as light as the system")
        self.check(self.b.js("return document.getElementById('library').offsetParent === null"), "no link to a library that may not be there")

    def controls(self):
        changes = [("on-0", None, "a surface off"), ("on-0", None, "and on again"), ("opacity-0", "0.9", "opacity"), ("opacity-0", "0.2", "opacity back"),
                   ("colour-1", "#00ff00", "colour"), ("deviation-1", None, "deviation map"), ("scale", "0.05", "its scale"),
                   ("clip", "1", "cut-away"), ("flip", None, "its side"), ("clip-what", "outer", "what is cut away"), ("clip", "-1", "no cut-away"),
                   ("theme", None, "theme")]
        before = self.pixels()
        for id, value, what in changes:
            self.set(id, value)
            after = self.pixels()
            self.check(differ(before, after) > 60, f"3D changes with: {what}")
            before = after
        self.check(not self.b.js("return document.getElementById('bar').hidden"), "the colour bar is shown")
        self.set("theme", None), self.set("deviation-1", None)
        for button in ("a", "l", "s", "home"):
            before = self.pixels()
            self.b.js("document.querySelector(`#views button[data-view=${arguments[0]}]`).click()", button)
            settle(self.b)
            self.check(differ(before, self.pixels()) > 60, f"3D changes with the button {button}")
        for id, canvas, what in (("show-cuts", "axial", "cuts"), ("show-marks", "over", "landmarks"), ("show-felt", "coronal", "felt shapes"),
                                 ("window", "sagittal", "window")):
            if self.b.js("return document.getElementById(arguments[0]).disabled", id):
                continue
            before = self.pixels(canvas)
            self.set(id, "40,80")
            self.check(differ(before, self.pixels(canvas)) > 10, f"{canvas} changes with: {what}")
            self.set(id, "40,400")

    def camera(self):
        box = self.b.js("const r = document.getElementById('view').getBoundingClientRect(); return [r.x, r.y, r.width, r.height]")
        x, y = int(box[0] + box[2] / 2), int(box[1] + box[3] / 2)
        near = lambda a, b, size=1e-6: abs(a - b) <= size * max(1, abs(b))
        old = self.cam()
        self.b.drag(x, y, x + 100, y - 40)
        new = self.cam()
        self.check(near(new["az"], old["az"] - 0.8) and near(new["el"], old["el"] - 0.32), f"a drag turns: {old} {new}")
        mm = 2 * new["dist"] * math.tan(0.26) / min(box[2], box[3])
        self.b.drag(x, y, x + 60, y + 20, shift=True)
        moved = self.cam()
        self.check(near(moved["pan"][0], new["pan"][0] + 60 * mm, 1e-3) and near(moved["pan"][1], new["pan"][1] - 20 * mm, 1e-3), f"shift and drag moves: {moved}")
        self.b.wheel(x, y, 120)
        out = self.cam()
        self.check(near(out["dist"], moved["dist"] * math.exp(0.08)), f"the wheel zooms: {moved} {out}")
        self.b.pinch(x, y, 80, 160)
        pinched = self.cam()
        self.check(near(pinched["dist"], out["dist"] / 2, 0.02), f"a pinch zooms: {out} {pinched}")
        self.b.js("document.getElementById('view').focus()")
        sides = {"a": (0, 0), "p": (math.pi, 0), "l": (math.pi / 2, 0), "r": (-math.pi / 2, 0), "s": (0, 1.55), "i": (0, -1.55)}
        for key, (az, el) in sides.items():
            self.b.key(key)
            c = self.cam()
            self.check(near(c["az"], az) and near(c["el"], el), f"key {key}: {c}")
        self.b.key("a"), self.b.key("\ue012")
        self.check(near(self.cam()["az"], 0.1), "the arrow to the left turns")
        self.b.key("0")
        self.check(self.cam()["pan"] == [0, 0], "0 resets")
        shown = self.b.js("return trephine.meshes[1].visible")
        self.b.key("2")
        self.check(self.b.js("return trephine.meshes[1].visible") != shown, "a digit switches a surface")
        self.b.key("2")

    def looking(self):
        """A drag measures, a right drag zooms or sets the window, and what is doubtful does not look sure."""
        box = self.b.js("const r = document.getElementById('axial').getBoundingClientRect(); return [r.x, r.y, r.width, r.height]")
        x, y = int(box[0] + box[2] / 2), int(box[1] + box[3] / 2)
        at = self.at()
        per_mm = self.b.js("const p = trephine.planes.find(p => p.id === 'axial'); return p.place(1, 0)[0] - p.place(0, 0)[0]")
        self.set("measure", None)
        self.b.drag(x, y, x + 40, y - 30)
        settle(self.b)
        measures = self.b.js("return trephine.state.measures.map(m => [m.plane.id, m.mm, Math.hypot(m.to[0] - m.from[0], m.to[1] - m.from[1])])")
        self.check(len(measures) == 1 and measures[0][0] == "axial" and abs(measures[0][2] - 50 / per_mm) < 0.01, f"a drag measures {50 / per_mm} mm: {measures}")
        self.check(self.at() == at, "and does not scroll")
        drawn = self.pixels("axial")
        self.b.drag(x, y, x, y - 75, button=2)
        zoom = self.b.js("const p = trephine.planes.find(p => p.id === 'axial'); return [p.zoom, (p.place(1, 0)[0] - p.place(0, 0)[0])]")
        self.check(abs(zoom[0] - math.exp(0.5)) < 1e-6 and abs(zoom[1] / per_mm - zoom[0]) < 1e-3, f"a right drag zooms: {zoom}")
        if not self.b.js("return document.getElementById('level').disabled"):
            self.set("right-drag", "window")
            self.b.drag(x, y, x + 10, y - 20, button=2)
            self.check(self.b.js("return [+document.getElementById('level').value, +document.getElementById('width').value]") == [60, 420], "or sets the window")
            self.set("right-drag", "zoom"), self.set("window", "40,400")
        self.set("measure", None), self.set("clear", None)
        self.check(differ(drawn, self.pixels("axial")) > 10 and self.b.js("return trephine.state.measures.length + trephine.planes[2].zoom") == 1, "clear takes both back")
        if not self.b.js("return document.getElementById('show-felt').disabled"):
            self.set("show-felt", None), self.set("fill", "0.2")
            faint = self.pixels("coronal")
            self.set("fill", "1")
            self.check(differ(faint, self.pixels("coronal")) > 10, "the felt shapes are as opaque as they are told to be")
            self.set("show-felt", None)
        seen = self.b.js("return trephine.page.marks.map(m => [m.label, m.colour])")
        for l in self.manifest["landmarks"]:
            name = l["name"].replace("_", " ") + (" ?" if l["confidence"] < 0.5 else "")
            colour = [c for n, c in seen if n == name]
            self.check(colour and (colour[0] == "#9aa7b5") == (l["confidence"] < 0.5), f"the mark of {l}: {seen}")
        dist = self.cam()["dist"]
        box = self.b.js("const r = document.getElementById('view').getBoundingClientRect(); return [r.x, r.y, r.width, r.height]")
        x, y = int(box[0] + box[2] / 2), int(box[1] + box[3] / 2)
        self.b.drag(x, y, x, y - 30, button=2)
        self.check(self.cam()["dist"] < 0.9 * dist, "a right drag zooms the surfaces")
        self.b.js("document.querySelector('#views button[data-view=home]').click()")
        self.b.act({"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": [{"type": "pointerMove", "x": x, "y": y}]})
        self.b.key("p")
        self.check(abs(self.cam()["az"] - math.pi) < 1e-6, "keys go to what lies under the mouse, without a click")
        self.b.key("0")

    def at(self):
        return self.b.js("return trephine.at")

    def cross_hair(self):
        for l in self.manifest["landmarks"]:
            found = self.b.js("""const r = [...document.querySelectorAll('#landmarks tr.jump')].find(r => r.cells[0].title === arguments[0])
                if (!r) return false; r.click(); return true""", l["name"])
            self.check(found and self.at() == l["position_mm"], f"landmark {l['name']}: the cross-hair is on it")
        settle(self.b)
        for plane, (u, v) in {"axial": (0, 1), "coronal": (0, 2), "sagittal": (1, 2)}.items():
            r = self.b.js("const r = document.getElementById(arguments[0]).getBoundingClientRect(); return [r.x, r.y]", plane)
            want = list(self.manifest["center_mm"])
            want[u] += 17
            want[v] += 12
            # A click goes to a whole pixel; where that lies in mm, the page's own scale says.
            x, y = (round(c) for c in self.b.js("return trephine.planes.find(p => p.id === arguments[0]).place(arguments[1], arguments[2])", plane, want[u], want[v]))
            before, other = self.at(), self.pixels("coronal" if plane != "coronal" else "axial")
            self.b.click(int(r[0]) + x, int(r[1]) + y)
            settle(self.b)
            now = self.at()
            fixed = 3 - u - v
            self.check(abs(now[u] - want[u]) < 2 and abs(now[v] - want[v]) < 2 and now[fixed] == before[fixed], f"click in {plane}: {want} {now}")
            self.check(differ(other, self.pixels("coronal" if plane != "coronal" else "axial")) > 20, f"click in {plane} moves another slice")
            self.b.drag(int(r[0]) + x, int(r[1]) + y, int(r[0]) + x, int(r[1]) + y - 60)
            settle(self.b)
            scrolled = self.at()
            self.check(scrolled[fixed] > now[fixed] and scrolled[u] == now[u], f"drag in {plane} scrolls: {now} {scrolled}")
            self.b.wheel(int(r[0]) + x, int(r[1]) + y, 120)
            self.check(self.at()[fixed] < scrolled[fixed], f"the wheel in {plane} scrolls")

    def left_is_left(self):
        """The marker lies on the patient's left: on the right of axial and coronal slices and of the view from the front."""
        marker = next(i for i, a in enumerate(self.manifest["anatomies"]) if a["name"] == "marker")
        self.b.js("trephine.go(arguments[0]); trephine.meshes.forEach((m, i) => { m.visible = i === arguments[1]; m.opacity = 1 })",
                  [self.manifest["center_mm"][0] - 40, *self.manifest["center_mm"][1:]], marker)
        self.set("show-marks", None)
        self.b.key("a")
        settle(self.b)
        for canvas in ("axial", "coronal", "solid"):
            p = self.pixels(canvas)
            halves = [0, 0]
            for i in range(0, len(p), 4):
                if p[i + 1] > 90 and p[i + 1] > 1.6 * p[i] and p[i + 1] > 1.6 * p[i + 2]:
                    halves[(i // 4) % 240 >= 120] += 1
            self.check(halves[1] > 10 and halves[0] == 0, f"{canvas}: the marker is on the right: {halves}")
        box = self.b.js("const r = document.getElementById('view').getBoundingClientRect(); return [r.x, r.y, r.width, r.height]")
        c = [self.manifest["center_mm"][k] + (58 if k == 0 else 0) for k in range(3)]
        x, y = self.b.js("const c = trephine.cam; return c.project(c.matrix(arguments[0], arguments[1]), arguments[0], arguments[1], arguments[2])", box[2], box[3], c)
        self.b.click(int(box[0] + x), int(box[1] + y))
        self.check(7 < math.dist(self.at(), c) < 11, f"a click on the marker in 3D sets the cross-hair on it: {self.at()}")
        self.b.js("trephine.meshes.forEach(m => { m.visible = true })")
        self.set("show-marks", None)

    def cuts(self):
        for i, a in enumerate(self.manifest["anatomies"]):
            if "file" not in a:
                continue
            points, triangles = read_glb(self.case / a["file"], self.manifest["center_mm"])
            for axis in range(3):
                mm = self.manifest["center_mm"][axis] + (3.217 if a["name"] != "marker" or axis else 58.3)
                u, v = [k for k in range(3) if k != axis]
                flat = self.b.js("""const out = []; trephine.cutSurface(trephine.meshes[arguments[0]], arguments[1], arguments[2], arguments[3], arguments[4],
                    (a, b, c, d) => out.push(a, b, c, d)); return out""", i, axis, mm, u, v)
                page = list(zip(flat[::2], flat[1::2]))
                truth = cut(points, triangles, axis, mm)
                off = max(farthest(page, truth), farthest(truth, page)) if page and truth else 99
                self.check(off < 0.05, f"cut of {a['name']} along axis {axis}: {off} mm, {len(page)} ends")

    def deviation(self):
        a = self.manifest["anatomies"][1]
        points, _ = read_glb(self.case / a["file"], self.manifest["center_mm"])
        values = next((self.case / "report").glob("deviation-inner-*.f32")).read_bytes()
        deviation = struct.unpack(f"<{len(points)}f", values[-4 * len(points):])
        by_place = {tuple(round(c, 2) for c in p): d for p, d in zip(points, deviation)}
        flat, dev, level = self.b.js("const m = trephine.meshes[1]; return [[...m.pos], [...m.dev], trephine.data.anatomies[1].deviation_scale_mm / 127]")
        compared = unknown = 0
        for k in range(len(dev)):
            near = [d for dx in (-.01, 0, .01) for dy in (-.01, 0, .01) for dz in (-.01, 0, .01)
                    if (d := by_place.get((round(round(flat[3 * k], 2) + dx, 2), round(round(flat[3 * k + 1], 2) + dy, 2), round(round(flat[3 * k + 2], 2) + dz, 2)))) is not None]
            if not near:
                continue
            if math.isnan(near[0]):
                unknown += 1
                self.check(dev[k] > 1e8, "a point without a deviation has none")
            else:
                compared += 1
                self.check(abs(dev[k] - near[0]) <= level, f"deviation {dev[k]} of a point is {near[0]}")
        self.check(compared > 0.9 * (len(points) - unknown) and unknown > 50, f"{compared} deviations compared, {unknown} unknown")
        # On the screen: red outside, blue inside.
        colours = self.b.js("""const m = trephine.meshes[1]; trephine.meshes.forEach(x => { x.visible = x === m }); m.opacity = 1
            document.getElementById('show-marks').click(); document.querySelector('#views button[data-view=a]').click(); document.getElementById('deviation-1').click()
            trephine.render()
            const c = document.getElementById('solid'), t = document.createElement('canvas'); t.width = c.width; t.height = c.height
            const g = t.getContext('2d'); g.drawImage(c, 0, 0)
            const mt = trephine.cam.matrix(c.width, c.height), out = []
            for (let i = 0; i < m.dev.length; i += 3) { const p = [...m.pos.slice(3 * i, 3 * i + 3)]; const q = p.map((x, k) => x - arguments[0][k])
              if (m.nor[3 * i + 1] > -.5 || m.dev[i] < 1e8 && Math.hypot(q[0], q[1] + 30, q[2]) < 29) continue
              const [x, y] = trephine.cam.project(mt, c.width, c.height, p), d = g.getImageData(x, y, 1, 1).data; out.push([m.dev[i], d[0], d[1], d[2]]) }
            document.getElementById('show-marks').click(); document.getElementById('deviation-1').click(); trephine.meshes.forEach(x => { x.visible = true })
            return out""", self.manifest["center_mm"])
        strong = [c for c in colours if 0.3 < abs(c[0]) < 1e8]
        right = sum((c[1] > c[3] + 15) == (c[0] > 0) and abs(c[1] - c[3]) > 15 for c in strong)
        self.check(len(strong) > 30 and right == len(strong), f"the map's colours: {right} of {len(strong)}")
        grey = [c for c in colours if c[0] > 1e8]
        self.check(grey and sum(abs(c[1] - c[3]) < 12 for c in grey) > 0.8 * len(grey), "what has no deviation is grey")

    def tables(self):
        rows = self.b.js("return [...document.querySelectorAll('#surfaces table tr')].slice(1).map(r => [...r.cells].map(c => c.title))")
        for row, a in zip(rows, self.manifest["anatomies"]):
            d, b = a["deviation_mm"], a["budget_mm"]
            want = [a["triangles"], a["volume_ml"], a["area_cm2"], d["max"], d["p99"], d["rms"], b["used"]]
            self.check([float(x) for x in row[1:]] == want, f"the row of {a['name']}: {row} {want}")
        self.check(len(rows) == len(self.manifest["anatomies"]), "a row for every anatomy")
        rows = self.b.js("return [...document.querySelectorAll('#landmarks tr.jump')].map(r => [r.cells[0].title, r.cells[1].title, r.cells[2].title, r.cells[3].textContent])")
        for row, l in zip(rows, self.manifest["landmarks"]):
            self.check(row[0] == l["name"] and [float(x) for x in row[1].split(", ")] == l["position_mm"] and float(row[2]) == l["confidence"] and row[3] == l["source"], f"the row of {l}: {row}")
        figures = self.b.js("return [...document.querySelectorAll('#figures tr')].slice(1).map(r => [r.cells[0].textContent, r.cells[1].title])")
        self.check(figures == [[k.replace("_", " "), str(v)] for k, v in self.manifest["figures"].items() if k != "verdict"], f"figures: {figures}")
        first = self.b.js("const v = document.getElementById('verdict'), w = document.getElementById('warnings'); return [v.textContent, !!(v.compareDocumentPosition(w) & 4)]")
        self.check(first == ["Verdict" + self.manifest["figures"]["verdict"], True], f"the verdict stands before the warnings: {first}")
        provenance = self.b.js("return document.getElementById('provenance').textContent")
        self.check(self.manifest["provenance"]["input_sha256"] in provenance and "outer.decimate.max deviation mm" in provenance, "provenance is told")
        self.check(self.b.js("return document.querySelectorAll('#trade circle.chosen').length") == 1, "the chosen point of the trade is marked")

    def slices(self):
        """The CT's values where they lie, in the window that was chosen."""
        self.set("show-cuts", None), self.set("show-marks", None)
        center = self.manifest["center_mm"]
        self.b.js("trephine.go(arguments[0])", center)
        for level, width in ((40, 400), (500, 2000)):
            self.set("level", str(level)), self.set("width", str(width))
            for plane, (u, v) in {"axial": (0, 1), "coronal": (0, 2)}.items():
                for x in (-60.2, 20.3, 59.1):
                    want = 2500 if 50 < x < 66 else 1200 if abs(x) < 38 else 60 - x / 2
                    grey = self.b.js("""trephine.slices(); const p = trephine.planes.find(p => p.id === arguments[0]), c = document.getElementById(p.id)
                        const [x, y] = p.place(arguments[1], arguments[2]), r = c.width / c.clientWidth
                        return [...c.getContext('2d').getImageData(Math.round(x * r), Math.round(y * r), 1, 1).data]""", plane, center[u] + x, center[v] + 5)
                    shown = max(0, min(255, 255 * ((want - level) / width + 0.5)))
                    self.check(abs(grey[0] - shown) < 6 and grey[0] == grey[1] == grey[2], f"{plane} at {x} mm: {want} HU is {shown}, not {grey}")
        self.check("the CT of the case" in self.b.js("return document.getElementById('source').textContent"), "it says where the slices come from")
        self.set("show-cuts", None), self.set("show-marks", None)

    def rays(self):
        """The CT by rays: as a plain caster in script draws it, ended by opaque surfaces and by the cut."""
        if self.b.js("return document.getElementById('cast').disabled"):
            self.check(self.mode != "webgl2", "rays are offered where WebGL2 is")
            return
        self.b.js("trephine.meshes.forEach(m => { m.visible = false }); trephine.state.showMarks = false; document.querySelector('#views button[data-view=home]').click(); trephine.cam.dist *= 0.5")
        settle(self.b)
        bare = self.pixels()
        for name in ("bone", "skin"):
            self.set("cast", name)
            off = self.b.js(REFERENCE, 700)
            self.check(off["covered"] > 60, f"{name}: rays that meet something: {off}")
            self.check(off["median"] <= 2 and off["p95"] <= 8, f"{name}: as the reference draws it: {off}")
        self.check(differ(bare, self.pixels()) > 60, "the CT is seen")
        self.set("shift", "400"), self.set("clip", "1")
        off = self.b.js(REFERENCE, 700)
        self.check(off["covered"] > 40 and off["median"] <= 2 and off["p95"] <= 8, f"shifted and cut: {off}")
        self.set("shift", "0"), self.set("clip", "-1")
        # A surface that hides all of it.
        self.set("cast", "bone")
        self.b.js("const m = trephine.meshes[0]; m.visible = true; m.kept = m.opacity; m.opacity = 1; trephine.render()")
        with_rays = self.pixels()
        self.set("cast", "nothing"), self.b.js("trephine.render()")
        without = self.pixels()
        self.check(differ(with_rays, bare) > 60 and differ(with_rays, without) < 60, "an opaque surface hides the bone that lies behind it")
        self.set("cast", "nothing")
        self.b.js("trephine.meshes.forEach(m => { m.visible = true; if (m.kept) m.opacity = m.kept }); trephine.cam.dist *= 2; trephine.state.showMarks = true; trephine.render()")

    def felt_rays(self):
        """What is felt by rays, all of it and a shape alone."""
        if self.mode != "webgl2":
            return
        names = self.b.js("return [...document.getElementById('cast').options].map(o => o.textContent)")
        self.check("bone" in names and "felt: all" in names and "felt: inner" in names, f"what rays can go through: {names}")
        self.b.js("trephine.meshes.forEach(m => { m.visible = false }); trephine.state.showMarks = false; document.querySelector('#views button[data-view=home]').click(); trephine.cam.dist *= 0.5")
        seen = {}
        for name in ("felt: all", "felt: inner"):
            self.set("cast", name)
            self.check(self.b.js("return document.getElementById('shift').disabled"), f"{name}: no HU to shift")
            off = self.b.js(REFERENCE, 500)
            self.check(off["covered"] > 30 and off["median"] <= 2 and off["p95"] <= 8, f"{name}: as the reference draws it: {off}")
            seen[name] = self.pixels()
        self.check(differ(seen["felt: all"], seen["felt: inner"]) > 60, "one shape is less than all")
        self.set("clip", "1")
        self.set("cast", "felt: all")
        off = self.b.js(REFERENCE, 500)
        self.check(off["covered"] > 30 and off["median"] <= 2 and off["p95"] <= 8, f"cut: {off}")
        self.set("clip", "-1"), self.set("cast", "nothing")
        self.b.js("trephine.meshes.forEach(m => { m.visible = true }); trephine.cam.dist *= 2; trephine.state.showMarks = true; trephine.render()")

    def without_ct(self):
        self.b.open((self.case.parent / "felt/report/view.html").as_uri())
        wait(self.b)
        self.check("holds no CT" in self.b.js("return document.getElementById('source').textContent"), "a case without CT says so")
        self.b.js("trephine.go(trephine.data.targets[0].position_mm)")
        p = self.pixels("coronal")
        self.check(len({tuple(p[i:i + 3]) for i in range(0, len(p), 4)}) > 3, "and shows the shapes of the haptic volume")

    def hostile(self):
        warnings = json.loads((self.case / "report/view.json").read_text())["warnings"]
        self.check(self.b.js("return [...document.querySelectorAll('#warnings p')].map(p => p.textContent)") == warnings, "warnings verbatim")
        self.check(self.b.js("return document.title") == self.manifest["case"] and self.b.js("return document.querySelectorAll('img, b, iframe, object').length") == 0,
                   "hostile names stay text")


def make_pages(folder):
    subprocess.run([os.environ["PAGE_SAMPLES"], folder], check=True)
    case = pathlib.Path(folder) / "marked"
    for one in (case, case.parent / "felt"):
        subprocess.run([os.environ["TREPHINE"], "page", one, "--quiet"], check=True)
    return case


def main():
    mode = sys.argv[1]
    check = Checks()
    with tempfile.TemporaryDirectory() as folder:
        case = make_pages(folder)
        with Browser(*MODES[mode]) as browser:
            page = Page(browser, check, case, mode)
            page.opens()
            page.hostile()
            page.tables()
            page.controls()
            page.camera()
            page.looking()
            page.cross_hair()
            page.left_is_left()
            page.cuts()
            page.deviation()
            page.slices()
            browser.call("/window/rect", {"width": 800, "height": 600})  # rays are cast by the processor here: fewer of them
            page.rays()
            page.felt_rays()
            page.without_ct()
    check.end()


if __name__ == "__main__":
    main()
