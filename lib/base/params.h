// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace trephine {

/// Parameters are declared once. An options struct lists its members in a static `describe` (a visitor over members;
/// the default is the member's initializer and stands nowhere else):
///
///   struct DecimateParams {
///     double max_deviation_mm = 0.2;
///     template <class V> static void describe(V& v) {
///       using P = DecimateParams;
///       v.number(&P::max_deviation_mm, "max_deviation_mm", Range{0, 5}, "Largest two-sided distance to the input.");
///     }
///   };
///
/// parameters_of<P>() turns that into a list of type-erased descriptors; the CLI flag (--max-deviation-mm), the YAML
/// key, validation, help, reference page, JSON schema, completion and the manifest of effective values all come from
/// it.

struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

enum class ParameterKind { number, integer, flag, choice, text, numbers };

/// choice holds its name, numbers a fixed count of doubles.
using ParameterValue = std::variant<double, std::int64_t, bool, std::string, std::vector<double>>;

struct Parameter {
  std::string name;  ///< snake_case, ends in its unit
  std::string help;  ///< one line
  ParameterKind kind = ParameterKind::number;
  Range range;                       ///< number, integer, numbers
  std::vector<std::string> choices;  ///< choice
  std::size_t count = 0;             ///< numbers: how many
  /// Defaults that hang on another parameter's choice, {"method brain", 22.5}, in the order of its choices.
  std::vector<std::pair<std::string, ParameterValue>> defaults_by;
  std::function<ParameterValue(const void* params)> get;
  std::function<void(void* params, const ParameterValue&)> set;  ///< the value must have passed parse_parameter
};

/// The value's text, as in a manifest or a help page: 0.2, true, "threshold", [1, 2, 3].
std::string to_text(const ParameterValue& value);

/// Reads one value; lists are given as their items. Returns the fault ("must be a number from 0 to 5") or "".
std::string parse_parameter(const Parameter& parameter, const std::vector<std::string>& items, ParameterValue& value);

/// "22.5 with method brain": the defaults that differ from this one; "" where none does.
std::string other_defaults(const Parameter& parameter, const ParameterValue& default_value);

/// "number, 0 to 5, default 0.2": what help and reference pages say of it.
std::string describe_parameter(const Parameter& parameter, const ParameterValue& default_value);

/// A member whose default hangs on another member, an enumeration of 0 to N - 1: `DefaultBy<double, Method, 2> width_mm
/// {{0.5, 2}}`. Until it is assigned to, of() is the choice's default.
template <class T, class E, std::size_t N>
class DefaultBy {
 public:
  DefaultBy(std::array<T, N> defaults) : defaults_(defaults), value_(defaults[0]) {}
  DefaultBy& operator=(T value) {
    value_ = value;
    given_ = true;
    return *this;
  }
  T of(E choice) const { return given_ ? value_ : defaults_[static_cast<std::size_t>(choice)]; }
  /// What was assigned, or the first choice's default.
  operator T() const { return value_; }

 private:
  std::array<T, N> defaults_;
  T value_;
  bool given_ = false;
};

/// A struct's descriptors with its name erased.
struct ParameterSet {
  std::vector<Parameter> parameters;
  const Parameter* find(const std::string& name) const;
  std::vector<std::string> names() const;
};

namespace detail {

template <class P>
class Collector {
 public:
  explicit Collector(ParameterSet& out) : out_(out) {}

