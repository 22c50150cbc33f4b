# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f unity_groups.awk -v most_lines=N FILE...: prints "GROUP FILE" for the files that may be compiled as one.
#
# Two files share a group where neither declares for itself alone (in an unnamed namespace, as a constant, an alias, a type or
# a macro, at the left margin, where clang-format puts what stands in a namespace) a name that the other declares at its
# left margin too, or uses: a function by a call, anything else by any mention. So helpers of the same name in two files stay
# apart, and no file finds another's helper where it meant a header's. An alias or a using declaration that both write alike is
# one name, which C++ lets them repeat. Capitals alone are macros, as TEST, and declare nothing. A group holds at most N lines,
# for editing one file compiles its whole group. Files that include CGAL stay alone: each costs more than all of its room.

function declare(name, own, value) {
  if (name ~ /^(operator|static_assert|[A-Z][A-Z_]+)$/) return
  used[file, name] = mentioned[file, name] = 1
  if (own) declared[file, name] = value ? "value" : "function"
}

FNR == 1 { file = ++files; path[file] = FILENAME; lines[file] = unnamed = 0 }
{ ++lines[file] }
/^#include <CGAL\// { alone[file] = 1 }
# A using directive holds for the whole group: only files with the same ones share one.
/^using namespace / && !/using namespace trephine;/ { directives[file] = directives[file] $0 }
/^#define / { split($2, macro, "("); declare(macro[1], 1, 1); next }
/^namespace \{/ { unnamed = 1 }
/^\}  \/\/ namespace$/ { unnamed = 0 }
/^[ \t]*(\/\/|#)/ { next }
{
  sub(/\/\/.*/, "")
  gsub(/"([^"\\]|\\.)*"/, "\"\"")
}
{ sub(/^(\[\[[a-z_]+\]\]|__attribute__\(\([a-z_]+\)\)) /, "") }
/^using [A-Za-z_0-9:]+;$/ {  # using texts::Phrase; declares Phrase
  line = $0
  sub(/^using ([A-Za-z_0-9]*::)*/, "", line)
  sub(/;$/, "", line)
  declare(line, 1, 1)
  same[file, line] = unnamed $0
  next
}
/^using [A-Za-z_0-9]+ = .*;$/ { split($0, alias, " "); same[file, alias[2]] = unnamed $0 }
/^(using|struct|class|enum|union) / {
  line = $0
  sub(/^(using|struct|class|enum( class)?|union) +/, "", line)
  if (match(line, /^[A-Za-z_][A-Za-z_0-9]*/) && line !~ /^namespace/) declare(substr(line, 1, RLENGTH), 1, 1)
}
/^[A-Za-z_]/ && !/^(using|struct|class|enum|union|namespace|template) / {
  own = unnamed || /^(static|const|constexpr|inline constexpr) /
  # The name stands before the first parenthesis, brace, bracket, equals sign or semicolon; a definition "T Class::f(" is no new name.
  line = $0
  while (gsub(/<[^<>]*>/, "", line)) ;
  if (match(line, /[({=;[]/)) {
    value = substr(line, RSTART, 1) != "("
    line = substr(line, 1, RSTART - 1)
    sub(/ +$/, "", line)
    if (match(line, /[A-Za-z_:][A-Za-z_0-9:]*$/)) {
      name = substr(line, RSTART, RLENGTH)
      if (name !~ /::/) declare(name, own, value)
    }
  }
  # Further names of one declaration: `constexpr double a = 1, b = 2;`
  line = $0
  if (line !~ /\(/)
    while (match(line, /, *[A-Za-z_][A-Za-z_0-9]* *[={]/)) {
      name = substr(line, RSTART + 1, RLENGTH - 2)
      gsub(/[ ={]/, "", name)
      declare(name, 1, 1)
      line = substr(line, RSTART + RLENGTH)
    }
}
{
  line = $0
  before = " "
  while (match(line, /[A-Za-z_][A-Za-z_0-9]*/)) {
    if (RSTART > 1) before = substr(line, RSTART - 1, 1)
    if (before !~ /[.:>]/) {
      name = substr(line, RSTART, RLENGTH)
      mentioned[file, name] = 1
      if (substr(line, RSTART + RLENGTH, 1) == "(") used[file, name] = 1
    }
    line = substr(line, RSTART + RLENGTH)
    before = " "
  }
}

END {
  for (key in declared) { split(key, part, SUBSEP); names[part[1]] = names[part[1]] " " part[2] }
  for (f = 1; f <= files; ++f) {
    if (alone[f]) continue
    for (g = 1; g <= groups; ++g) if (fits(f, g)) break
    if (g > groups) groups = g
    members[g] = members[g] " " f
    total[g] += lines[f]
    print g, path[f]
  }
}

function fits(f, g, them, n, i) {
  if (total[g] + lines[f] > most_lines) return 0
  n = split(members[g], them, " ")
  if (n && directives[them[1]] != directives[f]) return 0
  for (i = 1; i <= n; ++i) if (clash(f, them[i]) || clash(them[i], f)) return 0
  return 1
}

function clash(a, b, list, n, i) {
  n = split(names[a], list, " ")
  for (i = 1; i <= n; ++i)
    if ((a, list[i]) in same && (b, list[i]) in same && same[a, list[i]] == same[b, list[i]]) continue
    else if (declared[a, list[i]] == "value" ? (b, list[i]) in mentioned : (b, list[i]) in used) return 1
  return 0
}
