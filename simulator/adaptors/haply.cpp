// SPDX-License-Identifier: GPL-3.0-or-later
// Haply's Inverse3 (and Inverse3x, Minverse) with a VerseGrip, by the vendor's Inverse Service: JSON over a WebSocket,
// one state for each message that it gets. Source: Haply Inverse SDK 3.5, Service, "WebSocket Protocol", "Control
// Commands", "Basis Permutation" (docs.haply.co/inverseSDK/service); of 3.1, whose forces have another key, the
// vendor's examples in Python. Metres and newtons; x to the right, y forward, z up, as `--workspace-axes haply` takes
// them. A fake of the service is all that was ever held with it.
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>

#include "device/adaptor.h"

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

// Until what does not answer is lost, and what was cancelled is closed. That a device gives no pose for some
// milliseconds, the program that holds it notices (--adaptor-timeout-ms).
constexpr auto answer_time = std::chrono::milliseconds(2000), cancel_time = std::chrono::milliseconds(250);
constexpr std::size_t message_bytes = 1 << 20;
constexpr double mm_per_m = 1000;

std::string failed = "nothing failed";

struct Failure {
  std::string what;
};

// A connection on which nothing lasts longer than that, also where the service sends half of a frame or byte by byte;
// but for the look-up of a HOST that is no number.
class Service {
 public:
  Service() : socket_(io_) {
    const char* own = std::getenv("TREPHINE_HAPLY_SERVICE");
    const std::string where = own && *own ? own : "127.0.0.1:10001";
    const std::size_t colon = where.rfind(':');
    if (colon == std::string::npos) throw Failure{where + " of TREPHINE_HAPLY_SERVICE is no HOST:PORT"};
    beast::error_code fault;
    const auto ends = asio::ip::tcp::resolver(io_).resolve(where.substr(0, colon), where.substr(colon + 1), fault);
    if (fault) throw Failure{where + ": " + fault.message()};
    step("Haply's Inverse Service at " + where, [&](const auto& done) {
      beast::get_lowest_layer(socket_).async_connect(ends, [done](beast::error_code e, const auto&) { done(e); });
    });
    beast::get_lowest_layer(socket_).socket().set_option(asio::ip::tcp::no_delay(true), fault);
    socket_.read_message_max(0);
    step("the handshake", [&](const auto& done) { socket_.async_handshake(where, "/", done); });
    inventory_ = receive();
  }
  ~Service() {
    beast::error_code fault;
    beast::get_lowest_layer(socket_).socket().close(fault);
  }
  /// As the protocol wants a connection to end.
  void leave() {
    if (is_broken_) return;
    step("the end", [&](const auto& done) { socket_.async_close(beast::websocket::close_code::normal, done); });
  }
  const Json& inventory() const { return inventory_; }
  Json receive() {
    beast::flat_buffer buffer;
    until_ = Clock::now() + answer_time;
    do {
      step(
          "a state",
          [&](const auto& done) {
            socket_.async_read_some(buffer, message_bytes, [done](beast::error_code e, std::size_t) { done(e); });
          },
          until_);
      // Not by the stream's own limit, which would end the connection before the last force is taken back.
      if (buffer.size() > message_bytes) throw Failure{"the service sent more than 1 MB for a state"};
    } while (!socket_.is_message_done());
    const char* text = static_cast<const char*>(buffer.data().data());
    Json state = Json::parse(text, text + buffer.size(), nullptr, false);
    if (!state.is_object()) throw Failure{"the service sent what is no JSON object"};
    return state;
  }
  void send(const Json& message) {
    const std::string text = message.dump();
    if (is_broken_) return send_frame(text);
    step("a force", [&](const auto& done) {
      socket_.async_write(asio::buffer(text), [done](beast::error_code e, std::size_t) { done(e); });
    });
  }

 private:
  /// A stream that failed writes no more, and the last force is to be taken back all the same [RFC 6455, 5.2]: one text
  /// frame, masked by zeros.
  void send_frame(const std::string& text) {
    std::string frame = "\x81";
    if (text.size() < 126)
      frame += char(0x80 | text.size());
    else
      frame += {'\xfe', char(text.size() >> 8), char(text.size() & 255)};
    frame.append(4, '\0');
    frame += text;
    step("a force", [&](const auto& done) {
      asio::async_write(beast::get_lowest_layer(socket_), asio::buffer(frame),
                        [done](beast::error_code e, std::size_t) { done(e); });
    });
  }
  template <class Begin>
  void step(const std::string& what, const Begin& begin) {
    step(what, begin, Clock::now() + answer_time);
  }
  template <class Begin>
  void step(const std::string& what, const Begin& begin, Clock::time_point until) {
    beast::error_code fault;
    bool is_done = false;
    begin([&](beast::error_code e) { fault = e, is_done = true; });
    io_.restart();
    io_.run_until(until);
    is_broken_ = is_broken_ || !is_done || fault;
    if (!is_done) {
      beast::get_lowest_layer(socket_).cancel();  // and not closed: the last force is to be taken back
      io_.restart();
      io_.run_for(cancel_time);
      if (!is_done) {  // it went on to another address, or waits all the same
        beast::error_code ignored;
        beast::get_lowest_layer(socket_).socket().close(ignored);
        io_.restart();
        io_.run();  // what was begun ends now, before what it refers to goes
      }
      throw Failure{what + ": no answer in time"};
    }
    if (fault) throw Failure{what + ": " + fault.message()};
  }

