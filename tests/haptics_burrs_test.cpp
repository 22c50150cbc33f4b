// SPDX-License-Identifier: GPL-3.0-or-later
// Burrs of several sizes and kinds: which comes next, and that each cuts its own hole, now and when it is run again.
#include "haptics/burrs.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "haptics/recording.h"
#include "haptics_tools.h"

using namespace trephine;
using namespace trephine::tools;

namespace {

haptics::ToolParams burr(const char* kind, double mm) { return haptics::own_tool(params_of(kind, mm)); }

std::string named(const std::vector<haptics::ToolParams>& burrs, int n) {
  return n < 0 ? "none"
               : burrs[std::size_t(n)].tool + " " + std::to_string(int(burrs[std::size_t(n)].tool_diameter_mm));
}

haptics::BeltToolParams belt_burr(const char* name, double mm) {
  haptics::BeltToolParams t;
  static_cast<haptics::ToolParams&>(t) = burr("ball", mm);
  t.name = name;
  t.blunt = t.cuts = true;
  return t;
}

// A block, and a belt of two burrs that drill it.
struct Scene {
  voxel::HapticVolume volume = empty(60, {0.5, 0.5, 0.5});
  std::unique_ptr<contact::ContactVolume> contact;
  std::unique_ptr<haptics::Drilling> drilling;
  std::unique_ptr<haptics::ToolBelt> belt;
  Scene() {
    fill_wide(volume, 1, [](Vec3 p) { return -p.z; });
    contact = std::make_unique<contact::ContactVolume>(volume);
    drill::DrillShapes shapes;
    shapes[1] = {true, 0.02};
    haptics::DrillingParams params;
    params.drill = true;
    const std::vector<haptics::BeltToolParams> tools = {belt_burr("burr", 4), belt_burr("burr_7", 7)};
    std::vector<haptics::Burr> burrs;
    for (const haptics::BeltToolParams& t : tools) burrs.push_back({haptics::cutter_of(params, t), 8});
    drilling = std::make_unique<haptics::Drilling>(volume, *contact, shapes, params, drill::DrillParams{}, burrs);
    belt = std::make_unique<haptics::ToolBelt>(*contact, one_shape(1, face(1, 0.35, 0.3), face(1, 0.35, 0.3)),
                                               haptics::ForceParams{}, haptics::ShaftParams{}, tools, drilling.get());
  }
  /// How wide the block is open at that place of its surface, and 3 mm deep, along y.
  double width_mm(double x) const {
    int open = 0;
    for (double y = -12; y < 12; y += 0.1) open += contact->shape_at({x, y, -2.0}) == 0;
    return 0.1 * open;
  }
};

std::vector<haptics::ServoFrame> drilled(Scene& s) {
  std::vector<haptics::ServoFrame> frames;
  Vec3 tip{-7, 0, 4};
  const auto go = [&](Vec3 to, int ticks, std::uint32_t buttons) {
    const Vec3 from = tip;
    for (int n = 1; n <= ticks; ++n) {
      tip = from + (to - from) * (double(n) / ticks);
      haptics::HapticInput in = pose(tip, {0, 0, 1});
      in.buttons = buttons;
      const haptics::HapticState is = s.belt->update(in);
      s.belt->after(in, is);
      haptics::ServoFrame f;
      haptics::put_input(in, f);
      haptics::put_answer(is, f);
      f.tick = frames.size();
      f.dt_s = 0.001;
      f.time_s = 0.001 * double(frames.size() + 1);
      frames.push_back(f);
    }
  };
  const std::uint32_t second = 1u << haptics::belt_button::tool_shift, down = haptics::belt_button::pedal;
  go({-7, 0, 3}, 20, 0);
  go({-7, 0, -6}, 900, down);
  go({-7, 0, -6.6}, 50, second);  // it touches: the burr is not changed there
  EXPECT_EQ(s.belt->in_hand(), 0);
  go({-7, 0, 4}, 100, 0);
  go({6, 0, 4}, 100, second);
  EXPECT_EQ(s.belt->in_hand(), 1);
  go({6, 0, -6}, 1500, second | down);
  go({6, 0, 4}, 100, second);
  return frames;
}

}  // namespace

// A wider burr that is taken in the hole of a narrower one stands in its walls: it begins at the nearest place outside,
// where nothing of it is in bone, its force comes slowly, and it follows the hand out.
TEST(HapticsBurrs, AWiderOneTakenInTheOthersHoleBeginsOutsideOfBone) {
  Scene s;
  Vec3 tip{0, 0, 4};
  haptics::HapticState is;
  double deepest_mm = 0, most_step_n = 0;
  int looking = 0;
  const auto go = [&](Vec3 to, int ticks, std::uint32_t buttons) {
    const Vec3 from = tip;
    for (int n = 1; n <= ticks; ++n) {
      tip = from + (to - from) * (double(n) / ticks);
      haptics::HapticInput in = pose(tip, {0, 0, 1});
      in.buttons = buttons;
      const haptics::HapticState before = is;
      is = s.belt->update(in);
      s.belt->after(in, is);
      most_step_n = std::max(most_step_n, norm(is.force_n - before.force_n));
      looking = is.force_n == Vec3{} && is.touched == 0 && s.belt->in_hand() == 1 ? looking + 1 : 0;
      if (s.belt->in_hand() != 1 || (looking > 0 && looking < 30)) continue;  // it may look for its way out
      // How far the ball's outside lies in bone, which discs allow by 0.22 mm at an edge.
      for (int k = 0; k < 200; ++k) {
        const double z = 1 - (k + 0.5) / 100, turn = 2.399963 * k, across = std::sqrt(1 - z * z);
        const Vec3 out{across * std::cos(turn), across * std::sin(turn), z};
        for (double in_mm = 0;
             in_mm < 3.5 && s.contact->shape_at(is.proxy_mm + Vec3{0, 0, 3.5} + out * (3.5 - in_mm)) != 0; in_mm += 0.1)
          deepest_mm = std::max(deepest_mm, in_mm);
      }
    }
  };
  const std::uint32_t second = 1u << haptics::belt_button::tool_shift, down = haptics::belt_button::pedal;
  go({0, 0, 3}, 20, 0);
  go({0, 0, -7}, 1200, down);
  go({0, 0, -4}, 200, 0);
  ASSERT_EQ(is.touched, 0);
  ASSERT_LT(is.proxy_mm.z, -3.5) << "it is in its hole";
  go({0, 0, -4}, 800, second);
  EXPECT_EQ(s.belt->in_hand(), 1) << "nothing was touched";
  EXPECT_GT(is.proxy_mm.z, tip.z + 1) << "it does not fit";
  EXPECT_GT(is.force_n.z, 1) << "and is held out";
  go({0, 0, 4}, 200, second);
  EXPECT_EQ(is.touched, 0);
  EXPECT_LT(norm(is.proxy_mm - tip), 1e-9);
  EXPECT_LT(norm(is.force_n), 1e-9);
  std::printf("  at most %.2f mm in bone, the force changed by at most %.3f N in a tick\n", deepest_mm, most_step_n);
  EXPECT_LE(deepest_mm, 0.3);
  EXPECT_LE(most_step_n, 1.0);
}

