// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/button_board.h"

#include "haptics/tool_belt.h"

namespace trephine::session {
namespace {

constexpr std::uint32_t tool_bits = haptics::belt_button::tool_mask << haptics::belt_button::tool_shift,
                        command_bits = haptics::belt_button::command_mask << haptics::belt_button::command_shift;

class BoardDevice : public device::Device {
 public:
  BoardDevice(std::unique_ptr<device::Device> device, std::shared_ptr<const ButtonBoard> board)
      : device_(std::move(device)), board_(std::move(board)) {}

  double damping_n_s_per_mm() const override { return device_->damping_n_s_per_mm(); }
  bool knows_across() const override { return device_->knows_across(); }
  bool read(double dt_s, device::DeviceReading& out) override {
    const bool there = device_->read(dt_s, out);
    const std::uint32_t board = board_->buttons.load(std::memory_order_relaxed);
    const std::uint32_t own = out.buttons & tool_bits, boards = board & tool_bits;
    if (own != own_tool_) tool_ = own_tool_ = own;
    if (boards != board_tool_) tool_ = board_tool_ = boards;
    if (!(out.buttons & command_bits)) out.buttons |= board & command_bits;
    out.buttons = (out.buttons & ~tool_bits) | tool_ | (board & haptics::belt_button::pedal);
    return there;
  }
  void send(Vec3 force_n) override { device_->send(force_n); }
  void tell(const device::DeviceNews& news) override { device_->tell(news); }
  std::vector<std::pair<std::string, std::uint64_t>> counts() const override { return device_->counts(); }

 private:
  const std::unique_ptr<device::Device> device_;
  const std::shared_ptr<const ButtonBoard> board_;
  std::uint32_t own_tool_ = 0, board_tool_ = 0, tool_ = 0;
};

}  // namespace

std::unique_ptr<device::Device> with_board(std::unique_ptr<device::Device> device,
                                           std::shared_ptr<const ButtonBoard> board) {
  if (!board) return device;
  return std::make_unique<BoardDevice>(std::move(device), std::move(board));
}

}  // namespace trephine::session
