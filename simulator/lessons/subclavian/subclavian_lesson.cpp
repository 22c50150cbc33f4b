// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lessons/lesson_parts.h"
#include "lessons/lesson_type.h"
#include "lessons/report_pictures.h"
#include "lessons/subclavian/chest_moves.h"
#include "lessons/subclavian/line_scan.h"
#include "lessons/subclavian/subclavian_score.h"

namespace trephine::lessons {
namespace {

using Json = nlohmann::ordered_json;
using detail::PictureMark;

Json list_of(Vec3 v) { return {v.x, v.y, v.z}; }
Json moment(double time_s) { return time_s < 0 ? Json(nullptr) : Json(time_s); }
const SubclavianFacts& own(const LessonFacts& facts) { return static_cast<const SubclavianFacts&>(facts); }

Json json_of(const SubclavianFacts& f) {
  Json passes = Json::array(), aspirations = Json::array();
  const auto at = [&](double time_s) { return f.from_scan ? Json(nullptr) : moment(time_s); };
  for (const VeinPass& p : f.passes)
    passes.push_back({{"begin_s", at(p.begin_s)},
                      {"end_s", at(p.end_s)},
                      {"entry_mm", list_of(p.entry_mm)},
                      {"tip_mm", list_of(p.tip_mm)},
                      {"in_place", p.in_place}});
  for (const Aspiration& a : f.aspirations)
    aspirations.push_back({{"time_s", a.time_s}, {"tip_mm", list_of(a.tip_mm)}, {"shape_number", a.inside}});
  Json out = {{"passes", passes}, {"aspirations", aspirations}};
  Json entered = Json::array();
  for (const auto& [shape, time_s] : {std::pair<const char*, double>{"vein", f.vein_s},
                                      {"artery", f.artery_s},
                                      {"pleura", f.pleura_s},
                                      {"lung", f.lung_s}}) {
    out[std::string(shape) + "_s"] = at(time_s);
    if (time_s >= 0) entered.push_back(shape);
  }
  out["blood_s"] = at(f.blood_s);
  if (f.from_scan) out["entered"] = entered;
  return out;
}

constexpr texts::Wording tip_words{{"The needle's tip", "Die Nadelspitze"}},
    legend_words{
        {"Orange: where the needle's tip went, projected onto the slice. Blue ring: the puncture. Red ring: the "
         "sternal notch. Green: the line from the puncture to it.",
         "Orange: wohin die Nadelspitze ging, auf die Schicht projiziert. Blauer Ring: der Einstich. Roter Ring: "
         "das Jugulum. Grün: die Linie vom Einstich dorthin."}},
    no_ct_words{{" The case holds no CT to show behind it.", " Der Fall hat kein CT, das dahinter stünde."}};

std::string ways_html(const SubclavianFacts& f, const cases::LoadedCase& loaded, texts::Language language) {
  const ChestFrame frame = chest_frame_of(loaded.haptic, chest_shapes_of(loaded.manifest));
  std::vector<PictureMark> marks = {{{frame.notch_mm}, "target"}};
  for (const VeinPass& p : f.passes) {
    PictureMark way{{}, "way"};
    for (const VeinPassPoint& at : p.path) way.points_mm.push_back(at.tip_mm);
    if (way.points_mm.size() > 1) marks.push_back(way);
  }
  std::string out;
  if (!f.passes.empty()) {
    const VeinPass& last = f.passes.back();
    marks.push_back({{last.entry_mm, frame.notch_mm}, "expert"});
    marks.push_back({{last.entry_mm}, "hole"});
    marks.push_back({{last.tip_mm}, "tip"});
    out += std::string("<h2>") + tip_words.of(language) + "</h2>\n" +
           detail::slices_html(loaded, last.tip_mm, marks, language);
  }
  out += std::string("<p class=\"faint\">") + legend_words.of(language);
  return out + (loaded.has_ct() ? "" : no_ct_words.of(language)) + "</p>\n";
}

std::vector<LessonTask> tasks_of(const cases::CaseManifest&) {
  std::vector<LessonTask> all;
  for (const char* side :
       {"right", "left"})  // the right is the usual one: its pleura lies lower, without a thoracic duct
    all.push_back(
        {side,
         fmt::format("A needle under the {} clavicle toward the sternal notch: blood from the subclavian vein "
                     "at the first pass.",
                     side),
         "A central line: drugs that no small vein bears, and no vein of the arm is left.",
         fmt::format("Eine Nadel unter dem {} Schlüsselbein zum Jugulum: Blut aus der Vena subclavia beim ersten "
                     "Durchgang.",
                     side == std::string("left") ? "linken" : "rechten"),
         "Ein zentraler Zugang: Medikamente, die keine kleine Vene verträgt, und am Arm ist keine Vene übrig."});
  return all;
}

texts::Phrase of_scan(const SubclavianFacts& f) {
  if (const texts::Phrase unseen = unseen_line(f); !unseen.empty()) return unseen;
  return f.vein_s >= 0 ? "the line came into the vein" : "the line came into no vein";
}

// Drapes leave the whole clavicle of the side that was asked for open, with the notch: what everybody sees and feels.
LessonField field_of(const SubclavianFacts& f) {
  constexpr double beyond_mm = 25;
  const Vec3 middle = f.clavicle_mm[f.task == "left" ? 1 : 0];
  const double open = norm(f.notch_mm - middle) + beyond_mm;
  return {middle, open, open + 2 * beyond_mm, {0, 1, 0}, {0, -1, 0}};
}

// Blood of the vein is shown as long as the tip is in it.
lesson::Fluid syringe_of(const SubclavianFacts& f) {
  return f.syringe == lesson::Fluid::venous_blood && f.blood_s < 0 ? lesson::Fluid::none : f.syringe;
}

std::vector<LessonStatus> status_of(const SubclavianFacts& f) {
  const lesson::Fluid holds = syringe_of(f);
  return {{"passes_count", "Passes", std::to_string(f.passes.size())},
          {"aspirations_count", "Aspirations", std::to_string(f.aspirations.size())},
          {"syringe", "Syringe",
           holds == lesson::Fluid::venous_blood     ? "blood"
           : holds == lesson::Fluid::arterial_blood ? "bright blood"
           : holds == lesson::Fluid::air            ? "air"
           : f.aspirations.empty()                  ? "-"
                                                    : "none"}};
}

}  // namespace

LessonType subclavian_lesson() {
  LessonType m;
  m.name = "subclavian";
  m.german_title = "Zugang zur Vena subclavia";
  m.summary = "a needle under the clavicle into the subclavian vein";
  m.rows = {"puncture", "direction", "vein", "artery", "lung", "passes", "time"};
  m.columns = {measured_for("puncture", "below_border_mm"),
               measured_for("direction", "off_notch_deg"),
               measured_for("time", "procedure_s"),
               {"success", "1 or 0: blood from the vein, and no failure", ""},
               {"first_pass", "1 or 0: success at the first pass", ""},
               {"passes_count", "how often the needle entered the skin", ""},
               {"aspirations_count", "how often somebody aspirated", ""}};
  m.steps = with_common_steps({script_step<PunctureStep>("puncture", "Moves the needle straight into the chest."),
                               script_step("aspirate", "Draws at the syringe.")});
  m.require = [](const cases::CaseManifest& manifest) { chest_shapes_of(manifest); };
  m.tasks = tasks_of;
  m.tools = subclavian_tools;
  m.plan = plan_chest_moves;
  m.begin = [](const cases::CaseManifest& manifest, const voxel::HapticVolume& before, const voxel::HapticVolume&) {
    return std::unique_ptr<Lesson>(std::make_unique<Subclavian>(manifest, before));
  };
  m.score = [](const LessonFacts& facts, const cases::LoadedCase& loaded, const voxel::HapticVolume& before,
               const AnyParams& rubric) {
    return score_subclavian(own(facts), loaded.manifest, before, rubric.as<SubclavianRubric>());
  };
  m.texts = {{"Pass the needle toward the sternal notch", "Nadel zum Jugulum führen"},
             {"Flat under the clavicle, toward the notch, the needle passes over the lung.",
              "Flach unter dem Schlüsselbein, zum Jugulum hin, geht die Nadel über der Lunge vorbei."},
             {"A give in the vein's wall.", "Ein Nachgeben der Venenwand."},
             {"Aspirate", "Aspirieren"},
             {"Blood alone shows that the tip is in the vein.", "Nur Blut zeigt, dass die Spitze in der Vene liegt."},
             {"Dark blood, without a pulse.", "Dunkles Blut, ohne Puls."},
             {"Blood still comes.", "Es kommt noch immer Blut."},
             {"Aspirations", "Aspirationen"},
             {"Syringe", "Spritze"},
             {"blood", "Blut"},
             {"bright blood", "hellrotes Blut"},
             {"air", "Luft"},
             {"none", "nichts"}};
  append(m.texts, subclavian_words());
  m.guide = [](const LessonFacts& facts) {
    const SubclavianFacts& f = own(facts);
    return std::vector<LessonGuide>{
        {"Pass the needle toward the sternal notch", "needle", "",
         "Flat under the clavicle, toward the notch, the needle passes over the lung.", "A give in the vein's wall.",
         is_still_in(f)},
        {"Aspirate", "", "aspirate", "Blood alone shows that the tip is in the vein.", "Dark blood, without a pulse.",
         is_still_in(f) && f.blood_s >= 0},
        {"Finish the lesson", "", "finish", "What is left in place is judged.", "Blood still comes."}};
  };
  m.status = [](const LessonFacts& facts) { return status_of(own(facts)); };
  m.field = [](const LessonFacts& facts, const cases::CaseManifest&) { return field_of(own(facts)); };
  m.fluid = [](const LessonFacts& facts, const cases::CaseManifest&) { return syringe_of(own(facts)); };
  m.verdict = [](const LessonFacts& facts, const AnyParams& rubric) {
    const NeedleColour c = needle_colour(own(facts), rubric.as<SubclavianRubric>());
    return c == NeedleColour::none ? 0 : c == NeedleColour::green ? 1 : -1;
  };
  m.facts_json = [](const LessonFacts& facts) { return json_of(own(facts)); };
  m.facts_of_outcome = line_facts_of_scan;
  m.outcome = [](const LessonFacts& facts, const LessonScore& score) {
    if (facts.from_scan) return of_scan(own(facts));
    return texts::Phrase("needle passes: {}, {}", {std::to_string(score.count("passes_count")),
                                                   score.flag("first_pass") ? "green: success at the first pass"
                                                   : score.flag("success")  ? "green: blood from the vein"
                                                                            : "red: failure"});
  };
  m.headline = [](const LessonFacts& facts, const LessonScore& score) {
    if (facts.from_scan) return of_scan(own(facts));
    return texts::Phrase("needle passes: {}, {}",
                         {std::to_string(score.count("passes_count")), score.flag("success") ? "green" : "red"});
  };
  m.pictures = [](const LessonFacts& facts, const cases::LoadedCase& loaded, texts::Language language) {
    return ways_html(own(facts), loaded, language);
  };
  return m;
}

}  // namespace trephine::lessons
