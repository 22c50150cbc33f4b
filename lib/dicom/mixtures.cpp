// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/mixtures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "dicom/attributes.h"
#include "dicom/header_tags.h"
#include "dicom/slabs.h"

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

/// How a slice differs from those of a series.
struct Difference {
  std::uint32_t tag = 0;
  std::string what;
};
Difference difference(const FrameRef& odd, const Series& s) {
  const FileHeader &h = *odd.header, &g = *s.slices.front().header;
  const Frame &f = frame_of(odd), &e = frame_of(s.slices.front());
  const auto apart = [](double a, double b) { return std::abs(a - b) > 1e-4 * b; };
  if (h.study_uid != g.study_uid) return {t_study, "is that of another study"};
  if (h.modality != g.modality) return {t_modality, "is another one"};
  if (h.is_ct() != g.is_ct() || h.sop_class != g.sop_class) return {t_sop_class, "is another one than the others'"};
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
  return {t_series, "is the series', but the slice is none of it"};
}

struct Extent {
  double from = 1e300, to = -1e300;
};
Extent extent_of(const Series& s) {
  Extent range;
  for (const FrameRef& r : s.slices) {
    range.from = std::min(range.from, along(r, s.stack.normal()));
    range.to = std::max(range.to, along(r, s.stack.normal()));
  }
  return range;
}

// One or two slices that differ in nothing but the series' UID, right beyond an end: they would be missed.
bool continues(const Series& other, const Series& s, const Extent& range) {
  if (other.slices.size() >= s.slices.size() || count_levels(other.stack) >= min_slices) return false;
  const FileHeader &h = *other.slices.front().header, &g = *s.slices.front().header;
  if (h.study_uid != g.study_uid || h.frame_uid != g.frame_uid || h.kernel != g.kernel || h.rows != g.rows ||
      h.columns != g.columns || h.modality != g.modality || h.raw_image_type != g.raw_image_type)
    return false;
  const Stack both = {other.slices.front(), s.slices.front()};
  for (int i = 0; i < 2; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (norm((*frame_of(both[0]).orientation)[at] - (*frame_of(both[1]).orientation)[at]) > 1e-3) return false;
    if (std::abs((*frame_of(both[0]).spacing_mm)[at] - (*frame_of(both[1]).spacing_mm)[at]) > 1e-4) return false;
  }
  const double at = along(both[0], s.stack.normal()), step = 1.5 * s.summary.spacing_mm.z;
  return (at < range.from && at > range.from - step) || (at > range.to && at < range.to + step);
}

// A slice that was left out before it came to any series: a localizer by its ImageType, one whose tags are wrong.
std::optional<OddSlice> odd_slice(const LeftOut& left, const Series& s, const Extent& range, double reach) {
  const FileHeader &h = *left.header, &g = *s.slices.front().header;
  if (h.series_uid != s.sort_uid || h.rows != g.rows || h.columns != g.columns) return {};
  OddSlice odd{h.name, tag_name(left.tag), left.what, std::nan(""), false};
  if (h.frames.empty() || !h.frames.front().position_mm || !h.frames.front().orientation) return odd;
  const FrameRef r{&h, 0};
  if (norm(normal_of(r) - s.stack.normal()) > 0.1) return {};  // a localizer that is one
  odd.along_mm = along(r, s.stack.normal());
  if (!(odd.along_mm > range.from - reach && odd.along_mm < range.to + reach)) return {};
  odd.within = odd.along_mm > range.from && odd.along_mm < range.to;
  return odd;
}

void refuse_several_patients(const Series& s) {
  const SeriesIdentity said = identity_of(s.slices);
  if (said.contradictions.empty()) return;
  const auto& first = said.contradictions.front();
  const auto absent = static_cast<std::size_t>(said.absent[static_cast<std::size_t>(first.which)]);
  throw Error(ExitCode::bad_input, first.odd->header->name, tag_name(identity_tag(first.which)),
              (first.values > 1 ? fmt::format("{} values within the series", first.values)
                                : fmt::format("given by {} of {} slices", s.slices.size() - absent, s.slices.size())) +
                  ": slices of several patients; take the files of the others out, or, where it is one patient after "
                  "all, say why with same_patient_reason");
}

