# SPDX-License-Identifier: GPL-3.0-or-later
"""desk_tabs.py: a person's hand at the desk in chromium: who it is, what is edited before a case is open, and what another tab did.
TREPHINE is the program."""
import json
import pathlib
import tempfile

from desk import Desk, Page, make_root
from webdriver import Browser, Checks

TOLD = "document.getElementById('problem').hidden ? '' : document.getElementById('problem-text').textContent"


def post(desk, path, body):
    body = body if isinstance(body, bytes) else json.dumps(body).encode()
    return desk.raw(desk.head("POST", path, Content_Type="application/json", Content_Length=len(body)) + body)


def info(desk):
    return json.loads(desk.get("api/case?case=head-01").split(b"\r\n\r\n", 1)[1])


def who(browser, page, check):
    """A name is neither kept nor sent."""
    for name, fine in (("Anna Schmidt", False), ("anna-2", True), ("A", False)):
        page.write("#who", name)
        kept, marked = browser.js("return [localStorage.getItem('trephine-who'), document.getElementById('who').getAttribute('aria-invalid')]")
        check((kept == name) == fine and marked == str(not fine).lower(), f"{name}: kept {kept}, marked {marked}")
    page.write("#who", "anna-2")


# As a slow desk answers: the scan is there, its outlines are not, until `letOpen` is set.
OPENS_SLOWLY = """const quick = window.fetch; window.fetch = async (...asked) => {
  const reply = await quick(...asked)
  if (window.letOpen || !String(asked[0]).startsWith('api/open?')) return reply
  await new Promise(r => setTimeout(r, 50))
  const now = await reply.json()
  return new Response(JSON.stringify({ ...now, state: now.lattice ? 'opening' : now.state }))
}"""


def before_open(desk, browser, page, check, root):
    """While the case is being opened: a stroke sent to the desk, and one on the page."""
    base = info(desk)["base"]
    browser.js(OPENS_SLOWLY)
    browser.js("location.hash = 'case/head-01'")
    page.until("desk.page && desk.page.volume", "the scan, before its outlines")
    answer = post(desk, f"api/patch?case=head-01&anatomy=skull&by=anna-2&why=&base={base}", b"\0" * 64)
    # The desk itself may be quicker than the page, and refuses the patch for its size.
    check(b" 200 " not in answer.split(b"\r\n")[0], f"a patch before the outlines: {answer[-300:]}")
    for tool in ("landmark", "add"):
        browser.js("desk.page.pick(arguments[0]); problem('')", tool)
        browser.click(*page.place("axial", [n // 2 for n in browser.js("return desk.page.volume.size")]))
        told, closed = browser.js(f"return [{TOLD}, !desk.page.isOpen]")
        check(closed and "still being opened" in told, f"{tool}: {told}")
    check(not (root / "configs/head-01.yaml").exists() and not (root / "configs/head-01.desk").exists(), "nothing was saved")
    browser.js("problem(''); window.letOpen = true")
    page.until("desk.page.isOpen && document.documentElement.dataset.ready === 'case'", "the opened case")


def other_tab(desk, browser, page, check, root):
    """What this tab saved is taken back as long as it stands; what another tab saved is not."""
    def put(name, at):
        browser.js("window.saved = ''; putLandmark(desk.page, arguments[0], arguments[1]).then(() => { saved = 'yes' }, e => { saved = e.message })", name, at)
        page.until("saved === 'yes'", name)

    def given(name):
        return info(desk)["now"]["landmarks"].get(name)

    browser.js("desk.page.pick('cross')")  # with a brush in hand, undo is of strokes
    put("inion", [0.5, 89, 6])
    put("nasion", [0.5, -93, 40])
    other = {"case": "head-01", "by": "bert-1", "name": "nasion", "position_mm": [1, -92, 41], "base": info(desk)["base"]}
    check(b" 200 " in post(desk, "api/landmark", other).split(b"\r\n")[0], "another tab moves the nasion")
    page.click("#undo")
    page.until("!document.getElementById('problem').hidden", "what undo says")
    check("has changed this since" in browser.js(f"return {TOLD}"), "undo says that another tab changed it")
    check(given("nasion") == [1, -92, 41], f"and leaves it: {given('nasion')}")
    browser.js("problem('')")
    page.click("#undo")
    page.until("desk.page.info.now.landmarks.inion[1] === 89.4", "undo of the change before, which nobody touched")
    check(given("inion") == [0, 89.4, 5.8] and given("nasion") == [1, -92, 41], "of this tab alone")
    page.click("#redo")
    page.until("desk.page.info.now.landmarks.inion[1] === 89", "and redo")


def main():
    check = Checks()
    with tempfile.TemporaryDirectory() as folder:
        root = make_root(pathlib.Path(folder))
        with Desk(root, pathlib.Path(folder) / "library") as desk, Browser("--lang=en", width=1600, height=1000) as browser:
            browser.open(desk.url)
            page = Page(browser, check)
            page.until("document.documentElement.dataset.ready === 'library' && !!document.querySelector('.card')", "the library's page")
            who(browser, page, check)
            before_open(desk, browser, page, check, root)
            other_tab(desk, browser, page, check, root)
            check(desk.end() == 0, "Ctrl-C ends the desk")
    check.end()


if __name__ == "__main__":
    main()
