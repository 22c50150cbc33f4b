// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "fluoro/fluoro_memory.h"
#include "fluoro/fluoroscope.h"

namespace trephine::fluoro {

/// A picture that a FluoroThread made.
struct MadeFluoro {
  FluoroPicture picture;
  CArmParams arm;
  std::vector<MetalRod> metal;
  double waited_s = 0;  ///< from the call of show() that it answers
};

/// Fluoroscopic pictures for somebody who may not wait, such as a window: they are made in threads of their own, which
/// give way to all others (nice 5), on as many cores as the machine has, at most 8.
///
/// - Of a place of the arm that is new, a picture of half the size comes first, with the needle where it is by then;
///   then the whole one.
/// - While the arm stands still only the needle is drawn anew. What was asked for meanwhile and is older than the last
///   call is left out.
/// - While the arm turns, pictures of half the size follow each other, each of a place where it was; MadeFluoro::arm
///   says which.
/// - Places where the arm stood are remembered (FluoroMemory): where it comes back to one, only the needle is drawn.
/// - move() makes what does not hang on the needle before X-rays are on, so that they show a picture at once.
///
/// Calls come from one thread and return at once; nothing here waits for a picture but the destructor. It waits until
/// its thread has ended: for what is left of the FluoroVolume that the thread makes of the CT at its start, for the
/// eight rows of a picture on which each thread is, and for the drawing of a needle. What was asked for and is not made
/// yet is dropped.
class FluoroThread {
 public:
  /// `ct` must stay as it is, and must outlive the object. Throws Error 65 where it has no voxels. `size`: pixels of a
  /// whole picture's side, even.
  FluoroThread(const grid::Grid<std::int16_t>& ct, int size);
  ~FluoroThread();
  FluoroThread(const FluoroThread&) = delete;
  FluoroThread& operator=(const FluoroThread&) = delete;

  void move(const CArmParams& arm);
  void show(const CArmParams& arm, const std::vector<MetalRod>& metal);
  /// The newest picture that was not taken yet. Throws what making it threw, such as bad_alloc.
  std::optional<MadeFluoro> take();

 private:
  struct Ask {
    CArmParams arm;
    std::vector<MetalRod> metal;
    std::uint64_t number = 0;  ///< 0: there was none
    double asked_s = 0;
  };

  void run();
  void serve(const FluoroVolume& volume);
  void make(const FluoroVolume& volume, const Ask& ask, bool prepares);
  const KeptFluoro* patient(const FluoroVolume& volume, const Ask& ask, bool prepares, int size,
                            const KeptFluoro* coarse);
  bool integrate(const FluoroVolume& volume, const Ask& ask, bool prepares, const KeptFluoro* coarse,
                 FluoroIntegrals& out);
  void publish(const KeptFluoro& patient, const Ask* asked = nullptr);
  bool goes_on(const Ask& ask, bool prepares, bool coarse);

  const grid::Grid<std::int16_t>& ct_;
  const int size_;
  std::mutex mutex_;  // guards what follows, and is never held while a picture is made
  std::condition_variable asked_;
  Ask shown_, moved_;  // the last calls of show() and move()
  std::optional<MadeFluoro> made_;
  std::exception_ptr fault_;
  bool stop_ = false;

  // Of the thread alone:
  FluoroMemory memory_;
  std::uint64_t published_ = 0;           // the number of the show() that the last picture answers
  std::uint64_t served_ = 0, ahead_ = 0;  // the numbers of the show() and the move() that were seen to
  std::thread thread_;
};

}  // namespace trephine::fluoro
