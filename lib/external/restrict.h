// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace trephine::external {

/// What separate() could not do.
struct Separation {
  std::string network_open;   ///< why the network stays open; empty where it is closed
  std::string services_open;  ///< why socket files and /dev/shm of this machine stay open; empty where they are closed
};

/// Puts this process, which must have one thread, and its children into a user and a network namespace of their own
/// with loopback alone, and its children into a process namespace, which ends with the first of them. The user keeps
/// his numbers. In a mount namespace, too, /dev/shm is an empty one of its own of at most so many bytes, which ends
/// with the last process, and each socket file that a process of this network namespace listens on now is hidden. Where
/// the kernel does not allow all of it, as much as it does.
Separation separate(std::uint64_t shared_memory_bytes);

/// Landlock rules by which a process, and all that it starts, may write beneath these folders and to devices, and
/// nowhere else.
class Restriction {
 public:
  explicit Restriction(const std::vector<std::string>& may_write);
  ~Restriction();
  Restriction(const Restriction&) = delete;
  Restriction& operator=(const Restriction&) = delete;

  /// Why files stay open; empty where they do not.
  const std::string& open() const { return open_; }
  /// For the process that is to be restricted, right before it becomes the program. Also takes away the right to gain
  /// privileges. False where the kernel refuses what it agreed to.
  bool enter() const;

 private:
  int rules_ = -1;
  std::string open_;
};

}  // namespace trephine::external
