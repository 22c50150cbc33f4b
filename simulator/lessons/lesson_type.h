// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cases/load_case.h"
#include "fluoro/carm.h"
#include "lesson/rubric.h"
#include "lessons/lesson.h"
#include "lessons/lesson_text.h"
#include "lessons/scripted_hand.h"
#include "texts/language.h"
#include "texts/phrase.h"

namespace trephine::lessons {

struct LessonScore;
struct ReportHead;

/// What a participant is asked for: it is assigned, recorded and judged.
struct LessonTask {
  std::string name;  ///< as recordings have it: "right", "pedicle_2_left"
  std::string aim, indication;
  std::string german_aim, german_indication;
  std::string doubt = {};  ///< what of it the case knows only doubtfully, so that rows are not judged; empty: nothing
  /// false: nobody is asked for it, as the case was drilled for another one; a recording of it is judged all the same.
  bool is_offered = true;
};
/// Below it the shipped rubrics judge nothing by a landmark, and the programs that find them call it doubtful.
constexpr double sure_confidence = 0.5;
/// "confidence 0.34, below 0.5"
std::string doubt_words(double confidence);

/// A column of the log of attempts beside those that every lesson has.
struct LessonColumn {
  std::string name, help;
  std::string row;  ///< the row that measures it under this name; empty: a figure of the score
};

/// A step that a window leads through, by the name of the tool to be taken, or of the command. "screw_*": any of the
/// tools of which that is the begin; which of them, the participant decides. "burr*", where a tool is called "burr":
/// that one, unless the participant takes another.
struct LessonGuide {
  std::string text, tool, command;
  std::string why, sign;  ///< why it is done, and how one sees that it is right
  bool done = false;      ///< as anyone sees who looks at the patient; that is not whether it was done well
};
/// What a window says of a lesson that goes on: the name for programs, which ends in its unit, and the label for
/// people.
struct LessonStatus {
  std::string name, label, value;
};

inline void append(std::vector<LessonText>& texts, const std::vector<LessonText>& more) {
  texts.insert(texts.end(), more.begin(), more.end());
}

/// What lamp and drapes of a window leave open: the middle of the field, and the radius of the drape's opening (0:
/// nothing is draped yet). It must not tell what the participant has to find.
struct LessonField {
  Vec3 centre_mm;
  double open_mm = 0, lamp_mm = 130;
  Vec3 down{0, 1, 0};  ///< where drops fall: by default a patient on the back
  /// From where its surgeon first sees the patient (unit, from the patient to the eye); 0: upright over the field.
  Vec3 from;
};

/// A C-arm, as a window shows it.
struct LessonXray {
  /// Where it stands: "lateral", "free", and by how many degrees it is turned and tilted.
  struct Pose {
    std::string view;
    double orbit_deg = 0, tilt_deg = 0;
    fluoro::CArmParams arm;
  };
  Pose now;
  bool on = false;
  double exposure_s = 0;
  std::size_t shots_count = 0;
  Pose seen;  ///< as the last picture was taken, and the metal in it; where there was a shot
  std::vector<fluoro::MetalRod> metal;
};

/// X-rays that were on without a break, as its review shows them: what was seen at their end.
struct LessonShot {
  double begin_s = 0, end_s = 0;
  LessonXray::Pose seen;
  std::vector<fluoro::MetalRod> metal;
};

/// A lesson that the program knows: everything that commands, scripts, reports, logs and curricula need of it. Every
/// simulator/lessons/NAME/NAME_lesson.cpp defines `LessonType NAME_lesson()`, and CMake finds it; its rubric is
/// declared beside it, in NAME_rubric.cpp. Nothing else names a lesson.
struct LessonType {
  std::string name;                   ///< as scripts, rubrics, recordings and --module have it
  std::string german_title;           ///< the English title is the name with spaces
  std::string summary;                ///< half a line
  std::vector<std::string> rows;      ///< the names of the score's rows, in their order
  std::vector<LessonColumn> columns;  ///< of the log, after the rows
  std::vector<StepChoice> steps;      ///< what its scripts may say
  bool needs_pictures = false;        ///< fluoroscopy shows where the tool is: a window needs the case's CT
  bool of_head = false;  ///< a window shows a head that is held, and the body beyond it; else a part of the trunk
  /// What the other hand may hold, and must spare. `second_takes_xrays`: where that is nothing, its switch is the
  /// pedal.
  SecondUse second;
  bool second_takes_xrays = false;
  /// The patients' classes that are exercised in turn. None: a case needs no class, and --classes is ignored.
  std::vector<std::string> classes;

