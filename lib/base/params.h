// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/parameter.h"
#include "base/vec3.h"

namespace trephine {

/// Parameters are declared once. An options struct lists its members in a static `describe` function that takes a
/// visitor. The default is the member's initializer and is written nowhere else:
///
///   struct DecimateParams {
///     double max_deviation_mm = 0.2;
///     template <class V> static void describe(V& v) {
///       using P = DecimateParams;
///       v.number(&P::max_deviation_mm, "max_deviation_mm", Range{0, 5}, "Largest two-sided distance to the input.");
///     }
///   };
///
/// parameters_of<P>() turns that into a list of type-erased descriptors. The CLI flag (--max-deviation-mm), the YAML
/// key, validation, help, reference page, JSON schema, completion, the cache's key and the record of effective values
/// all come from this list.
///
/// A member may itself be a declared struct (a group), a list of declared structs, or a map from names to them, which
/// keeps the order in which the names were given. It may also be a list of steps: each item is one of several declared
/// structs, told by its name, and the structs may come from a registry. A struct whose only parameter has an empty name
/// stands for that value alone: `{nasion: 0.5}`. A struct may have a member `std::string fault() const`, which says
/// what is wrong with its values taken together ("NAME: what"), or returns "". What is declared earlier is also read
/// earlier.

namespace detail {

using StepsOf = std::function<Steps&(void* holder)>;
Parameter steps_parameter(const char* name, const char* help, std::vector<StepChoice> choices, const StepsOf& of);
Parameter step_parameter(const StepChoice& choice, const StepsOf& of);

template <class P, class = void>
struct HasFault : std::false_type {};
template <class P>
struct HasFault<P, std::void_t<decltype(std::declval<const P&>().fault())>> : std::true_type {};

template <class T>
T& member_at(void* object, std::size_t at) {
  return *reinterpret_cast<T*>(static_cast<char*>(object) + at);
}

/// Adds parameters by the place of their member in its struct, in bytes. So little is compiled for each of the structs.
class Declarer {
 protected:
  explicit Declarer(ParameterSet& set) : out(set) {}

  Parameter& number_at(std::size_t at, const char* name, Range range, const char* help);
  template <class T>
  Parameter& optional_value_at(std::size_t at, const char* name, const char* help, ParameterKind kind);
  Parameter& number_list_at(std::size_t at, const char* name, const char* help);
  Parameter& extent_at(std::size_t at, const char* name, const char* help);
  Parameter& words_at(std::size_t at, const char* name, const char* help);
  Parameter& flag_at(std::size_t at, const char* name, const char* help);
  Parameter& text_at(std::size_t at, const char* name, const char* help);
  Parameter& numbers_at(std::size_t at, std::size_t count, const char* name, Range range, const char* help);
  /// Of so many bytes; the values of a choice by their names.
  Parameter& integer_at(std::size_t at, std::size_t bytes, bool is_signed, const char* name, Range range,
                        const char* help);
  Parameter& choice_at(std::size_t at, std::size_t bytes, const char* name, Named<std::int64_t> choices,
                       const char* help);
  /// Of so many bytes each.
  Parameter& whole_numbers_at(std::vector<std::size_t> places, std::size_t bytes, bool is_signed, const char* name,
                              Range range, const char* help);
  Parameter& section_of(const char* name, const char* help, std::shared_ptr<const ParameterSet> set);
  Parameter& constant_of(const char* name, const char* value, const char* help);
  Parameter& add(const char* name, const char* help, ParameterKind kind);
  void add_all(const ParameterSet& set, std::size_t at, const char* prefix = "");
  /// Of a struct that may be missing: `held` gives it, made where it is not there; `there` says whether it is.
  void add_all_optional(const ParameterSet& set, const std::function<void*(void*)>& held,
                        const std::function<bool(const void*)>& there);
  static StepsOf steps_at(std::size_t at);

