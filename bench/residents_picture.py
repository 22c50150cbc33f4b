#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""residents_picture.py TEXT PICTURE.svg: draws what `lessons_test --gtest_filter=LongLessonsResidents*` printed: for each level
of aim noise how many simulated residents scored how many points, the mean and its 95 % interval."""
import re
import sys

LEVEL = re.compile(r"aim noise +([0-9.]+) mm: mean ([0-9.]+) \+- ([0-9.]+) \|(.*)")
WIDTH, HEIGHT, LEFT, BAR, TOP = 640, 84, 130, 15, 30
MOST_POINTS = 30


def main():
    levels = []
    for line in open(sys.argv[1], encoding="utf-8"):
        if found := LEVEL.match(line):
            counts = {int(p): int(n) for p, n in (pair.split(":") for pair in found[4].split())}
            levels.append((found[1], float(found[2]), float(found[3]), counts))
    if not levels:
        sys.exit(f"{sys.argv[1]}: holds no levels")
    most = max(max(counts.values()) for *_, counts in levels)
    total = TOP + HEIGHT * len(levels) + 40
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {total}" font-family="sans-serif" font-size="12">',
        f'<rect width="{WIDTH}" height="{total}" fill="#fff"/>',
        f'<text x="{LEFT}" y="18">Simulated residents in the phantom head of the tests, by points of {MOST_POINTS}</text>',
    ]
    x_of = lambda points: LEFT + BAR * (points + 0.5)
    for n, (noise, mean, half, counts) in enumerate(levels):
        base = TOP + HEIGHT * (n + 1) - 8
        out.append(f'<text x="8" y="{base - 40}">aim noise {noise} mm</text>')
        out.append(f'<text x="8" y="{base - 24}" fill="#555">mean {mean:.1f} &#177; {half:.1f}</text>')
        out.append(f'<text x="8" y="{base - 8}" fill="#555">{sum(counts.values())} residents</text>')
        out.append(f'<line x1="{LEFT}" x2="{x_of(MOST_POINTS) + BAR}" y1="{base}" y2="{base}" stroke="#999"/>')
        for points, count in sorted(counts.items()):
            height = (HEIGHT - 22) * count / most
            out.append(
                f'<rect x="{x_of(points) - 0.4 * BAR:.1f}" y="{base - height:.1f}" width="{0.8 * BAR:.1f}" height="{height:.1f}" '
                'fill="#56b4e9"/>'
            )
        out.append(
            f'<line x1="{x_of(mean - half):.1f}" x2="{x_of(mean + half):.1f}" y1="{base + 4}" y2="{base + 4}" stroke="#d55e00" '
            'stroke-width="3"/>'
        )
    for points in range(0, MOST_POINTS + 1, 5):
        out.append(f'<text x="{x_of(points):.1f}" y="{total - 22}" text-anchor="middle">{points}</text>')
    out.append(f'<text x="{LEFT}" y="{total - 6}" fill="#555">orange: the 95 % interval of the mean</text>')
    out.append("</svg>")
    with open(sys.argv[2], "w", encoding="utf-8") as f:
        f.write("\n".join(out) + "\n")


if __name__ == "__main__":
    main()
