// SPDX-License-Identifier: GPL-3.0-or-later
// How far the force of an exactly round tool leans from the surface's normal, on planes and spheres.
#include <gtest/gtest.h>

#include <algorithm>

#include "haptics/round_body.h"
#include "haptics_tools.h"

using namespace trephine;
using namespace trephine::tools;
using walls::uniform;

namespace {

struct Leaning {
  double p50_deg = 0, p99_deg = 0, max_deg = 0;
};

// A ball that touches a sphere of that radius (below 0: from within, 0: a plane) at random places, a hundredth of a mm
// deep.
Leaning leaning(double ball_mm, double sphere_mm, double voxel_mm, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::vector<double> deg;
  for (int volume_n = 0; volume_n < 3; ++volume_n) {
    voxel::HapticVolume v = empty(int(26 / voxel_mm), {voxel_mm, voxel_mm, voxel_mm});
    const Vec3 up = normalized({uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, 0.2, 1)});
    const double radius = std::abs(sphere_mm);
    const Vec3 middle = sphere_mm > 0 ? up * -radius : up * radius;
    fill_wide(v, 1, [&](Vec3 p) {
      if (sphere_mm == 0) return -dot(p, up);
      return sphere_mm > 0 ? radius - norm(p - middle) : norm(p - middle) - radius;
    });
    const contact::ContactVolume contact(v);
    haptics::RoundBody body(contact, {{ball_mm, ball_mm, ball_mm}});
    const Vec3 across = normalized(cross(up, Vec3{0.3, 1, 0.2})), along = cross(up, across);
    for (int n = 0; n < 400; ++n) {
      const Vec3 flat = across * uniform(rng, -3, 3) + along * uniform(rng, -3, 3);
      Vec3 centre, normal = up;
      if (sphere_mm == 0) {
        centre = flat + up * (ball_mm - 0.01);
      } else {
        const Vec3 out = normalized(flat + up * (sphere_mm > 0 ? radius : -radius));
        normal = sphere_mm > 0 ? out : -out;
        centre = middle + out * (sphere_mm > 0 ? radius + ball_mm - 0.01 : radius - ball_mm + 0.01);
      }
      body.begin_frame();
      haptics::RoundBody::Touch t = body.deepest(centre, normal, 0, {});
      if (!t.hit) continue;
      body.set_on_edge(t, normal);
      deg.push_back(std::acos(std::clamp(dot(t.contact.normal, normal), -1.0, 1.0)) * 180 / M_PI);
    }
  }
  if (deg.size() < 300) return {90, 90, 90};
  std::sort(deg.begin(), deg.end());
  return {deg[deg.size() / 2], deg[deg.size() * 99 / 100], deg.back()};
}

// Where a ball touches an edge, a rim or a corner, and the direction in which it is pressed there.
struct Place {
  Vec3 at_mm, out;
};
struct Body {
  std::function<double(Vec3)> level_mm;  // above 0 inside, about a distance
  std::function<Place(double ball_mm)> place;
};
using MakeBody = std::function<Body(std::mt19937_64&)>;

Vec3 any_way(std::mt19937_64& rng) {
  return normalized({uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, 0.2, 1)});
}

