# SPDX-License-Identifier: GPL-3.0-or-later
"""index.py: a library's page in chromium: its links, and 10,000 cases that can be searched, filtered and sorted."""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time

from page import make_pages, settle, wait
from webdriver import Browser, Checks

CLASSES = ["normal", "hydrocephalic", "shifted", "small"]


def many(count, like):
    rows = []
    for i in range(count):
        row = dict(like, case=f"head-{i * 7919 % count:05d}", triangles=10000 + i * 31 % 9973, deviation_mm=(i * 17 % 400) / 100,
                   warnings=["a warning <b>"] if i % 7 == 0 else [], severities=["wrong"] if i % 7 == 0 else [], state="last build failed with 80" if i % 100 == 0 else "")
        row["class"] = CLASSES[i % 4]
        rows.append(row)
    return rows


def main():
    check = Checks()
    with tempfile.TemporaryDirectory() as folder, Browser("--enable-unsafe-swiftshader") as browser:
        make_pages(folder)
        library = pathlib.Path(folder)
        shutil.rmtree(library / "felt")
        shutil.copytree(library / "marked", library / "copied")  # its case.json is of another case: a fault to be shown
        subprocess.run([os.environ["TREPHINE"], "library", "list", library, "--sheet"], check=True, stdout=subprocess.DEVNULL)
        index = library / "index.html"

        def opens(file):
            began = time.monotonic()
            browser.open(file.as_uri())
            while not browser.js("return document.documentElement.dataset.ready === '1'"):
                if time.monotonic() - began > 600:
                    raise RuntimeError("the list never became ready")
            return time.monotonic() - began

        def comes(title):
            for _ in range(3000):
                if browser.js("return document.title") == title:
                    return True
                time.sleep(0.1)
            return False

        def cells(column):
            return browser.js("""const i = [...document.querySelectorAll('#head button')].findIndex(b => b.dataset.key === arguments[0])
                const rows = [...document.querySelectorAll('#all .row')].sort((a, b) => parseInt(a.style.top) - parseInt(b.style.top))
                return rows.map(r => r.children[i + 1].textContent)""", column)

        def set_to(id, value):
            browser.js("const e = document.getElementById(arguments[0]); e.value = arguments[1]; e.dispatchEvent(new Event('input'))", id, value)

        opens(index)
        check(cells("case") == ["copied", "marked"], f"the cases: {cells('case')}")
        check("of case marked" in cells("state")[0] and cells("state")[1] == "", f"a damaged case says so: {cells('state')}")
        browser.js("document.querySelector('#all a').click()")
        check(comes("marked"), "the link leads to the case's page")
        wait(browser)
        check(browser.js("return document.getElementById('library').offsetParent !== null"), "the page has a link back")
        browser.js("document.getElementById('library').click()")
        check(comes("Patient library"), "and back")
        errors = [e["message"] for e in browser.log("browser") if e["level"] == "SEVERE"]
        check(not errors, f"no error in the console: {errors}")

        html = index.read_text()
        at = html.index('id="cases"')
        data = html[html.index(">", at) + 1:html.index("</script>", at)]
        like = json.loads(data)["cases"][1]
        text = json.dumps({"volumes": ["outer", "inner"], "cases": many(10000, like)}).replace("<", "\\u003c")
        large = library / "large.html"
        large.write_text(html.replace(data, text))
        opening = opens(large)
        check(browser.js("return document.querySelectorAll('#all .row').length") < 60, "only what is seen is laid out")
        check(browser.js("return document.getElementById('all').clientHeight") == 640000, "and all can be scrolled to")
        sorting = browser.js("""const b = document.querySelector('#head button[data-key=triangles]'), t = performance.now(); b.click()
            document.getElementById('rows').getBoundingClientRect(); return performance.now() - t""")
        print(f"10,000 cases: open in {opening:.2f} s, sorted in {sorting:.0f} ms")
        check(sorting < 20000, "sorted without a wait that a user would take for the end")
        numbers = [int(c.replace(",", "")) for c in cells("triangles")]
        check(numbers == sorted(numbers) and numbers[0] == 10000, f"sorted upwards: {numbers}")
        browser.js("document.querySelector('#head button[data-key=triangles]').click()")
        numbers = [int(c.replace(",", "")) for c in cells("triangles")]
        check(numbers == sorted(numbers, reverse=True) and numbers[0] == 19972, f"and downwards: {numbers}")
        browser.js("document.getElementById('rows').scrollTop = 300000")
        settle(browser), settle(browser)
        check(len(cells("case")) > 5 and browser.js("return parseInt(document.querySelector('#all .row').style.top)") > 290000, "rows in the middle appear")

        told = lambda: browser.js("return document.getElementById('count').textContent")
        for control, value, count in (("class", "shifted", 2500), ("class", "", 10000), ("find", "HEAD-0012", 10), ("find", "", 10000), ("state", "failed", 100),
                                      ("state", "warned", 1429), ("state", "", 10000), ("most", "0.5", 1275), ("most", "", 10000)):
            set_to(control, value)
            check(told() == f"{count} of 10000 cases", f"{control}={value}: {told()}")
        set_to("find", "a warning")
        browser.js("document.querySelector('#all .row').click()")
        check(browser.js("return [...document.querySelectorAll('#detail p')].map(p => p.textContent)")[-1:] == ["wrong: a warning <b>"], "a warning is shown word for word, with its weight")
        check("1 (1 wrong)" in cells("warned"), f"the row counts what is wrong: {cells('warned')[:3]}")
        kept = browser.js("return location.hash")
        check("find=a" in kept and "by=triangles" in kept and "down=1" in kept, f"the address keeps what is shown: {kept}")
        broken = library / "broken.html"
        broken.write_text(large.read_text()[:300000])
        browser.open(broken.as_uri())
        check("cut off or damaged" in browser.js("return document.getElementById('problem').textContent"), "a list that is cut off says so")
    check.end()


if __name__ == "__main__":
    main()
