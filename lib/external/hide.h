// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

namespace trephine::external {

/// For the first process of a process namespace, in a mount namespace that separate() made: makes one more, in which
/// every file system but these folders can only be read (so that neither modes, times, owners nor extended attributes
/// of files elsewhere can be changed, which Landlock does not cover), and /proc shows the processes of this namespace
/// alone. Returns what could not be done.
struct Hiding {
  std::string attributes_open;  ///< why modes, times and attributes of other files stay open; empty where they do not
  std::string processes_open;   ///< why other processes' command lines stay open; empty where they do not
};
Hiding hide_the_rest(const std::vector<std::string>& may_write);

/// System calls that no program needs that labels scans: reading and steering other processes (ptrace, process_vm_*,
/// pidfd_getfd), keys of the user's session, further namespaces and mounts, tracing of the kernel. They fail with
/// EPERM, for this process and all that it starts (seccomp). With `attributes` also those that change modes, times,
/// owners and extended attributes, anywhere: for where hide_the_rest could not keep them to the folder. Returns why
/// that cannot be done; empty where it is.
std::string forbid_calls(bool attributes);

}  // namespace trephine::external
