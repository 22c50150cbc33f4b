// SPDX-License-Identifier: GPL-3.0-or-later
// The import beside itk::ImageSeriesReader with GDCMImageIO and dcm2niix: seconds, and the peak of what the process and
// its children hold (PSS, so that shared pages count once).
//
//   bench_import --make FOLDER raw|jpeg_ls [SLICES]   a 512 x 512 phantom series without tilt
//   bench_import FOLDER [REPETITIONS]                 all of them in turn on that series; the least seconds count
#include <dirent.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "base/child.h"
#include "dicom/import.h"
#include "grid/nrrd.h"
#include "phantom/phantom.h"
#ifdef BENCH_ITK
#include <itkGDCMImageIO.h>
#include <itkGDCMSeriesFileNames.h>
#include <itkImageSeriesReader.h>
#endif

extern char** environ;

namespace {

using namespace trephine;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

int make_series(const fs::path& folder, const std::string& encoding, int slices) {
  phantom::ScanParams p;
  p.slices_count = 64;
  p.slice_step_mm = 2;
  const phantom::Scan some = phantom::scan(phantom::Head(phantom::HeadParams{}), p);
  // To and fro through the head until there are enough: neighbours are neighbours everywhere.
  phantom::Scan all = some;
  const std::size_t pixels = std::size_t(some.columns) * std::size_t(some.rows);
  all.slices.clear();
  all.hu.clear();
  for (int k = 0; k < slices; ++k) {
    const int n = k % 126, from = n < 64 ? n : 126 - n;
    phantom::SlicePose pose = some.slices[0];
    pose.origin_mm.z += 0.5 * k;
    all.slices.push_back(pose);
    all.hu.insert(all.hu.end(), some.hu.begin() + static_cast<std::ptrdiff_t>(pixels * std::size_t(from)),
                  some.hu.begin() + static_cast<std::ptrdiff_t>(pixels * std::size_t(from + 1)));
  }
  p.slice_step_mm = 0.5;
  p.slices_count = slices;
  phantom::SeriesParams series;
  series.encoding = encoding == "raw" ? phantom::Encoding::none : phantom::Encoding::jpeg_ls;
  phantom::write_series(folder, all, p, series, "bench");
  return 0;
}

/// One reader in this process.
int read_with(const std::string& how, const std::string& folder, const std::string& out) {
  if (how == "trephine" || how == "trephine+write") {
    const dicom::ImportResult r = dicom::import_series(folder, {});
    if (how == "trephine+write") grid::write_nrrd(out + "/volume.nrrd", r.volume);
    return grid::lattice_of(r.volume).count() > 0 ? 0 : 1;
  }
#ifdef BENCH_ITK
  if (how == "itk") {
    using Image = ::itk::Image<short, 3>;
    auto names = ::itk::GDCMSeriesFileNames::New();
    names->SetDirectory(folder);
    auto reader = ::itk::ImageSeriesReader<Image>::New();
    reader->SetImageIO(::itk::GDCMImageIO::New());
    reader->SetFileNames(names->GetInputFileNames());
    reader->Update();
    return reader->GetOutput()->GetLargestPossibleRegion().GetNumberOfPixels() > 0 ? 0 : 1;
  }
#endif
  return 2;
}

std::vector<int> children_of(int pid) {
  std::vector<int> all{pid};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string tasks = "/proc/" + std::to_string(all[i]) + "/task";
    DIR* d = opendir(tasks.c_str());
    if (!d) continue;
    while (const dirent* e = readdir(d)) {
      std::ifstream in(tasks + "/" + e->d_name + "/children");
      for (int child; in >> child;) all.push_back(child);
    }
    closedir(d);
  }
  return all;
}

double pss_mb(int pid) {
  double kb = 0;
  for (const int p : children_of(pid)) {
    std::ifstream in("/proc/" + std::to_string(p) + "/smaps_rollup");
    for (std::string line; std::getline(in, line);)
      if (line.rfind("Pss:", 0) == 0) kb += std::atof(line.c_str() + 4);
  }
  return kb / 1024;
}

struct Cost {
  double seconds = 1e9, peak_mb = 0;
  bool good = false;
};

Cost run(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const std::string& w : words) arguments.push_back(const_cast<char*>(w.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  posix_spawn_file_actions_addopen(&quiet, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&quiet, 2, "/dev/null", O_WRONLY, 0);
  Cost c;
  const auto start = Clock::now();
  pid_t pid = 0;
  if (posix_spawnp(&pid, arguments[0], &quiet, nullptr, arguments.data(), environ) != 0) return c;
  int status = 0;
  while (waitpid(pid, &status, WNOHANG) == 0) {
    c.peak_mb = std::max(c.peak_mb, pss_mb(pid));
    usleep(10000);
  }
  c.seconds = seconds_since(start);
  c.good = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  return c;
}

}  // namespace

int main(int argc, char** argv) {
  run_child_if_asked(argc, argv);
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() >= 3 && words[0] == "--make")
    return make_series(words[1], words[2], words.size() > 3 ? std::atoi(words[3].c_str()) : 1000);
  if (words.size() == 4 && words[0] == "--read") return read_with(words[1], words[2], words[3]);
  if (words.empty() || words[0][0] == '-') {
    std::fputs("usage: bench_import --make FOLDER raw|jpeg_ls [SLICES] | bench_import FOLDER [REPETITIONS]\n", stderr);
    return 64;
  }
  const int repetitions = words.size() > 1 ? std::atoi(words[1].c_str()) : 3;
  std::string scratch = (fs::temp_directory_path() / "bench-import-XXXXXX").string();
  if (!mkdtemp(scratch.data())) return 73;
  const auto list = dicom::list_series(words[0]).series;
  const auto& n = list.at(0).size;
  const double volume_mb = 2.0 * n[0] * n[1] * n[2] / (1 << 20);
  std::printf("%s, %s: int16 volume %.0f MB\n", list[0].token.c_str(), list[0].transfer_syntax.c_str(), volume_mb);
  const std::string self = fs::read_symlink("/proc/self/exe").string();
  const std::vector<std::pair<std::string, std::vector<std::string>>> ways = {
      {"trephine", {self, "--read", "trephine", words[0], scratch}},
      {"itk", {self, "--read", "itk", words[0], scratch}},
      {"trephine+write", {self, "--read", "trephine+write", words[0], scratch}},
      {"dcm2niix (writes)", {"dcm2niix", "-z", "n", "-b", "n", "-o", scratch, words[0]}}};
  std::vector<Cost> best(ways.size());
  for (int i = 0; i < repetitions; ++i)  // in turn, so that the machine's moods meet all alike
    for (std::size_t w = 0; w < ways.size(); ++w) {
      const Cost c = run(ways[w].second);
      if (!c.good) continue;
      best[w].good = true;
      best[w].seconds = std::min(best[w].seconds, c.seconds);
      best[w].peak_mb = std::max(best[w].peak_mb, c.peak_mb);
    }
  for (std::size_t w = 0; w < ways.size(); ++w)
    if (best[w].good)
      std::printf("%-20s %7.2f s  peak %6.0f MB = %.2f volumes\n", ways[w].first.c_str(), best[w].seconds,
                  best[w].peak_mb, best[w].peak_mb / volume_mb);
    else
      std::printf("%-20s not there, or failed\n", ways[w].first.c_str());
  fs::remove_all(scratch);
  return 0;
}
