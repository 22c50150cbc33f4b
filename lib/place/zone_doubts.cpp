// SPDX-License-Identifier: GPL-3.0-or-later
#include "place/zone_doubts.h"

#include <algorithm>
#include <cmath>

#include "mask/filters.h"
#include "mask/hu_view.h"

namespace trephine::place {
namespace {

constexpr double usual_third_ml = 0.5, whole_third_ratio = 0.8;
constexpr double air_hu = -300, most_air_ratio = 0.02;
constexpr double fat_mean_hu[2] = {-130, -50}, fat_hu[2] = {-220, 40}, fat_step_mm = 1.5, within_mm = 2,
                 most_fat_ml = 2;

void doubt_third_ventricle(const grid::Field& zone, Warnings& out) {
  std::size_t all = 0, largest = 0;
  for (const mask::Component& c : mask::components(mask::positive(zone, zone)).list) {
    all += c.voxels;
    largest = std::max(largest, std::size_t(c.voxels));
  }
  const double ml = double(all) * zone.voxel_volume_mm3() / 1000;
  if (all == 0 || (ml >= usual_third_ml && double(largest) >= whole_third_ratio * double(all))) return;
  out.push_back(
      {"unusual_third_ventricle",
       "what is taken for the third ventricle has {volume_ml:.1f} ml, {whole_percent:.0f} % of it in one "
       "piece (an adult's has {usual_ml} ml and more, in one): it may be a part of another space, or missing",
       {{"volume_ml", ml}, {"whole_percent", 100.0 * double(largest) / double(all)}, {"usual_ml", usual_third_ml}}});
}

/// HU of the nearest voxel; nothing outside of the scan.
std::optional<double> hu_at(const mask::HuView& hu, Vec3 lps_mm) {
  const Vec3 at = hu.lattice().to_index(lps_mm);
  const int i = int(std::lround(at.x)), j = int(std::lround(at.y)), k = int(std::lround(at.z));
  if (!hu.lattice().contains(i, j, k)) return {};
  return hu(i, j, k);
}

bool is_fat(const mask::HuView& hu, Vec3 lps_mm) {
  double sum = 0, n = 0;
  for (const Vec3 step :
       {Vec3{}, Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}})
    if (const std::optional<double> v = hu_at(hu, lps_mm + step * fat_step_mm)) {
      if (*v < fat_hu[0] || *v > fat_hu[1]) return false;
      sum += *v, ++n;
    }
  return n > 0 && sum / n > fat_mean_hu[0] && sum / n < fat_mean_hu[1];
}

/// The share of the zone that lies deeper than `deep_mm` and for which the test holds, and its volume.
template <class Test>
std::pair<double, double> share_and_ml(const grid::Field& zone, double deep_mm, const Test& test) {
  double all = 0, yes = 0;
  for (int k = 0; k < zone.size[2]; ++k)
    for (int j = 0; j < zone.size[1]; ++j)
      for (int i = 0; i < zone.size[0]; ++i)
        if (zone.at(i, j, k) > deep_mm) ++all, yes += test(zone.to_world_mm({double(i), double(j), double(k)}));
  return {all > 0 ? yes / all : 0, yes * zone.voxel_volume_mm3() / 1000};
}

}  // namespace

Warnings zone_doubts(const grid::Field& zone, Zone what, const grid::HuVolume* volume) {
  Warnings out;
  if (what == Zone::third_ventricle) doubt_third_ventricle(zone, out);
  if (!volume) return out;
  const mask::HuView hu(*volume);
  if (what == Zone::dura) {
    const double ml = share_and_ml(zone, within_mm, [&](Vec3 p) { return is_fat(hu, p); }).second;
    if (ml > most_fat_ml)
      out.push_back(
          {"fat_inside_dura",
           "{fat_ml:.0f} ml inside it are as dark as fat, as of an orbit or of the scalp over a gap of the bone: "
           "there it is not the dura",
           {{"fat_ml", ml}}});
  } else {
    const double ratio = share_and_ml(zone, 0, [&](Vec3 p) { return hu_at(hu, p).value_or(0) < air_hu; }).first;
    if (ratio > most_air_ratio)
      out.push_back({"zone_in_air",
                     "{air_percent:.0f} % of it lie in air, where the template of a head does not fit this one",
                     {{"air_percent", 100 * ratio}}});
  }
  return out;
}

}  // namespace trephine::place
