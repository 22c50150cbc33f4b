#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""page_times.py PAGE.html ...: how large a case's page is, how long it takes to be seen, and how long its pictures take.

Needs chromium and chromium-driver. Medians, in ms, of the browser on this machine: say what else it does at the time."""
import pathlib
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "browser"))
from webdriver import Browser  # noqa: E402

FRAME = "trephine.cam.az += 0.1; trephine.render(); return trephine.times.frame"
SLICES = "trephine.at[2] += 1; trephine.slices(); return trephine.times.slices"


def open_page(url, software):
    browser = Browser(*(["--disable-3d-apis"] if software else ["--enable-unsafe-swiftshader"]), "--enable-precise-memory-info")
    browser.open(url)
    for _ in range(600):
        if browser.js("return document.documentElement.dataset.ready === '1'"):
            return browser
        time.sleep(0.1)
    raise SystemExit(url + ": never ready")


def main():
    print(f"{'page':40} {'MB':>5} {'script kB':>9} {'first ms':>8} {'slices ms':>9} {'software frame ms':>17} {'heap MB':>7}")
    for name in sys.argv[1:]:
        file = pathlib.Path(name).resolve()
        text = file.read_text()
        script = text[text.index("<script>"):].split("</script>")[0]
        first, heap = [], []
        for _ in range(3):
            with open_page(file.as_uri(), False) as browser:
                first.append(browser.js("return trephine.times.first"))
                heap.append(browser.js("return performance.memory.usedJSHeapSize") / 1e6)
                slices = statistics.median(browser.js(SLICES) for _ in range(15))
        with open_page(file.as_uri(), True) as browser:
            frame = statistics.median(browser.js(FRAME) for _ in range(9))
        print(f"{file.parent.parent.name[:40]:40} {file.stat().st_size / 1e6:5.1f} {len(script) / 1e3:9.1f} "
              f"{statistics.median(first):8.0f} {slices:9.1f} {frame:17.0f} {statistics.median(heap):7.1f}", flush=True)


if __name__ == "__main__":
    main()
