// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine/spine_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/base64.h"
#include "base/png.h"
#include "fluoro/fluoroscope.h"
#include "lessons/report_pictures.h"
#include "lessons/spine/pedicle_errors.h"
#include "lessons/spine/spine_moves.h"

namespace trephine::lessons {
namespace {

using Json = nlohmann::ordered_json;
using detail::PictureMark;

const SpineNeedleFacts& own(const LessonFacts& facts) { return static_cast<const SpineNeedleFacts&>(facts); }
Json list_of(Vec3 v) { return {v.x, v.y, v.z}; }

Json json_of(const SpineNeedleFacts& f) {
  Json shots = Json::array(), passes = Json::array(), punctures = Json::array();
  for (const FluoroShot& s : f.shots)
    shots.push_back({{"begin_s", s.begin_s},
                     {"end_s", s.end_s},
                     {"view", s.arm.view()},
                     {"orbit_deg", s.arm.orbit_deg},
                     {"tilt_deg", s.arm.tilt_deg},
                     {"tip_mm", list_of(s.tip_mm)}});
  const auto json_of_pass = [](const NeedlePass& p) {
    return Json{{"tool", p.tool},
                {"begin_s", p.begin_s},
                {"end_s", p.end_s},
                {"entry_mm", list_of(p.entry_mm)},
                {"deepest_mm", list_of(p.deepest().tip_mm)},
                {"tip_mm", list_of(p.path.back().tip_mm)},
                {"axis", list_of(p.path.back().axis)},
                {"in_place", p.in_place}};
  };
  for (const NeedlePass& p : f.passes) passes.push_back(json_of_pass(p));
  for (const NeedlePass& p : f.punctures) punctures.push_back(json_of_pass(p));
  return {{"exposure_s", f.exposure_s()}, {"shots", shots}, {"passes", passes}, {"punctures", punctures}};
}

constexpr texts::Wording none_words{{"No picture was taken.", "Es wurde kein Bild aufgenommen."}},
    fluoroscopy_words{{"Fluoroscopy: {} shots, {:.1f} s", "Durchleuchtung: {} Aufnahmen, {:.1f} s"}},
    no_ct_words{{"The case holds no CT to show.", "Der Fall hat kein CT, das gezeigt werden könnte."}},
    shot_words{{"{} at {:.1f} s, {:.1f} s long", "{} bei {:.1f} s, {:.1f} s lang"}},
    free_words{{" (orbit {:g}, tilt {:g} degrees)", " (um {:g} Grad gedreht, um {:g} Grad gekippt)"}},
    pedicle_words{{"The pedicle", "Der Pedikel"}}, tip_words{{"The needle's tip", "Die Nadelspitze"}},
    legend_words{
        {"Orange: the needle and its tip's way, projected onto the slice. Green: the ideal axis of {}, from its "
         "entry (blue ring) to its target (red ring).",
         "Orange: die Nadel und der Weg ihrer Spitze, auf die Schicht projiziert. Grün: die ideale Achse von {}, "
         "vom Eintritt (blauer Ring) zum Ziel (roter Ring)."}};

// What was seen: the last pictures that were taken, with the needle as it was then.
std::string shots_html(const SpineNeedleFacts& facts, const cases::LoadedCase& loaded, texts::Language language) {
  constexpr std::size_t most = 6;
  constexpr int size = 256;
  if (facts.shots.empty()) return std::string("<p>") + none_words.of(language) + "</p>\n";
  std::string out = "<h2>" +
                    fmt::format(fmt::runtime(fluoroscopy_words.of(language)), facts.shots.size(), facts.exposure_s()) +
                    "</h2>\n";
  if (!loaded.has_ct()) return out + "<p class=\"faint\">" + no_ct_words.of(language) + "</p>\n";
  fluoro::Fluoroscope fluoroscope(loaded.ct);
  const bool flipped = spine_field(facts, loaded.manifest).from.y > 0;  // as the surgeon stands, as in the window
  const std::size_t first = facts.shots.size() > most ? facts.shots.size() - most : 0;
  for (std::size_t n = first; n < facts.shots.size(); ++n) {
    const FluoroShot& s = facts.shots[n];
    const fluoro::FluoroPicture picture = fluoroscope.picture(arm_of(loaded.manifest, s.arm), size, {s.metal()});
    const auto letters = fluoro::CArm(arm_of(loaded.manifest, s.arm), size).side_letters();
    if ((n - first) % 3 == 0) out += "<div class=\"slices\">\n";
    out += fmt::format(
        "<figure><svg viewBox=\"0 0 160 160\"><image width=\"160\" height=\"160\" href=\"data:image/png;base64,{}\"/>"
        "<text x=\"4\" y=\"11\">{}</text><text x=\"150\" y=\"11\">{}</text></svg><figcaption>{}{}</figcaption>"
        "</figure>\n",
        base64(png_of(size, size, 1, fluoro::shown_grey(picture, fluoro::MetalShown::bright, flipped))),
        letters[flipped], letters[!flipped],
        fmt::format(fmt::runtime(shot_words.of(language)), s.arm.view(), s.begin_s, s.end_s - s.begin_s),
        std::string(s.arm.view()) == "free"
            ? fmt::format(fmt::runtime(free_words.of(language)), s.arm.orbit_deg, s.arm.tilt_deg)
            : "");
    if ((n - first) % 3 == 2 || n + 1 == facts.shots.size()) out += "</div>\n";
  }
  return out;
}

}  // namespace

nlohmann::ordered_json spine_facts_json(const LessonFacts& facts) { return json_of(own(facts)); }

std::vector<StepChoice> spine_steps() {
  std::vector<StepChoice> steps = {
      script_step<NeedleStep>("needle", "Moves the needle from outside on a line into a pedicle."),
      script_step<PushStep>("push", "Pushes the needle on along its axis."),
      script_step<InsertStep>("insert", "Moves the tool on a straight line between two places."),
      script_step<ShootStep>("shoot", "Takes a picture: the pedal is down for a moment.")};
  for (int command = haptics::belt_command::view_ap; command <= haptics::belt_command::tilt_less; ++command)
    steps.push_back(script_step(haptics::belt_command::names[command], "Moves the C-arm."));
  return with_common_steps(steps);
}

std::vector<LessonStatus> spine_status(const LessonFacts& lesson) {
  const SpineNeedleFacts& f = own(lesson);
  return {{"passes_count", "Passes", std::to_string(f.passes.size())},
          {"shots_count", "Shots", std::to_string(f.shots.size())},
          {"exposure_s", "X-rays, s", fmt::format("{:.1f}", f.exposure_s())}};
}

LessonField spine_field(const LessonFacts&, const cases::CaseManifest& manifest) {
  constexpr double beside_mm = 60;
  const std::vector<CasePedicle> all = pedicles_of(manifest);
  LessonField field{manifest.center_mm, 0, 150, {0, -1, 0}, {0, 1, 0}};
  if (all.empty()) return field;
  Vec3 middle;
  for (const CasePedicle& p : all) middle += p.entry_mm * (1.0 / double(all.size()));
  double away = 0;
  for (const CasePedicle& p : all) away = std::max(away, norm(p.entry_mm - middle));
  return {middle, away + beside_mm, away + 2 * beside_mm, field.down, field.from};
}

static LessonXray::Pose pose_of(const cases::CaseManifest& manifest, const ArmPose& p) {
  return {p.view(), p.orbit_deg, p.tilt_deg, arm_of(manifest, p)};
}

std::vector<LessonShot> spine_shots(const LessonFacts& lesson, const cases::CaseManifest& manifest) {
  std::vector<LessonShot> all;
  for (const FluoroShot& s : own(lesson).shots)
    all.push_back({s.begin_s, s.end_s, pose_of(manifest, s.arm), {s.metal()}});
  return all;
}

LessonXray spine_xray(const Lesson& lesson, const cases::CaseManifest& manifest) {
  const SpineNeedle& spine = static_cast<const SpineNeedle&>(lesson);
  const SpineNeedleFacts& f = spine.facts();
  LessonXray x;
  x.now = pose_of(manifest, spine.arm());
  x.on = spine.exposing();
  x.exposure_s = f.exposure_s();
  x.shots_count = f.shots.size();
  if (f.shots.empty()) return x;
  x.seen = pose_of(manifest, f.shots.back().arm);
  x.metal = {f.shots.back().metal()};
  return x;
}

std::string spine_pictures(const LessonFacts& lesson, const cases::LoadedCase& loaded, texts::Language language) {
  const SpineNeedleFacts& facts = own(lesson);
  std::string out = facts.from_scan ? "" : shots_html(facts, loaded, language);
  const std::vector<CasePedicle> pedicles = pedicles_of(loaded.manifest);
  if (facts.passes.empty() || pedicles.empty()) return out;
  std::vector<PictureMark> marks;
  for (const NeedlePass& pass : facts.passes) {
    PictureMark way{{}, "way"};
    for (const NeedlePoint& p : pass.path) way.points_mm.push_back(p.tip_mm);
    if (way.points_mm.size() > 1) marks.push_back(way);
  }
  const NeedlePoint& end = facts.passes.back().path.back();
  const NeedleErrors e = nearest_pedicle(pedicles, end.tip_mm, end.axis);
  marks.push_back({{end.tip_mm, end.tip_mm + end.axis * 60}, "way"});
  marks.push_back({{e.pedicle->entry_mm, e.pedicle->target_mm}, "expert"});
  marks.push_back({{e.pedicle->target_mm}, "target"});
  marks.push_back({{e.pedicle->entry_mm}, "hole"});
  marks.push_back({{end.tip_mm}, "tip"});
  const Vec3 middle = e.pedicle->entry_mm + (e.pedicle->target_mm - e.pedicle->entry_mm) * 0.4;
  for (const auto& [words, at] :
       {std::pair<const texts::Wording&, Vec3>{pedicle_words, middle}, {tip_words, end.tip_mm}})
    out += std::string("<h2>") + words.of(language) + "</h2>\n" +
           detail::slices_html(loaded, at, marks, language, {-150, 900});
  return out + "<p class=\"faint\">" +
         fmt::format(fmt::runtime(legend_words.of(language)), detail::escaped(e.pedicle->name)) + "</p>\n";
}

}  // namespace trephine::lessons
