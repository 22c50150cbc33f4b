// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstring>
#include <sstream>

#include "base/joined.h"
#include "base/params.h"

namespace trephine {
namespace {

template <class T>
const T& member_of(const void* object, std::size_t at) {
  return *reinterpret_cast<const T*>(static_cast<const char*>(object) + at);
}

template <class I>
std::int64_t copied(const void* from) {
  I value;
  std::memcpy(&value, from, sizeof(I));
  return static_cast<std::int64_t>(value);
}

std::int64_t whole_number_at(const void* object, std::size_t at, std::size_t bytes, bool is_signed) {
  const char* from = static_cast<const char*>(object) + at;
  switch (bytes) {
    case 1:
      return is_signed ? copied<std::int8_t>(from) : copied<std::uint8_t>(from);
    case 2:
      return is_signed ? copied<std::int16_t>(from) : copied<std::uint16_t>(from);
    case 4:
      return is_signed ? copied<std::int32_t>(from) : copied<std::uint32_t>(from);
    default:
      return copied<std::int64_t>(from);
  }
}

template <class I>
void copy_to(void* to, std::int64_t value) {
  const I small = static_cast<I>(value);
  std::memcpy(to, &small, sizeof(I));
}

void set_whole_number(void* object, std::size_t at, std::size_t bytes, std::int64_t value) {
  char* to = static_cast<char*>(object) + at;
  switch (bytes) {
    case 1:
      return copy_to<std::int8_t>(to, value);
    case 2:
      return copy_to<std::int16_t>(to, value);
    case 4:
      return copy_to<std::int32_t>(to, value);
    default:
      return copy_to<std::int64_t>(to, value);
  }
}

}  // namespace

Parameter parameter_of_holder(Parameter p, const std::function<void*(void*)>& held) {
  // Reading a value does not change its holder, so the one function serves both.
  if (p.get) p.get = [get = p.get, held](const void* q) { return get(held(const_cast<void*>(q))); };
  if (p.set) p.set = [set = p.set, held](void* q, const ParameterValue& v) { set(held(q), v); };
  if (p.there) p.there = [there = p.there, held](const void* q) { return there(held(const_cast<void*>(q))); };
  if (p.items) p.items = [items = p.items, held](void* q) { return items(held(q)); };
  if (p.add) p.add = [add = p.add, held](void* q, const std::string& name) { return add(held(q), name); };
  if (p.clear) p.clear = [clear = p.clear, held](void* q) { clear(held(q)); };
  return p;
}

bool is_absent(const Parameter& p, const ParameterSet& set, void* object) {
  if (p.there) return !p.there(object);
  if (!p.left_out) return false;
  return p.is_value() ? p.get(object) == p.get(set.make().get()) : p.items(object).empty();
}

namespace detail {

Parameter& Declarer::add(const char* name, const char* help, ParameterKind kind) {
  Parameter& p = out.parameters.emplace_back();
  p.name = name;
  p.help = help;
  p.kind = kind;
  return p;
}

Parameter& Declarer::number_at(std::size_t at, const char* name, Range range, const char* help) {
  Parameter& p = add(name, help, ParameterKind::number);
  p.range = range;
  p.get = [at](const void* q) { return ParameterValue(member_of<double>(q, at)); };
  p.set = [at](void* q, const ParameterValue& v) { member_at<double>(q, at) = std::get<double>(v); };
  return p;
}

template <class T>
Parameter& Declarer::optional_value_at(std::size_t at, const char* name, const char* help, ParameterKind kind) {
  using Value = std::optional<T>;
  Parameter& p = add(name, help, kind);
  p.left_out = true;
  p.get = [at](const void* q) { return ParameterValue(member_of<Value>(q, at).value_or(T())); };
  p.set = [at](void* q, const ParameterValue& v) { member_at<Value>(q, at) = std::get<T>(v); };
  p.there = [at](const void* q) { return member_of<Value>(q, at).has_value(); };
  return p;
}
template Parameter& Declarer::optional_value_at<double>(std::size_t, const char*, const char*, ParameterKind);
template Parameter& Declarer::optional_value_at<std::int64_t>(std::size_t, const char*, const char*, ParameterKind);
template Parameter& Declarer::optional_value_at<std::string>(std::size_t, const char*, const char*, ParameterKind);
template Parameter& Declarer::optional_value_at<bool>(std::size_t, const char*, const char*, ParameterKind);

Parameter& Declarer::extent_at(std::size_t at, const char* name, const char* help) {
  using Value = std::array<int, 3>;
  Parameter& p = add(name, help, ParameterKind::text);
  p.get = [at](const void* q) {
    const Value& n = member_of<Value>(q, at);
    return ParameterValue(std::to_string(n[0]) + "x" + std::to_string(n[1]) + "x" + std::to_string(n[2]));
  };
  p.set = [at](void* q, const ParameterValue& v) {
    std::istringstream in(std::get<std::string>(v));
    char x = 0;
    for (int& n : member_at<Value>(q, at)) in >> n >> x;
  };
  return p;
}

Parameter& Declarer::words_at(std::size_t at, const char* name, const char* help) {
  using Value = std::vector<std::string>;
  Parameter& p = add(name, help, ParameterKind::text);
  p.get = [at](const void* q) { return ParameterValue(joined(member_of<Value>(q, at), " ")); };
  p.set = [at](void* q, const ParameterValue& v) {
    Value& words = member_at<Value>(q, at);
    words.clear();
    std::istringstream in(std::get<std::string>(v));
    for (std::string word; in >> word;) words.push_back(word);
  };
  return p;
}

Parameter& Declarer::number_list_at(std::size_t at, const char* name, const char* help) {
  using Value = std::vector<double>;
  Parameter& p = add(name, help, ParameterKind::any);  // of any count
  p.get = [at](const void* q) { return ParameterValue(member_of<Value>(q, at)); };
  p.set = [at](void* q, const ParameterValue& v) {
    const auto* numbers = std::get_if<Value>(&v);
    member_at<Value>(q, at) = numbers ? *numbers : Value();
  };
  return p.not_always();
}

Parameter& Declarer::flag_at(std::size_t at, const char* name, const char* help) {
  Parameter& p = add(name, help, ParameterKind::flag);
  p.get = [at](const void* q) { return ParameterValue(member_of<bool>(q, at)); };
  p.set = [at](void* q, const ParameterValue& v) { member_at<bool>(q, at) = std::get<bool>(v); };
  return p;
}

Parameter& Declarer::text_at(std::size_t at, const char* name, const char* help) {
  Parameter& p = add(name, help, ParameterKind::text);
  p.get = [at](const void* q) { return ParameterValue(member_of<std::string>(q, at)); };
  p.set = [at](void* q, const ParameterValue& v) { member_at<std::string>(q, at) = std::get<std::string>(v); };
  return p;
}

Parameter& Declarer::numbers_at(std::size_t at, std::size_t count, const char* name, Range range, const char* help) {
  Parameter& p = add(name, help, ParameterKind::numbers);
  p.range = range;
  p.count = count;
  p.get = [at, count](const void* q) {
    const double* first = &member_of<double>(q, at);
    return ParameterValue(std::vector<double>(first, first + count));
  };
  p.set = [at, count](void* q, const ParameterValue& v) {
    std::copy_n(std::get<std::vector<double>>(v).begin(), count, &member_at<double>(q, at));
  };
  return p;
}

Parameter& Declarer::whole_numbers_at(std::vector<std::size_t> places, std::size_t bytes, bool is_signed,
                                      const char* name, Range range, const char* help) {
  Parameter& p = add(name, help, ParameterKind::numbers);
  p.range = range;
  p.count = places.size();
  p.whole = true;
  p.get = [=](const void* q) {
    std::vector<double> all;
    for (const std::size_t at : places) all.push_back(static_cast<double>(whole_number_at(q, at, bytes, is_signed)));
    return ParameterValue(all);
  };
  p.set = [=](void* q, const ParameterValue& v) {
    const auto& all = std::get<std::vector<double>>(v);
    for (std::size_t n = 0; n < places.size(); ++n)
      set_whole_number(q, places[n], bytes, static_cast<std::int64_t>(all[n]));
  };
  return p;
}

Parameter& Declarer::section_of(const char* name, const char* help, std::shared_ptr<const ParameterSet> set) {
  Parameter& p = add(name, help, ParameterKind::group);
  p.item_set = [set]() -> const ParameterSet& { return *set; };
  p.items = [](void* q) { return std::vector<ParameterItem>{{"", q}}; };
  p.add = [](void* q, const std::string&) { return q; };
  p.clear = [](void*) {};
  return p;
}

Parameter& Declarer::constant_of(const char* name, const char* value, const char* help) {
  Parameter& p = add(name, help, ParameterKind::choice);
  p.choices = {value};
  p.get = [value](const void*) { return ParameterValue(std::string(value)); };
  p.set = [](void*, const ParameterValue&) {};
  return p;
}

Parameter& Declarer::integer_at(std::size_t at, std::size_t bytes, bool is_signed, const char* name, Range range,
                                const char* help) {
  Parameter& p = add(name, help, ParameterKind::integer);
  p.range = range;
  p.get = [=](const void* q) { return ParameterValue(whole_number_at(q, at, bytes, is_signed)); };
  p.set = [=](void* q, const ParameterValue& v) { set_whole_number(q, at, bytes, std::get<std::int64_t>(v)); };
  return p;
}

Parameter& Declarer::choice_at(std::size_t at, std::size_t bytes, const char* name, Named<std::int64_t> choices,
                               const char* help) {
  Parameter& p = add(name, help, ParameterKind::choice);
  for (const auto& c : choices) p.choices.push_back(c.first);
  p.get = [at, bytes, choices](const void* q) {
    const std::int64_t value = whole_number_at(q, at, bytes, true);
    for (const auto& c : choices)
      if (c.second == value) return ParameterValue(c.first);
    return ParameterValue(std::string());
  };
  p.set = [at, bytes, choices = std::move(choices)](void* q, const ParameterValue& v) {
    if (const std::int64_t* value = find_item(choices, std::get<std::string>(v)))
      set_whole_number(q, at, bytes, *value);
  };
  return p;
}

void Declarer::add_all(const ParameterSet& set, std::size_t at, const char* prefix) {
  const auto held = [at](void* q) -> void* { return static_cast<char*>(q) + at; };
  for (const Parameter& p : set.parameters) {
    out.parameters.push_back(parameter_of_holder(p, held));
    out.parameters.back().name.insert(0, prefix);
  }
}

void Declarer::add_all_optional(const ParameterSet& set, const std::function<void*(void*)>& held,
                                const std::function<bool(const void*)>& there) {
  for (const Parameter& p : set.parameters) {
    const auto is_there = [there, held, p, of = &set](const void* q) {
      return there(q) && !is_absent(p, *of, held(const_cast<void*>(q)));
    };
    Parameter& held_one = out.parameters.emplace_back(parameter_of_holder(p, held));
    held_one.left_out = true;
    held_one.there = is_there;
  }
}

StepsOf Declarer::steps_at(std::size_t at) {
  return [at](void* q) -> Steps& { return member_at<Steps>(q, at); };
}

Parameter steps_parameter(const char* name, const char* help, std::vector<StepChoice> choices, const StepsOf& of) {
  Parameter p;
  p.name = name;
  p.help = help;
  p.kind = ParameterKind::steps;
  p.items = [of](void* q) {
    std::vector<ParameterItem> all;
    for (auto& [step, params] : of(q)) all.push_back({step, params.object.get(), params.set});
    return all;
  };
  p.add = [of, choices](void* q, const std::string& name) -> void* {
    const auto step = std::find_if(choices.begin(), choices.end(), [&](const auto& c) { return c.name == name; });
    return of(q).emplace_back(name, AnyParams{step->set, step->set->make()}).second.object.get();
  };
  p.clear = [of](void* q) { of(q).clear(); };
  p.steps = std::move(choices);
  return p;
}

Parameter step_parameter(const StepChoice& choice, const StepsOf& of) {
  Parameter p = steps_parameter(choice.name.c_str(), choice.help.c_str(), {choice}, of);
  p.kind = ParameterKind::group;
  p.steps.clear();
  p.item_set = [set = choice.set]() -> const ParameterSet& { return *set; };
  const auto is_it = [name = choice.name](const auto& step) { return step.first == name; };
  p.items = [of, is_it](void* q) {
    std::vector<ParameterItem> all;
    for (auto& step : of(q))
      if (is_it(step)) all.push_back({"", step.second.object.get()});
    return all;
  };
  p.add = [of, is_it, add = p.add, name = choice.name](void* q, const std::string&) -> void* {
    Steps& all = of(q);
    const auto known = std::find_if(all.begin(), all.end(), is_it);
    return known == all.end() ? add(q, name) : known->second.object.get();
  };
  p.clear = [of, is_it](void* q) {
    Steps& all = of(q);
    all.erase(std::remove_if(all.begin(), all.end(), is_it), all.end());
  };
  return p;
}

namespace {

/// A set that stands for a plain value.
template <class T>
ParameterSet plain(ParameterKind kind) {
  ParameterSet set;
  Parameter& p = set.parameters.emplace_back();
  p.kind = kind;
  if constexpr (std::is_same_v<T, ParameterValue>) {
    p.get = [](const void* q) { return *static_cast<const ParameterValue*>(q); };
    p.set = [](void* q, const ParameterValue& v) { *static_cast<ParameterValue*>(q) = v; };
  } else {
    p.get = [](const void* q) { return ParameterValue(*static_cast<const T*>(q)); };
    p.set = [](void* q, const ParameterValue& v) { *static_cast<T*>(q) = std::get<T>(v); };
  }
  set.make = [] { return std::make_shared<T>(); };
  return set;
}

}  // namespace
}  // namespace detail

template <>
const ParameterSet& parameters_of<std::string>() {
  static const ParameterSet set = detail::plain<std::string>(ParameterKind::text);
  return set;
}
template <>
const ParameterSet& parameters_of<double>() {
  static const ParameterSet set = detail::plain<double>(ParameterKind::number);
  return set;
}
template <>
const ParameterSet& parameters_of<ParameterValue>() {
  static const ParameterSet set = detail::plain<ParameterValue>(ParameterKind::any);
  return set;
}

}  // namespace trephine
