// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "device/device.h"
#include "device/device_type.h"

namespace trephine::device {

/// Where a device's space lies before a screen, as its user sees it (in a mirror workbench: the screen's image in the
/// mirror, over the hands; dissertation, chapter 1 and 2.1). Of the screen: mm from its middle, x to the right, y
/// upwards, z from the screen towards the user.
struct ScreenRegistration {
  double scale = 1;                 ///< mm before the screen for each mm of the device
  Mat3 turn;                        ///< a rotation, from the device's axes to the screen's
  Vec3 offset_mm;                   ///< of the device's origin before the screen
  double height_mm = 0;             ///< of the picture on the screen
  double rms_mm = 0, worst_mm = 0;  ///< how far the marks lie from where they were touched
  int marks_count = 0;
  Vec3 before_screen(Vec3 device_mm) const { return turn * device_mm * scale + offset_mm; }
};

/// The rigid transform, or with `scales` the similarity, for which the marks are met with the least sum of squares
/// [Horn1987]. Throws Error 80 where fewer than three are given, or all lie (nearly) on a line.
ScreenRegistration fit_screen(const std::vector<Vec3>& device_mm, const std::vector<Vec3>& screen_mm, bool scales);

/// As JSON; and back. Throws Error 66; 65 naming the key that is missing or no registration's: a turn that is no
/// rotation, a scale or height that is not above 0.
std::string to_json(const ScreenRegistration& registration);
ScreenRegistration read_screen_registration(const std::filesystem::path& file);

/// What of the case the screen shows: its middle lies there, and the picture is so high.
struct ScreenView {
  Vec3 middle_mm, right{1, 0, 0}, up{0, 0, 1}, toward{0, -1, 0};
  double height_mm = 0;  ///< in the case; 0: not known yet
};

/// Where the window of a view lies on its screen, in heights of the window: the screen's middle from the window's, as
/// it is seen (in the mirror), and how high the screen is. By default the window fills the screen.
struct WindowPlace {
  double right = 0, up = 0, screen_height = 1;
};
/// What the whole screen would show, were it a window: `window` is what the window shows.
ScreenView over_screen(const ScreenView& window, const WindowPlace& place);

/// A device whose tool is seen where the hand is: poses are brought before the screen, and from there into the case as
/// the view lies at that moment; forces go the other way. Until a view is known the tool stands 10 m before the case.
///
/// In a picture that is larger than life the force is the tool's, and walls are softer at the hand. Where a mm of the
/// hand is more than one of the case, the hand gets so much less force that no wall is stiffer than in the case: a view
/// that is zoomed out makes no device unstable.
class ScreenDevice : public Device {
 public:
  ScreenDevice(std::unique_ptr<Device> device, const ScreenRegistration& registration,
               std::shared_ptr<Mailbox<ScreenView>> view);
  double damping_n_s_per_mm() const override;
  bool read(double dt_s, DeviceReading& out) override;
  void send(Vec3 force_n) override;
  void tell(const DeviceNews& news) override;
  bool knows_across() const override { return device_->knows_across(); }
  std::vector<std::pair<std::string, std::uint64_t>> counts() const override { return device_->counts(); }

 private:
  /// mm of the case for each of the device.
  double scale() const { return registration_.scale * view_.height_mm / registration_.height_mm; }
  double force_share() const { return view_.height_mm > 0 ? std::min(1.0, 1 / scale()) : 1; }
  Vec3 to_case(Vec3 direction) const;
  Vec3 to_device(Vec3 direction) const;
  std::unique_ptr<Device> device_;
  ScreenRegistration registration_;
  std::shared_ptr<Mailbox<ScreenView>> mailbox_;
  ScreenView view_;
};

}  // namespace trephine::device
