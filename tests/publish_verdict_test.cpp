// SPDX-License-Identifier: GPL-3.0-or-later
// What a person reads at the end of a run.
#include "publish/verdict.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "look/body_part.h"
#include "publish/scan_findings.h"
#include "stages/import.h"
#include "stages/stage.h"

namespace trephine {
namespace {

// A scan in which no cranial cavity is seen may be one of a jaw, or of no head at all.
TEST(Verdict, OfAScanThatShowsNoHeadIsDoubtful) {
  cases::CaseManifest manifest;
  const stages::StageType& stage = stages::stage_named("body_part");
  const auto verdict = [&](look::IsExpected is) {
    look::BodyPartResult result;
    result.is_expected = is;
    stages::CaseParts parts;
    stage.contribute(AnyParams::make(result), parts);
    return publish::verdict_text(publish::judge_anatomies({"skull"}, manifest, parts.evidence), manifest,
                                 parts.evidence, parts.remarks);
  };
  EXPECT_EQ(verdict(look::IsExpected::not_told), "skull: good");
  EXPECT_EQ(verdict(look::IsExpected::yes), "skull: good");
  EXPECT_EQ(verdict(look::IsExpected::unknown),
            "skull: doubtful; it is not sure that the scan shows the part of the body that is made of it");
}

// What a program repeated or lost between the slices speaks against everything that is made of them.
TEST(Verdict, OfAScanWithSlicesThatWereNotMeasuredIsDoubtful) {
  cases::CaseManifest manifest;
  stages::ImportStageResult result;
  result.seen = look::LookFigures{};
  const auto verdict = [&] {
    stages::CaseParts parts;
    stages::stage_named("import").contribute(AnyParams::make(result), parts);
    return publish::verdict_text(publish::judge_anatomies({"skin", "skull"}, manifest, parts.evidence), manifest,
                                 parts.evidence, parts.remarks);
  };
  EXPECT_EQ(verdict(), "skin, skull: good");
  result.seen->blank_slices_count = 14;
  EXPECT_EQ(verdict(), "skin, skull: doubtful (14 slices were not measured)");
}

using publish::AnatomyState;

// Whatever warning speaks against an anatomy: it is never called good beside it, whoever gave it and however many there
// are.
TEST(Verdict, IsNeverGoodBesideAWarningThatSpeaksAgainstIt) {
  const std::vector<std::string> wanted = {
      "skin",      "skull",    "brain", "ventricles", "dura", "midline", "third_ventricle",
      "brainstem", "clavicle", "vein",  "lung",       "canal"};
  const std::vector<std::string> ids = stages::wrong_kinds();
  ASSERT_GT(ids.size(), 20u);
  const cases::CaseManifest manifest;
  for (const std::string& id : ids)
    for (const std::string& given_by : wanted) {
      const Warning warning{id, "", {}};
      const std::vector<stages::Evidence> evidence = publish::evidence_of(warning, given_by);
      std::vector<std::string> about = stages::kind_of(warning).about;
      if (about.empty()) about = {given_by};
      ASSERT_EQ(evidence.size(), about.size()) << id;
      for (const publish::AnatomyVerdict& v : publish::judge_anatomies(wanted, manifest, evidence)) {
        const bool is_about = std::count(about.begin(), about.end(), v.anatomy) > 0;
        EXPECT_EQ(v.state, is_about ? AnatomyState::doubtful : AnatomyState::good) << id << " about " << v.anatomy;
      }
    }
}

TEST(Verdict, NotesAndPlacesToLookAtSpeakAgainstNothing) {
  for (const char* id : {"isovalue_lowered", "landmark_not_found", "air_at_base", "no_such_kind"})
    EXPECT_TRUE(publish::evidence_of(Warning{id, "", {}}, "skull").empty()) << id;
  EXPECT_EQ(stages::kind_of({"isovalue_lowered", "", {}}).severity, stages::Severity::note);
  EXPECT_EQ(stages::kind_of({"no_such_kind", "", {}}).severity, stages::Severity::look);
}

// Slices at a wrong distance stretch the whole scan, and no landmark of it is sure, but what a person gave.
TEST(Verdict, LandmarksAreDoubtfulBesideProportionsOfNoHead) {
  const auto confidences_beside = [](const char* warning) {
    cases::CaseManifest m;
    m.landmarks = {{"nasion", {0, -90, 0}, 0.9, "found"},
                   {"inion", {0, 90, 0}, 1, "given"},
                   {"bregma", {0, 0, 90}, 0.2, "found"},
                   {"monro_left", {3, 0, 0}, 0.8, "found"},
                   {"monro_right", {-3, 0, 0}, 0.8, "given"}};
    m.targets = {{"monro_left", {3, 0, 0}, 0.8, "ventricles"}, {"monro_right", {-3, 0, 0}, 0.8, "ventricles"}};
    publish::doubt_landmarks({{"no_such_kind", "", {}}, {warning, "", {}}}, m);
    std::vector<double> all;
    for (const cases::CaseLandmark& l : m.landmarks) all.push_back(l.confidence);
    for (const cases::CaseTarget& t : m.targets) all.push_back(t.confidence);
    return all;
  };
  EXPECT_EQ(confidences_beside("unusual_proportions"), (std::vector<double>{0.4, 1, 0.2, 0.4, 0.8, 0.4, 0.8}));
  EXPECT_EQ(confidences_beside("ends_above"), (std::vector<double>{0.9, 1, 0.2, 0.8, 0.8, 0.8, 0.8}));
}

// A bleed is what a person reads first, and what it may have spoilt is doubtful.
TEST(Verdict, ABleedIsSaidFirst) {
  cases::CaseManifest manifest;
  const auto finding = [](const char* kind, double confidence, std::vector<std::string> concerns, const char* text) {
    cases::CaseFinding f;
    f.kind = kind;
    f.confidence = confidence;
    f.concerns = std::move(concerns);
    f.text = text;
    f.side = "left";
    return f;
  };
  manifest.findings = {finding("wide_ventricles", 0.8, {}, "the ventricles are wide"),
                       finding("dense_tissue", 0.3, {"brain"}, "a streak"),
                       finding("dense_tissue", 0.9, {"brain"}, "66 ml lie in the brain")};
  const std::vector<stages::Evidence> evidence = publish::evidence_of(manifest.findings);
  EXPECT_EQ(
      publish::verdict_text(publish::judge_anatomies({"skull", "brain"}, manifest, evidence), manifest, evidence, {}),
      "to be looked at first: 66 ml lie in the brain, left; skull: good; brain: doubtful; to be looked at: the "
      "ventricles are wide, left");
}

}  // namespace
}  // namespace trephine