// How far the normal leans there, as the discs say and as the edge does.
struct Leans {
  std::vector<double> discs_deg, edge_deg;
};
Leans lean_at(const MakeBody& make, double ball_mm, double voxel_mm, int volumes, int touches) {
  std::mt19937_64 rng(11);
  Leans is;
  for (int volume_n = 0; volume_n < volumes; ++volume_n) {
    const Body body = make(rng);
    voxel::HapticVolume v = empty(int(22 / voxel_mm), {voxel_mm, voxel_mm, voxel_mm});
    fill_wide(v, 1, body.level_mm);
    const contact::ContactVolume contact(v);
    haptics::RoundBody round(contact, {{ball_mm, ball_mm, ball_mm}});
    for (int n = 0; n < touches; ++n) {
      const Place place = body.place(ball_mm);
      round.begin_frame();
      // Half occupancy leaves less of an edge than there is, so the ball goes in until it touches.
      haptics::RoundBody::Touch t;
      for (double in = -0.3; in < 1.2 && !t.hit; in += 0.01)
        t = round.deepest(place.at_mm + place.out * (ball_mm - in), place.out, 0, {});
      if (!t.hit) continue;
      const auto off_deg = [&] {
        return std::acos(std::clamp(dot(t.contact.normal, place.out), -1.0, 1.0)) * 180 / M_PI;
      };
      is.discs_deg.push_back(off_deg());
      round.set_on_edge(t, place.out);
      is.edge_deg.push_back(off_deg());
    }
  }
  EXPECT_GE(is.edge_deg.size(), std::size_t(volumes * touches) * 99 / 100) << "that were touched";
  std::sort(is.discs_deg.begin(), is.discs_deg.end());
  std::sort(is.edge_deg.begin(), is.edge_deg.end());
  return is;
}
double share_of(const std::vector<double>& sorted, double share) {
  return sorted[std::min(sorted.size() - 1, std::size_t(double(sorted.size()) * share))];
}

}  // namespace

TEST(HapticsNormals, OnPlanesAndSpheres) {
  for (const double voxel_mm : {0.4, 0.8})
    for (const double ball_mm : {1.0, 2.5, 3.5})
      for (const double sphere_mm : {0.0, 3.0, 5.0, 20.0, 100.0, -8.0, -100.0}) {
        const Leaning is = leaning(ball_mm, sphere_mm, voxel_mm, 3);
        std::printf("  ball of %.1f mm radius on %6.1f mm, voxels %.1f: %.2f %.2f %.2f degrees\n", ball_mm, sphere_mm,
                    voxel_mm, is.p50_deg, is.p99_deg, is.max_deg);
        // Discs are a voxel apart, which at 0.8 mm are 9 degrees on a sphere of 5 mm, 15 on one of 3 mm.
        if (std::abs(sphere_mm) > 0 && std::abs(sphere_mm) < 10) {
          EXPECT_LE(is.p99_deg, sphere_mm == 3 && voxel_mm > 0.5 ? 14 : 5);
        } else {
          EXPECT_LE(is.p99_deg, 1.5);
        }
      }
}

