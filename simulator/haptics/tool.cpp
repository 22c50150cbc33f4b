// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/tool.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/hash.h"
#include "base/text.h"
#include "base/write_file.h"

namespace trephine::haptics {
namespace {

using Tip = ToolParams::Tip;

constexpr double cone_lengths = 2;  // length of a cone, in diameters
constexpr double neck_ratio = 0.5;  // diameter of the shaft behind a ball, by that of the ball
constexpr int min_around = 4;

// The outline from the tip to the tail: distance along the axis and from it, each `spacing` of its length.
struct Outline {
  std::vector<Vec3> at{Vec3{}};  // x: from the axis, z: along it
  double spacing;
  void line(double x, double z) {
    const Vec3 from = at.back(), way = Vec3{x, 0, z} - from;
    const int n = std::max(1, int(std::ceil(norm(way) / spacing - 1e-9)));
    for (int i = 1; i <= n; ++i) at.push_back(from + way * (double(i) / n));
  }
  void arc(double radius, double until_rad) {
    const int n = std::max(1, int(std::ceil(radius * until_rad / spacing - 1e-9)));
    for (int i = 1; i <= n; ++i) {
      const double a = until_rad * i / n;
      at.push_back({radius * std::sin(a), 0, radius * (1 - std::cos(a))});
    }
  }
};

constexpr double farthest_point_mm = 400;
constexpr std::uint64_t max_point_bytes = 1 << 20;

std::string points_text(const std::string& file) {
  const std::vector<char> bytes = read_file(file, max_point_bytes);
  return {bytes.begin(), bytes.end()};
}

// The three numbers of a line, whatever separates them; none where it is empty or a comment.
std::optional<Vec3> point_of(const std::string& line, int number) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ExitCode::bad_input, "", "line " + std::to_string(number), what);
  };
  std::string words = line.substr(0, line.find('#'));
  for (char& c : words)
    if (c == '\t' || c == '\r' || c == ',') c = ' ';
  Vec3 at;
  int given = 0;
  for (const std::string& word : split_at(words, ' ')) {
    if (word.empty()) continue;
    const std::optional<double> v = parse_number(word);
    if (!v || given == 3) refuse("must be three numbers, x y z in mm");
    if (!(std::abs(*v) <= farthest_point_mm)) refuse(word + " mm: a tool reaches at most 400 mm");
    at[given++] = *v;
  }
  if (given == 0) return std::nullopt;
  if (given != 3) refuse("must be three numbers, x y z in mm");
  return at;
}

// Sorts points from the tip to the tail; the tip itself is the first of them.
std::vector<Vec3> points_of(const ToolParams& p) {
  return with_file(p.tool_points, [&] {
    const std::string text = points_text(p.tool_points);
    if (!p.tool_points_sha256.empty() && sha256_of_bytes(text) != p.tool_points_sha256)
      throw Error(ExitCode::bad_input, "", "tool_points_sha256", "is not that of the file: these are other points");
    std::vector<Vec3> points{Vec3{}};
    int number = 0;
    for (const std::string& line : split_at(text, '\n')) {
      const std::optional<Vec3> at = point_of(line, ++number);
      if (!at || *at == Vec3{}) continue;
      points.push_back(*at);
      if (points.size() > std::size_t(max_tool_points))
        throw Error(ExitCode::bad_input, "", "line " + std::to_string(number),
                    "gives more than " + std::to_string(max_tool_points) + " points, with the tip");
    }
    if (points.size() == 1) throw Error(ExitCode::bad_input, "", "", "holds no point besides the tip");
    std::stable_sort(points.begin() + 1, points.end(), [](Vec3 a, Vec3 b) { return a.z < b.z; });
    return points;
  });
}

// A ball, a rod, or a ball and the rod behind it.
std::vector<RoundPart> round_parts(const ToolParams& p, double radius, double neck) {
  if (!tool_kind(p.tool).has_neck) return {{radius, radius, radius}};
  if (p.tool_tip != Tip::ball && p.tool_tip != Tip::round)
    throw Error(ExitCode::usage, "", "--tool-tip", "must be round or ball for --tool " + p.tool);
  if (p.tool_length_mm < 2 * radius)
    throw Error(ExitCode::bad_config, "", "tool_length_mm",
                "must be at least the diameter, " + to_text(2 * radius) + ": make the tool longer, or thinner");
  const double end = p.tool_length_mm - neck;
  if (p.tool_tip == Tip::round) return {{radius, end, radius}};
  return {{radius, radius, radius}, {radius, std::max(radius, end), neck}};
}

}  // namespace

