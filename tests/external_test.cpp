// SPDX-License-Identifier: GPL-3.0-or-later
// A program of somebody else's: what it gets, what it may do, and what is said where it fails.
#include "external/external.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "base/child.h"
#include "base/error.h"
#include "base/hash.h"
#include "external/confined.h"
#include "report_of.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;

/// Soft tissue with a ball of bone in air, oblique.
grid::HuVolume sample() {
  grid::Lattice l;
  l.size = {24, 20, 16};
  l.spacing_mm = {1, 1.25, 2};
  l.origin_mm = {-40, 12, 300};
  l.direction.column = {Vec3{0.8, 0.6, 0}, Vec3{-0.6, 0.8, 0}, Vec3{0, 0, 1}};
  grid::Grid<std::int16_t> g(l);
  for (int k = 0; k < 16; ++k)
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 24; ++i) {
        const double r = std::hypot(i - 12.0, j - 10.0, k - 8.0);
        g.at(i, j, k) = std::int16_t(r < 4 ? 700 : r < 7 ? 40 : -1000);
      }
  return g;
}

external::ExternalParams params_of(const std::string& mode, const std::string& more = "") {
  external::ExternalParams p;
  p.program = EXTERNAL_PROGRAM;
  p.version = "1.7";
  for (const char* word : {mode.c_str(), "{input}", "{output}"}) p.arguments.push_back({word});
  if (!more.empty()) p.arguments.push_back({more});
  p.time_limit_s = 600;
  p.memory_limit_gb = 1;
  return p;
}

struct Refused {
  int code = 0;
  std::string text;
};

Refused refused(const external::ExternalParams& params) {
  Report report;
  try {
    value_of(report, external::run_external(sample(), params));
  } catch (const Error& e) {
    return {int(e.code()), e.field() + ": " + e.what()};
  }
  return {};
}

/// Whether this kernel lets a program be confined; then it must be.
struct Kernel {
  bool network = false, services = false, files = false;
  Kernel() {
    const ScratchFolder folder;
    external::ConfinedRequest request;
    request.argv = {EXTERNAL_PROGRAM, "--version"};
    request.folder = folder.path();
    request.log = folder.path() / "log.txt";
    const external::ConfinedResult result = external::run_confined(request);
    network = result.network_open.empty();
    services = result.services_open.empty();
    files = result.files_open.empty();
  }
  bool confines() const { return network && services && files; }
};

TEST(External, TakesTheLabelsThatTheProgramWrote) {
  external::ExternalParams p = params_of("good");
  p.names = {{"soft", {1}}, {"bone", {2}}};
  Report report;
  const grid::LabelFile map = value_of(report, external::run_external(sample(), p));
  const auto volume = std::get<grid::Grid<std::int16_t>>(sample());
  const auto& labels = std::get<grid::Mask>(map.samples);
  ASSERT_EQ(labels.size, volume.size);
  std::size_t labelled = 0;
  for (std::size_t i = 0; i < labels.voxels.size(); ++i) {
    ASSERT_EQ(int(labels.voxels[i]), volume.voxels[i] > 300 ? 2 : volume.voxels[i] > -200 ? 1 : 0) << i;
    labelled += labels.voxels[i] != 0;
  }
  EXPECT_EQ(std::get<std::string>(*report.find("said_version")), "labeller 1.7 (test)");
  EXPECT_EQ(std::get<std::string>(*report.find("output_sha256")).size(), 64u);
  EXPECT_NEAR(std::get<double>(*report.find("labelled_ml")), double(labelled) * 2.5 / 1000, 1e-6);
  EXPECT_EQ(grid::pick_label(map, "bone").voxels, grid::pick_label(map, "2").voxels);
  EXPECT_EQ(grid::pick_label(map, "soft, bone").voxels, labelled);

  // Of several labels one may be missing in a scan, but not all; a name must be known.
  grid::LabelFile unnamed = map;
  unnamed.segments.clear();
  EXPECT_EQ(grid::pick_label(unnamed, "1, 2, 17").voxels, labelled);
  EXPECT_THROW(grid::pick_label(unnamed, "17, 18"), Error);
  EXPECT_THROW(grid::pick_label(map, "bone, bnoe"), Error);
  EXPECT_THROW(grid::pick_label(map, "bone,,soft"), Error);

  // As a file between single tools, or in a cache, it stays the same.
  const grid::LabelFile back = grid::decode_labels(grid::encode_labels(map));
  EXPECT_EQ(std::get<grid::Mask>(back.samples).voxels, labels.voxels);
  EXPECT_EQ(back.format, map.format);
  ASSERT_EQ(back.segments.size(), 2u);
  EXPECT_EQ(back.segments[1].name, "bone");
  Report again;
  value_of(again, external::run_external(sample(), p));
  EXPECT_EQ(again.find("output_sha256")->index(), report.find("output_sha256")->index());
  EXPECT_EQ(*again.find("output_sha256"), *report.find("output_sha256"));
}

