#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# include_directions.sh ROOT: a module of lib/ includes only itself and modules that stand before it in lib/CMakeLists.txt;
# the simulator only what an exported case needs, and cli for its command line; a third-party library's headers stay in
# the module that owns it, and out of every header that another module can see. Nothing but the command compare includes
# simulator/peers. A lesson (a folder of simulator/lessons that holds a *_lesson.cpp) is included by nobody else; a rubric
# includes lib/lesson and lib/base alone, for `trephine` links it; tools/ include nothing else of the simulator than the list of rubrics.
set -u
root=$1
cd "$root" || exit 2
faults=0
fault() { echo "$1"; faults=$((faults + 1)); }

read -ra order <<< "$(sed -n 's/^foreach(module \(.*\))$/\1/p' lib/CMakeLists.txt)"
[ ${#order[@]} -ge 2 ] || { echo "lib/CMakeLists.txt: no list of modules found"; exit 1; }
declare -A rank
for i in "${!order[@]}"; do rank[${order[$i]}]=$i; done

# library: what its includes look like, and who may have them
owners=(
  'itk[A-Z]|itk_|itk'
  'vtk[A-Z]|vtk_|meshing meshio simulator'
  'CGAL/|meshing metrics boolean tetra'
  'gdcm|codecs'
  'yaml-cpp/|config'
  'CLI/|cli'
  'tiny_gltf|cases'
  'assimp/|meshio'
  'png\.h|picture ambf'
  'meshoptimizer|simulator'
  'boost/beast|desk simulator'
)
foreign='(itk[A-Z]|vtk[A-Z]|CGAL/|gdcm|yaml-cpp/|CLI/|tiny_gltf|assimp/|meshoptimizer|png\.h|zlib\.h|tbb/|oneapi/|openssl/|Eigen/|boost/)'

# Lines "file|included" of every include below the given folders.
includes() {
  find "$@" -type f \( -name '*.h' -o -name '*.cpp' \) -print0 2>/dev/null | sort -z |
    xargs -0 -r grep -HoE '^[[:space:]]*#[[:space:]]*include[[:space:]]*[<"][^>"]+' |
    sed -E 's/^([^:]*):[^<"]*[<"]/\1|/'
}

declare -A seen  # headers that another module can see
own=()           # "header|header of the same module that it includes"
while IFS='|' read -r file included; do
  from=${file#lib/} from=${from%%/*}  # lib/grid/a.cpp: grid, simulator/x/a.cpp: simulator
  to=${included%%/*}
  if [[ $from == simulator ]]; then
    case $to in
      base | json | cli | grid | surface | voxel | contact | cases | lesson) ;;
      *) [[ -n ${rank[$to]+x} && $included == */* && -e lib/$included ]] && fault "$file: the simulator may not include $included" ;;
    esac
  elif [[ $file == lib/* && -z ${rank[$from]+x} ]]; then
    fault "$file: module $from is not in lib/CMakeLists.txt"
  elif [[ $file == lib/* && -n ${rank[$to]+x} && $included == */* && ${rank[$to]} -gt ${rank[$from]} ]]; then
    fault "$file: $from may not include $included: $to comes after it in lib/CMakeLists.txt"
  fi
  if [[ $included =~ ^lessons/([^/]+)/ && -n $(find "simulator/lessons/${BASH_REMATCH[1]}" -name '*_lesson.cpp' 2>/dev/null) ]]; then
    [[ $file == simulator/lessons/${BASH_REMATCH[1]}/* ]] || fault "$file: $included belongs to a lesson, which nobody else includes"
  elif [[ $included == lessons/*/* && $file == simulator/* && $file != simulator/lessons/*/* ]]; then
    fault "$file: $included is of some lessons alone"
  fi
  if [[ $included == peers/* && $file != simulator/peers/* && $file != simulator/commands/compare* ]]; then
    fault "$file: $included is for the command compare alone, the runtime does not know it"
  fi
  if [[ $file == simulator/lessons/*/*_rubric.* && $included == */* ]]; then
    case $included in
      lesson/* | base/* | lessons/rubric_types.h | lessons/*/*_rubric.h) ;;
      *) fault "$file: a rubric may include lib/lesson and lib/base alone, not $included" ;;
    esac
  fi
  [[ $file == tools/* && $included == */* && -e simulator/$included && ! -e lib/$included && $included != lessons/rubric_types.h ]] &&
    fault "$file: tools/ may include nothing of the simulator but lessons/rubric_types.h, not $included"
  [[ $from != "$to" && -e lib/$included ]] && seen[lib/$included]=1
  [[ $from == "$to" && $file == *.h ]] && own+=("$file|lib/$included")
  for owner in "${owners[@]}"; do
    allowed=${owner##*|}
    pattern=${owner%|*}
    if [[ $included =~ ^($pattern) && ! " $allowed " == *" $from "* ]]; then
      fault "$file: only $allowed may include $included"
    fi
  done
done < <(includes lib simulator tools)

for pass in 1 2 3 4 5; do
  for pair in "${own[@]}"; do [[ -n ${seen[${pair%|*}]+x} ]] && seen[${pair#*|}]=1; done
done
while IFS='|' read -r file included; do
  [[ -n ${seen[$file]+x} && $included =~ ^$foreign ]] && fault "$file: other modules see this header; it may not include $included"
done < <(includes lib)

[ "$faults" -eq 0 ] || { echo "$faults wrong includes"; exit 1; }
