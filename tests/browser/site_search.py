# SPDX-License-Identifier: GPL-3.0-or-later
"""site_search.py ROOT REFERENCE: the site that docs/build_site.sh makes, opened from its folder: a search finds pages and links to them, from a page
within a folder too, and the menu shows the parts of the manual."""
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from webdriver import Browser, Checks, skip

PARTS = ["Tutorials", "How to make cases", "How to use cases", "Reference", "Explanation", "How right is it?", "Developers"]
LINKS = "return [...document.querySelectorAll('#mkdocs-search-results a')].map(a => a.href)"


def search(browser, words):
    browser.js("const i = document.getElementById('mkdocs-search-query'); i.value = arguments[0]; i.dispatchEvent(new Event('input'))", words)
    for _ in range(600):
        if browser.js("return document.getElementById('mkdocs-search-results').textContent"):
            break
        time.sleep(0.1)
    return browser.js(LINKS)


def main():
    check = Checks()
    with tempfile.TemporaryDirectory() as folder:
        made = subprocess.run(["bash", sys.argv[1] + "/docs/build_site.sh", folder, sys.argv[2]], capture_output=True, text=True)
        if made.returncode == 77:
            skip("no mkdocs")
        check(made.returncode == 0, f"the site is made: {made.stdout[-400:]}")
        with Browser() as browser:
            browser.open((Path(folder) / "index.html").as_uri())
            menu = browser.js("return document.querySelector('.navbar').textContent")
            check(all(part in menu for part in PARTS), f"the menu shows the parts: {menu.split()}")
            links = search(browser, "passivity delay")
            check(links and links[0].startswith("file:") and any("contact-and-force.html" in link for link in links), f"found from a folder: {links}")
            check(search(browser, "zzqx") == [], "nothing is found of a word that no page has")
            browser.open((Path(folder) / "tutorials/first-lesson.html").as_uri())
            links = search(browser, "burr hole desk")
            check(any(link.split("#")[0].endswith("/tutorials/burr-hole.html") for link in links), f"found from within a folder: {links}")
            check(all(Path(link.split("#")[0].removeprefix("file://")).is_file() for link in links), f"all links lead to a file: {links}")
    check.end()


main()
