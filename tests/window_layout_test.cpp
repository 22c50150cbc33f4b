// SPDX-License-Identifier: GPL-3.0-or-later
// Where the window's panels lie: beside each other, whatever is shown.
#include "window/layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

using namespace trephine;

// The work on the left, the patient in the middle, the monitor on the right: the patient has the most room.
TEST(Layout, ThePatientHasMoreRoomThanTheMonitor) {
  constexpr float letter = 13;
  for (const auto& [width, height] : {std::pair<float, float>{1024, 600}, {1280, 800}, {1366, 768}, {1920, 1080}}) {
    SCOPED_TRACE(testing::Message() << width << " x " << height);
    const window::Layout l(width, height, letter, true, false, false, false);
    const float from = l.work.x + l.work.width, to = std::min(l.xray.x, l.status.x);
    EXPECT_FLOAT_EQ(l.patient.x, from) << "what is shown as free is free";
    EXPECT_FLOAT_EQ(l.patient.x + l.patient.width, to);
    EXPECT_GT(to - from, l.xray.width);
    EXPECT_GE(to - from, 0.35f * width);
    EXPECT_LT(from, 0.5f * width) << "what is looked at lies in the middle of the window";
    EXPECT_GT(to, 0.5f * width);
    // The picture, within the panel's borders of 8 pixels: a third of the window, where its height allows that.
    EXPECT_GE(l.xray.width - 16, std::min(width / 3, 0.66f * height)) << "too small to see a pedicle in";
  }
}

TEST(Layout, NoPanelLiesOverAnother) {
  const std::pair<float, float> sizes[] = {{1024, 600}, {1024, 768},  {1280, 720},
                                           {1366, 768}, {1920, 1080}, {3840, 2160}};
  for (const auto& [width, height] : sizes)
    for (const float letter : {13.f, 20.f, 26.f})
      for (int shown = 0; shown < 16; ++shown) {
        const bool has_xray = shown & 1, has_scores = shown & 2, has_shots = shown & 4, has_time = shown & 8;
        if (has_xray && has_scores) continue;  // one while the lesson goes on, the other after it
        SCOPED_TRACE(testing::Message() << width << " x " << height << ", letters " << letter << ", shown " << shown);
        const window::Layout l(width, height, letter, has_xray, has_scores, has_shots, has_time);
        EXPECT_GT(l.patient.width, 0);
        EXPECT_FALSE(l.patient.overlaps(l.work) || l.patient.overlaps(l.status) ||
                     (has_xray && l.patient.overlaps(l.xray)));
        std::vector<window::Place> places{l.work, l.status};
        if (has_xray) places.push_back(l.xray);
        if (has_scores) places.push_back(l.scores);
        if (has_shots) places.push_back(l.shots);
        if (has_time) places.push_back(l.time);
        for (std::size_t a = 0; a < places.size(); ++a) {
          EXPECT_GE(places[a].x, 0);
          EXPECT_GE(places[a].y, 0);
          EXPECT_LE(places[a].x + places[a].width, width);
          EXPECT_LE(places[a].y + places[a].height, height);
          EXPECT_GE(places[a].width, 13 * letter) << "too narrow to be read";
          EXPECT_GE(places[a].height, 4 * letter);
          for (std::size_t b = 0; b < a; ++b) EXPECT_FALSE(places[a].overlaps(places[b])) << a << " and " << b;
        }
      }
}
