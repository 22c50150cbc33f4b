// SPDX-License-Identifier: GPL-3.0-or-later
#include "external/external.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>

#include "base/error.h"
#include "base/file_descriptor.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/open_beneath.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "base/text.h"
#include "base/write_file.h"
#include "external/confined.h"
#include "grid/bounded_read.h"
#include "grid/nifti.h"

namespace trephine::external {
namespace fs = std::filesystem;
namespace {

constexpr double version_limit_s = 120, same_voxel = 0.05, largest_output_gb = 16;
constexpr std::size_t max_said = 200;

[[noreturn]] void usage(const std::string& field, const std::string& what) {
  throw Error(ExitCode::usage, "", field, what);
}

/// A folder of its own with an empty home, removed with all that is in it.
class Scratch {
 public:
  Scratch() {
    std::string name = (fs::temp_directory_path() / "trephine-external-XXXXXX").string();
    if (!mkdtemp(name.data()))
      throw Error(ExitCode::cannot_create, name, "external", std::string("no folder for it: ") + std::strerror(errno));
    folder_ = name;
    for (const char* part : {"home", "tmp"}) fs::create_directory(folder_ / part);
  }
  ~Scratch() {
    std::error_code error;
    // What the program closed for itself is opened again.
    for (auto i = fs::recursive_directory_iterator(folder_, fs::directory_options::skip_permission_denied, error);
         !error && i != fs::recursive_directory_iterator(); i.increment(error))
      if (i->is_directory(error) && !i->is_symlink(error)) fs::permissions(i->path(), fs::perms::owner_all, error);
    fs::remove_all(folder_, error);
    if (error) log_warning("external: its folder could not be removed: " + folder_.string());
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path& folder() const { return folder_; }

 private:
  fs::path folder_;
};

std::string find_program(const std::string& name) {
  const auto is_program = [](const std::string& path) {
    struct stat s {};
    return stat(path.c_str(), &s) == 0 && S_ISREG(s.st_mode) && access(path.c_str(), X_OK) == 0;
  };
  if (name.find('/') != std::string::npos) {
    if (name[0] != '/') usage("program", printable(name) + ": must be a name in PATH, or an absolute path");
    if (is_program(name)) return name;
  } else if (const char* path = std::getenv("PATH")) {
    for (const std::string& folder : split_at(path, ':'))
      if (!folder.empty() && folder[0] == '/' && is_program(folder + "/" + name)) return folder + "/" + name;
  }
  throw Error(ExitCode::no_input, printable(name), "program", "there is no such program");
}

/// Whether the line holds that version and no longer number: "2.4" is neither in "12.4" nor in "2.40".
bool holds_version(const std::string& line, const std::string& version) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  for (std::size_t at = 0; (at = line.find(version, at)) != std::string::npos; ++at) {
    const std::size_t end = at + version.size();
    const bool begins = at == 0 || !digit(version.front()) || !(digit(line[at - 1]) || line[at - 1] == '.');
    const bool ends = end == line.size() || !digit(version.back()) || !digit(line[end]);
    if (begins && ends) return true;
  }
  return false;
}

class Run {
 public:
  explicit Run(const ExternalParams& params) : params_(params) {
    if (params.program.empty()) usage("program", "is needed: the program that labels the scan");
    if (params.version.empty()) usage("version", "is needed: what the first line of its version must hold");
    const fs::path output = params.labels_file;
    if (params.labels_file.empty() || output.is_absolute() ||
        std::any_of(output.begin(), output.end(), [](const fs::path& part) { return part == ".."; }))
      usage("labels_file", printable(params.labels_file) + ": must be a path within the folder");
    for (const auto& [name, word] : params.environment)
      for (const char c : name)
        if (!(c == '_' || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')))
          usage("environment", printable(name) + ": is no name of a variable");
    for (const ExternalWord& folder : params.may_write)
      if (folder.text.empty() || folder.text[0] != '/')
        usage("may_write", printable(folder.text) + ": must be absolute");
    program_ = find_program(params.program);
  }

  void check_version(const Progress& progress) {
    if (params_.version_arguments.empty()) {
      made.result.said_version = "is not asked";
      return;
    }
    ConfinedRequest request = request_of(params_.version_arguments);
    request.time_limit_s = std::min(params_.time_limit_s, version_limit_s);
    require_good(run_confined(request, progress), "asked for its version, ");
    const std::vector<std::string> said = said_lines();
    const std::string line = said.empty() ? "" : said.front();
    if (!holds_version(line, params_.version))
      usage("version", "the program says '" + line + "', which does not hold " + printable(params_.version));
    made.result.said_version = line;
  }

  void label(const grid::HuVolume& volume, const Progress& progress) {
    std::error_code ignored;
    fs::create_directories((scratch_.folder() / params_.labels_file).parent_path(), ignored);
    write_file(scratch_.folder() / "input.nii.gz", grid::encode_nifti(volume, true));
    made.result.program_sha256 = sha256_of_file(program_);
    const ConfinedResult result = run_confined(request_of(params_.arguments), progress);
    require_good(result, "");
    if (sha256_of_file(program_) != made.result.program_sha256)
      refuse("was exchanged while it ran: nobody can say which program made the labels");
    for (const auto& [open, what] :
         {std::make_pair(result.network_open, "has the network"),
          {result.services_open, "may speak to services of this machine"},
          {result.files_open, "may write where the user may"},
          {result.attributes_open, "is kept from modes and times of files by a filter of system calls alone"},
          {result.processes_open, "may see the command lines of other processes"}}) {
      if (open.empty()) continue;
      made.warnings.push_back({"not_confined",
                               "the program {what}, the kernel allows no other ({open})",
                               {{"what", what}, {"open", open}}});
    }
  }

  /// The output's bytes, wherever links in the folder lead.
  std::string output() const {
    const FileDescriptor fd(open_beneath(scratch_.folder(), params_.labels_file));
    struct stat s {};
    if (!fd.valid() || fstat(fd.get(), &s) != 0 || !S_ISREG(s.st_mode)) {
      const bool leads_out = !fd.valid() && (errno == EXDEV || errno == ELOOP);
      refuse(leads_out ? "leads out of the program's folder"
                       : "was not written, though the program ended without error");
    }
    if (double(s.st_size) > largest_output_gb * 1e9) refuse("is larger than 16 GB");
    std::string bytes(std::size_t(s.st_size), '\0');
    std::size_t at = 0;
    while (at < bytes.size()) {
      const ssize_t n = read(fd.get(), bytes.data() + at, bytes.size() - at);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) throw Error(ExitCode::io, params_.labels_file, "labels_file", "cannot be read");
      at += std::size_t(n);
    }
    return bytes;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ExitCode::bad_input, "", "labels_file", printable(params_.labels_file) + " " + what);
  }

