// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <optional>

#include "base/error.h"
#include "base/progress.h"
#include "base/refusal.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "lesson/approval.h"
#include "lessons/exercise_plan.h"
#include "lessons/lesson_run.h"
#include "lessons/results.h"
#include "lessons/score_recording.h"
#include "lessons/signed_points.h"

namespace trephine::commands {
namespace {

namespace fs = std::filesystem;

struct ExerciseParams {
  std::string module = "ventriculostomy", participant, group, level;
  bool all = true, play = false, again = false, retention = false;
  texts::Language language = texts::Language::english;
  template <class V>
  static void describe(V& v) {
    using P = ExerciseParams;
    v.word(&P::module, "module", lessons::lesson_names(), "Which lesson.");
    v.text(&P::participant, "participant", "Anonymous token of who does it: a-z, 0-9, _ and -; never a name.");
    v.text(&P::group, "group", "Token of the group that the participant is in, for studies; kept in the plan.");
    v.text(&P::level, "level",
           "Token of the level of training, such as student, resident or expert; kept in the plan.");
    v.flag(&P::again, "again", "Go through the practice once more: it is added to the plan.");
    v.flag(&P::retention, "retention", "Do the tests once more, later: they are added to the plan.");
    v.flag(&P::all, "all", "With a script, do every case that is left; without it, one.");
    v.flag(&P::play, "play", "Open a window in which the next case that is to be done is done by hand.");
    v.choice(&P::language, "language", texts::languages(), "Language of the reports' pages, and of the window.");
  }
};

std::string text_of(const lessons::CurriculumParams& p) {
  return to_text(AnyParams::make<lessons::CurriculumParams>(p));
}

class Exercise {
 public:
  explicit Exercise(const cli::ParsedCommand& parsed)
      : parsed_(parsed),
        params_(parsed.params<ExerciseParams>()),
        out_(parsed.path("out")),
        module_(lessons::lesson_type(params_.module)),
        log_(out_ / ("attempts-" + params_.module + ".csv")) {
    lesson::validate_token(params_.participant, "--participant");
    if (!params_.group.empty()) lesson::validate_token(params_.group, "--group");
    if (!params_.level.empty()) lesson::validate_token(params_.level, "--level");
    const bool does = parsed.has("script") || params_.play;
    if (does && !parsed.has("rubric"))
      throw Error(ExitCode::usage, "", "--rubric", "is needed with --script or --play");
    if (!does && parsed.has("rubric") && !parsed.has("signed_by"))
      throw Error(ExitCode::usage, "", "--rubric", "is given with --script, --play or --signed-by, and only with them");
    if (parsed.has("script") && params_.play)
      throw Error(ExitCode::usage, "", "--script, --play", "a case is done by a script or by hand");
    if (parsed.has("settings") && !params_.play)
      throw Error(ExitCode::usage, "", "--settings", "is of the window: it needs --play");
  }

  ExitCode run() {
    cases_ = lessons::cases_for_lessons(parsed_.path("library"), module_);
    make_output_folder(out_);
    take_plan();
    lengthen_plan();
    if (parsed_.has("rubric")) rubric_ = lessons::read_rubric_file(parsed_.path("rubric"));
    if (parsed_.has("script") || params_.play) do_cases();
    print_table();
    return ExitCode::ok;
  }

 private:
  fs::path file_of(std::size_t n, const char* extension) const {
    return lessons::planned_file(out_, plan_, n, extension);
  }

  fs::path public_key() const { return parsed_.has("signed_by") ? parsed_.path("signed_by") : fs::path(); }

  // The plan that is there, or a new one.
  void take_plan() {
    const fs::path file = lessons::plan_file(out_, params_.participant, params_.module);
    const lessons::CurriculumParams& asked = parsed_.params<lessons::CurriculumParams>();
    if (fs::exists(file)) {
      plan_ = lessons::read_plan(file);
      bool other = false;
      for (const Parameter& p : parameters_of<lessons::CurriculumParams>().parameters)
        other |= parsed_.given.count(p.name) > 0;
      if (other && text_of(asked) != text_of(plan_.curriculum))
        throw Error(ExitCode::usage, file.string(), "curriculum",
                    "the participant has a plan by other parameters; leave them out to go on with it");
      const auto same = [&](const char* what, const std::string& asked_for, std::string& planned) {
        if (!asked_for.empty() && !planned.empty() && asked_for != planned)
          throw Error(ExitCode::usage, file.string(), what, "the participant's plan says " + planned);
        if (asked_for.empty() || !planned.empty()) return;
        planned = asked_for;  // a plan of before may say none
        lessons::write_plan(file, plan_);
      };
      same("--group", params_.group, plan_.group);
      same("--level", params_.level, plan_.level);
      std::cout << "goes on with " << file.string() << "\n";
      return;
    }
    plan_.participant = params_.participant;
    plan_.module = params_.module;
    plan_.group = params_.group;
    plan_.level = params_.level;
    plan_.curriculum = asked;
    lessons::CurriculumParams assigned = asked;  // a script that names its task can do no other
    if (assigned.task.empty() && parsed_.has("script"))
      assigned.task = lessons::read_lesson_script(parsed_.path("script")).task;
    for (const lessons::CurriculumCase& c : lessons::plan_curriculum(cases_.approved, asked, module_))
      plan_.cases.push_back({c.token, c.patient_class, lessons::assigned_task(c, assigned), "", c.difficulty_level});
    plan_.cases = lessons::phased(plan_.cases, asked);
    for (const auto& [folder, why] : cases_.left_out) std::cout << fmt::format("left out: {}: {}\n", folder, why);
    if (const int n = cases_.of_other_lessons; n > 0)
      std::cout << fmt::format("{} beside {} of other lessons\n", n == 1 ? "a case" : fmt::format("{} cases", n),
                               n == 1 ? "is" : "are");
    if (plan_.cases.empty())
      throw Error(ExitCode::no_input, parsed_.text("library"), "",
                  "holds no approved case of these classes and difficulties: trephine library approve CASE --by TOKEN");
    lessons::write_plan(file, plan_);
  }

