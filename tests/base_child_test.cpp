// SPDX-License-Identifier: GPL-3.0-or-later
// The bounded child: whatever the worker does, the parent survives, says what happened, and keeps no process and no
// descriptor.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <new>
#include <stdexcept>
#include <thread>

#include "base/child.h"
#include "base/child_message.h"
#include "base/child_protocol.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"

namespace trephine {
namespace {

const ChildWorker echo("test-echo", [](ChildRequest& r) {
  // In pieces of odd sizes, small and large.
  std::size_t size = 1;
  for (std::string_view rest = r.request(); !rest.empty(); size = size * 3 + 1) {
    const std::string_view piece = rest.substr(0, size);
    r.write(piece.data(), piece.size());
    rest.remove_prefix(piece.size());
  }
});
const ChildWorker misbehave("test-misbehave", [](ChildRequest& r) {
  const std::string how(r.request());
  if (how == "abort") std::abort();
  if (how == "segv") std::raise(SIGSEGV);
  if (how == "exit") ::_exit(3);
  if (how == "exit0") ::_exit(0);
  if (how == "error") throw Error(ExitCode::bad_input, "a.dcm", "0028,0010", "rows\n0 \xc3\xa9").in_case("c1");
  if (how == "foreign") throw std::out_of_range("DOE^JOHN");
  if (how == "odd") throw 7;
  if (how == "chatter") {
    std::cout << "DOE^JOHN" << std::endl;
    std::cerr << "DOE^JOHN" << std::endl;
    std::fputs("DOE^JOHN\n", stderr);
  }
  if (how == "spin")
    for (volatile int i = 0;; i = i + 1) {
    }
  if (how == "sleep") std::this_thread::sleep_for(std::chrono::hours(1));
  if (how == "allocate")
    for (;;) std::memset(::operator new(1 << 24), 1, 1 << 24);
  if (how == "write") {
    const std::string block(1 << 22, 'x');
    for (;;) r.write(block.data(), block.size());
  }
  if (how == "nonsense") (void)!::write(child_pipe_fd, "\xff\xff\xff\xff\xff\xff\xff\xff", 8);
  if (how == "orphan") {
    const pid_t pid = ::fork();
    if (pid == 0) std::this_thread::sleep_for(std::chrono::hours(1));
    r.write(&pid, sizeof pid);
  }
  if (how == "inspect") {
    int more = 0;
    for (int fd = child_pipe_fd + 1; fd < 1024; ++fd) more += ::fcntl(fd, F_GETFD) >= 0;
    std::string found = std::to_string(more);
    struct sigaction a {};
    sigaction(SIGPIPE, nullptr, &a);
    found += a.sa_handler == SIG_DFL ? " default" : " not default";
    r.write(found.data(), found.size());
  }
  if (how == "progress")
    for (int i = 0; i <= 10; ++i) {
      r.report(i / 10.0);
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
    }
});

int count_of(const char* folder) {
  int n = 0;
  for (auto it = std::filesystem::directory_iterator(folder); it != std::filesystem::directory_iterator(); ++it) ++n;
  return n;
}

// Within minutes, for a busy machine. A zombie that nobody reaps in this container counts as dead.
bool dies(pid_t pid) {
  const auto alive = [pid] {
    std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
    std::string number, name, state;
    return (stat >> number >> name >> state) && state != "Z" && state != "X";
  };
  for (int i = 0; i < 30000 && alive(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return !alive();
}

class Child : public testing::Test {
 protected:
  void SetUp() override { descriptors_ = count_of("/proc/self/fd"); }
  void TearDown() override {
    EXPECT_EQ(count_of("/proc/self/fd"), descriptors_);
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a zombie or a child is left";
    EXPECT_EQ(errno, ECHILD);
  }
  // The what of the Error 70 that comes.
  static std::string death(const char* how, ChildLimits limits = {}) {
    try {
      run_child("test-misbehave", how, limits);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::internal);
      EXPECT_EQ(e.field(), "test-misbehave");
      return e.what();
    }
    return "no error";
  }
  int descriptors_ = 0;
};

TEST(ChildMessage, ComesApartAsItWasPutTogether) {
  MessageWriter out;
  out.number(7);
  out.text("seven");
  out.array(std::vector<double>{0.5, -1});
  out.array(std::vector<double>{});
  out.value(true);
  MessageReader in("w", out.bytes());
  EXPECT_EQ(in.number(), 7u);
  EXPECT_EQ(in.text(), "seven");
  EXPECT_EQ(in.array<double>(), (std::vector<double>{0.5, -1}));
  EXPECT_TRUE(in.array<double>().empty());
  EXPECT_FALSE(in.empty());
  EXPECT_TRUE(in.value<bool>());
  EXPECT_TRUE(in.empty());
  EXPECT_THROW(in.number(), Error);
}

TEST(ChildMessage, TrustsNoLength) {
  for (const std::uint64_t length : {std::uint64_t{2}, std::uint64_t{1} << 61, ~std::uint64_t{0}}) {
    MessageWriter out;
    out.number(length);
    out.value('x');
    EXPECT_THROW(MessageReader("w", out.bytes()).text(), Error);
    EXPECT_THROW(MessageReader("w", out.bytes()).array<double>(), Error);
    EXPECT_THROW(MessageReader("w", std::string_view(out.bytes()).substr(0, 5)).text(), Error);
  }
}

TEST_F(Child, CarriesRequestAndResult) {
  std::string request(100'000'000, '\0');
  for (std::size_t i = 0; i < request.size(); ++i) request[i] = static_cast<char>(i * 2654435761u >> 13);
  const ChildResult result = run_child("test-echo", request, {});
  ASSERT_EQ(result.bytes().size(), request.size());
  EXPECT_TRUE(result.bytes() == request);
}

TEST_F(Child, EmptyAndMoved) {
  ChildResult result = run_child("test-echo", "", {});
  EXPECT_EQ(result.bytes().size(), 0u);
  result = run_child("test-echo", "abc", {});
  const ChildResult moved = std::move(result);
  EXPECT_EQ(moved.bytes(), "abc");
}

TEST_F(Child, AnErrorArrivesWhole) {
  try {
    run_child("test-misbehave", "error", {});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    EXPECT_EQ(e.case_token(), "c1");
    EXPECT_EQ(e.file(), "a.dcm");
    EXPECT_EQ(e.field(), "0028,0010");
    EXPECT_STREQ(e.what(), "rows\n0 \xc3\xa9");
  }
}

TEST_F(Child, DeathsAreNamed) {
  EXPECT_EQ(death("abort"), "the child was killed by signal 6");
  if (!built_with_sanitizer) {
    EXPECT_EQ(death("segv"), "the child was killed by signal 11");
  }
  EXPECT_EQ(death("exit"), "the child ended with status 3 and no result");
  EXPECT_EQ(death("exit0"), "the child ended with status 0 and no result");
  EXPECT_EQ(death("odd"), "the child ended with status 1 and no result");
  EXPECT_EQ(death("nonsense"), "the child sent nonsense");
  EXPECT_EQ(death("foreign"), "unexpected exception of type std::out_of_range");
  EXPECT_THROW(run_child("test-nobody", "", {}), Error);
}

TEST_F(Child, LimitsHold) {
  ChildLimits wall;
  wall.wall_s = 0.3;
  // Both would go on for an hour: that they come to an end is all that a busy machine can be asked for.
  EXPECT_EQ(death("spin", wall), "wall clock limit 0.3 s reached");
  EXPECT_EQ(death("sleep", wall), "wall clock limit 0.3 s reached");
  ChildLimits cpu;
  cpu.cpu_s = 1;
  EXPECT_EQ(death("spin", cpu), "CPU time limit 1 s reached");
  ChildLimits memory;
  memory.memory_bytes = std::uint64_t{512} << 20;
  EXPECT_EQ(death("write", memory), "memory limit 512 MiB reached");
  if (!built_with_sanitizer) {
    EXPECT_EQ(death("allocate", memory), "memory limit 512 MiB reached");
  }
}

TEST_F(Child, ChatterIsNotHeard) {
  if (built_with_sanitizer) GTEST_SKIP() << "a sanitizer's reports need stderr";
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  run_child("test-misbehave", "chatter", {});
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(Child, InheritsNothing) {
  const int leaky = ::dup(1);  // without O_CLOEXEC, as libraries open theirs
  std::signal(SIGPIPE, SIG_IGN);
  EXPECT_EQ(run_child("test-misbehave", "inspect", {}).bytes(), "0 default");
  std::signal(SIGPIPE, SIG_DFL);
  ::close(leaky);
}

TEST_F(Child, ReportsProgress) {
  double last = -1;
  int calls = 0;
  const auto sink = [&](double f) {
    ++calls;
    EXPECT_GE(f, last);
    last = f;
  };
  run_child("test-misbehave", "progress", {}, Progress(sink, nullptr));
  EXPECT_GE(calls, 3);
  EXPECT_EQ(last, 1);
}

TEST_F(Child, CancelKills) {
  std::atomic<bool> cancel{false};
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    cancel = true;
  });
  EXPECT_THROW(run_child("test-misbehave", "sleep", {}, Progress({}, &cancel)), Cancelled);  // and not in an hour
  later.join();
  // Also from the sink, in the middle of the messages.
  EXPECT_THROW(run_child("test-misbehave", "progress", {}, Progress([](double) { throw Cancelled{}; }, nullptr)),
               Cancelled);
}

TEST_F(Child, AnOrphanOfTheChildDies) {
  const ChildResult result = run_child("test-misbehave", "orphan", {});
  pid_t orphan = 0;
  ASSERT_EQ(result.bytes().size(), sizeof orphan);
  std::memcpy(&orphan, result.bytes().data(), sizeof orphan);
  EXPECT_TRUE(dies(orphan));
}

TEST_F(Child, ManyAtOnce) {
  std::atomic<int> good{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 50; ++t)
    threads.emplace_back([&good, t] {
      const std::string request(100'000, static_cast<char>('0' + t));
      good += run_child("test-echo", request, {}).bytes() == request;
    });
  for (auto& t : threads) t.join();
  EXPECT_EQ(good, 50);
}

// Killing the parent (here: a copy of this test that runs one child that sleeps) leaves no child.
const ChildWorker sleeper("test-sleeper", [](ChildRequest& r) {
  write_file(std::string(r.request()), std::to_string(::getpid()));
  std::this_thread::sleep_for(std::chrono::hours(1));
});
const ChildWorker parent_of_sleeper("test-parent-of-sleeper",
                                    [](ChildRequest& r) { run_child("test-sleeper", r.request(), {}); });

TEST_F(Child, DiesWithItsParent) {
  const std::string file = testing::TempDir() + "trephine-sleeper-" + std::to_string(::getpid());
  std::atomic<bool> cancel{false};
  std::thread parent(
      [&] { EXPECT_THROW(run_child("test-parent-of-sleeper", file, {}, Progress({}, &cancel)), Cancelled); });
  pid_t pid = 0;
  for (int i = 0; i < 30000 && !(std::ifstream(file) >> pid); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_GT(pid, 0);
  EXPECT_EQ(::kill(pid, 0), 0);
  cancel = true;  // SIGKILL to the middle process
  parent.join();
  EXPECT_TRUE(dies(pid));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace trephine
