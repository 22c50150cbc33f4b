// SPDX-License-Identifier: GPL-3.0-or-later
// Where the window's panels lie: beside each other, whatever is shown.
#include "window/layout.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

using namespace trephine;

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