  void lengthen_plan() {
    if (!params_.again && !params_.retention) return;
    std::size_t done = 0;
    for (std::size_t n = 0; n < plan_.cases.size(); ++n)
      if (fs::exists(file_of(n, ".json")) || fs::exists(file_of(n, ".lesson"))) done = n + 1;
    if (params_.again) lessons::add_round(plan_, done);
    if (params_.retention) lessons::add_retention(plan_);
    lessons::write_plan(lessons::plan_file(out_, params_.participant, params_.module), plan_);
  }

  const lessons::CurriculumCase* find(const std::string& token) const {
    for (const lessons::CurriculumCase& c : cases_.approved)
      if (c.token == token) return &c;
    return nullptr;
  }

  void do_cases() {
    const lessons::LessonScript script =
        params_.play ? lessons::LessonScript() : lessons::read_lesson_script(parsed_.path("script"));
    if (!params_.play && script.module != module_.name)
      throw Error(ExitCode::usage, parsed_.text("script"), "module",
                  script.module + ", but --module is " + module_.name);
    for (std::size_t n = 0; n < plan_.cases.size(); ++n) {
      const fs::path recording = file_of(n, ".lesson"), report = file_of(n, ".json");
      if (fs::exists(report)) continue;
      const lessons::CurriculumCase* c = find(plan_.cases[n].token);
      if (!c) {
        std::cout << fmt::format("{}: is no longer in the library, or no longer approved: left out\n",
                                 plan_.cases[n].token);
        continue;
      }
      if (!fs::exists(recording)) {
        if (!params_.play)
          do_case(*c, plan_.cases[n].task, script, recording);
        else if (play_case(*c, plan_.cases[n].task, recording); !fs::exists(recording) || fs::exists(report))
          return;
      }
      // The report is last: what is there is done.
      lessons::ScoredLesson scored =
          lessons::score_recording(recording, c->folder, *rubric_, lessons::Answers::replayed, public_key());
      lessons::require_approved(c->folder, scored.head.case_sha256, c->case_sha256);
      if (scored.head.unasked && scored.recording.header.device != "script")
        throw refusal("lesson.asked", "is empty: the rubric's questions were not asked",
                      {"take the recording out of the folder, and `exercise` has the case to do"})
            .in_file(recording.string());
      scored.head.language = params_.language;
      const std::string repeats = lessons::write_report(scored, c->folder, {{}, file_of(n, ".html"), log_});
      if (!repeats.empty()) std::cout << fmt::format("{}: the motion is that of {}\n", plan_.cases[n].token, repeats);
      lessons::write_report(scored, c->folder, {report, {}, {}});
      if (!params_.all) return;
    }
  }

  // In a window, which judges and reports it as well. A lesson that never began leaves no recording: it is still to do.
  void play_case(const lessons::CurriculumCase& c, const std::string& task, const fs::path& recording) {
#ifdef TREPHINE_WITH_DISPLAY
    const cli::Command play = cli::OwnCommand::named("play");
    std::vector<std::string> words = {c.folder.string(),   "--lesson",          params_.module,         "--participant",
                                      params_.participant, "--rubric",          parsed_.text("rubric"), "--record",
                                      recording.string(),  "--approved-sha256", c.case_sha256};
    if (!task.empty()) words.insert(words.end(), {"--task", task});
    if (params_.language == texts::Language::german) words.insert(words.end(), {"--language", "de"});
    if (parsed_.has("settings")) words.insert(words.end(), {"--settings", parsed_.text("settings")});
    play.run(cli::parse_command(play, words));
#else
    (void)c, (void)task, (void)recording;
    throw Error(ExitCode::usage, "", "--play", "this build has no window");
#endif
  }

