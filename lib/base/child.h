// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/progress.h"

namespace trephine {

/// The bounded child process. Dangerous work (decoders with live asserts, foreign importers, booleans that crash or
/// hang) runs in a spawned copy of this program with limits on memory, CPU time and wall clock time, core size 0 and
/// none of our signal handlers. The request and the result travel in shared memory. The parent always survives, kills
/// what is left of the child, and reports.
///
/// A worker is a function registered under a name at static initialization:
///   static const ChildWorker decode_worker("dicom-decode", [](ChildRequest& r) { ... });
/// main() of every program and test calls run_child_if_asked(argc, argv) before anything else. (The linker drops a
/// static library's registrations unless something else in that file is used, so keep the registration in the .cpp of
/// the parent's function that calls run_child.)

struct ChildLimits {
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< address space (RLIMIT_AS)
  double cpu_s = 300;                                   ///< RLIMIT_CPU
  double wall_s = 600;                                  ///< the child is killed (SIGKILL) after it
};

/// What a worker sees: the request's bytes, a sink for the result, and a way to say how far it is.
class ChildRequest {
 public:
  virtual ~ChildRequest() = default;
  virtual std::string_view request() const = 0;
  virtual void write(const void* data, std::size_t size) = 0;  ///< appends to the result
  void write(std::string_view bytes) { write(bytes.data(), bytes.size()); }
  virtual void report(double fraction) = 0;  ///< also shows that the worker is alive
};

struct ChildWorker {
  ChildWorker(const char* name, std::function<void(ChildRequest&)> function);
};

/// The result: a read-only mapping of what the worker wrote, released with the object.
class ChildResult {
 public:
  ChildResult() = default;
  ChildResult(const char* data, std::size_t size) : data_(data), size_(size) {}
  ChildResult(ChildResult&&) noexcept;
  ChildResult& operator=(ChildResult&&) noexcept;
  ~ChildResult();
  std::string_view bytes() const { return {data_, size_}; }

 private:
  const char* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Which program holds the worker, where it is not this one; main() of that program calls run_child_if_asked too.
struct ChildProgram {
  std::filesystem::path file;  ///< empty: this program
};

/// Runs the worker and waits. An Error that the worker throws arrives as the same Error (code, cause, file, field,
/// what). Throws Error 70 where the child dies (Cause::child_died, unless it was killed from outside) or exceeds a
/// limit (Cause::child_limit); the text says which: "killed by signal 6", "memory limit 512 MiB", "wall clock limit 60
/// s". Throws Cancelled where `progress` says so. No child outlives the call or a parent that was killed
/// (PR_SET_PDEATHSIG).
ChildResult run_child(const std::string& worker, std::string_view request, const ChildLimits& limits,
                      const Progress& progress = {}, const ChildProgram& program = {});

/// From now on workers run in that program where run_child names none: for a library of ours in a process of somebody
/// else's, such as a Python module. To be called before any worker runs.
void set_child_program(const std::filesystem::path& file);

/// In the child: runs the worker and ends the process. In the parent: returns.
void run_child_if_asked(int argc, char** argv);

}  // namespace trephine
