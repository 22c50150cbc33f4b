// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/mixtures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "dicom/header_tags.h"

namespace trephine::dicom {
namespace {

using Stack = std::vector<FrameRef>;

const Frame& frame_of(const FrameRef& r) { return r.header->frames[static_cast<std::size_t>(r.frame)]; }

Vec3 normal_of(const FrameRef& r) { return cross((*frame_of(r).orientation)[0], (*frame_of(r).orientation)[1]); }
double along(const FrameRef& r, Vec3 normal) { return dot(*frame_of(r).position_mm, normal); }

std::map<std::string, Stack> by_text(const Stack& stack, std::string FileHeader::*member) {
  std::map<std::string, Stack> parts;
  for (const FrameRef& r : stack) parts[r.header->*member].push_back(r);
  return parts;
}

std::vector<Stack> values_of(const std::map<std::string, Stack>& parts) {
  std::vector<Stack> out;
  for (const auto& [text, stack] : parts) out.push_back(stack);
  return out;
}

/// Whether two parts lie within each other: more than a slice of the one between the ends of the other.
bool overlap(const std::map<std::string, Stack>& parts) {
  struct Range {
    double from = 1e300, to = -1e300;
  };
  std::vector<Range> ranges;
  const Vec3 n = normal_of(parts.begin()->second.front());
  for (const auto& [text, stack] : parts) {
    Range range;
    for (const FrameRef& r : stack) {
      range.from = std::min(range.from, along(r, n));
      range.to = std::max(range.to, along(r, n));
    }
    ranges.push_back(range);
  }
  std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) { return a.from < b.from; });
  double to = ranges.front().to;
  for (std::size_t i = 1; i < ranges.size(); ++i) {
    if (ranges[i].from < to - same_position_mm) return true;
    to = std::max(to, ranges[i].to);
  }
  return false;
}

template <class Parts>
std::vector<Stack> parted(std::vector<Stack> stacks, Parts parts_of) {
  std::vector<Stack> out;
  for (Stack& s : stacks)
    for (Stack& part : parts_of(std::move(s))) out.push_back(std::move(part));
  return out;
}

// Where most slices have a value of their own, a program gave each file a new one.
std::vector<Stack> by_identity(Stack s, std::string FileHeader::*member) {
  const auto parts = by_text(s, member);
  if (parts.size() < 2 || (parts.size() > 2 && 2 * parts.size() > s.size())) return {std::move(s)};
  return values_of(parts);
}

std::vector<Stack> by_interleaved(Stack s, std::string FileHeader::*member) {
  const auto parts = by_text(s, member);
  if (parts.size() < 2 || !overlap(parts)) return {std::move(s)};
  return values_of(parts);
}

/// How a slice differs from those of a series; an empty field where it does not.
struct Difference {
  std::uint32_t tag = 0;
  std::string what;
};
Difference difference(const FrameRef& odd, const Series& s) {
  const FileHeader &h = *odd.header, &g = *s.slices.front().header;
  const Frame &f = frame_of(odd), &e = frame_of(s.slices.front());
  const auto apart = [](double a, double b) { return std::abs(a - b) > 1e-4 * b; };
  if (h.patient_id != g.patient_id) return {t_patient, "is that of another patient"};
  if (h.study_uid != g.study_uid) return {t_study, "is that of another study"};
  if (h.modality != g.modality) return {make_tag(0x0008, 0x0060), "is another one"};
  if (h.rows != g.rows || h.columns != g.columns)
    return {t_rows, fmt::format("{} x {}, the others have {} x {}", h.columns, h.rows, g.columns, g.rows)};
  if (apart((*f.spacing_mm)[0], (*e.spacing_mm)[0]) || apart((*f.spacing_mm)[1], (*e.spacing_mm)[1]))
    return {t_spacing, fmt::format("{:.4g} x {:.4g} mm, the others have {:.4g} x {:.4g}", (*f.spacing_mm)[0],
                                   (*f.spacing_mm)[1], (*e.spacing_mm)[0], (*e.spacing_mm)[1])};
  const double cosine = dot(normal_of(odd), normal_of(s.slices.front()));
  if (cosine < std::cos(0.06 * M_PI / 180))
    return {t_orientation, fmt::format("turned by {:.2f} degrees against the others",
                                       std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI)};
  for (int i = 0; i < 2; ++i)
    if (norm((*f.orientation)[static_cast<std::size_t>(i)] - (*e.orientation)[static_cast<std::size_t>(i)]) > 1e-3)
      return {t_orientation, "rows and columns run otherwise than in the others"};
  if (h.frame_uid != g.frame_uid) return {t_frame_uid, "is another one than the others'"};
  if (h.kernel != g.kernel) return {t_kernel, "is another one than the others'"};
  if (h.acquisition != g.acquisition) return {t_acquisition, "is another one than the others'"};
  return {};
}

template <class Get>
auto distinct(const Series& s, Get get) {
  std::set<decltype(get(s.slices.front()))> all;
  for (const FrameRef& r : s.slices) all.insert(get(r));
  return all;
}

}  // namespace

std::vector<Stack> part_mixture(Stack stack) {
  std::vector<Stack> out = {std::move(stack)};
  for (const auto member : {&FileHeader::patient_id, &FileHeader::study_uid, &FileHeader::frame_uid})
    out = parted(std::move(out), [member](Stack s) { return by_identity(std::move(s), member); });
  out = parted(std::move(out), [](Stack s) { return by_interleaved(std::move(s), &FileHeader::kernel); });
  return parted(std::move(out), [](Stack s) { return by_interleaved(std::move(s), &FileHeader::acquisition); });
}

