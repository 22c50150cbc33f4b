// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/desk.h"

#include <malloc.h>
#include <sys/stat.h>

#include <chrono>
#include <iostream>
#include <optional>
#include <thread>

#include "base/error.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/spawn.h"
#include "base/temporary_folder.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "desk/server.h"

namespace trephine::tools {
namespace {
namespace fs = std::filesystem;

constexpr int desk_threads = 16, page_threads = 2;

struct DeskParams {
  int port = 0;
  bool browser = true;
  template <class V>
  static void describe(V& v) {
    using P = DeskParams;
    v.integer(&P::port, "port", Range{0, 65534},
              "Port of the loopback interface; the one after it serves the pages of cases. 0: two free ones.");
    v.flag(&P::browser, "browser", "Open the desk in a browser.");
  }
};

/// The address holds the desk's token, and what stands on a command line every user of the machine can read. So the
/// browser gets a file that only its owner can read, which leads there.
void open_browser(const fs::path& folder, const std::string& address) {
  const fs::path file = folder / "desk.html";
  const mode_t before = ::umask(077);
  write_file(file,
             "<!DOCTYPE html><meta charset=\"utf-8\"><meta name=\"referrer\" content=\"no-referrer\">"
             "<meta http-equiv=\"refresh\" content=\"0;url=" +
                 address + "\"><title>trephine desk</title>\n");
  ::umask(before);
  SpawnRequest request;
  request.argv = {"xdg-open", file.string()};
  request.output = folder / "said";
  request.own_group = true;
  try {
    spawn(request);
  } catch (const Error&) {
    log_warning("no browser was opened: xdg-open is not there; open the address by hand");
  }
}

}  // namespace

const cli::OwnCommand desk_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "desk";
  c.summary = "serves a library in a browser: see, place, paint, build, approve";
  c.description =
      "Serves pages on the loopback interface of this machine, to whoever has the address that it prints: the "
      "library's "
      "cases, which of them are stale and why, builds, slices at full resolution beside the 3D view, landmarks and "
      "burr "
      "holes by mouse, corrections by brush, approval. Whatever is done by hand becomes a line of the case's "
      "configuration or a file beside it, which the next build repeats. Nothing is fetched from outside. Ctrl-C ends "
      "it. "
      "docs/how-to/desk.md shows every page.";
  c.examples = {"trephine desk library --config LIBRARY.yaml",
                "trephine desk library --config LIBRARY.yaml --no-browser"};
  cli::Argument root =
      cli::argument("root", Kind::in_folder, "A further folder that configurations and new scans may lie in.");
  root.repeated = true;
  c.arguments = {cli::positional_argument("library", Kind::out_folder, "The library: the folder with the cases."),
                 cli::argument("config", Kind::in_file,
                               "The library's configuration (LIBRARY.yaml); without it cases are only looked at and "
                               "approved."),
                 root};
  c.groups = {cli::ParameterGroup::of<DeskParams>("Parameters")};
  c.run = [](const cli::ParsedCommand& parsed) {
    desk::DeskOptions options;
    options.library = fs::absolute(parsed.path("library")).lexically_normal();
    if (parsed.has("config")) options.config = fs::absolute(parsed.path("config")).lexically_normal();
    for (const std::string& r : parsed.all("root")) options.roots.emplace_back(r);
    options.program_version = "trephine " TREPHINE_VERSION;
    // Drafts and slices of many megabytes pass through the server's threads all day: what is freed goes back to the
    // system at once, and is not kept by each thread for itself.
    ::mallopt(M_MMAP_THRESHOLD, 1 << 20);
    const DeskParams& params = parsed.params<DeskParams>();
    auto [at, pages_at] = desk::listen_on_two(params.port);
    options.port = at.port;
    options.page_port = pages_at.port;
    desk::Desk desk(options);
    const desk::Gate gate(at.port);
    desk::Server server(
        std::move(at), [&](const auto& head, std::string& path) { return gate.refuses(head, path); },
        [&](const desk::Request& request) { return desk.answer(request); }, desk_threads);
    desk::Server pages(
        std::move(pages_at),
        [port = options.page_port](const auto& head, std::string& path) {
          return desk::refuses_page(head, port, path);
        },
        [&](const desk::Request& request) { return desk.page(request); }, page_threads);
    std::cout << "trephine desk: " << gate.address() << "\n";
    if (!parsed.quiet) std::cout << "Whoever has this address may change the library. Ctrl-C ends the desk.\n";
    std::cout << std::flush;
    std::optional<TemporaryFolder> folder;
    if (params.browser) open_browser(folder.emplace().path(), gate.address());
    std::thread waiting([&] {
      while (!cancel_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
      desk.stop();
      server.stop();
      pages.stop();
    });
    std::thread serving_pages([&] { pages.run(); });
    server.run();
    serving_pages.join();
    waiting.join();
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
