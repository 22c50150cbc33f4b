// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <system_error>
#include <tuple>

#include "base/error.h"
#include "base/parallel.h"
#include "dicom/header_tags.h"
#include "dicom/input_files.h"
#include "dicom/mixtures.h"
#include "dicom/slabs.h"

namespace trephine::dicom {
namespace {

namespace fs = std::filesystem;

constexpr double orientation_tolerance = 1e-3;  // cosine units: 0.06 degrees

/// Everything except positions by which slices are ordered and series are told apart.
auto stack_key(const FrameRef& r) {
  const Frame& f = r.header->frames[static_cast<std::size_t>(r.frame)];
  const auto& o = *f.orientation;
  return std::make_tuple(r.header->columns, r.header->rows, (*f.spacing_mm)[0], (*f.spacing_mm)[1], o[0].x, o[0].y,
                         o[0].z, o[1].x, o[1].y, o[1].z);
}

bool same_stack(const FrameRef& a, const FrameRef& b) {
  const Frame &f = a.header->frames[static_cast<std::size_t>(a.frame)],
              &g = b.header->frames[static_cast<std::size_t>(b.frame)];
  if (a.header->columns != b.header->columns || a.header->rows != b.header->rows) return false;
  for (int i = 0; i < 2; ++i) {
    if (std::abs((*f.spacing_mm)[i] - (*g.spacing_mm)[i]) > 1e-4 * (*f.spacing_mm)[i]) return false;
    if (norm((*f.orientation)[i] - (*g.orientation)[i]) > orientation_tolerance) return false;
  }
  return true;
}

const Frame& frame_of(const FrameRef& r) { return r.header->frames[static_cast<std::size_t>(r.frame)]; }

struct Group {
  std::vector<FrameRef> slices;
  std::vector<const FileHeader*> faulty;
};

std::string modality_name(const FileHeader& h) {
  if (h.modality == "CT" && h.has_sop_class && !(h.sop_class && h.sop_class->is_ct))
    return std::string("CT as ") + (h.sop_class ? h.sop_class->name : "an unknown storage class");
  return h.modality.empty() ? "none given" : h.modality;
}

void fill_summary(const FileHeader& h, Series& s) {
  s.is_ct = h.is_ct();
  s.sort_uid = h.series_uid;
  s.summary.modality = modality_name(h);
  s.summary.kernel = h.kernel;
  s.summary.image_type = h.image_type;
  s.summary.contrast = h.contrast;
  s.summary.transfer_syntax = h.syntax->name;
  s.summary.size = {h.columns, h.rows, static_cast<int>(s.slices.size())};
}

void refuse(Series& s, const std::string& file, const std::string& field, const Message& what) {
  if (!s.refusal.empty()) return;
  s.refusal_file = file;
  s.refusal_field = field;
  s.refusal = what;
}

Series make_series(std::vector<FrameRef> slices, ModalityPolicy modality) {
  Series s;
  s.slices = std::move(slices);
  const FrameRef& middle = s.slices[s.slices.size() / 2];
  const FileHeader& h = *middle.header;
  fill_summary(h, s);
  const Frame& f = frame_of(middle);
  s.stack.columns = h.columns;
  s.stack.rows = h.rows;
  s.stack.dx_mm = (*f.spacing_mm)[0];
  s.stack.dy_mm = (*f.spacing_mm)[1];
  s.stack.u = (*f.orientation)[0];
  s.stack.v = (*f.orientation)[1];
  for (const FrameRef& r : s.slices) s.stack.positions_mm.push_back(*frame_of(r).position_mm);
  s.summary.spacing_mm = {s.stack.dx_mm, s.stack.dy_mm, median_step_mm(s.stack)};
  s.summary.slice_thickness_mm = f.thickness_mm.value_or(0);

  if (!s.is_ct && modality == ModalityPolicy::ct)
    refuse(s, h.name, "Modality (0008,0060)",
           s.summary.modality + ", only CT is read, unless " + Setting{"modality", "any"});
  for (const FrameRef& r : s.slices)
    if (r.header->syntax != h.syntax &&
        (r.header->syntax->encoding == Encoding::native) != (h.syntax->encoding == Encoding::native))
      s.summary.transfer_syntax = "mixed";
  // Pixels that are not compressed are there in full. Compressed ones may claim any size.
  constexpr std::uint64_t free_of_ratio = std::uint64_t{1} << 30, most = 2000;
  std::uint64_t claimed = 0, there = 0;
  for (const FrameRef& r : s.slices) {
    if (r.header->syntax->encoding == Encoding::native) continue;
    claimed += r.header->frame_bytes();
    const auto [from, to] = r.header->frame_fragments[static_cast<std::size_t>(r.frame)];
    for (std::size_t i = from; i < to; ++i) there += r.header->fragments[i].length;
  }
  if (claimed > free_of_ratio && claimed / most > there)
    refuse(s, h.name, tag_name(h.pixels.tag), fmt::format("{} compressed bytes claim to be {}", there, claimed));
  if (const int levels = count_levels(s.stack); levels < min_slices)
    refuse(s, h.name, "series",
           fmt::format("{} slice position{}, at least {} are needed", levels, levels == 1 ? "" : "s", min_slices));
  return s;
}

/// Splits a group into stacks and adds them.
void add_series(Group& group, ModalityPolicy modality, std::vector<Series>& out) {
  // Files are ordered by content. Their places in the sorted list decide only between files that agree in all of it, so
  // that messages do not vary.
  std::sort(group.slices.begin(), group.slices.end(), [](const FrameRef& a, const FrameRef& b) {
    const Vec3 p = *frame_of(a).position_mm, q = *frame_of(b).position_mm;
    return std::make_tuple(stack_key(a), p.x, p.y, p.z, a.header, a.frame) <
           std::make_tuple(stack_key(b), q.x, q.y, q.z, b.header, b.frame);
  });
  std::vector<std::vector<FrameRef>> stacks;
  for (const FrameRef& r : group.slices) {
    auto it = std::find_if(stacks.begin(), stacks.end(), [&](const auto& s) { return same_stack(s.front(), r); });
    if (it == stacks.end()) it = stacks.insert(stacks.end(), std::vector<FrameRef>());
    it->push_back(r);
  }
  std::vector<std::vector<FrameRef>> parts;
  for (auto& stack : stacks)
    for (auto& part : part_mixture(std::move(stack))) parts.push_back(std::move(part));
  stacks = std::move(parts);
  std::sort(group.faulty.begin(), group.faulty.end());
  if (stacks.empty() && !group.faulty.empty()) {
    Series s;
    fill_summary(*group.faulty.front(), s);
    s.summary.size[2] = static_cast<int>(group.faulty.size());
    out.push_back(std::move(s));
  }
  const std::size_t first = out.size() - (stacks.empty() && !group.faulty.empty() ? 1 : 0);
  for (auto& s : stacks) out.push_back(make_series(std::move(s), modality));
  if (!group.faulty.empty()) {
    const FileHeader& f = *group.faulty.front();
    for (std::size_t i = first; i < out.size(); ++i)
      refuse(out[i], f.name, tag_name(f.faults.front().tag), f.faults.front().what);
  }
}

// A DICOMDIR is DICOM, and names every UID, but no slice is lost with it.
bool is_index(const std::string& what) { return what.rfind("a DICOMDIR", 0) == 0; }

bool begins_as_dicom(const Origin& origin) {
  try {
    ByteSource source(origin);
    const std::uint8_t* p = source.get(128, 4);
    return p && std::memcmp(p, "DICM", 4) == 0;
  } catch (const std::system_error&) {
    return false;
  }
}

void read_headers(const std::vector<InputFile>& files, Catalogue& c, const Progress& progress) {
  std::vector<FileHeader> headers(files.size());
  std::vector<WalkFault> faults(files.size());
  std::vector<char> good(files.size(), 0);
  std::vector<std::string> names(files.size());
  parallel_for(0, static_cast<std::int64_t>(files.size()), 16, [&](std::int64_t from, std::int64_t to) {
    progress.report(static_cast<double>(from) / static_cast<double>(files.size()));
    for (auto i = static_cast<std::size_t>(from); i < static_cast<std::size_t>(to); ++i) {
      names[i] = name_of_input(files, i);
      try {
        headers[i] = read_header(files[i].origin);
        good[i] = 1;
      } catch (const WalkFault& f) {
        faults[i] = f;
      } catch (const std::system_error&) {
        faults[i] = {"", "cannot be read"};
      }
    }
  });
  std::set<std::string> alike;  // names without their digits: those of slices
  const auto letters = [&](std::size_t i) {
    std::string name = files[i].path;
    name.erase(std::remove_if(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; }), name.end());
    return name;
  };
  for (std::size_t i = 0; i < files.size(); ++i)
    if (good[i]) alike.insert(letters(i));
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (good[i]) {
      headers[i].name = names[i];
      c.headers.push_back(std::move(headers[i]));
      continue;
    }
    WalkFault& f = faults[i];
    const bool is_dicom = !f.field.empty() || (!is_index(f.what) && begins_as_dicom(files[i].origin));
    const bool is_called_so = !is_dicom && !f.is_empty && !is_index(f.what) && alike.count(letters(i)) > 0;
    if (is_called_so) f.what = "nothing but its name says what it was: a slice may be lost";
    c.broken.push_back({names[i], f.field, f.what, is_dicom || is_called_so, static_cast<int>(i) + 1, f.is_empty});
  }
}

