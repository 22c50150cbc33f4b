#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Another program's labels in a run: only where the user allows it, once for all anatomies, from the cache afterwards, and
# recorded in the case. As a single tool it gives the same labels.
. "$(dirname "$0")/common.sh"
: "${LABELLER:?}"
# Beside it other tests run programs as well, whose folders are theirs.
mkdir "$work/root" "$work/tmp"
export TMPDIR=$work/tmp
touch "$work/root/trephine.root"
cp -r "$SOURCE/configs/scenes" "$SOURCE/configs/materials.yaml" "$work/root/"
recipe() {  # recipe MODE VERSION
  cat >"$work/root/recipe.yaml" <<YAML
trephine: 1
anatomies:
  labeller:
    shows_face: false
    stages:
      - external:
          program: $LABELLER
          version: "$2"
          arguments: [$1, "{input}", "{output}"]
          names: {tissue: 1, bone: 2}
          time_limit_s: 600
          environment: {MODEL: "--weights=/home/private/w.pt mode=fast and/or"}
  skull:
    shows_face: false
    stages: [labels: {map: labeller.external, label: bone}, contour, decimate, smooth, normals]
  head:
    shows_face: true
    stages: [labels: {map: labeller.external, label: "tissue, bone"}, contour, decimate, smooth, normals]
YAML
}
cat >"$work/root/scene.yaml" <<'YAML'
trephine: 1
face: {policy: keep, reason: a phantom}
anatomies:
  skull: {max_deviation_mm: 3}
  head: {max_deviation_mm: 3}
YAML
cat >"$work/root/case.yaml" <<'YAML'
trephine: 1
case: labelled
pipeline: recipe.yaml
scene: scene.yaml
set: {resample.spacing_mm: [2.5, 2.5, 2.5]}
YAML
run=("$TREPHINE" run "$work/root/case.yaml" --series "$SOURCE/sample_dicom" --out "$work/out" --quiet --no-pictures --no-page)

recipe good 1.7
expect 64 'labeller\.external: runs the program ".*external_program".*--allow-external' "${run[@]}"
[[ ! -e $work/out/labelled ]] || fail "a refused run left a case"
"${run[@]}" --allow-external --keep "$work/keep" --json "$work/run.json" >"$work/said" 2>&1 || { cat "$work/said"; fail "no case of labels"; }
python3 - "$work/out/labelled/case.json" "$work/run.json" "$LABELLER" <<'PY'
import hashlib, json, sys
manifest, run = (json.load(open(f)) for f in sys.argv[1:3])
made_of = {k: v for k, v in manifest["provenance"]["parameters"].items() if k.startswith("labeller.external.")}
of = lambda name: made_of["labeller.external." + name]
assert of("program") == sys.argv[3].rpartition("/")[2] and of("arguments.0") == "good" and of("version") == "1.7", made_of
assert of("said_version") == "labeller 1.7 (test)" and len(of("output_sha256")) == 64, made_of
assert of("program_sha256") == hashlib.sha256(open(sys.argv[3], "rb").read()).hexdigest(), made_of
assert of("environment.MODEL") == "--weights=w.pt mode=fast and/or", made_of
assert "private" not in open(sys.argv[1]).read() and sys.argv[3] not in open(sys.argv[1]).read()
volumes = {a["name"]: a["volume_ml"] for a in manifest["anatomies"]}
assert 400 < volumes["skull"] < 1200 and volumes["head"] > 2.5 * volumes["skull"], volumes
stages = run["stages"]
assert stages["labeller.external"]["state"] == "computed" and stages["skull.labels"]["state"] == "computed"
PY
digest=$(case_digest "$work/out/labelled")

# The same program as a single tool on the same volume, and its labels by file.
"$TREPHINE" external "$work/keep/resample.nrrd" --program "$LABELLER" --version 1.7 --arguments=good "--arguments={input}" \
  "--arguments={output}" --names tissue=1 --names bone=2 --output "$work/labels.nrrd" --quiet 2>/dev/null
cmp "$work/labels.nrrd" "$work/keep/labeller.external.nrrd" || fail "the single tool gives other labels"
"$TREPHINE" labels "$work/keep/resample.nrrd" --map "$work/labels.nrrd" --label bone --output "$work/skull.nrrd" --quiet 2>/dev/null
cmp "$work/skull.nrrd" "$work/keep/skull.labels.nrrd" || fail "the single tool gives another skull"
expect 64 'file, and map are given|file: and map are given' "$TREPHINE" labels "$work/keep/resample.nrrd" --map "$work/labels.nrrd" \
  --file "$work/labels.nrrd" --output "$work/x.nrrd" --quiet

# From the cache, as long as the recipe says the same. Another version is another result.
"${run[@]}" --allow-external --json "$work/run.json" >"$work/said" 2>&1 || { cat "$work/said"; fail "no second run"; }
python3 - "$work/run.json" <<'PY'
import json, sys
states = {name: s["state"] for name, s in json.load(open(sys.argv[1]))["stages"].items()}
assert states["labeller.external"] != "computed", states
PY
[[ $(case_digest "$work/out/labelled") == "$digest" ]] || fail "the second run made another case"
recipe good 1.8
expect 78 'labeller\.external: version: the program says .labeller 1\.7' "${run[@]}" --allow-external
recipe partial 1.7
expect 65 'labeller\.external: labels_file: labels\.nii\.gz is no map of labels: data' "${run[@]}" --allow-external
recipe code 1.7
expect 70 'labeller\.external: program: external_program ended with code 3; its last line: no model' "${run[@]}" --allow-external
[[ $(case_digest "$work/out/labelled") == "$digest" ]] || fail "a failed run changed the case"

# Ctrl-C ends the program and all that it started.
recipe sleep 1.7
sed -i 's|"{output}"\]|"{output}", "{folder}/pid"]|' "$work/root/recipe.yaml"
interrupted "${run[@]}" --allow-external
[[ $code == 130 ]] || { cat "$work/said"; fail "Ctrl-C gave $code"; }
for try in {1..3000}; do grep -aqs "$work/tmp/trephine-external" /proc/[0-9]*/cmdline || break; sleep 0.1; done
((try < 3000)) || fail "the program outlives Ctrl-C"
[[ -z $(ls "$work/tmp") ]] || fail "Ctrl-C leaves the program's folder"

# An anatomy of labels alone has no surface that a scene could want.
recipe good 1.7
sed -i 's/  head: {max/  labeller: {max/' "$work/root/scene.yaml"
expect 78 'anatomies\.labeller: .*it gives labels and no surface' "${run[@]}" --allow-external
sed -i 's/  labeller: {max/  head: {max/' "$work/root/scene.yaml"

# A library passes the permission on, or each case is refused.
cat >"$work/root/library.yaml" <<YAML
trephine: 1
config: case.yaml
cases: [{case: one, series: series}]
YAML
ln -s "$SOURCE/sample_dicom" "$work/root/series"
library=("$TREPHINE" library build "$work/root/library.yaml" --out "$work/library" --quiet --no-pictures --root "$SOURCE")
got=0
"${library[@]}" >"$work/said" 2>&1 || got=$?
[[ $got == 64 ]] && grep -q 'say --allow-external' "$work/said" || { cat "$work/said"; fail "a library ran a program unasked ($got)"; }
"${library[@]}" --allow-external >"$work/said" 2>&1 || { cat "$work/said"; fail "no library of labels"; }
[[ -e $work/library/one/case.json ]] || fail "the library made no case"
[[ -z $(ls "$work/tmp") ]] || fail "folders of programs are left"
