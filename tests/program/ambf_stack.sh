#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# D27. A case for AMBF: read by PyYAML, Pillow and VTK (ambf_stack.py); a stack drilled there, read back as labels, and judged.
. "$(dirname "$0")/common.sh"
: "${WRITE_CASE:?}" "${SIM:?}"
python=
for p in python3 /usr/bin/python3; do
  "$p" -c 'import numpy, yaml, PIL, vtkmodules' 2>/dev/null && { python=$p; break; }
done
[[ -n $python ]] || skip "no python3-vtk9, python3-numpy, python3-yaml and python3-pil"
cd "$work"
check() { "$python" "$SOURCE/tests/program/ambf_stack.py" "$@" || fail "ambf_stack.py $*"; }
export_() { "$TREPHINE" export --quiet "$@" 2>>log || { cat log >&2; fail "export $*"; }; }
read_back() { # CASE STACK NAME
  "$TREPHINE" drilled "$1" "$2" --out "$3.seg.nrrd" --report "$3.report.json" --quiet 2>>log || { cat log >&2; fail "drilled $2"; }
}
score() { # NAME: of the head
  "$SIM" score-drilled "$1.seg.nrrd" --case head --rubric rubric.json --participant r-01 --json "$1.score.json" --log attempts.csv "${@:2}" \
    >table 2>>log || { cat log >&2; fail "score-drilled $1"; }
}

whole_scene() { # KIND
  "$WRITE_CASE" $1 $1
  export_ $1 --format ambf --name $1 --out ADF
  check scene $1 ADF/$1.ambf "$SOURCE"
}
whole_scene head
whole_scene play
export_ play --format ambf --name left --ambf-view left --out views
check scene play views/left.ambf "$SOURCE" left >/dev/null

# The same bytes, with other threads; pictures of a longer stack before are gone, and what else lies there stays.
cp -r ADF/head.ambf ADF/again.ambf
touch ADF/again.ambf/volume/notes.txt
export_ play --format ambf --name again --threads 1 --out ADF
[[ -e ADF/again.ambf/volume/notes.txt ]] && rm ADF/again.ambf/volume/notes.txt
diff -r ADF/play.ambf ADF/again.ambf || fail "two exports differ"

# Nothing was drilled.
read_back head ADF/head.ambf/volume untouched
"$TREPHINE" rubric "$SOURCE/configs/rubrics/ventriculostomy.yaml" --output rubric.json --quiet
score untouched
grep -q '^Burr hole placement.* 1 .*no hole was drilled' table || fail "a hole in nothing: $(cat table)"

# A hole at Kocher's point, voxel for voxel; where it is and how large, by the lesson's own functions.
kocher() { "$python" -c 'import json,sys; print(*(p["position_mm"] for p in json.load(open("head/case.json"))["landmarks"] if p["name"] == sys.argv[1]), sep="")' "$1" | tr -d '[] '; }
check drill head ADF/head.ambf "$SOURCE" right "$(kocher kocher_right)" 7
read_back head right right
check labels head ADF/head.ambf "$SOURCE" right.seg.nrrd right
read_back head right_named named
cmp right.seg.nrrd named.seg.nrrd || fail "other names of the pictures give other labels"
score right --page right.html
grep -q 'MEASURED on the volume as another program drilled it' table || fail "not said what it is: $(cat table)"
grep -q '^Burr hole placement.* 5 .*at Kocher' table || fail "not at Kocher's point: $(cat table)"
for row in Anatomy Trajectory Depth Final Time Passes; do grep -q "^$row.*not judged.*a drilled volume does not show it" table || fail "$row: $(cat table)"; done
"$python" - right.score.json right.json right.report.json <<'PY' || fail "the hole"
import json, sys
import numpy as np
score, truth, report = (json.load(open(f)) for f in sys.argv[1:])
facts = score["facts"]
assert facts["from_volume"] and score["checked"] == "measured" and facts["procedure_s"] is None
assert len(facts["holes"]) == 1 and facts["hole"]["through"], facts["holes"]
axis, found = np.array(truth["axis"]), (np.array(facts["hole"]["outer_mm"]) + facts["hole"]["inner_mm"]) / 2
off = found - truth["at_mm"]
across, along = np.linalg.norm(off - axis * (off @ axis)), abs((found - truth["bone_middle_mm"]) @ axis)
turned = np.degrees(np.arccos(min(1, np.array(facts["hole"]["out"]) @ axis)))
figures = report
assert figures["removed_mm3"] == truth["mm3"], (figures, truth)
for name, least in truth["at_least"].items():
    assert figures[name + ".removed_count"] >= least, name
bone = facts["hole"]["removed_mm3"]
print(f"the hole's middle {across:.3f} mm beside the line that was drilled and {along:.3f} mm along it, {turned:.2f} degrees off; "
      f"{figures['removed_mm3']:.1f} mm3 removed, of bone {bone:.1f} ({figures['skull.removed_mm3']:.1f} as shown)")
assert across < 0.25 and along < 0.45 and turned < 1 and abs(bone - figures["skull.removed_mm3"]) / bone < 0.1
PY
score right
[[ $(wc -l <attempts.csv) == 3 ]] || fail "one volume is two attempts: $(cat attempts.csv)"
score right --task left
grep -q '^Burr hole placement.* 1 .*placed on the other side' table || fail "another side: $(cat table)"
mkdir results && cp right.score.json results/r-01.json
"$SIM" group results --page group.html >/dev/null 2>>log || fail "no group reads it"
if grep -l "$work" right.html right.score.json; then fail "a path is in it"; fi

