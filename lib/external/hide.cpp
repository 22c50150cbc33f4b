// SPDX-License-Identifier: GPL-3.0-or-later
#include "external/hide.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace trephine::external {
namespace {

/// As in linux/mount.h (Linux 5.12), which glibc 2.36's sys/mount.h contradicts.
struct MountAttributes {
  std::uint64_t set = 0, clear = 0, propagation = 0, user_namespace = 0;
};
constexpr std::uint64_t read_only = 1;
constexpr unsigned recursive = 0x8000;  // AT_RECURSIVE

bool change_mount(const char* path, unsigned flags, const MountAttributes& attributes) {
#ifdef SYS_mount_setattr
  return syscall(SYS_mount_setattr, AT_FDCWD, path, flags, &attributes, sizeof attributes) == 0;
#else
  errno = ENOSYS;
  return false;
#endif
}

std::string because(const char* what) { return std::string(what) + ": " + std::strerror(errno); }

std::string freeze(const std::vector<std::string>& may_write) {
  // A folder that is mounted on itself has flags of its own.
  for (const std::string& folder : may_write)
    if (mount(folder.c_str(), folder.c_str(), nullptr, MS_BIND | MS_REC, nullptr) != 0)
      return because("its folder cannot be parted from the rest");
  MountAttributes frozen, open;
  frozen.set = read_only;
  open.clear = read_only;
  if (!change_mount("/", recursive, frozen)) return because("file systems cannot be made read-only");
  for (const std::string& folder : may_write)
    if (!change_mount(folder.c_str(), recursive, open)) return because("its folder cannot be opened again");
  if (access("/dev/shm", F_OK) == 0 && !change_mount("/dev/shm", 0, open)) return because("/dev/shm");
  return "";
}

/// System calls by name where this architecture has them.
const std::vector<long>& calls_on_others() {
  static const std::vector<long> calls = {
      SYS_ptrace,
      SYS_process_vm_readv,
      SYS_process_vm_writev,
      SYS_kcmp,
      SYS_add_key,
      SYS_request_key,
      SYS_keyctl,
      SYS_mount,
      SYS_umount2,
      SYS_setns,
      SYS_unshare,
      SYS_pivot_root,
      SYS_perf_event_open,
      SYS_bpf,
      SYS_userfaultfd,
      SYS_kexec_load,
#ifdef SYS_io_uring_setup
      // Its operations are begun by a thread of the kernel, past this filter.
      SYS_io_uring_setup,
      SYS_io_uring_enter,
      SYS_io_uring_register,
#endif
#ifdef SYS_pidfd_getfd
      SYS_pidfd_getfd,
#endif
#ifdef SYS_move_mount
      SYS_move_mount,
      SYS_open_tree,
      SYS_fsopen,
      SYS_fsmount,
      SYS_fspick,
#endif
#ifdef SYS_mount_setattr
      SYS_mount_setattr,
#endif
#ifdef SYS_process_madvise
      SYS_process_madvise,
#endif
  };
  return calls;
}

const std::vector<long>& calls_on_attributes() {
  static const std::vector<long> calls = {
      SYS_fchmod,    SYS_fchmodat,  SYS_fchown,      SYS_fchownat,     SYS_utimensat,    SYS_setxattr,
      SYS_lsetxattr, SYS_fsetxattr, SYS_removexattr, SYS_lremovexattr, SYS_fremovexattr,
#ifdef SYS_chmod
      SYS_chmod,     SYS_chown,     SYS_lchown,      SYS_utime,        SYS_utimes,       SYS_futimesat,
#endif
      452,  // fchmodat2, Linux 6.6
      463,  // setxattrat, Linux 6.13
      466,  // removexattrat
  };
  return calls;
}

}  // namespace

Hiding hide_the_rest(const std::vector<std::string>& may_write) {
  Hiding made;
  if (unshare(CLONE_NEWNS) != 0 || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) {
    made.attributes_open = made.processes_open = because("no mount namespace");
    return made;
  }
  if (getpid() != 1)
    made.processes_open = "no process namespace";
  else if (mount("proc", "/proc", "proc", MS_NOSUID | MS_NODEV | MS_NOEXEC, nullptr) != 0)
    made.processes_open = because("/proc cannot be its own");
  made.attributes_open = freeze(may_write);
  return made;
}

std::string forbid_calls(bool attributes) {
#if defined(__x86_64__)
  constexpr std::uint32_t machine = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
  constexpr std::uint32_t machine = AUDIT_ARCH_AARCH64;
#else
  return "no list of system calls for this processor";
#endif
  const auto load = [](std::size_t at) { return sock_filter(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, std::uint32_t(at))); };
  const auto give = [](std::uint32_t what) { return sock_filter(BPF_STMT(BPF_RET | BPF_K, what)); };
  const std::uint32_t refuse = SECCOMP_RET_ERRNO | EPERM, unknown = SECCOMP_RET_ERRNO | ENOSYS;
  std::vector<sock_filter> code;
  // Another machine's numbers (32 bits) are other calls: none of them.
  code.push_back(load(offsetof(seccomp_data, arch)));
  code.push_back(sock_filter(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, machine, 1, 0)));
  code.push_back(give(refuse));
  code.push_back(load(offsetof(seccomp_data, nr)));
#if defined(__x86_64__)
  code.push_back(sock_filter(BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, 0x40000000u, 0, 1)));  // x32
  code.push_back(give(refuse));
#endif
  const auto forbid = [&](long call, std::uint32_t answer) {
    code.push_back(sock_filter(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, std::uint32_t(call), 0, 1)));
    code.push_back(give(answer));
  };
  for (const long call : calls_on_others()) forbid(call, refuse);
  if (attributes)
    for (const long call : calls_on_attributes()) forbid(call, refuse);
#ifdef SYS_clone3
  forbid(SYS_clone3, unknown);  // its flags lie in memory; the C library then takes clone
#endif
  code.push_back(sock_filter(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, std::uint32_t(SYS_clone), 0, 3)));
  code.push_back(load(offsetof(seccomp_data, args[0])));
  code.push_back(sock_filter(BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, std::uint32_t(CLONE_NEWUSER), 0, 1)));
  code.push_back(give(refuse));
  code.push_back(give(SECCOMP_RET_ALLOW));
  const sock_fprog program{static_cast<unsigned short>(code.size()), code.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
    return because("no seccomp");
  return "";
}

}  // namespace trephine::external
