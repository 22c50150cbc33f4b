// SPDX-License-Identifier: GPL-3.0-or-later
// The library's page: cases, what is stale and why, builds, approval.
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "base/base64.h"
#include "base/error_text.h"
#include "base/file_descriptor.h"
#include "base/hash.h"
#include "base/open_beneath.h"
#include "base/parallel.h"
#include "base/text.h"
#include "base/write_file.h"
#include "desk/desk_state.h"
#include "desk/gate.h"
#include "desk/hand_work.h"
#include "desk/json_reply.h"
#include "desk/links.h"
#include "desk/web_files.h"
#include "lesson/approval.h"
#include "library/approve.h"
#include "library/catalogue.h"
#include "library/lesson_uses.h"
#include "library/sheet.h"
#include "page/html.h"
#include "picture/image.h"

namespace trephine::desk {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t max_file_bytes = std::size_t{1} << 28, max_log_bytes = 64 << 10, max_reason = 500;

Json json_of(const ParameterValue& value) {
  return std::visit([](const auto& v) { return Json(v); }, value);
}

Json json_of(const fs::path& library, const library::CaseRow& row) {
  Json out = {{"case", row.token},          {"class", row.patient_class},
              {"fault", row.fault},         {"warnings", row.warnings},
              {"triangles", row.triangles}, {"deviation_mm", row.deviation_max_mm},
              {"seconds", row.seconds},     {"age_s", row.age_s},
              {"last_code", row.last.code}, {"last_reason", row.last.reason}};
  out["wrong_count"] = row.wrong_count;
  out["pictures"] = Json::array();
  for (const std::string& file : library::overview_pictures(library, row))
    out["pictures"].push_back(fs::path(file).filename().string());
  out["anatomies"] = Json::array();
  out["figures"] = Json::object();
  out["approval"] = nullptr;
  if (!row.fault.empty()) return out;
  for (const cases::CaseAnatomy& a : row.manifest.anatomies)
    out["anatomies"].push_back({{"name", a.name}, {"volume_ml", a.volume_ml}, {"triangles", a.triangles}});
  for (const char* name : {"evans_index_ratio", "midline_shift_mm"})
    if (const ParameterValue* value = row.figure(name)) out["figures"][name] = json_of(*value);
  try {
    if (const auto approval = lesson::read_approval(library / row.token))
      out["approval"] = {{"by", approval->by},
                         {"difficulty_level", approval->difficulty_level},
                         {"holds", approval->case_sha256 == sha256_of_file(library / row.token / "case.json")}};
  } catch (const Error& e) {
    out["warnings"].push_back(std::string("approval: ") + e.what());
  }
  return out;
}

// Anybody may ask for it, as often as he likes, and read none of it: so there is one of it.
Reply desk_page(DeskState& desk, const Request&) {
  static const std::string html = page::html_page(web::desk_html, web::desk_css, web::desk_js, "{}", {});
  static const std::string own =
      "default-src 'none'; script-src '" + policy_hash(web::desk_js) + "'; style-src '" + policy_hash(web::desk_css) +
      "'; img-src 'self' blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
  Reply reply = bytes_reply({}, "text/html; charset=utf-8");
  reply.lasting = html;
  reply.policy = own + "; frame-src http://127.0.0.1:" + std::to_string(desk.library.options().page_port);
  return reply;
}

// A skull with a burr hole, from above.
Reply icon(DeskState&, const Request&) {
  constexpr int side = 32;
  picture::Image image(side, side, {0.08, 0.09, 0.11});
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const double bone = std::hypot((x - 15.5) / 12.0, (y - 15.5) / 14.5), hole = std::hypot(x - 20.5, y - 10.5);
      if (bone > 1 || hole < 3.5) continue;
      image.at(x, y)[0] = 236;
      image.at(x, y)[1] = 228;
      image.at(x, y)[2] = 200;
    }
  return bytes_reply(picture::encode_png(image), "image/png");
}

