// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/nrrd_header.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "grid/nrrd_scale.h"

namespace trephine::grid::detail {
namespace {

// `space directions` holds spacing times direction, from which neither comes back to the last bit where an axis is
// oblique. Then, and only then, these keys hold them apart; a reader that does not know them loses nothing.
constexpr const char* spacing_key = "trephine-spacing";
constexpr const char* direction_key = "trephine-direction";

// The text after a leading "none", the entry of a list axis; empty where there is none.
std::string after_none(const std::string& text) { return lower(text.substr(0, 5)) == "none " ? text.substr(5) : ""; }

// "(a,b,c) (d,e,f)": `count` vectors; "none" and other counts are refused.
std::vector<Vec3> vectors_of(const std::string& text, std::size_t count, const std::string& field) {
  std::string plain;
  int depth = 0;
  std::vector<Vec3> out;
  const std::string form = "must be " + std::to_string(count) + " vectors (x,y,z)";
  for (const char c : text) {
    if (c == '(') {
      if (depth++ != 0) refuse(field, form);
      plain.clear();
    } else if (c == ')') {
      if (depth-- != 1) refuse(field, form);
      std::replace(plain.begin(), plain.end(), ',', ' ');
      const auto parts = words(plain);
      if (parts.size() != 3) refuse(field, form);
      out.push_back({number_of(parts[0], field), number_of(parts[1], field), number_of(parts[2], field)});
    } else if (depth == 1) {
      plain.push_back(c);
    } else if (c != ' ' && c != '\t') {
      refuse(field, form);
    }
  }
  if (depth != 0 || out.size() != count) refuse(field, form);
  return out;
}

std::string text_of(Vec3 v) { return "(" + to_text(v.x) + "," + to_text(v.y) + "," + to_text(v.z) + ")"; }

std::string escaped(const std::string& s) {
  std::string out;
  for (const char c : s) {
    if (c == '\\')
      out += "\\\\";
    else if (c == '\n')
      out += "\\n";
    else
      out.push_back(c);
  }
  return out;
}

std::string unescaped(std::string_view s) {
  std::string out;
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (s[i] == '\\' && i + 1 < s.size() && (s[i + 1] == 'n' || s[i + 1] == '\\')) {
      out.push_back(s[++i] == 'n' ? '\n' : '\\');
    } else {
      out.push_back(s[i]);
    }
  }
  return out;
}

std::array<Vec3, 3> steps_of(const Lattice& l) {
  return {l.direction.column[0] * l.spacing_mm.x, l.direction.column[1] * l.spacing_mm.y,
          l.direction.column[2] * l.spacing_mm.z};
}

// The spacing and direction that a reader without the two keys computes from the steps.
void take_steps(Lattice& l, const std::array<Vec3, 3>& steps, const std::string& field = "space directions") {
  for (int a = 0; a < 3; ++a) {
    // hypot of an axis-aligned step is exact.
    const Vec3 v = steps[a];
    const double length = std::hypot(v.x, v.y, v.z);
    if (!(length > 0) || !std::isfinite(length) || length < 1e-9 || length > 1e9)
      refuse(field, "axis " + std::to_string(a) + " has a spacing of " + to_text(length));
    l.spacing_mm[a] = length;
    l.direction.column[a] = v / length;
  }
}

void check_orthogonal(Lattice& l, const std::string& field = "space directions") {
  constexpr double refused_above = 1e-4, kept_below = 1e-6;
  double worst = 0;
  for (int a = 0; a < 3; ++a)
    worst = std::max(worst, std::abs(dot(l.direction.column[a], l.direction.column[(a + 1) % 3])));
  if (!(worst <= refused_above)) refuse(field, "the axes are not orthogonal (cosine " + to_text(worst) + ")");
  if (worst <= kept_below) return;
  // The file was written with few digits, so the nearest orthonormal axes are taken; the first axis is kept.
  auto& c = l.direction.column;
  const double hand = determinant(l.direction) < 0 ? -1 : 1;
  c[1] = normalized(c[1] - c[0] * dot(c[0], c[1]));
  c[2] = cross(c[0], c[1]) * hand;
}

// Spacing and direction to the bit, where the keys are there and still say what the steps say.
void take_exact_keys(Lattice& l, NrrdKeys& keys, const std::array<Vec3, 3>& steps) {
  const auto s = keys.find(spacing_key), d = keys.find(direction_key);
  if (s != keys.end() && d != keys.end()) {
    try {
      Lattice exact = l;
      exact.spacing_mm = vectors_of(s->second, 1, spacing_key)[0];
      const auto columns = vectors_of(d->second, 3, direction_key);
      std::copy(columns.begin(), columns.end(), exact.direction.column.begin());
      bool same = true;
      const auto exact_steps = steps_of(exact);
      for (int a = 0; a < 3; ++a)
        same = same && exact.spacing_mm[a] > 0 && norm(exact_steps[a] - steps[a]) <= 1e-14 * norm(steps[a]) &&
               std::abs(norm(exact.direction.column[a]) - 1) <= 1e-6;
      if (same) l = exact;
    } catch (const Error&) {
      // The key is of another program, so the steps hold.
    }
  }
  keys.erase(spacing_key);
  keys.erase(direction_key);
}

std::optional<NrrdType> type_of(const std::string& name) {
  static const std::map<std::string, NrrdType> types = {{"signed char", NrrdType::int8},
                                                        {"int8", NrrdType::int8},
                                                        {"int8_t", NrrdType::int8},
                                                        {"uchar", NrrdType::uint8},
                                                        {"unsigned char", NrrdType::uint8},
                                                        {"uint8", NrrdType::uint8},
                                                        {"uint8_t", NrrdType::uint8},
                                                        {"short", NrrdType::int16},
                                                        {"short int", NrrdType::int16},
                                                        {"signed short", NrrdType::int16},
                                                        {"signed short int", NrrdType::int16},
                                                        {"int16", NrrdType::int16},
                                                        {"int16_t", NrrdType::int16},
                                                        {"ushort", NrrdType::uint16},
                                                        {"unsigned short", NrrdType::uint16},
                                                        {"unsigned short int", NrrdType::uint16},
                                                        {"uint16", NrrdType::uint16},
                                                        {"uint16_t", NrrdType::uint16},
                                                        {"int", NrrdType::int32},
                                                        {"signed int", NrrdType::int32},
                                                        {"int32", NrrdType::int32},
                                                        {"int32_t", NrrdType::int32},
                                                        {"uint", NrrdType::uint32},
                                                        {"unsigned int", NrrdType::uint32},
                                                        {"uint32", NrrdType::uint32},
                                                        {"uint32_t", NrrdType::uint32},
                                                        {"float", NrrdType::float32},
                                                        {"double", NrrdType::float64}};
  const auto found = types.find(name);
  return found == types.end() ? std::nullopt : std::optional<NrrdType>(found->second);
}

}  // namespace

