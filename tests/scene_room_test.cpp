// SPDX-License-Identifier: GPL-3.0-or-later
// What stands about a patient in a lesson: it hides nothing of the patient, and lies where it belongs.
#include "scene/room.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trephine::scene {
namespace {

constexpr Vec3 origin{3, -20, 40};

RoomParams room_of(bool head, double down_y) {
  RoomParams p;
  p.patient_mm = {{-75, -120, -60}, {85, 80, 150}};
  p.down = {0, down_y, 0};
  p.head = head;
  return p;
}

Vec3 world(const SolidVertex& v) { return origin + Vec3{v.position_mm[0], v.position_mm[1], v.position_mm[2]}; }

TEST(Room, HidesNothingOfThePatientButTheCutEnds) {
  for (const bool head : {true, false})
    for (const double down : {1.0, -1.0}) {
      const RoomParams p = room_of(head, down);
      const Vec3 low = p.patient_mm.min_mm, high = p.patient_mm.max_mm;
      const Room made = make_room(p, origin);
      const Solid& room = made.solid;
      ASSERT_GT(room.indices.size(), 1000u);
      int below = 0, above = 0;
      for (const SolidVertex& v : room.vertices) {
        const Vec3 at = world(v);
        const bool inside = at.x > low.x && at.x < high.x && at.y > low.y + 3 && at.y < high.y - 3 &&
                            at.z > low.z + drape_over_mm + 1e-3 && at.z < high.z - (head ? 0 : drape_over_mm + 1e-3);
        EXPECT_FALSE(inside) << at.x << " " << at.y << " " << at.z;
        below += at.z < low.z - 300;
        above += at.z > high.z + 300;
      }
      EXPECT_GT(below, 0) << "the body goes on below";
      EXPECT_EQ(above > 0, !head) << "and above, but for a head";
      const surface::Bounds& all = made.bounds_mm;
      EXPECT_LT(all.min_mm.z, low.z - 300);
      // What bears the patient lies under, and not over.
      const double bears = down > 0 ? high.y : low.y, far = down > 0 ? all.max_mm.y : all.min_mm.y;
      EXPECT_GT(down * (far - bears), 50);
    }
}

// What a person sees from above is the outer side of it.
TEST(Room, IsSeenFromOutside) {
  for (const bool head : {true, false})
    for (const double down : {1.0, -1.0}) {
      const Solid room = make_room(room_of(head, down), origin).solid;
      int seen = 0;
      for (double x = -250; x < 250; x += 23)
        for (double z = -500; z < 500; z += 31) {
          double highest = -1e9, faces = 0;
          for (std::size_t n = 0; n + 2 < room.indices.size(); n += 3) {
            Vec3 p[3], normal;
            for (std::size_t c = 0; c < 3; ++c) {
              const SolidVertex& v = room.vertices[room.indices[n + c]];
              p[c] = world(v);
              normal += Vec3{v.normal[0], v.normal[1], v.normal[2]};
            }
            const Vec3 facing = cross(p[1] - p[0], p[2] - p[0]);
            if (std::abs(facing.y) < 1e-3) continue;
            // Where the vertical line through x and z meets its plane, and whether that is within it.
            const double y = p[0].y - (facing.x * (x - p[0].x) + facing.z * (z - p[0].z)) / facing.y;
            bool within = true;
            for (int c = 0; c < 3; ++c)
              within = within && dot(cross(p[(c + 1) % 3] - p[c], Vec3{x, y, z} - p[c]), facing) >= 0;
            if (!within || -down * y <= highest) continue;
            highest = -down * y;
            faces = std::min(-down * facing.y, -down * normal.y);
          }
          if (highest < -1e8) continue;
          ++seen;
          EXPECT_GT(faces, 0) << x << " " << z;
        }
      EXPECT_GT(seen, 100);
    }
}

TEST(Room, ToolsLieOnTheTrayBesideThePatient) {
  RoomParams p = room_of(true, 1);
  const Solid bare = make_room(p, origin).solid;
  for (const char* tool : {"burr", "catheter", "needle"}) {
    haptics::ToolParams t;
    t.tool = tool;
    p.tools.push_back(haptics::own_tool(t));
  }
  for (const double side : {-1.0, 1.0}) {
    p.tray_side = side;
    const Solid full = make_room(p, origin).solid;
    std::size_t more = 0;
    for (const haptics::ToolParams& t : p.tools) more += solid_of(t).vertices.size();
    ASSERT_EQ(full.vertices.size(), bare.vertices.size() + more);
    double beside_mm = 1e9;
    for (std::size_t n = bare.vertices.size(); n < full.vertices.size(); ++n) {
      const double x = world(full.vertices[n]).x;
      beside_mm = std::min(beside_mm, side * x - (side > 0 ? p.patient_mm.max_mm.x : -p.patient_mm.min_mm.x));
    }
    EXPECT_GT(beside_mm, 30);
    EXPECT_LT(beside_mm, 200);
  }
}

}  // namespace
}  // namespace trephine::scene
