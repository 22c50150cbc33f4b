// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/desk.h"

#include "base/error.h"
#include "base/text.h"
#include "cases/case.h"
#include "desk/desk_state.h"
#include "desk/json_reply.h"
#include "desk/links.h"

namespace trephine::desk {
namespace {

const Routes& routes() {
  static const Routes all = [] {
    Routes out;
    for (Routes part : {library_routes(), compare_routes(), look_routes(), change_routes(), scene_routes(),
                        edit_routes(), new_case_routes(), drop_routes()})
      out.merge(part);
    return out;
  }();
  return all;
}

// The case that a request is about, as its address or the JSON that came with it names it; empty: none.
std::string case_of(const Request& request) {
  if (request.query.count("case")) return request.value("case");
  if (request.body.empty() || request.body.front() != '{') return "";
  try {
    const auto json = json_of(request);
    const auto named = json.find("case");
    return named != json.end() && named->is_string() ? named->get<std::string>() : "";
  } catch (const std::exception&) {  // whoever answers it says what is wrong with it
    return "";
  }
}

}  // namespace

int number_of(const Request& request, const std::string& name) {
  const auto number = parse_integer(request.value(name));
  if (!number || *number < -1000000 || *number > 1000000)
    throw Error(ExitCode::usage, "", name, "must be a whole number");
  return static_cast<int>(*number);
}

double real_of(const Request& request, const std::string& name) {
  const auto number = parse_number(request.value(name));
  if (!number) throw Error(ExitCode::usage, "", name, "must be a number");
  return *number;
}

Desk::Desk(DeskOptions options) : state_(std::make_unique<DeskState>(std::move(options))) {
  remove_unused_drops(state_->library.options());
}
Desk::~Desk() = default;

Reply Desk::answer(const Request& request) {
  // Every case is named by its token alone, wherever a request names one; so no name of a case is a path.
  const std::string token = case_of(request);
  if (request.query.count("case") || !token.empty()) cases::validate_case_token(token, ExitCode::usage);
  require_no_links(state_->library.options(), token);
  const auto found = routes().find(request.path);
  if (found == routes().end()) throw Error(ExitCode::no_input, "", "", "the desk has no such page");
  if (found->second.method != request.method)
    throw Error(ExitCode::usage, "", "method", std::string("must be ") + found->second.method);
  return found->second.answer(*state_, request);
}

Reply Desk::page(const Request& request) { return state_->pages.take(request.path); }

void Desk::stop() {
  state_->builder.stop();
  state_->trials.end();
  state_->live.forget();
  state_->cases.clear();
}

}  // namespace trephine::desk