Reply library_cases(DeskState& desk, const Request&) {
  const fs::path& folder = desk.library.options().library;
  Json out = {{"name", folder.filename().string()},
              {"config", desk.library.options().config.filename().string()},
              {"cases", Json::array()}};
  std::error_code ignored;
  if (!fs::exists(folder, ignored)) return json_reply(out);
  const std::vector<std::string> tokens = library::library_tokens(folder);
  std::vector<library::CaseRow> rows(tokens.size());
  parallel_for(0, static_cast<std::int64_t>(rows.size()), 4, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) try {
        rows[i].token = tokens[i];
        require_no_links(desk.library.options(), tokens[i]);
        rows[i] = library::read_row(folder, tokens[i]);
      } catch (const Error& e) {
        rows[i].fault = error_text(e);
      }
  });
  for (const library::CaseRow& row : rows) out["cases"].push_back(json_of(folder, row));
  return json_reply(out);
}

Reply plan(DeskState& desk, const Request&) {
  Json out = Json::array();
  for (const DeskCase& c : desk.library.plan())
    out.push_back({{"case", c.token},
                   {"reasons", c.reasons},
                   {"fault", c.fault},
                   {"fixed", c.fixed},
                   {"config", c.config.filename().string()},
                   {"shared", !c.copied_from.empty()},
                   {"phantom", c.entry.phantom >= 0}});
  return json_reply({{"cases", out}});
}

Reply build(DeskState& desk, const Request& request) {
  const auto json = desk::json_of(request);
  const auto only = json.value("only", std::vector<std::string>());
  for (const DeskCase& c : only.empty() ? desk.library.plan() : std::vector<DeskCase>())
    require_no_links(desk.library.options(), c.token);
  for (const std::string& token : only) {
    require_no_links(desk.library.options(), token);
    desk.library.find(token);
  }
  if (only.size() == 1 && !desk.builder.status().running) keep_before(desk.library, only[0]);
  desk.builder.start(only);
  return json_reply({{"started", true}});
}

Reply stop_build(DeskState& desk, const Request&) {
  desk.builder.stop();
  return json_reply({{"stopped", true}});
}

Reply build_status(DeskState& desk, const Request&) {
  const BuildRunner::Status s = desk.builder.status();
  Json out = {{"running", s.running}, {"ever", s.ever}, {"stopping", s.stopping}, {"code", s.code},
              {"seconds", s.seconds}, {"only", s.only}, {"lines", s.lines},       {"at_work", Json::array()}};
  for (const auto& [name, status] : s.at_work)
    out["at_work"].push_back({{"case", name},
                              {"stage", status.stages.empty() ? "" : status.stages.back().name},
                              {"fraction", status.fraction}});
  return json_reply(out);
}

Reply build_log(DeskState& desk, const Request& request) {
  const library::LibraryState state(desk.library.options().library);
  const fs::path file = state.log_file("case." + request.value("case"));
  std::error_code ignored;
  if (request.value("case").empty() || !fs::exists(file, ignored)) return json_reply({{"log", ""}});
  const std::vector<char> bytes = read_file(file, max_file_bytes);
  const std::size_t from = bytes.size() > max_log_bytes ? bytes.size() - max_log_bytes : 0;
  return json_reply({{"log", std::string(bytes.begin() + std::ptrdiff_t(from), bytes.end())}});
}