std::size_t bytes_of(NrrdType type) {
  switch (type) {
    case NrrdType::int8:
    case NrrdType::uint8:
      return 1;
    case NrrdType::int16:
    case NrrdType::uint16:
      return 2;
    case NrrdType::int32:
    case NrrdType::uint32:
    case NrrdType::float32:
      return 4;
    case NrrdType::float64:
      return 8;
  }
  return 0;
}

std::string nrrd_header_text(const Lattice& lattice, NrrdType type, NrrdEncoding encoding, const NrrdKeys& keys,
                             int layers) {
  const bool layered = layers > 1;
  const auto steps = steps_of(lattice);
  std::string out = "NRRD0004\n";
  out += std::string("type: ") +
         (type == NrrdType::uint8   ? "unsigned char"
          : type == NrrdType::int16 ? "short"
                                    : "float") +
         "\n";
  out += layered ? "dimension: 4\n" : "dimension: 3\n";
  out += "space: left-posterior-superior\nsizes:";
  if (layered) out += " " + std::to_string(layers);
  for (const int n : lattice.size) out += " " + std::to_string(n);
  out += layered ? "\nspace directions: none" : "\nspace directions:";
  for (const Vec3 v : steps) out += " " + text_of(v);
  out += layered ? "\nkinds: list domain domain domain" : "\nkinds: domain domain domain";
  out += "\nendian: little\nencoding: ";
  out += encoding == NrrdEncoding::gzip ? "gzip" : "raw";
  out += "\nspace origin: " + text_of(lattice.origin_mm) + "\n";

  NrrdKeys all = keys;
  Lattice again = lattice;
  take_steps(again, steps);
  if (again != lattice) {
    all[spacing_key] = text_of(lattice.spacing_mm);
    const auto& c = lattice.direction.column;
    all[direction_key] = text_of(c[0]) + " " + text_of(c[1]) + " " + text_of(c[2]);
  }
  for (const auto& [key, value] : all) {
    if (key.empty() || key[0] == '#' || key.find_first_of(":\n\r") != std::string::npos ||
        value.find('\r') != std::string::npos)
      throw Error(ExitCode::internal, "", "key '" + key + "'", "cannot be written to a NRRD header");
    out += escaped(key) + ":=" + escaped(value) + "\n";
  }
  return out + "\n";
}

void take_axes(Lattice& lattice, const std::array<Vec3, 3>& steps, const std::string& field) {
  take_steps(lattice, steps, field);
  check_orthogonal(lattice, field);
}

void require_place(const Lattice& l, const std::string& field) {
  constexpr double farthest_mm = 1e6;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 index;
    for (int a = 0; a < 3; ++a) index[a] = corner >> a & 1 ? l.size[a] - 1.0 : 0.0;
    const Vec3 at = l.to_world_mm(index);
    for (int a = 0; a < 3; ++a)
      if (!(std::fabs(at[a]) <= farthest_mm)) refuse(field, "the volume lies more than 1 km from the origin");
  }
}

