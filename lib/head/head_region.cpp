// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/head_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/joined.h"
#include "mask/bits.h"
#include "mask/coarse.h"
#include "mask/field_edge.h"
#include "mask/hu_view.h"
#include "place/cranium.h"

namespace trephine::head {
namespace {

constexpr double coarse_mm = 2;
constexpr double bone_hu = 226;
constexpr double foramen_mm2 = 1300;  ///< a foramen magnum has 600 to 1,000 mm^2; the posterior fossa is far wider
constexpr double cut_side_mm2 = 150;  ///< of tissue at a side of the field of view: a head cut there
constexpr int block_cells = 4;
constexpr double cut_cavity_mm2 = 300;  ///< of the cavity at the top or bottom slice
constexpr double open_mm = 16;
constexpr int open_cells = int(open_mm / coarse_mm);
constexpr double usual_length_ratio[2] = {0.95, 1.5};  ///< seven given heads 1.07 to 1.32
constexpr double usual_height_ratio[2] = {0.72, 1.5};  ///< six given heads 0.90 to 1.10, phantoms 1.03 to 1.08

/// The volume's axis nearest to the patient's superior direction, and whether its indices ascend with it.
struct UpAxis {
  int axis = 2;
  bool ascends = true;
};
UpAxis up_axis(const grid::Lattice& l) {
  const int axis = place::vertical_axis(l);
  return {axis, l.direction.column[axis].z > 0};
}

double cell_face_mm2(const grid::Lattice& l, int axis) { return l.voxel_volume_mm3() / l.spacing_mm[axis]; }

/// The mask's area in each slice across that axis.
std::vector<double> areas_mm2(const mask::BitMask& mask, int axis) {
  const grid::Lattice& l = mask.lattice();
  std::vector<double> area(l.size[axis]);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        if (mask.get(i, j, k)) area[axis == 0 ? i : axis == 1 ? j : k] += cell_face_mm2(l, axis);
  return area;
}

mask::BitMask part_of(const mask::BitMask& mask, const grid::Box& box) {
  return mask::placed(mask::crop(mask, box), mask.lattice());
}

/// Of each shape of a head where the scan's end or the field's edge cuts it: "above and on its left and back side".
class Cuts {
 public:
  void add(std::initializer_list<const char*> shapes, const std::string& end) {
    for (const char* shape : shapes) add_once(of_[shape].ends, end);
  }
  void add_side(const char* shape, const std::string& side) { add_once(of_[shape].sides, side); }
  bool any_of(const char* shape) const { return of_.count(shape) > 0; }
  Named<std::string> in_words() const {
    Named<std::string> out;
    for (const auto& [shape, where] : of_) {
      std::vector<std::string> all = where.ends;
      if (!where.sides.empty()) all.push_back("on its " + listed(where.sides) + " side");
      out.emplace_back(shape, listed(all));
    }
    return out;
  }

