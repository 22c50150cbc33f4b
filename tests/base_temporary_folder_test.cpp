// SPDX-License-Identifier: GPL-3.0-or-later
// TemporaryFolder: what a killed process left goes when the next one begins; what is held, of others or not ours stays.
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <memory>
#include <string>

#include "base/error.h"
#include "base/memory_kills.h"
#include "base/temporary_folder.h"

namespace trephine {
namespace {
namespace fs = std::filesystem;

class TemporaryFolders : public testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/trephine-base-XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    in_ = name;
    const char* before = getenv("TMPDIR");
    before_ = before ? before : "";
    setenv("TMPDIR", name, 1);
  }
  void TearDown() override {
    if (before_.empty())
      unsetenv("TMPDIR");
    else
      setenv("TMPDIR", before_.c_str(), 1);
    fs::remove_all(in_);
  }
  std::size_t count() const {
    return std::size_t(std::distance(fs::directory_iterator(in_), fs::directory_iterator()));
  }

  fs::path in_;
  std::string before_;
};

// A process that holds a folder with a file in it, until it is killed.
struct Holder {
  pid_t process = -1;
  fs::path folder;
  Holder() {
    int ready[2];
    if (pipe(ready) != 0) return;
    process = fork();
    if (process == 0) {
      const TemporaryFolder held;
      fs::create_directory(held.path() / "deeper");
      std::ofstream(held.path() / "deeper" / "volume.nrrd") << "a patient's CT";
      const std::string name = held.path().string() + "\n";
      if (write(ready[1], name.data(), name.size()) != ssize_t(name.size())) _exit(1);
      for (;;) pause();
    }
    std::string name;
    for (char c = 0; read(ready[0], &c, 1) == 1 && c != '\n';) name += c;
    close(ready[0]);
    close(ready[1]);
    folder = name;
  }
  void kill() {
    ::kill(process, SIGKILL);
    waitpid(process, nullptr, 0);
  }
};

TEST_F(TemporaryFolders, WhatAKilledProcessLeftGoesAtTheNextStart) {
  Holder killed;
  killed.kill();
  ASSERT_TRUE(fs::exists(killed.folder / "deeper" / "volume.nrrd")) << "SIGKILL leaves it";
  {
    const TemporaryFolder next;
    EXPECT_FALSE(fs::exists(killed.folder));
    struct stat s {};
    ASSERT_EQ(stat(next.path().c_str(), &s), 0);
    EXPECT_EQ(s.st_mode & 0777, 0700u);
    EXPECT_EQ(count(), 1u);
  }
  EXPECT_EQ(count(), 0u);
}

TEST_F(TemporaryFolders, WhatIsHeldStays) {
  Holder other;
  const TemporaryFolder mine;
  fs::create_directory(in_ / "trephine-another");
  std::ofstream(in_ / "trephine-held-file") << "no folder";
  fs::create_directory(in_ / "target");
  std::ofstream(in_ / "target" / "kept") << "beyond a link";
  fs::create_directory_symlink(in_ / "target", in_ / "trephine-held-link");
  const TemporaryFolder third;
  EXPECT_TRUE(fs::exists(other.folder / "deeper" / "volume.nrrd"));
  EXPECT_TRUE(fs::exists(mine.path()));
  EXPECT_TRUE(fs::exists(in_ / "trephine-another"));
  EXPECT_TRUE(fs::exists(in_ / "trephine-held-file"));
  EXPECT_TRUE(fs::exists(in_ / "target" / "kept"));
  other.kill();
}

TEST_F(TemporaryFolders, AFullFolderIsNamedAndNoOtherFault) {
  const TemporaryFolder folder;
  const auto told = [&](std::uint64_t bytes, ExitCode code) {
    try {
      folder.fill(bytes, [&] { throw Error(code, "out.nrrd", "", "could not write"); });
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), code);
      return e.line("program");
    }
    return std::string();
  };
  const std::string full = told(std::uint64_t{1} << 62, ExitCode::io);
  EXPECT_NE(full.find(in_.string()), std::string::npos) << full;
  EXPECT_NE(full.find("set TMPDIR"), std::string::npos) << full;
  EXPECT_EQ(full.find("out.nrrd"), std::string::npos) << full;
  EXPECT_NE(told(1, ExitCode::io).find("out.nrrd"), std::string::npos);
  EXPECT_NE(told(std::uint64_t{1} << 62, ExitCode::bad_input).find("out.nrrd"), std::string::npos);
}

TEST(MemoryKills, AreReadOfEitherVersionOfControlGroups) {
  const TemporaryFolder folder;
  const auto write = [&](const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder.path() / name).parent_path());
    std::ofstream(folder.path() / name) << text;
    return folder.path() / name;
  };
  const auto second = write("second", "0::/system.slice/slurmstepd.scope/job_4/step_0\n");
  EXPECT_EQ(memory_kills(second, folder.path()), 0u);
  write("system.slice/slurmstepd.scope/job_4/step_0/memory.events", "low 0\nhigh 9\nmax 31\noom 5\noom_kill 3\n");
  EXPECT_EQ(memory_kills(second, folder.path()), 3u);
  const auto first = write("first", "9:name=systemd:/\n4:cpu,memory:/slurm/job_4\n0::/\n");
  write("memory/slurm/job_4/memory.oom_control", "oom_kill_disable 0\nunder_oom 0\noom_kill 2\n");
  EXPECT_EQ(memory_kills(first, folder.path()), 2u);
  EXPECT_EQ(memory_kills(folder.path() / "none", folder.path()), 0u);
}

}  // namespace
}  // namespace trephine
