#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# guard.sh ROOT: bench/guard tells a worse program from a better one and from itself; the programs are stand-ins.
set -euo pipefail
guard=$1/bench/guard
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# stand_in NAME TRIANGLES MM [STEP THAT FAILS]: does what the guard asks, and measures as told in its results.
stand_in() {
  cat > "$work/$1" <<EOF
#!/bin/bash
case "\$1" in
  phantom) mkdir -p "\$2/dicom" "\$2/truth"; echo {} > "\$2/truth/truth.json" ;;
  measure) cp "\$2" "\$4" ;;
  ${4:-none}) exit 80 ;;
  help) ;;
  *) while [ "\${1:---output}" != --output ]; do shift; done
     echo '{"triangles_count": $2, "deviation_rms_mm": $3}' > "\$2" ;;
esac
EOF
  chmod +x "$work/$1"
}

# expect STATUS WORD PROGRAM PROGRAM: the guard's exit status and what it says.
expect() {
  local status=0
  "$guard" "$work/$3" "$work/$4" --repeats 7 --work "$work" > "$work/said" || status=$?
  [ "$status" = "$1" ] && grep -q -- "$2" "$work/said" && return
  echo "$3 against $4: exit $status, expected $1 and '$2':"
  cat "$work/said"
  exit 1
}

stand_in same 1000 0.1
stand_in triangles 1100 0.1
stand_in further 1000 0.2
stand_in nearer 1000 0.05
stand_in fails 1000 0.1 smooth
expect 0 "nothing moved beyond noise" same same
expect 1 "contour skull .*triangles_count .*+10.0 %.* WORSE" same triangles
expect 1 "segment brain .*deviation_rms_mm .*WORSE" same further
expect 0 "segment brain .*deviation_rms_mm .*better" same nearer
expect 1 "smooth skull .*head: no" same fails
expect 0 "smooth skull .*base: no, head: yes" fails same

# Instructions: works of two names, and a valgrind that counts what their program says. The memory is that of bash.
mkdir "$work/bin"
cat > "$work/bin/valgrind" <<'EOF'
#!/bin/bash
while [[ $1 == --* ]]; do shift; done
echo "==7== I   refs:      $("$1" count "$2")" >&2
EOF
works_of() {  # works_of NAME COUNT OF BEND
  printf '#!/bin/bash\ncase "$1" in "") echo bend; echo fold ;; count) [ "$2" = bend ] && echo "%s" || echo 1,000,000 ;; esac\n' "$2" \
    > "$work/$1"
  chmod +x "$work/$1"
}
chmod +x "$work/bin/valgrind"
# expect_count STATUS WORD PROGRAM [FLAG]
expect_count() {
  local status=0
  PATH=$work/bin:$PATH "$guard" --instructions "$work/$3" "$work/base.json" "${@:4}" > "$work/said" 2>&1 || status=$?
  [ "$status" = "$1" ] && grep -q -- "$2" "$work/said" && return
  echo "instructions of $3: exit $status, expected $1 and '$2':"
  cat "$work/said"
  exit 1
}
works_of usual 2,000,000
works_of little_more 2,099,000
works_of more 2,101,000
expect_count 0 "base.json: written" usual --write
expect_count 0 "bend .*instructions .*+0.0 %" usual
expect_count 0 "bend .*instructions .*+5.0 %$" little_more
expect_count 1 "bend .*instructions .*+5.[01] %  WORSE" more
sed -i 's/"memory_mb": [0-9.]*/"memory_mb": 0.5/' "$work/base.json"
expect_count 1 "fold .*memory_mb .*WORSE" usual
sed -i 's/fold/twist/' "$work/base.json"
expect_count 70 "has other works (bend, twist)" usual
echo "the guard tells them apart"
