// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace trephine::slicer {

/// A scene in MRML: one element a node, with an ID of its class and number, which other nodes refer to. What 3D Slicer
/// takes from a node stands in ReadXMLAttributes of its class; what is left out is at Slicer's default.
class Mrml {
 public:
  using Attributes = std::vector<std::pair<std::string, std::string>>;

  /// Adds a node of a class (vtkMRML...Node), whose element is called `tag`; returns its ID. Lists of nodes show data,
  /// cameras and views alone.
  std::string add(const std::string& tag, const std::string& node_class, const std::string& name,
                  const Attributes& attributes);
  /// One of which there is one of each tag in a scene; its ID is the class and the tag.
  std::string add_singleton(const std::string& tag, const std::string& node_class, const std::string& singleton,
                            const std::string& name, const Attributes& attributes);
  /// One that is displayed and stored: it refers to both, in the words of old and new versions. `more` are references
  /// of other roles, "role:ID;".
  std::string add_data(const std::string& tag, const std::string& node_class, const std::string& name,
                       const std::string& display, const std::string& storage, const Attributes& attributes,
                       const std::string& more = "");
  /// Lengths are mm, and that volume is selected where there is one.
  void add_units(const std::string& volume);

  std::string text(const std::string& program) const;

 private:
  void element(const std::string& tag, const std::string& id, const std::string& name, const std::string& singleton,
               bool hidden, const Attributes& attributes);
  std::map<std::string, int> numbers_;  ///< of each class, how many there are
  std::string elements_;
};

}  // namespace trephine::slicer