  /// Throws Error 65 where the case holds no such lesson.
  std::function<void(const cases::CaseManifest&)> require;
  std::function<std::vector<haptics::BeltToolParams>()> tools;
  /// What a recording of this case may be of, the usual one first. None: the case holds no task.
  std::function<std::vector<LessonTask>(const cases::CaseManifest&)> tasks;
  /// What a script asks of the hand; throws Error 65 naming the step.
  std::function<std::vector<HandMove>(const LessonScript&, const ScriptScene&, const ScriptAim&)> plan;
  /// `before` is the volume as the lesson began; all three must outlive the lesson.
  std::function<std::unique_ptr<Lesson>(const cases::CaseManifest&, const voxel::HapticVolume& before,
                                        const voxel::HapticVolume& now)>
      begin;
  /// Pure: the same facts, case, volume as the lesson began, and rubric give the same rows. (The haptic volume of the
  /// case itself may have been cut since.)
  std::function<LessonScore(const LessonFacts&, const cases::LoadedCase&, const voxel::HapticVolume& before,
                            const AnyParams&)>
      score;

  /// What a CT after a procedure shows as this lesson's facts, so that score() judges it, with the name of the task or
  /// ""; empty: no CT shows enough. Throws Error 64 where the task must be named.
  std::function<std::shared_ptr<LessonFacts>(const lesson::OutcomeRecord&, const cases::LoadedCase&,
                                             const std::string& task)>
      facts_of_outcome;

  /// The same of the volume as it was drilled in another program; empty: it does not show enough.
  std::function<std::shared_ptr<LessonFacts>(const cases::LoadedCase&, const voxel::HapticVolume& now)> facts_of_volume;

  /// For a window: the steps in their order (empty: a step for each tool, and the end), what it says meanwhile, and
  /// what a marker drew and nobody erased. Each may be empty.
  std::vector<LessonText> texts;
  std::function<std::vector<LessonGuide>(const LessonFacts&)> guide;  ///< the same steps whatever was done
  std::function<std::vector<LessonStatus>(const LessonFacts&)> status;
  std::function<std::vector<Vec3>(const LessonFacts&)> ink;
  /// The field of operation; empty: about the middle of what is shown.
  std::function<LessonField(const LessonFacts&, const cases::CaseManifest&)> field;
  /// What comes out of the tool in hand, where a surgeon sees it.
  std::function<lesson::Fluid(const LessonFacts&, const cases::CaseManifest&)> fluid;
  /// Of a lesson with a C-arm; else empty. A lesson that does not need its pictures shows them where the case has a CT.
  std::function<LessonXray(const Lesson&, const cases::CaseManifest&)> xray;
  /// And all that was seen, in the order of time.
  std::function<std::vector<LessonShot>(const LessonFacts&, const cases::CaseManifest&)> shots;
  /// 1: the tool is shown in green, as it succeeded; -1: in red, as it failed; 0: neither. By the lesson's rubric.
  std::function<int(const LessonFacts&, const AnyParams& rubric)> verdict;

  /// For reports: the facts as JSON, the end of the table in the terminal, what the page's head says beside the time,
  /// and the page's pictures as HTML.
  std::function<nlohmann::ordered_json(const LessonFacts&)> facts_json;
  std::function<texts::Phrase(const LessonFacts&, const LessonScore&)> outcome, headline;
  std::function<std::string(const LessonFacts&, const cases::LoadedCase&, texts::Language)> pictures;
};

/// All of them, by name of their source.
const std::vector<LessonType>& lesson_types();
/// Throws Error 65 with the field `lesson` where there is none of that name.
const LessonType& lesson_type(const std::string& name);
/// What a participant may be asked for in this case; the first is the usual one.
std::vector<LessonTask> offered_tasks(const LessonType& type, const cases::CaseManifest& manifest);
/// The task of that name, offered or not; throws Error 65 with the field `task` where the case holds no such task.
LessonTask task_of(const LessonType& type, const cases::CaseManifest& manifest, const std::string& name);
/// The task of that name, or without a name the usual one, which is empty where the case offers none. Throws as
/// task_of.
LessonTask task_or_usual(const LessonType& type, const cases::CaseManifest& manifest, const std::string& name);
/// What a case offers to a lesson: its tasks, or why it cannot be exercised.
struct LessonUse {
  std::vector<std::string> tasks;
  std::vector<std::pair<std::string, std::string>> doubtful;  ///< those that can be done and not wholly judged, and why
  std::string why_not;                                        ///< empty: it can
};
LessonUse use_of(const LessonType& type, const cases::CaseManifest& manifest);
/// The patient's class, as the case's figures have it; "": none.
std::string class_of(const cases::CaseManifest& manifest);
/// Why no case of that patient's class is exercised in turn ("": it has none); empty where such cases are. A lesson in
/// such a case is possible, and doubtful.
std::string class_fault(const LessonType& type, const std::string& patient_class);
/// What people call the lesson of that name; of one that is not known, the name with spaces.
std::string lesson_title(const std::string& name, texts::Language language);
/// The values of --module.
std::vector<std::string> lesson_names();

}  // namespace trephine::lessons
