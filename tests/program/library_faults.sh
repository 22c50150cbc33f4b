#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Every write, fsync, rename and opened file of a case fails in turn; the disk is full; memory is short: the old case or the new one, a
# line of why, and the next build makes it good. LONG=1: more of each. PART=builds: of builds of a library; PART=cases (case_faults.sh):
# of one case's run; PART=all: of both. library_kills.sh has what ends a build from outside.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/library_common.sh"
cd "$work/l"
: "${FAULT:?}" "${LONG:=0}" "${PART:=builds}"
"$TREPHINE" phantom "$work/l/one" $tiny_flags --seed 7 --quiet >/dev/null
printf 'trephine: 1\nconfig: c.yaml\ncases: [{case: a, series: one/dicom}, {case: b, series: one/dicom, set: {skull.smooth.iterations_count: 3}}]\n' >l.yaml
case_of() { case_digest "$work/out/$1"; }
new=(--set skull.smooth.iterations_count=7)
one=("$TREPHINE" run c.yaml --series one/dicom --out "$work/out" --case a --quiet --no-pictures --threads 1)

# The two states that there may be, and nothing else.
"${one[@]}" "${new[@]}"
made_new=$(case_of a)
"${one[@]}"
old=$(case_of a)
[[ $old != "$made_new" ]] || fail "both states are equal"
is_whole() {
  local now
  now=$(case_of a) || fail "$1: torn"
  [[ $now == "$old" || $now == "$made_new" ]] || fail "$1: neither the old case nor the new one"
}

# count KIND: how many such calls a run makes, into `calls`.
count() {
  rm -f "$work/counts"
  LD_PRELOAD=$FAULT TREPHINE_FAULT=$1:1:1 TREPHINE_FAULT_IN=run TREPHINE_FAULT_COUNT=$work/counts "${one[@]}" "${new[@]}" \
    --cache "$work/cache" >said 2>&1 || { cat said; fail "$1: the run that counts"; }
  rm -rf "$work/cache"
  calls=$(sort -n "$work/counts" | tail -1)
  [[ $calls -ge 3 ]] || fail "$1: $calls calls were counted"
}
# fault KIND ERRNO CODES: a run's first such call fails, some later one (LONG=1: every one), and one more than there are.
total=0 refused=0
fault() {
  local kind=$1 number=$2 codes=$3 n code calls points
  count "$kind"
  points=($((calls / 2)) $((calls - 1)))
  ((LONG)) && points=($(seq $((calls + 1))))
  for n in "${points[@]}"; do
    [[ $(case_of a) == "$old" ]] || "${one[@]}" 2>/dev/null || fail "the run that restores the old case"
    [[ $(case_of a) == "$old" ]] || fail "not the old case"
    code=0
    LD_PRELOAD=$FAULT TREPHINE_FAULT=$kind:$n:$number TREPHINE_FAULT_IN=run "${one[@]}" "${new[@]}" --cache "$work/cache" \
      >said 2>&1 || code=$?
    total=$((total + 1))
    is_whole "$kind $n"
    # A run that says that it failed has published nothing; but the folder's own sync comes after case.json is in its place.
    [[ $code != 74 || $(case_of a) == "$old" ]] || grep -q 'case.json: fsync of the folder' said ||
      { cat said; fail "$kind $n ends with 74, and the new case is published"; }
    [[ -z $(find "$work/out" "$work/cache" -name ".trephine-tmp-*" 2>/dev/null) ]] || fail "$kind $n: temporary files are left"
    rm -rf "$work/cache"
    [[ " $codes 0 " == *" $code "* ]] || { cat said; fail "$kind $n ends with $code"; }
    [[ $kind.$code != malloc.[67][3-46] ]] || grep -q 'Cannot allocate memory' said || { cat said; fail "$kind $n: $code without why"; }
    if [[ $code != 0 ]]; then
      refused=$((refused + 1))
      [[ $(grep -cE '^trephine( run)?: ' said) == 1 ]] || { cat said; fail "$kind $n: not one line"; }
    fi
  done
}
if [[ $PART != builds ]]; then
fault write 28 74   # ENOSPC
((!LONG)) || fault write 5 74  # EIO
fault short 0 0
fault fsync 5 74
fault rename 5 74
fault open 13 "73 74"   # EACCES
fault close 28 74
fault malloc 12 "70 66 73 74"  # the system's own calls report it as of a folder or file
"${one[@]}" "${new[@]}"
"${one[@]}"
echo "$total faults, $refused refused"