ToolParams own_tool(const ToolParams& params) {
  const ToolKind& own = tool_kind(params.tool);
  ToolParams p = params;
  if (own.from_file == p.tool_points.empty())
    throw Error(ExitCode::usage, "", "--tool-points",
                own.from_file ? "is missing: --tool points needs it" : "is for --tool points, not for " + p.tool);
  if (own.from_file && p.tool_points_sha256.empty())
    p.tool_points_sha256 = with_file(p.tool_points, [&] { return sha256_of_bytes(points_text(p.tool_points)); });
  if (p.tool_tip == Tip::own) p.tool_tip = own.tip;
  if (!(p.tool_diameter_mm > 0)) p.tool_diameter_mm = own.diameter_mm;
  if (!(p.tool_length_mm > 0)) p.tool_length_mm = own.length_mm;
  if (!(p.tool_spacing_mm > 0)) p.tool_spacing_mm = own.spacing_mm;
  return p;
}

Tool make_tool(const ToolParams& params) {
  const ToolParams p = own_tool(params);
  Tool tool;
  tool.search = p.tool_search;
  tool.lock_distance_mm = p.lock_distance_mm;
  if (tool_kind(p.tool).from_file) {
    tool.points_mm = points_of(p);
    tool.length_mm = std::max(0.0, tool.points_mm.back().z);
    return tool;
  }
  if (!(tool_kind(p.tool).length_mm > 0)) return tool;
  const double radius = 0.5 * p.tool_diameter_mm;
  const double neck = p.tool_tip == Tip::ball ? neck_ratio * radius : radius;
  if (tool_kind(p.tool).exact) {
    tool.round = round_parts(p, radius, neck);
    tool.length_mm = tool.round.back().to_mm + tool.round.back().radius_mm;
    return tool;
  }
  tool.length_mm = p.tool_length_mm;
  const double length = p.tool_length_mm;
  Outline o;
  // More than that along the outline or around it is refused anyway, so it is not even laid out.
  if ((length + 4 * radius) / p.tool_spacing_mm > max_tool_points ||
      2 * M_PI * radius / p.tool_spacing_mm > max_tool_points)
    throw Error(ExitCode::bad_config, "", "tool_spacing_mm",
                "gives more than " + std::to_string(max_tool_points) + " points");
  o.spacing = p.tool_spacing_mm;
  switch (p.tool_tip) {
    case Tip::own:
    case Tip::flat:
      o.line(radius, 0);
      break;
    case Tip::round:
      o.arc(radius, 0.5 * M_PI);
      break;
    case Tip::cone:
      o.line(radius, cone_lengths * 2 * radius);
      break;
    case Tip::ball:
      o.arc(radius, M_PI - std::asin(neck_ratio));
      break;
  }
  if (o.at.back().z > length)
    throw Error(ExitCode::bad_config, "", "tool_length_mm",
                "must be at least the tip's length, " + to_text(o.at.back().z) +
                    ": make the tool longer or thinner, or choose another tool_tip");
  if (o.at.back().z < length) o.line(neck, length);
  int ring = 0;
  for (const Vec3& at : o.at) {
    const int around =
        at.x < 1e-9 ? 1 : std::max(min_around, int(std::ceil(2 * M_PI * at.x / p.tool_spacing_mm - 1e-9)));
    const double half = ring++ % 2 == 0 ? 0 : 0.5;
    for (int n = 0; n < around; ++n) {
      const double a = 2 * M_PI * (n + half) / around;
      tool.points_mm.push_back({at.x * std::cos(a), at.x * std::sin(a), at.z});
    }
    if (tool.points_mm.size() > std::size_t(max_tool_points))
      throw Error(ExitCode::bad_config, "", "tool_spacing_mm",
                  "gives more than " + std::to_string(max_tool_points) + " points");
  }
  return tool;
}

}  // namespace trephine::haptics
