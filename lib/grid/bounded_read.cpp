// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/bounded_read.h"

#include <algorithm>
#include <cstring>

#include "base/child.h"
#include "base/child_message.h"
#include "base/error.h"
#include "base/memory_budget.h"
#include "base/write_file.h"
#include "grid/image_pair.h"
#include "grid/nifti.h"

namespace trephine::grid {
namespace fs = std::filesystem;
namespace {

constexpr const char* worker_name = "volume-read";

enum class Task : std::int32_t { nrrd, nifti, pair, labels, label_bytes };

void write_texts(MessageWriter& to, const std::vector<std::string>& texts) {
  to.number(texts.size());
  for (const std::string& t : texts) to.text(t);
}
std::vector<std::string> read_texts(MessageReader& from) {
  std::vector<std::string> texts;
  for (std::uint64_t n = from.number(); n > 0; --n) texts.emplace_back(from.text());
  return texts;
}

// The voxels come last, straight from where they lie.
void write_grid(ChildRequest& to, MessageWriter& head, const AnyGrid& grid) {
  head.value(static_cast<std::int32_t>(grid.index()));
  std::visit(
      [&](const auto& g) {
        head.value(static_cast<const Lattice&>(g));
        to.write(head.bytes());
        to.write(g.voxels.data(), g.voxels.size() * sizeof g.voxels[0]);
      },
      grid);
}

template <class T>
Grid<T> take_voxels(MessageReader& from, const Lattice& lattice) {
  double count = 1;
  for (const int n : lattice.size) count *= n > 0 ? n : 1e18;
  if (!(count <= 1e13)) throw Error(ExitCode::internal, "", worker_name, "a message of the child is damaged");
  const std::string_view bytes = from.take(lattice.count() * sizeof(T));  // which are there
  Grid<T> grid(lattice);
  if (!bytes.empty()) std::memcpy(grid.voxels.data(), bytes.data(), bytes.size());
  return grid;
}

AnyGrid take_grid(MessageReader& from) {
  const auto kind = from.value<std::int32_t>();
  const auto lattice = from.value<Lattice>();
  if (kind == 0) return take_voxels<std::int16_t>(from, lattice);
  if (kind == 1) return take_voxels<float>(from, lattice);
  if (kind == 2) return take_voxels<std::uint8_t>(from, lattice);
  throw Error(ExitCode::internal, "", worker_name, "a message of the child is damaged");
}

void answer_grid(ChildRequest& to, const BoundedGrid& read) {
  MessageWriter head;
  write_texts(head, read.warnings);
  head.number(read.keys.size());
  for (const auto& [key, value] : read.keys) head.text(key), head.text(value);
  head.value(read.is_analyze);
  write_grid(to, head, read.grid);
}

void answer_labels(ChildRequest& to, const LabelFile& labels) {
  MessageWriter head;
  head.value(labels.lattice);
  head.value(labels.layers);
  head.text(labels.format);
  write_texts(head, labels.warnings);
  head.number(labels.segments.size());
  for (const LabelSegment& s : labels.segments) {
    head.text(s.id);
    head.text(s.name);
    head.value(s.value);
    head.value(s.layer);
    head.value(s.cropped);
  }
  write_grid(to, head, labels.samples);
}

LabelFile take_labels(MessageReader& from) {
  LabelFile labels;
  labels.lattice = from.value<Lattice>();
  labels.layers = from.value<int>();
  labels.format = from.text();
  labels.warnings = read_texts(from);
  for (std::uint64_t n = from.number(); n > 0; --n) {
    LabelSegment s;
    s.id = from.text();
    s.name = from.text();
    s.value = from.value<int>();
    s.layer = from.value<int>();
    s.cropped = from.value<bool>();
    labels.segments.push_back(std::move(s));
  }
  labels.samples = take_grid(from);
  return labels;
}

std::string_view view(const std::vector<char>& bytes) { return {bytes.data(), bytes.size()}; }

BoundedGrid of_nifti(Nifti nifti) {
  BoundedGrid out;
  out.grid = std::move(nifti.grid);
  out.warnings = std::move(nifti.warnings);
  return out;
}

BoundedGrid of_pair(const fs::path& header, const fs::path& image, const std::string& axes) {
  const std::vector<char> head = read_file(header), data = read_file(image);
  ImagePair pair = join_image_pair(view(head), view(data), image.extension() == ".gz", axes);
  BoundedGrid out = of_nifti(decode_nifti(pair.nifti, scan_limit));
  out.is_analyze = pair.is_analyze;
  out.warnings.insert(out.warnings.begin(), pair.warnings.begin(), pair.warnings.end());
  return out;
}

const ChildWorker worker(worker_name, [](ChildRequest& request) {
  MessageReader in(worker_name, request.request());
  const auto task = in.value<Task>();
  const auto limit = in.value<GzipLimit>();
  const fs::path first(in.text()), second(in.text());
  const std::string axes(in.text());
  const std::string_view bytes = in.text();
  switch (task) {
    case Task::nrrd: {
      Nrrd nrrd = read_nrrd(first, limit);
      return answer_grid(request, {std::move(nrrd.grid), std::move(nrrd.keys), false, std::move(nrrd.warnings)});
    }
    case Task::nifti: {
      const std::vector<char> file = read_file(first);
      return answer_grid(request, of_nifti(decode_nifti(view(file), limit)));
    }
    case Task::pair:
      return answer_grid(request, of_pair(first, second, axes));
    case Task::labels: {
      const std::vector<char> file = read_file(first);
      return answer_labels(request, decode_labels(view(file)));
    }
    case Task::label_bytes:
      return answer_labels(request, decode_labels(bytes));
  }
});

ChildResult run(Task task, GzipLimit limit, const fs::path& first, const fs::path& second, const std::string& axes,
                std::string_view label_bytes, const Progress& progress) {
  std::uint64_t bytes = label_bytes.size();
  for (const fs::path& file : {first, second}) {
    std::error_code none;
    if (const auto size = fs::file_size(file, none); !none) bytes += size;
  }
  MessageWriter request;
  request.value(task);
  request.value(limit);
  request.text(first.string());  // the child works in the same folder
  request.text(second.string());
  request.text(axes);
  request.text(label_bytes);
  // Bytes that are not compressed do not grow, and this does not ask whether they are. Samples of a byte may become
  // floats, which are then handed over; what a program maps before it begins is counted as memory too.
  const std::uint64_t grown = limit.bytes(bytes);
  ChildLimits limits;
  limits.memory_bytes = std::min((std::uint64_t{3} << 30) + bytes + 9 * grown, available_memory_bytes());
  limits.cpu_s = 60 + static_cast<double>(grown) / 5e6;
  limits.wall_s = 4 * limits.cpu_s;
  return run_child(worker_name, request.bytes(), limits, progress);
}

BoundedGrid taken(const ChildResult& result) {
  MessageReader in(worker_name, result.bytes());
  BoundedGrid out;
  out.warnings = read_texts(in);
  for (std::uint64_t n = in.number(); n > 0; --n) {
    const std::string key(in.text());
    out.keys[key] = in.text();
  }
  out.is_analyze = in.value<bool>();
  out.grid = take_grid(in);
  return out;
}

}  // namespace

BoundedGrid read_nrrd_bounded(const fs::path& file, GzipLimit limit, const Progress& progress) {
  return taken(run(Task::nrrd, limit, file, {}, {}, {}, progress));
}

BoundedGrid read_nifti_bounded(const fs::path& file, GzipLimit limit, const Progress& progress) {
  return taken(run(Task::nifti, limit, file, {}, {}, {}, progress));
}

BoundedGrid read_pair_bounded(const fs::path& header, const fs::path& image, const std::string& analyze_axes,
                              const Progress& progress) {
  return taken(run(Task::pair, scan_limit, header, image, analyze_axes, {}, progress));
}

LabelFile read_labels_bounded(const fs::path& file, const Progress& progress) {
  const ChildResult result = run(Task::labels, labels_limit, file, {}, {}, {}, progress);
  MessageReader in(worker_name, result.bytes());
  return take_labels(in);
}

LabelFile decode_labels_bounded(std::string_view bytes, const Progress& progress) {
  const ChildResult result = run(Task::label_bytes, labels_limit, {}, {}, {}, bytes, progress);
  MessageReader in(worker_name, result.bytes());
  return take_labels(in);
}

HuVolume read_foreign_hu(const fs::path& file) {
  return with_file(file.string(), [&] { return to_hu(read_nrrd_bounded(file, labels_limit).grid); });
}

Field read_foreign_field(const fs::path& file) {
  return with_file(file.string(), [&] { return to_field(read_nrrd_bounded(file, labels_limit).grid); });
}

Mask read_foreign_mask(const fs::path& file) {
  return with_file(file.string(), [&] { return to_mask(read_nrrd_bounded(file, labels_limit).grid); });
}

}  // namespace trephine::grid
