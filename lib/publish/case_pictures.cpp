// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/case_pictures.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "base/parallel.h"
#include "boolean/cutter.h"
#include "meshing/contour.h"
#include "picture/image.h"
#include "picture/palette.h"
#include "picture/render.h"
#include "picture/slice.h"
#include "stages/stage.h"
#include "surface/bounds.h"
#include "voxel/shape_field.h"

namespace trephine::publish {
namespace {

constexpr int cell_px = 640;

surface::Bounds bounds_of_all(const grid::HuVolume* volume, const std::vector<PictureAnatomy>& anatomies) {
  if (anatomies.empty()) return surface::bounds_of(grid::lattice_of(*volume), 0.5);
  surface::Bounds all;
  for (const PictureAnatomy& a : anatomies) surface::include(all, surface::bounds_of(*a.surface));
  return all;
}

picture::Image shaded(const std::vector<picture::SurfaceView>& views, picture::View from, const std::string& title,
                      std::optional<surface::Bounds> frame, const Progress& progress,
                      std::optional<picture::ClipPlane> clip = {}) {
  picture::RenderParams params;
  params.view = from;
  params.width = params.height = cell_px;
  params.title = title;
  params.frame = frame;
  params.clip = clip;
  return picture::render_surfaces(views, params, progress);
}

// The largest shape lies outermost and would hide the rest, so it is drawn transparent.
std::vector<picture::SurfaceView> see_through(const std::vector<PictureAnatomy>& anatomies) {
  std::vector<picture::SurfaceView> views;
  double largest = 0;
  for (const PictureAnatomy& a : anatomies) largest = std::max(largest, std::abs(surface::volume_mm3(*a.surface)));
  for (const PictureAnatomy& a : anatomies) {
    const double share = std::abs(surface::volume_mm3(*a.surface)) / largest;
    views.push_back({a.surface, a.colour_rgb, share > 0.3 && anatomies.size() > 1 ? 0.25 * a.opacity : a.opacity});
  }
  return views;
}

// Their outlines for slices, with their names or without.
std::vector<picture::OverlayShape> outlines_of(const std::vector<PictureAnatomy>& anatomies, bool named) {
  std::vector<picture::Rgb> colours;
  for (const PictureAnatomy& a : anatomies) colours.push_back(a.colour_rgb);
  colours = picture::line_colours(colours);
  std::vector<picture::OverlayShape> shapes;
  for (std::size_t i = 0; i < anatomies.size(); ++i)
    shapes.push_back({anatomies[i].surface, colours[i], named ? anatomies[i].name : ""});
  return shapes;
}

// Where to cut: through the middle of the smallest shape, which is the innermost one.
struct Focus {
  Vec3 at;
  std::string note;  // says so in the picture
};
Focus point_of_interest(const std::vector<PictureAnatomy>& anatomies, const surface::Bounds& frame) {
  if (anatomies.empty()) return {(frame.min_mm + frame.max_mm) / 2, "through the middle"};
  const auto smallest = std::min_element(anatomies.begin(), anatomies.end(), [](const auto& a, const auto& b) {
    return std::abs(surface::volume_mm3(*a.surface)) < std::abs(surface::volume_mm3(*b.surface));
  });
  const surface::Bounds b = surface::bounds_of(*smallest->surface);
  return {(b.min_mm + b.max_mm) / 2, "through the middle of " + smallest->name};
}

// From red (a guess) to green (certain).
std::array<double, 3> colour_of(const cases::CaseLandmark& l) {
  return {1 - l.confidence, 0.15 + 0.75 * l.confidence, 0.1};
}

// Images that may lie on several sheets. The parts of one image are made one after the other, so that as many images
// are made at once as there are threads.
struct Sheet {
  std::string name;
  std::vector<std::size_t> cells;  // images
};

class Sheets {
 public:
  std::size_t image(std::function<picture::Image()> make) {
    makers_.push_back(std::move(make));
    return makers_.size() - 1;
  }
  void add(Sheet sheet) { sheets_.push_back(std::move(sheet)); }

