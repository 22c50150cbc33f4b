# SPDX-License-Identifier: GPL-3.0-or-later
"""small_picture.py PICTURE...: makes screenshots small enough for the documentation, in place: PNG of at most 256 colours, the most frequent
ones, by chromium and the standard library."""
import base64
import pathlib
import struct
import sys
import zlib

from webdriver import Browser

# The picture's size, its palette and an index a pixel. Colours are rounded to five bits a channel before they are counted.
REDUCE = """
const most = arguments[1], done = arguments[2], image = new Image()
image.onerror = () => done(null)
image.onload = () => {
  const c = document.createElement('canvas'), w = c.width = image.width, h = c.height = image.height, d = c.getContext('2d')
  d.drawImage(image, 0, 0)
  const px = d.getImageData(0, 0, w, h).data, count = new Map(), key = n => (px[n] >> 3) << 10 | (px[n + 1] >> 3) << 5 | px[n + 2] >> 3, sums = new Map()
  for (let n = 0; n < px.length; n += 4) {
    const k = key(n), s = sums.get(k) || [0, 0, 0, 0]
    s[0] += px[n], s[1] += px[n + 1], s[2] += px[n + 2], ++s[3]
    sums.set(k, s)
  }
  const all = [...sums].sort((a, b) => b[1][3] - a[1][3] || a[0] - b[0]).slice(0, most).map(([, s]) => s.slice(0, 3).map(v => Math.round(v / s[3]))), near = new Map()
  let out = ''
  for (let n = 0; n < px.length; n += 4) {
    const k = key(n)
    if (!near.has(k)) {
      let best = 0, least = 1e9
      all.forEach((p, i) => { const e = (p[0] - px[n]) ** 2 + (p[1] - px[n + 1]) ** 2 + (p[2] - px[n + 2]) ** 2; if (e < least) least = e, best = i })
      near.set(k, best)
    }
    out += String.fromCharCode(near.get(k))
  }
  done({ w, h, palette: all, pixels: btoa(out) })
}
image.src = 'data:image/png;base64,' + arguments[0]"""


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def shrink(browser, file, most_bytes=150000):
    """Call it on a page without a policy, such as about:blank."""
    original = base64.b64encode(file.read_bytes()).decode()
    for colours in (256, 160, 96):
        got = browser.call("/execute/async", {"script": REDUCE, "args": [original, colours]})
        if not got:
            raise RuntimeError(f"{file} is no picture")
        w, h, pixels = got["w"], got["h"], base64.b64decode(got["pixels"])
        rows = b"".join(b"\0" + pixels[y * w:(y + 1) * w] for y in range(h))
        small = (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", w, h, 8, 3, 0, 0, 0)) + chunk(b"PLTE", bytes(v for p in got["palette"] for v in p))
                 + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))
        if len(small) < most_bytes:
            break
    file.write_bytes(small)


if __name__ == "__main__":
    with Browser() as chromium:
        chromium.open("about:blank")
        for name in sys.argv[1:]:
            shrink(chromium, pathlib.Path(name))
