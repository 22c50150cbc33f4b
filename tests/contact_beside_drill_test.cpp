// SPDX-License-Identifier: GPL-3.0-or-later
// A thread lowers voxels, as a drill does, while others settle and cut: no voxel rises, and nothing that is gone is
// felt.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "contact_walls.h"
#include "report_of.h"
#include "voxel/cut.h"
#include "voxel/raw_voxel.h"

using namespace trephine;
using walls::uniform;

namespace {

constexpr int side = 40;

// Three shapes that meet, with shared voxels at their borders; a border of EMPTY.
voxel::HapticVolume three_shapes() {
  voxel::HapticVolume v;
  v.voxels = grid::Grid<std::int16_t>(walls::lattice(side, {0.5, 0.5, 0.5}), voxel::haptic_empty);
  for (int n = 1; n <= 3; ++n) v.shapes.push_back(voxel::occupancy_shape("shape_" + std::to_string(n), n));
  for (int k = 2; k < side - 2; ++k)
    for (int j = 2; j < side - 2; ++j)
      for (int i = 2; i < side - 2; ++i) {
        const double a = i - 19.3 + 0.3 * j, b = j - 20.2 + 0.2 * k;  // planes between the shapes
        const int own = a < 0 ? 1 : b < 0 ? 2 : 3;
        const double d = std::min(std::abs(a), own == 1 ? 1e9 : std::abs(b));
        v.voxels.at(i, j, k) = voxel::detail::join(own, int(std::lround(255 * std::min(1.0, 0.5 + 0.5 * d))), false);
      }
  return v;
}

// Lowers a random box of voxels in each tick; each voxel must be as it was left, or bare, or lower.
struct Driller {
  voxel::HapticVolume& volume;
  contact::ContactVolume& contact;
  grid::Grid<std::int16_t> left;
  std::mt19937_64 rng{7};
  int risen = 0;

  Driller(voxel::HapticVolume& v, contact::ContactVolume& c) : volume(v), contact(c), left(v.voxels) {}

