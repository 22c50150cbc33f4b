// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/spilled_data.h"

#include <linux/magic.h>
#include <sys/vfs.h>

#include <system_error>
#include <utility>

#include "base/error.h"
#include "stages/data_files.h"

namespace trephine::pipeline {
namespace {

using Volume = std::shared_ptr<const grid::HuVolume>;
using Field = std::shared_ptr<const grid::Field>;

template <class G>
G lattice_alone(const G& grid) {
  G out;
  static_cast<grid::Lattice&>(out) = grid;
  return out;
}

template <class G>
G filled(G grid, const ScratchFile& file) {
  grid.voxels.resize(grid.count());
  file.read(0, grid.voxels.data(), grid.voxels.size() * sizeof(typename G::Sample));
  return grid;
}

// A folder that lies in memory would hold a second copy there.
bool lies_in_memory(const std::filesystem::path& folder) {
  struct statfs of {};
  return statfs(folder.c_str(), &of) == 0 && (of.f_type == TMPFS_MAGIC || of.f_type == RAMFS_MAGIC);
}

bool has_room(const std::filesystem::path& folder, double bytes) {
  constexpr double left_free_bytes = 1e9;
  std::error_code error;
  const auto space = std::filesystem::space(folder, error);
  return !error && double(space.available) >= bytes + left_free_bytes;
}

}  // namespace

bool SpilledData::takes(const stages::StageData& data) {
  return (std::holds_alternative<Volume>(data) || std::holds_alternative<Field>(data)) &&
         stages::bytes_in_memory(data) >= spilled_from_bytes;
}

std::shared_ptr<const SpilledData> SpilledData::write(const stages::StageData& data,
                                                      const std::filesystem::path& folder) {
  if (!takes(data) || lies_in_memory(folder) || !has_room(folder, stages::bytes_in_memory(data))) return {};
  const auto* volume = std::get_if<Volume>(&data);
  try {
    std::shared_ptr<SpilledData> out(new SpilledData(folder));
    const auto append = [&](const auto& g) {
      out->file_.append(g.voxels.data(), g.voxels.size() * sizeof(g.voxels[0]));
    };
    if (volume) {
      std::visit(append, **volume);
      out->without_voxels_ = std::make_shared<const grid::HuVolume>(
          std::visit([](const auto& g) { return grid::HuVolume(lattice_alone(g)); }, **volume));
    } else {
      const grid::Field& field = *std::get<Field>(data);
      append(field);
      out->without_voxels_ = std::make_shared<const grid::Field>(lattice_alone(field));
    }
    return out;
  } catch (const Error&) {  // it stays in memory
    return {};
  }
}

stages::StageData SpilledData::read() const {
  if (const auto* field = std::get_if<Field>(&without_voxels_))
    return std::make_shared<const grid::Field>(filled(**field, file_));
  return std::make_shared<const grid::HuVolume>(std::visit(
      [this](const auto& g) { return grid::HuVolume(filled(g, file_)); }, *std::get<Volume>(without_voxels_)));
}

}  // namespace trephine::pipeline
