// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/lease.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>
#include <vector>

#include "base/error.h"

namespace trephine {
namespace fs = std::filesystem;
namespace {

constexpr const char *free_name = "free", *held_prefix = "held-";
constexpr int tries = 100;
constexpr double second_look_s = 1;

std::string random_digits() {
  std::random_device source;
  char text[17];
  std::snprintf(text, sizeof text, "%08x%08x", static_cast<unsigned>(source()), static_cast<unsigned>(source()));
  return text;
}

// Where a process runs: the start of this host's kernel, and the namespace in which its number counts.
std::string place_of_processes() {
  std::string boot, space;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  std::error_code ignored;
  const std::string link = fs::read_symlink("/proc/self/ns/pid", ignored).string();
  std::copy_if(link.begin(), link.end(), std::back_inserter(space), [](char c) { return c >= '0' && c <= '9'; });
  boot.erase(std::remove(boot.begin(), boot.end(), '-'), boot.end());
  return boot.empty() || space.empty() ? "" : boot + "." + space;
}

struct Process {
  bool known = false;  // its line in /proc could be read
  bool ended = false;
  std::string start;  // in ticks after the start of the kernel
};
Process look_at(pid_t pid) {
  Process out;
  if (::kill(pid, 0) != 0 && errno == ESRCH) {
    out.known = out.ended = true;
    return out;
  }
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string line, word;
  if (!std::getline(file, line)) return out;
  const std::size_t name_end = line.rfind(')');
  if (name_end == std::string::npos) return out;
  std::istringstream rest(line.substr(name_end + 1));
  constexpr int state = 1, start = 20;  // counted from the end of the name
  for (int field = 1; rest >> word; ++field) {
    if (field == state) out.ended = word == "Z" || word == "X";
    if (field == start) {
      out.start = word;
      out.known = true;
    }
  }
  return out;
}

// held-BOOT.NAMESPACE-PID-START-RANDOM
std::string new_holder() {
  const pid_t pid = ::getpid();
  const std::string place = place_of_processes();
  return held_prefix + (place.empty() ? "elsewhere" : place) + "-" + std::to_string(pid) + "-" + look_at(pid).start +
         "-" + random_digits();
}

bool has_ended(const std::string& holder) {
  std::vector<std::string> parts;
  std::istringstream in(holder.substr(std::strlen(held_prefix)));
  for (std::string part; std::getline(in, part, '-');) parts.push_back(part);
  if (parts.size() != 4 || place_of_processes().empty() || parts[0] != place_of_processes()) return false;
  const pid_t pid = static_cast<pid_t>(std::strtol(parts[1].c_str(), nullptr, 10));
  if (pid <= 0) return false;
  const Process process = look_at(pid);
  return process.known && (process.ended || process.start != parts[2]);
}

double seconds(const timespec& t) { return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec); }

// When the file was renewed or renamed last, by the file server's clock; negative where it is gone.
double changed_s(int folder, const std::string& name) {
  struct stat s {};
  if (::fstatat(folder, name.c_str(), &s, AT_SYMLINK_NOFOLLOW) != 0) return -1;
  return std::max(seconds(s.st_mtim), seconds(s.st_ctim));
}

// What the file server's clock says now: the time of a file that is made for it. Negative where none can be made.
double server_now_s(int folder) {
  const std::string name = "now-" + random_digits();
  const FileDescriptor fd(::openat(folder, name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  if (!fd.valid()) return -1;
  ::futimens(fd.get(), nullptr);
  struct stat s {};
  const bool good = ::fstat(fd.get(), &s) == 0;
  ::unlinkat(folder, name.c_str(), 0);
  return good ? seconds(s.st_mtim) : -1;
}

// "free", or the holder's name; empty where there is neither.
std::string entry_of(int folder) {
  const int copy = ::openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  DIR* all = copy < 0 ? nullptr : ::fdopendir(copy);
  if (!all) {
    if (copy >= 0) ::close(copy);
    return "";
  }
  std::string found;
  while (const dirent* entry = ::readdir(all)) {
    const std::string name = entry->d_name;
    if (name == free_name || name.rfind(held_prefix, 0) == 0) found = name;
  }
  ::closedir(all);
  return found;
}

Error cannot(const fs::path& folder, int number) {
  return Error(ExitCode::cannot_create, (folder / lease_folder).string(), "", std::strerror(number));
}

}  // namespace

Lease::Lease(const fs::path& folder, double lease_s) : lease_s_(lease_s), name_(new_holder()) {
  Attempt attempt = Attempt::try_again;
  for (int i = 0; attempt == Attempt::try_again && i < tries; ++i) {
    folder_ = FileDescriptor(::open((folder / lease_folder).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW));
    if (!folder_.valid() && errno != ENOENT) throw cannot(folder, errno);
    if (!folder_.valid()) {
      attempt = make_new(folder);
      continue;
    }
    const std::string there = entry_of(folder_.get());
    if (there.empty()) {  // somebody emptied it, or it is gone by now
      ::rmdir((folder / lease_folder).c_str());
      continue;
    }
    attempt = there == free_name || may_be_taken_over(there) ? take(there) : Attempt::busy;
  }
  if (attempt != Attempt::taken)
    throw Error(ExitCode::busy, folder.string(), "", "another process works on it, try again when it is done");
  // The folder may have been renamed or removed meanwhile, with what we took.
  struct stat ours, there;
  if (::fstat(folder_.get(), &ours) != 0 || ::stat((folder / lease_folder).c_str(), &there) != 0 ||
      ours.st_ino != there.st_ino || ours.st_dev != there.st_dev) {
    ::renameat(folder_.get(), name_.c_str(), folder_.get(), free_name);
    throw Error(ExitCode::busy, folder.string(), "", "another process has just left it, try again");
  }
  // Signals go to the threads that were there before.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    renewer_ = std::thread([this] { renew_until_the_end(); });
  } catch (...) {
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    ::renameat(folder_.get(), name_.c_str(), folder_.get(), free_name);
    throw;
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Lease::~Lease() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
  }
  wake_.notify_all();
  renewer_.join();
  ::renameat(folder_.get(), name_.c_str(), folder_.get(), free_name);  // fails where it is not ours any more
}

bool Lease::is_held() const {
  struct stat s {};
  return ::fstatat(folder_.get(), name_.c_str(), &s, AT_SYMLINK_NOFOLLOW) == 0;
}

// The folder appears with our file in it: a rename onto a folder that holds a file fails.
Lease::Attempt Lease::make_new(const fs::path& folder) {
  const fs::path made = folder / (std::string(lease_folder) + "-" + random_digits());
  if (::mkdir(made.c_str(), 0755) != 0) throw cannot(folder, errno);
  const FileDescriptor fd(::open((made / name_).c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
  const int no_file = fd.valid() ? 0 : errno;
  const bool renamed = fd.valid() && ::rename(made.c_str(), (folder / lease_folder).c_str()) == 0;
  const int reason = no_file ? no_file : errno;
  if (renamed) {
    folder_ = FileDescriptor(::open((folder / lease_folder).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW));
    if (folder_.valid()) file_ = FileDescriptor(::openat(folder_.get(), name_.c_str(), O_WRONLY | O_CLOEXEC));
    return file_.valid() ? Attempt::taken : Attempt::try_again;
  }
  ::unlink((made / name_).c_str());
  ::rmdir(made.c_str());
  if (reason != ENOTEMPTY && reason != EEXIST) throw cannot(folder, reason);
  return Attempt::try_again;
}

Lease::Attempt Lease::take(const std::string& from) {
  const bool renamed = ::renameat(folder_.get(), from.c_str(), folder_.get(), name_.c_str()) == 0;
  // An answer that NFS lost is asked for again, and then says that there is nothing to rename.
  if (!renamed && errno != ENOENT) throw cannot("", errno);
  if (!renamed && !is_held()) return Attempt::try_again;
  file_ = FileDescriptor(::openat(folder_.get(), name_.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file_.valid()) return Attempt::try_again;
  ::futimens(file_.get(), nullptr);
  return is_held() ? Attempt::taken : Attempt::try_again;
}

bool Lease::may_be_taken_over(const std::string& holder) const {
  if (has_ended(holder)) return true;
  const auto is_old = [&] {
    const double now_s = server_now_s(folder_.get()), then_s = changed_s(folder_.get(), holder);
    return now_s >= 0 && then_s >= 0 && now_s - then_s > lease_s_;
  };
  if (!is_old()) return false;
  // Who has just taken it renews it a moment after the rename, which some servers do not count as a change.
  std::this_thread::sleep_for(std::chrono::duration<double>(std::min(second_look_s, lease_s_ / 2)));
  return is_old();
}

void Lease::renew_until_the_end() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!wake_.wait_for(lock, std::chrono::duration<double>(lease_s_ / 4), [this] { return ends_; }))
    ::futimens(file_.get(), nullptr);
}

bool is_on_network(const fs::path& file) {
  struct statfs s {};
  if (::statfs(file.c_str(), &s) != 0) return false;
  // NFS, SMB (1, 2), CIFS, Lustre, BeeGFS, GPFS, Ceph, AFS, FUSE
  static const std::array<unsigned long, 10> types = {0x6969,     0x517B,     0xFE534D42, 0xFF534D42, 0x0BD00BD0,
                                                      0x19830326, 0x47504653, 0x00C36400, 0x5346414F, 0x65735546};
  return std::find(types.begin(), types.end(), static_cast<unsigned long>(s.f_type) & 0xFFFFFFFFul) != types.end();
}

}  // namespace trephine
