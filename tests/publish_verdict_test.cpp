// SPDX-License-Identifier: GPL-3.0-or-later
// What a person reads at the end of a run.
#include "publish/verdict.h"

#include <gtest/gtest.h>

namespace trephine {
namespace {

// A scan in which no cranial cavity is seen may be one of a jaw, or of no head at all.
TEST(Verdict, OfAScanThatShowsNoHeadIsDoubtful) {
  cases::CaseManifest manifest;
  EXPECT_EQ(publish::verdict_of({"skull"}, manifest, nullptr, nullptr, nullptr), "skull: good");
  manifest.figures = {{"body_part.is_expected", std::string("yes")}};
  EXPECT_EQ(publish::verdict_of({"skull"}, manifest, nullptr, nullptr, nullptr), "skull: good");
  manifest.figures = {{"body_part.is_expected", std::string("unknown")}};
  EXPECT_EQ(publish::verdict_of({"skull"}, manifest, nullptr, nullptr, nullptr),
            "skull: doubtful; it is not sure that the scan shows the part of the body that is made of it");
}

}  // namespace
}  // namespace trephine