  template <class T>
  Parameter& group_at(std::size_t at, const char* name, const char* help) {
    Parameter& p = add_items<T>(name, help, ParameterKind::group);
    p.items = [at](void* q) { return std::vector<ParameterItem>{{"", &member_at<T>(q, at)}}; };
    p.add = [at](void* q, const std::string&) -> void* { return &member_at<T>(q, at); };
    p.clear = [at](void* q) { member_at<T>(q, at) = T(); };
    return p;
  }
  template <class T>
  Parameter& optional_at(std::size_t at, const char* name, const char* help) {
    Parameter& p = add_items<T>(name, help, ParameterKind::group);
    const auto of = [at](void* q) -> std::optional<T>& { return member_at<std::optional<T>>(q, at); };
    p.items = [of](void* q) {
      return of(q) ? std::vector<ParameterItem>{{"", &*of(q)}} : std::vector<ParameterItem>{};
    };
    p.add = [of](void* q, const std::string&) -> void* { return of(q) ? &*of(q) : &of(q).emplace(); };
    p.clear = [of](void* q) { of(q).reset(); };
    return p;
  }
  template <class T>
  Parameter& list_at(std::size_t at, const char* name, const char* help) {
    Parameter& p = add_items<T>(name, help, ParameterKind::list);
    const auto of = [at](void* q) -> std::vector<T>& { return member_at<std::vector<T>>(q, at); };
    p.items = [of](void* q) {
      std::vector<ParameterItem> all;
      for (T& item : of(q)) all.push_back({std::to_string(all.size()), &item});
      return all;
    };
    p.add = [of](void* q, const std::string&) -> void* { return &of(q).emplace_back(); };
    p.clear = [of](void* q) { of(q).clear(); };
    return p;
  }
  template <class T>
  Parameter& map_at(std::size_t at, const char* name, const char* help) {
    Parameter& p = add_items<T>(name, help, ParameterKind::map);
    const auto of = [at](void* q) -> Named<T>& { return member_at<Named<T>>(q, at); };
    p.items = [of](void* q) {
      std::vector<ParameterItem> all;
      for (auto& item : of(q)) all.push_back({item.first, &item.second});
      return all;
    };
    p.add = [of](void* q, const std::string& key) -> void* {
      for (auto& item : of(q))
        if (item.first == key) return &item.second;
      return &of(q).emplace_back(key, T()).second;
    };
    p.clear = [of](void* q) { of(q).clear(); };
    return p;
  }

  template <class T>
  Parameter& sorted_map_at(std::size_t at, const char* name, const char* help) {
    Parameter& p = add_items<T>(name, help, ParameterKind::map);
    const auto of = [at](void* q) -> std::map<std::string, T>& { return member_at<std::map<std::string, T>>(q, at); };
    p.items = [of](void* q) {
      std::vector<ParameterItem> all;
      for (auto& item : of(q)) all.push_back({item.first, &item.second});
      return all;
    };
    p.add = [of](void* q, const std::string& key) -> void* { return &of(q)[key]; };
    p.clear = [of](void* q) { of(q).clear(); };
    return p;
  }

  ParameterSet& out;

 private:
  template <class T>
  Parameter& add_items(const char* name, const char* help, ParameterKind kind) {
    Parameter& p = add(name, help, kind);
    p.item_set = &parameters_of<T>;
    return p;
  }
};

template <class P>
class Collector : Declarer {
 public:
  explicit Collector(ParameterSet& set) : Declarer(set) {}

