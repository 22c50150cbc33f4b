// SPDX-License-Identifier: GPL-3.0-or-later
#include "itk/transform_file.h"

#include <string>
#include <vector>

#include "base/error.h"
#include "base/temporary_folder.h"
#include "base/write_file.h"
#include "itk/itk_child.h"
#include "itk/transform_message.h"

namespace trephine::itk {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t max_bytes = 1 << 24;

bool is_hdf5(const fs::path& file) {
  const std::string end = file.extension().string();
  return end == ".h5" || end == ".hdf5";
}

ChildResult run_worker(const MessageWriter& request) {
  ChildLimits limits;
  limits.memory_bytes = std::uint64_t{3} << 30;
  limits.cpu_s = 30;
  limits.wall_s = 120;
  return itk_child::run(transform_worker_name, request, limits);
}

LinearMap decode_hdf5(const fs::path& file) {
  MessageWriter request = itk_child::request();
  request.value(TransformTask::read);
  request.text(fs::absolute(file).string());
  const ChildResult result = run_worker(request);
  MessageReader in(transform_worker_name, result.bytes());
  std::vector<LinearMap> maps;
  bool composite = false;
  while (!in.empty()) {
    const std::string kind(in.text());
    const auto parameters = in.array<double>(), fixed = in.array<double>();
    if (kind.rfind("CompositeTransform", 0) == 0) {
      if (composite || !maps.empty()) throw Error(ExitCode::bad_input, "", "Transform", "composites within composites");
      composite = true;
    } else {
      maps.push_back(linear_map(kind, parameters, fixed));
    }
  }
  if (maps.empty()) throw Error(ExitCode::bad_input, "", "Transform", "the file holds none");
  if (maps.size() > 1 && !composite)
    throw Error(ExitCode::bad_input, "", "Transform", "there are several: only one, or a composite, can be read");
  // ITK's composite applies the transform that was added last first.
  LinearMap all = maps.back();
  for (std::size_t i = maps.size() - 1; i-- > 0;) all = then(all, maps[i]);
  inverse(all);
  return all;
}

}  // namespace

bool is_transform_file(const fs::path& file) { return file.extension() == ".tfm" || is_hdf5(file); }

LinearMap read_transform(const fs::path& file) {
  if (!is_hdf5(file)) return read_tfm(file);
  read_file(file, max_bytes);  // says what is missing, unreadable or far too large
  return with_file(file.string(), [&] { return decode_hdf5(file); });
}

void write_transform(const fs::path& file, const LinearMap& map) {
  if (!is_transform_file(file)) throw Error(ExitCode::usage, file.string(), "transform", "must end in .tfm or .h5");
  if (!is_hdf5(file)) return write_file(file, encode_tfm(map));
  const TemporaryFolder folder;
  const fs::path made = folder.path() / "transform.h5";
  MessageWriter request = itk_child::request();
  request.value(TransformTask::write);
  request.text(made.string());
  std::vector<double> numbers;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) numbers.push_back(map.matrix.column[c][r]);
  for (int r = 0; r < 3; ++r) numbers.push_back(map.offset_mm[r]);
  request.array(numbers);
  run_worker(request);
  const std::vector<char> bytes = read_file(made, max_bytes);
  write_file(file, {bytes.data(), bytes.size()});
}

}  // namespace trephine::itk
