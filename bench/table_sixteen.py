#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""table_sixteen.py: which p values of the dissertation's Table XVI follow from what it prints.

The table prints, for each group of screws, their number, how many had at most 2 of 5 errors, and mean and standard deviation of
the errors. The Kruskal-Wallis test needs the errors of each screw. This lists every distribution of 0 to 5 errors that rounds to
the printed figures, and the least and largest p value of two groups over all of them (chi-squared with one degree of freedom, with
and without the correction for ties)."""
import itertools
import math

GROUPS = {"A": (26, 17, 2.08, 1.23), "B": (24, 20, 1.58, 0.88), "C": (26, 24, 0.96, 0.96)}
PRINTED = {"AB": 0.1505, "AC": 0.0005, "BC": 0.0078}


def parts(total, count):
    """All ways of writing `total` as `count` whole numbers from 0."""
    if count == 1:
        yield (total,)
        return
    for first in range(total + 1):
        for rest in parts(total - first, count - 1):
            yield (first,) + rest


def distributions(n, acceptable, mean, sd):
    for low in parts(acceptable, 3):
        for high in parts(n - acceptable, 3):
            counts = low + high
            total = sum(k * c for k, c in enumerate(counts))
            if abs(total / n - mean) > 0.005 + 1e-12:
                continue
            squares = sum(k * k * c for k, c in enumerate(counts))
            spread = math.sqrt((squares - total * total / n) / (n - 1))
            if abs(spread - sd) <= 0.005 + 1e-12:
                yield counts


def kruskal(a, b):
    """p with and without the correction for ties."""
    n1, n2 = sum(a), sum(b)
    n = n1 + n2
    rank, sum_a, ties, below = 0, 0, 0, 0
    for x, y in zip(a, b):
        t = x + y
        rank = below + (t + 1) / 2
        sum_a += x * rank
        ties += t ** 3 - t
        below += t
    sum_b = n * (n + 1) / 2 - sum_a
    h = 12 / (n * (n + 1)) * (sum_a ** 2 / n1 + sum_b ** 2 / n2) - 3 * (n + 1)
    tied = h / (1 - ties / (n ** 3 - n))
    return math.erfc(math.sqrt(tied / 2)), math.erfc(math.sqrt(max(0, h) / 2))


all_of = {name: list(distributions(*figures)) for name, figures in GROUPS.items()}
for name, found in all_of.items():
    print(f"group {name}: {len(found)} distributions round to the printed figures")
for pair, printed in PRINTED.items():
    ps = [kruskal(a, b) for a, b in itertools.product(all_of[pair[0]], all_of[pair[1]])]
    for what, n in (("corrected for ties", 0), ("not corrected", 1)):
        values = [p[n] for p in ps]
        if values:
            inside = min(values) <= printed <= max(values)
            print(f"{pair}, {what}: p from {min(values):.5f} to {max(values):.5f}; printed {printed}: "
                  f"{'within' if inside else 'not within'}")
joint = [(a, b, c) for a in all_of["A"] for b in all_of["B"] for c in all_of["C"]
         if abs(kruskal(a, b)[0] - PRINTED["AB"]) < 5e-5 and abs(kruskal(a, c)[0] - PRINTED["AC"]) < 5e-5
         and abs(kruskal(b, c)[0] - PRINTED["BC"]) < 5e-5]
print(f"{len(joint)} of {len(all_of['A']) * len(all_of['B']) * len(all_of['C'])} tables give all three printed p values")
for a, b, c in joint:
    print(f"screws with 0 to 5 errors: A {a}, B {b}, C {c}")