  Parameter& number(double P::*m, const char* name, Range range, const char* help) {
    return number_at(place(m), name, range, help);
  }
  /// A number that may be missing, of a result.
  Parameter& number(std::optional<double> P::*m, const char* name, const char* help) {
    return optional_value_at<double>(place(m), name, help, ParameterKind::number);
  }
  /// A whole number that may be missing, of a result.
  Parameter& integer(std::optional<std::int64_t> P::*m, const char* name, const char* help) {
    return optional_value_at<std::int64_t>(place(m), name, help, ParameterKind::integer);
  }
  /// A text that may be missing, of a result.
  Parameter& text(std::optional<std::string> P::*m, const char* name, const char* help) {
    return optional_value_at<std::string>(place(m), name, help, ParameterKind::text);
  }
  /// A flag that may be missing, of a result.
  Parameter& flag(std::optional<bool> P::*m, const char* name, const char* help) {
    return optional_value_at<bool>(place(m), name, help, ParameterKind::flag);
  }
  /// Voxels along three axes, kept and printed as one text: "512x512x108".
  Parameter& extent(std::array<int, 3> P::*m, const char* name, const char* help) {
    return extent_at(place(m), name, help);
  }
  /// Words, kept and printed as one text with blanks between them.
  Parameter& words(std::vector<std::string> P::*m, const char* name, const char* help) {
    return words_at(place(m), name, help);
  }
  /// Any count of numbers, of a result; left out where there are none.
  Parameter& numbers(std::vector<double> P::*m, const char* name, const char* help) {
    return number_list_at(place(m), name, help);
  }
  template <class I>
  Parameter& integer(I P::*m, const char* name, Range range, const char* help) {
    range.min = std::max(range.min, static_cast<double>(std::numeric_limits<I>::lowest()));
    range.max = std::min(range.max, static_cast<double>(std::numeric_limits<I>::max()));
    return integer_at(place(m), sizeof(I), std::is_signed_v<I>, name, range, help);
  }
  Parameter& flag(bool P::*m, const char* name, const char* help) { return flag_at(place(m), name, help); }
  Parameter& text(std::string P::*m, const char* name, const char* help) { return text_at(place(m), name, help); }
  template <class E, class List = std::initializer_list<std::pair<const char*, E>>>
  Parameter& choice(E P::*m, const char* name, const List& choices, const char* help) {
    Named<std::int64_t> values;
    for (const auto& c : choices) values.emplace_back(c.first, static_cast<std::int64_t>(c.second));
    return choice_at(place(m), sizeof(E), name, std::move(values), help);
  }
  /// One of the words, or "" where none is given.
  Parameter& word(std::string P::*m, const char* name, std::vector<std::string> words, const char* help) {
    Parameter& p = text(m, name, help);
    p.kind = ParameterKind::choice;
    p.choices = std::move(words);
    return p;
  }
  template <std::size_t N>
  Parameter& numbers(std::array<double, N> P::*m, const char* name, Range range, const char* help) {
    return numbers_at(place(m), N, name, range, help);
  }
  Parameter& numbers(Vec3 P::*m, const char* name, Range range, const char* help) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    return numbers_at(place(m), 3, name, range, help);
  }
  /// Whole numbers.
  template <class I, std::size_t N>
  Parameter& integers(std::array<I, N> P::*m, const char* name, Range range, const char* help) {
    std::vector<std::size_t> places;
    for (std::size_t n = 0; n < N; ++n) places.push_back(place(m) + n * sizeof(I));
    return whole_numbers_at(std::move(places), sizeof(I), std::is_signed_v<I>, name, range, help);
  }
  /// Two members as one value, [low, high].
  template <class I>
  Parameter& integers(I P::*low, I P::*high, const char* name, Range range, const char* help) {
    return whole_numbers_at({place(low), place(high)}, sizeof(I), std::is_signed_v<I>, name, range, help);
  }
  /// A key that always has this text.
  Parameter& constant(const char* name, const char* value, const char* help) { return constant_of(name, value, help); }

