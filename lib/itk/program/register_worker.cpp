// SPDX-License-Identifier: GPL-3.0-or-later
// The course of a registration: where it begins, how it descends from coarse voxels to fine ones, and how it checks
// itself. What a place is worth is asked of mutual_information.h.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>

#include "base/child.h"
#include "base/degree.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/splitmix64.h"
#include "itk/itk_child.h"
#include "itk/registration_message.h"
#include "mutual_information.h"

namespace trephine::itk {
namespace {

constexpr float body = 0.1f;  ///< a value from 0 to 1 above it is no air
constexpr std::size_t min_places = 500;
constexpr std::array<int, registration_levels> level_samples{8000, 20000, 0};

struct Pair {
  grid::Grid<float> fixed, moving;
};

struct Course {
  RegistrationTask task;
  std::array<Pair, registration_levels> levels;
  grid::Mask look;  ///< of the coarsest fixed level
  Vec3 fixed_centre, moving_centre;
};

/// Centre of what is no air.
Vec3 centre_of(const grid::Grid<float>& grid) {
  Vec3 sum;
  double weight = 0;
  for (int k = 0; k < grid.size[2]; ++k)
    for (int j = 0; j < grid.size[1]; ++j)
      for (int i = 0; i < grid.size[0]; ++i)
        if (grid.at(i, j, k) > body) sum += Vec3{double(i), double(j), double(k)}, weight += 1;
  return grid.to_world_mm(weight > 0 ? sum / weight : Vec3{});
}

/// Where samples may lie: within 16 mm of the body, of a grid of about 8 mm.
grid::Mask around_body(const grid::Grid<float>& grid) {
  grid::Mask mask(grid);
  for (int k = 0; k < grid.size[2]; ++k)
    for (int j = 0; j < grid.size[1]; ++j)
      for (int i = 0; i < grid.size[0]; ++i) {
        if (!(grid.at(i, j, k) > body)) continue;
        for (int c = std::max(0, k - 2); c <= std::min(grid.size[2] - 1, k + 2); ++c)
          for (int b = std::max(0, j - 2); b <= std::min(grid.size[1] - 1, j + 2); ++b)
            for (int a = std::max(0, i - 2); a <= std::min(grid.size[0] - 1, i + 2); ++a) mask.at(a, b, c) = 1;
      }
  return mask;
}

/// About `count` places of a grid within the mask, each off a voxel's centre by up to half a voxel, so that they do not
/// beat with the other grid's voxels.
std::vector<Vec3> places_of(const grid::Lattice& grid, const grid::Mask& look, int count) {
  const auto looked_at = [&](Vec3 p) {
    const Vec3 v = look.to_index(p);
    const int i = static_cast<int>(std::lround(v.x)), j = static_cast<int>(std::lround(v.y)),
              k = static_cast<int>(std::lround(v.z));
    return look.contains(i, j, k) && look.at(i, j, k) > 0;
  };
  const double inside =
      static_cast<double>(std::count_if(look.voxels.begin(), look.voxels.end(), [](auto v) { return v > 0; })) *
      look.voxel_volume_mm3() / grid.voxel_volume_mm3();
  const double share = std::min(1.0, count / std::max(1.0, inside));
  std::uint64_t state = 20;
  const auto uniform = [&] { return unit_of_bits(splitmix64_mixed(state += splitmix64_step)); };
  std::vector<Vec3> places;
  for (int k = 1; k + 1 < grid.size[2]; ++k)
    for (int j = 1; j + 1 < grid.size[1]; ++j)
      for (int i = 1; i + 1 < grid.size[0]; ++i) {
        if (uniform() >= share) continue;
        const Vec3 p = grid.to_world_mm({i + uniform() - 0.5, j + uniform() - 0.5, k + uniform() - 0.5});
        if (looked_at(p)) places.push_back(p);
      }
  return places;
}

struct Place {
  Pose pose;
  double information = 0;
};

/// Steepest ascent with a step that is halved when the slope turns back.
Place ascend(const MutualInformation& of, Pose pose, double step_mm, double min_step_mm, int most) {
  Place best{pose, -1};
  Pose slope, before;
  for (int n = 0; n < most && step_mm >= min_step_mm; ++n) {
    const double here = of.at(pose, &slope);
    if (here > best.information) best = {pose, here};
    double length = 0, turned = 0;
    for (std::size_t i = 0; i < slope.size(); ++i) {
      length += slope[i] * slope[i];
      if (!before.empty()) turned += slope[i] * before[i];
    }
    length = std::sqrt(length);
    if (!(length > 0)) break;
    if (turned < 0) step_mm /= 2;
    for (std::size_t i = 0; i < pose.size(); ++i) pose[i] += step_mm * slope[i] / length;
    before = slope;
  }
  return best;
}

/// One direction: from one scan onto the other.
class Direction {
 public:
  Direction(const Course& course, bool back) : course_(course), back_(back) {
    centre_ = back ? course.moving_centre : course.fixed_centre;
    const grid::Mask own = back ? around_body(course.levels[0].moving) : grid::Mask();
    for (int l = 0; l < registration_levels; ++l) {
      places_[l] =
          places_of(fixed(l), back ? own : course.look, level_samples[l] ? level_samples[l] : course.task.samples);
      if (places_[l].size() < min_places)
        throw Error(ExitCode::bad_input, "", back ? "moving" : "volume",
                    "hardly anything stands out of the values that are compared");
    }
  }
  Vec3 centre() const { return centre_; }
  MutualInformation at_level(int l, bool affine) const {
    return {fixed(l), moving(l), places_[l], course_.task.bins, centre_, affine};
  }
  Place refine(int level, const Pose& from, double step_mm, double min_step_mm, int most = 200) const {
    return ascend(at_level(level, from.size() > 6), from, step_mm, min_step_mm, most);
  }
  /// Through the two finer levels.
  Place finish(const Pose& from, double step_mm) const {
    return refine(2, refine(1, from, step_mm, 0.05).pose, 0.5, 0.004);
  }

