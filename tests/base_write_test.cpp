// SPDX-License-Identifier: GPL-3.0-or-later
// FileWriter: whatever step fails, the old target stays, the temporary file goes, and the exit code says who must act.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <string>

#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"

namespace trephine {
namespace {
namespace fs = std::filesystem;

class WriteFile : public testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/trephine-write-XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    folder_ = name;
    calls_ = file_calls();
  }
  void TearDown() override {
    file_calls() = calls_;
    fs::remove_all(folder_);
  }
  static std::string content(const fs::path& file) {
    const auto bytes = read_file(file);
    return {bytes.begin(), bytes.end()};
  }
  int files() const {
    int n = 0;
    for (auto it = fs::directory_iterator(folder_); it != fs::directory_iterator(); ++it) ++n;
    return n;
  }
  // The exit code of what f throws, 0 where it throws nothing.
  template <class F>
  static int code(F f) {
    try {
      f();
    } catch (const Error& e) {
      last_what() = e.what();
      return static_cast<int>(e.code());
    }
    return 0;
  }
  static std::string& last_what() {
    static std::string what;
    return what;
  }
  void expect_old_target_intact() {
    EXPECT_EQ(content(folder_ / "target"), "old");
    EXPECT_EQ(files(), 1);
  }
  fs::path folder_;
  FileCalls calls_;
};

int g_step_calls = 0;

TEST_F(WriteFile, WritesAndReplaces) {
  write_file(folder_ / "target", "old");
  {
    FileWriter w(folder_ / "target");
    w.write("ne");
    w.write("w");
    EXPECT_EQ(content(folder_ / "target"), "old");
    EXPECT_EQ(files(), 2);
    w.commit();
    EXPECT_EQ(w.bytes_written(), 3u);
  }
  EXPECT_EQ(content(folder_ / "target"), "new");
  EXPECT_EQ(files(), 1);
  struct stat s {};
  ASSERT_EQ(::stat((folder_ / "target").c_str(), &s), 0);
  const mode_t mask = ::umask(0);
  ::umask(mask);
  EXPECT_EQ(s.st_mode & 0777, 0644u & ~mask);
}

TEST_F(WriteFile, WithoutCommitNothingStays) {
  write_file(folder_ / "target", "old");
  { FileWriter(folder_ / "target").write("half"); }
  expect_old_target_intact();
}

TEST_F(WriteFile, LongAndOddNames) {
  const std::string name = std::string(240, 'x') + "\xc3\xa9 b";
  write_file(folder_ / name, "1");
  EXPECT_EQ(content(folder_ / name), "1");
  EXPECT_EQ(files(), 1);
}

TEST_F(WriteFile, EveryFailingStepIs74) {
  write_file(folder_ / "target", "old");
  const auto attempt = [&] { return code([&] { write_file(folder_ / "target", "new bytes"); }); };

  file_calls().write = [](int, const void*, std::size_t) -> long { return errno = ENOSPC, -1; };
  EXPECT_EQ(attempt(), 74);
  EXPECT_NE(last_what().find("No space left"), std::string::npos) << last_what();
  expect_old_target_intact();

  file_calls().write = [](int fd, const void* data, std::size_t) -> long {
    return g_step_calls++ < 3 ? ::write(fd, data, 1) : (errno = EIO, -1);
  };
  g_step_calls = 0;
  EXPECT_EQ(attempt(), 74);
  expect_old_target_intact();

  file_calls().write = [](int, const void*, std::size_t) -> long { return 0; };
  EXPECT_EQ(attempt(), 74);
  expect_old_target_intact();

  file_calls() = calls_;
  file_calls().fsync = [](int) { return errno = EIO, -1; };
  EXPECT_EQ(attempt(), 74);
  expect_old_target_intact();

  file_calls() = calls_;
  file_calls().close = [](int fd) { return ::close(fd), errno = EDQUOT, -1; };
  EXPECT_EQ(attempt(), 74);
  expect_old_target_intact();

  file_calls() = calls_;
  file_calls().rename = [](const char*, const char*) { return errno = EXDEV, -1; };
  EXPECT_EQ(attempt(), 74);
  expect_old_target_intact();

  // The folder's fsync comes after the rename: reported, and the new file is there.
  file_calls() = calls_;
  file_calls().fsync = [](int fd) { return g_step_calls++ == 0 ? ::fsync(fd) : (errno = EIO, -1); };
  g_step_calls = 0;
  EXPECT_EQ(attempt(), 74);
  EXPECT_EQ(content(folder_ / "target"), "new bytes");
  EXPECT_EQ(files(), 1);
}

