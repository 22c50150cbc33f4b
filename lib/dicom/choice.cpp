// SPDX-License-Identifier: GPL-3.0-or-later
// Which series of a folder can be read, and which of them is meant. List and import ask the same questions.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/error.h"
#include "base/parallel.h"
#include "dicom/catalogue.h"
#include "dicom/hu.h"
#include "dicom/mixtures.h"
#include "dicom/values.h"

namespace trephine::dicom {
namespace {

bool is_native(const FrameRef& r) { return r.header->syntax->encoding == Encoding::native; }

/// Throws the error that import would throw for slices at one position whose pixels differ.
void check_duplicates(const Series& series, const StackGeometry& geometry, const ImportParams& params) {
  const std::size_t pixels = std::size_t(series.stack.columns) * std::size_t(series.stack.rows);
  HuMapper<float> mapper;
  HuCounts ignored;
  for (const auto& level : geometry.levels) {
    if (level.size() < 2) continue;
    std::vector<FrameRef> frames;
    for (const int i : level) frames.push_back(series.slices[static_cast<std::size_t>(i)]);
    if (!std::all_of(frames.begin(), frames.end(), is_native)) continue;
    std::vector<float> first(pixels), other(pixels);
    read_frames(frames, [&](std::size_t i, const std::uint8_t* stored) {
      const FileHeader& h = *frames[i].header;
      mapper.apply(
          hu_rule(h, h.frames[static_cast<std::size_t>(frames[i].frame)], params.clamp_low_hu, params.clamp_high_hu),
          stored, pixels, i == 0 ? first.data() : other.data(), ignored);
      if (i > 0 && first != other) different_duplicates(h);
    });
  }
}

void check_streams(const Series& series, const Progress& progress) {
  const auto count = static_cast<std::int64_t>(series.slices.size());
  std::vector<std::exception_ptr> errors(series.slices.size());
  parallel_for(0, count, 8, [&](std::int64_t from, std::int64_t to) {
    progress.report(static_cast<double>(from) / static_cast<double>(count));
    for (auto i = static_cast<std::size_t>(from); i < static_cast<std::size_t>(to); ++i) try {
        if (!is_native(series.slices[i])) check_frame_stream(series.slices[i]);
      } catch (...) {
        errors[i] = std::current_exception();
      }
  });
  for (const auto& e : errors)  // the first in the stack's order, as import tells it
    if (e) std::rethrow_exception(e);
}

double length_mm(const Series& s) {
  const Vec3 n = s.stack.normal();
  double low = 0, high = 0;
  for (const Vec3& p : s.stack.positions_mm) {
    const double at = dot(p - s.stack.positions_mm.front(), n);
    low = std::min(low, at);
    high = std::max(high, at);
  }
  return high - low;
}

/// By bands, because a thin slice of a medium kernel shows more than a thick one of a very soft kernel.
int hardness(const std::string& kernel) {
  constexpr int softest_medium = 46, softest_hard = 56;
  const int sharpness = kernel_sharpness(kernel);
  return sharpness >= softest_hard ? 2 : sharpness >= softest_medium ? 1 : 0;
}

std::string listing(const Catalogue& c) {
  constexpr int max_listed = 4;  // more are a table's business
  int usable = 0;
  std::string out;
  for (const Series& s : c.series)
    if (s.summary.usable && s.part_of.empty() && ++usable <= max_listed)
      out += (out.empty() ? "" : "; ") + s.summary.line();
  return usable > max_listed ? fmt::format("{}, which `trephine import --list FOLDER` shows as a table", usable) : out;
}

Setting taking(const Series& s) { return {"series", s.summary.token.substr(0, s.summary.token.find('-'))}; }

[[noreturn]] void refuse(const Series& s) {
  if (s.refused) std::rethrow_exception(s.refused);
  throw Error(ExitCode::bad_input, s.refusal_file, s.refusal_field, s.refusal);
}

const Series* named(const Catalogue& c, const std::string& token) {
  for (const Series& s : c.series) {
    if (s.summary.token != token && taking(s).value != token) continue;
    if (!s.refusal.empty()) refuse(s);
    return &s;
  }
  return nullptr;
}

}  // namespace

std::string plane_of(const SliceStack& stack) {
  const Vec3 n = stack.normal();
  const double aligned = std::cos(30 * M_PI / 180);
  if (std::abs(n.z) > aligned) return "axial";
  if (std::abs(n.y) > aligned) return "coronal";
  if (std::abs(n.x) > aligned) return "sagittal";
  return "oblique";
}

std::string origin_of(const SeriesSummary& summary) {
  const std::string first = summary.image_type.substr(0, summary.image_type.find('/'));
  return first == "ORIGINAL" ? "original" : first == "DERIVED" ? "derived" : "";
}

void judge(Series& s, const ImportParams& params, const Progress& progress) {
  if (!s.refusal.empty()) return;
  try {
    const StackGeometry g = analyse_series(s, params);
    check_streams(s, progress);
    check_duplicates(s, g, params);
    s.rectified_for = g.reason;
  } catch (const Error& e) {
    s.refused = std::current_exception();
    s.refusal_file = e.file();
    s.refusal_field = e.field();
    s.refusal = e.message();
    s.summary.usable = false;
    s.summary.verdict = s.refusal_field + ": " + s.refusal.text();
  }
}

const Series* proposed(const Catalogue& c) {
  const auto is_axial = [](const Series& s) { return plane_of(s.stack) == "axial"; };
  double longest_mm = 0;  // of the axial ones: what a reformat counts as its length is another direction
  for (const Series& s : c.series)
    if (s.refusal.empty() && is_axial(s)) longest_mm = std::max(longest_mm, length_mm(s));
  const auto key = [&](const Series& s) {
    const double thickness_mm = std::max(s.summary.slice_thickness_mm, s.summary.spacing_mm.z);
    return std::make_tuple(!s.is_ct, !is_axial(s), length_mm(s) < longest_mm * 2 / 3,
                           origin_of(s.summary) != "original", hardness(s.summary.kernel), thickness_mm);
  };
  const Series* best = nullptr;
  for (const Series& s : c.series)
    if (s.refusal.empty() && s.part_of.empty() && (!best || key(s) < key(*best))) best = &s;
  return best;
}

const Series& choose(Catalogue& c, const ImportParams& params, const Progress& progress) {
  if (const Series* asked = params.series.empty() ? nullptr : named(c, params.series)) return *asked;
  const auto usable = [&] {
    return std::count_if(c.series.begin(), c.series.end(),
                         [](const Series& s) { return s.refusal.empty() && s.part_of.empty(); });
  };
  if (usable() > 1 || !params.series.empty())
    for (Series& s : c.series) judge(s, params, progress);
  const auto left = usable();
  const Series* best = proposed(c);
  const std::string known = best ? listing(c) + "; proposed is " + best->summary.token + ", " : "";
  if (!params.series.empty())
    throw Error(ExitCode::usage, "", "series",
                best ? "no such series; there are: " + known + taking(*best) + " takes it"
                     : Message("no such series; none is usable"));
  if (best) {
    if (left == 1 || params.series_rule == SeriesRule::best) return *best;
    const int others = of_other_patients(c, *best);
    throw Error(ExitCode::usage, "", "series",
                fmt::format("{} usable series, choose one by its token: {}", left, known) + taking(*best) + " or " +
                    Setting{"series_rule", "best"} + " takes it" +
                    (others > 0 ? fmt::format("; of another patient: {} of the others", others) : ""));
  }
  // Nothing is usable. The reason given is that of the largest CT series, or else of whatever was nearest to being one.
  if (!c.series.empty()) refuse(c.series.front());
  for (const auto& b : c.broken)
    if (b.is_dicom) throw Error(ExitCode::bad_input, b.name, b.field, b.what);
  if (c.localizers > 0)
    throw Error(ExitCode::bad_input, "", "ImageType (0008,0008)",
                fmt::format("only localizers ({}), no slices", c.localizers));
  if (!c.broken.empty() && (c.is_single_file || c.broken.size() == 1))
    throw Error(ExitCode::bad_input, c.broken.front().name, c.broken.front().field, c.broken.front().what);
  throw Error(ExitCode::bad_input, "", "series",
              fmt::format("no DICOM image among {} files; `trephine import --list FOLDER` says what each is", c.files));
}

}  // namespace trephine::dicom
