// SPDX-License-Identifier: GPL-3.0-or-later
// What a person reads at the end of a run.
#include "publish/verdict.h"

#include <gtest/gtest.h>

#include "look/body_part.h"
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

}  // namespace
}  // namespace trephine
