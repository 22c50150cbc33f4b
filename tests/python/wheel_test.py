# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheel is installed by pip into an empty folder, and works from there."""
import hashlib
import os
import pathlib
import subprocess
import sys
import unittest

from common import SOURCE, WORK, sample_case

import trephine

PIP = sorted(pathlib.Path("/usr/share/python-wheels").glob("pip-*.whl"))


def made(folder):
    package = pathlib.Path(trephine.__file__).parent
    command = [sys.executable, SOURCE / "python/make_wheel.py", package, trephine.__version__, WORK / folder]
    return pathlib.Path(subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip())


class Wheel(unittest.TestCase):
    def test_the_same_files_give_the_same_bytes(self):
        one, other = (hashlib.sha256(made(folder).read_bytes()).hexdigest() for folder in ("one", "other"))
        self.assertEqual(one, other)

    @unittest.skipUnless(PIP or os.environ.get("TREPHINE_CHECK") == "1", "needs the package python3-pip-whl")
    def test_pip_installs_it_and_it_works_from_there(self):
        site = WORK / "site"
        subprocess.run([sys.executable, PIP[0] / "pip", "--disable-pip-version-check", "install", "--no-index", "--no-deps",
                        "--quiet", "--target", site, made("wheel")], check=True)
        # Repair runs in the worker beside the module.
        run = ("import sys, trephine; case = trephine.load_case(sys.argv[1]); mesh = next(iter(case.surfaces.values())); "
               "print(trephine.__file__, len(trephine.repair(mesh).value.triangles))")
        environment = {**os.environ, "PYTHONPATH": str(site)}
        said = subprocess.run([sys.executable, "-c", run, sample_case()], env=environment, check=True, capture_output=True,
                              text=True).stdout
        self.assertTrue(said.startswith(str(site)), said)
        self.assertGreater(int(said.split()[-1]), 0)
        mode = {"capture_output": True, "text": True, "env": environment}
        listed = subprocess.run([sys.executable, PIP[0] / "pip", "--disable-pip-version-check", "list", "--path", site],
                                check=True, **mode)
        self.assertIn("trephine", listed.stdout)


if __name__ == "__main__":
    unittest.main()