/// What has lost its beginning, but holds the UID of a series of the folder, is a lost slice of that series.
void know_by_uid(const std::vector<InputFile>& files, Catalogue& c) {
  std::set<std::string> uids;
  for (const FileHeader& h : c.headers)
    if (h.series_uid.size() >= 6) uids.insert(h.series_uid);
  constexpr std::size_t max_looked_into = 2000, max_series = 200;
  if (uids.size() > max_series) return;
  std::size_t looked_into = 0;
  for (Catalogue::Broken& b : c.broken) {
    if (b.is_dicom || is_index(b.what) || ++looked_into > max_looked_into) continue;
    try {
      ByteSource source(files[static_cast<std::size_t>(b.number - 1)].origin);
      const std::size_t size = static_cast<std::size_t>(std::min<std::uint64_t>(source.size(), ByteSource::max_value));
      const std::uint8_t* p = source.get(0, size);
      const std::string_view bytes(reinterpret_cast<const char*>(p), p ? size : 0);
      b.is_dicom = std::any_of(uids.begin(), uids.end(),
                               [&](const std::string& uid) { return bytes.find(uid) != std::string_view::npos; });
    } catch (const std::system_error&) {
    }
  }
}

void sort_series(std::vector<Series>& series) {
  std::stable_sort(series.begin(), series.end(), [](const Series& a, const Series& b) {
    const auto key = [](const Series& s) {
      const auto& m = s.summary;
      return std::make_tuple(!s.refusal.empty(), !s.is_ct, -m.size[2], -m.size[0], -m.size[1], m.spacing_mm.x,
                             m.spacing_mm.z, m.slice_thickness_mm, m.kernel, m.image_type, m.contrast, m.modality,
                             s.sort_uid);
    };
    return key(a) < key(b);
  });
  int ordinal = 0;
  for (Series& s : series) {
    const auto& n = s.summary.size;
    s.summary.token = fmt::format("s{}-{}x{}x{}", ++ordinal, n[0], n[1], n[2]);
    s.summary.usable = s.refusal.empty();
    s.summary.verdict = s.summary.usable ? "usable" : s.refusal_field + ": " + s.refusal.text();
  }
}

}  // namespace