  /// Declares a member that is itself a declared struct, under a key of its own.
  template <class T>
  Parameter& group(T P::*m, const char* name, const char* help) {
    return group_at<T>(place(m), name, help);
  }
  /// The same for a struct that may be absent.
  template <class T>
  Parameter& group(std::optional<T> P::*m, const char* name, const char* help) {
    return optional_at<T>(place(m), name, help);
  }
  /// Some members of P itself, under a key of their own: `describe` declares them as P's would be.
  template <class Describe>
  Parameter& section(const char* name, const char* help, Describe describe) {
    auto set = std::make_shared<ParameterSet>();
    set->make = [] { return std::make_shared<P>(); };
    Collector<P> inner(*set);
    describe(inner);
    return section_of(name, help, std::move(set));
  }
  /// A group or section that is there only where `there` says so of P.
  template <class There>
  Parameter& only_where(Parameter& group, There there) {
    return group.only_where([there](const void* q) { return there(*static_cast<const P*>(q)); });
  }
  template <class T>
  Parameter& list(std::vector<T> P::*m, const char* name, const char* help) {
    return list_at<T>(place(m), name, help);
  }
  /// The same, where a new item begins as `first` makes it of the struct so far, instead of with the defaults.
  template <class T, class First>
  Parameter& list(std::vector<T> P::*m, const char* name, const char* help, First first) {
    Parameter& p = list(m, name, help);
    p.add = [m, first](void* q, const std::string&) -> void* {
      P& holder = *static_cast<P*>(q);
      return &(holder.*m).emplace_back(first(holder));
    };
    return p;
  }
  template <class T>
  Parameter& map(Named<T> P::*m, const char* name, const char* help) {
    return map_at<T>(place(m), name, help);
  }
  template <class T>
  Parameter& map(std::map<std::string, T> P::*m, const char* name, const char* help) {
    return sorted_map_at<T>(place(m), name, help);
  }
  /// Declares a list of steps, each of which is one of the choices. The items keep their names.
  Parameter& steps(Steps P::*m, const char* name, std::vector<StepChoice> choices, const char* help) {
    return out.parameters.emplace_back(steps_parameter(name, help, std::move(choices), steps_at(place(m))));
  }
  /// Declares one choice as a group under its own name, which may be absent; where it is given it stands in the list.
  Parameter& group(Steps P::*m, const StepChoice& choice) {
    return out.parameters.emplace_back(step_parameter(choice, steps_at(place(m))));
  }
  /// Declares every parameter of a base of P.
  template <class B>
  void all_of() {
    add_all(parameters_of<B>(), place_of(static_cast<B&>(sample_)));
  }
  /// Declares every parameter of a member's struct as P's own, with `prefix` before their names.
  template <class M>
  void all_of(M P::*m, const char* prefix = "") {
    add_all(parameters_of<M>(), place(m), prefix);
  }
  /// The same of a struct of a result that may be missing, and its values with it.
  template <class M>
  void all_of(std::optional<M> P::*m) {
    const std::size_t at = place(m);
    const auto of = [at](void* q) -> std::optional<M>& { return member_at<std::optional<M>>(q, at); };
    add_all_optional(
        parameters_of<M>(), [of](void* q) -> void* { return of(q) ? &*of(q) : &of(q).emplace(); },
        [of](const void* q) { return of(const_cast<void*>(q)).has_value(); });
  }

 private:
  template <class M>
  std::size_t place(M P::*m) {
    return place_of(sample_.*m);
  }
  template <class M>
  std::size_t place_of(M& member) {
    return static_cast<std::size_t>(reinterpret_cast<char*>(&member) - reinterpret_cast<char*>(&sample_));
  }
  P sample_;
};

}  // namespace detail

template <class P>
const ParameterSet& parameters_of() {
  static const ParameterSet set = [] {
    ParameterSet s;
    detail::Collector<P> c(s);
    P::describe(c);
    s.make = [] { return std::make_shared<P>(); };
    if constexpr (detail::HasFault<P>::value) s.fault = [](const void* q) { return static_cast<const P*>(q)->fault(); };
    return s;
  }();
  return set;
}

/// A struct that declares nothing.
struct NothingDeclared {
  template <class V>
  static void describe(V&) {}
};

/// A params object without its type, as the stage registry, YAML and the CLI carry it.
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
  template <class P>
  P& as() {
    return *static_cast<P*>(object.get());
  }
  ParameterValue get(const Parameter& p) const { return p.get(object.get()); }
};

/// One value within a params object, at any depth: "spacing_mm", "shapes.skin.clear_mm", "bubbles.0".
struct ParameterLeaf {
  std::string path;
  const Parameter* parameter = nullptr;
  void* object = nullptr;  ///< the struct that holds it
  ParameterValue value() const { return parameter->get(object); }
};

/// All values, in the order of declaration and of the items. They point into `params`.
std::vector<ParameterLeaf> leaves_of(const AnyParams& params);

/// One declared parameter at any depth, with an object that holds the defaults: "shapes", "shapes.NAME.clear_mm".
struct DeclaredParameter {
  std::string path;
  const Parameter* parameter = nullptr;
  std::shared_ptr<void> defaults;
};
std::vector<DeclaredParameter> declared_of(const AnyParams& defaults);

/// Reads the text of a command line: "KEY=VALUE,KEY=VALUE" into a group or into a new item of a list,
/// "NAME:KEY=VALUE,..." or "NAME=VALUE" into an item of a map. A piece without "=" belongs to the value before it, so
/// that a value may be a list. Returns the fault or "".
std::string parse_item(const Parameter& parameter, void* params, const std::string& text);

/// The whole object as text, including empty groups, lists and maps. The key of a cache is made of it.
std::string to_text(const AnyParams& params);

}  // namespace trephine
