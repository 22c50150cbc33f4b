// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/subclavian/subclavian_score.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lessons/subclavian/line_scan.h"
#include "lessons/time_row.h"

namespace trephine::lessons {
namespace {

// The pass that is judged: the one that lies in place, else the last.
const VeinPass* judged_pass(const SubclavianFacts& f) { return f.passes.empty() ? nullptr : &f.passes.back(); }

// Of a CT that shows no line, or one that is doubtful, nothing is judged.
bool is_unseen(const SubclavianFacts& f, ScoreRow& row) {
  const texts::Phrase why = unseen_line(f);
  if (why.empty()) return false;
  row.score.reset();
  row.why = why;
  return true;
}

ScoreRow score_puncture(const SubclavianFacts& f, const ChestFrame& frame, const PunctureRubric& r) {
  ScoreRow row{"puncture", "Puncture of the skin", 1, "the needle entered nothing", {}, {}, {}};
  if (is_unseen(f, row)) return row;
  const VeinPass* pass = judged_pass(f);
  if (!pass) return row;
  const double below = frame.below_border_mm(pass->entry_mm);
  row.measured = {{"below_border_mm", below}};
  row.limits = {{"ideal_mm", r.ideal_mm}, {"far_mm", r.far_mm}};
  row.decided_s = pass->begin_s;
  row.score = below < 0 ? 1 : below <= r.ideal_mm.limit ? 5 : below <= r.far_mm.limit ? 3 : 2;
  row.why = below < 0        ? "above the clavicle's lower border"
            : *row.score > 2 ? "below the clavicle's lower border"
                             : "too far below the clavicle";
  return row;
}

ScoreRow score_direction(const SubclavianFacts& f, const ChestFrame& frame, const NotchRubric& r) {
  ScoreRow row{"direction", "Direction of the needle", 1, "the needle entered nothing", {}, {}, {}};
  if (is_unseen(f, row)) return row;
  const VeinPass* pass = judged_pass(f);
  if (!pass) return row;
  const double off = frame.off_notch_deg(pass->entry_mm, pass->tip_mm - pass->entry_mm);
  row.measured = {{"off_notch_deg", off}};
  row.limits = {{"ideal_deg", r.ideal_deg}, {"good_deg", r.good_deg}, {"acceptable_deg", r.acceptable_deg}};
  row.decided_s = pass->end_s;
  row.score = off <= r.ideal_deg.limit        ? 5
              : off <= r.good_deg.limit       ? 4
              : off <= r.acceptable_deg.limit ? 3
              : off < 90                      ? 2
                                              : 1;
  row.why = *row.score >= 4   ? "toward the sternal notch"
            : *row.score >= 2 ? "beside the sternal notch"
                              : "away from it";
  return row;
}

// How far the needle went on, out of the vein again, in any pass, and when.
std::pair<double, double> beyond_vein(const SubclavianFacts& f, int vein) {
  std::pair<double, double> most{0, 0};
  for (const VeinPass& pass : f.passes) {
    double left_at = -1;
    for (const VeinPassPoint& p : pass.path) {
      const double depth = dot(pass.entry_mm - p.tip_mm, pass.out);
      if (p.inside == vein)
        left_at = std::max(left_at, depth);
      else if (left_at >= 0 && depth - left_at > most.first)
        most = {depth - left_at, p.time_s};
    }
  }
  return most;
}

ScoreRow score_vein(const SubclavianFacts& f, const ChestShapes& shapes, const SubclavianRubric& r) {
  ScoreRow row{"vein", "Blood from the vein", 1, "the vein was never reached", {}, {}, f.end_s};
  if (is_unseen(f, row)) return row;
  if (f.from_scan) {  // a line is pushed where blood came from; how often somebody drew, and how deep, nobody knows
    if (f.inside == shapes.vein)
      row.score = 5, row.why = "the line lies in the vein";
    else if (f.vein_s >= 0)
      row.score.reset(), row.why = "the line goes on beyond the vein that the case shows";
    return row;
  }
  if (f.blood_s >= 0) {
    row = {"vein", row.title, 5, "blood was aspirated with the tip in the vein", {}, {}, f.blood_s};
  } else if (f.inside == shapes.vein) {
    row.score = 3;
    row.why = "the tip lies in the vein, and nobody aspirated";
  } else if (f.vein_s >= 0) {
    row.score = 2;
    row.why = "the vein was entered, and left again";
    row.decided_s = f.vein_s;
  }
  const auto limited = [&](const char* figure, double value, const lesson::FourLimits& limits, const std::string& unit,
                           const char* why, double at_s) {
    row.measured.emplace_back(figure, value);
    row.limits.insert(row.limits.end(), {{"five_" + unit, limits.five},
                                         {"four_" + unit, limits.four},
                                         {"three_" + unit, limits.three},
                                         {"two_" + unit, limits.two}});
    lower(row, limits.score(value), why, at_s);
  };
  if (r.aspirations_count && !f.aspirations.empty())
    limited("aspirations_count", double(f.aspirations.size()), *r.aspirations_count, "count",
            "drawn at the syringe again and again", f.aspirations.back().time_s);
  if (r.beyond_vein_mm && f.vein_s >= 0) {
    const auto [beyond_mm, at_s] = beyond_vein(f, shapes.vein);
    limited("beyond_vein_mm", beyond_mm, *r.beyond_vein_mm, "mm", "the needle went through the vein", at_s);
  }
  return row;
}

// What must not be entered. Where the case does not show it, nobody knows whether the needle was there.
ScoreRow score_untouched(const SubclavianFacts& f, const char* name, const char* title, bool known, const char* unknown,
                         double entered_s, const std::string& entered) {
  ScoreRow row{name, title, {}, unknown, {}, {}, {}};
  if (is_unseen(f, row)) return row;
  if (!known && entered_s < 0) return row;  // before all else: a case that does not know counts for nobody
  if (entered_s < 0 && f.vein_s < 0) {      // who does nothing, or pricks the skin alone, spares nothing
    row.score = 1;
    row.why = f.passes.empty() ? "the needle entered nothing" : "the vein was never reached";
    return row;
  }
  row.score = entered_s < 0 ? 5 : 1;
  row.why = entered_s < 0 ? "not entered" : entered + " was entered";
  row.decided_s = entered_s < 0 ? f.end_s : entered_s;
  return row;
}

ScoreRow score_passes(const SubclavianFacts& f, const SubclavianRubric& rubric, bool harmed) {
  const PassesRubric& r = rubric.passes;
  const double count = double(f.passes.size());
  ScoreRow row{"passes", "Needle passes", 1, "the needle entered nothing", {{"passes_count", count}}, {}, f.end_s};
  row.limits = {{"ideal_count", r.ideal_count}, {"good_count", r.good_count}, {"most_count", r.most_count}};
  if (f.from_scan) return {row.name, row.title, {}, not_shown(f), {}, {}, {}};
  if (f.passes.empty()) return row;
  row.decided_s = f.passes.back().begin_s;
  if (f.vein_s < 0) {  // a prick of the skin is one pass too, and spares nobody one
    row.why = "the vein was never reached";
    return row;
  }
  if (harmed) {
    row.why = unsaved_by("", harmed);
    return row;
  }
  row.score = count <= r.ideal_count.limit ? 5 : count <= r.good_count.limit ? 4 : count <= r.most_count.limit ? 3 : 1;
  row.why = *row.score == 5 ? "as few as can be" : *row.score > 1 ? "several passes" : "too many passes";
  lower_by_speed(row, f, rubric.insertion_mm_per_s);
  return row;
}

texts::Phrase unreached_goal(const SubclavianFacts& f, const SubclavianRubric& r) {
  if (const texts::Phrase unseen = unseen_line(f); !unseen.empty()) return unseen;
  if (f.from_scan) return f.vein_s < 0 ? "the vein was never reached" : "";
  if (f.end != LessonEnd::finished) return name_of(f.end);
  if (f.passes.empty()) return "the needle entered nothing";
  if (f.blood_s < 0) return "no blood was drawn from the vein";
  if (double(f.passes.size()) > r.passes.most_count.limit) return "too many passes";
  return f.procedure_s() > r.time.allotted_s.limit ? "not in the allotted time" : "";
}

void note_critical(const SubclavianFacts& f, const ChestFrame& frame, const std::vector<lesson::CriticalRule>& rules,
                   LessonScore& score) {
  CriticalErrors errors(rules, score);
  if (f.artery_s >= 0) errors.happened("artery", "the artery was entered", f.artery_s);
  if (f.pleura_s >= 0) errors.happened("pleura_or_lung", "the pleura was entered", f.pleura_s);
  if (f.lung_s >= 0) errors.happened("pleura_or_lung", "the lung was entered", f.lung_s);
  if (f.task.empty()) return;
  for (const VeinPass& p : f.passes)
    if (frame.side_of(p.entry_mm) != (f.task == "left" ? 1 : 0))
      errors.happened("wrong_side", "the needle went in on the wrong side", p.begin_s);
}

constexpr texts::Wording higher_words{
    {"Puncture the skin {:.0f} mm more cranially: it was {:.0f} mm below the clavicle's lower border, and up to {:.0f} "
     "mm are ideal.",
     "Stechen Sie {:.0f} mm weiter kranial ein: der Einstich lag {:.0f} mm unter dem Unterrand der Klavikula, ideal "
     "sind "
     "bis zu {:.0f} mm."}};
constexpr texts::Wording lower_words{
    {"Puncture the skin at least {:.0f} mm more caudally: it was {:.0f} mm above the clavicle's lower border.",
     "Stechen Sie mindestens {:.0f} mm weiter kaudal ein: der Einstich lag {:.0f} mm über dem Unterrand der "
     "Klavikula."}};
constexpr texts::Wording turn_words{{"Turn the needle {}: its line passed {} of the sternal notch.",
                                     "Drehen Sie die Nadel {}: ihre Linie verlief {} vom Jugulum."}};
constexpr texts::Wording away_words{{"Point the needle toward the sternal notch: it pointed away from it.",
                                     "Richten Sie die Nadel auf das Jugulum: sie zeigte von ihm weg."}};

// What to do otherwise, of puncture and direction.
std::vector<Advice> advice_of(const SubclavianFacts& f, const ChestFrame& frame, const PunctureRubric& r,
                              const LessonScore& score) {
  std::vector<Advice> all;
  const VeinPass* pass = judged_pass(f);
  if (!pass) return all;
  if (score.lost("puncture")) {
    const double below = frame.below_border_mm(pass->entry_mm);
    Advice a{"puncture", {}};
    for (const texts::Language l : {texts::Language::english, texts::Language::german})
      a.in[std::size_t(l)] = below < 0 ? fmt::format(fmt::runtime(lower_words.of(l)), std::ceil(-below), -below)
                                       : fmt::format(fmt::runtime(higher_words.of(l)),
                                                     std::ceil(below - r.ideal_mm.limit), below, r.ideal_mm.limit);
    all.push_back(a);
  }
  if (!score.lost("direction")) return all;
  const Vec3 way = pass->tip_mm - pass->entry_mm;
  const double off_deg = frame.off_notch_deg(pass->entry_mm, way);
  if (off_deg >= 90) {
    all.push_back({"direction", {away_words.in[0], away_words.in[1]}});
    return all;
  }
  const BodyAxes axes = body_axes(frame.side_of(pass->entry_mm) == 1, frame.left, cross(frame.left, frame.cranial));
  std::vector<NamedPart> off = parts_of(axes, -frame.to_notch(pass->entry_mm, way));
  if (off.empty()) return all;
  off.resize(1);
  std::vector<NamedPart> turn = opposite(off);
  turn.front().size = off_deg;
  all.push_back(lessons::advice_of("direction", turn, PartUnit::degrees, off, turn_words));
  return all;
}

double earlier(double a, double b) { return a < 0 ? b : b < 0 ? a : std::min(a, b); }

}  // namespace

NeedleColour needle_colour(const SubclavianFacts& f, const SubclavianRubric& rubric) {
  const bool failed = f.artery_s >= 0 || f.pleura_s >= 0 || f.lung_s >= 0 ||
                      double(f.passes.size()) > rubric.passes.most_count.limit ||
                      f.procedure_s() > rubric.time.allotted_s.limit || f.end == LessonEnd::device_lost;
  if (failed) return NeedleColour::red;
  if (f.from_scan)
    return f.passes.empty() ? NeedleColour::none : f.vein_s < 0 ? NeedleColour::red : NeedleColour::green;
  if (f.blood_s >= 0) return NeedleColour::green;
  return f.end == LessonEnd::running ? NeedleColour::none : NeedleColour::red;
}

LessonScore score_subclavian(const SubclavianFacts& f, const cases::CaseManifest& manifest,
                             const voxel::HapticVolume& before, const SubclavianRubric& rubric) {
  const ChestShapes shapes = chest_shapes_of(manifest);
  const ChestFrame frame = chest_frame_of(before, shapes);
  const double lung_s = earlier(f.pleura_s, f.lung_s);
  bool lung_known = f.task.empty() ? frame.has_lung[0] && frame.has_lung[1] : frame.has_lung[f.task == "left" ? 1 : 0];
  if (!f.passes.empty() && f.task.empty()) {
    lung_known = true;
    for (const VeinPass& p : f.passes) lung_known = lung_known && frame.has_lung[frame.side_of(p.entry_mm)];
  }
  LessonScore score;
  score.unreached = unreached_goal(f, rubric);
  note_critical(f, frame, rubric.critical_errors, score);
  const bool harmed = !score.critical.empty();
  score.rows = {
      score_puncture(f, frame, rubric.puncture),
      score_direction(f, frame, rubric.direction),
      score_vein(f, shapes, rubric),
      score_untouched(f, "artery", "Artery", shapes.artery != 0, "the case has none", f.artery_s, "the artery"),
      score_untouched(f, "lung", "Pleura and lung", lung_known, "the case shows no lung on that side", lung_s,
                      f.lung_s >= 0 ? "the lung" : "the pleura"),
      score_passes(f, rubric, harmed),
      time_row(f, rubric.time, score.unsaved())};
  score.advice = advice_of(f, frame, rubric.puncture, score);
  const bool success = needle_colour(f, rubric) == NeedleColour::green && f.end == LessonEnd::finished;
  score.figures = {{"success", success},
                   {"first_pass", success && f.passes.size() == 1},
                   {"passes_count", int(f.passes.size())},
                   {"aspirations_count", int(f.aspirations.size())}};
  if (f.from_scan)  // success is blood in few passes and in time
    for (LessonFigure& figure : score.figures) figure.value = std::monostate();
  return score;
}

}  // namespace trephine::lessons
