// SPDX-License-Identifier: GPL-3.0-or-later
// What to do otherwise: each sentence says a direction in the frame of this head, and where it was missed.
#include <fmt/format.h>

#include <cmath>

#include "lessons/ventriculostomy/score_parts.h"

namespace trephine::lessons::detail {
namespace {

using texts::Wording;

constexpr Wording hole_words{
    {"Place the hole {}: it lay {} of Kocher's point.", "Setzen Sie das Bohrloch {}: es lag {} von Kochers Punkt."}};
constexpr Wording aim_words{{"Aim {}: your line passed {} of the foramen of Monro.",
                             "Zielen Sie {}: Ihre Linie verlief {} vom Foramen Monroi."}};
constexpr Wording tip_words{{"Bring the tip {}: it lay {} of the foramen of Monro.",
                             "Bringen Sie die Spitze {}: sie lag {} vom Foramen Monroi."}};
constexpr Wording deeper_words{
    {"Push the catheter {:.0f} mm farther: its tip lay {:.0f} mm below the {}, and {:.0f} to {:.0f} mm are ideal.",
     "Schieben Sie den Katheter {:.0f} mm weiter vor: die Spitze lag {:.0f} mm unter der {}, ideal sind {:.0f} bis "
     "{:.0f} mm."}};
constexpr Wording shallower_words{
    {"Stop {:.0f} mm earlier: the catheter's tip lay {:.0f} mm below the {}, and {:.0f} to {:.0f} mm are ideal.",
     "Halten Sie {:.0f} mm früher an: die Spitze des Katheters lag {:.0f} mm unter der {}, ideal sind {:.0f} bis "
     "{:.0f} "
     "mm."}};
constexpr Wording inner_table{{"inner table", "inneren Tafel"}}, outer_table{{"outer table", "äußeren Tafel"}};
constexpr Wording midline_left{{"Draw the line of the midline {:.0f} mm farther to the patient's left.",
                                "Zeichnen Sie die Linie der Mitte {:.0f} mm weiter zur linken Seite des Patienten."}};
constexpr Wording midline_right{{"Draw the line of the midline {:.0f} mm farther to the patient's right.",
                                 "Zeichnen Sie die Linie der Mitte {:.0f} mm weiter zur rechten Seite des Patienten."}};
constexpr Wording suture_front{{"Draw the line of the suture {:.0f} mm more anteriorly.",
                                "Zeichnen Sie die Linie der Kranznaht {:.0f} mm weiter nach anterior."}};
constexpr Wording suture_back{{"Draw the line of the suture {:.0f} mm more posteriorly.",
                               "Zeichnen Sie die Linie der Kranznaht {:.0f} mm weiter nach posterior."}};

void say_line(std::vector<Advice>& all, const BestTrace& trace, double limit_mm, const Wording& plus,
              const Wording& minus) {
  if (!trace.any() || trace.off_mm() <= limit_mm) return;
  Advice a{"landmarks", {}};
  for (const texts::Language l : {texts::Language::english, texts::Language::german})
    a.in[std::size_t(l)] = fmt::format(fmt::runtime((trace.signed_off_mm < 0 ? plus : minus).of(l)), trace.off_mm());
  all.push_back(a);
}

Advice depth_advice(const DepthRubric& r, double depth) {
  const bool deeper = depth < r.ideal_low_mm.limit;
  const double by = deeper ? r.ideal_low_mm.limit - depth : depth - r.ideal_high_mm.limit;
  const Wording& table = r.measured_from == DepthRubric::From::outer_table ? outer_table : inner_table;
  Advice a{"depth", {}};
  for (const texts::Language l : {texts::Language::english, texts::Language::german})
    a.in[std::size_t(l)] =
        fmt::format(fmt::runtime((deeper ? deeper_words : shallower_words).of(l)), std::max(1.0, std::round(by)), depth,
                    table.of(l), r.ideal_low_mm.limit, r.ideal_high_mm.limit);
  return a;
}

}  // namespace

std::vector<Advice> advice_of(const Scoring& s, const LessonScore& score) {
  std::vector<Advice> all;
  const BodyAxes axes = body_axes(s.on_left(), s.frame.left, s.frame.forwards);
  const auto say = [&](const char* row, const std::vector<NamedPart>& more, PartUnit unit,
                       const std::vector<NamedPart>& place, const Wording& words) {
    if (!more.empty()) all.push_back(lessons::advice_of(row, more, unit, place, words));
  };
  if (score.lost("landmarks")) {
    say_line(all, best_midline(s), s.rubric.landmarks.midline_mm.limit, midline_left, midline_right);
    say_line(all, best_suture(s), s.rubric.landmarks.suture_mm.limit, suture_front, suture_back);
  }
  const bool sided = s.side_known();  // else medial and lateral mean nothing
  const cases::CaseLandmark* kocher = find_landmark(s.manifest, s.on_left() ? "kocher_left" : "kocher_right");
  // On the other side the failure says it all.
  const auto on_side = [&](Vec3 at) { return (s.frame.left_of_midline_mm(at) > 0) == s.on_left(); };
  if (sided && score.lost("burr_hole") && kocher && s.facts.hole && s.facts.hole->drilled &&
      on_side(worst_hole(s, *kocher).outer_mm)) {
    const BoneHole& hole = worst_hole(s, *kocher);
    const std::vector<NamedPart> off = parts_across(axes, hole.out, hole.outer_mm - kocher->position_mm);
    say("burr_hole", opposite(off), PartUnit::mm, off, hole_words);
  }
  const std::optional<Vec3> foramen = s.foramen();
  if (!s.facts.passes.empty() && !on_side(s.facts.passes.back().entry_mm)) return all;
  if (sided && score.lost("trajectory") && foramen && !s.facts.passes.empty()) {
    const LineMiss m = line_miss(s.facts.passes.back(), *foramen);
    const std::vector<NamedPart> off = parts_across(axes, m.way, -m.to_foramen_mm);
    if (m.length_mm > 0) say("trajectory", as_turns(opposite(off), m.length_mm), PartUnit::degrees, off, aim_words);
  }
  const CatheterPass* pass = s.final_pass();
  if (!pass) return all;
  if (score.lost("depth")) {
    const DepthRubric& r = s.rubric.depth;
    const double depth = depth_mm(s, *pass);
    const bool ideal = depth >= r.ideal_low_mm.limit && depth <= r.ideal_high_mm.limit;  // and was drawn back to there
    all.push_back(depth_advice(r, ideal ? deepest(s).depth_mm : depth));
  }
  if (sided && score.lost("tip") && foramen) {
    const std::vector<NamedPart> off = parts_of(axes, pass->path.back().tip_mm - *foramen);
    say("tip", opposite(off), PartUnit::mm, off, tip_words);
  }
  return all;
}

}  // namespace trephine::lessons::detail