NrrdHeader parse_nrrd_header(std::string_view text, bool layered) {
  NrrdHeader h;
  std::map<std::string, std::string> fields;
  bool first = true;
  while (!text.empty()) {
    const auto end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (first) {
      first = false;
      if (line.size() != 8 || line.substr(0, 7) != "NRRD000" || line[7] < '1' || line[7] > '5')
        refuse("header", "not a NRRD file of version 1 to 5");
      continue;
    }
    if (line.empty() || line[0] == '#') continue;
    const auto key_at = line.find(":="), field_at = line.find(": ");
    if (key_at != std::string_view::npos && (field_at == std::string_view::npos || key_at < field_at)) {
      h.keys[unescaped(line.substr(0, key_at))] = unescaped(line.substr(key_at + 2));
    } else if (field_at != std::string_view::npos) {
      const std::string name = lower(trimmed(line.substr(0, field_at)));
      if (!fields.emplace(name, trimmed(line.substr(field_at + 2))).second) refuse(name, "given twice");
    } else {
      refuse("header", "a line is neither a field nor a key");
    }
  }

  for (const auto& [name, value] : fields)
    if (!is_known_field(name)) h.unknown.push_back(tellable_key(name));
  const auto get = [&](const std::string& name) -> const std::string& {
    const auto found = fields.find(name);
    if (found == fields.end()) refuse(name, "missing");
    return found->second;
  };
  for (const char* name : {"data file", "datafile"})
    if (fields.count(name))
      throw Error(ExitCode::bad_input, "", "data file", "a detached header: convert it to one file with the data in it")
          .because(Cause::other_encoding);
  for (const char* name : {"line skip", "lineskip", "byte skip", "byteskip"})
    if (fields.count(name) && fields[name] != "0") refuse(name, "must be 0");

  const auto type = type_of(lower(get("type")));
  if (!type) refuse("type", "'" + get("type") + "' is not supported");
  h.type = *type;
  const bool has_list = layered && get("dimension") == "4";
  if (!has_list && get("dimension") != "3")
    refuse("dimension", "'" + get("dimension") + "', must be 3" + (layered ? " or 4" : ""));

  const std::string encoding = lower(get("encoding"));
  if (encoding == "gzip" || encoding == "gz")
    h.gzip = true;
  else if (encoding != "raw")
    throw Error(ExitCode::bad_input, "", "encoding", "'" + encoding + "', must be raw or gzip")
        .because(Cause::other_encoding);
  if (bytes_of(h.type) > 1) {
    const std::string endian = lower(get("endian"));
    if (endian != "little" && endian != "big") refuse("endian", "'" + endian + "', must be little or big");
    h.big_endian = endian == "big";
  }

  const auto sizes = words(get("sizes"));
  const int list = has_list ? 1 : 0;
  if (sizes.size() != std::size_t(3 + list)) refuse("sizes", "must be " + std::to_string(3 + list) + " numbers");
  std::uint64_t count = 1;
  for (int a = 0; a < 3 + list; ++a) {
    std::uint64_t n = 0;
    const char* end = sizes[a].data() + sizes[a].size();
    const auto r = std::from_chars(sizes[a].data(), end, n);
    if (r.ec != std::errc() || r.ptr != end || n < 1 || n > std::uint64_t(std::numeric_limits<int>::max()))
      refuse("sizes", "'" + sizes[a] + "' is not a size");
    if (n > (std::uint64_t{1} << 40) / count) refuse("sizes", "more than 2^40 voxels");
    count *= n;
    (a < list ? h.layers : h.lattice.size[a - list]) = static_cast<int>(n);
  }
  if (std::int64_t{h.layers} * h.lattice.size[0] > std::numeric_limits<int>::max()) refuse("sizes", "too many layers");

  const std::string space = lower(get("space"));
  double flip = 1;
  if (space == "right-anterior-superior" || space == "ras")
    flip = -1;
  else if (space != "left-posterior-superior" && space != "lps")
    refuse("space", "'" + space + "', must be left-posterior-superior or right-anterior-superior");

  const std::string directions = has_list ? after_none(get("space directions")) : get("space directions");
  if (directions.empty()) refuse("space directions", "the first of 4 axes must be a list: none");
  const auto given = vectors_of(directions, 3, "space directions");
  std::array<Vec3, 3> steps;
  check_scales(fields, {given[0], given[1], given[2]}, static_cast<std::size_t>(list));
  const Vec3 unit_mm = units_of(fields);
  // 0 - v and not -v, so that a 0 does not become -0.
  const auto to_lps = [&](Vec3 v) {
    v = {v.x * unit_mm.x, v.y * unit_mm.y, v.z * unit_mm.z};
    return flip > 0 ? v : Vec3{0 - v.x, 0 - v.y, v.z};
  };
  for (int a = 0; a < 3; ++a) steps[a] = to_lps(given[a]);
  take_steps(h.lattice, steps);
  h.lattice.origin_mm = to_lps(vectors_of(get("space origin"), 1, "space origin")[0]);
  take_exact_keys(h.lattice, h.keys, steps);
  check_orthogonal(h.lattice);
  require_place(h.lattice, "space origin");
  return h;
}

}  // namespace trephine::grid::detail
