# SPDX-License-Identifier: GPL-3.0-or-later
"""desk_use.py [MINUTES [SIZE [SLICES]]]: random use of the desk in chromium on a phantom of SIZE x SIZE x SLICES voxels: scrolling,
windows, strokes of every kind, undo, panels. It prints how long a slice takes to come, how long from the brush to the picture, and the
memory of the desk and of the page, and checks that memory does not grow and that no page reports a fault. TREPHINE is the program."""
import pathlib
import random
import sys
import tempfile
import time

from desk import Desk, Page, make_root, no_console_errors, run
from desk_hand import SCENE
from webdriver import Browser, Checks

TOOLS = ("cross", "measure", "profile", "entry", "target", "add", "remove", "erase", "fill", "grow", "region", "snake", "cut", "smooth")
TABS = ("look", "place", "paint", "values", "history", "build", "approve")
FULL = "skin.segment.fill: none, skin.segment.coarse_mm: 1.5"


def memory_mb(pid):
    for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1]) / 1024
    return 0.0


def slices_ms(browser):
    """From asking for a slice that was not asked for yet to its bytes, along each axis: medians."""
    return browser.call("/execute/async", {"script": """
        const done = arguments[arguments.length - 1], v = desk.page.volume
        ;(async () => { const out = []
          for (const axis of [0, 1, 2]) { const all = []
            for (let i = 3; i < v.size[axis]; i += Math.ceil(v.size[axis] / 15)) {
              v.forget(`${axis}:${i}`)
              const began = performance.now()
              await v.slice(axis, i)
              all.push(performance.now() - began)
            }
            all.sort((a, b) => a - b), out.push(all[all.length >> 1])
          } return out })().then(done, e => done(String(e)))""", "args": []})


def use(page, minutes, desk, seed=1):
    browser, r, rows = page.b, random.Random(seed), []
    size = browser.js("return desk.page.volume.size")
    end, told, strokes = time.monotonic() + 60 * minutes, 0, []
    actions = 0
    while time.monotonic() < end or len(rows) < 8:
        for _ in range(20):
            actions += 1
            what = r.randrange(9)
            plane = r.choice(("axial", "coronal", "sagittal"))
            x, y, w, h = page.box("#" + plane)
            at = lambda: (round(x + w * r.uniform(0.25, 0.75)), round(y + h * r.uniform(0.25, 0.75)))
            if what < 4:
                browser.js("desk.page.pick(arguments[0])", r.choice(TOOLS))
                browser.drag(*at(), *at())
                if browser.js("return /^(add|remove)$/.test(desk.page.tool)"):
                    strokes.append(browser.js("return desk.stats.brush || 0"))
            elif what == 4:
                browser.wheel(*at(), r.choice((-120, 120)))
            elif what == 5:
                browser.js("desk.page.go(arguments[0])", [r.randrange(n) for n in size])
            elif what == 6:
                page.click(f"[data-tab={r.choice(TABS)}]")
            elif what == 7:  # a snake goes on, or another edit is looked at; neither is where none is in hand
                browser.js("for (const id of arguments[0]) { const b = document.getElementById(id); if (b && !b.disabled) b.click() }", r.choice((["snake-step"], ["snake-back"], ["edit-preview"], ["cancel-edit"])))
            else:
                browser.js("desk.page.setWindow(arguments[0], arguments[1]); r = arguments[2] ? desk.page.undoPaint() : desk.page.redoPaint()", r.randrange(-200, 800), r.randrange(50, 3000), r.random() < 0.7)
            browser.js("problem('')")  # a fill that reaches the edge says so
        heap = browser.js("return performance.memory ? performance.memory.usedJSHeapSize / 1048576 : 0")
        if time.monotonic() - told > 60 * minutes / 12:
            told = time.monotonic()
            rows.append((memory_mb(desk.process.pid), heap))
            print(f"{actions} actions: the desk {rows[-1][0]:.0f} MB, the page {rows[-1][1]:.0f} MB", flush=True)
    return rows, sorted(strokes), actions


def main():
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else 10
    size, count = (int(sys.argv[2]) if len(sys.argv) > 2 else 512), (int(sys.argv[3]) if len(sys.argv) > 3 else 200)
    check = Checks()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        root, library = make_root(folder, ("skull_drilled", FULL)), folder / "library"
        (root / "configs/scenes/skull_drilled.yaml").write_text(SCENE)
        with open(root / "configs/coarse.yaml", "a") as config:
            config.write("burr_holes: []  # a hand places them\n")
        run("phantom", folder / "phantom", "--columns-count", size, "--rows-count", size, "--slices-count", count, "--slice-step-mm", 200 / count, "--quiet")
        (folder / "phantom/dicom").rename(root / "big")
        listed = root / "configs/LIBRARY.yaml"
        listed.write_text(listed.read_text().replace("../sample_dicom", "../big"))
        run("library", "build", listed, "--out", library, "--quiet")
        with Desk(root, library) as desk:
            with Browser("--enable-unsafe-swiftshader", "--enable-precise-memory-info", "--lang=en", width=1600, height=1000) as browser:
                browser.open(desk.url + "/case/head-01")
                page = Page(browser, check)
                page.until("desk.page && desk.page.volume && desk.page.fields.includes('skull') && !document.getElementById('busy').textContent", "the opened case")
                page.write("#who", "anna-2")
                print("voxels:", browser.js("return desk.page.volume.size"))
                print("a slice along i, j, k comes in", " ".join(f"{v:.1f}" for v in slices_ms(browser)), "ms (medians)")
                rows, strokes, actions = use(page, minutes, desk)
                if strokes:
                    print(f"brush to picture: median {strokes[len(strokes) // 2]:.1f} ms, 95 of 100 within {strokes[len(strokes) * 95 // 100]:.1f} ms, {len(strokes)} strokes")
                early, late = rows[len(rows) // 3:len(rows) // 3 + 3], rows[-3:]
                for n, what in ((0, "desk"), (1, "page")):
                    a, b = max(v[n] for v in early), min(v[n] for v in late)
                    check(b < 1.25 * a + 60, f"memory of the {what}: {a:.0f} MB early, {b:.0f} MB late, {actions} actions")
                no_console_errors(browser, check)
            check(desk.end() == 0, "Ctrl-C ends the desk")
    check.end()


if __name__ == "__main__":
    main()
