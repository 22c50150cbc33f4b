#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""sizes.py ROOT: how large things may be.
C++: 400 lines a file, 6,000 a room (a folder of lib/ or simulator/; of simulator/lessons each folder is one, and what lies beside them
another); of lib/, simulator/ and tools/ 25 methods and 600 lines a class, wherever they are written. Not counted as methods: what is
defaulted, deleted or pure, and what the class itself defines in three lines or fewer.
Pages (web/): 400 lines a file, 130 columns a line, 130 lines a function of a script, and no name twice at the top of one folder's
scripts, for they become one script."""
import re
import sys
from pathlib import Path

ROOT = Path(sys.argv[1])
FILE, ROOM, METHODS, CLASS, COLUMNS, FUNCTION = 400, 6000, 25, 600, 130, 130

BARE = re.compile(r'R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|//[^\n]*|/\*.*?\*/|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*', re.S | re.M)
CLASS_HEAD = re.compile(r"^(?:template\s*<.*>\s*)?(?:class|struct)\s+((?:\w+::)*\w+)\s*(?:final\s*)?(?::(?!:).*)?$", re.S)
NO_METHOD = re.compile(r"(using|typedef|friend|static_assert|enum|class|struct|union)\b")
NAME = re.compile(r"[^(={]*?(operator\s*(?:\(\)|[^\s(]+)|~?\w+)\s*\(")
OUTSIDE = re.compile(r"[^(={]*?\b((?:\w+::)+)(?:~?\w+|operator[^(]+)\s*\(")


def without_angles(text):
    """What stands in angle brackets is a type: the parentheses of std::function<void(int)> are no parameters."""
    depth, out = 0, []
    for at, c in enumerate(text):
        if c == "<" and re.search(r"\w$", text[:at].rstrip()[-1:]) and not text[:at].rstrip().endswith("operator"):
            depth += 1
        elif c == ">" and depth and text[at - 1] != "-":
            depth -= 1
        elif depth == 0:
            out.append(c)
    return "".join(out)


def is_method(text):
    text = without_angles(re.sub(r"\b(public|private|protected)\s*:|\[\[.*?\]\]", " ", text)).strip()
    return not NO_METHOD.match(text) and NAME.match(text) is not None


def classes_of(text):
    """[name, methods, lines] of each class that a file defines, and (name, lines) of each method that it defines outside of its class."""
    text = BARE.sub(lambda m: "\n" * m.group().count("\n"), text)
    stack, head, parens, classes, outside = [], 0, 0, [], []  # of the stack: kind, name, begin, methods, parentheses before
    for at, c in enumerate(text):
        if c == "(":
            parens += 1
        elif c == ")":
            parens -= 1
        elif c == ";" and parens == 0:
            member = text[head:at]
            if stack and stack[-1][0] == "class" and is_method(member) and not re.search(r"=\s*(default|delete|0)\s*$", member):
                stack[-1][3].append(member)
            head = at + 1
        elif c == "{":
            before = re.sub(r"\b(public|private|protected)\s*:|\[\[.*?\]\]", " ", text[head:at]).strip()
            flat = re.sub(r"<[^<>()]*>", "", re.sub(r"<[^<>()]*>", "", before))
            named = CLASS_HEAD.match(flat) if parens == 0 else None
            if named:
                stack.append(("class", named.group(1), at, [], parens))
            elif parens == 0 and re.match(r"(inline\s+)?namespace\b|extern\b", before):
                stack.append(("namespace", "", at, [], parens))
            else:
                stack.append(("block", "", head, [], parens))
                parens = 0
            head = at + 1
        elif c == "}" and stack:
            kind, name, begin, methods, parens = stack.pop()
            head = at + 1
            if kind == "class":
                whole = "::".join([s[1] for s in stack if s[0] == "class"] + [name])
                classes.append([whole, len(methods), text.count("\n", begin, at) + 1])
            elif kind == "block":
                declared = text[begin:at].lstrip()
                before, lines = declared.split("{", 1)[0], declared.count("\n") + 1
                if stack and stack[-1][0] == "class":
                    if parens == 0 and is_method(before):
                        if lines > 3:
                            stack[-1][3].append(before)
                    else:
                        head = begin  # an initialiser or a default: the declaration goes on
                elif all(s[0] == "namespace" for s in stack):
                    of = OUTSIDE.match(without_angles(before))
                    if of:
                        outside.append((of.group(1)[:-2], lines))
    return classes, outside


def functions_of(script):
    """(name, lines) of each function of a script."""
    script = re.sub(r"//[^\n]*|/\*.*?\*/|'(?:\\.|[^'\\\n])*'|\"(?:\\.|[^\"\\\n])*\"|(?<=[(,=:!&|?] )/(?:\\.|[^/\\\n])+/|(?<=[(!])/(?:\\.|[^/\\\n])+/",
                    lambda m: "''" + "\n" * m.group().count("\n"), script, flags=re.S)
    stack, round_, found = [], [], []
    for at, c in enumerate(script):
        if c == "(":
            round_.append(at)
        elif c == ")" and round_:
            last = round_.pop()
        elif c == "{":
            before = script[:at].rstrip()[-200:]
            if before.endswith("=>"):
                is_function, begin = True, at
            elif before.endswith(")"):
                begin = last
                is_function = not re.search(r"\b(if|for|while|switch|catch|with)\s*$", script[max(0, last - 20):last])
            else:
                is_function, begin = False, at
            line = script[script.rfind("\n", 0, begin) + 1:begin].strip()
            stack.append((is_function, begin, line))
        elif c == "}" and stack:
            is_function, begin, line = stack.pop()
            if is_function:
                found.append((line[:60] or "(", script.count("\n", begin, at) + 1))
    return found


faults = []
folders = [ROOT / f for f in ("lib", "simulator", "tools", "python", "bench", "tests") if (ROOT / f).is_dir()]
if not folders:
    sys.exit(f"{ROOT}: no folder of sources")
rooms, classes, outside = {}, {}, {}
for file in sorted(f for folder in folders for f in folder.rglob("*") if f.suffix in (".h", ".cpp")):
    text, path = file.read_text(), file.relative_to(ROOT)
    lines = text.count("\n")
    if lines > FILE:
        faults.append(f"{path}: {lines} lines, at most {FILE}")
    if path.parts[0] not in ("lib", "simulator", "tools"):
        continue
    room = "/".join(path.parts[:3 if path.parts[:2] == ("simulator", "lessons") and len(path.parts) > 3 else 2])
    if path.parts[0] != "tools":
        rooms[room] = rooms.get(room, 0) + lines
    defined, written = classes_of(text)
    for name, methods, lines in defined:
        classes.setdefault((room, name), []).append([path, methods, lines])
    for name, lines in written:
        outside[room, name] = outside.get((room, name), 0) + lines
for room, lines in rooms.items():
    if lines > ROOM:
        faults.append(f"{room}: {lines} lines of C++, at most {ROOM}")
for (room, name), all_of in classes.items():
    for path, methods, lines in all_of:
        if len(all_of) == 1:  # of one name in several files each has its own methods
            lines += outside.get((room, name), 0)
        if methods > METHODS:
            faults.append(f"{path}: {name} has {methods} methods, at most {METHODS}")
        if lines > CLASS:
            faults.append(f"{path}: {name} has {lines} lines in all its files, at most {CLASS}")
names = {}
for file in sorted(f for f in (ROOT / "web").rglob("*") if f.suffix in (".js", ".css", ".html")):
    text, path = file.read_text(), file.relative_to(ROOT)
    lines = text.split("\n")
    if len(lines) - 1 > FILE:
        faults.append(f"{path}: {len(lines) - 1} lines, at most {FILE}")
    faults += [f"{path}:{n}: {len(line)} columns, at most {COLUMNS}" for n, line in enumerate(lines, 1) if len(line) > COLUMNS]
    if file.suffix != ".js":
        continue
    faults += [f"{path}: {name}: a function of {n} lines, at most {FUNCTION}" for name, n in functions_of(text) if n > FUNCTION]
    for name in re.findall(r"^(?:async )?(?:const|let|function|class) (\w+)", text, re.M):
        if names.setdefault((file.parent, name), path) != path and path.name != "index.js":  # a page of its own
            faults.append(f"{path}: {name} is also a name of {names[file.parent, name]}")
print("\n".join(faults))
sys.exit(f"{len(faults)} too large" if faults else 0)