  std::vector<CasePicture> make(const Progress& progress) const {
    std::vector<picture::Image> images(makers_.size());
    std::atomic<std::size_t> made{0};
    const auto one_more = [&] { progress.report(double(++made) / double(makers_.size() + sheets_.size())); };
    parallel_for(0, std::int64_t(images.size()), 1, [&](std::int64_t from, std::int64_t to) {
      for (std::int64_t i = from; i < to; ++i) {
        images[i] = makers_[i]();
        one_more();
      }
    });
    std::vector<CasePicture> pictures(sheets_.size());
    parallel_for(0, std::int64_t(sheets_.size()), 1, [&](std::int64_t from, std::int64_t to) {
      for (std::int64_t i = from; i < to; ++i) {
        std::vector<picture::Image> cells;
        for (const std::size_t c : sheets_[i].cells) cells.push_back(images[c]);
        pictures[i] = {sheets_[i].name, picture::encode_png(picture::contact_sheet(cells, 3))};
        one_more();
      }
    });
    return pictures;
  }

 private:
  std::vector<std::function<picture::Image()>> makers_;
  std::vector<Sheet> sheets_;
};

/// The scene in which landmarks are shown; the makers of the images keep it.
struct LandmarksScene {
  std::vector<surface::TriMesh> balls;
  std::vector<picture::SurfaceView> views;
  std::vector<picture::OverlayShape> outlines;
};

Sheet landmarks_sheet(Sheets& sheets, const grid::HuVolume& volume, const std::vector<PictureAnatomy>& anatomies,
                      const std::vector<cases::CaseLandmark>& landmarks, const surface::Bounds& frame,
                      const Progress& progress) {
  const auto scene = std::make_shared<LandmarksScene>();
  for (const cases::CaseLandmark& l : landmarks) scene->balls.push_back(ball_at(l.position_mm, 0.1));
  scene->views = see_through(anatomies);
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    scene->views.push_back({&scene->balls[i], colour_of(landmarks[i]), 1});
  scene->outlines = outlines_of(anatomies, false);

  Sheet sheet{"landmarks.png", {}};
  for (const picture::View v : {picture::View::front, picture::View::left, picture::View::oblique_right})
    sheet.cells.push_back(
        sheets.image([scene, v, &frame, &progress] { return shaded(scene->views, v, "landmarks", frame, progress); }));
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const cases::CaseLandmark& l = landmarks[i];
    picture::SliceParams params;
    params.plane = stages::plane_of_landmark(l.name);
    const int axis = picture::axis_of(params.plane);
    const auto range = picture::slice_range_mm(grid::lattice_of(volume), params.plane);
    if (l.position_mm[axis] < range[0] || l.position_mm[axis] > range[1]) continue;
    params.longer_side_px = cell_px;
    params.window_width_hu = 400;
    params.position_mm = l.position_mm[axis];
    sheet.cells.push_back(sheets.image([scene, i, params, &l, &volume, &progress] {
      progress.check();
      std::vector<picture::OverlayShape> shapes = scene->outlines;
      shapes.push_back({&scene->balls[i], colour_of(l), l.name + (l.confidence < 0.5 ? " (doubtful)" : "")});
      return picture::slice_overlay(volume, params, shapes);
    }));
  }
  return sheet;
}

std::size_t side(Sheets& sheets, const PictureAnatomy& a, picture::View from, const Progress& progress) {
  return sheets.image([&a, from, &progress] {
    return shaded({{a.surface, a.colour_rgb, 1}}, from, a.name, {}, progress);
  });
}

}  // namespace

surface::TriMesh ball_at(Vec3 position_mm, double within_mm) {
  boolean::Cutter ball;
  ball.kind = boolean::Cutter::Kind::sphere;
  ball.position_mm = position_mm;
  ball.radius_mm = 3;
  return boolean::mesh_of(ball, within_mm);
}

void show_felt(const cases::CaseManifest& manifest, const voxel::HapticVolume& haptic,
               std::list<surface::TriMesh>& kept, std::vector<PictureAnatomy>& shown, const Progress& progress) {
  for (const cases::CaseShape& shape : manifest.haptic.shapes) {
    if (shape.displayed != "haptic") continue;
    progress.check();
    kept.push_back(meshing::contour_to_look_at(voxel::shape_field(haptic, shape.number)));
    picture::give_normals(kept.back());  // once for all pictures
    shown.push_back({shape.name, &kept.back(), shape.material.colour_rgb, 1});
  }
}

