#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# docs/build_site.sh OUT [REFERENCE]: the pages as a site to browse, OUT/index.html first. REFERENCE is what the build made of the commands,
# build/release/docs/reference where it is not given. Needs mkdocs; without it the exit code is 77.
# A link that leads nowhere is an error. The same pages give the same bytes: the site holds no time.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
(($# == 1 || $# == 2)) || { echo "usage: docs/build_site.sh OUT [REFERENCE]" >&2; exit 64; }
reference=${2:-$root/build/release/docs/reference}
command -v mkdocs >/dev/null || { echo "skipped: no mkdocs; install it with: apt install mkdocs" >&2; [[ ${TREPHINE_CHECK:-} != 1 ]] || exit 1; exit 77; }
for program in trephine trephine-sim; do
  [[ -e $reference/$program/index.md ]] || { echo "$reference/$program is missing: build Trephine first, which makes it" >&2; exit 66; }
done
mkdir -p "$1"
out=$(cd "$1" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Pages as mkdocs wants them: in one folder, with the files of the repository that they link to beside them.
python3 - "$root" "$work" "$out" "$reference" <<'PY'
import re, shutil, sys
from pathlib import Path
root, work = Path(sys.argv[1]), Path(sys.argv[2])
pages = work / "pages"
shutil.copytree(root / "docs", pages, ignore=shutil.ignore_patterns("*.sh", "*.js"))
shutil.copytree(sys.argv[4], pages / "reference", dirs_exist_ok=True)
tops = {"README.md": "index.md", "CONTRIBUTING.md": "CONTRIBUTING.md", "CHANGELOG.md": "CHANGELOG.md"}
for name, page in tops.items():
    shutil.copy(root / name, pages / page)

def moved(source, page, link):
    """The link of `source`, a file of the repository, as the site's `page` has it."""
    name, mark, anchor = link.partition("#")
    if not name or re.match(r"[a-z][a-z0-9+.-]*:", link):
        return link
    target = (source.parent / name).resolve().relative_to(root)
    if target.parts[0] == "docs":
        place = Path(*target.parts[1:])
    elif str(target) in tops:
        place = Path(tops[str(target)])
    else:  # a source or a licence: a copy of it, as text
        place = Path("files") / (str(target) if target.suffix in (".c", ".h", ".cpp") else f"{target}.txt")
        (pages / place).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(root / target, pages / place)
    up = len(page.relative_to(pages).parts) - 1
    return "../" * up + str(place) + mark + anchor

for page in pages.glob("**/*.md"):
    if page.is_relative_to(pages / "files"):
        continue
    name = str(page.relative_to(pages))
    source = root / {v: k for k, v in tops.items()}.get(name, "docs/" + name)
    text = (source if source.exists() else page).read_text(encoding="utf-8")  # the reference has no source here
    text = re.sub(r"(\]\()([^)\s]+)(\))", lambda m: m[1] + moved(source, page, m[2]) + m[3], text)
    # Lists without an empty line before them are lists on GitHub, but not to mkdocs.
    text = re.sub(r"(?m)^(?!\s*(?:[-*|#>]|\d+\.)|\s*$|```)(.*)\n(?=(?:[-*]|\d+\.) )", r"\1\n\n", text)
    page.write_text(text, encoding="utf-8")

config = []
for line in (root / "mkdocs.yml").read_text(encoding="utf-8").splitlines():
    entry = re.match(r"(\s*)- (.*): (\S+)/$", line)
    if not entry:
        config.append(line)
        continue
    config.append(f"{entry[1]}- {entry[2]}:")
    listed = re.findall(r"\]\(([a-z_0-9-]+\.md)\)", (pages / entry[3] / "index.md").read_text(encoding="utf-8"))
    rest = sorted(p.name for p in (pages / entry[3]).glob("*.md") if p.name not in listed and p.name != "index.md")
    config += [f"{entry[1]}    - {entry[3]}/{name}" for name in ["index.md", *listed, *rest]]
config += [f"docs_dir: {pages}", f"site_dir: {sys.argv[3]}", ""]
(work / "mkdocs.yml").write_text("\n".join(config), encoding="utf-8")
PY

SOURCE_DATE_EPOCH=0 mkdocs build --strict --clean --config-file "$work/mkdocs.yml" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
rm -f "$out"/sitemap.xml "$out"/sitemap.xml.gz  # dates, and links of a server that there is not
sed -i -z 's/<!--\nMkDocs version : [^\n]*\nBuild Date UTC : [^\n]*\n-->\n//' "$out/index.html"
# The search works from a folder too: docs/search.js, and the index as a script, a section a line.
python3 - "$out/search" <<'PY'
import json, sys
from pathlib import Path
folder = Path(sys.argv[1])
docs = json.loads((folder / "search_index.json").read_text(encoding="utf-8"))["docs"]
pages = {d["location"]: d["title"] for d in docs if "#" not in d["location"]}
# A page's own entry repeats its sections: only pages without sections keep theirs.
parted = {d["location"].partition("#")[0] for d in docs if "#" in d["location"]}
lines = [json.dumps([d["location"], pages[d["location"].partition("#")[0]], d["title"], d["text"]], ensure_ascii=False)
         for d in docs if "#" in d["location"] or d["location"] not in parted]
(folder / "index.js").write_text("window.search_sections = [\n" + ",\n".join(lines) + "\n];\n", encoding="utf-8")
PY
rm -f "$out"/search/{search_index.json,lunr.js,worker.js}
cp "$root/docs/search.js" "$out/search/main.js"
python3 "$root/tests/house/links.py" --site "$out"