TEST_F(WriteFile, OpenFailsWith73) {
  write_file(folder_ / "target", "old");
  file_calls().open = [](const char*, int, unsigned) { return errno = EROFS, -1; };
  EXPECT_EQ(code([&] { write_file(folder_ / "target", "new"); }), 73);
  expect_old_target_intact();
}

TEST_F(WriteFile, ShortWritesAndInterruptionsGoOn) {
  file_calls().write = [](int fd, const void* data, std::size_t size) -> long {
    if (g_step_calls++ % 2 == 0) return errno = EINTR, -1;
    return ::write(fd, data, std::min<std::size_t>(size, 2));
  };
  file_calls().fsync = [](int fd) { return g_step_calls++ % 2 == 0 ? (errno = EINTR, -1) : ::fsync(fd); };
  g_step_calls = 0;
  write_file(folder_ / "target", "all of this");
  EXPECT_EQ(content(folder_ / "target"), "all of this");
}

TEST_F(WriteFile, WhereItCannotBeCreated) {
  EXPECT_EQ(code([&] { write_file(folder_ / "missing" / "target", "x"); }), 73);
  EXPECT_EQ(code([&] { write_file(folder_, "x"); }), 73);
  EXPECT_EQ(code([&] { write_file(folder_ / "", "x"); }), 73);
  write_file(folder_ / "file", "x");
  EXPECT_EQ(code([&] { write_file(folder_ / "file" / "target", "x"); }), 73);
  if (::geteuid() != 0) {
    fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_EQ(code([&] { write_file(folder_ / "target", "x"); }), 73);
    EXPECT_EQ(code([&] { make_output_folder(folder_); }), 73);
    fs::permissions(folder_, fs::perms::owner_all);
  }
  EXPECT_EQ(code([&] { write_file("/proc/trephine", "x"); }), 73);  // a file system that nobody can create files in
  EXPECT_EQ(files(), 1);
}

