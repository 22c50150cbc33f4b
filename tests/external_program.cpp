// SPDX-License-Identifier: GPL-3.0-or-later
// external_program MODE INPUT OUTPUT [MORE]: a stand-in for a program that labels scans, and all that can be wrong with
// one. `good` labels what is above 300 HU with 2, and what else is above -200 HU with 1.
#include <arpa/inet.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/un.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <thread>
#include <vector>

#include "base/error.h"
#include "grid/nifti.h"
#include "grid/nrrd.h"

using namespace trephine;

namespace {

void write(const std::string& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

grid::Mask labelled(const std::string& input) {
  std::ifstream in(input, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const grid::HuVolume volume = grid::to_hu(grid::decode_nifti(bytes).grid);
  grid::Mask labels(grid::lattice_of(volume));
  std::visit(
      [&](const auto& g) {
        for (std::size_t i = 0; i < g.voxels.size(); ++i) labels.voxels[i] = g.voxels[i] > 300 ? 2 : g.voxels[i] > -200;
      },
      volume);
  return labels;
}

/// Exit code 0 where there is a way out of this machine: a datagram can be sent without anybody listening.
int try_network() {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(9);
  inet_pton(AF_INET, "192.0.2.1", &to.sin_addr);
  return fd >= 0 && connect(fd, reinterpret_cast<sockaddr*>(&to), sizeof to) == 0 ? 0 : 1;
}

}  // namespace

/// A leak checker reads the process as ptrace does, which a confined program may not.
extern "C" const char* __asan_default_options() { return "detect_leaks=0"; }

int main(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], "--version") == 0) return std::cout << "labeller 1.7 (test)\nmore\n", 0;
  if (argc < 4) return 64;
  const std::string mode = argv[1], input = argv[2], output = argv[3], more = argc > 4 ? argv[4] : "";
  if (mode == "good") {
    write(output, grid::encode_nifti(labelled(input), true));
  } else if (mode == "sleep") {
    if (fork() == 0) {  // a child that tries to outlive it
      setsid();
      signal(SIGTERM, SIG_IGN);
      write(more, std::to_string(getpid()));
    }
    std::this_thread::sleep_for(std::chrono::seconds(600));
  } else if (mode == "orphan") {  // ends well, and leaves a process behind
    if (fork() == 0) {
      setsid();
      std::this_thread::sleep_for(std::chrono::seconds(3));
      write(more, "alive");
      return 0;
    }
    write(output, grid::encode_nifti(labelled(input), true));
  } else if (mode == "memory") {
    std::vector<std::vector<char>> held;
    for (int i = 0; i < 100; ++i) {
      held.emplace_back(std::size_t{20} << 20, char(i));
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    std::this_thread::sleep_for(std::chrono::seconds(600));
  } else if (mode == "garbage") {
    write(output, std::string(5000, 'x'));
  } else if (mode == "partial") {
    const std::string whole = grid::encode_nifti(labelled(input), true);
    write(output, whole.substr(0, whole.size() / 2));
  } else if (mode == "grid") {
    const grid::Mask all = labelled(input);
    grid::Lattice half = all;
    half.size[2] /= 2;
    grid::Mask part(half);
    std::copy_n(all.voxels.begin(), part.voxels.size(), part.voxels.begin());
    write(output, grid::encode_nifti(part, true));
  } else if (mode == "moved") {
    grid::Mask all = labelled(input);
    all.origin_mm.x += 0.5 * all.spacing_mm.x;
    write(output, grid::encode_nifti(all, true));
  } else if (mode == "empty") {
    write(output, grid::encode_nifti(grid::Mask(static_cast<const grid::Lattice&>(labelled(input))), true));
  } else if (mode == "fraction") {
    grid::Field half(static_cast<const grid::Lattice&>(labelled(input)), 0.5f);
    write(output, grid::encode_nifti(grid::HuVolume(half), true));
  } else if (mode == "nothing") {
  } else if (mode == "code") {
    std::cerr << "loading\n\nno model: \x1b[31mweights missing\n";
    return 3;
  } else if (mode == "crash") {
    raise(SIGSEGV);
  } else if (mode == "link") {
    return symlink("/etc/passwd", output.c_str());
  } else if (mode == "fifo") {
    return mkfifo(output.c_str(), 0600);
  } else if (mode == "network") {
    if (try_network() == 0) return 5;
    write(output, grid::encode_nifti(labelled(input), true));
  } else if (mode == "outside") {  // writes where it may not, and where it may
    write(more, "written");
    write(std::string(getenv("HOME")) + "/note", "written");
    if (!std::ifstream(std::string(getenv("HOME")) + "/note")) return 6;
    write(output, grid::encode_nifti(labelled(input), true));
  } else if (mode == "attributes") {  // changes a file that it may read, and one of its own
    const std::string own = std::string(getenv("HOME")) + "/note";
    write(own, "written");
    const timespec times[2] = {{1, 0}, {1, 0}};
    if (chmod(more.c_str(), 0777) == 0) return 11;
    if (utimensat(AT_FDCWD, more.c_str(), times, 0) == 0) return 12;
    if (setxattr(more.c_str(), "user.note", "x", 1, 0) == 0) return 13;
    if (chown(more.c_str(), getuid(), getgid()) == 0) return 14;
    if (chmod(own.c_str(), 0700) != 0 || utimensat(AT_FDCWD, own.c_str(), times, 0) != 0) return 15;
    write(output, grid::encode_nifti(labelled(input), true));
  } else if (mode == "processes") {  // looks for a process by its command line, and into it
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      std::ifstream in(entry.path() / "cmdline", std::ios::binary);
      const std::string line{std::istreambuf_iterator<char>(in), {}};
      if (line.find("external_test") != std::string::npos) return 21;
    }
    if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) == 0) return 22;
    if (unshare(CLONE_NEWUSER) == 0) return 23;
    if (mount("none", "/tmp", "tmpfs", 0, nullptr) == 0) return 24;
    char byte = 0;
    iovec here{&byte, 1}, there{&byte, 1};
    if (process_vm_readv(getpid(), &here, 1, &there, 1, 0) >= 0) return 25;
#ifdef SYS_io_uring_setup
    char ring[256] = {};  // of struct io_uring_params; its operations would pass by the filter
    if (syscall(SYS_io_uring_setup, 1, ring) >= 0 || errno != EPERM) return 26;
#endif
    std::thread([] {}).join();  // what it needs goes on
    if (const pid_t child = fork(); child == 0) _exit(0);
    write(output, grid::encode_nifti(labelled(input), true));
  } else if (mode == "services") {  // speaks to a socket file, and leaves data in shared memory
    sockaddr_un to{};
    to.sun_family = AF_UNIX;
    more.copy(to.sun_path, sizeof to.sun_path - 1);
    const int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    const bool reached = connect(fd, reinterpret_cast<sockaddr*>(&to), sizeof to) == 0;
    const std::string note = "/dev/shm/trephine-external-note";
    write(note, "left");
    if (!std::ifstream(note)) return 6;
    if (reached) return 5;
    write(output, grid::encode_nifti(labelled(input), true));
  } else if (mode == "environment") {
    extern char** environ;
    for (char** e = environ; *e; ++e) std::cout << *e << "\n";
    return getenv("SECRET") ? 7 : getenv("MODEL") && std::string(getenv("MODEL")) == more ? 8 : 9;
  } else {
    return 64;
  }
  return 0;
}
