// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings of every older version are read, and replay as they were felt.
#include <gtest/gtest.h>

#include "base/error.h"
#include "session/felt_case.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;

const fs::path old = fs::path(TREPHINE_SOURCE_DIR) / "tests/data/old";

TEST(HapticsOld, EveryVersionReplays) {
  for (const char* name : {"version_1.servo", "version_2.servo", "version_3.lesson", "version_4.servo",
                           "version_5.servo", "version_6.servo", "version_7.servo", "version_8.servo"}) {
    SCOPED_TRACE(name);
    const haptics::Recording r = haptics::read_recording(old / name);
    session::FeltCase felt = session::felt_again(old / "case-1.4", name, r.header);
    contact::ContactVolume contact(felt.loaded.haptic, r.header.contact);
    session::Rerun rerun(felt, contact, name, r.header);
    const std::vector<haptics::ServoFrame> again = rerun.run(r.frames);
    ASSERT_GE(again.size(), 24u);
    double max_n = 0;
    for (std::size_t n = 0; n < again.size(); ++n)
      for (int a = 0; a < 3; ++a) {
        EXPECT_NEAR(again[n].force_n[a], r.frames[n].force_n[a], 1e-9) << n;
        max_n = std::max(max_n, std::abs(again[n].force_n[a]));
      }
    for (std::size_t n = 0; n < again.size(); ++n) EXPECT_EQ(again[n].events, r.frames[n].events) << n;
    EXPECT_GT(max_n, 0.5) << "it was felt";
    EXPECT_EQ(r.header.outcome.has_value(), r.header.drilling.drill);
    if (!r.header.outcome) continue;
    EXPECT_TRUE(r.header.outcome->undone > 0 || r.header.outcome->removed_mm3.at("outer") > 1);
    EXPECT_EQ(haptics::volume_digest(felt.loaded.haptic), r.header.outcome->volume_sha256);
  }
}

TEST(HapticsOld, WhatAVersionKnowsIsRead) {
  const haptics::RecordingHeader one = haptics::read_recording(old / "version_1.servo").header;
  EXPECT_EQ(one.feel_sha256, "");
  EXPECT_EQ(one.tool.tool, haptics::ToolParams().tool);
  EXPECT_EQ(one.force.max_torque_n_mm, haptics::ForceParams().max_torque_n_mm);
  EXPECT_EQ(one.force.ramp_s, 0);
  const haptics::RecordingHeader two = haptics::read_recording(old / "version_2.servo").header;
  EXPECT_EQ(two.tool.tool, "ball");
  EXPECT_EQ(two.tool.tool_diameter_mm, 6);
  EXPECT_EQ(two.drilling.clearance_voxels, 1.75);
  EXPECT_EQ(two.law.power_w, drill::DrillParams().power_w);
  const haptics::RecordingHeader three = haptics::read_recording(old / "version_3.lesson").header;
  ASSERT_EQ(three.tools.size(), 2u);
  EXPECT_EQ(three.lesson, "ventriculostomy");
  EXPECT_EQ(three.tools[0].pierce_n, 2);
  EXPECT_TRUE(three.tools[1].cuts);
  EXPECT_TRUE(haptics::read_recording(old / "version_4.servo").header.knows_across);
  const haptics::RecordingHeader five = haptics::read_recording(old / "version_5.servo").header;
  EXPECT_EQ(five.drilling.cut_at, haptics::DrillingParams::At::tool);
  EXPECT_EQ(five.drilling.undo_steps, 0);
  EXPECT_EQ(five.force.force_law, haptics::ForceParams::Law::second);
  const haptics::RecordingHeader six = haptics::read_recording(old / "version_6.servo").header;
  EXPECT_EQ(six.drilling.cut_at, haptics::DrillingParams::At::way);
  EXPECT_EQ(six.force.force_law, haptics::ForceParams::Law::third);
  EXPECT_EQ(six.tool.lock, haptics::ToolParams::Lock::turn);
  EXPECT_EQ(six.outcome->undone, 1);
  const haptics::RecordingHeader seven = haptics::read_recording(old / "version_7.servo").header;
  EXPECT_EQ(seven.force.force_law, haptics::ForceParams::Law::fourth);
  EXPECT_EQ(seven.tool.lock, haptics::ToolParams::Lock::line);
  EXPECT_EQ(seven.drilling.way_ends, haptics::DrillingParams::WayEnds::running);
  const haptics::RecordingHeader eight = haptics::read_recording(old / "version_8.servo").header;
  EXPECT_EQ(eight.force.force_law, haptics::ForceParams::Law::fourth);
  EXPECT_EQ(eight.drilling.way_ends, haptics::DrillingParams::WayEnds::outside);
}

// The digest by which a recording knows its case's materials: other materials are refused, the same ones never.
TEST(HapticsOld, OtherMaterialsAreRefused) {
  session::FeltCase felt(old / "case-1.4", "");
  const std::string recorded = haptics::read_recording(old / "version_2.servo").header.feel_sha256;
  EXPECT_EQ(haptics::feel_digest(felt.feels), recorded);
  haptics::Feels seen = felt.feels;
  seen[1].colour_rgb = {0, 0, 0};
  EXPECT_EQ(haptics::feel_digest(seen), recorded) << "what is only seen is not felt";
  for (double cases::MaterialParams::*value :
       {&cases::MaterialParams::drag_n_s_per_mm, &cases::MaterialParams::shaft_friction_n_per_mm}) {
    haptics::Feels other = felt.feels;
    other[2].*value += 0.001;
    EXPECT_NE(haptics::feel_digest(other), recorded);
  }
  haptics::Feels other = felt.feels;
  other[1].back.touchable = true;
  EXPECT_NE(haptics::feel_digest(other), recorded);
}

}  // namespace
}  // namespace trephine