# The example drills as anybody could, by the scene's own files.
example() { "$python" "$SOURCE/examples/ambf_stack/drill_ball.py" "$@" || fail "the example: $*"; }
example ADF/head.ambf landmark_kocher_left 34 ball >ball.txt
read_back head ball ball
score ball
grep -q '^Burr hole placement.*at Kocher' table || fail "the example's hole: $(cat table)"
[[ $("$python" -c 'import json; print("%.1f" % json.load(open("ball.report.json"))["removed_mm3"])') == "$(grep -o '[0-9.]* mm3' ball.txt | cut -d' ' -f1)" ]] ||
  fail "another volume: $(cat ball.txt)"
[[ $(wc -l <"$SOURCE/examples/ambf_stack/drill_ball.py") -lt 60 ]] || fail "the example is too long"

# What is no drilled stack of this case.
refused() { expect "$1" "$2" "$TREPHINE" drilled head "$3" --out no.seg.nrrd --quiet; }
cp -r right few && rm few/plane00215.png && refused 65 'few: pictures: must be 216 PNG files' few
cp -r right gap && mv gap/plane00100.png gap/plane00300.png && refused 65 'gap: pictures: must be 216' gap
cp -r right twice && cp twice/plane007.png twice/other_7.png && refused 65 'its number is that of another picture' twice
cp -r right unnamed && cp unnamed/plane007.png unnamed/plane.png && refused 65 'ends in no number' unnamed
refused 65 'must be 216 PNG files' ADF/play.ambf/volume
refused 66 'STACK: not found' none
expect 64 '^trephine export: --anatomy: .*whole haptic volume' "$TREPHINE" export head --format ambf --anatomy skull --out no --quiet
[[ ! -e no ]] || fail "an export that was refused wrote something"
"$python" - <<'PY'
import shutil
from PIL import Image
def changed(name, change, n=108):
    shutil.copytree("right", name)
    p = Image.open(f"right/plane00{n}.png")
    change(p).save(f"{name}/plane00{n}.png")
def put(p, at, rgba):
    p = p.copy()
    p.putpixel(at, rgba)
    return p
changed("small", lambda p: p.resize((215, 216)))
changed("colour", lambda p: put(p, (108, 108), (1, 2, 3, 255)))
changed("more", lambda p: put(p, (0, 0), (255, 249, 219, 255)))
changed("half", lambda p: put(p, (108, 108), p.getpixel((108, 108))[:3] + (128,)))
changed("turned", lambda p: p.transpose(Image.FLIP_TOP_BOTTOM), 60)
PY
refused 65 'small/plane00108.png: has 215 x 216 pixels' small
refused 65 'colour/plane00108.png: pixels: column 108, row 108' colour
refused 65 'more/plane00108.png: pixels: column 0, row 0' more
refused 65 'half/plane00108.png: pixels: column 108' half
cp -r right broken && head -c 300 right/plane0050.png >broken/plane0050.png && refused 65 'broken/plane0050.png: ' broken
cp -r right text && echo "no picture" >text/plane0050.png && refused 65 'text/plane0050.png: ' text
[[ ! -e no.seg.nrrd ]] || fail "something of a refused stack is there"

# Labels of another case, of another lesson, and no such labels.
read_back play ADF/play.ambf/volume other
expect 65 'other.seg.nrrd: lattice: is not that' "$SIM" score-drilled other.seg.nrrd --case head --rubric rubric.json --participant r-01
"$python" -c 'd = open("right.seg.nrrd", "rb").read(); e = d.replace(b"space origin: (-96.75,", b"space origin: (-96.25,"); assert e != d; open("moved.seg.nrrd", "wb").write(e)'
expect 65 'moved.seg.nrrd: lattice: is not that' "$SIM" score-drilled moved.seg.nrrd --case head --rubric rubric.json --participant r-01
"$python" -c 'import gzip
head, v = open("right.seg.nrrd", "rb").read().split(b"\n\n", 1)
v = bytearray(gzip.decompress(v))
assert v[0] == 0
v[0] = 3
open("more.seg.nrrd", "wb").write(head + b"\n\n" + gzip.compress(v))'
expect 65 'more.seg.nrrd: voxels: are not those that the case shows' "$SIM" score-drilled more.seg.nrrd --case head --rubric rubric.json --participant r-01
"$TREPHINE" rubric "$SOURCE/configs/rubrics/pedicle_screw.yaml" --output screw.json --quiet
expect 64 'of which a drilled volume is not judged' "$SIM" score-drilled right.seg.nrrd --case head --rubric screw.json --participant r-01
expect 64 'participant' "$SIM" score-drilled right.seg.nrrd --case head --rubric rubric.json --participant 'A Name'

long_only

# A tool of theirs removes brain, too: that is said, and not judged.
example ADF/head.ambf target_monro_right 10 brain >/dev/null
read_back head brain brain
"$SIM" score-drilled brain.seg.nrrd --case head --rubric rubric.json --participant r-01 >table 2>said || fail "brain: $(cat said)"
grep -Eq 'brain: [0-9.]+ mm3 were removed, and no tool of the simulator removes it: not judged' said || fail "brain: $(cat said)"
grep -q '^Burr hole placement.* 1 .*no hole was drilled' table || fail "a hole in brain is one in bone: $(cat table)"

# Other cases, and the other views.
for kind in drill spine; do whole_scene $kind; done
for view in posterior right superior; do
  export_ play --format ambf --name $view --ambf-view $view --out views
  check scene play views/$view.ambf "$SOURCE" $view >/dev/null
done
