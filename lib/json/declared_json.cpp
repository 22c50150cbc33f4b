// SPDX-License-Identifier: GPL-3.0-or-later
#include "json/declared_json.h"

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/joined.h"
#include "base/text.h"

namespace trephine::json {
namespace {

using Json = nlohmann::ordered_json;

Json written(const ParameterSet& set, void* object);

// -0 becomes 0, so that equal values give equal bytes.
Json written(const Parameter& p, const ParameterValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number + 0.0;
  const auto* list = std::get_if<std::vector<double>>(&value);
  if (!list) return std::visit([](const auto& v) { return Json(v); }, value);
  Json out = Json::array();
  for (const double v : *list) out.push_back(p.whole ? Json(static_cast<std::int64_t>(v)) : Json(v + 0.0));
  return out;
}

Json written(const Parameter& p, void* object) {
  if (p.is_value()) return written(p, p.get(object));
  const std::vector<ParameterItem> items = p.items(object);
  if (p.kind == ParameterKind::group)
    return items.empty() ? Json(nullptr) : written(p.set_of(items[0]), items[0].object);
  Json out = p.kind == ParameterKind::map ? Json::object() : Json::array();
  for (const ParameterItem& item : items) {
    Json one = written(p.set_of(item), item.object);
    if (p.kind == ParameterKind::map)
      out[item.name] = std::move(one);
    else if (p.kind == ParameterKind::steps)
      out.push_back(Json{{item.name, std::move(one)}});
    else
      out.push_back(std::move(one));
  }
  return out;
}

Json written(const ParameterSet& set, void* object) {
  if (const Parameter* only = set.only_value()) return written(*only, object);
  Json out = Json::object();
  for (const Parameter& p : set.parameters)
    if (Json one = is_absent(p, set, object) ? Json() : written(p, object); !one.is_null())
      out[p.name] = std::move(one);
  return out;
}

[[noreturn]] void refuse(const std::string& where, const std::string& what) {
  throw Error(ExitCode::bad_input, "", where, what);
}

std::string below(const std::string& where, const std::string& key) {
  return where.empty() || key.empty() ? where + key : where + "." + key;
}

std::string text_of(const Json& v) { return v.is_string() ? v.get<std::string>() : v.dump(); }

// A value of whatever kind it has.
ParameterValue any_value(const Json& v, const std::string& where, const Parameter& p) {
  if (v.is_boolean()) return v.get<bool>();
  if (v.is_number_integer() && !(v.is_number_unsigned() && v.get<std::uint64_t>() >> 62)) return v.get<std::int64_t>();
  if (v.is_number_float()) return v.get<double>();
  if (v.is_string()) return v.get<std::string>();
  std::vector<double> list;
  for (const Json& one : v)
    if (v.is_array() && one.is_number()) list.push_back(one.get<double>());
  ParameterValue none;
  if (!v.is_array() || list.size() != v.size()) refuse(where, parse_parameter(p, {}, none));
  return list;
}

class Reader {
 public:
  explicit Reader(const JsonRules& rules) : rules_(rules) {}

  void read_struct(const Json& v, const std::string& where, const ParameterSet& set, void* object) const {
    if (const Parameter* only = set.only_value()) return read_parameter(v, where, *only, object);
    if (!v.is_object()) refuse(where, "is not an object");
    if (!rules_.by_program) refuse_unknown(v, where, set);
    for (const Parameter& p : set.parameters) {
      const auto item = v.find(p.name);
      if (item != v.end())
        read_parameter(*item, below(where, p.name), p, object);
      else if (rules_.by_program ? !p.left_out : p.required)
        refuse(below(where, p.name), "is missing: " + p.help);
    }
    if (!set.fault) return;
    const std::string what = set.fault(object);
    const std::size_t colon = what.find(": ");
    if (what.empty()) return;
    if (colon == std::string::npos) refuse(where, what);
    refuse(below(where, what.substr(0, colon)), what.substr(colon + 2));
  }

 private:
  static void refuse_unknown(const Json& v, const std::string& where, const ParameterSet& set) {
    for (auto item = v.begin(); item != v.end(); ++item)
      if (!set.find(item.key())) {
        const std::string near = nearest_name(item.key(), set.names());
        refuse(below(where, printable(item.key())),
               "is not known" + (near.empty() ? std::string() : ", did you mean " + near + "?"));
      }
  }

