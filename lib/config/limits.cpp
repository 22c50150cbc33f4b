// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "config/reading.h"

namespace trephine::config {
namespace {

const ValueOrigin by_scene{ValueSource::scene, "what the scene allows", {}};

// A point of a trade keeps its own value where the scene allows it. A point with a weaker value gets all that the scene
// allows.
bool keeps_own(const ConfigValues& values, const std::string& path, double allowed) {
  const double now = values.number(path, 0);
  return values.origin(path).source == ValueSource::trade && now > 0 && now <= allowed;
}

void allow(ConfigValues& values, const std::string& path, const ParameterValue& value, double allowed) {
  if (!keeps_own(values, path, allowed)) values.set_value(path, value, by_scene);
}

// How far smoothing may move the surface.
double smoothing_mm(const ConfigValues& values, const std::string& anatomy) {
  return values.number(anatomy + ".smooth.max_displacement_mm", 0);
}

// The anatomies of the recipe that have the limits of one of the scene: its own, and what stands for it.
std::vector<std::string> names_of(const SceneAnatomy& wanted) {
  return wanted.stand_in.empty() ? std::vector<std::string>{wanted.name}
                                 : std::vector<std::string>{wanted.name, wanted.stand_in};
}

void share_out_triangles(ConfigReading& r) {
  const double ratio = r.values.number("scene.triangles_ratio", 1);
  // The wall of a burr hole consists of triangles too, and they count against the scene's limit.
  constexpr std::int64_t triangles_a_hole = 4000;
  const auto holes = static_cast<std::int64_t>(r.out.burr_holes.size());
  for (SceneAnatomy& wanted : r.out.scene) {
    if (wanted.max_triangles == 0) continue;
    wanted.max_triangles = std::max<std::int64_t>(4, std::llround(double(wanted.max_triangles) * ratio));
    const bool drilled = std::any_of(r.out.drilled.begin(), r.out.drilled.end(),
                                     [&](const SceneDrill& d) { return d.anatomy == wanted.name; });
    std::int64_t count = wanted.max_triangles;
    if (drilled) count = std::max(count - triangles_a_hole * holes, count / 2);
    for (const std::string& name : names_of(wanted))
      allow(r.values, name + ".decimate.target_triangles_count", count, double(count));
  }
}

void share_out_deviation(ConfigReading& r, const SceneAnatomy& wanted, const std::string& name) {
  const std::string path = name + ".decimate.max_deviation_mm";
  if (wanted.max_deviation_mm <= 0 || r.values.origin(path).source > ValueSource::scene) return;
  const double smoothed_mm = smoothing_mm(r.values, name), rest_mm = wanted.max_deviation_mm - smoothed_mm;
  const std::string scene_path = "scene.anatomies." + wanted.name + ".max_deviation_mm";
  if (rest_mm > 0)
    allow(r.values, path, rest_mm, rest_mm);
  else
    r.faults.add(Error(
        ExitCode::bad_config, r.values.origin(scene_path).where, "anatomies." + wanted.name + ".max_deviation_mm",
        trephine::to_text(ParameterValue(wanted.max_deviation_mm)) +
            ", must exceed what smooth may move the surface by, " + trephine::to_text(ParameterValue(smoothed_mm))));
}

// The settings of the chosen point may have another effect on this head than on the head that was measured. The rule is
// therefore enforced here for decimation and smoothing, and the measured deviations are checked against it later.
void keep_rule(ConfigReading& r) {
  const double limit_mm = r.out.trade.rule.max_deviation_mm;
  if (limit_mm <= 0) return;
  for (SceneAnatomy& wanted : r.out.scene) {
    if (wanted.max_deviation_mm <= 0 || wanted.max_deviation_mm > limit_mm) wanted.max_deviation_mm = limit_mm;
    for (const std::string& name : names_of(wanted)) {
      const double smoothed_mm = smoothing_mm(r.values, name), rest_mm = limit_mm - smoothed_mm;
      const std::string path = name + ".decimate.max_deviation_mm";
      const double now = r.values.number(path, 0);
      if (rest_mm <= 0)
        r.faults.add(Error(ExitCode::bad_config, r.file.string(), "accuracy.max_deviation_mm",
                           trephine::to_text(ParameterValue(limit_mm)) + ", must exceed what smooth may move " + name +
                               " by, " + trephine::to_text(ParameterValue(smoothed_mm))));
      else if (now == 0 || now > rest_mm)
        r.values.set_value(path, rest_mm, {ValueSource::rule, "the accuracy that the case asks for", {}});
    }
  }
}

/// Of the bound of a decimation that reads a contour the contour may use this share at once, where it is not too little
/// to save triangles (docs/developers/decisions.md, 42). Who sets decimation to 0 or to a tight bound gets all
/// triangles.
void share_with_contour(ConfigReading& r, const std::string& name) {
  constexpr double share = 1.0 / 8, least_mm = 0.08;
  const auto recipe = std::find_if(r.out.anatomies.begin(), r.out.anatomies.end(),
                                   [&](const RecipeAnatomy& a) { return a.name == name; });
  if (recipe == r.out.anatomies.end()) return;
  for (std::size_t i = 0; i + 1 < recipe->steps.size(); ++i) {
    const std::string first = name + "." + recipe->steps[i].type->name,
                      next = name + "." + recipe->steps[i + 1].type->name;
    const std::string used = first + ".within_mm", known = next + ".input_within_mm";
    if (!r.values.has(used) || !r.values.has(known)) continue;
    const double part_mm = share * r.values.number(next + ".max_deviation_mm", 0);
    if (r.values.origin(used).source == ValueSource::standard && part_mm >= least_mm)
      r.values.set_value(used, part_mm, {ValueSource::rule, "an eighth of " + next + ".max_deviation_mm", {}});
    r.values.set_value(known, r.values.number(used, 0), {ValueSource::rule, used, {}});
  }
}

}  // namespace

void share_out_limits(ConfigReading& reading) {
  share_out_triangles(reading);
  for (const SceneAnatomy& wanted : reading.out.scene)
    for (const std::string& name : names_of(wanted)) share_out_deviation(reading, wanted, name);
  keep_rule(reading);
  for (const SceneAnatomy& wanted : reading.out.scene)
    for (const std::string& name : names_of(wanted)) share_with_contour(reading, name);
}

}  // namespace trephine::config
