// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/library_state.h"

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "cases/case.h"
#include "library/settings.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr std::uint64_t max_bytes = std::uint64_t{4} << 20;

std::optional<Json> read_json(const fs::path& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return {};
  try {
    const std::vector<char> bytes = read_file(file, max_bytes);
    return Json::parse(bytes.begin(), bytes.end());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return {};
  }
}

// Returns nothing where `read` throws, whatever it throws on a damaged file.
template <class T, class F>
std::optional<T> read_record(const fs::path& file, F read) {
  const auto json = read_json(file);
  if (!json) return {};
  try {
    return read(*json);
  } catch (const nlohmann::json::exception&) {
    return {};
  }
}

CaseInputs inputs_of(const Json& json) {
  return {json.at("settings").get<std::string>(), json.at("series").get<std::string>()};
}

}  // namespace

void LibraryState::make_folders() const {
  make_private_folder(folder());
  for (const char* name : {"cases", "settings", "phantoms", "logs"}) make_output_folder(folder() / name);
}

std::optional<CaseInputs> read_inputs(const LibraryState& state, const std::string& token) {
  return read_record<CaseInputs>(state.case_file(token, "inputs"), inputs_of);
}

std::optional<BuiltCase> read_built(const LibraryState& state, const std::string& token) {
  return read_record<BuiltCase>(state.case_file(token, "built"), [](const Json& json) {
    BuiltCase built{inputs_of(json), json.at("case_json").get<std::string>(), {}};
    for (const auto& [name, bytes] : json.at("files").items())
      built.files.emplace_back(name, bytes.get<std::uint64_t>());
    return built;
  });
}

std::optional<JobResult> read_result(const LibraryState& state, const std::string& token) {
  return read_record<JobResult>(state.case_file(token, "result"), [](const Json& json) {
    return JobResult{json.at("code").get<int>(), json.at("reason").get<std::string>(), json.at("seconds").get<double>(),
                     json.at("memory_mb").get<double>(), json.at("cpu_s").get<double>()};
  });
}

std::optional<std::map<std::string, std::string>> read_settings(const LibraryState& state, const std::string& sha256) {
  try {
    const std::vector<char> bytes = read_file(state.settings_file(sha256), max_bytes);
    return parse_settings_json({bytes.data(), bytes.size()});
  } catch (const Error&) {
    return {};
  }
}

void write_inputs(const LibraryState& state, const std::string& token, const CaseInputs& inputs) {
  const auto known = read_inputs(state, token);
  if (known && known->settings_sha256 == inputs.settings_sha256 && known->series_sha256 == inputs.series_sha256) return;
  const Json json = {{"settings", inputs.settings_sha256}, {"series", inputs.series_sha256}};
  write_file(state.case_file(token, "inputs"), json.dump(1) + "\n");
}

void write_built(const LibraryState& state, const std::string& token, const BuiltCase& built) {
  Json files = Json::object();
  for (const auto& [name, bytes] : built.files) files[name] = bytes;
  const Json json = {{"settings", built.inputs.settings_sha256},
                     {"series", built.inputs.series_sha256},
                     {"case_json", built.case_sha256},
                     {"files", files}};
  write_file(state.case_file(token, "built"), json.dump(1) + "\n");
}

void write_result(const LibraryState& state, const std::string& token, const JobResult& result) {
  const Json json = {{"code", result.code},
                     {"reason", result.reason},
                     {"seconds", result.seconds},
                     {"memory_mb", result.memory_mb},
                     {"cpu_s", result.cpu_s}};
  write_file(state.case_file(token, "result"), json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

BuiltCase describe_built(const fs::path& case_folder, const std::string& settings_sha256) {
  const std::vector<char> bytes = read_file(case_folder / "case.json", max_bytes);
  const std::string_view text(bytes.data(), bytes.size());
  const cases::CaseManifest manifest =
      with_file((case_folder / "case.json").string(), [&] { return cases::parse_case_json(text); });
  BuiltCase built{{settings_sha256, manifest.input_sha256}, sha256_of_bytes(text), {}};
  for (const cases::CaseFile& f : manifest.files) built.files.emplace_back(f.name, f.bytes);
  return built;
}

std::string fault_of_built(const fs::path& case_folder, const BuiltCase& built) {
  std::error_code error;
  if (!fs::exists(case_folder / "case.json", error)) return "case.json is missing";
  try {
    if (sha256_of_file(case_folder / "case.json") != built.case_sha256)
      return "case.json is not the one that was built";
  } catch (const Error&) {
    return "case.json cannot be read";
  }
  for (const auto& [name, bytes] : built.files) {
    const auto size = fs::file_size(case_folder / name, error);
    if (error) return name + " is missing";
    if (size != bytes) return name + " is damaged";
  }
  return "";
}

}  // namespace trephine::library
