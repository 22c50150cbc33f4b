# SPDX-License-Identifier: GPL-3.0-or-later
"""slicer_modules.py FOLDER WORK CASE SURFACE CONFIG: the executables of a folder as 3D Slicer finds and calls them.

The rules are those of the Slicer execution model, as its public documentation (slicer.readthedocs.io, developer guide, Module Overview;
github.com/Slicer/SlicerExecutionModel, ModuleDescriptionParser) states them: what --xml prints is read, checked, filled in and turned
into a command line, every parameter with its default, as vtkSlicerCLIModuleLogic does."""
import json, os, pathlib, re, subprocess, sys, xml.etree.ElementTree as ET

folder, work, case, surface, config = (pathlib.Path(a) for a in sys.argv[1:6])
HEAD = ["category", "title", "description", "version", "documentation-url", "license", "contributor"]
VALUES = {"integer": r"-?\d+", "double": r"-?\d+(\.\d+)?([eE][-+]?\d+)?", "boolean": "true|false", "string": ".*",
          "string-enumeration": ".+", "double-vector": r"(-?\d+(\.\d+)?([eE][-+]?\d+)?)(,-?\d+(\.\d+)?([eE][-+]?\d+)?)*", "integer-vector": r"-?\d+(,-?\d+)*",
          "file": ".*", "directory": ".*"}
ALWAYS = {"integer", "double", "string-enumeration"}  # Slicer gives these also where nobody changed them
VARIABLE = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
# What Slicer's own start script leaves in the environment: libraries that are others than ours.
slicer = {**os.environ, "LD_LIBRARY_PATH": str(work / "slicer-libraries"), "PYTHONHOME": str(work / "slicer-python")}
(work / "slicer-libraries").mkdir()
for name in ("libz.so.1", "libfmt.so.9", "libcrypto.so.3"):
    (work / "slicer-libraries" / name).write_bytes(b"no library")


def described(program):
    """The parameters of a module by name, each its element; fails where a rule is broken."""
    done = subprocess.run([program, "--xml"], capture_output=True, env=slicer, cwd="/")
    assert done.returncode == 0 and not done.stderr, (program, done.stderr)
    root = ET.fromstring(done.stdout)
    assert root.tag == "executable"
    assert [e.tag for e in root][:len(HEAD)] == HEAD and {e.tag for e in root[len(HEAD):]} == {"parameters"}
    assert all(root.findtext(t).strip() for t in ("category", "title", "description", "version", "license"))
    found, flags, indexes = {}, set(), []
    for group in root.findall("parameters"):
        assert set(group.attrib) <= {"advanced"} and [e.tag for e in group][:2] == ["label", "description"]
        assert group.findtext("label").strip() and len(group) > 2
        for p in group[2:]:
            assert p.tag in VALUES and not p.attrib, p.tag
            texts = {e.tag: (e.text or "") for e in p}
            allowed = {"name", "longflag", "index", "description", "label", "default", "constraints", "element", "channel"}
            assert set(texts) <= allowed and {"name", "description", "label"} <= set(texts), texts
            name = texts["name"]
            assert VARIABLE.fullmatch(name) and name not in found, name
            assert ("longflag" in texts) != ("index" in texts), name
            if "longflag" in texts:
                flag = texts["longflag"].lstrip("-")
                assert VARIABLE.fullmatch(flag) and flag not in flags, flag
                flags.add(flag)
            else:
                indexes.append(int(texts["index"]))
            assert ("channel" in texts) == (p.tag in ("file", "directory")) and texts.get("channel", "input") in ("input", "output")
            assert re.fullmatch(VALUES[p.tag], texts.get("default", "")) or p.tag not in ALWAYS | {"boolean", "double-vector"}, (name, texts)
            choices = [e.text for e in p.findall("element")]
            assert bool(choices) == (p.tag == "string-enumeration") and (not choices or texts["default"] in choices)
            if (limits := p.find("constraints")) is not None:
                least, most, step = (float(limits.findtext(k)) for k in ("minimum", "maximum", "step"))
                value = float(texts["default"])
                assert least <= value <= most and step > 0 and [e.tag for e in limits] == ["minimum", "maximum", "step"], name
                assert abs(value / step - round(value / step)) < 1e-6, (name, value, step)  # Slicer rounds to the step's digits
            found[name] = p
    assert sorted(indexes) == list(range(len(indexes))), indexes
    return found


def call(name, given, code=0):
    """Runs a module with these values, and the default of every other parameter, as Slicer does."""
    program, parameters = folder / name, described(folder / name)
    assert set(given) <= set(parameters), set(given) - set(parameters)
    words, positional = [str(program), "--returnparameterfile", str(work / "return.params")], {}
    for key, p in parameters.items():
        value = str(given.get(key, p.findtext("default") or ""))
        if p.find("index") is not None:
            positional[int(p.findtext("index"))] = value
        elif p.tag == "boolean":
            words += [p.findtext("longflag")] if value == "true" else []
        elif p.tag in ALWAYS or value:
            words += [p.findtext("longflag"), value]
    done = subprocess.run(words + [positional[i] for i in sorted(positional)], capture_output=True, text=True, env=slicer, cwd="/")
    assert done.returncode == code, (words, done.returncode, done.stderr)
    return done


modules = sorted(p.name for p in folder.iterdir())
assert modules == ["TrephineExport", "TrephineMeasure", "TrephineRun"] and all(os.access(folder / m, os.X_OK) for m in modules)
call("TrephineExport", {"input": case, "format": "slicer-mrb,vtp", "anatomy": "inner", "out": work / "exported", "quiet": "true"})
assert {p.suffix for p in (work / "exported").iterdir()} == {".mrb", ".vtp"}
done = call("TrephineMeasure", {"surface": surface, "report": work / "report.json"})
assert "volume_mm3" in done.stdout and json.loads((work / "report.json").read_text())
done = call("TrephineRun", {"config": config, "out": work / "library", "explain": "true"})
assert "skull" in done.stdout and not (work / "library").exists()
# A value that was changed is passed on, and what is refused ends as on a command line.
done = call("TrephineExport", {"input": case, "format": "slicer-mrb", "trajectory_mm": "500", "out": work / "none"}, 64)
assert "--trajectory-mm" in done.stderr, done.stderr
print(f"{len(modules)} modules, {sum(len(described(folder / m)) for m in modules)} parameters")
