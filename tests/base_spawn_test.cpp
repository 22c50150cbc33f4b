// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>

#include "base/error.h"
#include "base/file_descriptor.h"
#include "base/spawn.h"
#include "base/write_file.h"
#include "scratch_folder.h"

using namespace trephine;

namespace {

std::string text_of(const std::filesystem::path& file) {
  const std::vector<char> bytes = read_file(file);
  return {bytes.begin(), bytes.end()};
}

TEST(Spawn, GivesWhatIsNamedAndNothingElse) {
  const ScratchFolder folder;
  write_file(folder.path() / "given", "given");
  const FileDescriptor given(::open((folder.path() / "given").c_str(), O_RDONLY));
  const FileDescriptor high(::fcntl(given.get(), F_DUPFD, 20));  // inherited, were it not closed
  SpawnRequest request;
  request.argv = {"sh", "-c", "cat <&3; echo \" $word\" >&2; pwd; ls /proc/self/fd | wc -l; ulimit -c; exit 7"};
  request.folder = "/";
  request.output = folder.path() / "out";
  request.environment = {{"word", "said"}};
  request.descriptors = {high.get()};
  request.core_file = false;
  const Ended end = wait_for(spawn(request), until_it_ends_s);
  EXPECT_EQ(end.code, 7);
  EXPECT_EQ(end.signal, 0);
  EXPECT_EQ(text_of(request.output), "given said\n/\n5\n0\n");  // 0 to 3 and that of ls itself
}

TEST(Spawn, SaysWhyItCannot) {
  SpawnRequest request;
  request.argv = {"no-such-program-of-ours"};
  try {
    spawn(request);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::internal);
    EXPECT_EQ(e.file(), "no-such-program-of-ours");
    EXPECT_STREQ(e.what(), "cannot be started: No such file or directory");
  }
}

TEST(Spawn, BlockedAndIgnoredSignalsReachTheProgram) {
  sigset_t blocked, before;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &blocked, &before);
  const auto handler = std::signal(SIGTERM, SIG_IGN);
  SpawnRequest request;
  request.argv = {"sh", "-c", "kill -TERM $$; sleep 60"};
  const Ended end = wait_for(spawn(request), 30);
  std::signal(SIGTERM, handler);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  EXPECT_EQ(end.signal, SIGTERM);
}

}  // namespace