TEST(HapticsBurrs, TheNextSizeAndKind) {
  const std::vector<haptics::ToolParams> all = haptics::burr_library();
  ASSERT_GT(all.size(), 20u);
  EXPECT_EQ(named(all, haptics::other_burr(all, burr("ball", 5), "larger")), "ball 6");
  EXPECT_EQ(named(all, haptics::other_burr(all, burr("ball", 5), "smaller")), "ball 4");
  EXPECT_EQ(named(all, haptics::other_burr(all, burr("ball", 4.5), "smaller")), "ball 4");
  EXPECT_EQ(named(all, haptics::other_burr(all, burr("ball", 7), "larger")), "none");
  EXPECT_EQ(named(all, haptics::other_burr(all, burr("ball", 2), "smaller")), "none");
  std::string kinds;
  haptics::ToolParams held = burr("burr", 6);
  for (int n = 0; n < 7; ++n) {
    held = all[std::size_t(haptics::other_burr(all, held, "kind"))];
    kinds += held.tool + " ";
  }
  EXPECT_EQ(kinds, "ball round_burr diamond matchstick cylinder craniotome burr ");
  EXPECT_EQ(named(all, haptics::other_burr(all, burr("round_burr", 6), "kind")), "diamond 6");
  const std::vector<haptics::ToolParams> one = {burr("ball", 5)};
  for (const char* asked : {"smaller", "larger", "kind"})
    EXPECT_EQ(haptics::other_burr(one, one[0], asked), -1) << asked;
  EXPECT_THROW(haptics::other_burr(all, held, "bigger"), Error);
  for (const haptics::ToolParams& b : all) EXPECT_NO_THROW(haptics::make_tool(b)) << b.tool << b.tool_diameter_mm;
}

// What a user has set of the tool stays when a key takes another burr.
TEST(HapticsBurrs, AnotherBurrKeepsWhatIsSetOfTheTool) {
  haptics::ToolParams held = burr("ball", 5);
  held.tool_tip = haptics::ToolParams::Tip::round;
  held.tool_length_mm = 33;
  held.tool_spacing_mm = 1.5;
  held.tool_search = haptics::ToolParams::Search::tail_to_tip;
  held.lock_distance_mm = 7;
  const haptics::ToolParams wider = haptics::with_burr(held, burr("ball", 6)),
                            other = haptics::with_burr(held, burr("diamond", 5));
  EXPECT_EQ(wider.tool_diameter_mm, 6);
  EXPECT_EQ(wider.tool_tip, held.tool_tip);
  EXPECT_EQ(wider.tool_length_mm, 33);
  EXPECT_EQ(wider.tool_spacing_mm, 1.5);
  EXPECT_EQ(other.tool, "diamond");
  EXPECT_EQ(other.tool_tip, burr("diamond", 5).tool_tip);
  EXPECT_EQ(other.tool_length_mm, burr("diamond", 5).tool_length_mm);
  EXPECT_EQ(other.tool_spacing_mm, burr("diamond", 5).tool_spacing_mm);
  for (const haptics::ToolParams& next : {wider, other}) {
    EXPECT_EQ(next.tool_search, held.tool_search);
    EXPECT_EQ(next.lock_distance_mm, 7);
  }
}

TEST(HapticsBurrs, EachCutsAsWideAsItIs) {
  Scene s;
  const std::vector<haptics::ServoFrame> frames = drilled(s);
  const double first = s.width_mm(-7), second = s.width_mm(6);
  std::printf("  holes of %.1f and %.1f mm by burrs of 4 and 7 mm\n", first, second);
  EXPECT_NEAR(first, 4, 0.8);
  EXPECT_NEAR(second, 7, 0.8);
  EXPECT_EQ(s.drilling->in_hand(), 1);
  Scene again;
  const std::vector<haptics::ServoFrame> replayed = haptics::replay_frames(frames, 1000, *again.belt);
  ASSERT_EQ(replayed.size(), frames.size());
  for (std::size_t n = 0; n < frames.size(); ++n) ASSERT_TRUE(haptics::same_frame(frames[n], replayed[n])) << n;
  EXPECT_EQ(haptics::volume_digest(again.volume), haptics::volume_digest(s.volume));
}