 private:
  const grid::Grid<float>& fixed(int l) const { return back_ ? course_.levels[l].moving : course_.levels[l].fixed; }
  const grid::Grid<float>& moving(int l) const { return back_ ? course_.levels[l].fixed : course_.levels[l].moving; }
  const Course& course_;
  bool back_;
  Vec3 centre_;
  std::array<std::vector<Vec3>, registration_levels> places_;
};

/// How far apart two maps put a head's places.
double apart_mm(const LinearMap& a, const LinearMap& b, Vec3 centre) {
  double most = norm(a(centre) - b(centre));
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-arm_mm, arm_mm}) {
      Vec3 p = centre;
      p[axis] += side;
      most = std::max(most, norm(a(p) - b(p)));
    }
  return most;
}

/// The starts of a search without a given transform: centres of mass upon each other, turned and shifted.
std::vector<Pose> starts(const Course& course) {
  const Vec3 shift = course.moving_centre - course.fixed_centre;
  const double turn = 20 * degree * arm_mm;
  std::vector<Pose> all{{0, 0, 0, shift.x, shift.y, shift.z}};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      all.push_back(all[0]);
      all.back()[axis] += sign * turn;
    }
  for (const double up : {-40.0, 40.0}) {
    all.push_back(all[0]);
    all.back()[5] += up;
  }
  return all;
}

class Search {
 public:
  Search(const Course& course, ChildRequest& request)
      : course_(course), request_(request), onto_(course, false), back_(course, true) {}

  RegistrationFound run() {
    const Place rigid = best_rigid();
    const LinearMap map = map_of(rigid.pose, onto_.centre());
    Place affine;
    std::array<LinearMap, 3> perturbed;
    LinearMap reverse;
    std::vector<std::function<void()>> tasks;
    tasks.push_back([&] {
      const Pose from = affine_pose(map, onto_.centre());
      affine = course_.task.affine ? onto_.finish(from, 2) : onto_.refine(1, from, 1, 0.05);
      done(0.1);
    });
    if (course_.task.affine) run_and_clear(tasks);
    const LinearMap found = course_.task.affine ? map_of(affine.pose, onto_.centre()) : map;
    for (std::size_t i = 0; i < perturbed.size(); ++i)
      tasks.push_back([&, i] {
        perturbed[i] = map_of(onto_.finish(off(found, onto_.centre(), i), 2).pose, onto_.centre());
        done(0.12);
      });
    tasks.push_back([&] {
      reverse = map_of(back_.finish(off(inverse(found), back_.centre(), 3), 2).pose, back_.centre());
      done(0.12);
    });
    run_and_clear(tasks);
    RegistrationFound f;
    f.map = found;
    f.information = course_.task.affine ? affine.information : rigid.information;
    for (const LinearMap& p : perturbed) f.spread_mm = std::max(f.spread_mm, apart_mm(found, p, onto_.centre()));
    f.inverse_mm = apart_mm(found, inverse(reverse), onto_.centre());
    judge_place(f);
    f.scale_ratio = stretch(map_of(affine.pose, onto_.centre()));
    return f;
  }