  Outcome<grid::LabelFile, ExternalResult> made;

 private:
  std::string filled(const std::string& text) const {
    const std::pair<const char*, std::string> places[] = {
        {"{input}", (scratch_.folder() / "input.nii.gz").string()},
        {"{output}", (scratch_.folder() / params_.labels_file).string()},
        {"{folder}", scratch_.folder().string()},
        {"{threads}", std::to_string(thread_count())}};
    std::string out = text;
    for (const auto& [place, value] : places)
      for (std::size_t at = 0; (at = out.find(place, at)) != std::string::npos; at += value.size())
        out.replace(at, std::strlen(place), value);
    return out;
  }

  ConfinedRequest request_of(const std::vector<ExternalWord>& words) const {
    ConfinedRequest request;
    request.argv = {program_};
    for (const ExternalWord& w : words) request.argv.push_back(filled(w.text));
    request.folder = scratch_.folder();
    request.log = scratch_.folder() / "log.txt";
    request.require_confined = params_.require_confined;
    const char* path = std::getenv("PATH");
    request.environment = {{"PATH", path ? path : "/usr/bin:/bin"},
                           {"HOME", (scratch_.folder() / "home").string()},
                           {"TMPDIR", (scratch_.folder() / "tmp").string()},
                           {"LANG", "C.UTF-8"}};
    for (const auto& [name, word] : params_.environment) {
      auto& all = request.environment;
      all.erase(std::remove_if(all.begin(), all.end(), [&n = name](const auto& e) { return e.first == n; }), all.end());
      all.emplace_back(name, filled(word.text));
    }
    for (const ExternalWord& folder : params_.may_write) request.may_write.push_back(folder.text);
    request.time_limit_s = params_.time_limit_s;
    request.memory_limit_gb = params_.memory_limit_gb;
    request.file_limit_gb = largest_output_gb;
    return request;
  }

  /// What the program printed, without empty lines and control characters: its first line and its last ones.
  std::vector<std::string> said_lines() const {
    constexpr std::size_t most = 1 << 16;
    const FileDescriptor fd(open_beneath(scratch_.folder(), "log.txt"));
    struct stat s {};
    if (!fd.valid() || fstat(fd.get(), &s) != 0 || !S_ISREG(s.st_mode)) return {};
    std::string text(most, '\0');
    const auto read_at = [&](off_t from) {
      const ssize_t n = pread(fd.get(), text.data(), most, from);
      return text.substr(0, std::size_t(std::max<ssize_t>(0, n)));
    };
    std::string all = read_at(0);
    if (std::size_t(s.st_size) > most) all += "\n" + read_at(s.st_size - off_t(most));
    std::vector<std::string> lines;
    for (const std::string& line : split_at(all, '\n'))
      if (const std::string shown = printable(line).substr(0, max_said);
          shown.find_first_not_of(" ?") != std::string::npos)
        lines.push_back(shown);
    return lines;
  }