  static void read_value(const Json& v, const std::string& where, const Parameter& p, void* object) {
    if (p.kind == ParameterKind::any) return p.set(object, any_value(v, where, p));
    std::vector<std::string> items;
    const bool wants_text = p.kind == ParameterKind::text || p.kind == ParameterKind::choice;
    if (v.is_array())
      for (const Json& one : v) items.push_back(one.is_number() ? one.dump() : "");
    else if (v.is_string() == wants_text && !v.is_object() && !v.is_null())
      items.push_back(text_of(v));
    if (v.is_array() != (p.kind == ParameterKind::numbers)) items.clear();  // no item fits: the fault says what does
    ParameterValue value;
    const std::string fault = parse_parameter(p, items, value);
    if (!fault.empty()) refuse(where, (v.is_primitive() ? printable(text_of(v)).substr(0, 80) + ", " : "") + fault);
    p.set(object, value);
  }

  void read_steps(const Json& v, const std::string& where, const Parameter& p, void* object) const {
    for (std::size_t i = 0; i < v.size(); ++i) {
      const std::string path = where + "[" + std::to_string(i) + "]";
      const Json& item = v[i];
      const bool bare = item.is_string();
      if (!bare && (!item.is_object() || item.size() != 1)) refuse(path, "is no \"name\" or {\"name\": {...}}");
      const std::string name = bare ? item.get<std::string>() : item.begin().key();
      const StepChoice* step = p.find_step(name);
      if (!step)
        refuse(path, printable(name) + ", no such step; known are " + joined(p.steps, ", ", &StepChoice::name));
      read_struct(bare ? Json::object() : item.begin().value(), below(path, name), *step->set, p.add(object, name));
    }
  }

  void read_parameter(const Json& v, const std::string& where, const Parameter& p, void* object) const {
    if (p.is_value()) return read_value(v, where, p, object);
    if (p.kind == ParameterKind::group) return read_struct(v, where, p.item_set(), p.add(object, ""));
    const bool map = p.kind == ParameterKind::map;
    if (map ? !v.is_object() : !v.is_array()) refuse(where, map ? "is not an object" : "is not a list");
    if (p.count && v.size() > p.count) refuse(where, "at most " + std::to_string(p.count));
    p.clear(object);
    if (p.kind == ParameterKind::steps) return read_steps(v, where, p, object);
    std::size_t n = 0;
    for (auto item = v.begin(); item != v.end(); ++item, ++n) {
      const std::string name = map ? item.key() : "";
      read_struct(*item, map ? below(where, name) : where + item_in_path(name_in(*item), n), p.item_set(),
                  p.add(object, name));
    }
  }

  // What a program's file calls an item of a list.
  std::string name_in(const Json& item) const {
    const bool named = rules_.by_program && item.is_object() && item.contains("name") && item["name"].is_string();
    return named ? item["name"].get<std::string>() : "";
  }

  const JsonRules& rules_;
};

void check_size(std::string_view text, const JsonRules& rules) {
  if (text.size() > rules.max_bytes) refuse("json", "is larger than " + std::to_string(rules.max_bytes) + " bytes");
  switch (beyond_bounds(text, rules.bounds)) {
    case BeyondBounds::no:
      return;
    case BeyondBounds::levels:
      refuse("json", "is nested too deeply");
    case BeyondBounds::count:
      refuse("json", "holds too much");
  }
}

constexpr const char* no_json =
    "is no JSON; what is written in YAML is compiled first, a rubric by `trephine rubric FILE.yaml --output FILE.json`";

}  // namespace

std::string declared_json(const ParameterSet& set, void* object, int indent) {
  try {
    return written(set, object).dump(indent);
  } catch (const Json::exception&) {
    throw Error(ExitCode::internal, "", "", "a text is not UTF-8");
  }
}

std::string declared_json(const AnyParams& params, int indent) {
  return declared_json(*params.set, params.object.get(), indent);
}

std::string declared_text(std::string_view text, const std::vector<std::string>& keys) {
  check_size(text, {});
  const Json json = Json::parse(text.begin(), text.end(), nullptr, false);
  if (json.is_discarded()) refuse("json", no_json);
  const Json* at = &json;
  for (const std::string& key : keys) {
    if (!at->is_object() || !at->contains(key)) return "";
    at = &at->at(key);
  }
  return at->is_string() ? at->get<std::string>() : "";
}

void read_declared_json(std::string_view text, const ParameterSet& set, void* object, const JsonRules& rules) {
  check_size(text, rules);
  // A key that is given twice would silently win.
  std::vector<std::vector<std::string>> keys;
  std::string twice;
  const auto watch = [&](int, Json::parse_event_t event, Json& v) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key) {
      const std::string key = v.get<std::string>();
      for (const std::string& k : keys.back())
        if (k == key && twice.empty()) twice = printable(key);
      keys.back().push_back(key);
    }
    return true;
  };
  Json json;
  try {
    json = Json::parse(text.begin(), text.end(), watch);
  } catch (const Json::exception&) {
    refuse("json", rules.by_program ? "is damaged" : no_json);
  }
  if (!twice.empty()) refuse(twice, "is given twice");
  Reader(rules).read_struct(json, "", set, object);
}

}  // namespace trephine::json
