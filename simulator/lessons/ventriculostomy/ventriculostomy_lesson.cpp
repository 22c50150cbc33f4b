// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "lessons/lesson_parts.h"
#include "lessons/lesson_type.h"
#include "lessons/report_pictures.h"
#include "lessons/ventriculostomy/head_moves.h"
#include "lessons/ventriculostomy/scan_facts.h"
#include "lessons/ventriculostomy/ventriculostomy_score.h"

namespace trephine::lessons {
namespace {

using Json = nlohmann::ordered_json;
using detail::PictureMark;

Json list_of(Vec3 v) { return {v.x, v.y, v.z}; }
Json moment(double time_s) { return time_s < 0 ? Json(nullptr) : Json(time_s); }

Json json_of(const VentriculostomyFacts& f) {
  Json traces = Json::array(), incisions = Json::array(), passes = Json::array();
  for (const MarkerTrace& t : f.traces)
    traces.push_back({{"begin_s", t.begin_s},
                      {"end_s", t.end_s},
                      {"length_mm", t.length_mm},
                      {"erased", t.erased},
                      {"from_mm", list_of(t.points_mm.front())},
                      {"to_mm", list_of(t.points_mm.back())}});
  for (const LessonIncision& i : f.incisions) incisions.push_back({{"time_s", i.time_s}, {"at_mm", list_of(i.at_mm)}});
  for (const CatheterPass& p : f.passes)
    passes.push_back({{"begin_s", p.begin_s},
                      {"end_s", p.end_s},
                      {"entry_mm", list_of(p.entry_mm)},
                      {"tip_mm", list_of(p.path.back().tip_mm)},
                      {"csf_s", moment(p.csf_s)},
                      {"in_place", p.in_place}});
  Json out = {{"drilled_beforehand", f.drilled_beforehand}, {"traces", traces},     {"incisions", incisions},
              {"drill_begin_s", moment(f.drill_begin_s)},   {"drill_s", f.drill_s}, {"burr_mm", f.burr_mm},
              {"through_s", moment(f.through_s)},           {"hole", nullptr},      {"passes", passes}};
  if (f.dura) {
    Json pops = Json::array();
    for (const DuraPop& p : f.dura->pops)
      pops.push_back({{"time_s", p.time_s}, {"at_mm", list_of(p.at_mm)}, {"force_n", p.force_n}});
    out["dura"] = {{"pops", pops},
                   {"burr_first_s", moment(f.dura->burr_first_s)},
                   {"burr_s", f.dura->burr_s},
                   {"burr_n", f.dura->burr_n},
                   {"breached", f.dura->breach.has_value()}};
  }
  Json holes = Json::array();
  for (const BoneHole& h : f.holes)
    holes.push_back({{"begin_s", moment(h.begin_s)},
                     {"outer_mm", list_of(h.outer_mm)},
                     {"removed_mm3", h.removed_mm3},
                     {"through", h.through}});
  out["holes"] = holes;
  if (f.hole)
    out["hole"] = {{"outer_mm", list_of(f.hole->outer_mm)},
                   {"inner_mm", list_of(f.hole->inner_mm)},
                   {"out", list_of(f.hole->out)},
                   {"removed_mm3", f.hole->removed_mm3},
                   {"through", f.hole->through},
                   {"drilled", f.hole->drilled}};
  return out;
}

constexpr texts::Wording hole_words{{"The burr hole", "Das Bohrloch"}},
    tip_words{{"The catheter's tip", "Die Katheterspitze"}},
    legend_words{
        {"Orange: what was drawn and where the catheter's tip went, projected onto the slice. Blue ring: the hole. "
         "Red ring: the foramen of Monro on that side. Green: the straight way from this hole to it.",
         "Orange: was gezeichnet wurde und wohin die Katheterspitze ging, auf die Schicht projiziert. Blauer "
         "Ring: das Bohrloch. Roter Ring: das Foramen Monroi dieser Seite. Grün: der gerade Weg von diesem Loch "
         "dorthin."}},
    no_ct_words{{" The case holds no CT to show behind it.", " Der Fall hat kein CT, das dahinter stünde."}};

std::string ways_html(const VentriculostomyFacts& facts, const cases::LoadedCase& loaded, texts::Language language) {
  std::vector<PictureMark> marks;
  for (const MarkerTrace& t : facts.traces)
    if (t.points_mm.size() > 1) marks.push_back({t.points_mm, "way"});
  for (const CatheterPass& pass : facts.passes) {
    PictureMark way{{}, "way"};
    for (const PassPoint& p : pass.path) way.points_mm.push_back(p.tip_mm);
    if (way.points_mm.size() > 1) marks.push_back(way);
  }
  const HeadFrame frame = head_frame_of(loaded.manifest);
  std::optional<Vec3> target;
  if (facts.hole) {
    target = foramen_of(loaded.manifest, frame.left_of_midline_mm(facts.hole->outer_mm) > 0);
    marks.push_back({{facts.hole->outer_mm}, "hole"});
    if (target) marks.push_back({{facts.hole->outer_mm, *target}, "expert"});
  }
  if (target) marks.push_back({{*target}, "target"});
  std::string out;
  if (facts.hole)
    out += std::string("<h2>") + hole_words.of(language) + "</h2>\n" +
           detail::slices_html(loaded, facts.hole->outer_mm, marks, language);
  if (!facts.passes.empty()) {
    const Vec3 tip = facts.passes.back().path.back().tip_mm;
    marks.push_back({{tip}, "tip"});
    out += std::string("<h2>") + tip_words.of(language) + "</h2>\n" + detail::slices_html(loaded, tip, marks, language);
  }
  out += std::string("<p class=\"faint\">") + legend_words.of(language);
  return out + (loaded.has_ct() ? "" : no_ct_words.of(language)) + "</p>\n";
}

const VentriculostomyFacts& own(const LessonFacts& facts) { return static_cast<const VentriculostomyFacts&>(facts); }

// Where the skull was drilled beforehand there must be a hole on that side: through the other side's no catheter goes.
bool may_be_entered(const cases::CaseManifest& manifest, bool left) {
  const auto own = foramen_of(manifest, left), other = foramen_of(manifest, !left);
  const auto& holes = manifest.burr_holes;
  return holes.empty() || !own || !other || std::any_of(holes.begin(), holes.end(), [&](const auto& hole) {
           return norm(hole.position_mm - *own) < norm(hole.position_mm - *other);
         });
}

std::string side_doubt(const cases::CaseManifest& manifest, bool left) {
  double foramen = 1;
  foramen_of(manifest, left, &foramen);
  std::string doubt = foramen < sure_confidence ? "the foramen of Monro: " + doubt_words(foramen) : "";
  const cases::CaseLandmark* kocher = find_landmark(manifest, left ? "kocher_left" : "kocher_right");
  if (manifest.burr_holes.empty() && kocher && kocher->confidence < sure_confidence)
    doubt += (doubt.empty() ? "" : "; ") + ("Kocher's point: " + doubt_words(kocher->confidence));
  return doubt;
}

std::vector<LessonTask> tasks_of(const cases::CaseManifest& manifest) {
  std::vector<LessonTask> all;
  for (const bool left : {false, true}) {  // the right is the usual one: it is seldom the dominant hemisphere
    const char* side = left ? "left" : "right";
    if (foramen_of(manifest, left))
      all.push_back({side,
                     fmt::format("An external ventricular drain through Kocher's point on the {0}: its tip in the {0} "
                                 "lateral ventricle, at the foramen of Monro, at the first pass.",
                                 side),
                     "Acute hydrocephalus: CSF has to be drained, and the pressure in the head to be measured.",
                     fmt::format("Eine externe Ventrikeldrainage durch Kochers Punkt {}: die Spitze im {} "
                                 "Seitenventrikel, am Foramen Monroi, beim ersten Durchgang.",
                                 left ? "links" : "rechts", left ? "linken" : "rechten"),
                     "Akuter Hydrozephalus: Liquor muss abfließen, und der Druck im Kopf ist zu messen.",
                     side_doubt(manifest, left), may_be_entered(manifest, left)});
  }
  return all;
}

std::vector<LessonGuide> guide_of(const VentriculostomyFacts& f) {
  std::vector<LessonGuide> steps;
  const bool erased = std::any_of(f.traces.begin(), f.traces.end(), [](const MarkerTrace& t) { return t.erased; });
  if (!f.drilled_beforehand)
    steps = {
        {"Mark: the pedal draws", "marker", "",
         "Kocher's point lies 11 cm behind the nasion and 3 cm beside the midline, before the coronal suture.",
         "The line of the midline runs from the nasion; the other crosses it at the suture.",
         f.traces.size() > 1 && f.traces.back().end_s < f.end_s},
        {"Erase the traces", "", "erase", "Nothing but the last mark guides the hole.", "The skin is bare.", erased},
        {"Incise the skin at the last mark", "", "incise", "The burr must not wind the skin up.", "Bone lies open.",
         !f.incisions.empty()},
        {"Drill: the pedal runs the burr", "burr*", "",
         "The hole is as wide as the catheter needs, and upright on the skull.",
         "The inner table gives way; lift the pedal before the dura is pressed.", f.through_s >= 0}};
  steps.push_back({"Pass the catheter", "catheter", "",
                   "Upright on the skull it points at the foramen of Monro, 5 to 6 cm below the inner table.",
                   "A give, and CSF comes.", is_still_in(f) && f.passes.back().csf_s >= 0});
  steps.push_back({"Finish the lesson", "", "finish", "What is left in place is judged.", "CSF drains."});
  return steps;
}

std::vector<LessonStatus> status_of(const VentriculostomyFacts& f) {
  std::vector<LessonStatus> all;
  if (!f.drilled_beforehand) {
    const double trace_mm = f.traces.empty() ? 0 : f.traces.back().length_mm;
    all = {{"trace_mm", "Last trace, mm", fmt::format("{:.0f}", trace_mm)},
           {"traces_count", "Traces", std::to_string(f.traces.size())},
           {"incisions_count", "Incisions", std::to_string(f.incisions.size())},
           {"hole", "Hole",
            f.through_s >= 0 ? "through"
            : f.hole         ? "not through"
                             : "-"}};
  }
  if (f.dura)
    all.push_back({"dura", "Dura",
                   f.dura->breach              ? "breached by the burr"
                   : !f.dura->pops.empty()     ? "passed"
                   : f.dura->burr_first_s >= 0 ? "reached by the burr"
                                               : "-"});
  all.push_back({"passes_count", "Passes", std::to_string(f.passes.size())});
  return all;
}

std::vector<Vec3> ink_of(const VentriculostomyFacts& f) {
  std::vector<Vec3> dots;
  for (const MarkerTrace& t : f.traces)
    if (!t.erased) dots.insert(dots.end(), t.points_mm.begin(), t.points_mm.end());
  return dots;
}

// Marks are made on the bare head, in a light that tells nothing of where they belong, by a surgeon who stands behind
// the head on the side that was asked for; then it is draped about the cut.
LessonField field_of(const VentriculostomyFacts& f, const cases::CaseManifest& manifest) {
  constexpr double open_mm = 48, lamp_mm = 110;
  if (f.drilled_beforehand && f.hole) return {f.hole->outer_mm, open_mm, lamp_mm, {0, 1, 0}, {}};
  if (!f.incisions.empty()) return {f.incisions.back().at_mm, open_mm, lamp_mm, {0, 1, 0}, {}};
  const HeadFrame frame = head_frame_of(manifest);
  const Vec3 from = normalized(Vec3{f.task == "left" ? 0.42 : -0.42, -0.55, 0.75});
  return {frame.bregma_mm ? *frame.bregma_mm : frame.nasion_mm, 0, 150, {0, 1, 0}, from};
}

// A catheter drains as long as its tip is in the ventricles.
lesson::Fluid fluid_of(const VentriculostomyFacts& f, const cases::CaseManifest& manifest) {
  return is_still_in(f) && !f.passes.back().path.empty() &&
                 f.passes.back().path.back().inside == head_shapes_of(manifest).ventricles
             ? lesson::Fluid::csf
             : lesson::Fluid::none;
}

texts::Phrase outcome(const LessonFacts& facts, const LessonScore& score) {
  if (facts.from_volume) {
    const std::optional<BoneHole>& hole = own(facts).hole;
    return !hole           ? "no hole was drilled"
           : hole->through ? "the hole lets the catheter through"
                           : "the hole does not let the catheter through";
  }
  if (facts.from_scan)
    return facts.seen == lesson::Sighting::doubtful ? "what the CT shows of a catheter is doubtful"
           : !score.known("in_ventricle")           ? "the CT shows no catheter"
           : score.flag("third_ventricle")          ? "the catheter lies in the third ventricle"
           : score.flag("contralateral")            ? "the catheter lies in the contralateral ventricle"
           : score.flag("in_ventricle")             ? "the catheter lies in a ventricle"
                                                    : "the catheter lies in no ventricle";
  return {"catheter passes: {}, {}",
          {std::to_string(score.count("passes_count")),
           score.flag("third_ventricle") ? "the catheter lies in the third ventricle"
           : score.flag("contralateral") ? "the catheter lies in the contralateral ventricle"
           : score.flag("first_pass")    ? "success at the first pass"
           : score.flag("in_ventricle")  ? "the catheter lies in a ventricle"
                                         : "the catheter lies in no ventricle"}};
}

}  // namespace

LessonType ventriculostomy_lesson() {
  LessonType m;
  m.name = "ventriculostomy";
  m.german_title = "Ventrikeldrainage";
  m.summary = "a burr hole, and a catheter into the ventricle";
  m.rows = {"landmarks", "burr_hole", "trajectory", "depth", "tip", "time", "passes"};
  m.columns = {measured_for("burr_hole", "kocher_off_mm"),
               measured_for("trajectory", "line_off_foramen_mm"),
               measured_for("trajectory", "beyond_midline_mm"),
               measured_for("depth", "depth_mm"),
               measured_for("tip", "foramen_off_mm"),
               measured_for("time", "procedure_s"),
               {"passes_count", "how often the catheter entered the brain", ""}};
  for (const char* name : {"in_ventricle", "first_pass", "contralateral", "third_ventricle"})
    m.columns.push_back({name, "1 or 0, of the catheter's last place", ""});
  m.columns.push_back(
      {"kakarla_grade", "1 to 3, of the catheter's last place; empty where the case does not show it", ""});
  m.columns.push_back({"dura_passed", "1 or 0: a catheter gave way through the dura; empty where none is felt", ""});
  m.columns.push_back({"dura_breached", "1 or 0: the burr pressed on the dura with more than it bears", ""});
  m.columns.push_back({"burr_on_dura_n", "the largest force of the running burr while it touched the dura", ""});
  m.steps = with_common_steps({script_step<TraceStep>("trace", "Draws a line on the skin with the pedal down."),
                               script_step("erase", "Takes the lines away."),
                               script_step("incise", "Cuts the skin around the last point of the marker."),
                               script_step("undo", "Takes back the last stroke of the drill or the last incision."),
                               script_step("reset", "Takes back all that was cut."),
                               script_step<DrillStep>("drill", "Drills a hole with the pedal down."),
                               script_step<InsertStep>("insert", "Moves the tool on a straight line into the head.")});
  m.classes = {"normal", "hydrocephalic", "shifted", "small"};
  m.require = [](const cases::CaseManifest& manifest) {
    head_shapes_of(manifest);
    head_frame_of(manifest);
    if (!foramen_of(manifest, false) && !foramen_of(manifest, true))
      throw Error(ExitCode::bad_input, "", "landmarks",
                  "the lesson needs a foramen of Monro as its target: monro_right or monro_left, found or given");
  };
  m.tasks = tasks_of;
  m.tools = ventriculostomy_tools;
  m.second = {{"suction", "irrigation"}, {"dura", "brain", "ventricles"}};
  m.plan = plan_head_moves;
  m.begin = [](const cases::CaseManifest& manifest, const voxel::HapticVolume& before, const voxel::HapticVolume& now) {
    return std::unique_ptr<Lesson>(std::make_unique<Ventriculostomy>(manifest, before, now));
  };
  m.score = [](const LessonFacts& facts, const cases::LoadedCase& loaded, const voxel::HapticVolume& before,
               const AnyParams& rubric) {
    return score_ventriculostomy(own(facts), loaded.manifest, before, rubric.as<VentriculostomyRubric>(),
                                 CriticalZones(loaded));
  };
  m.texts = {{"burr {} mm", "Bohrer {} mm"},
             {"burr diamond {} mm", "Diamantbohrer {} mm"},
             {"suction", "Sauger"},
             {"irrigation", "Spülung"},
             {"Mark: the pedal draws", "Anzeichnen: das Pedal zeichnet"},
             {"Erase the traces", "Spuren löschen"},
             {"Incise the skin at the last mark", "Haut an der letzten Marke einschneiden"},
             {"Drill: the pedal runs the burr", "Bohren: das Pedal treibt den Bohrer"},
             {"Pass the catheter", "Katheter einführen"},
             {"Kocher's point lies 11 cm behind the nasion and 3 cm beside the midline, before the coronal suture.",
              "Kochers Punkt liegt 11 cm hinter dem Nasion und 3 cm neben der Mittellinie, vor der Kranznaht."},
             {"The line of the midline runs from the nasion; the other crosses it at the suture.",
              "Die Linie der Mitte beginnt am Nasion; die andere kreuzt sie an der Kranznaht."},
             {"Nothing but the last mark guides the hole.", "Nur die letzte Marke führt zum Bohrloch."},
             {"The skin is bare.", "Auf der Haut ist nichts mehr zu sehen."},
             {"The burr must not wind the skin up.", "Der Bohrer darf die Haut nicht aufwickeln."},
             {"Bone lies open.", "Der Knochen liegt frei."},
             {"The hole is as wide as the catheter needs, and upright on the skull.",
              "Das Loch ist so weit, wie der Katheter es braucht, und steht senkrecht auf dem Schädel."},
             {"The inner table gives way; lift the pedal before the dura is pressed.",
              "Die innere Tafel gibt nach; das Pedal loslassen, bevor die Dura gedrückt wird."},
             {"Upright on the skull it points at the foramen of Monro, 5 to 6 cm below the inner table.",
              "Senkrecht auf dem Schädel zeigt er zum Foramen Monroi, 5 bis 6 cm unter der inneren Tafel."},
             {"A give, and CSF comes.", "Ein Nachgeben, und Liquor kommt."},
             {"CSF drains.", "Liquor läuft ab."},
             {"Traces", "Spuren"},
             {"Incisions", "Hautschnitte"},
             {"Hole", "Bohrloch"},
             {"through", "offen"},
             {"not through", "nicht offen"},
             {"Dura", "Dura"},
             {"breached by the burr", "vom Bohrer verletzt"},
             {"passed", "durchstoßen"},
             {"reached by the burr", "vom Bohrer erreicht"}};
  append(m.texts, ventriculostomy_words());
  m.guide = [](const LessonFacts& facts) { return guide_of(own(facts)); };
  m.status = [](const LessonFacts& facts) { return status_of(own(facts)); };
  m.of_head = true;
  m.field = [](const LessonFacts& facts, const cases::CaseManifest& manifest) {
    return field_of(own(facts), manifest);
  };
  m.fluid = [](const LessonFacts& facts, const cases::CaseManifest& manifest) {
    return fluid_of(own(facts), manifest);
  };
  m.ink = [](const LessonFacts& facts) { return ink_of(own(facts)); };
  m.facts_json = [](const LessonFacts& facts) { return json_of(own(facts)); };
  m.outcome = outcome;
  m.facts_of_outcome = facts_of_scan;
  m.facts_of_volume = facts_of_drilled;
  m.headline = [](const LessonFacts& facts, const LessonScore& score) {
    if (facts.from_scan) return outcome(facts, score);
    return texts::Phrase("passes of the catheter: {}", {std::to_string(score.count("passes_count"))});
  };
  m.pictures = [](const LessonFacts& facts, const cases::LoadedCase& loaded, texts::Language language) {
    return ways_html(own(facts), loaded, language);
  };
  return m;
}

}  // namespace trephine::lessons