// For which lessons the case serves is the simulator's to say; it lies beside this program, or in PATH.
Reply lessons(DeskState& desk, const Request& request) {
  const std::string token = request.value("case");
  const fs::path folder = desk.library.options().library / token;
  std::error_code ignored;
  if (token.empty() || !fs::exists(folder / "case.json", ignored))
    throw Error(ExitCode::no_input, "", "case", "has not been built yet");
  const auto uses = library::lesson_uses(folder);
  if (!uses)
    throw Error(ExitCode::no_input, "trephine-sim", "",
                "is not installed beside trephine: for which lessons the case serves is not known; it can be approved");
  Json out = Json::array();
  for (const library::LessonUse& use : *uses) {
    Json doubtful = Json::object();
    for (const auto& [task, why] : use.doubtful) doubtful[task] = why;
    out.push_back({{"name", use.name}, {"tasks", use.tasks}, {"doubtful", doubtful}, {"why_not", use.why_not}});
  }
  return json_reply({{"lessons", out}});
}

Reply approve(DeskState& desk, const Request& request) {
  const auto json = desk::json_of(request);
  const std::string token = json.at("case"), by = json.at("by");
  cases::validate_case_token(token, ExitCode::usage);
  const fs::path folder = desk.library.options().library / token;
  const bool withdraw = json.value("withdraw", false);
  const int level = json.value("difficulty_level", 3);
  if (level < 1 || level > 5) throw Error(ExitCode::usage, "", "difficulty_level", "must be 1 to 5");
  std::vector<lesson::AcceptedLesson> accepted;
  for (const auto& [name, why] : json.value("accepted", std::map<std::string, std::string>()))
    accepted.push_back({printable(name), printable(why.substr(0, max_reason))});
  const std::string done =
      withdraw ? library::withdraw_approval(folder, by) : library::approve_case(folder, by, level, accepted);
  if (!desk.library.options().config.empty()) {
    const DeskLock lock(desk.library);
    const DeskCase one = desk.library.find(token);
    std::vector<HandEntry> journal = read_journal(one);
    HandEntry entry;
    entry.by = by;
    entry.why = json.value("why", "");
    entry.kind = "approval";
    entry.what = withdraw ? "withdrawn" : "approved, difficulty " + std::to_string(level);
    for (const auto& check : json.value("checks", std::vector<std::string>())) entry.what += "; " + printable(check);
    for (const lesson::AcceptedLesson& a : accepted) entry.what += "; cannot serve " + a.lesson + ": " + a.reason;
    add_entry(journal, std::move(entry));
    write_journal(one, journal);
  }
  return json_reply({{"done", done}});
}

// A picture of a case's report folder. It is sent as bytes to the desk's script, which shows it as a picture: nobody
// can open it as a page.
Reply overview(DeskState& desk, const Request& request) {
  const std::string name = request.value("name");
  if (!is_plain_path(name) || fs::path(name).extension() != ".png" || fs::path(name).has_parent_path())
    throw Error(ExitCode::no_input, "", "name", "is no picture of a case");
  const fs::path file = fs::path(request.value("case")) / "report" / name;
  const FileDescriptor fd(open_beneath(desk.library.options().library, file));
  if (request.value("case").empty() || !fd.valid())
    throw Error(ExitCode::no_input, "", "", "the case has no such file");
  const std::vector<char> bytes = read_file("/proc/self/fd/" + std::to_string(fd.get()), max_file_bytes);
  return bytes_reply({bytes.begin(), bytes.end()}, "image/png");
}

Reply page_address(DeskState& desk, const Request& request) {
  const std::string token = request.value("case");
  cases::validate_case_token(token, ExitCode::usage);
  return json_reply({{"address", desk.pages.put(desk.library.options().library / token)}});
}

}  // namespace

Routes library_routes() {
  return {
      {"", {"GET", desk_page}},
      {"icon", {"GET", icon}},
      {"api/library", {"GET", library_cases}},
      {"api/plan", {"GET", plan}},
      {"api/build", {"POST", build}},
      {"api/stop", {"POST", stop_build}},
      {"api/status", {"GET", build_status}},
      {"api/log", {"GET", build_log}},
      {"api/lessons", {"GET", lessons}},
      {"api/overview", {"GET", overview}},
      {"api/page", {"GET", page_address}},
      {"api/approve", {"POST", approve}},
  };
}

}  // namespace trephine::desk
