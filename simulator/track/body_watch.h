// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/rigid_fit.h"
#include "track/igtl/igtl_messages.h"

namespace trephine::track {

/// Which bodies of a tracker are wanted, and when what it says of them is too old.
struct WatchedBodies {
  std::vector<std::string> tools;
  std::string reference;                   ///< on the print; empty: poses are of the tracker's own frame
  double late_s = 0.2, together_s = 0.05;  ///< together: of a tool and the reference
};

/// What of a tracker's messages was not taken, and why.
struct WatchCounts {
  std::uint64_t poses = 0;         ///< of tools, taken
  std::uint64_t broken = 0;        ///< a wrong check sum or size
  std::uint64_t not_rigid = 0;     ///< not finite, or no rotation: scaled or sheared
  std::uint64_t mirrored = 0;      ///< a rotation of the mirrored body
  std::uint64_t incomplete = 0;    ///< a place without how the body is turned
  std::uint64_t unseen = 0;        ///< the very identity, which servers send of a body that is out of view
  std::uint64_t late = 0;          ///< more than late_s later than the quickest
  std::uint64_t out_of_order = 0;  ///< not newer than the one before
  std::uint64_t unwell = 0;        ///< messages by which the tracker says that it is not well
  std::uint64_t others = 0;        ///< of bodies that are not wanted
};
std::vector<std::pair<std::string, std::uint64_t>> listed(const WatchCounts& counts);

/// Makes poses of tools before the reference of a tracker's messages. A pose is what the tracker says of both at one
/// time: where their stamps agree once, they must; else they may be together_s apart. The sender's clock need not be
/// ours: a message is late against the quickest that came since the connection was made.
class BodyWatch {
 public:
  /// Number of the tool, and its frame in the reference's; with the time of `take`.
  using Found = std::function<void(int tool, const RigidMap& tool_to_reference, double now_s)>;
  BodyWatch(WatchedBodies wanted, Found found);
  /// A message that came at that time of our clock.
  void take(const IgtlHeader& header, const IgtlContent& content, double now_s);
  /// A new connection: nothing that came before is compared with what comes.
  void begin_anew();
  const WatchCounts& counts() const { return counts_; }
  /// When the tracker last said that it is not well; before all times: never.
  double unwell_s() const { return unwell_s_; }
  /// Some names of bodies that came and are not wanted, safe to print.
  const std::vector<std::string>& strangers() const { return strangers_; }

 private:
  struct Seen {
    RigidMap map;
    double stamp_s = -1, now_s = -1e9;
    bool used = true;
  };
  bool in_time(Seen& seen, double stamp_s, double now_s);
  void take_body(const IgtlBody& body, double stamp_s, double now_s);
  void pair(std::size_t tool, double now_s);

  const WatchedBodies wanted_;
  const Found found_;
  std::vector<Seen> tools_;
  Seen reference_;
  WatchCounts counts_;
  std::vector<std::string> strangers_;
  bool stamps_agree_ = false;
  double least_delay_s_ = 1e300, last_s_ = 0, unwell_s_ = -1e9;
};

}  // namespace trephine::track
