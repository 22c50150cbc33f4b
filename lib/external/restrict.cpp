// SPDX-License-Identifier: GPL-3.0-or-later
#include "external/restrict.h"

#include <fcntl.h>
#include <linux/landlock.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <set>

#include "base/error.h"

namespace trephine::external {
namespace {

/// Newer than Debian 12's header; the kernel says by its version whether it knows them.
constexpr std::uint64_t access_refer = 1ULL << 13, access_truncate = 1ULL << 14;
constexpr std::uint64_t access_write = LANDLOCK_ACCESS_FS_WRITE_FILE,
                        access_make = LANDLOCK_ACCESS_FS_REMOVE_DIR | LANDLOCK_ACCESS_FS_REMOVE_FILE |
                                      LANDLOCK_ACCESS_FS_MAKE_CHAR | LANDLOCK_ACCESS_FS_MAKE_DIR |
                                      LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_SOCK |
                                      LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_BLOCK |
                                      LANDLOCK_ACCESS_FS_MAKE_SYM;

bool write_text(const char* file, const std::string& text) {
  const int fd = open(file, O_WRONLY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool good = write(fd, text.data(), text.size()) == ssize_t(text.size());
  close(fd);
  return good;
}

/// Programs of several processes may talk to each other through it.
void bring_up_loopback() {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return;
  ifreq request{};
  std::strcpy(request.ifr_name, "lo");
  if (ioctl(fd, SIOCGIFFLAGS, &request) == 0) {
    request.ifr_flags = short(request.ifr_flags | IFF_UP);
    ioctl(fd, SIOCSIFFLAGS, &request);
  }
  close(fd);
}

void keep_numbers(uid_t user, gid_t group) {
  const auto map = [](unsigned id) { return std::to_string(id) + " " + std::to_string(id) + " 1"; };
  write_text("/proc/self/setgroups", "deny");
  if (!write_text("/proc/self/uid_map", map(user)) || !write_text("/proc/self/gid_map", map(group)))
    throw Error(ExitCode::internal, "", "external",
                std::string("the namespace takes no user: ") + std::strerror(errno));
}

/// The socket files that processes of this network namespace listen on, or have bound.
std::set<std::string> socket_files() {
  std::set<std::string> files;
  std::ifstream table("/proc/net/unix");
  for (std::string line; std::getline(table, line);)
    if (const auto at = line.find(" /"); at != std::string::npos) files.insert(line.substr(at + 1));
  return files;
}

/// Lays something else over what must not be reached. The mounts are seen by this process and its children alone.
std::string hide_services(const std::set<std::string>& sockets, std::uint64_t shared_memory_bytes) {
  const auto fault = [](const std::string& what) { return what + " cannot be hidden: " + std::strerror(errno); };
  if (mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return fault("services");
  const std::string size = "mode=1777,size=" + std::to_string(shared_memory_bytes);
  if (access("/dev/shm", F_OK) == 0 &&
      mount("tmpfs", "/dev/shm", "tmpfs", MS_NOSUID | MS_NODEV | MS_NOEXEC, size.c_str()) != 0)
    return fault("/dev/shm");
  for (const std::string& file : sockets)  // one that is gone, or in a folder closed to the user, needs no hiding
    if (mount("/dev/null", file.c_str(), nullptr, MS_BIND, nullptr) != 0 && errno != ENOENT && errno != EACCES &&
        errno != ENOTDIR)
      return fault("a socket file");
  return "";
}

}  // namespace

Separation separate(std::uint64_t shared_memory_bytes) {
  const uid_t user = geteuid();
  const gid_t group = getegid();
  prctl(PR_SET_DUMPABLE, 1);  // else /proc/self is root's, and the numbers cannot be said
  Separation made;
  made.services_open = "no mount namespace";
  const std::set<std::string> sockets = socket_files();
  if (unshare(CLONE_NEWUSER | CLONE_NEWNET | CLONE_NEWPID | CLONE_NEWIPC | CLONE_NEWNS) == 0) {
    keep_numbers(user, group);
    bring_up_loopback();
    made.services_open = hide_services(sockets, shared_memory_bytes);
  } else if (unshare(CLONE_NEWUSER | CLONE_NEWNET | CLONE_NEWPID | CLONE_NEWIPC) == 0 ||
             unshare(CLONE_NEWUSER | CLONE_NEWNET) == 0) {
    keep_numbers(user, group);
    bring_up_loopback();
  } else if (const int why = errno; unshare(CLONE_NEWNET) == 0) {
    bring_up_loopback();
  } else {
    made.network_open = std::string("no user namespace: ") + std::strerror(why);
  }
  return made;
}

Restriction::Restriction(const std::vector<std::string>& may_write) {
  const long version = syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  if (version < 1) {
    open_ = std::string("no Landlock: ") + std::strerror(errno);
    return;
  }
  std::uint64_t handled = access_write | access_make;
  if (version >= 2) handled |= access_refer;
  if (version >= 3) handled |= access_truncate;
  landlock_ruleset_attr rules{};
  rules.handled_access_fs = handled;
  rules_ = int(syscall(SYS_landlock_create_ruleset, &rules, sizeof rules.handled_access_fs, 0));
  if (rules_ < 0) {
    open_ = std::string("no Landlock: ") + std::strerror(errno);
    return;
  }
  fcntl(rules_, F_SETFD, FD_CLOEXEC);
  const auto allow = [&](const std::string& path, std::uint64_t access) {
    const int fd = ::open(path.c_str(), O_PATH | O_CLOEXEC);
    if (fd < 0) return false;
    landlock_path_beneath_attr rule{};
    rule.allowed_access = access;
    rule.parent_fd = fd;
    const bool good = syscall(SYS_landlock_add_rule, rules_, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
    close(fd);
    return good;
  };
  for (const std::string& folder : may_write)
    if (!allow(folder, handled)) throw Error(ExitCode::no_input, folder, "may_write", std::strerror(errno));
  if (version < 3) open_ = "Landlock of this kernel does not stop that files are cut short; Linux 6.2 does";
  allow("/dev", access_write | (handled & access_truncate));
  allow("/dev/shm", handled);  // semaphores of programs with several processes
}

Restriction::~Restriction() {
  if (rules_ >= 0) close(rules_);
}

bool Restriction::enter() const {
  for (int capability = 0; capability < 64; ++capability) prctl(PR_CAPBSET_DROP, capability, 0, 0, 0);
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return false;
  return rules_ < 0 || syscall(SYS_landlock_restrict_self, rules_, 0) == 0;
}

}  // namespace trephine::external
