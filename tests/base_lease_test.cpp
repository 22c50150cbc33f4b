// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/lease.h"
#include "base/temporary_folder.h"

namespace trephine {
namespace {
namespace fs = std::filesystem;

fs::path holder_in(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder / lease_folder))
    if (entry.path().filename() != "free") return entry.path();
  return {};
}

bool is_busy(const fs::path& folder, double lease_s = Lease::default_lease_s) {
  try {
    Lease lease(folder, lease_s);
    return false;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::busy);
    return true;
  }
}

// As another host would have named it: its kernel started another time.
void become_of_another_host(const fs::path& folder) {
  const fs::path holder = holder_in(folder);
  fs::rename(holder, folder / lease_folder / "held-0123.4-1-5-0000000000000000");
}

void make_old(const fs::path& folder, double seconds) {
  timespec t[2]{};
  clock_gettime(CLOCK_REALTIME, &t[0]);
  t[0].tv_sec -= static_cast<time_t>(seconds);
  t[1] = t[0];
  ASSERT_EQ(utimensat(AT_FDCWD, holder_in(folder).c_str(), t, 0), 0);
}

TEST(Lease, KeepsOthersOutUntilItEnds) {
  const TemporaryFolder folder;
  {
    const Lease lease(folder.path());
    EXPECT_TRUE(lease.is_held());
    EXPECT_TRUE(is_busy(folder.path()));
  }
  EXPECT_TRUE(fs::exists(folder.path() / lease_folder / "free"));
  EXPECT_FALSE(is_busy(folder.path()));
}

TEST(Lease, OfAProcessThatWasKilledIsTakenAtOnce) {
  const TemporaryFolder folder;
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    const Lease lease(folder.path());
    if (write(ends[1], "x", 1) != 1) _exit(1);
    pause();
    _exit(0);
  }
  char x;
  ASSERT_EQ(read(ends[0], &x, 1), 1);
  EXPECT_TRUE(is_busy(folder.path()));
  kill(child, SIGKILL);
  siginfo_t info;
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT), 0);  // ended and not yet waited for
  EXPECT_FALSE(is_busy(folder.path()));
  waitpid(child, nullptr, 0);
  close(ends[0]);
  close(ends[1]);
}

TEST(Lease, OfAnotherHostIsTakenOnlyWhenItIsOld) {
  const TemporaryFolder folder;
  const Lease lost(folder.path(), 1000);
  become_of_another_host(folder.path());
  EXPECT_FALSE(lost.is_held());
  EXPECT_TRUE(is_busy(folder.path(), 1000));
  // Its time says that it was not renewed, but the file was changed (its ctime) a moment ago: by whom renamed it.
  make_old(folder.path(), 5000);
  EXPECT_TRUE(is_busy(folder.path(), 1000));
  while (is_busy(folder.path(), 1e-3)) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

TEST(Lease, IsRenewed) {
  const TemporaryFolder folder;
  const Lease lease(folder.path(), 0.4);
  struct stat first, later;
  ASSERT_EQ(stat(holder_in(folder.path()).c_str(), &first), 0);
  do {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ASSERT_EQ(stat(holder_in(folder.path()).c_str(), &later), 0);
  } while (later.st_mtim.tv_sec == first.st_mtim.tv_sec && later.st_mtim.tv_nsec == first.st_mtim.tv_nsec);
  EXPECT_TRUE(lease.is_held());
}

TEST(Lease, FollowsItsFolderThatIsRenamed) {
  const TemporaryFolder folder;
  const fs::path made = folder.path() / ".case.new", there = folder.path() / "case";
  fs::create_directory(made);
  {
    const Lease lease(made);
    fs::rename(made, there);
    EXPECT_TRUE(lease.is_held());
    EXPECT_TRUE(is_busy(there));
  }
  EXPECT_FALSE(is_busy(there));
}

// Many want it, from its very first making on: at no time do two have it.
TEST(Lease, IsNeverHeldTwice) {
  const TemporaryFolder folder;
  std::atomic<int> holders{0}, taken{0}, twice{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 100; ++i) try {
          const Lease lease(folder.path());
          twice += ++holders > 1;
          ++taken;
          std::this_thread::yield();
          --holders;
        } catch (const Error& e) {
          if (e.code() != ExitCode::busy) ++twice;
        }
    });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(twice, 0);
  EXPECT_GT(taken, 0);
  int entries = 0;
  for (const auto& entry : fs::directory_iterator(folder.path() / lease_folder)) entries += entry.is_regular_file();
  EXPECT_EQ(entries, 1);
  for (const auto& entry : fs::directory_iterator(folder.path())) EXPECT_EQ(entry.path().filename(), lease_folder);
}

TEST(Lease, ThatCannotBeMadeIsAnError) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  try {
    Lease lease(folder.path() / "file");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::cannot_create);
  }
}

}  // namespace
}  // namespace trephine
