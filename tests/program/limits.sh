#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Limits that hold and are named: of file sizes, descriptors, memory, time and messages; requests to stop that come early; paths that
# lead nowhere.
. "$(dirname "$0")/common.sh"
cd "$work"
mkdir plain && cp "$SOURCE"/sample_dicom/* plain/

# A limit on file sizes is an I/O error, also where a child meets it, and no death by a signal.
for blocks in 0 20; do
  code=0
  said=$(ulimit -f $blocks; exec "$TREPHINE" import plain --output v.nrrd --quiet 2>&1) || code=$?
  [[ $code == 74 ]] || fail "ulimit -f $blocks: $code: $said"
  [[ ! -e v.nrrd && -z $(find . -name '.trephine-tmp-*') ]] || fail "ulimit -f $blocks: something is left"
done
# Nor is it one where nothing but the message is too long for it.
code=0; (ulimit -f 0; exec "$TREPHINE" import nowhere --output v.nrrd >stdout 2>stderr) || code=$?
[[ $code == 66 || $code == 74 ]] || fail "ulimit -f 0 and messages in a file: $code"

# Too few descriptors: told, and no slice is passed over.
for n in 8 12 16; do
  code=0; (ulimit -n $n; exec "$TREPHINE" import plain --output v.nrrd --quiet --threads 2) >said 2>&1 || code=$?
  if [[ $code == 0 ]]; then
    "$TREPHINE" import plain --output w.nrrd --quiet
    cmp -s v.nrrd w.nrrd || fail "ulimit -n $n: another volume"
    rm v.nrrd w.nrrd
  else
    grep -Eqi 'descriptor|too many open files|cannot be started|shared librar|shared object' said || { cat said; fail "ulimit -n $n: $code, not told"; }
  fi
done

# Stopped while the program is being made ready: 130, or done. Nothing else.
python3 - "$TREPHINE" <<'PY'
import signal, subprocess, sys, time
for number in (signal.SIGINT, signal.SIGTERM):
    early = 0
    for n in range(500):
        if n >= 20 and early > 0:
            break  # a busy machine rarely sends it in time
        p = subprocess.Popen([sys.argv[1], "help"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while p.poll() is None:
            try:
                caught = next(l for l in open(f"/proc/{p.pid}/status") if l.startswith("SigCgt:"))
            except (OSError, StopIteration):
                break
            if int(caught.split()[1], 16) >> (number - 1) & 1 and "python" not in open(f"/proc/{p.pid}/comm").read():
                break
        p.send_signal(number)
        code = p.wait()
        assert code in (0, 130), (number, code)
        early += code == 130
    assert early > 0, "never met it early"
PY

# A bound by hand for decimation is not the surface's, which is smoothed afterwards: told, with what bounds the whole, which does.
bounded() {
  "$TREPHINE" run "$SOURCE/configs/ct_skull.yaml" --series plain --out bounds --no-pictures --no-page "${coarse[@]}" \
    --set scene.anatomies.skull.max_triangles=0 --set skull.contour.within_mm=0 --set "$1" >said 2>&1 || { cat said; fail "$1"; }
}
bounded skull.decimate.max_deviation_mm=0.5
grep -q 'skull: deviates by 0\.5[0-9]* mm, though skull.decimate.max_deviation_mm is 0.5: .* set scene.anatomies.skull.max_deviation_mm = 0.5' said ||
  { cat said; fail "a bound that was not had is not told"; }
# Deviations are those from the surface on the voxels of the run: what coarser voxels lost is not in them, which is said.
((LONG == 1)) || grep -q 'good; on voxels of 2.5 x 2.5 x 2.5 mm, [0-9]* % of the scan.s: the deviations leave out' said ||
  { cat said; fail "coarser voxels are not told"; }
# What needs more memory than there is is refused before anything is taken.
python3 - <<'PY'
with open("huge.nrrd", "wb") as f:
    head = (b"NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 9000 9000 9000\n"
            b"space directions: (1,0,0) (0,1,0) (0,0,1)\nendian: little\nencoding: raw\nspace origin: (0,0,0)\n\n")
    f.write(head)
    f.truncate(len(head) + 2 * 9000**3)
with open("keys.yaml", "w") as f:
    f.write("trephine: 1\n" + "".join(f"k{i}: {i}\n" for i in range(70000)))
with open("wide.ply", "w") as f:
    f.write("ply\nformat ascii 1.0\nelement vertex 1\n" + "".join(f"property float p{i}\n" for i in range(100000)) +
            "element face 0\nproperty list uchar int vertex_indices\nend_header\n" + "0 " * 100000 + "\n")
PY
expect 70 'needs about [0-9.]+ GB, [0-9.]+ GB are available' timeout 600 "$TREPHINE" contour huge.nrrd --output s.vtp --quiet
rm huge.nrrd
code=0; timeout 600 "$TREPHINE" run keys.yaml --out out >said 2>&1 || code=$?
[[ $code == 78 && $(wc -l <said) == 21 ]] || { head -c 3000 said; fail "70,000 unknown keys: $code, $(wc -l <said) lines"; }
grep -q 'more faults are not listed' said || fail "does not say how many more"
expect 65 'property: [0-9]+( or more)?, at most 1000' timeout 600 "$TREPHINE" repair wide.ply --output s.vtp --quiet

# A soup that takes long hears of a request to stop, and of its limit.
python3 - <<'PY'
import math
with open("soup.obj", "w") as f:
    n = 300
    for i in range(n):
        for j in range(2 * n):
            a, b = math.pi * i / (n - 1), math.pi * j / n
            f.write(f"v {20*math.sin(a)*math.cos(b):.4f} {20*math.sin(a)*math.sin(b):.4f} {20*math.cos(a):.4f}\n")
    for i in range(n - 1):
        for j in range(2 * n):
            a, b = i * 2 * n + j + 1, i * 2 * n + (j + 1) % (2 * n) + 1
            f.write(f"f {a} {b} {b + 2*n}\nf {a} {b + 2*n} {a + 2*n}\n")
    for i in range(30000):
        f.write("f 5 70000 150000\n")
PY
interrupted "$TREPHINE" repair soup.obj --output s.vtp --recontour-voxels-count 900 --quiet
[[ $code == 130 ]] || { cat "$work/said"; fail "Ctrl-C of a repair: $code"; }
expect 70 'total_limit_s' timeout 600 "$TREPHINE" repair soup.obj --output s.vtp --recontour-voxels-count 900 --total-limit-s 1 --quiet
expect 70 'total_limit_s' timeout 600 "$TREPHINE" measure soup.obj --reference soup.obj --sample-count 100000000 --total-limit-s 1 --quiet

# Memory is asked for before it is taken, and the message says how much there would have to be.
"$TREPHINE" import plain --output m.nrrd --quiet
expect 70 'needs about .* GB' bash -c 'ulimit -v 3000000; exec "$0" "$@"' \
  "$TREPHINE" resample m.nrrd --spacing-mm 0.16,0.16,0.16 --output fine.nrrd --quiet
"$TREPHINE" contour m.nrrd --output m.vtp --isovalue-hu 300.5 --quiet
expect 70 'needs about .* GB' "$TREPHINE" remesh m.vtp --edge-mm 0.001 --output fine.vtp --quiet
[[ ! -e fine.nrrd && ! -e fine.vtp ]] || fail "something is left of what needs too much memory"

# Links in a circle, and names that are too long.
ln -s loop loop
long=$(printf 'n%.0s' {1..300})
deep=$(printf 'd/%.0s' {1..3000})
for path in loop loop/x "$long" "$deep/x"; do
  for command in "run $path --out out" "import $path --output v.nrrd" "contour $path --output s.vtp" "library build $path --out out"; do
    code=0; "$TREPHINE" $command >said 2>&1 || code=$?
    [[ $code == 66 || $code == 78 || $code == 64 ]] || { head -c 400 said; fail "${command:0:60}: $code"; }
  done
done
code=0; "$TREPHINE" run "$SOURCE/configs/sample.yaml" --out "$work/loop/out" >said 2>&1 || code=$?
[[ $code == 73 ]] || { head -c 400 said; fail "an output folder below links in a circle: $code"; }

long_only

bounded scene.anatomies.skull.max_deviation_mm=0.5
if grep -q 'deviates by' said; then fail "the bound of the whole is exceeded"; fi
grep -Eq "^skull .* 0\\.[34][0-9]+ " said || { cat said; fail "the bound of the whole"; }

# What a run will take of memory is said when its scan is known. Where that is more than there is, the voxels that are named fit.
little() { (ulimit -v 450000; "$TREPHINE" run "$SOURCE/configs/ct_head.yaml" --series plain --out little --no-pictures --no-page "$@") >said 2>&1 || true; }
little
larger=$(sed -n 's/^warning: .*: about 4[0-9]0 MB of memory by estimate, .* available: end other programs, or .*`--set \(resample[^`]*\)`$/\1/p' said)
[[ -n $larger ]] || { cat said; fail "too little memory is not told"; }
little --set "$larger"
grep -q '^about [12][0-9]0 MB of memory by estimate, [0-9.]* MB are available$' said || { cat said; fail "the remedy $larger"; }
echo ok