void refuse_unequal(const Series& s) {
  for (std::size_t a = 0; a < attributes().size(); ++a) {
    if (attributes()[a].rule != AttributeRule::equal) continue;
    std::map<std::uint64_t, std::size_t> counts;
    for (const FrameRef& r : s.slices) ++counts[r.header->said[a]];
    if (counts.size() < 2) continue;
    const FrameRef* odd = &s.slices.front();
    for (const FrameRef& r : s.slices)
      if (counts[r.header->said[a]] < counts[odd->header->said[a]]) odd = &r;
    throw Error(ExitCode::bad_input, odd->header->name, tag_name(attributes()[a].tag),
                fmt::format("{} values within the series, this one in {} of {} slices: they cannot be read alike; take "
                            "these files out, and where that leaves a gap, read it with ",
                            counts.size(), counts[odd->header->said[a]], s.slices.size()) +
                    Setting{"gaps", "interpolate"});
  }
}

void warn_of_identity(const Series& s, Warnings& warnings) {
  const SeriesIdentity said = identity_of(s.slices);
  for (int which = 0; which < identity_count; ++which) {
    const auto absent = static_cast<std::size_t>(said.absent[static_cast<std::size_t>(which)]);
    if (absent > 0 && absent < s.slices.size())
      warnings.push_back({"identity_of_some",
                          "{attribute} is given by {count} of {slices_count} slices: that the others are of the same "
                          "patient is taken on trust",
                          {{"attribute", identity_keyword(which)},
                           {"count", static_cast<std::int64_t>(s.slices.size() - absent)},
                           {"slices_count", static_cast<std::int64_t>(s.slices.size())}}});
  }
  for (const int which : said.own_for_each)
    warnings.push_back({"identity_of_each",
                        "{attribute} is another one in most slices: that all are of one patient is taken on trust",
                        {{"attribute", identity_keyword(which)}}});
  for (const auto& c : said.contradictions)
    if (c.values > 1)
      warnings.push_back({"identity_contradicts",
                          "{attribute} has {count} values within the series, which is used for the reason given",
                          {{"attribute", identity_keyword(c.which)}, {"count", static_cast<std::int64_t>(c.values)}}});
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
  for (const auto member : {&FileHeader::study_uid, &FileHeader::frame_uid})
    out = parted(std::move(out), [member](Stack s) { return by_identity(std::move(s), member); });
  out = parted(std::move(out), [](Stack s) { return by_interleaved(std::move(s), &FileHeader::kernel); });
  return parted(std::move(out), [](Stack s) { return part_by_acquisition(std::move(s)); });
}

void find_odd_slices(std::vector<Series>& series, const std::vector<LeftOut>& left_out) {
  for (Series& s : series) {
    if (s.slices.empty() || !s.refusal.empty()) continue;
    const Vec3 n = s.stack.normal();
    const Extent range = extent_of(s);
    const auto [from, to] = range;
    const double reach = 2.5 * std::max(1.0, s.summary.spacing_mm.z);
    for (const LeftOut& left : left_out)
      if (auto odd = odd_slice(left, s, range, reach)) s.odd.push_back(std::move(*odd));
    for (const Series& other : series) {
      if (&other == &s || other.slices.empty() || other.slices.size() >= s.slices.size() || !other.part_of.empty())
        continue;
      if (other.sort_uid != s.sort_uid) {
        if (continues(other, s, range))
          for (const FrameRef& r : other.slices)
            s.odd.push_back({r.header->name, tag_name(t_series), "is another one, and the slice continues the series",
                             along(r, n), false});
        continue;
      }
      for (const FrameRef& r : other.slices) {
        const double at = along(r, n);
        if (!(at > from - reach && at < to + reach)) continue;
        const Difference d = difference(r, s);
        s.odd.push_back({r.header->name, tag_name(d.tag), d.what, at, at > from && at < to});
      }
    }
    std::sort(s.odd.begin(), s.odd.end(), [](const OddSlice& a, const OddSlice& b) {
      const bool no_a = std::isnan(a.along_mm), no_b = std::isnan(b.along_mm);  // those without a position last
      const double at_a = no_a ? 0 : a.along_mm, at_b = no_b ? 0 : b.along_mm;
      return std::tie(no_a, at_a, a.field, a.file) < std::tie(no_b, at_b, b.field, b.file);
    });
  }
}

StackGeometry analyse_series(const Series& s, const ImportParams& params) {
  if (trimmed(params.same_patient_reason).empty()) refuse_several_patients(s);
  refuse_unequal(s);
  if (params.units == UnitPolicy::hu)
    for (const FrameRef& r : s.slices)
      if (const std::string& unit = r.header->rescale_type; s.is_ct && !unit.empty() && unit != "HU")
        throw Error(ExitCode::bad_input, r.header->name, tag_name(t_rescale_type),
                    unit +
                        ", must be HU; where the values are Hounsfield units all the same (some programs write US, "
                        "unspecified), " +
                        Setting{"units", "any"} + " takes them for such");
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
    if (e.cause() == Cause::missing_slices && params.gaps == GapPolicy::refuse)
      for (const OddSlice& odd : s.odd)
        if (odd.within)
          throw Error(ExitCode::bad_input, odd.file, odd.field,
                      odd.what +
                          fmt::format(", at {:.1f} mm along the slices' normal: it is none of the series, and leaves a "
                                      "gap; ",
                                      odd.along_mm) +
                          Setting{"gaps", "interpolate"} + " reads the others");
    throw;
  }
}

