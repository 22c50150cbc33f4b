// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/volume_source.h"

#include <algorithm>

#include "base/error.h"
#include "base/joined.h"
#include "base/write_file.h"
#include "dicom/archive.h"
#include "dicom/input_files.h"
#include "itk/slicer_scene.h"
#include "itk/volume_file.h"

namespace trephine::dicom {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t max_scene_bytes = std::uint64_t{64} << 20;

[[noreturn]] void refuse(const std::string& what) { throw Error(ExitCode::bad_input, "", "scene", what); }

std::vector<VolumeSource> sources_of(const std::vector<itk::SceneVolume>& volumes, const fs::path& folder,
                                     bool archive) {
  if (volumes.empty()) refuse("holds no scalar volume");
  std::vector<VolumeSource> sources;
  for (const itk::SceneVolume& v : volumes) {
    VolumeSource s;
    if (archive)
      s.member = (folder / v.file).generic_string();
    else
      s.file = folder / v.file;
    s.transformed = v.transformed;
    sources.push_back(std::move(s));
  }
  return sources;
}

std::vector<VolumeSource> in_archive(const fs::path& file, const Progress& progress) {
  const Archive archive = read_archive(file, progress, {}, {".mrml"});
  const Archive::Member* scene = nullptr;
  for (const Archive::Member& m : archive.members) {
    if (fs::path(m.name).extension() != ".mrml") continue;
    if (scene) refuse("the archive holds several scenes");
    scene = &m;
  }
  if (!scene) refuse("the archive holds no scene (.mrml)");
  if (scene->bytes.size() > max_scene_bytes) refuse("the scene is larger than 64 MiB");
  return sources_of(itk::scene_volumes(scene->bytes), fs::path(scene->name).parent_path(), true);
}

}  // namespace

std::vector<VolumeSource> volume_sources(const fs::path& path, const Progress& progress) {
  std::error_code none;
  const std::string extension = path.extension().string();
  std::vector<VolumeSource> sources;
  if (fs::is_regular_file(path, none) && extension == ".mrml") {
    const std::vector<char> text = read_file(path, max_scene_bytes);
    sources = with_scan(path, [&] {
      return sources_of(itk::scene_volumes({text.data(), text.size()}), path.parent_path(), false);
    });
  } else if (fs::is_regular_file(path, none) && extension == ".mrb" && is_zip(path)) {
    sources = with_scan(path, [&] { return in_archive(path, progress); });
  } else {
    for (fs::path& file : itk::find_volume_files(path)) {
      sources.emplace_back();
      sources.back().file = std::move(file);
    }
  }
  for (std::size_t i = 0; i < sources.size(); ++i) sources[i].token = "s" + std::to_string(i + 1);
  return sources;
}

std::vector<fs::path> files_beside(const fs::path& path) {
  std::error_code none;
  if (!fs::is_regular_file(path, none) || path.extension() == ".mrb") return {};
  std::vector<fs::path> files;
  try {
    for (const VolumeSource& s : volume_sources(path)) {
      if (s.file != path) files.push_back(s.file);
      if (const fs::path data = itk::data_file_of(s.file); !data.empty()) files.push_back(data);
    }
  } catch (const Error&) {
  }
  return files;
}

// A scene's file may be a link, but not one that leads out of the scene's folder.
void require_beneath(const fs::path& scene, const fs::path& file) {
  const fs::path folder = fs::weakly_canonical(fs::absolute(scene).parent_path()), real = fs::weakly_canonical(file);
  if (std::mismatch(folder.begin(), folder.end(), real.begin(), real.end()).first != folder.end())
    refuse("a volume's file is a link out of the scene's folder: save the scene with its data, or as .mrb");
}

void unpack(const fs::path& path, VolumeSource& source, const Progress& progress) {
  with_scan(path, [&] {
    if (source.transformed)
      refuse(
          "the volume lies under a transform, which is not part of its file: harden the transform in 3D Slicer and "
          "save the scene again");
    if (!source.member.empty() && !source.unpacked) {
      const Archive archive = read_archive(path, progress, {}, {source.member});
      const auto member = std::find_if(archive.members.begin(), archive.members.end(),
                                       [&](const Archive::Member& m) { return m.name == source.member; });
      if (member == archive.members.end()) refuse("the volume's file is not in the archive");
      source.unpacked = std::make_shared<TemporaryFolder>();
      // Only the ending of a member's name is used, and only where it is one that is known.
      const fs::path name = fs::path(source.member).filename();
      std::string ending = name.extension().string();
      if (ending == ".gz") ending = name.stem().extension().string() + ending;
      const fs::path file = source.unpacked->path() / ("volume" + ending);
      source.unpacked->fill(member->bytes.size(), [&] { write_file(file, member->bytes); });
      source.file = file;
    }
    std::error_code none;
    if (!fs::is_regular_file(source.file, none)) refuse("the volume's file is not there");
    if (path.extension() == ".mrml") require_beneath(path, source.file);
    if (itk::find_volume_files(source.file).empty()) refuse("the volume's file is of no format that is read");
  });
}

VolumeSource chosen_volume(const fs::path& path, const std::string& series, const Progress& progress) {
  std::vector<VolumeSource> sources = volume_sources(path, progress);
  if (sources.empty()) return {};
  const std::string known = joined(sources, ", ", &VolumeSource::token);
  const auto found = std::find_if(sources.begin(), sources.end(), [&](const VolumeSource& s) {
    return series.empty() ? sources.size() == 1 : series.substr(0, series.find('-')) == s.token;
  });
  if (found == sources.end())
    throw Error(ExitCode::usage, name_of_scan(path), "series",
                (series.empty() ? std::to_string(sources.size()) + " volumes, choose one by its token: " + known
                                : "no such volume; there are: " + known) +
                    "; " + Setting{"series", "s1"} + " chooses the first");
  unpack(path, *found, progress);
  return *found;
}

}  // namespace trephine::dicom