  bool is_broken_ = false;
  Clock::time_point until_;
  asio::io_context io_;
  beast::websocket::stream<beast::tcp_stream> socket_;
  Json inventory_;
};

std::unique_ptr<Service> service;
struct Device {
  std::string id;
  const char* force_key = "vector";
  double axis[3] = {0, 0, 1}, across[3] = {0, 0, 0};  // as the grip was seen last; upright where there is none
  std::uint32_t buttons = 0;
} device;

// Every function of the library: what is thrown becomes its line and its result.
template <class F, class R>
R guarded(R bad, const F& f) {
  try {
    return f();
  } catch (const Failure& e) {
    failed = e.what;
  } catch (const std::exception& e) {
    failed = e.what();
  }
  return bad;
}

const Json& list_of(const Json& state, const char* kind) {
  static const Json none = Json::array();
  const auto found = state.find(kind);
  return found != state.end() && found->is_array() ? *found : none;
}

const Json& arms() {
  if (!service) service = std::make_unique<Service>();
  return list_of(service->inventory(), "inverse3");
}

double number(const Json& of, const char* key) {
  const auto found = of.find(key);
  if (found == of.end() || !found->is_number()) throw Failure{std::string("a state has no number ") + key};
  return found->get<double>();
}

// Buttons are up where nobody says that they are down; a direction that is not known is the last one.
void take_grip(const Json& grip) {
  const auto state = grip.find("state");
  if (state == grip.end() || !state->is_object()) return;
  const auto down = [](const Json& of, const char* name) {
    const auto button = of.find(name);
    return button != of.end() && button->is_boolean() && button->get<bool>();
  };
  if (const auto all = state->find("buttons"); all != state->end() && all->is_object())
    for (const char* name : {"a", "b", "c"}) device.buttons |= std::uint32_t(down(*all, name)) << (name[0] - 'a');
  else
    device.buttons = down(*state, "button");
  const auto q = state->find("orientation");
  if (q == state->end() || !q->is_object()) return;
  const double w = number(*q, "w"), x = number(*q, "x"), y = number(*q, "y"), z = number(*q, "z");
  if (!(std::abs(w * w + x * x + y * y + z * z - 1) < 0.1)) return;
  // The grip points along its own y, to the tip; its x goes across.
  const double points[3] = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
  const double across[3] = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
  for (int a = 0; a < 3; ++a) device.axis[a] = -points[a], device.across[a] = across[a];
}

void send_force(const double* force_n) {
  const Json force = {{"x", force_n[0]}, {"y", force_n[1]}, {"z", force_n[2]}};
  service->send(
      {{"inverse3", {{{"device_id", device.id}, {"commands", {{"set_cursor_force", {{device.force_key, force}}}}}}}}});
}

}  // namespace

extern "C" {

int trephine_adaptor_version(void) { return TREPHINE_ADAPTOR_VERSION; }

int trephine_adaptor_count(void) {
  return guarded(-1, [] { return int(arms().size()); });
}

int trephine_adaptor_name(int index, char* out, int size) {
  return guarded(1, [&] {
    const Json& arm = arms().at(std::size_t(index));
    const std::string kind = arm.contains("config") ? arm["config"].value("type", "inverse3") : "inverse3";
    std::snprintf(out, std::size_t(size), "Haply %s %s", kind.c_str(), arm.at("device_id").get<std::string>().c_str());
    return 0;
  });
}

void* trephine_adaptor_open(int index) {
  return guarded(static_cast<void*>(nullptr), [&]() -> void* {
    device = Device();
    device.id = arms().at(std::size_t(index)).at("device_id").get<std::string>();
    if (!service->inventory().contains("session_id")) device.force_key = "values";  // before 3.5
    return &device;
  });
}

// The service says none of them.
int trephine_adaptor_limits(void*, trephine_adaptor_limits_t* out) {
  std::memset(out, 0, sizeof *out);
  return 0;
}

int trephine_adaptor_start(void*) {
  return guarded(1, [] {
    const double none[3] = {0, 0, 0};
    send_force(none);
    return 0;
  });
}

// The answer to the force before.
int trephine_adaptor_read(void*, trephine_adaptor_pose* out) {
  return guarded(1, [&] {
    const Json state = service->receive();
    device.buttons = 0;
    for (const char* kind : {"wireless_verse_grip", "verse_grip"})
      if (const Json& grips = list_of(state, kind); !grips.empty()) {
        take_grip(grips[0]);
        break;
      }
    const Json* arm = nullptr;
    for (const Json& one : list_of(state, "inverse3"))
      if (one.is_object() && one.contains("device_id") && one["device_id"] == device.id) arm = &one;
    if (!arm) throw Failure{"the service no longer lists " + device.id};
    const Json& at = arm->at("state").at("cursor_position");
    int a = 0;
    for (const char* axis : {"x", "y", "z"}) out->tip_mm[a++] = mm_per_m * number(at, axis);
    std::memcpy(out->axis, device.axis, sizeof out->axis);
    std::memcpy(out->across, device.across, sizeof out->across);
    out->buttons = device.buttons;
    return 0;
  });
}

int trephine_adaptor_send(void*, const double force_n[3], const double*) {
  return guarded(1, [&] {
    send_force(force_n);
    return 0;
  });
}

void trephine_adaptor_close(void*) {
  guarded(1, [] {
    const double none[3] = {0, 0, 0};
    send_force(none);
    service->leave();
    return 0;
  });
  service.reset();
}

const char* trephine_adaptor_error(void) { return failed.c_str(); }

}  // extern "C"