Warnings warnings_of_changes(const Series& s, const HuCounts& counts) {
  Warnings all;
  const auto warn = [&](const char* id, const char* form, Named<ParameterValue> values = {}) {
    all.push_back({id, form, std::move(values)});
  };
  const auto changes = [&](const char* what, std::size_t count, const std::string& then = "") {
    if (count > 1)
      warn("attribute_changes", "{attribute} changes within the series, {count} values{then}",
           {{"attribute", what}, {"count", static_cast<std::int64_t>(count)}, {"then", then}});
  };
  for (std::size_t a = 0; a < attributes().size(); ++a) {
    const AttributeRule rule = attributes()[a].rule;
    if (rule == AttributeRule::own || rule == AttributeRule::fixed || rule == AttributeRule::equal) continue;
    const bool parted = rule == AttributeRule::parted;
    // What parts a series is told here where it did not: slabs one after the other, or a value of each slice's own.
    if (parted && attributes()[a].tag != t_kernel && attributes()[a].tag != t_acquisition &&
        attributes()[a].tag != t_frame_uid)
      continue;
    changes(attributes()[a].keyword, distinct(s, [a](const FrameRef& r) { return r.header->said[a]; }).size(),
            rule == AttributeRule::applied       ? ": applied slice by slice"
            : attributes()[a].tag == t_frame_uid ? ": that all slices are of one frame is taken on trust"
                                                 : "");
  }
  changes("StudyInstanceUID", distinct(s, [](const FrameRef& r) { return r.header->study_uid; }).size());
  warn_of_identity(s, all);
  const auto any = [&](bool FileHeader::*member) {
    return std::any_of(s.slices.begin(), s.slices.end(), [&](const FrameRef& r) { return r.header->*member; });
  };
  if (any(&FileHeader::lossy))
    warn("lossy_once", "LossyImageCompression is 01: the pixels were compressed with loss once");
  if (any(&FileHeader::quality_control))
    warn("test_object", "QualityControlImage is YES: the scan may be of a test object");
  for (const FrameRef& r : s.slices)
    if (r.header->photometric == "MONOCHROME1") {
      warn("monochrome1",
           "PhotometricInterpretation is MONOCHROME1, which is shown inverted; HU are taken as they are stored");
      break;
    }
  const auto slopes = distinct(s, [](const FrameRef& r) { return frame_of(r).slope.value_or(1); });
  const auto intercepts = distinct(s, [](const FrameRef& r) { return frame_of(r).intercept.value_or(0); });
  if (slopes.size() > 1 && s.slices.front().header->frames.size() > 1)
    changes("RescaleSlope of the frames", slopes.size(), ": applied frame by frame");
  if (intercepts.size() > 1 && s.slices.front().header->frames.size() > 1)
    changes("RescaleIntercept of the frames", intercepts.size(), ": applied frame by frame");
  if (!s.is_ct) return all;
  if (*slopes.begin() < 0)
    warn("negative_slope", "RescaleSlope is {slope:.4g}: bright and dark are exchanged", {{"slope", *slopes.begin()}});
  constexpr double least = -10240, most = 100;
  for (const double i : {*intercepts.begin(), *intercepts.rbegin()})
    if (i < least || i > most) {
      warn("unusual_intercept", "RescaleIntercept is {intercept:.6g}, usual is -1024, at most {least} to {most}",
           {{"intercept", i}, {"least", least}, {"most", most}});
      break;
    }
  for (const std::string& type : distinct(s, [](const FrameRef& r) { return r.header->raw_image_type; }))
    if (type.find("MIP") != std::string::npos || type.find("MAX_IP") != std::string::npos ||
        type.find("MIN_IP") != std::string::npos) {
      warn("projections", "ImageType says that slices are projections (MIP), which show no surfaces where they are");
      break;
    }
  constexpr double metal_hu = 31000;
  if (counts.max > metal_hu)
    warn("beyond_metal", "values up to {max_hu:.0f} HU, metal has at most about {metal_hu:.0f}: are these HU?",
         {{"max_hu", counts.max}, {"metal_hu", metal_hu}});
  return all;
}

}  // namespace trephine::dicom