TEST_F(WriteFile, DevicesAreWrittenStraight) {
  write_file("/dev/null", "x");
  EXPECT_EQ(code([] { write_file("/dev/full", "x"); }), 74);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(WriteFile, SymbolicLinksStay) {
  fs::create_directory(folder_ / "real");
  write_file(folder_ / "real" / "target", "old");
  fs::create_symlink("real/target", folder_ / "link");
  write_file(folder_ / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(content(folder_ / "real" / "target"), "new");
}

// Who puts a link where another writes would choose what is overwritten.
TEST_F(WriteFile, ALinkIsReplacedWhereNobodyMeantIt) {
  fs::create_directory(folder_ / "real");
  write_file(folder_ / "real" / "target", "old");
  fs::create_symlink("real/target", folder_ / "link");
  write_file(folder_ / "link", "new", Links::replaced);
  EXPECT_FALSE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(content(folder_ / "link"), "new");
  EXPECT_EQ(content(folder_ / "real" / "target"), "old");
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  write_file(folder_ / "pipe", "new", Links::replaced);  // and does not wait for whoever reads it
  EXPECT_EQ(content(folder_ / "pipe"), "new");
  if (::geteuid() != 0) return;
  fs::create_symlink("real/target", folder_ / "planted");
  ASSERT_EQ(::lchown((folder_ / "planted").c_str(), 65534, 65534), 0);
  write_file(folder_ / "planted", "new");
  EXPECT_FALSE(fs::is_symlink(folder_ / "planted"));
  EXPECT_EQ(content(folder_ / "real" / "target"), "old");
}

TEST_F(WriteFile, APrivateFolderIsOfItsOwnerAlone) {
  const mode_t before = ::umask(0);
  make_private_folder(folder_ / "library" / ".library");
  ::umask(before);
  struct stat s {};
  ASSERT_EQ(::stat((folder_ / "library" / ".library").c_str(), &s), 0);
  EXPECT_EQ(s.st_mode & 07777, 0700u);
  fs::create_directory(folder_ / "elsewhere");
  fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "link");
  EXPECT_EQ(code([this] { make_private_folder(folder_ / "link"); }), 73);
}

TEST_F(WriteFile, FileSizeLimitIs74) {
  write_file(folder_ / "target", "old");
  const pid_t pid = ::fork();  // the limit is for one's whole process
  if (pid == 0) {
    const rlimit limit{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    ::_exit(code([&] { write_file(folder_ / "target", std::string(100000, 'x')); }));
  }
  int status = 0;
  ASSERT_EQ(::waitpid(pid, &status, 0), pid);
  ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 74);
  expect_old_target_intact();
}

TEST_F(WriteFile, StaleTemporariesAreRemoved) {
  write_file(folder_ / "target", "old");
  const pid_t pid = ::fork();
  if (pid == 0) {
    FileWriter w(folder_ / "target");
    w.write("half");
    ::kill(::getpid(), SIGKILL);
  }
  // Nobody has asked for it yet: it has ended all the same.
  siginfo_t ended{};
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(pid), &ended, WEXITED | WNOWAIT), 0);
  EXPECT_EQ(files(), 2);
  FileWriter mine(folder_ / "target");
  std::ofstream(folder_ / (std::string(temporary_prefix) + "x-1-notours")) << "x";
  EXPECT_EQ(files(), 4);
  EXPECT_EQ(remove_stale_temporaries(folder_), 1);
  EXPECT_EQ(files(), 3);
  int status = 0;
  ASSERT_EQ(::waitpid(pid, &status, 0), pid);

  // Held locked by somebody whose number means nothing here: another host, another container.
  const fs::path foreign = folder_ / (std::string(temporary_prefix) + std::to_string(pid) + "-7-foreign");
  {
    FileWriter w(foreign);
    w.commit();
  }
  {
    const int fd = ::open(foreign.c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_EQ(::flock(fd, LOCK_EX), 0);
    EXPECT_EQ(remove_stale_temporaries(folder_), 0);
    ::close(fd);
  }
  EXPECT_EQ(remove_stale_temporaries(folder_), 1);
  EXPECT_EQ(remove_stale_temporaries(folder_ / "missing"), 0);
}

TEST_F(WriteFile, ReadsAndRefuses) {
  write_file(folder_ / "a", "12345");
  EXPECT_EQ(content(folder_ / "a"), "12345");
  EXPECT_EQ(read_file(folder_ / "a", 5).size(), 5u);
  EXPECT_EQ(code([&] { read_file(folder_ / "a", 4); }), 65);
  EXPECT_EQ(code([&] { read_file(folder_ / "b"); }), 66);
  EXPECT_EQ(code([&] { read_file(folder_); }), 66);
  EXPECT_EQ(code([&] { read_file("/dev/zero"); }), 66);
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(code([&] { read_file(folder_ / "pipe"); }), 66);
  EXPECT_EQ(code([&] { sha256_of_file(folder_ / "b"); }), 66);
  EXPECT_EQ(sha256_of_file(folder_ / "a"), sha256_of_bytes("12345"));
}

TEST_F(WriteFile, OutputFolders) {
  make_output_folder(folder_ / "a" / "b");
  make_output_folder(folder_ / "a" / "b");
  EXPECT_TRUE(fs::is_directory(folder_ / "a" / "b"));
  write_file(folder_ / "file", "x");
  EXPECT_EQ(code([&] { make_output_folder(folder_ / "file"); }), 73);
  EXPECT_EQ(code([&] { make_output_folder(folder_ / "file" / "a"); }), 73);
  EXPECT_EQ(code([&] { make_output_folder("/proc/trephine"); }), 73);
}

}  // namespace
}  // namespace trephine