void find_odd_slices(std::vector<Series>& series) {
  for (Series& s : series) {
    if (s.slices.empty() || !s.refusal.empty()) continue;
    const Vec3 n = s.stack.normal();
    double from = 1e300, to = -1e300;
    for (const FrameRef& r : s.slices) {
      from = std::min(from, along(r, n));
      to = std::max(to, along(r, n));
    }
    const double reach = 2.5 * std::max(1.0, s.summary.spacing_mm.z);
    for (const Series& other : series) {
      if (&other == &s || other.slices.empty() || other.sort_uid != s.sort_uid ||
          other.slices.size() >= s.slices.size())
        continue;
      for (const FrameRef& r : other.slices) {
        const double at = along(r, n);
        if (!(at > from - reach && at < to + reach)) continue;
        const Difference d = difference(r, s);
        if (d.tag == 0) continue;
        s.odd.push_back({r.header->name, tag_name(d.tag), d.what, at, at > from && at < to});
      }
    }
    std::sort(s.odd.begin(), s.odd.end(), [](const OddSlice& a, const OddSlice& b) {
      return std::tie(a.along_mm, a.field, a.file) < std::tie(b.along_mm, b.field, b.file);
    });
  }
}

StackGeometry analyse_series(const Series& s, const ImportParams& params) {
  if (params.units == UnitPolicy::hu)
    for (const FrameRef& r : s.slices)
      if (const std::string& unit = r.header->rescale_type; s.is_ct && !unit.empty() && unit != "HU")
        throw Error(ExitCode::bad_input, r.header->name, tag_name(t_rescale_type),
                    unit +
                        ", must be HU; where the values are Hounsfield units all the same (some programs write US, "
                        "unspecified), --units any takes them for such");
  if (params.burned_in_reason.empty())
    for (const FrameRef& r : s.slices)
      if (r.header->burned_in)
        throw Error(ExitCode::privacy, r.header->name, tag_name(t_burned_in),
                    "YES: the pixels may show the patient's name; look at them, and say with burned_in_reason why they "
                    "may be used");
  try {
    return analyse_stack(s.stack, params.gaps, params.max_gap_mm);
  } catch (const Error& e) {
    // A slice that was parted from the series is not one that was lost.
    if (e.field() == tag_name(t_position) && params.gaps == GapPolicy::refuse)
      for (const OddSlice& odd : s.odd)
        if (odd.within)
          throw Error(ExitCode::bad_input, odd.file, odd.field,
                      odd.what + fmt::format(", at {:.1f} mm along the slices' normal: it is none of the series, and "
                                             "leaves a gap; --gaps interpolate reads the others",
                                             odd.along_mm));
    throw;
  }
}

void warn_of_changes(const Series& s, const HuCounts& counts, Report& report) {
  const auto changes = [&](const char* what, std::size_t count, const char* then = "") {
    if (count > 1) report.warn(fmt::format("{} changes within the series, {} values{}", what, count, then));
  };
  const auto slopes = distinct(s, [](const FrameRef& r) { return frame_of(r).slope.value_or(1); });
  const auto intercepts = distinct(s, [](const FrameRef& r) { return frame_of(r).intercept.value_or(0); });
  changes("RescaleSlope", slopes.size(), ": applied slice by slice");
  changes("RescaleIntercept", intercepts.size(), ": applied slice by slice");
  changes("the kernel", distinct(s, [](const FrameRef& r) { return r.header->kernel; }).size());
  changes("kVp", distinct(s, [](const FrameRef& r) { return r.header->kvp.value_or(0); }).size());
  changes("the contrast agent's tag", distinct(s, [](const FrameRef& r) { return r.header->contrast; }).size());
  changes("PatientPosition", distinct(s, [](const FrameRef& r) { return r.header->patient_position; }).size());
  changes("PatientID", distinct(s, [](const FrameRef& r) { return r.header->patient_id; }).size(),
          ": that all slices are of one patient is taken on trust");
  changes("StudyInstanceUID", distinct(s, [](const FrameRef& r) { return r.header->study_uid; }).size());
  changes("FrameOfReferenceUID", distinct(s, [](const FrameRef& r) { return r.header->frame_uid; }).size(),
          ": that all slices are of one frame is taken on trust");
  if (!s.is_ct) return;
  if (*slopes.begin() < 0)
    report.warn(fmt::format("RescaleSlope is {:.4g}: bright and dark are exchanged", *slopes.begin()));
  constexpr double least = -10240, most = 100;
  for (const double i : {*intercepts.begin(), *intercepts.rbegin()})
    if (i < least || i > most) {
      report.warn(fmt::format("RescaleIntercept is {:.6g}, usual is -1024, at most {} to {}", i, least, most));
      break;
    }
  for (const std::string& type : distinct(s, [](const FrameRef& r) { return r.header->raw_image_type; }))
    if (type.find("MIP") != std::string::npos || type.find("MAX_IP") != std::string::npos ||
        type.find("MIN_IP") != std::string::npos) {
      report.warn("ImageType says that slices are projections (MIP), which show no surfaces where they are");
      break;
    }
  constexpr double metal_hu = 31000;
  if (counts.max > metal_hu)
    report.warn(
        fmt::format("values up to {:.0f} HU, metal has at most about {:.0f}: are these HU?", counts.max, metal_hu));
}

}  // namespace trephine::dicom
