// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace trephine {

/// One declared parameter without its struct's type, and sets of them; base/params.h makes them of declarations.

struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// `any` is a value of whatever kind it has, which a program writes and nobody gives.
enum class ParameterKind { number, integer, flag, choice, text, numbers, any, group, list, map, steps };

/// The value of a parameter: a choice is held by its name, and numbers are a fixed count of doubles.
using ParameterValue = std::variant<double, std::int64_t, bool, std::string, std::vector<double>>;

/// A map from names to declared structs that keeps the order in which they were given.
template <class T>
using Named = std::vector<std::pair<std::string, T>>;

/// The item with that name, or null where there is none.
template <class T>
const T* find_item(const Named<T>& all, const std::string& name) {
  for (const auto& item : all)
    if (item.first == name) return &item.second;
  return nullptr;
}

struct ParameterSet;

/// What a text must look like.
struct TextForm {
  const char* pattern;  ///< as a regular expression of a JSON schema
  const char* what;     ///< for messages: "64 digits from 0 to 9 and a to f"
  bool (*fits)(const std::string& text);
};
/// Anything but nothing.
extern const TextForm some_text;

/// A declared struct within another. An item of a map is named by its key, an item of a list by its number from 0, a
/// step by what it is; a group has the name "".
struct ParameterItem {
  std::string name;
  void* object = nullptr;
  const ParameterSet* set = nullptr;  ///< of a step; null: the one of the parameter
};

/// One of the structs that an item of a list of steps may be.
struct StepChoice {
  std::string name, help;
  const ParameterSet* set = nullptr;
};

struct Parameter {
  std::string name;  ///< snake_case, ends in its unit; an empty name means that the struct stands for this value alone
  std::string help;  ///< one line, shown in help and reference
  ParameterKind kind = ParameterKind::number;
  Range range;                       ///< for number, integer and numbers
  std::vector<std::string> choices;  ///< for choice
  std::size_t count = 0;             ///< for numbers: how many; for list and map: at most this many, 0 means any count
  bool required = false;             ///< a file without this key is refused
  bool zero_is_none = false;         ///< 0 is allowed even below the range and means no limit
  bool came_later = false;           ///< an identity made of the values leaves this one out where it is at its default
  bool whole = false;                ///< for numbers: whole ones
  bool left_out = false;             ///< a file that a program writes has no such key where the value is the default
  bool bare_items = false;           ///< for list and map: printed figures of its items go without its name
  const char *item_beginning = "", *item_ending = "";  ///< for map: what stands there about the name of a plain item
  const char* item_separator = ".";                    ///< between the name of an item and those of its members there
  const TextForm* form = nullptr;                      ///< for text
  std::string source = "";  ///< for text and map, what the value names: "anatomy", "material", "landmark", "file"
  /// For numbers, integers, flags, choices and texts.
  std::function<ParameterValue(const void* params)> get;
  std::function<void(void* params, const ParameterValue&)> set;  ///< the value must have passed parse_parameter
  std::function<bool(const void* params)> there;  ///< of a value that may be missing; empty: it is always there
  /// For groups, lists, maps and steps: the declaration of an item (for steps: the choices), the existing items, a
  /// function that adds one item of a name (in a map an existing item of that name is returned), and one that removes
  /// all items.
  std::function<const ParameterSet&()> item_set;
  std::vector<StepChoice> steps;
  std::function<std::vector<ParameterItem>(void* params)> items;
  std::function<void*(void* params, const std::string& name)> add;
  std::function<void(void* params)> clear;

  bool is_value() const { return kind < ParameterKind::group; }
  const ParameterSet& set_of(const ParameterItem& item) const { return item.set ? *item.set : item_set(); }
  const StepChoice* find_step(const std::string& step) const;
  /// For chaining in a declaration: v.flag(...).is_required();
  Parameter& is_required() { return required = true, *this; }
  Parameter& none_at_zero() { return zero_is_none = true, *this; }
  Parameter& is_later() { return came_later = true, *this; }
  Parameter& not_always() { return left_out = true, *this; }
  /// How a printed result names the items of a list or map: without the list's own name ("skull.volume_ml");
  /// plain ones between two words ("clear_of_sinus_mm"); members joined by another word than a dot ("left_length_mm").
  Parameter& items_alone() { return bare_items = true, *this; }
  Parameter& items_between(const char* beginning, const char* ending) {
    return item_beginning = beginning, item_ending = ending, items_alone();
  }
  Parameter& items_joined(const char* separator) { return item_separator = separator, items_alone(); }
  Parameter& of_form(const TextForm& f) { return form = &f, *this; }
  /// A group that is there only where this says so of the struct that holds it.
  Parameter& only_where(std::function<bool(const void* holder)> there);
  Parameter& names(const char* what) { return source = what, *this; }
  Parameter& at_most(std::size_t n) { return count = n, *this; }
};

/// The value's text, as in a manifest or on a help page: 0.2, true, "threshold", [1, 2, 3].
std::string to_text(const ParameterValue& value);

/// Reads one value; a list is given as its items. Returns the fault ("must be a number from 0 to 5") or "".
std::string parse_parameter(const Parameter& parameter, const std::vector<std::string>& items, ParameterValue& value);

/// What is wrong with a value that no text was read for: a number that is not finite or out of its range, a text of
/// another form, a word that is no choice. "must be a number from 0 to 5", or "".
std::string fault_of(const Parameter& parameter, const ParameterValue& value);

/// Describes a parameter for help and reference pages: "number, 0 to 5, default 0.2". `object` holds the defaults.
std::string describe_parameter(const Parameter& parameter, const void* object);

/// The descriptors of a struct, without the struct's type.
struct ParameterSet {
  std::vector<Parameter> parameters;
  std::function<std::shared_ptr<void>()> make;           ///< an object with the defaults
  std::function<std::string(const void* object)> fault;  ///< empty where the struct has none
  const Parameter* find(const std::string& name) const;
  std::vector<std::string> names() const;
  /// The only parameter, if its name is empty; else null.
  const Parameter* only_value() const;
  bool has_required() const;
};

/// Whether a file or a printed result goes without it: a value that may be missing and is, or one that is left out
/// where it is the default; a group, list or map that is left out where nothing is in it.
bool is_absent(const Parameter& parameter, const ParameterSet& set, void* object);

/// The parameter of a struct that is held by another one: `held` leads from the holder to it.
Parameter parameter_of_holder(Parameter parameter, const std::function<void*(void* holder)>& held);

/// The first fault of an object's values, of what each struct says in fault(), and of names that a map has twice:
/// "PATH: what", or "". An item of a list stands in the path by its `name`, where it has a plain one.
std::string fault_of(const ParameterSet& set, void* object);

/// How that path names an item of a list: ".skull", or "[0]" where the name is none that a path can hold.
std::string item_in_path(const std::string& name, std::size_t number);

template <class P>
const ParameterSet& parameters_of();
/// For lists and maps of plain values.
template <>
const ParameterSet& parameters_of<std::string>();
template <>
const ParameterSet& parameters_of<double>();
template <>
const ParameterSet& parameters_of<ParameterValue>();

struct AnyParams;

using Steps = Named<AnyParams>;

}  // namespace trephine