 private:
  static void run_and_clear(std::vector<std::function<void()>>& tasks) {
    parallel_do(tasks);
    tasks.clear();
  }
  void done(double share) {
    double before = progress_.load();
    while (!progress_.compare_exchange_weak(before, before + share)) {
    }
    request_.report(std::min(1.0, before + share));
  }

  Place best_rigid() {
    std::vector<Pose> from = course_.task.has_initial
                                 ? std::vector<Pose>{rigid_pose(course_.task.initial, onto_.centre())}
                                 : starts(course_);
    std::vector<Place> coarse(from.size());
    std::vector<std::function<void()>> tasks;
    for (std::size_t i = 0; i < from.size(); ++i)
      tasks.push_back([&, i] {
        coarse[i] = onto_.refine(0, from[i], 8, 0.25);
        done(0.2 / static_cast<double>(from.size()));
      });
    run_and_clear(tasks);
    std::stable_sort(coarse.begin(), coarse.end(),
                     [](const Place& a, const Place& b) { return a.information > b.information; });
    coarse.resize(std::min<std::size_t>(3, coarse.size()));
    for (Place& place : coarse)
      tasks.push_back([&] {
        place = onto_.refine(1, place.pose, 2, 0.05);
        done(0.05);
      });
    run_and_clear(tasks);
    const Place& best = *std::max_element(coarse.begin(), coarse.end(),
                                          [](const Place& a, const Place& b) { return a.information < b.information; });
    return onto_.refine(2, best.pose, 0.5, 0.004);
  }

  /// 8 mm and 8 degrees off, each number of `which` in another direction.
  Pose off(const LinearMap& map, Vec3 centre, std::size_t which) const {
    constexpr double r = 0.5773502691896258;
    static const Vec3 directions[] = {{r, r, r}, {-r, r, -r}, {r, -r, -r}, {-r, -r, r}};
    const Vec3 d = directions[which % 4];
    const LinearMap moved = then(map, rigid_map(d * 8, Vec3{d.y, -d.z, d.x} * 8, map(centre)));
    return course_.task.affine ? affine_pose(moved, centre) : rigid_pose(moved, centre);
  }

  /// Overlap, and how much less information there is 20 mm off, on the voxels of 4 mm.
  void judge_place(RegistrationFound& f) const {
    const MutualInformation of = onto_.at_level(1, true);
    const auto at = [&](const LinearMap& map) { return of.at(affine_pose(map, onto_.centre())); };
    const double here = at(f.map);
    f.overlap_ratio = of.overlap_ratio();
    double best_off = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-20.0, 20.0}) {
        LinearMap moved = f.map;
        moved.offset_mm[axis] += side;
        best_off = std::max(best_off, at(moved));
      }
    f.margin_ratio = here > 0 ? 1 - best_off / here : 0;
  }

  /// How much the map stretches or shrinks, along the axes of the patient.
  static double stretch(const LinearMap& map) {
    double most = 0;
    for (int axis = 0; axis < 3; ++axis) most = std::max(most, std::fabs(norm(map.matrix.column[axis]) - 1));
    return most;
  }

  const Course& course_;
  ChildRequest& request_;
  Direction onto_, back_;
  std::atomic<double> progress_{0};
};

const ChildWorker worker(register_worker_name, [](ChildRequest& request) {
  MessageReader in = itk_child::opened(register_worker_name, request.request());
  Course course;
  course.task = in.value<RegistrationTask>();
  for (Pair& level : course.levels) {
    level.fixed = itk_child::take_grid(in, register_worker_name);
    level.moving = itk_child::take_grid(in, register_worker_name);
  }
  const grid::Grid<float> within = itk_child::take_grid(in, register_worker_name);
  course.look = around_body(course.levels[0].fixed);
  for (std::size_t i = 0; i < course.look.voxels.size(); ++i)
    course.look.voxels[i] = course.look.voxels[i] && within.voxels.at(i) > 0;
  course.fixed_centre = centre_of(course.levels[0].fixed);
  course.moving_centre = centre_of(course.levels[0].moving);
  MessageWriter out;
  out.value(Search(course, request).run());
  request.write(out.bytes());
});

}  // namespace
}  // namespace trephine::itk
