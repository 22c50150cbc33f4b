// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine/spine_advice.h"

#include <fmt/format.h>

#include <cmath>

namespace trephine::lessons {
namespace {

using texts::Language;
using texts::Wording;

constexpr Wording entry_words{{"Enter {}: your line passed {} of the ideal entry.",
                               "Gehen Sie {} ein: Ihre Linie verlief {} vom idealen Eintritt."}};
constexpr Wording target_words{
    {"Aim {}: your line passed {} of the target.", "Zielen Sie {}: Ihre Linie verlief {} vom Ziel."}};
constexpr Wording parallel_words{
    {"Keep the direction and mend the entry: your line passed {} of the target, as it did of the entry.",
     "Behalten Sie die Richtung und verbessern Sie den Eintritt: Ihre Linie verlief {} vom Ziel, so wie vom "
     "Eintritt."}};
constexpr Wording axial_words{
    {"Seen from above, turn the screw {}.", "Drehen Sie die Schraube, von oben gesehen, {}."}};
constexpr Wording sagittal_words{
    {"Seen from the side, turn the screw {}.", "Drehen Sie die Schraube, von der Seite gesehen, {}."}};
constexpr Wording finder_axial_words{
    {"Seen from above, turn the finder {}.", "Drehen Sie den Pfriem, von oben gesehen, {}."}};
constexpr Wording finder_sagittal_words{
    {"Seen from the side, turn the finder {}.", "Drehen Sie den Pfriem, von der Seite gesehen, {}."}};
constexpr Wording farther_words{{"Go {:.0f} mm farther: the tip lay {:.0f} mm before the target.",
                                 "Gehen Sie {:.0f} mm weiter: die Spitze lag {:.0f} mm vor dem Ziel."}};
constexpr Wording earlier_words{{"Stop {:.0f} mm earlier: the tip lay {:.0f} mm beyond the target.",
                                 "Halten Sie {:.0f} mm früher an: die Spitze lag {:.0f} mm hinter dem Ziel."}};
struct BreachWords {
  const char* side;
  Wording words;
};
constexpr BreachWords breach_words[] = {
    {"medial",
     {{"Keep more laterally: the tool came {:.1f} mm through the medial wall.",
       "Bleiben Sie weiter lateral: das Instrument kam {:.1f} mm durch die mediale Wand."}}},
    {"lateral",
     {{"Keep more medially: the tool came {:.1f} mm through the lateral wall.",
       "Bleiben Sie weiter medial: das Instrument kam {:.1f} mm durch die laterale Wand."}}},
    {"upper",
     {{"Keep more caudally: the tool came {:.1f} mm through the upper wall.",
       "Bleiben Sie weiter kaudal: das Instrument kam {:.1f} mm durch die obere Wand."}}},
    {"lower",
     {{"Keep more cranially: the tool came {:.1f} mm through the lower wall.",
       "Bleiben Sie weiter kranial: das Instrument kam {:.1f} mm durch die untere Wand."}}}};

BodyAxes axes_of(const CasePedicle& p) { return body_axes(p.on_left(), p.left, p.anterior()); }

Advice in_both(const std::string& row, const Wording& words, double a, double b) {
  Advice out{row, {}};
  for (const Language l : {Language::english, Language::german})
    out.in[std::size_t(l)] = fmt::format(fmt::runtime(words.of(l)), a, b);
  return out;
}

void say_entry(std::vector<Advice>& all, const LessonScore& score, const BodyAxes& axes, Vec3 forwards, Vec3 off_mm) {
  if (!score.lost("entry")) return;
  const std::vector<NamedPart> off = parts_across(axes, forwards, off_mm);
  if (!off.empty()) all.push_back(advice_of("entry", opposite(off), PartUnit::mm, off, entry_words));
}

}  // namespace

std::vector<Advice> pedicle_advice(const LessonScore& score, const NeedleErrors& e) {
  std::vector<Advice> all;
  const CasePedicle& p = *e.pedicle;
  const BodyAxes axes = axes_of(p);
  const Vec3 f = p.forwards();
  say_entry(all, score, axes, f, e.entry_off);
  if (!score.lost("target")) return all;
  const std::vector<NamedPart> off = parts_across(axes, f, e.target_off);
  const std::vector<NamedPart> lean = parts_across(axes, f, e.target_off - e.entry_off);
  const std::vector<NamedPart> turn = as_turns(opposite(lean), norm(p.target_mm - p.entry_mm));
  if (off.empty()) return all;
  if (turn.empty()) {
    Advice a{"target", {}};
    for (const Language l : {Language::english, Language::german})
      a.in[std::size_t(l)] = fmt::format(fmt::runtime(parallel_words.of(l)), place_words(off, l));
    all.push_back(a);
  } else {
    all.push_back(advice_of("target", turn, PartUnit::degrees, off, target_words));
  }
  return all;
}

std::vector<Advice> five_errors_advice(const LessonScore& score, const NeedleErrors& e, Vec3 entry_off_mm,
                                       double left_deg, double up_deg, bool of_screw) {
  std::vector<Advice> all;
  const CasePedicle& p = *e.pedicle;
  const BodyAxes axes = axes_of(p);
  say_entry(all, score, axes, p.anterior(), entry_off_mm);
  const auto turned = [&](const char* row, Vec3 lean_deg, const Wording& words) {
    const std::vector<NamedPart> lean = parts_of(axes, lean_deg);
    if (score.lost(row) && !lean.empty()) all.push_back(advice_of(row, opposite(lean), PartUnit::degrees, {}, words));
  };
  turned("axial", p.left * left_deg, of_screw ? axial_words : finder_axial_words);
  turned("sagittal", p.cranial * up_deg, of_screw ? sagittal_words : finder_sagittal_words);
  return all;
}

Advice depth_advice(const std::string& row, double beyond_mm) {
  const double by = std::abs(beyond_mm);
  return in_both(row, beyond_mm < 0 ? farther_words : earlier_words, by, by);
}

Advice breach_advice(const PedicleBreach& breach) {
  for (const BreachWords& b : breach_words)
    if (breach.side == b.side) return in_both("breach", b.words, breach.depth_mm, 0);
  return {"breach", {}};
}

}  // namespace trephine::lessons