// At an edge the direction goes round from the one face's normal to the other's: to the nearest point
// of the edge, as the ball's middle goes round it. Voxels round an edge off, and the discs that are touched there face
// one way or another; the two faces beside it are known. Rims are edges that curve, and in a corner three faces meet.
TEST(HapticsNormals, AtEdgesRimsAndCorners) {
  // Of two planes whose normals differ by that angle.
  const auto edge = [](double turn_deg) -> MakeBody {
    return [=](std::mt19937_64& rng) {
      const Vec3 a = any_way(rng), along = normalized(cross(a, Vec3{0.3, 1, 0.2})), across = cross(along, a);
      const double all = turn_deg * M_PI / 180;
      const auto way = [=](double turn) { return a * std::cos(turn) + across * std::sin(turn); };
      return Body{[=, b = way(all)](Vec3 p) { return std::min(-dot(p, a), -dot(p, b)); },
                  [=, &rng](double) {
                    return Place{along * uniform(rng, -3, 3), way(uniform(rng, 0.1, all - 0.1))};
                  }};
    };
  };
  // Of a cylinder's end, or of a hole (`hole`) as deep as the volume.
  const auto rim = [](double radius_mm, bool hole) -> MakeBody {
    return [=](std::mt19937_64& rng) {
      const Vec3 up = any_way(rng), a = normalized(cross(up, Vec3{0.3, 1, 0.2})), b = cross(up, a);
      const double side = hole ? -1 : 1;
      return Body{[=](Vec3 p) { return std::min(-dot(p, up), side * (radius_mm - norm(p - up * dot(p, up)))); },
                  [=, &rng](double ball_mm) {
                    // A ball in a hole's middle touches all of its rim at once, and is pressed anywhere.
                    const double most = hole ? std::asin(std::min(1.0, 0.7 * radius_mm / ball_mm)) : M_PI / 2;
                    const double turn = uniform(rng, 0.1, std::min(most, M_PI / 2 - 0.1));
                    const double round = uniform(rng, 0, 2 * M_PI);
                    const Vec3 way = a * std::cos(round) + b * std::sin(round);
                    return Place{way * radius_mm, up * std::cos(turn) + way * (side * std::sin(turn))};
                  }};
    };
  };
  const auto corner = [](bool beside) -> MakeBody {
    return [=](std::mt19937_64& rng) {
      const Vec3 a = any_way(rng), b = normalized(cross(a, Vec3{0.3, 1, 0.2})), c = cross(a, b);
      return Body{[=](Vec3 p) {
                    return -std::max({dot(p, a), dot(p, b), dot(p, c)});
                  },
                  [=, &rng](double) {
                    if (beside) {  // on an edge that ends in it
                      const double turn = uniform(rng, 0.1, M_PI / 2 - 0.1);
                      return Place{c * -uniform(rng, 0.1, 3), a * std::cos(turn) + b * std::sin(turn)};
                    }
                    return Place{
                        {}, normalized(a * uniform(rng, 0.2, 1) + b * uniform(rng, 0.2, 1) + c * uniform(rng, 0.2, 1))};
                  }};
    };
  };
  struct Row {
    const char* name;
    MakeBody make;
    double most_p90_deg[2], most_p99_deg[2];  // in voxels of 0.4 and 0.8 mm
  };
  constexpr double as_fourth = 90;  // in so few voxels a rim, and a corner, are not always told
  for (const Row& row :
       {Row{"an edge", edge(90), {0.5, 0.5}, {1, 1}}, Row{"an edge of 150", edge(30), {1, 1}, {3, 3}},
        Row{"an edge of 135", edge(45), {1, 1}, {3, 3}}, Row{"an edge of 120", edge(60), {1, 1}, {3, 3}},
        Row{"an edge of 75", edge(105), {1, 1}, {3, 3}}, Row{"an edge of 60", edge(120), {1, 1}, {3, 3}},
        Row{"a corner", corner(false), {1, 8}, {as_fourth, as_fourth}},
        Row{"an edge beside a corner", corner(true), {1, 8}, {as_fourth, as_fourth}},
        Row{"a cylinder's end, 3 mm radius", rim(3, false), {0.5, 3}, {1, as_fourth}},
        Row{"a cylinder's end, 6 mm radius", rim(6, false), {0.5, 0.5}, {1, 1}},
        Row{"a hole's rim, 2.5 mm radius", rim(2.5, true), {0.5, 3}, {3, as_fourth}},
        Row{"a cylinder's end, 3.2 mm radius", rim(3.2, false), {0.5, 1}, {1, 3}},
        Row{"a hole's rim, 3.2 mm radius", rim(3.2, true), {0.5, 3}, {3, 3}},
        Row{"a hole's rim, 4 mm radius", rim(4, true), {0.5, 1}, {3, 3}},
        Row{"a hole's rim, 7 mm radius", rim(7, true), {0.5, 0.5}, {1, 1}}})
    for (const double voxel_mm : {0.4, 0.8})
      for (const double ball_mm : {1.0, 2.5, 3.5}) {
        SCOPED_TRACE(row.name + std::string(", ball of ") + std::to_string(ball_mm) + ", voxels " +
                     std::to_string(voxel_mm));
        const Leans is = lean_at(row.make, ball_mm, voxel_mm, 4, 300);
        const auto of = [](const std::vector<double>& d, double share) { return share_of(d, share); };
        std::printf("  %-30s ball %.1f voxels %.1f: edge %5.2f %5.2f %5.2f %5.2f, discs %5.2f %5.2f %5.2f %5.2f deg\n",
                    row.name, ball_mm, voxel_mm, of(is.edge_deg, 0.5), of(is.edge_deg, 0.9), of(is.edge_deg, 0.99),
                    is.edge_deg.back(), of(is.discs_deg, 0.5), of(is.discs_deg, 0.9), of(is.discs_deg, 0.99),
                    is.discs_deg.back());
        const int coarse = voxel_mm > 0.5 ? 1 : 0;
        EXPECT_LE(of(is.edge_deg, 0.9), row.most_p90_deg[coarse]);
        EXPECT_LE(of(is.edge_deg, 0.99), std::min(row.most_p99_deg[coarse], of(is.discs_deg, 0.99)));
        EXPECT_GE(of(is.discs_deg, 0.99), 10) << "which this test must be able to show";
      }
}

