// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/params.h"
#include "lessons/motion_figures.h"
#include "lessons/results.h"
#include "study/study.h"

namespace trephine::group {

/// What a teacher looks at.
struct GroupParams {
  std::string expert_level = "expert", less_level, more_level;
  texts::Language language = texts::Language::english;
  template <class V>
  static void describe(V& v) {
    using P = GroupParams;
    v.text(&P::expert_level, "expert_level",
           "The level whose recordings are called an expert's: they give the bands of the motion figures.");
    v.text(&P::less_level, "less_level", "Of the two levels that set the pass mark, the one that should not pass.");
    v.text(&P::more_level, "more_level", "Of the two levels that set the pass mark, the one that should pass.");
    v.choice(&P::language, "language", texts::languages(), "Language of the page.");
  }
};

/// What a participant did in one lesson. Shares are of the points that could be had, as means over attempts.
struct ParticipantView {
  std::string participant, group, level;
  std::size_t planned = 0, done = 0, completed = 0, failed = 0, signed_count = 0;
  std::map<std::string, double> share_by_phase;    ///< "" where the plan has no phases
  std::map<std::string, bool> completed_by_phase;  ///< the last attempt of the phase, and of all under "all"
  double first_share = 0, last_share = 0, mean_share = 0;
  std::vector<std::string> critical;  ///< with repetitions
  std::vector<std::string> recordings_gone;
  /// What was kept of the gain: (retention - before) / (after - before); nothing where there was no gain.
  std::optional<double> retained_ratio;
};

/// Of a row of the score: the mean by phase, and how many were judged.
struct RowView {
  std::string name, title;
  std::map<std::string, std::pair<double, std::size_t>> by_phase;
};

/// Where contrasting groups set the pass mark [Jorgensen2018]: where the normal densities of both levels cross.
struct PassMark {
  std::string why_not;         ///< empty: it was set
  std::string less, more, of;  ///< the levels, and whose performances: "phase after"
  study::Summary less_summary, more_summary;
  double mark_ratio = 0;
  /// As they are. Points alone pass nobody: the last of the performances must be completed, so neither left unfinished
  /// nor failed by a critical error.
  double less_pass_ratio = 0, more_fail_ratio = 0;
  double less_pass_expected_ratio = 0, more_fail_expected_ratio = 0;  ///< by the normal distributions
  std::vector<std::pair<std::string, bool>> passed;                   ///< every participant with such a performance
};

struct ModuleView {
  std::string module;
  std::vector<std::string> phases;  ///< in their order
  std::vector<ParticipantView> participants;
  std::vector<RowView> rows;
  std::map<std::string, std::map<std::string, std::size_t>> failures;  ///< critical error, participant, how often
  std::optional<PassMark> pass_mark;                                   ///< where both levels were named
  std::vector<lessons::ExpertBand> bands;
  std::vector<lessons::AttemptResult> attempts;
};

struct GroupView {
  std::vector<ModuleView> modules;
  std::vector<texts::Phrase> notes;
};
GroupView view_of(const lessons::Results& results, const GroupParams& params);

/// What a page shows beside the view.
struct GroupPageParts {
  std::map<std::string, std::vector<std::pair<std::string, std::string>>> pictures;  ///< title and SVG, by module
  std::optional<study::Study> answers;  ///< of a questionnaire: a measure a question, by phase
};
/// One HTML page of it, without script and without other files. Notes and plots are in English.
std::string group_page(const GroupView& view, const GroupPageParts& parts,
                       texts::Language language = texts::Language::english);

}  // namespace trephine::group
