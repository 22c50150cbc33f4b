#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# anatomies.sh ROOT: no source of lib/pipeline, lib/publish and lib/library names an anatomy or a landmark: which there are,
# and what is done with each, stands in recipes, configurations and the declarations of stages. The names are those of the
# anatomies in pipelines/*.yaml and of the landmarks that a stage declares (s.points), without left, right and the
# like, which are directions, and other. A name is found in a string literal as a whole word with a quote, a
# dot or an underscore on at least one side ("skull", "mesh.skull.", "ventricles_ml"). Comments do not count, nor do words
# of a sentence and names of included files.
set -u
cd "$1" || exit 2
names=$({
  cat pipelines/*.yaml | perl -ne '$in = /^anatomies:/ if /^\w/; print "$1\n" if $in && /^  (\w+):/'
  cat lib/stages/*_stage.cpp | perl -0777 -ne 'while (/s\.points = \{(.*?)\};/gs) { my $p = $1; print "$1\n" while $p =~ /\{"(\w+)"/g }'
} | tr '_' '\n' | grep -vxE 'left|right|midline|sagittal|other' | sort -u | paste -sd '|')
[[ $names == *'|'* ]] || { echo "$1: no recipe and no stage declares a name"; exit 2; }
folders=()
for folder in lib/pipeline lib/publish lib/library; do [ -d "$folder" ] && folders+=("$folder"); done
[ ${#folders[@]} -gt 0 ] || { echo "$1: no folder of sources"; exit 2; }

find "${folders[@]}" -type f \( -name '*.cpp' -o -name '*.h' \) -print0 | sort -z | xargs -0 -r perl -0777 -ne '
  BEGIN { $names = shift @ARGV; $faults = 0; }
  # Comments go, lines stay; literals are kept whole, so that no // within one begins a comment.
  my ($text, $line) = ($_, 1);
  while ($text =~ m{\G(?:(//[^\n]*|/\*.*?\*/|(?m:^)\#include[^\n]*)|(R"([^()\s\\]*)\(.*?\)\3")|("(?:\\.|[^"\\\n])*")|(\x27(?:\\.|[^\x27\\\n])+\x27)|(.))}gs) {
    my ($whole, $literal) = ($&, defined $2 ? $2 : $4);
    if (defined $literal && $literal =~ /(?:(?<=["._])(?:$names)(?![A-Za-z0-9])|(?<![A-Za-z0-9])(?:$names)(?=["._]))/) {
      print "$ARGV:$line: $literal names an anatomy or a landmark\n";
      $faults++;
    }
    $line += ($whole =~ tr/\n//);
  }
  END { if ($faults) { print "$faults names of anatomies and landmarks\n"; exit 1; } }
' "$names"