  void tick(int most) {
    grid::Box box;
    for (std::size_t a = 0; a < 3; ++a) {
      box.begin[a] = 1 + int(rng() % (side - 6));
      box.end[a] = box.begin[a] + 4;
    }
    const grid::Box beside = grid::grown(box, 1, volume.voxels);
    std::vector<int> others;
    for_each(beside, [&](int i, int j, int k) { others.push_back(other(i, j, k)); });
    for (int k = box.begin[2]; k < box.end[2]; ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for (int i = box.begin[0]; i < box.end[0]; ++i) {
          std::int16_t& voxel = volume.voxels.at(i, j, k);
          voxel::detail::change_voxel(voxel, [&](std::int16_t raw) {
            const voxel::detail::RawVoxel is = voxel::detail::split(raw), was = voxel::detail::split(left.at(i, j, k));
            risen += is.share > was.share || (is.number != 0 && is.number != was.number);
            if (is.number == 0) return left.at(i, j, k) = voxel::haptic_empty;
            const int share = is.share - 1 - int(rng() % std::uint64_t(most));
            return left.at(i, j, k) = share > 0 ? voxel::detail::join(is.number, share, true) : voxel::haptic_empty;
          });
        }
    // As every cut does: where the rest of a voxel would go to another shape than before it is EMPTY.
    std::size_t n = 0;
    for_each(beside, [&](int i, int j, int k) {
      if (const int was = others[n++]; was == other(i, j, k)) return;
      voxel::detail::change_voxel(volume.voxels.at(i, j, k), [&](std::int16_t raw) {
        const voxel::detail::RawVoxel is = voxel::detail::split(raw);
        return is.number == 0 ? raw : left.at(i, j, k) = voxel::detail::join(is.number, is.share, true);
      });
    });
    contact.loosen(beside);
  }

 private:
  template <class Each>
  static void for_each(const grid::Box& box, const Each& each) {
    for (int k = box.begin[2]; k < box.end[2]; ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for (int i = box.begin[0]; i < box.end[0]; ++i) each(i, j, k);
  }
  int other(int i, int j, int k) const {
    const voxel::detail::RawVoxel is = voxel::detail::split(voxel::detail::load_voxel(volume.voxels.at(i, j, k)));
    return is.number != 0 ? voxel::detail::other_shape(volume.voxels, is.number, i, j, k) : 0;
  }
};

// What is felt at every place is what a new ContactVolume feels of the same voxels.
int felt_otherwise(const voxel::HapticVolume& volume, const contact::ContactVolume& contact) {
  voxel::HapticVolume copy = volume;
  const contact::ContactVolume fresh(copy);
  std::mt19937_64 rng(3);
  int differ = 0;
  for (int n = 0; n < 200000; ++n) {
    const Vec3 p = volume.voxels.to_world_mm({uniform(rng, 0, side), uniform(rng, 0, side), uniform(rng, 0, side)});
    differ += contact.shape_at(p) != fresh.shape_at(p);
  }
  return differ;
}

void drill_beside_settle(int ticks, int most) {
  voxel::HapticVolume volume = three_shapes();
  contact::ContactVolume contact(volume);
  Driller driller(volume, contact);
  std::atomic<bool> stop{false};
  std::uint64_t settled = 0;
  std::thread settler([&] {
    std::mt19937_64 rng(11);
    while (!stop) {
      grid::Box box;
      for (std::size_t a = 0; a < 3; ++a) {
        box.begin[a] = int(rng() % (side - 12));
        box.end[a] = box.begin[a] + 12;
      }
      contact.settle(box);
      ++settled;
    }
  });
  for (int n = 0; n < ticks; ++n) driller.tick(most);
  stop = true;
  settler.join();
  EXPECT_EQ(driller.risen, 0);
  EXPECT_GT(settled, 10u);
  EXPECT_EQ(felt_otherwise(volume, contact), 0) << "before it settles";
  contact.settle(grid::whole_box(volume.voxels));
  EXPECT_EQ(felt_otherwise(volume, contact), 0) << "after it";
  std::printf("  %d ticks, settled %llu times beside them\n", ticks, static_cast<unsigned long long>(settled));
}

}  // namespace

// F4
TEST(ContactBesideDrill, SettlingUndoesNoCutAndFeelsNothingThatIsGone) {
  drill_beside_settle(20000, 8);
  drill_beside_settle(3000, 255);
}
TEST(LongContactBesideDrill, AMillionTicksBesideSettling) { drill_beside_settle(1000000, 2); }

// F3: a burr hole that is cut while a servo drills.
TEST(ContactBesideDrill, ACutBesideADrillRaisesNothing) {
  voxel::HapticVolume volume = three_shapes();
  contact::ContactVolume contact(volume);
  Driller driller(volume, contact);
  std::atomic<bool> stop{false};
  int cuts = 0;
  std::thread cutter([&] {
    std::mt19937_64 rng(5);
    for (; !stop; ++cuts) {
      const Vec3 centre = volume.voxels.to_world_mm({uniform(rng, 5, 35), uniform(rng, 5, 35), uniform(rng, 5, 35)});
      Report report;
      value_of(report, voxel::cut_volume(volume, [=](Vec3 p) { return norm(p - centre) - 1.5; },
                                         {centre - Vec3{1.5, 1.5, 1.5}, centre + Vec3{1.5, 1.5, 1.5}}, {1, 3}));
    }
  });
  for (int n = 0; n < 20000; ++n) driller.tick(6);
  stop = true;
  cutter.join();
  EXPECT_GT(cuts, 3);
  // A shared voxel that is cut may keep its other shape's share, and then is of that shape; its own part never rises.
  int risen = 0;
  for (std::size_t n = 0; n < volume.voxels.voxels.size(); ++n) {
    const voxel::detail::RawVoxel is = voxel::detail::split(volume.voxels.voxels[n]),
                                  was = voxel::detail::split(driller.left.voxels[n]);
    risen += is.number == was.number && is.share > was.share;
  }
  EXPECT_EQ(risen, 0);
}