std::vector<CasePicture> make_side_pictures(const std::vector<PictureAnatomy>& anatomies, const Progress& whole) {
  const Progress progress = whole.silent();
  Sheets sheets;
  for (const PictureAnatomy& a : anatomies) {
    Sheet sides{a.name + "_sides.png", {}};  // no name of the pictures above
    for (const picture::View v : {picture::View::oblique_left, picture::View::oblique_right, picture::View::front,
                                  picture::View::left, picture::View::back, picture::View::top})
      sides.cells.push_back(side(sheets, a, v, progress));
    sheets.add(std::move(sides));
  }
  return sheets.make(whole);
}

std::vector<CasePicture> make_case_pictures(const grid::HuVolume* volume, const std::vector<PictureAnatomy>& anatomies,
                                            const std::vector<cases::CaseLandmark>& landmarks, const Progress& whole) {
  if (anatomies.empty() && !volume) return {};
  const Progress progress = whole.silent();  // of an image; what is reported is how many of them are made
  const surface::Bounds frame = bounds_of_all(volume, anatomies);
  const Focus focus = point_of_interest(anatomies, frame);
  Sheets sheets;
  if (volume && !landmarks.empty() && !anatomies.empty())
    sheets.add(landmarks_sheet(sheets, *volume, anatomies, landmarks, frame, progress));
  Sheet overview{"overview.png", {}};

  std::vector<picture::SurfaceView> solid;
  for (const PictureAnatomy& a : anatomies) solid.push_back({a.surface, a.colour_rgb, 1});
  // On the cut face what comes later covers what came before: what is enclosed comes after what encloses it.
  std::map<const surface::TriMesh*, double> sizes;
  for (const picture::SurfaceView& s : solid) sizes[s.mesh] = std::abs(surface::volume_mm3(*s.mesh));
  std::stable_sort(solid.begin(), solid.end(), [&](const picture::SurfaceView& a, const picture::SurfaceView& b) {
    return sizes.at(a.mesh) > sizes.at(b.mesh);
  });
  if (anatomies.size() > 1)  // with one anatomy it is that anatomy's own picture
    overview.cells.push_back(sheets.image(
        [&] { return shaded(see_through(anatomies), picture::View::oblique_left, "all", frame, progress); }));
  if (!anatomies.empty()) {
    overview.cells.push_back(sheets.image([&] {
      picture::ClipPlane front_half;
      front_half.point_mm = focus.at;
      front_half.normal = {0, -1, 0};
      return shaded(solid, picture::View::front, "cut", frame, progress, front_half);
    }));
    sheets.add({"cut.png", {overview.cells.back()}});
  }

  for (const PictureAnatomy& a : anatomies) {
    overview.cells.push_back(side(sheets, a, picture::View::oblique_left, progress));
    if (anatomies.size() == 1) overview.cells.push_back(side(sheets, a, picture::View::oblique_right, progress));
  }

  const std::vector<picture::OverlayShape> shapes = outlines_of(anatomies, true);
  constexpr picture::SlicePlane planes[] = {picture::SlicePlane::axial, picture::SlicePlane::coronal,
                                            picture::SlicePlane::sagittal};
  constexpr const char* names[] = {"axial", "coronal", "sagittal"};
  constexpr int slices = 6;
  for (int p = 0; volume && p < 3; ++p) {
    const auto range = picture::slice_range_mm(grid::lattice_of(*volume), planes[p]);
    const int axis = picture::axis_of(planes[p]);
    const double from = std::max(range[0], frame.min_mm[axis]), to = std::min(range[1], frame.max_mm[axis]);
    picture::SliceParams params;
    params.plane = planes[p];
    params.longer_side_px = cell_px;
    params.window_width_hu = 150;  // brain and CSF must be distinguishable; bone is white in any window
    const auto slice = [&] {
      return sheets.image([volume, &shapes, &progress, params] {
        progress.check();
        return picture::slice_overlay(*volume, params, shapes);
      });
    };
    Sheet sheet{std::string(names[p]) + ".png", {}};
    for (int i = 0; i < slices; ++i) {
      params.position_mm = from + (to - from) * (i + 1) / (slices + 1);
      sheet.cells.push_back(slice());
    }
    params.position_mm = std::clamp(focus.at[axis], range[0], range[1]);
    params.note = focus.note;
    overview.cells.push_back(slice());
    if (p == 0) sheets.add({"middle.png", {overview.cells.back()}});
    sheets.add(std::move(sheet));
  }
  sheets.add(std::move(overview));
  return sheets.make(whole);
}

}  // namespace trephine::publish
