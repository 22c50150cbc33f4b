// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/elements.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "base/error.h"
#include "base/open_beneath.h"
#include "dicom/attributes.h"
#include "dicom/identity.h"

namespace trephine::dicom {

ByteSource::ByteSource(const Origin& origin) {
  if (origin.in_memory) {
    memory_ = origin.bytes.data();
    size_ = origin.bytes.size();
    return;
  }
  // O_NONBLOCK, because a FIFO must not block the scan.
  fd_ = origin.folder.empty() ? ::open(origin.file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)
                              : open_beneath(origin.folder, origin.file.lexically_relative(origin.folder));
  // A file that is not opened for want of a descriptor is no file that cannot be read: no slice may be lost by it.
  if (fd_ < 0 && (errno == EMFILE || errno == ENFILE))
    throw Error(ExitCode::io, "", "open", "too few file descriptors: raise the limit (ulimit -n)");
  if (fd_ < 0) throw std::system_error(errno, std::generic_category());
  struct stat st {};
  if (::fstat(fd_, &st) != 0 || !S_ISREG(st.st_mode)) {
    ::close(fd_);
    throw std::system_error(EINVAL, std::generic_category());
  }
  size_ = static_cast<std::uint64_t>(st.st_size);
}

ByteSource::~ByteSource() {
  if (fd_ >= 0) ::close(fd_);
}

bool ByteSource::read(std::uint64_t offset, void* out, std::size_t count) const {
  auto* p = static_cast<char*>(out);
  if (count == 0) return true;
  if (fd_ < 0) {
    if (offset > size_ || count > size_ - offset) return false;
    std::memcpy(p, memory_ + offset, count);
    return true;
  }
  while (count > 0) {
    const ssize_t n = ::pread(fd_, p, count, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    p += n;
    offset += static_cast<std::uint64_t>(n);
    count -= static_cast<std::size_t>(n);
  }
  return true;
}

const std::uint8_t* ByteSource::get(std::uint64_t offset, std::size_t count) {
  if (count > max_value || offset > size_ || count > size_ - offset) return nullptr;
  if (fd_ < 0) return reinterpret_cast<const std::uint8_t*>(memory_) + offset;
  if (offset < window_begin_ || offset + count > window_begin_ + window_count_) {
    // Most headers fit in the first window; later ones are read where a large value was skipped.
    constexpr std::size_t usual = 8 * 1024;
    const std::size_t want = static_cast<std::size_t>(std::min<std::uint64_t>(std::max(count, usual), size_ - offset));
    window_.resize(std::max(window_.size(), want));
    window_count_ = 0;
    if (!read(offset, window_.data(), want)) return nullptr;
    window_begin_ = offset;
    window_count_ = want;
  }
  return window_.data() + (offset - window_begin_);
}

namespace {

constexpr std::uint32_t item_tag = make_tag(0xfffe, 0xe000), item_end = make_tag(0xfffe, 0xe00d),
                        sequence_end = make_tag(0xfffe, 0xe0dd), pixel_data = make_tag(0x7fe0, 0x0010);
constexpr std::uint32_t undefined = 0xffffffff;

constexpr unsigned vr_code(char a, char b) { return (static_cast<unsigned>(a) << 8) | static_cast<unsigned>(b); }

class Walker {
 public:
  Walker(ByteSource& source, const std::function<bool(std::uint32_t)>& into_sequence,
         const std::function<void(const Element&, const std::vector<Level>&)>& visit)
      : source_(source), into_sequence_(into_sequence), visit_(visit) {}

  /// Returns the position behind the data set. `until_item_end` says that it is an item of undefined length.
  std::uint64_t data_set(std::uint64_t at, std::uint64_t end, bool explicit_vr, bool until_item_end) {
    while (at < end && pixels_.tag == 0) {
      Head h = head(at, end, explicit_vr);
      if (h.tag == item_end && until_item_end) return h.value;
      if ((h.tag >> 16) == 0xfffe) fail(h.tag, "a delimiter where no sequence is open");
      const bool top = levels_.empty();
      if (top && h.tag >= make_tag(0x7fe0, 0x0008) && h.tag <= pixel_data) {
        pixels_ = {h.tag, h.value, h.length, h.length == undefined};
        return h.value;
      }
      if (h.length == undefined) {
        if (h.vr != 0 && h.vr != vr_code('S', 'Q') && h.vr != vr_code('U', 'N'))
          fail(h.tag, "undefined length where the value representation has none");
        at = sequence(h.tag, h.value, end, explicit_vr && h.vr != vr_code('U', 'N'), true);
        continue;
      }
      if (h.length > end - h.value) fail(h.tag, fmt::format("claims {} bytes, {} remain", h.length, end - h.value));
      if ((h.vr == vr_code('S', 'Q') || h.vr == 0) && into_sequence_(h.tag))
        sequence(h.tag, h.value, h.value + h.length, explicit_vr, false);
      else if (h.vr != vr_code('S', 'Q'))
        visit_({h.tag, h.value, h.length, false}, levels_);
      at = h.value + h.length;
    }
    if (until_item_end && pixels_.tag == 0) throw WalkFault{where(), "an item is not closed"};
    return at;
  }
  Element pixels() const { return pixels_; }

 private:
  struct Head {
    std::uint32_t tag;
    unsigned vr;  // 0: implicit
    std::uint32_t length;
    std::uint64_t value;
  };

  Head head(std::uint64_t at, std::uint64_t end, bool explicit_vr) {
    if (end - at < 8) throw WalkFault{where(), "an element is cut short"};
    const std::uint8_t* p = source_.get(at, 8);
    if (!p) throw WalkFault{where(), "an element is cut short"};
    Head h{make_tag(le16(p), le16(p + 2)), 0, le32(p + 4), at + 8};
    if (!explicit_vr || (h.tag >> 16) == 0xfffe) return h;
    const auto upper = [](std::uint8_t c) { return c >= 'A' && c <= 'Z'; };
    if (!upper(p[4]) || !upper(p[5])) fail(h.tag, "no value representation");
    h.vr = vr_code(static_cast<char>(p[4]), static_cast<char>(p[5]));
    if (has_short_length(static_cast<char>(p[4]), static_cast<char>(p[5]))) {
      h.length = le16(p + 6);
      return h;
    }
    if (end - at < 12) fail(h.tag, "an element is cut short");
    p = source_.get(at + 8, 4);
    if (!p) fail(h.tag, "an element is cut short");
    h.length = le32(p);
    h.value = at + 12;
    return h;
  }

  std::uint64_t sequence(std::uint32_t tag, std::uint64_t at, std::uint64_t end, bool explicit_vr, bool until_end) {
    if (static_cast<int>(levels_.size()) >= max_nesting)
      fail(tag, fmt::format("sequences nested deeper than {}", max_nesting));
    levels_.push_back({tag, 0});
    for (;; ++levels_.back().item) {
      if (!until_end && at == end) break;
      const Head h = head(at, end, false);
      if (h.tag == sequence_end && until_end) {
        at = h.value;
        break;
      }
      if (h.tag != item_tag) fail(tag, "a sequence holds something that is not an item");
      if (h.length == undefined) {
        at = data_set(h.value, end, explicit_vr, true);
      } else {
        if (h.length > end - h.value)
          fail(tag, fmt::format("an item claims {} bytes, {} remain", h.length, end - h.value));
        data_set(h.value, h.value + h.length, explicit_vr, false);
        at = h.value + h.length;
      }
    }
    levels_.pop_back();
    return at;
  }

  std::string where() const { return levels_.empty() ? "data set" : tag_name(levels_.back().tag); }
  [[noreturn]] static void fail(std::uint32_t tag, const std::string& what) { throw WalkFault{tag_name(tag), what}; }

  ByteSource& source_;
  const std::function<bool(std::uint32_t)>& into_sequence_;
  const std::function<void(const Element&, const std::vector<Level>&)>& visit_;
  std::vector<Level> levels_;
  Element pixels_;
};

}  // namespace

bool has_short_length(char a, char b) {
  switch (vr_code(a, b)) {
    case vr_code('A', 'E'):
    case vr_code('A', 'S'):
    case vr_code('A', 'T'):
    case vr_code('C', 'S'):
    case vr_code('D', 'A'):
    case vr_code('D', 'S'):
    case vr_code('D', 'T'):
    case vr_code('F', 'L'):
    case vr_code('F', 'D'):
    case vr_code('I', 'S'):
    case vr_code('L', 'O'):
    case vr_code('L', 'T'):
    case vr_code('P', 'N'):
    case vr_code('S', 'H'):
    case vr_code('S', 'L'):
    case vr_code('S', 'S'):
    case vr_code('S', 'T'):
    case vr_code('T', 'M'):
    case vr_code('U', 'I'):
    case vr_code('U', 'L'):
    case vr_code('U', 'S'):
      return true;
    default:
      return false;
  }
}

Element walk_elements(ByteSource& source, std::uint64_t begin, std::uint64_t end, bool explicit_vr,
                      const std::function<bool(std::uint32_t)>& into_sequence,
                      const std::function<void(const Element&, const std::vector<Level>&)>& visit) {
  Walker walker(source, into_sequence, visit);
  walker.data_set(begin, end, explicit_vr, false);
  return walker.pixels();
}

std::vector<Fragment> walk_fragments(ByteSource& source, std::uint64_t begin, std::uint64_t end) {
  std::vector<Fragment> fragments;
  for (std::uint64_t at = begin;;) {
    const std::uint8_t* p = end - at >= 8 ? source.get(at, 8) : nullptr;
    if (!p) throw WalkFault{tag_name(pixel_data), "compressed pixel data is cut short"};
    const std::uint32_t tag = make_tag(le16(p), le16(p + 2)), length = le32(p + 4);
    at += 8;
    if (tag == sequence_end) return fragments;
    if (tag != item_tag)
      throw WalkFault{tag_name(pixel_data), "compressed pixel data holds something that is not an item"};
    if (length > end - at)
      throw WalkFault{tag_name(pixel_data), fmt::format("a fragment claims {} bytes, {} remain", length, end - at)};
    fragments.push_back({at, length});
    at += length;
  }
}

std::string tag_name(std::uint32_t tag) {
  const char* name = nullptr;
  switch (tag) {
    case make_tag(0x0002, 0x0010):
      name = "TransferSyntaxUID";
      break;
    case make_tag(0x0020, 0x000d):
      name = "StudyInstanceUID";
      break;
    case make_tag(0x0028, 0x0008):
      name = "NumberOfFrames";
      break;
    case make_tag(0x7fe0, 0x0008):
      name = "FloatPixelData";
      break;
    case make_tag(0x7fe0, 0x0009):
      name = "DoubleFloatPixelData";
      break;
    case pixel_data:
      name = "PixelData";
      break;
    default:
      if (const int a = find_attribute(tag); a >= 0) name = attributes()[static_cast<std::size_t>(a)].keyword;
      for (int which = 0; which < identity_count; ++which)
        if (identity_tag(which) == tag) name = identity_keyword(which);
  }
  const std::string number = fmt::format("({:04X},{:04X})", tag >> 16, tag & 0xffff);
  return name ? std::string(name) + " " + number : number;
}

}  // namespace trephine::dicom