TEST(External, WhatGoesWrongIsSaid) {
  const struct {
    const char *mode, *said;
    ExitCode code;
  } cases[] = {
      {"garbage", "labels_file: labels.nii.gz is no map of labels: header: neither NRRD nor NIfTI",
       ExitCode::bad_input},
      {"partial", "is no map of labels: data: ", ExitCode::bad_input},
      {"fraction", "is no map of labels: data: ", ExitCode::bad_input},
      {"nothing", "was not written, though the program ended without error", ExitCode::bad_input},
      {"link", "leads out of the program's folder", ExitCode::bad_input},
      {"fifo", "was not written", ExitCode::bad_input},
      {"grid", "labels_file: 24 x 20 x 8 voxels, the scan has 24 x 20 x 16", ExitCode::quality},
      {"moved", "lie up to 0.4 voxels off the scan's", ExitCode::quality},
      {"empty", "holds no label", ExitCode::quality},
      {"code", "external_program ended with code 3; its last line: no model: ?[31mweights missing", ExitCode::internal},
      {"crash", "was killed by signal 11", ExitCode::internal}};
  for (const auto& c : cases) {
    const Refused is = refused(params_of(c.mode));
    EXPECT_EQ(is.code, int(c.code)) << c.mode << ": " << is.text;
    EXPECT_NE(is.text.find(c.said), std::string::npos) << c.mode << ": " << is.text;
  }
  external::ExternalParams p = params_of("moved");
  p.same_grid = false;
  EXPECT_EQ(refused(p).code, 0);
}

TEST(External, ParametersThatMakeNoSense) {
  const auto with = [](auto change) {
    external::ExternalParams p = params_of("good");
    change(p);
    return refused(p);
  };
  EXPECT_EQ(with([](auto& p) { p.program = ""; }).code, 64);
  EXPECT_EQ(with([](auto& p) { p.program = "bin/labeller"; }).code, 64);
  EXPECT_EQ(with([](auto& p) { p.program = "no-such-program-of-trephine"; }).code, 66);
  EXPECT_EQ(with([](auto& p) { p.program = "/etc/passwd"; }).code, 66);
  EXPECT_EQ(with([](auto& p) { p.version = ""; }).code, 64);
  EXPECT_EQ(with([](auto& p) { p.version = "7"; }).code, 64);  // it says 1.7
  EXPECT_EQ(with([](auto& p) { p.version = "1"; }).code, 0);
  const Refused other = with([](auto& p) { p.version = "2.0"; });
  EXPECT_EQ(other.code, 64);
  EXPECT_EQ(other.text, "version: the program says 'labeller 1.7 (test)', which does not hold 2.0");
  EXPECT_EQ(with([](auto& p) { p.labels_file = "/tmp/labels.nii"; }).code, 64);
  EXPECT_EQ(with([](auto& p) { p.labels_file = "a/../../labels.nii"; }).code, 64);
  EXPECT_EQ(with([](auto& p) { p.environment = {{"A=B", {"c"}}}; }).code, 64);
  EXPECT_EQ(with([](auto& p) { p.may_write = {{"folder"}}; }).code, 64);
  EXPECT_EQ(with([](auto& p) { p.labels_file = "deep/er/labels.nii.gz"; }).code, 0);
}

bool is_running(const fs::path& pid_file) {
  std::ifstream in(pid_file);
  int pid = 0;
  return in >> pid && kill(pid, 0) == 0;
}

TEST(External, TimeIsLimitedForAllItsProcesses) {
  const ScratchFolder folder;
  external::ExternalParams p = params_of("sleep", (folder.path() / "pid").string());
  p.may_write = {{folder.path().string()}};
  p.time_limit_s = 1.5;
  const Refused is = refused(p);  // it would sleep for ten minutes
  EXPECT_EQ(is.code, 70);
  EXPECT_NE(is.text.find("reached its time limit of 1.5 s"), std::string::npos) << is.text;
  // In a namespace the number that the child sees is not that which we see: what matters is that it does not work on.
  if (!Kernel().network) {
    EXPECT_FALSE(is_running(folder.path() / "pid"));
  }
}

