// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "haptics/recording.h"
#include "lessons/lesson.h"
#include "lessons/motion_figures.h"
#include "lessons/score.h"
#include "lessons/signature.h"

namespace trephine::lessons {

/// What a report says beside the scores.
struct ReportHead {
  std::string case_token, module, participant;
  std::string recording_sha256, rubric_sha256, case_sha256;  ///< of the files; case: of its case.json
  std::string motion_sha256 = {};                            ///< motion_digest()
  bool replayed = false;                                     ///< else the recording's answers were trusted
  haptics::Seal seal = haptics::Seal::absent;                ///< of the recording
  Signature signature = Signature::not_asked;
  std::string announced_rubric_sha256 = {};  ///< as the recording names it; empty: none
  bool unasked = false;                      ///< the rubric has questions, and the recording says that none was asked
  std::vector<std::pair<std::string, double>> motion = {};  ///< motion_figures()
  std::vector<ExpertBand> experts = {};                     ///< beside which they are shown; none: by themselves
  texts::Language language = texts::Language::english;      ///< of page and table; the JSON is for programs
  bool measured = false;                                    ///< LessonFacts::from_scan: there is no recording
  double place_error_mm = 0;                                ///< of a tracked tool: RecordingHeader::place_error_mm
  bool other_rubric() const { return !announced_rubric_sha256.empty() && announced_rubric_sha256 != rubric_sha256; }
  const char* checked() const { return measured ? "measured" : replayed ? "replayed" : "trusted"; }
};

/// What is to be known of the points before they are believed: sentences, none where nothing is.
std::vector<std::string> provenance_notes(const ReportHead& head, texts::Language language);

/// The report of a scored lesson as JSON: rows with measured figures, limits and moments, and what happened; in
/// English, but for `feedback`, which has each sentence in each language. It holds no time, host or path; the same
/// inputs give the same bytes.
std::string score_json(const ReportHead& head, const LessonFacts& facts, const LessonScore& score);

/// The same as a table for the terminal.
std::string score_text(const ReportHead& head, const LessonFacts& facts, const LessonScore& score);

/// "failed: the lung was entered": the outcome, and its reason where there is one.
std::string headline_of(const LessonScore& score, texts::Language language = texts::Language::english);

/// Sum of the rows that were judged, and of the most that they could have been.
struct ScoreSum {
  int points = 0, most = 0;
  int of_table = 0, max_of_table = 0;  ///< without the rows that stand beside a printed table
  bool beside = false;                 ///< there are such rows
};
ScoreSum sum_of(const LessonScore& score);

}  // namespace trephine::lessons
