// SPDX-License-Identifier: GPL-3.0-or-later
// A folder or archive that was dropped on the page: it comes in pieces, and lies beside LIBRARY.yaml when all are
// there.
#include <algorithm>
#include <fstream>

#include "base/hash.h"
#include "base/text.h"
#include "base/write_file.h"
#include "config/config_root.h"
#include "desk/desk_state.h"
#include "desk/json_reply.h"
#include "library/dropped.h"

namespace trephine::desk {
namespace fs = std::filesystem;
namespace {

constexpr int max_files = 20000;
constexpr double kept_s = 24 * 3600;  // for whoever dropped it today and makes a case of it tomorrow

fs::path folder_of(const DeskLibrary& library) {
  if (library.options().config.empty()) throw Error(ExitCode::usage, "", "--config", "is needed: LIBRARY.yaml");
  const fs::path folder =
      fs::absolute(library.options().config).lexically_normal().parent_path() / library::dropped_folder;
  std::error_code ignored;
  if (fs::is_symlink(folder, ignored))
    throw Error(ExitCode::cannot_create, "", library::dropped_folder,
                "is a link: what is dropped stays beside LIBRARY.yaml");
  return folder;
}

/// Where the pieces of one drop lie. `drop` is a name that the page made: hexadecimal digits.
fs::path incoming_of(const DeskLibrary& library, const std::string& drop) {
  if (drop.size() != 16 || drop.find_first_not_of("0123456789abcdef") != std::string::npos)
    throw Error(ExitCode::usage, "", "drop", "must be 16 hexadecimal digits");
  return folder_of(library) / (library::incoming_prefix + drop);
}

/// Never the name that the file had: it may be a patient's.
std::string file_name(int number) {
  const std::string digits = std::to_string(number);
  return std::string(6 - std::min<std::size_t>(6, digits.size()), '0') + digits;
}

// A piece of a file, after all that came of it before.
Reply drop_piece(DeskState& desk, const Request& request) {
  const fs::path incoming = incoming_of(desk.library, request.value("drop"));
  const int number = number_of(request, "file");
  const auto offset = parse_integer(request.value("offset"));
  if (number < 0 || number >= max_files)
    throw Error(ExitCode::usage, "", "file", "is one of more than " + std::to_string(max_files));
  if (!offset || *offset < 0) throw Error(ExitCode::usage, "", "offset", "must be a whole number");
  std::error_code ignored;
  if (!fs::exists(incoming, ignored)) {
    remove_unused_drops(desk.library.options());
    make_private_folder(incoming.parent_path());
    make_private_folder(incoming);
  }
  const fs::path file = incoming / file_name(number);
  const std::uintmax_t there = fs::exists(file, ignored) ? fs::file_size(file, ignored) : 0;
  if (there != std::uintmax_t(*offset)) throw Error(ExitCode::usage, "", "offset", "is not where the file ends so far");
  std::ofstream out(file, std::ios::binary | std::ios::app);
  out.write(request.body.data(), std::streamsize(request.body.size()));
  out.close();
  if (!out) {
    fs::remove_all(incoming, ignored);
    throw Error(ExitCode::io, "", "drop", "cannot be written: is the disk full?");
  }
  return json_reply({{"bytes", there + request.body.size()}});
}

// All pieces are there: the whole gets a name by its content, so that the same scan is there once.
Reply dropped(DeskState& desk, const Request& request) {
  const auto json = desk::json_of(request);
  const fs::path incoming = incoming_of(desk.library, json.at("drop"));
  const int count = json.at("files").get<int>();
  const bool archive = json.at("archive").get<bool>();
  if (count < 1 || count > max_files || (archive && count != 1))
    throw Error(ExitCode::usage, "", "files", "must be 1 to " + std::to_string(max_files) + ", and 1 of an archive");
  Sha256 hash;
  for (int i = 0; i < count; ++i) {
    std::error_code error;
    const fs::path file = incoming / file_name(i);
    if (!fs::is_regular_file(file, error)) throw Error(ExitCode::usage, "", "files", "are not all there");
    hash.text(sha256_of_file(file));
  }
  const std::string name = hash.hex().substr(0, 16) + (archive ? ".zip" : "");
  const fs::path target = incoming.parent_path() / name;
  std::error_code error;
  if (!fs::exists(target, error)) {
    fs::rename(archive ? incoming / file_name(0) : incoming, target, error);
    if (error && !fs::exists(target)) throw Error(ExitCode::io, "", "drop", "cannot be put into its place");
  }
  fs::remove_all(incoming, error);
  const fs::path below =
      config::absolute_path(target).lexically_relative(config::absolute_path(desk.library.roots().at(0)));
  return json_reply({{"path", "0/" + below.string()}, {"archive", archive}});
}

}  // namespace

void remove_unused_drops(const DeskOptions& options) {
  if (options.config.empty()) return;
  try {
    remove_stale_temporaries(fs::absolute(options.config).parent_path());  // texts of a desk that was killed
    std::error_code ignored;
    for (const fs::path& drop : library::unused_drops(options.config, options.roots, kept_s))
      fs::remove_all(drop, ignored);
  } catch (const std::exception&) {  // what is used is not known, as where LIBRARY.yaml has a fault
  }
}

Routes drop_routes() {
  return {
      {"api/drop", {"POST", drop_piece}},
      {"api/dropped", {"POST", dropped}},
  };
}

}  // namespace trephine::desk