 private:
  struct Where {
    std::vector<std::string> ends, sides;
  };
  static void add_once(std::vector<std::string>& words, const std::string& word) {
    if (std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
  }
  std::map<std::string, Where> of_;
};

const char* side_name(const grid::Lattice& l, int axis, bool last) {
  const Vec3 out = l.direction.column[axis] * (last ? 1.0 : -1.0);
  if (std::abs(out.x) >= std::abs(out.y)) return out.x > 0 ? "left" : "right";
  return out.y > 0 ? "back" : "front";
}

/// How much of a head the field's edge cuts towards each side of the volume, in mm2: by axis, first and last.
struct CutAreas {
  std::array<std::array<double, 2>, 3> tissue{}, bone{}, cavity{};
};

/// Adds where padding lies beside the head (mask/field_edge.h), in and beside the cells of `upper`: of a cell that
/// padding cuts, less than half may be tissue.
/// Each block of cells counts for the side to which most of its faces look, so that a round rim behind is not also one
/// beside.
void add_padded(const mask::HuView& hu, const mask::CoarseRaster& raster, const mask::BitMask& upper,
                const mask::BitMask& cavity, CutAreas& out, const Progress& progress) {
  struct Block {
    std::array<std::array<double, 2>, 3> faces{};
    double bone = 0, cavity = 0, all = 0;
  };
  std::map<std::array<int, 3>, Block> blocks;
  const mask::FieldEdge edge = mask::field_edge(hu, progress);
  const mask::BitMask at_head = mask::dilated_6(upper), at_cavity = mask::dilated_6(cavity);
  const grid::Lattice& l = hu.lattice();
  const grid::Box box = edge.tissue.bounds();
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i) {
        const std::array<int, 3> at{i / raster.factor[0], j / raster.factor[1], k / raster.factor[2]};
        if (!edge.tissue.get(i, j, k) || !at_head.get(at[0], at[1], at[2])) continue;
        Block& block = blocks[{at[0] / block_cells, at[1] / block_cells, at[2] / block_cells}];
        const bool in_cavity = at_cavity.get(at[0], at[1], at[2]);
        for (int a = 0; a < 3; ++a)
          for (const int last : {0, 1}) {
            std::array<int, 3> next{i, j, k};
            next[std::size_t(a)] += last ? 1 : -1;
            if (!edge.padding.at(next[0], next[1], next[2])) continue;
            const double mm2 = cell_face_mm2(l, a);
            block.faces[std::size_t(a)][std::size_t(last)] += mm2;
            block.all += mm2;
            if (hu(i, j, k) > bone_hu) block.bone += mm2;
            if (in_cavity) block.cavity += mm2;
          }
      }
  for (const auto& [index, block] : blocks) {
    std::size_t side = 0;
    const auto of_side = [&block = block](std::size_t s) { return block.faces[s / 2][s % 2]; };
    for (std::size_t s = 1; s < 6; ++s)
      if (of_side(s) > of_side(side)) side = s;
    const double mm2 = of_side(side);
    out.tissue[side / 2][side % 2] += mm2;
    out.bone[side / 2][side % 2] += mm2 * block.bone / block.all;
    out.cavity[side / 2][side % 2] += mm2 * block.cavity / block.all;
  }
}

/// How high and how long the cavity is, by how wide, by its moments. A nod adds of its length to its height: a usual
/// head that looks straight up has 1.25, a long narrow one 1.4. Its length is along the longer axis of its
/// section, whichever way the head is turned; only where that lies within 30 degrees of left and right is it the width,
/// which a wrong distance of columns makes the longer.
struct Proportions {
  double height_ratio = 0, length_ratio = 0;
};
Proportions proportions_of(const mask::BitMask& cavity) {
  const grid::Lattice& l = cavity.lattice();
  const Vec3 centre = cavity.centre_mm();
  double xx = 0, xy = 0, yy = 0, zz = 0;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        if (!cavity.get(i, j, k)) continue;
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)}) - centre;
        xx += p.x * p.x, xy += p.x * p.y, yy += p.y * p.y, zz += p.z * p.z;
      }
  const double middle = 0.5 * (xx + yy), apart = std::hypot(0.5 * (xx - yy), xy);
  const double narrow = middle - apart, wide = middle + apart;  // of the axes of its section
  if (!(narrow > 0)) return {};
  return {std::sqrt(zz / narrow), std::sqrt(yy - xx >= -apart ? wide / narrow : narrow / wide)};
}

}  // namespace