  void require_good(const ConfinedResult& r, const std::string& when) const {
    const std::string name = fs::path(program_).filename().string();
    const auto fail = [&](const std::string& what) {
      const std::vector<std::string> said = said_lines();
      throw Error(ExitCode::internal, "", "program",
                  when + name + " " + what + (said.empty() ? "" : "; its last line: " + said.back()));
    };
    if (!r.not_started.empty()) fail("could not be started: " + r.not_started);
    if (r.timed_out) fail("reached its time limit of " + to_text(params_.time_limit_s) + " s and was ended");
    if (r.over_memory) fail("reached its memory limit of " + to_text(params_.memory_limit_gb) + " GB and was ended");
    if (r.signal) fail("was killed by signal " + std::to_string(r.signal));
    if (r.code) fail("ended with code " + std::to_string(r.code));
  }

  const ExternalParams& params_;
  Scratch scratch_;
  std::string program_;
};

/// Whole numbers of 8 or 16 bits in one layer.
template <class T>
grid::Grid<T> as(const grid::LabelFile& map) {
  grid::Grid<T> out(map.lattice);
  std::visit([&](const auto& g) { std::copy(g.voxels.begin(), g.voxels.end(), out.voxels.begin()); }, map.samples);
  return out;
}

void make_plain(grid::LabelFile& map, const Named<ExternalLabel>& names, const Run& run) {
  if (map.layers != 1) run.refuse("has " + std::to_string(map.layers) + " layers, must be a map of one");
  double largest = 0;
  std::visit(
      [&](const auto& g) {
        for (const auto v : g.voxels) largest = std::max(largest, double(v));
      },
      map.samples);
  if (largest > 32767) run.refuse("holds the label " + to_text(largest) + ", must be at most 32767");
  if (largest > 255)
    map.samples = as<std::int16_t>(map);
  else
    map.samples = as<std::uint8_t>(map);
  if (!names.empty()) map.segments.clear();
  for (const auto& [name, label] : names) {
    grid::LabelSegment segment;
    segment.id = segment.name = name;
    segment.value = label.value;
    map.segments.push_back(segment);
  }
  map.format = map.segments.empty() ? "NRRD" : "seg.nrrd";  // as encode_labels writes it
}

void require_same_grid(const grid::Lattice& map, const grid::Lattice& volume) {
  double off = map.size == volume.size ? 0 : 1e9;
  for (int c = 0; c < 8 && off < 1e9; ++c) {
    Vec3 at;
    for (int a = 0; a < 3; ++a) at[a] = c >> a & 1 ? volume.size[std::size_t(a)] - 1.0 : 0;
    const Vec3 q = volume.to_index(map.to_world_mm(at));
    for (int a = 0; a < 3; ++a) off = std::max(off, std::abs(q[a] - at[a]));
  }
  if (off <= same_voxel) return;
  const auto size = [](const grid::Lattice& l) {
    return std::to_string(l.size[0]) + " x " + std::to_string(l.size[1]) + " x " + std::to_string(l.size[2]);
  };
  throw refusal("labels_file",
                map.size == volume.size
                    ? "its voxels lie up to " + to_text(std::round(off * 100) / 100) + " voxels off the scan's"
                    : size(map) + " voxels, the scan has " + size(volume),
                {"set `same_grid` to false, and it is resampled"});
}

void count_labels(const grid::LabelFile& map, ExternalResult& result) {
  std::set<int> values;
  std::size_t voxels = 0;
  std::visit(
      [&](const auto& g) {
        for (const auto v : g.voxels)
          if (v != 0) {
            ++voxels;
            values.insert(int(v));
          }
      },
      map.samples);
  if (values.empty())
    throw refusal("labels_file", "holds no label: every voxel is 0",
                  {"look at what the program says of this series when it is run by hand, or paint the labels and bring "
                   "them back by the stage `labels`"});
  result.labels_count = values.size();
  result.labelled_ml = double(voxels) * map.lattice.voxel_volume_mm3() / 1000;
}

}  // namespace

Outcome<grid::LabelFile, ExternalResult> run_external(const grid::HuVolume& volume, const ExternalParams& params,
                                                      const Progress& progress) {
  Run run(params);
  ExternalResult& result = run.made.result;
  grid::LabelFile& map = run.made.value;
  run.check_version(progress.part(0, 0.05));
  run.label(volume, progress.part(0.05, 0.95));
  const std::string bytes = run.output();
  result.output_sha256 = sha256_of_bytes(bytes);
  try {
    map = grid::decode_labels_bounded(bytes);
  } catch (const Error& e) {
    run.refuse("is no map of labels: " + (e.field().empty() ? "" : e.field() + ": ") + e.what());
  }
  result.output_format = map.format;
  for (const std::string& w : map.warnings) run.made.warnings.push_back({"label_file", w, {}});
  map.warnings.clear();
  if (params.same_grid) require_same_grid(map.lattice, grid::lattice_of(volume));
  make_plain(map, params.names, run);
  count_labels(map, result);
  return std::move(run.made);
}

}  // namespace trephine::external
