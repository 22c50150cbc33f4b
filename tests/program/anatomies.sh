#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The examples of the reference that segment a head do so, as they stand there, on the sample, whichever way; what leaks
# says so; foreign labels keep their volume and place; landmarks that cannot be are refused.
. "$(dirname "$0")/common.sh"
here=$(cd "$(dirname "$0")" && pwd)
trephine() { "$TREPHINE" "$@"; }
cd "$work"
trephine reference --out reference
trephine import "$SOURCE/sample_dicom" --output head.nrrd --quiet

# reported NAME COMMAND...: it works; its report in report.json, its warnings in the file `stderr`.
reported() {
  "$@" --quiet --report report.json 2>stderr || { cat stderr >&2; fail "$*"; }
}
# example PAGE TEXT: the example of that page which holds the text.
example() {
  local line
  line=$(sed -n '/^## Examples/,$p' "reference/$1.md" | grep -E "^trephine $1 " | grep -F -m 1 -- "$2") ||
    fail "$1.md has no example with '$2'"
  eval "reported $line"
}
# figure NAME LEAST MOST: of report.json.
figure() {
  python3 -c 'import json, sys
value = json.load(open("report.json"))[sys.argv[1]]
print(sys.argv[1], value)
sys.exit(not float(sys.argv[2]) <= value <= float(sys.argv[3]))' "$@" || fail "$1 is not within $2 and $3"
}
silent() { [[ ! -s stderr ]] || { cat stderr >&2; fail "$1 warns"; }; }
overlap() { python3 "$here/overlap.py" "$@" || fail "$1 and $2 differ"; }

# Every method by its own thresholds; the snake by those that the reference shows.
example segment 'skull.nrrd'
example brain '--skull' && silent brain && figure volume_ml 1100 1180
example ventricles '--brain' && silent ventricles && figure volume_ml 20 21.2
cp ventricles.nrrd segment.nrrd
example presegment '--lower-hu' && silent presegment
example snake '--bubbles-count' && silent snake && figure volume_ml 20 22.5
overlap segment.nrrd ventricles.nrrd 0.9
example snake '--bubbles ' && silent snake && overlap segment.nrrd ventricles.nrrd 0.9
example presegment '--method edges'
example snake '--method geodesic' && silent snake && overlap segment.nrrd finer.nrrd 0.9

# A window that ends within the tissue leaks, and says by how much; a geodesic snake with nothing to hold it stays in the
# anatomy that presegment was given, and says that it fills it.
reported trephine presegment head.nrrd --lower-hu 0 --upper-hu 18 --within brain.nrrd --output leak.nrrd
reported trephine snake leak.nrrd --bubbles-count 2 --within brain.nrrd --output leaked.nrrd
grep -q 'at 29 % of what it holds the speed is negative' stderr || fail "a leak of 300 ml is not said"
reported trephine snake edges.nrrd --method geodesic --start segment.nrrd --output filled.nrrd
grep -Eq '[6-9][0-9] % of its surface rest on the limits' stderr || fail "that the snake fills the brain is not said"
reported trephine snake edges.nrrd --method geodesic --start segment.nrrd --within brain.nrrd --output cut.nrrd
overlap filled.nrrd cut.nrrd 0.999

# Labels on voxels twice as large.
python3 "$here/overlap.py" --halve segment.nrrd labels.nrrd
reported trephine labels head.nrrd --file labels.nrrd --output labelled.nrrd
silent labels && figure volume_change_ratio -0.005 0.005
overlap segment.nrrd labelled.nrrd 0.85

# Landmarks.
trephine segment head.nrrd --lower-hu -475 --open-mm 3 --components largest --fill cavities_and_cut --fill-close-mm 6 \
  --output skin.nrrd --quiet
points() {
  printf '# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n'
  printf '# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n'
  printf '1,%s,0,0,0,1,1,1,0,%s,,\n' "$2" "$1"
}
find_them=(trephine landmarks head.nrrd --skin skin.nrrd --skull skull.nrrd --given points.fcsv --output landmarks.json)
points Inion 0,900,0 >points.fcsv
expect 65 'landmarks: points.fcsv: inion: .*lies 8[0-9][0-9] mm outside of the skin' "${find_them[@]}" --quiet
points Naison 0,-93.2,40.1 >points.fcsv
reported "${find_them[@]}"
grep -q 'naison is none of the landmarks that are looked for, did you mean nasion?' stderr || fail "Naison is taken"

# A constant image holds no anatomy, though others do.
python3 - <<'PY'
data = open("head.nrrd", "rb").read()
at = data.index(b"\n\n")
head = [line for line in data[:at].decode().split("\n")]
size = 1
for n in next(line for line in head if line.startswith("sizes:")).split()[1:]:
    size *= int(n)
head = ["encoding: raw" if line.startswith("encoding:") else line for line in head]
assert "type: int16" in head or "type: short" in head, head
open("constant.nrrd", "wb").write("\n".join(head).encode() + b"\n\n" + (40).to_bytes(2, "little") * size)
PY
expect 80 'brain: volume: every voxel is 40 HU' trephine brain constant.nrrd --skull skull.nrrd \
  --output none.nrrd --quiet
expect 80 'landmarks: volume: every voxel is 40 HU' trephine landmarks constant.nrrd --skin skin.nrrd --skull skull.nrrd \
  --output none.json --quiet
expect 80 'deface: volume: every voxel is 40 HU' trephine deface constant.nrrd --skin skin.nrrd \
  --landmarks landmarks.json --output none.nrrd --quiet
expect 64 'ventricles: lower_hu: 20 is above upper_hu, 18.5' trephine ventricles head.nrrd --lower-hu 20 \
  --brain brain.nrrd --output none.nrrd --quiet
expect 64 'roi_min_mm, roi_max_mm: 5 to 4 mm along y' trephine segment head.nrrd --roi-min-mm 0,5,0 --roi-max-mm 9,4,9 \
  --output none.nrrd --quiet
expect 80 'lower_hu, upper_hu: the mask is empty' trephine segment head.nrrd --lower-hu 30000 --output none.nrrd --quiet
[[ ! -e none.nrrd && ! -e none.json ]] || fail "what was refused left a file"
echo ok
