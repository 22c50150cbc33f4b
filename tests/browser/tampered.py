# SPDX-License-Identifier: GPL-3.0-or-later
"""tampered.py: a page that was changed or cut off. What was injected does not run, and what is damaged is told."""
import http.server
import json
import tempfile
import threading

from page import make_pages, wait
from webdriver import Browser, Checks


class Counter(http.server.BaseHTTPRequestHandler):
    hits = 0

    def do_GET(self):
        Counter.hits += 1
        self.send_response(200)
        self.end_headers()

    def log_message(self, *_):
        pass


def main():
    check = Checks()
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Counter)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    remote = f"http://127.0.0.1:{server.server_port}"
    with tempfile.TemporaryDirectory() as folder, Browser() as browser:
        case = make_pages(folder)
        file = case / "report/view.html"
        good = file.read_text()

        def shows(html):
            file.write_text(html)
            browser.open("about:blank")
            browser.log("browser")
            browser.open(file.as_uri())
            wait(browser)
            return browser.js("const p = document.getElementById('problem'); return p.hidden ? '' : p.textContent")

        secret = case / "secret.html"
        secret.write_text("<p>secret</p>")
        injected = (f"<script>document.title = 'taken'</script><img src='{remote}/a.png' onerror=\"document.title = 'taken'\">"
                    f"<script src='{remote}/a.js'></script><link rel=stylesheet href='{remote}/a.css'><iframe src='{secret.as_uri()}'></iframe>"
                    f"<div style='position:fixed;inset:0;background:red'></div><form action='{remote}'><input type=submit id=send></form>")
        told = shows(good.replace("</main>", "</main>" + injected))
        refused = [e["message"] for e in browser.log("browser") if "Content Security Policy" in e["message"]]
        check(told == "" and browser.js("return document.title") == "marked", "an injected script does not run")
        check(len(refused) >= 5, f"the policy refuses it: {refused}")
        check(browser.js("return getComputedStyle(document.querySelector('body div[style]')).position") == "static", "an injected style does nothing")
        frame = browser.js("const f = document.querySelector('iframe'); try { return f.contentDocument ? f.contentDocument.body.textContent : '' } catch (e) { return '' }")
        check("secret" not in frame, "a frame with a file stays empty")
        browser.js("document.getElementById('send').click()")
        check(Counter.hits == 0, f"nothing is fetched: {Counter.hits}")

        at = good.index('id="case-data"')
        data = good[good.index(">", at) + 1:good.index("</script>", at)]
        changed = json.loads(data)
        changed["case"] = "<img src=x onerror=\"document.title='taken'\">"
        told = shows(good.replace(data, json.dumps(changed).replace("<", "\\u003c")))
        check(told == "" and browser.js("return document.getElementById('title').textContent") == changed["case"] and not browser.js("return document.querySelector('img')"),
              "a hostile name of a case stays text")

        block = good.index('id="surface-1"')
        middle = good.index(">", block) + 2000
        swapped = good[:middle] + ("A" if good[middle] != "A" else "B") + good[middle + 1:]
        for name, html in {"cut off in its data": good[:middle], "cut off in its figures": good[:at + 200], "cut off before its end": good[:-30],
                           "one letter changed": swapped, "a part missing": good.replace('id="surface-1"', 'id="other"'),
                           "a letter that is none": good[:middle] + "*" + good[middle + 1:], "figures changed": good.replace(data, data[:-9])}.items():
            told = shows(html)
            check("Make it again" in told and ("cut off" in told or "damaged" in told), f"{name}: a clear message: '{told}'")
        for key, value in (("points", 10), ("triangles", 7)):
            changed = json.loads(data)
            changed["anatomies"][0][key] = value
            told = shows(good.replace(data, json.dumps(changed)))
            check("damaged" in told, f"wrong {key}: a clear message: '{told}'")
    check.end()


if __name__ == "__main__":
    main()