  void number(double P::*m, const char* name, Range range, const char* help) {
    add(
        name, help, ParameterKind::number, range, [m](const P& p) { return ParameterValue(p.*m); },
        [m](P& p, const ParameterValue& v) { p.*m = std::get<double>(v); });
  }
  /// With a default for each choice of the parameter `by`, which is declared before it and named `by_name`.
  template <class E, std::size_t N>
  void number(DefaultBy<double, E, N> P::*m, const char* name, Range range, const char* help, E P::*by,
              const char* by_name) {
    add(
        name, help, ParameterKind::number, range, [m, by](const P& p) { return ParameterValue((p.*m).of(p.*by)); },
        [m](P& p, const ParameterValue& v) { p.*m = std::get<double>(v); });
    add_defaults(by_name);
  }
  template <class I>
  void integer(I P::*m, const char* name, Range range, const char* help) {
    range.min = std::max(range.min, static_cast<double>(std::numeric_limits<I>::lowest()));
    range.max = std::min(range.max, static_cast<double>(std::numeric_limits<I>::max()));
    add(
        name, help, ParameterKind::integer, range,
        [m](const P& p) { return ParameterValue(static_cast<std::int64_t>(p.*m)); },
        [m](P& p, const ParameterValue& v) { p.*m = static_cast<I>(std::get<std::int64_t>(v)); });
  }
  void flag(bool P::*m, const char* name, const char* help) {
    add(
        name, help, ParameterKind::flag, {}, [m](const P& p) { return ParameterValue(p.*m); },
        [m](P& p, const ParameterValue& v) { p.*m = std::get<bool>(v); });
  }
  void text(std::string P::*m, const char* name, const char* help) {
    add(
        name, help, ParameterKind::text, {}, [m](const P& p) { return ParameterValue(p.*m); },
        [m](P& p, const ParameterValue& v) { p.*m = std::get<std::string>(v); });
  }
  template <class E>
  void choice(E P::*m, const char* name, std::vector<std::pair<std::string, E>> choices, const char* help) {
    auto& p = add(
        name, help, ParameterKind::choice, {},
        [m, choices](const P& p) {
          for (const auto& c : choices)
            if (c.second == p.*m) return ParameterValue(c.first);
          return ParameterValue(std::string());
        },
        [m, choices](P& p, const ParameterValue& v) {
          for (const auto& c : choices)
            if (c.first == std::get<std::string>(v)) p.*m = c.second;
        });
    for (const auto& c : choices) p.choices.push_back(c.first);
  }
  template <class C, class E, std::size_t N>
  void choice(DefaultBy<C, E, N> P::*m, const char* name, std::vector<std::pair<std::string, C>> choices,
              const char* help, E P::*by, const char* by_name) {
    auto& p = add(
        name, help, ParameterKind::choice, {},
        [m, by, choices](const P& p) {
          for (const auto& c : choices)
            if (c.second == (p.*m).of(p.*by)) return ParameterValue(c.first);
          return ParameterValue(std::string());
        },
        [m, choices](P& p, const ParameterValue& v) {
          for (const auto& c : choices)
            if (c.first == std::get<std::string>(v)) p.*m = c.second;
        });
    for (const auto& c : choices) p.choices.push_back(c.first);
    add_defaults(by_name);
  }
  template <std::size_t N>
  void numbers(std::array<double, N> P::*m, const char* name, Range range, const char* help) {
    auto& p = add(
        name, help, ParameterKind::numbers, range,
        [m](const P& p) { return ParameterValue(std::vector<double>((p.*m).begin(), (p.*m).end())); },
        [m](P& p, const ParameterValue& v) {
          const auto& items = std::get<std::vector<double>>(v);
          for (std::size_t i = 0; i < N; ++i) (p.*m)[i] = items[i];
        });
    p.count = N;
  }

 private:
  /// The last parameter's defaults, one for each choice of the parameter of that name.
  void add_defaults(const std::string& by_name) {
    Parameter& p = out_.parameters.back();
    const Parameter& by = *out_.find(by_name);
    for (const std::string& choice : by.choices) {
      P example;
      by.set(&example, choice);
      p.defaults_by.emplace_back(by_name + " " + choice, p.get(&example));
    }
  }
  template <class Get, class Set>
  Parameter& add(const char* name, const char* help, ParameterKind kind, Range range, Get get, Set set) {
    Parameter p;
    p.name = name;
    p.help = help;
    p.kind = kind;
    p.range = range;
    p.get = [get](const void* q) { return get(*static_cast<const P*>(q)); };
    p.set = [set](void* q, const ParameterValue& v) { set(*static_cast<P*>(q), v); };
    out_.parameters.push_back(std::move(p));
    return out_.parameters.back();
  }
  ParameterSet& out_;
};

}  // namespace detail

template <class P>
const ParameterSet& parameters_of() {
  static const ParameterSet set = [] {
    ParameterSet s;
    detail::Collector<P> c(s);
    P::describe(c);
    return s;
  }();
  return set;
}

/// A params object with its type erased, as the stage registry, YAML and the CLI carry it.
struct AnyParams {
  const ParameterSet* set = nullptr;
  std::shared_ptr<void> object;

  template <class P>
  static AnyParams make(P defaults = {}) {
    return {&parameters_of<P>(), std::make_shared<P>(std::move(defaults))};
  }
  template <class P>
  const P& as() const {
    return *static_cast<const P*>(object.get());
  }
  ParameterValue get(const Parameter& p) const { return p.get(object.get()); }
};

}  // namespace trephine