TEST(External, MemoryIsLimited) {
  external::ExternalParams p = params_of("memory");
  p.memory_limit_gb = 0.2;
  const Refused is = refused(p);
  EXPECT_EQ(is.code, 70);
  EXPECT_NE(is.text.find("reached its memory limit of 0.2 GB"), std::string::npos) << is.text;
}

TEST(External, NothingOfItOutlivesIt) {
  const ScratchFolder folder;
  const fs::path sign = folder.path() / "alive";
  external::ExternalParams p = params_of("orphan", sign.string());
  p.may_write = {{folder.path().string()}};
  EXPECT_EQ(refused(p).code, 0);
  std::this_thread::sleep_for(std::chrono::seconds(4));
  EXPECT_FALSE(fs::exists(sign));
}

TEST(External, HasNoNetworkAndWritesNowhereElse) {
  const Kernel kernel;
  if (!kernel.network && !kernel.files) GTEST_SKIP() << "this kernel confines nothing";
  if (kernel.network) {
    EXPECT_EQ(refused(params_of("network")).code, 0);
  }
  if (!kernel.files) return;
  const ScratchFolder folder;
  const fs::path sign = folder.path() / "sign";
  external::ExternalParams p = params_of("outside", sign.string());
  p.require_confined = kernel.confines();
  EXPECT_EQ(refused(p).code, 0);
  EXPECT_FALSE(fs::exists(sign));
  p.may_write = {{folder.path().string()}};
  EXPECT_EQ(refused(p).code, 0);
  EXPECT_TRUE(fs::exists(sign));
}

// A container or a chroot may not have the namespaces that confine. Where a machine must have them, as in continuous
// integration, this is not skipped: somewhere the confinement has to be seen to work.
TEST(External, RunsConfinedForReal) {
  if (!Kernel().confines() && !std::getenv("TREPHINE_REQUIRE_CONFINED"))
    GTEST_SKIP()
        << "this machine gives a program no namespaces of its own; TREPHINE_REQUIRE_CONFINED=1 makes that a failure";
  const ScratchFolder folder;
  const fs::path file = folder.path() / "private";
  std::ofstream(file) << "of the user";
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  const auto before = fs::last_write_time(file);
  for (const char* mode : {"good", "attributes", "processes", "network", "services"}) {
    external::ExternalParams p = params_of(mode, file.string());
    p.require_confined = true;
    const Refused is = refused(p);
    EXPECT_EQ(is.code, 0) << mode << ": " << is.text;
  }
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(fs::last_write_time(file), before);
  // A folder that it may write to is its own in this, too.
  external::ExternalParams p = params_of("attributes", file.string());
  p.require_confined = true;
  p.may_write = {{folder.path().string()}};
  EXPECT_NE(refused(p).text.find("ended with code 11"), std::string::npos) << refused(p).text;
}

TEST(External, ReachesNoServiceAndLeavesNoSharedMemory) {
  if (!Kernel().services) GTEST_SKIP() << "this kernel hides no service";
  const ScratchFolder folder;
  const fs::path file = folder.path() / "service";
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  ASSERT_LT(file.string().size(), sizeof at.sun_path);
  file.string().copy(at.sun_path, sizeof at.sun_path - 1);
  const int service = socket(AF_UNIX, SOCK_STREAM, 0), client = socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(bind(service, reinterpret_cast<sockaddr*>(&at), sizeof at), 0);
  ASSERT_EQ(listen(service, 4), 0);
  const Refused is = refused(params_of("services", file.string()));
  EXPECT_EQ(is.code, 0) << is.text;
  EXPECT_FALSE(fs::exists("/dev/shm/trephine-external-note"));
  // The service itself goes on.
  EXPECT_EQ(connect(client, reinterpret_cast<sockaddr*>(&at), sizeof at), 0);
  close(client);
  close(service);
}

TEST(External, ItsEnvironmentIsItsOwn) {
  setenv("SECRET", "of the user", 1);
  external::ExternalParams p = params_of("environment", "8 threads");
  p.environment = {{"MODEL", {"8 threads"}}};
  const Refused is = refused(p);
  unsetenv("SECRET");
  EXPECT_NE(is.text.find("ended with code 8"), std::string::npos) << is.text;
}

TEST(External, LeavesNoFolder) {
  const auto count = [] {
    std::size_t n = 0;
    for (const auto& e : fs::directory_iterator(fs::temp_directory_path()))
      n += e.path().filename().string().rfind("trephine-external-", 0) == 0;
    return n;
  };
  const std::size_t before = count();
  refused(params_of("good"));
  refused(params_of("code"));
  EXPECT_LE(count(), before);
}

}  // namespace
}  // namespace trephine
