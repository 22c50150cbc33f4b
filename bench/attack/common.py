# SPDX-License-Identifier: GPL-3.0-or-later
"""What the attackers share: a seed, a scratch folder, runs of the program, and the rules that hold for every run."""
import argparse
import pathlib
import random
import re
import subprocess
import sys
import tempfile

CANARY = "CANARYZEBRA"
PROGRESS = re.compile(r"(\d+ % of all|\S+ \d+ %)( \(|,| \||$)")
KNOWN_CODES = {0, 64, 65, 66, 70, 73, 74, 75, 78, 80, 81, 130}


class Attack:
    def __init__(self, about, count, more=None):
        parser = argparse.ArgumentParser(description=about)
        parser.add_argument("--trephine", default="trephine", help="the program")
        parser.add_argument("--sim", default="trephine-sim", help="the simulator")
        parser.add_argument("--seed", type=int, default=1)
        parser.add_argument("--count", type=int, default=count, help="how many attacks")
        parser.add_argument("--timeout-s", type=float, default=120, help="a run that takes longer is a finding")
        for name, settings in (more or {}).items():
            parser.add_argument(name, **settings)
        self.args = parser.parse_args()
        self.random = random.Random(self.args.seed)
        self.scratch = tempfile.TemporaryDirectory()
        self.work = pathlib.Path(self.scratch.name)
        self.findings, self.outcomes = [], {}

    def find(self, what):
        self.findings.append(what)
        print("FINDING: " + what, flush=True)

    def run(self, what, *words, program=None, allowed=KNOWN_CODES - {70}, cwd=None):
        """Runs the program. A crash, an unknown code, more than one line of why, a canary, or a run without end is a finding."""
        command = [program or self.args.trephine, *map(str, words)]
        try:
            done = subprocess.run(command, capture_output=True, timeout=self.args.timeout_s, cwd=cwd)
        except subprocess.TimeoutExpired:
            self.find(f"{what}: no end after {self.args.timeout_s} s")
            return 124, "", ""
        code, out, err = done.returncode, done.stdout.decode("utf-8", "replace"), done.stderr.decode("utf-8", "replace")
        key = str(code) + (" " + field_of(err) if code else "")
        self.outcomes[key] = self.outcomes.get(key, 0) + 1
        if code not in allowed:
            self.find(f"{what}: exit {code}: {err.strip()[-300:]}")
        if CANARY in out + err:
            self.find(f"{what}: an identifier is told: {err.strip()[-300:]}")
        # On a busy machine a program also says how far it is.
        lines = [line for line in err.splitlines() if "warning" not in line and line.strip() and not PROGRESS.match(line)]
        if code in (65, 66, 80, 81) and len(lines) != 1:
            self.find(f"{what}: {len(lines)} lines of why")
        return code, out, err

    def sample(self, name, kind):
        """A case that the tests use, made by the program that lies beside the attacked one in a build."""
        folder = self.work / name
        subprocess.run([pathlib.Path(self.args.trephine).resolve().parent / "write_sample_case", folder, kind], check=True)
        return folder

    def end(self):
        for key in sorted(self.outcomes, key=self.outcomes.get, reverse=True)[:40]:
            print(f"{self.outcomes[key]:6d}  {key}")
        print(f"{sum(self.outcomes.values())} runs, {len(self.findings)} findings, seed {self.args.seed}")
        sys.exit(1 if self.findings else 0)


def field_of(err):
    """The part of an error that says which kind of fault it is: no names, no numbers."""
    line = err.strip().splitlines()[-1] if err.strip() else ""
    return re.sub(r"[0-9.]+", "#", ": ".join(line.split(": ")[-2:]))[:90]
