// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/import.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <exception>
#include <new>
#include <optional>

#include "base/error.h"
#include "base/hash.h"
#include "base/memory_budget.h"
#include "base/parallel.h"
#include "dicom/catalogue.h"
#include "dicom/header_tags.h"
#include "dicom/hu.h"
#include "dicom/input_files.h"
#include "dicom/mixtures.h"
#include "dicom/offset.h"
#include "dicom/resample.h"
#include "dicom/values.h"
#include "dicom/volume_import.h"
#include "dicom/volume_source.h"

namespace trephine::dicom {
namespace {

/// A series ready to be read: its rules, and which slabs of target slices need which levels.
struct Plan {
  const Series* series = nullptr;
  StackGeometry geometry;
  std::vector<HuRule> rules;  ///< per slice of the series
  bool integral = true;
  double air = air_hu;
  struct Slab {
    int begin = 0, end = 0;              ///< target slices
    int first_level = 0, end_level = 0;  ///< levels that they need
    int own_from = 0;                    ///< levels below it are an earlier slab's to count
  };
  std::vector<Slab> slabs;
};

/// How many target slices a worker reads at once. Starting a child process pays only for some megabytes, and the slices
/// that are being read must stay small beside the volume.
int slab_size(const Series& series, const StackGeometry& g) {
  constexpr std::int64_t min_bytes = 8 << 20, max_bytes = 128 << 20;
  const FileHeader& h = *series.slices.front().header;
  const bool child = std::any_of(series.slices.begin(), series.slices.end(),
                                 [](const FrameRef& r) { return r.header->syntax->encoding != Encoding::native; });
  const int count = g.target.size[2];
  if (!child) return std::clamp(count / (4 * thread_count()), 4, 32);
  const auto slice_bytes = static_cast<std::int64_t>(std::max<std::uint64_t>(1, h.frame_bytes()));
  const std::int64_t bytes = std::clamp(slice_bytes * count / (4 * thread_count()), min_bytes, max_bytes);
  const int share = (count + thread_count() - 1) / thread_count();
  return std::clamp(static_cast<int>(bytes / slice_bytes), 1, std::max(1, share));
}

Plan make_plan(const Series& series, const ImportParams& params) {
  Plan plan;
  plan.series = &series;
  plan.geometry = analyse_series(series, params);
  for (const FrameRef& r : series.slices) {
    plan.rules.push_back(hu_rule(*r.header, r.header->frames[static_cast<std::size_t>(r.frame)], params.clamp_low_hu,
                                 params.clamp_high_hu));
    plan.rules.back().intercept += params.offset_hu;
    plan.integral = plan.integral && plan.rules.back().is_integral();
    plan.air = plan.rules.back().air;
  }
  const int stored = plan.rules.front().bits_stored;
  if (std::any_of(plan.rules.begin(), plan.rules.end(), [&](const HuRule& r) { return r.bits_stored != stored; }))
    for (HuRule& r : plan.rules) r.counts_more_bits = true;
  const int count = plan.geometry.target.size[2], size = slab_size(series, plan.geometry);
  int counted = 0;
  for (int k = 0; k < count; k += size) {
    Plan::Slab s;
    s.begin = k;
    s.end = std::min(count, k + size);
    s.first_level = s.begin;
    s.end_level = s.end;
    if (plan.geometry.resampled) {
      s.first_level = static_cast<int>(plan.geometry.levels.size());
      s.end_level = 0;
      for (int t = s.begin; t < s.end; ++t) {  // not monotonic: one that is a level as it is needs no neighbours
        const Taps taps = taps_of(plan.geometry, t);
        s.first_level = std::min(s.first_level, taps.first());
        s.end_level = std::max(s.end_level, taps.last() + 1);
      }
    }
    s.own_from = std::max(counted, s.first_level);
    counted = std::max(counted, s.end_level);
    plan.slabs.push_back(s);
  }
  return plan;
}

// Some programs store as many bits as a slice's largest value needs.
void require_stored_bits(const FileHeader& h, const HuCounts& counts) {
  if (counts.more_bits > 0)
    throw Error(
        ExitCode::bad_input, h.name, tag_name(t_stored),
        fmt::format("{} here and another number in other slices of the series, and {} pixels have more bits: they "
                    "cannot be read alike; take the file out, and where that leaves a gap, read it with ",
                    h.bits_stored, counts.more_bits) +
            Setting{"gaps", "interpolate"});
}

/// Reads the levels of a slab in ascending order and hands them over as HU; duplicates are compared and dropped.
template <class T, class Take>
void read_levels(const Plan& plan, const Plan::Slab& slab, std::vector<HuCounts>& level_counts,
                 const Progress& progress, Take&& take) {
  const auto& levels = plan.geometry.levels;
  std::vector<FrameRef> frames;
  struct Place {
    int level, member;
  };
  std::vector<Place> places;
  for (int k = slab.first_level; k < slab.end_level; ++k)
    for (std::size_t m = 0; m < levels[static_cast<std::size_t>(k)].size(); ++m) {
      places.push_back({k, static_cast<int>(m)});
      frames.push_back(plan.series->slices[static_cast<std::size_t>(levels[static_cast<std::size_t>(k)][m])]);
    }
  const std::size_t pixels = std::size_t(plan.series->stack.columns) * std::size_t(plan.series->stack.rows);
  HuMapper<T> mapper;
  std::vector<T> own, other;
  const T* last = nullptr;
  const FrameSink sink = [&](std::size_t i, const std::uint8_t* stored) {
    const Place p = places[i];
    const auto& members = levels[static_cast<std::size_t>(p.level)];
    const HuRule& rule = plan.rules[static_cast<std::size_t>(members[static_cast<std::size_t>(p.member)])];
    HuCounts counts;
    if (p.member == 0) {
      T* target = take.place(p.level, own);
      mapper.apply(rule, stored, pixels, target, counts);
      require_stored_bits(*frames[i].header, counts);
      if (p.level >= slab.own_from) level_counts[static_cast<std::size_t>(p.level)] = counts;
      last = target;
      if (members.size() == 1) take.done(p.level, target);
      return;
    }
    other.resize(pixels);
    mapper.apply(rule, stored, pixels, other.data(), counts);
    require_stored_bits(*frames[i].header, counts);
    if (std::memcmp(other.data(), last, pixels * sizeof(T)) != 0) different_duplicates(*frames[i].header);
    if (p.member + 1 == static_cast<int>(members.size())) take.done(p.level, last);
  };
  // Compressed and uncompressed files may be mixed, so they are read in runs of one kind.
  for (std::size_t from = 0; from < frames.size();) {
    const auto native = [&](std::size_t i) { return frames[i].header->syntax->encoding == Encoding::native; };
    std::size_t to = from + 1;
    while (to < frames.size() && native(to) == native(from)) ++to;
    read_frames(
        {frames.begin() + static_cast<std::ptrdiff_t>(from), frames.begin() + static_cast<std::ptrdiff_t>(to)},
        [&](std::size_t i, const std::uint8_t* stored) { sink(from + i, stored); }, progress);
    from = to;
  }
}

/// Reads the slices straight into the volume.
template <class T>
struct Direct {
  grid::Grid<T>& volume;
  T* place(int level, std::vector<T>&) { return volume.voxels.data() + volume.index(0, 0, level); }
  void done(int, const T*) {}
};

/// Reads through a window of four slices in the target's plane. A target slice is made as soon as its last level is
/// there.
template <class T>
struct Windowed {
  const Plan& plan;
  const Plan::Slab& slab;
  grid::Grid<T>& volume;
  int next = slab.begin;
  std::array<std::vector<float>, 4> window{};