Outcome<grid::HuVolume, HeadRegionResult> head_region(const grid::HuVolume& volume, const HeadRegionParams& p,
                                                      const Progress& progress) {
  mask::check_finite(volume);
  const mask::HuView hu(volume);
  const grid::Lattice& l = hu.lattice();
  const mask::CoarseRaster raster = mask::coarse_raster(l, coarse_mm);
  const mask::BitMask bright = mask::above(hu, bone_hu), bone = mask::coarse_mask(bright, raster, 0.5);
  const mask::BitMask tissue =
      mask::largest(mask::components(mask::coarse_mask(mask::above(hu, p.tissue_hu), raster, 0.5)));
  progress.report(0.4);
  HeadRegionResult result;
  Warnings warnings;
  mask::BitMask cavity;
  try {
    auto found = place::cranial_cavity(bone, progress);
    cavity = std::move(found.value);
    result.cranial_cavity_ml = found.result.cranial_cavity_ml;
    warnings = std::move(found.warnings);
  } catch (const Error& e) {
    if (e.code() != ExitCode::quality) throw;
    warnings.push_back({"no_cranial_cavity",
                        "no cranial cavity was found, and the scan was not cut to the head: no space of 15 mm radius "
                        "that bone encloses",
                        {}});
    return {volume, {}, std::move(warnings)};
  }
  const grid::Lattice& c = cavity.lattice();
  const UpAxis up = up_axis(c);
  const std::vector<double> area = areas_mm2(cavity, up.axis);
  const int n = c.size[up.axis];
  const auto at_height = [&](int h) { return up.ascends ? h : n - 1 - h; };  // h counts from the bottom
  int foramen = 0, top = n - 1;
  while (foramen < n - 1 && area[at_height(foramen)] < foramen_mm2) ++foramen;
  while (top > foramen && area[at_height(top)] == 0) --top;

  Vec3 centre;
  for (int a = 0; a < 3; ++a) centre[a] = (c.size[a] - 1) / 2.0;
  centre[up.axis] = at_height(foramen);
  result.foramen_z_mm = c.to_world_mm(centre).z;
  Cuts cuts;
  if (area[at_height(0)] > cut_cavity_mm2 && foramen == 0) {
    warnings.push_back(
        {"ends_below", "the scan ends below in the cranial cavity: the base of the skull is missing", {}});
    cuts.add({"skull", "brain", "dura", "brainstem"}, "below");
  }
  if (area[at_height(n - 1)] > cut_cavity_mm2) {
    warnings.push_back({"ends_above", "the scan ends above in the cranial cavity: the vertex is missing", {}});
    cuts.add({"skin", "skull", "brain", "dura", "midline", "sagittal_sinus"}, "above");
  } else if (const std::vector<double> slices = areas_mm2(tissue, up.axis); slices[at_height(n - 1)] > cut_side_mm2) {
    warnings.push_back(
        {"ends_in_scalp",
         "the scan ends above in the skull or the scalp: the skin of the vertex is missing, and closed by a plane",
         {}});
    cuts.add({"skin"}, "above");
  }

  const int lowest = std::max(0, foramen - int(std::ceil(p.below_mm / c.spacing_mm[up.axis])));
  grid::Box box = grid::whole_box(c);
  (up.ascends ? box.begin : box.end)[up.axis] = up.ascends ? lowest : n - lowest;
  const mask::BitMask head = part_of(tissue, box);
  const grid::Box tight = head.bounds();
  // A side of the field of view that cuts the head itself (not the shoulders below it).
  grid::Box skull_box = box;
  (up.ascends ? skull_box.begin : skull_box.end)[up.axis] = up.ascends ? foramen : n - foramen;
  const mask::BitMask upper = part_of(tissue, skull_box);
  // A cavity ends before a gap of its bone that is wide, as where the field cuts the head: it goes on to the field's
  // edge. Cells of which any part is bone are a wall, as they are to the cavity.
  mask::BitMask soft = mask::both(upper, mask::dilated(cavity, open_mm, progress)), open = cavity;
  soft.remove(mask::coarse_mask(bright, raster, 0));
  for (int step = 0; step < open_cells; ++step) open |= mask::both(mask::dilated_6(open), soft);
  CutAreas areas;
  for (int a = 0; a < 3; ++a) {
    if (a == up.axis) continue;
    const auto ends = [a](const mask::BitMask& of) -> std::array<double, 2> {
      const std::vector<double> mm2 = areas_mm2(of, a);
      return {mm2.front(), mm2.back()};
    };
    areas.tissue[a] = ends(upper);
    areas.bone[a] = ends(mask::both(upper, bone));
    areas.cavity[a] = ends(open);
  }
  add_padded(hu, raster, upper, open, areas, progress.part(0.6, 0.9));
  for (int a = 0; a < 3; ++a)
    for (const bool last : {false, true}) {
      if (!(areas.tissue[a][last] > cut_side_mm2)) continue;
      const bool is_end = a == up.axis;
      const std::string side = is_end ? (last == up.ascends ? "above" : "below") : side_name(c, a, last);
      warnings.push_back({"field_cuts_head",
                          "the field of view cuts the head {where}: what lies there is missing",
                          {{"where", is_end ? side : "on its " + side + " side"}}});
      const auto add = [&](const char* shape) { is_end ? cuts.add({shape}, side) : cuts.add_side(shape, side); };
      add("skin");
      if (areas.bone[a][last] > cut_side_mm2) add("skull");
      if (!(areas.cavity[a][last] > cut_cavity_mm2)) continue;
      for (const char* shape : {"brain", "dura"}) add(shape);
      if (side == "below") add("brainstem");
      if (side == "above" || side == "front" || side == "back")
        for (const char* shape : {"midline", "sagittal_sinus"}) add(shape);
    }
  result.cut = cuts.in_words();
  if (!cuts.any_of("brain")) {
    const auto [ratio, length_ratio] = proportions_of(cavity);
    result.cavity_height_ratio = ratio;
    result.cavity_length_ratio = length_ratio;
    if (length_ratio < usual_length_ratio[0] || length_ratio > usual_length_ratio[1])
      warnings.push_back(
          {"unusual_proportions",
           "the cranial cavity is {length_ratio:.2f} times as long as wide, where heads have 1.1 to 1.4: "
           "the distance of rows or columns may be wrong, or the skull is of an unusual shape; compare it with the "
           "scan's protocol",
           {{"length_ratio", length_ratio}}});
    if (ratio < usual_height_ratio[0] || ratio > usual_height_ratio[1])
      warnings.push_back(
          {"unusual_proportions",
           "the cranial cavity is {height_ratio:.2f} times as high as wide, where heads have 0.9 to 1.1: "
           "the distance between the slices may be wrong, or the skull is of an unusual shape; compare it with the "
           "scan's protocol",
           {{"height_ratio", ratio}}});
  }

  grid::Box fine;
  for (int a = 0; a < 3; ++a) {
    const int margin = int(std::ceil(p.margin_mm / l.spacing_mm[a]));
    fine.begin[a] = std::max(0, tight.begin[a] * raster.factor[a] - margin);
    fine.end[a] = std::min(l.size[a], tight.end[a] * raster.factor[a] + margin);
  }
  // The cut through the neck is a plane, without a margin of the neck below it.
  if (lowest > 0)
    (up.ascends ? fine.begin : fine.end)[up.axis] =
        up.ascends ? lowest * raster.factor[up.axis] : std::min(l.size[up.axis], (n - lowest) * raster.factor[up.axis]);
  grid::HuVolume out = std::visit([&](const auto& grid) { return grid::HuVolume(grid::crop(grid, fine)); }, volume);
  result.region_ml = grid::lattice_of(out).count() * l.voxel_volume_mm3() / 1000;
  result.neck_cut = lowest > 0;
  return {std::move(out), std::move(result), std::move(warnings)};
}

}  // namespace trephine::head
