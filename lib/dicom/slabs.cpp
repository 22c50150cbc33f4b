// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/slabs.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace trephine::dicom {
namespace {

const Frame& frame_of(const FrameRef& r) { return r.header->frames[static_cast<std::size_t>(r.frame)]; }

/// The slices of one acquisition, ascending along the normal.
struct Slab {
  std::vector<FrameRef> slices;
  std::vector<double> along_mm;
  double from() const { return along_mm.front(); }
  double to() const { return along_mm.back(); }
};

std::vector<Slab> slabs_of(const std::vector<FrameRef>& stack) {
  const Frame& f = frame_of(stack.front());
  const Vec3 n = cross((*f.orientation)[0], (*f.orientation)[1]);
  std::map<std::string, std::vector<std::pair<double, FrameRef>>> by_number;
  for (const FrameRef& r : stack) by_number[r.header->acquisition].emplace_back(dot(*frame_of(r).position_mm, n), r);
  std::vector<Slab> slabs;
  for (auto& [number, slices] : by_number) {
    std::stable_sort(slices.begin(), slices.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    slabs.emplace_back();
    for (const auto& [along, r] : slices) {
      slabs.back().slices.push_back(r);
      slabs.back().along_mm.push_back(along);
    }
  }
  std::stable_sort(slabs.begin(), slabs.end(), [](const Slab& a, const Slab& b) {
    return std::make_pair(a.from(), a.to()) < std::make_pair(b.from(), b.to());
  });
  return slabs;
}

bool overlap(const Slab& a, const Slab& b) { return b.from() < a.to() + same_position_mm; }

bool has(const Slab& slab, double along_mm) {
  const auto at = std::lower_bound(slab.along_mm.begin(), slab.along_mm.end(), along_mm - same_position_mm);
  return at != slab.along_mm.end() && *at < along_mm + same_position_mm;
}

/// Whether b goes on where a ends; where they overlap, at the same positions and by less than half.
bool follows(const Slab& a, const Slab& b) {
  if (!overlap(a, b)) return true;
  if (!(a.from() < b.from() && a.to() < b.to())) return false;
  std::size_t shared = 0;
  for (const double at : b.along_mm) {
    if (at > a.to() + same_position_mm) break;
    if (!has(a, at)) return false;
    ++shared;
  }
  for (const double at : a.along_mm)
    if (at > b.from() - same_position_mm && !has(b, at)) return false;
  return 2 * shared < std::min(a.slices.size(), b.slices.size());
}

/// The chain of most slices: places in `slabs`, ascending.
std::vector<std::size_t> longest_chain(const std::vector<Slab>& slabs) {
  std::vector<std::size_t> count(slabs.size()), before(slabs.size(), slabs.size());
  std::size_t last = 0;
  for (std::size_t i = 0; i < slabs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      if (count[j] > count[i] && follows(slabs[j], slabs[i])) count[i] = count[j], before[i] = j;
    count[i] += slabs[i].slices.size();
    if (count[i] > count[last]) last = i;
  }
  std::vector<std::size_t> chain;
  for (std::size_t i = last; i < slabs.size(); i = before[i]) chain.push_back(i);
  std::reverse(chain.begin(), chain.end());
  return chain;
}

}  // namespace

std::vector<std::vector<FrameRef>> part_by_acquisition(std::vector<FrameRef> stack) {
  std::vector<Slab> slabs = slabs_of(stack);
  double to = slabs.front().to();
  bool any = false;
  for (std::size_t i = 1; i < slabs.size(); ++i) {
    any = any || slabs[i].from() < to + same_position_mm;
    to = std::max(to, slabs[i].to());
  }
  if (!any) return {std::move(stack)};
  std::vector<std::vector<FrameRef>> scans;
  std::vector<FrameRef> twice;  // what a later slab shows once more
  while (!slabs.empty()) {
    scans.emplace_back();
    const Slab* before = nullptr;
    const std::vector<std::size_t> chain = longest_chain(slabs);
    for (const std::size_t i : chain) {
      for (std::size_t s = 0; s < slabs[i].slices.size(); ++s)
        (before && overlap(*before, slabs[i]) && has(*before, slabs[i].along_mm[s]) ? twice : scans.back())
            .push_back(slabs[i].slices[s]);
      before = &slabs[i];
    }
    for (auto i = chain.rbegin(); i != chain.rend(); ++i) slabs.erase(slabs.begin() + static_cast<std::ptrdiff_t>(*i));
  }
  if (!twice.empty()) scans.push_back(std::move(twice));
  return scans;
}

void find_rescans(std::vector<Series>& series) {
  for (Series& s : series)
    for (const Series& whole : series) {
      if (s.slices.empty() || !s.refusal.empty() || 2 * s.slices.size() >= whole.slices.size() ||
          s.sort_uid != whole.sort_uid)
        continue;
      const FileHeader &h = *s.slices.front().header, &g = *whole.slices.front().header;
      if (h.study_uid != g.study_uid || h.frame_uid != g.frame_uid || h.kernel != g.kernel || h.rows != g.rows ||
          h.columns != g.columns || norm(s.stack.normal() - whole.stack.normal()) > 1e-3)
        continue;
      const auto ends = [n = whole.stack.normal()](const Series& of) {
        double from = 1e300, to = -1e300;
        for (const Vec3& p : of.stack.positions_mm) from = std::min(from, dot(p, n)), to = std::max(to, dot(p, n));
        return std::make_pair(from, to);
      };
      const auto [from, to] = ends(s);
      const auto [first, last] = ends(whole);
      const double step = whole.summary.spacing_mm.z;
      if (from < first - step || to > last + step) continue;
      s.part_of = whole.summary.token;
      break;
    }
}

}  // namespace trephine::dicom