  void do_case(const lessons::CurriculumCase& c, const std::string& task, const lessons::LessonScript& script,
               const fs::path& recording) {
    lessons::LessonOptions o;
    o.script = script;
    o.participant = params_.participant;
    o.task = task;
    o.rubric = &*rubric_;
    o.hand = parsed_.params<device::HandParams>();
    o.aim = parsed_.params<lessons::ScriptAim>();
    session::FeltCase felt(c.folder, "");
    const lessons::LessonResult r =
        with_file(c.token, [&] { return lessons::run_lesson(felt, o, cancel_requested()); });
    haptics::RecordingWriter writer(recording, r.recording.header);
    writer.add(r.recording.frames);
    writer.finish(r.recording.header.outcome);
  }

  void print_table() const {
    std::cout << fmt::format("{:<4}{:<26}{:<16}{:<12}{:<18}{:<11}{}\n", "", "case", "class", "difficulty", "task",
                             "phase", "result");
    for (std::size_t n = 0; n < plan_.cases.size(); ++n) {
      const lessons::PlannedCase& c = plan_.cases[n];
      const auto or_none = [](const std::string& s) { return s.empty() ? std::string("-") : s; };
      std::string result = result_of(file_of(n, ".json"));
      if (parsed_.has("signed_by") && fs::exists(file_of(n, ".lesson")))
        result += std::string(", ") + lessons::to_text(signed_state_of(n));
      std::cout << fmt::format("{:<4}{:<26}{:<16}{:<12}{:<18}{:<11}{}\n", n + 1, c.token, or_none(c.patient_class),
                               c.difficulty_level, or_none(c.task), or_none(c.phase), result);
    }
  }

  lessons::SignedState signed_state_of(std::size_t n) const {
    const lessons::CurriculumCase* c = find(plan_.cases[n].token);
    return lessons::signed_state(
        {plan_.participant, plan_.module, plan_.cases[n].token, file_of(n, ".lesson"), file_of(n, ".json")},
        c ? c->folder : fs::path(), rubric_ ? &*rubric_ : nullptr, public_key());
  }

  // By the report alone, which stays when the recording is deleted.
  static std::string result_of(const fs::path& report) {
    if (!fs::exists(report)) return "to do";
    try {
      const lessons::AttemptResult r = lessons::read_report(report);
      std::string result = fmt::format("{} of {} points:", r.points, r.most_points);
      for (const lessons::ResultRow& row : r.rows) result += " " + (row.score ? std::to_string(*row.score) : "-");
      if (!r.outcome.empty()) result += ", " + r.outcome;
      return result + (r.recording_is_there ? "" : " (its recording is gone: it cannot be judged again)");
    } catch (const Error& e) {
      return std::string("done; its report cannot be read: ") + e.what();
    }
  }

  const cli::ParsedCommand& parsed_;
  const ExerciseParams& params_;
  const fs::path out_;
  const lessons::LessonType& module_;
  const fs::path log_;
  lessons::LibraryCases cases_;
  std::optional<lesson::CompiledRubric> rubric_;
  lessons::ExercisePlan plan_;
};

}  // namespace

const cli::OwnCommand exercise_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "exercise";
  c.summary = "leads a participant through a library's approved cases, and goes on where that ended";
  c.description =
      "Chooses cases by class and difficulty, in an order that the seed decides and that is kept in the folder, so "
      "that "
      "it stays the same when the library grows. Cases that no reviewer approved (`trephine library approve`), that "
      "changed since, or whose class is uncertain, are left out, and it says why. With a script and a rubric each case "
      "is done, scored and reported; what was done before is not done again. With --play the next case is done by hand "
      "in "
      "a window (`trephine-sim play`). Without either it says what is to be done. With --test-cases-count some cases "
      "are "
      "withheld for tests before and after practice; --again and --retention lengthen a plan. `trephine-sim group` "
      "shows what a group did.";
  const cli::Argument library = cli::positional_argument("library", Kind::in_folder, "The library's folder.");
  const cli::Argument out =
      cli::required_argument("out", Kind::out_folder, "Folder of the participant's recordings and reports.");
  c.arguments = {
      library,
      out,
      cli::argument("script", Kind::in_file, "What the simulated hand does (.json)."),
      cli::argument("rubric", Kind::in_file, "The compiled rubric (.json)."),
      cli::argument("signed_by", Kind::in_file,
                    "A teacher's public key (PEM): say which attempts are signed; with --rubric also whether "
                    "their points are those of the signed recordings."),
      cli::argument("settings", Kind::in_file, "With --play: settings of the window, as play takes them.")};
  c.groups = {cli::ParameterGroup::of<ExerciseParams>("Parameters"),
              cli::ParameterGroup::of<lessons::CurriculumParams>("The choice of cases"),
              cli::ParameterGroup::of<lessons::ScriptAim>("How well the hand aims"),
              cli::ParameterGroup::of<device::HandParams>("Simulated hand")};
  c.examples = {"trephine-sim exercise library --participant r-01 --out results",
                "trephine-sim exercise library --participant r-01 --out results --script "
                "examples/lessons/ventriculostomy.json --rubric ventriculostomy.rubric.json",
                "trephine-sim exercise library --participant r-01 --out results --play --rubric "
                "ventriculostomy.rubric.json"};
  c.run = [](const cli::ParsedCommand& parsed) { return Exercise(parsed).run(); };
  return c;
});

}  // namespace trephine::commands