  float* place(int, std::vector<float>& own) {
    own.resize(std::size_t(plan.series->stack.columns) * std::size_t(plan.series->stack.rows));
    buffer = &own;
    return own.data();
  }
  void done(int level, const float*) {
    const StackGeometry& g = plan.geometry;
    auto& slot = window[static_cast<std::size_t>(level) % 4];
    if (g.sheared)
      shift_slice(*buffer, plan.series->stack.columns, plan.series->stack.rows,
                  g.shift[static_cast<std::size_t>(level)], g.target.size[0], g.target.size[1],
                  static_cast<float>(plan.air), slot);
    else
      slot = *buffer;
    for (; next < slab.end; ++next) {
      const Taps taps = taps_of(g, next);
      if (taps.last() > level) return;
      std::array<const float*, 4> s{};
      for (std::size_t k = 0; k < 4; ++k) s[k] = window[static_cast<std::size_t>(taps.level[k]) % 4].data();
      blend(taps, s, std::size_t(g.target.size[0]) * std::size_t(g.target.size[1]),
            volume.voxels.data() + volume.index(0, 0, next));
    }
  }
  std::vector<float>* buffer = nullptr;
};

/// Returns nothing where a value does not fit T = int16.
template <class T>
std::optional<grid::Grid<T>> read_volume(const Plan& plan, HuCounts& counts, const Progress& progress) {
  grid::Grid<T> volume(plan.geometry.target);
  std::vector<HuCounts> level_counts(plan.geometry.levels.size());
  const auto slabs = static_cast<std::int64_t>(plan.slabs.size());
  std::vector<std::exception_ptr> errors(plan.slabs.size());
  std::atomic<std::int64_t> first_bad{slabs}, done{0};
  parallel_for(0, slabs, 1, [&](std::int64_t i, std::int64_t) {
    if (i > first_bad.load()) return;  // the error told is the first in the stack's order, whatever the threads did
    const Plan::Slab& slab = plan.slabs[static_cast<std::size_t>(i)];
    const double share = 1.0 / static_cast<double>(slabs);
    try {
      const double at = static_cast<double>(done.load()) * share;
      progress.report(at);
      const Progress here = progress.part(at, at);  // what a child reports says that it is alive, and hears of Ctrl-C
      if (plan.geometry.resampled)
        read_levels<float>(plan, slab, level_counts, here, Windowed<T>{plan, slab, volume});
      else
        read_levels<T>(plan, slab, level_counts, here, Direct<T>{volume});
      ++done;
    } catch (...) {
      errors[static_cast<std::size_t>(i)] = std::current_exception();
      for (std::int64_t seen = first_bad.load(); i < seen && !first_bad.compare_exchange_weak(seen, i);) {
      }
    }
  });
  if (first_bad < slabs) std::rethrow_exception(errors[static_cast<std::size_t>(first_bad.load())]);
  counts = HuCounts();
  for (const HuCounts& c : level_counts) counts.add(c);
  if (std::is_same_v<T, std::int16_t> && !counts.fits_int16()) return std::nullopt;
  return volume;
}

grid::HuVolume read_volume(const Plan& plan, HuCounts& counts, const Progress& progress) {
  const auto& size = plan.geometry.target.size;
  require_memory(plan.geometry.target.count() * (plan.integral ? sizeof(std::int16_t) : sizeof(float)),
                 fmt::format("a volume of {} x {} x {} voxels", size[0], size[1], size[2]));
  try {
    if (plan.integral)
      if (auto v = read_volume<std::int16_t>(plan, counts, progress.part(0, 0.9))) return std::move(*v);
    return std::move(*read_volume<float>(plan, counts, progress));
  } catch (const std::bad_alloc&) {
    const auto& n = plan.geometry.target.size;
    throw Error(ExitCode::internal, "", "memory", fmt::format("not enough for {} x {} x {} voxels", n[0], n[1], n[2]));
  }
}

std::string hash_of_series(const Series& series, const Progress& progress) {
  std::vector<std::string> hashes(series.slices.size());
  parallel_for(0, static_cast<std::int64_t>(hashes.size()), 4, [&](std::int64_t from, std::int64_t to) {
    progress.report(static_cast<double>(from) / static_cast<double>(hashes.size()));
    for (auto i = static_cast<std::size_t>(from); i < static_cast<std::size_t>(to); ++i)
      hashes[i] = hash_of_frame(series.slices[i]);
  });
  std::sort(hashes.begin(), hashes.end());
  Sha256 sha;
  sha.text("trephine dicom series 1").integer(static_cast<std::int64_t>(hashes.size()));
  for (const std::string& h : hashes) sha.text(h);
  // A stored result must not keep quiet about what this series says otherwise.
  for (const Warning& w : warnings_of_changes(series, HuCounts())) sha.text(to_text(w));
  return sha.hex();
}

void describe(const Series& series, const Plan& plan, const HuCounts& counts, ImportResult& result) {
  const StackGeometry& g = plan.geometry;
  const FileHeader& h = *series.slices.front().header;
  ImportFigures& f = result.figures;
  f.modality = series.summary.modality;
  f.slices_count = g.levels.size();
  f.size = g.target.size;
  f.spacing_x_mm = g.target.spacing_mm.x;
  f.spacing_y_mm = g.target.spacing_mm.y;
  f.spacing_z_mm = g.target.spacing_mm.z;
  StackFigures& stack = f.stack.emplace();
  stack.slice_thickness_mm = series.summary.slice_thickness_mm;
  stack.smallest_step_mm = g.smallest_step_mm;
  stack.largest_gap_mm = g.largest_step_mm;
  stack.tilt_deg = g.tilt_deg;
  stack.resampled = g.resampled;
  if (g.resampled) stack.resampled_for = g.reason;
  stack.missing_slices_interpolated_count = g.missing_steps;
  stack.duplicates_dropped_count = series.slices.size() - g.levels.size();
  f.padding_voxels_count = counts.padding;
  f.clamped_voxels_count = counts.clamped;
  f.below_air_voxels_count = counts.below_air;
  f.hu_min = counts.min;
  f.hu_max = counts.max;
  f.sample_type = sample_type_of(result.volume);
  f.tags = TagFigures{series.summary.kernel,          series.summary.image_type,      h.patient_position,
                      series.summary.contrast_text(), series.summary.transfer_syntax, h.tilt_tag_deg};
  const auto warn = [&](const char* id, const char* form, Named<ParameterValue> values) {
    result.warnings.push_back({id, form, std::move(values)});
  };
  constexpr double same_tilt_deg = 1;  // the tag's sign is not reliable, and often it is rounded
  if (h.tilt_tag_deg && std::abs(std::abs(*h.tilt_tag_deg) - std::abs(g.tilt_deg)) > same_tilt_deg)
    warn("tilt_by_tag",
         "GantryDetectorTilt is {by_tag_deg:.4g} degrees, by the slices' positions it is {tilt_deg:.1f}: these count",
         {{"by_tag_deg", *h.tilt_tag_deg}, {"tilt_deg", g.tilt_deg}});
  for (Warning& w : warnings_of_changes(series, counts)) result.warnings.push_back(std::move(w));
  if (g.resampled) warn("resampled", "resampled from the true positions: {why}", {{"why", g.reason}});
  if (counts.below_air > 0)
    warn("below_air", "{count} voxels below -1024 HU that no padding tag declares", {{"count", counts.below_air}});
  if (h.syntax->lossy) warn("lossy", "compressed with loss: {syntax}", {{"syntax", std::string(h.syntax->name)}});
  if (plan.rules.front().padding && counts.padding > 0) {
    HuRule bare = plan.rules.front();
    bare.padding.reset();
    const std::uint8_t word[2] = {static_cast<std::uint8_t>(*h.padding & 0xff),
                                  static_cast<std::uint8_t>(*h.padding >> 8)};
    float hu = 0;
    HuCounts ignored;
    if (h.bits_allocated == 16) HuMapper<float>().apply(bare, word, 1, &hu, ignored);
    if (hu > -300)
      warn("padding_is_tissue", "the declared padding value means {hu} HU: {count} voxels of it became air",
           {{"hu", fmt::format("{}", hu)}, {"count", counts.padding}});
  }
}

}  // namespace

ImportResult import_series(const std::filesystem::path& folder_or_file, const ImportParams& params,
                           const Progress& progress) {
  const VolumeSource volume =
      with_scan(folder_or_file, [&] { return chosen_volume(folder_or_file, params.series, progress.part(0, 0.1)); });
  if (!volume.file.empty())
    return with_scan(folder_or_file, [&] { return import_volume(folder_or_file, volume, params, progress); });
  return with_scan(folder_or_file, [&] {
    Catalogue catalogue = scan(folder_or_file, params.modality, progress.part(0, 0.2));
    const Series& series = choose(catalogue, params);
    const Plan plan = make_plan(series, params);
    ImportResult result;
    HuCounts counts;
    result.volume = read_volume(plan, counts, progress.part(0.2, 0.95));
    if (series.is_ct) require_offset(result.volume, tag_name(t_intercept));
    describe(series, plan, counts, result);
    say_otherwise(result, params);
    result.folder = describe_rest(catalogue, &series);
    result.input_sha256 = hash_of_series(series, progress.part(0.95, 1));
    return result;
  });
}

std::string hash_of_series_input(const std::filesystem::path& folder_or_file, const ImportParams& params,
                                 const Progress& progress, FolderRest* folder) {
  const VolumeSource volume =
      with_scan(folder_or_file, [&] { return chosen_volume(folder_or_file, params.series, progress); });
  if (!volume.file.empty()) return with_scan(folder_or_file, [&] { return hash_of_volume(folder_or_file, volume); });
  return with_scan(folder_or_file, [&] {
    Catalogue catalogue = scan(folder_or_file, params.modality, progress.part(0, 0.5));
    const Series& series = choose(catalogue, params);
    analyse_series(series, params);  // what import would refuse is refused also where its result is stored
    if (folder) *folder = describe_rest(catalogue, &series);
    return hash_of_series(series, progress.part(0.5, 1));
  });
}

namespace {

/// What the two series' headers say, by `of`; nothing where one of them is a volume file.
template <class Of>
std::optional<std::array<std::string, 2>> said_by(const SeriesChoice& a, const SeriesChoice& b,
                                                  const Progress& progress, Of&& of) {
  std::array<std::string, 2> said;
  for (const SeriesChoice* c : {&a, &b}) {
    if (!volume_sources(c->folder_or_file, progress).empty()) return std::nullopt;
    Catalogue catalogue = scan(c->folder_or_file, c->params.modality, progress);
    said[c == &b] = of(*choose(catalogue, c->params).slices.front().header);
  }
  return said;
}

}  // namespace

std::optional<bool> of_one_frame(const SeriesChoice& a, const SeriesChoice& b, const Progress& progress) {
  const auto uids = said_by(a, b, progress, [](const FileHeader& h) { return h.frame_uid; });
  if (!uids || (*uids)[0].empty() || (*uids)[1].empty()) return std::nullopt;
  return (*uids)[0] == (*uids)[1];
}

}  // namespace trephine::dicom