Catalogue scan(const fs::path& folder_or_file, ModalityPolicy modality, const Progress& progress) {
  Catalogue c;
  std::error_code ec;
  const fs::file_status status = fs::status(folder_or_file, ec);
  if (!fs::exists(status)) throw Error(ExitCode::no_input, "", "", "no such file or folder");
  c.is_single_file = fs::is_regular_file(status) && !is_zip(folder_or_file);
  InputList list = list_inputs(folder_or_file, progress.part(0, 0.8));
  const Progress rest = list.archive.members.empty() ? progress : progress.part(0.8, 1);
  c.archive = std::move(list.archive);
  c.hidden = list.hidden;
  c.links = list.links;
  for (int n = 0; n < list.unreadable_folders; ++n)
    c.broken.push_back({"", "", "a folder that cannot be read", false, 0});
  const std::vector<InputFile>& files = list.files;
  c.files = static_cast<int>(files.size());
  read_headers(files, c, rest);
  know_by_uid(files, c);

  std::map<std::tuple<std::string, std::string, bool>, Group> groups;
  for (const FileHeader& h : c.headers) {
    if (h.is_localizer()) {
      ++c.localizers;
      c.left_out.push_back({&h, t_image_type, "is that of a localizer"});
      continue;
    }
    Group& g = groups[{h.series_uid, h.modality, h.is_ct()}];
    const bool secondary = h.raw_image_type.find("DERIVED") != std::string::npos ||
                           h.raw_image_type.find("SECONDARY") != std::string::npos;
    if (h.faults.empty())
      for (int f = 0; f < static_cast<int>(h.frames.size()); ++f) g.slices.push_back({&h, f});
    else if (h.has_geometry() || !secondary || !h.is_ct())
      g.faulty.push_back(&h);
    else {
      ++c.without_geometry;  // a screen capture among the slices
      c.left_out.push_back({&h, h.faults.front().tag, h.faults.front().what});
    }
  }
  for (auto& [key, group] : groups) {
    if (!std::get<2>(key) && modality == ModalityPolicy::ct && group.slices.empty() && !group.faulty.empty()) {
      // Its tags are not to blame: this modality is not read at all.
      Series s;
      const FileHeader& h = **std::min_element(group.faulty.begin(), group.faulty.end());
      fill_summary(h, s);
      s.summary.size[2] = static_cast<int>(group.faulty.size());
      refuse(s, h.name, "Modality (0008,0060)",
             s.summary.modality + ", only CT is read, unless " + Setting{"modality", "any"});
      c.series.push_back(std::move(s));
      continue;
    }
    if (!std::get<2>(key) && modality == ModalityPolicy::ct) {
      for (const FileHeader* h : group.faulty) c.left_out.push_back({h, t_sop_class, "is none of CT"});
      group.faulty.clear();
    }
    add_series(group, modality, c.series);
  }
  sort_series(c.series);
  find_rescans(c.series);
  find_odd_slices(c.series, c.left_out);
  return c;
}

}  // namespace trephine::dicom