// A rod that lies over an edge is pressed where it crosses it, which gives the torque its arm. Of discs the deepest may
// be one beside it.
TEST(HapticsNormals, ARodIsPressedWhereItCrossesAnEdge) {
  for (const double voxel_mm : {0.4, 0.8}) {
    std::mt19937_64 rng(5);
    std::vector<double> discs_mm, edge_mm;
    for (int volume_n = 0; volume_n < 4; ++volume_n) {
      const Vec3 a = any_way(rng), along = normalized(cross(a, Vec3{0.3, 1, 0.2})), b = cross(along, a);
      voxel::HapticVolume v = empty(int(22 / voxel_mm), {voxel_mm, voxel_mm, voxel_mm});
      fill_wide(v, 1, [&](Vec3 p) { return std::min(-dot(p, a), -dot(p, b)); });
      const contact::ContactVolume contact(v);
      const double radius_mm = 1.5, length_mm = 8;
      haptics::RoundBody round(contact, {{0, length_mm, radius_mm}});
      for (int n = 0; n < 200; ++n) {
        const double turn = uniform(rng, 0.3, M_PI / 2 - 0.3), crosses_mm = uniform(rng, 2.5, 5.5);
        const Vec3 out = a * std::cos(turn) + b * std::sin(turn), on_edge = along * uniform(rng, -2, 2);
        const Vec3 axis = normalized(cross(along, out) + along * uniform(rng, -0.5, 0.5));
        round.begin_frame();
        haptics::RoundBody::Touch t;
        for (double in = -0.3; in < 1.2 && !t.hit; in += 0.01)
          t = round.deepest(on_edge + out * (radius_mm - in) - axis * crosses_mm, axis, 0, {});
        if (!t.hit) continue;
        discs_mm.push_back(std::abs(t.pressed_mm - crosses_mm));
        round.set_on_edge(t, axis);
        edge_mm.push_back(std::abs(t.pressed_mm - crosses_mm));
      }
    }
    ASSERT_GT(edge_mm.size(), 700u);
    std::sort(discs_mm.begin(), discs_mm.end());
    std::sort(edge_mm.begin(), edge_mm.end());
    std::printf(
        "  rod of 1.5 mm radius over an edge, voxels %.1f: arm off by %.3f %.3f %.3f mm, of discs %.3f %.3f %.3f\n",
        voxel_mm, share_of(edge_mm, 0.5), share_of(edge_mm, 0.99), edge_mm.back(), share_of(discs_mm, 0.5),
        share_of(discs_mm, 0.99), discs_mm.back());
    EXPECT_LE(share_of(edge_mm, 0.5), 0.01);
    EXPECT_LE(share_of(edge_mm, 0.99), 0.5 * voxel_mm);
    EXPECT_GE(share_of(discs_mm, 0.5), 0.2 * voxel_mm) << "which this test must be able to show";
  }
}
