// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace trephine::dicom {

/// Where a file's bytes are: on disk, or in memory, which must outlive the objects that read from it.
struct Origin {
  std::filesystem::path file;
  std::filesystem::path folder;  ///< what is opened must lie beneath it, links or not; empty: it may lie anywhere
  std::string_view bytes;
  bool in_memory = false;

  Origin() = default;
  Origin(std::filesystem::path f) : file(std::move(f)) {}  // NOLINT: a path is one
  static Origin beneath(std::filesystem::path folder, std::filesystem::path file) {
    Origin o(std::move(file));
    o.folder = std::move(folder);
    return o;
  }
  static Origin memory(std::string_view bytes) {
    Origin o;
    o.bytes = bytes;
    o.in_memory = true;
    return o;
  }
};

/// A file that is read by position through a small window, with never more than max_value bytes at once in memory.
class ByteSource {
 public:
  static constexpr std::size_t max_value = 64 * 1024;

  /// Throws std::system_error where the file cannot be opened or is not a regular file.
  explicit ByteSource(const Origin& origin);
  ~ByteSource();
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  std::uint64_t size() const { return size_; }
  /// `count` bytes at `offset`, valid until the next call; null where not all of them exist or count > max_value.
  const std::uint8_t* get(std::uint64_t offset, std::size_t count);
  /// Reads directly into `out`; returns false where not all bytes exist.
  bool read(std::uint64_t offset, void* out, std::size_t count) const;

 private:
  int fd_ = -1;
  const char* memory_ = nullptr;  ///< instead of fd_
  std::uint64_t size_ = 0, window_begin_ = 0;
  std::vector<std::uint8_t> window_;
  std::size_t window_count_ = 0;
};

constexpr std::uint32_t make_tag(unsigned group, unsigned element) { return (group << 16) | element; }

/// One data element: where its value lies. A sequence's value is visited element by element.
struct Element {
  std::uint32_t tag = 0;
  std::uint64_t offset = 0;
  std::uint32_t length = 0;
  bool undefined_length = false;
};

/// A place where the data is not well-formed DICOM; `what` holds no text of the file.
struct WalkFault {
  std::string field, what;
  bool is_empty = false;  ///< the file has no bytes
};

/// The place of an element: the tags of the sequences around it, outermost first, and the item's index in each.
struct Level {
  std::uint32_t tag = 0;
  int item = 0;
};

constexpr int max_nesting = 16;

/// Whether the VR has a 16-bit length. All other VRs, also those of a later standard, have two reserved bytes and a
/// 32-bit length (PS3.5 7.1.2).
bool has_short_length(char first, char second);

/// Walks the data set in [begin, end) and calls `visit` for every element with a plain value (including the elements of
/// sequence items, with their path in `levels`) up to the pixel data, whose element it returns (tag 0: there is none).
/// Lengths are checked against the enclosing item and the file before anything is read; nesting is bounded. Throws
/// WalkFault. `into_sequence` says which sequences of defined length are entered; the others are skipped as a whole.
Element walk_elements(ByteSource& source, std::uint64_t begin, std::uint64_t end, bool explicit_vr,
                      const std::function<bool(std::uint32_t tag)>& into_sequence,
                      const std::function<void(const Element&, const std::vector<Level>& levels)>& visit);

struct Fragment {
  std::uint64_t offset = 0;
  std::uint32_t length = 0;
};
/// The items of encapsulated pixel data; the first is the basic offset table. Throws WalkFault where an item is longer
/// than the remaining bytes or the delimiter is missing (the file is truncated).
std::vector<Fragment> walk_fragments(ByteSource& source, std::uint64_t begin, std::uint64_t end);

/// A text such as "PixelSpacing (0028,0030)" for the tags that this room knows, else "(gggg,eeee)".
std::string tag_name(std::uint32_t tag);

inline std::uint16_t le16(const std::uint8_t* p) { return static_cast<std::uint16_t>(p[0] | (p[1] << 8)); }
inline std::uint32_t le32(const std::uint8_t* p) { return le16(p) | (std::uint32_t{le16(p + 2)} << 16); }

}  // namespace trephine::dicom