# Memory that does not suffice, at several sizes: nothing is published, or all of it.
limits=(250000 400000)
((LONG)) && limits=($(seq 100000 20000 800000))
for kb in "${limits[@]}"; do
  code=0; (ulimit -v $kb; "${one[@]}" "${new[@]}" --no-use-cache >said 2>&1) || code=$?
  is_whole "memory limit $kb"
  # 127: the loader; 134: what a library allocates before main.
  [[ $code == 134 ]] && ! grep -q '^trephine' said && grep -q 'std::bad_alloc' said && code=127
  [[ $code == 0 || $code == 70 || $code == 127 ]] || { cat said; fail "memory limit $kb: $code"; }
  [[ $code != 0 ]] || "${one[@]}"
done
fi
[[ $PART != cases ]] || exit 0

# Through a build: the case fails, the other is built, the reason is told, the next build makes it good.
build l.yaml
before=$(digests)
for fault in write+:3:28 fsync+:2:5 rename+:1:30; do
  code=0
  LD_PRELOAD=$FAULT TREPHINE_FAULT=$fault TREPHINE_FAULT_IN=a build l.yaml "${new[@]}" >said 2>&1 || code=$?
  [[ $code == 74 ]] && grep -Eq 'a +74 .*failed' said || { cat said; fail "$fault in a build: $code"; }
  is_whole "$fault"  # the new one where all was there but the last fsync, of the folder
  [[ $(grep '^b ' <<<"$before") != "$(digests | grep '^b ')" ]] || fail "$fault: case b was not built"
  build l.yaml
  [[ $before == "$(digests)" ]] || fail "$fault: not made good"
done

# In the build itself, and in what it starts for each case: at worst it stops; what is there is whole, the next one goes on.
for word in build job; do
  for kind in write fsync rename open close malloc; do
    ((LONG)) || [[ $word.$kind =~ ^(build.(rename|malloc)|job.write)$ ]] || continue
    build l.yaml || fail "the build that restores"
    rm -f "$work/counts"
    LD_PRELOAD=$FAULT TREPHINE_FAULT=$kind:1:1 TREPHINE_FAULT_IN=$word TREPHINE_FAULT_COUNT=$work/counts \
      build l.yaml "${new[@]}" >said 2>&1 || { cat said; fail "$kind in $word: the build that counts"; }
    calls=$(sort -n "$work/counts" | tail -1)
    points=($(((calls + 1) / 2)))
    ((LONG)) && points=($(seq "$calls"))
    for n in "${points[@]}"; do
      build l.yaml || fail "the build that restores"
      [[ $before == "$(digests)" ]] || fail "$kind in $word: not made good"
      code=0
      LD_PRELOAD=$FAULT TREPHINE_FAULT=$kind:$n:$([[ $kind == malloc ]] && echo 12 || echo 5) TREPHINE_FAULT_IN=$word \
        build l.yaml "${new[@]}" >said 2>&1 || code=$?
      # Where a system's own call has no memory, it is told as of the file that was to be opened.
      [[ $kind.$code == malloc.66 ]] && grep -q 'Cannot allocate memory' said && code=70
      [[ " 0 70 73 74 " == *" $code "* ]] || { cat said; fail "$kind $n in $word ends with $code"; }
      for c in a b; do case_digest "$work/out/$c" >/dev/null || fail "$kind $n in $word: case $c is torn"; done
      [[ -z $(find "$work/out" -name ".trephine-tmp-*") ]] || fail "$kind $n in $word: temporary files are left"
    done
    echo "$kind in $word: ${#points[@]} of $calls"
  done
done
build l.yaml

# A disk that is full from the first byte on (a limit on file sizes, as a full disk for all of them), for the build as for its cases.
code=0; (ulimit -f 4; build l.yaml "${new[@]}" >said 2>&1) || code=$?
[[ $code == 74 || $code == 73 ]] || { cat said; fail "file size limit: $code"; }
[[ $before == "$(digests)" ]] || fail "file size limit: a case changed"
build l.yaml
if mkdir "$work/small" && mount -t tmpfs -o size=64k none "$work/small" 2>/dev/null; then
  code=0; "$TREPHINE" library build l.yaml --out "$work/small" --quiet >said 2>&1 || code=$?
  [[ $code == 73 ]] && grep -q 'MB are free' said || { cat said; umount "$work/small"; fail "small disk: $code"; }
  code=0; "$TREPHINE" library build l.yaml --out "$work/small" --quiet --no-check-disk >said 2>&1 || code=$?
  left=$(find "$work/small" -name case.json)
  umount "$work/small"
  [[ $code == 74 || $code == 73 ]] && [[ -z $left ]] || { cat said; fail "full disk: $code $left"; }
else
  echo "no tmpfs can be mounted here: the small disk is left out"
fi
