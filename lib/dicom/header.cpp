// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace trephine::dicom {
namespace {

constexpr std::uint32_t t_transfer_syntax = make_tag(0x0002, 0x0010), t_media_class = make_tag(0x0002, 0x0002),
                        t_image_type = make_tag(0x0008, 0x0008), t_sop_class = make_tag(0x0008, 0x0016),
                        t_modality = make_tag(0x0008, 0x0060), t_contrast = make_tag(0x0018, 0x0010),
                        t_thickness = make_tag(0x0018, 0x0050), t_tilt = make_tag(0x0018, 0x1120),
                        t_kernel = make_tag(0x0018, 0x1210), t_patient_position = make_tag(0x0018, 0x5100),
                        t_series = make_tag(0x0020, 0x000e), t_position = make_tag(0x0020, 0x0032),
                        t_orientation = make_tag(0x0020, 0x0037), t_frame_uid = make_tag(0x0020, 0x0052),
                        t_samples = make_tag(0x0028, 0x0002), t_photometric = make_tag(0x0028, 0x0004),
                        t_frames = make_tag(0x0028, 0x0008), t_rows = make_tag(0x0028, 0x0010),
                        t_columns = make_tag(0x0028, 0x0011), t_spacing = make_tag(0x0028, 0x0030),
                        t_allocated = make_tag(0x0028, 0x0100), t_stored = make_tag(0x0028, 0x0101),
                        t_high_bit = make_tag(0x0028, 0x0102), t_representation = make_tag(0x0028, 0x0103),
                        t_padding = make_tag(0x0028, 0x0120), t_padding_limit = make_tag(0x0028, 0x0121),
                        t_intercept = make_tag(0x0028, 0x1052), t_slope = make_tag(0x0028, 0x1053),
                        t_shared_groups = make_tag(0x5200, 0x9229), t_frame_groups = make_tag(0x5200, 0x9230),
                        t_pixels = make_tag(0x7fe0, 0x0010);

constexpr int max_frames = 65536;
constexpr std::uint64_t max_pixel_bytes = std::uint64_t{4} << 30;
constexpr std::uint64_t max_compressed_frame = std::uint64_t{256} << 20;  // decoded; 8192 x 8192 words take 128 MiB

bool descend(std::uint32_t tag) {
  switch (tag) {
    case t_shared_groups:
    case t_frame_groups:
    case make_tag(0x0020, 0x9113):  // plane position
    case make_tag(0x0020, 0x9116):  // plane orientation
    case make_tag(0x0028, 0x9110):  // pixel measures
    case make_tag(0x0028, 0x9145):  // pixel value transformation
    case make_tag(0x0018, 0x9314):  // CT reconstruction
    case make_tag(0x0018, 0x9329):  // CT image frame type
      return true;
    default:
      return false;
  }
}

/// Where a frame's tag stands in the functional groups (PS3.3 C.7.6.16.2).
std::uint32_t macro_of(std::uint32_t tag) {
  switch (tag) {
    case t_position:
      return make_tag(0x0020, 0x9113);
    case t_orientation:
      return make_tag(0x0020, 0x9116);
    case t_spacing:
    case t_thickness:
      return make_tag(0x0028, 0x9110);
    default:
      return make_tag(0x0028, 0x9145);
  }
}

/// Tags outside RawFrame on which HU or the choice of files depends.
bool matters(std::uint32_t tag) {
  static constexpr std::uint32_t all[] = {t_image_type,  t_sop_class, t_modality,       t_series,  t_samples,
                                          t_photometric, t_frames,    t_rows,           t_columns, t_allocated,
                                          t_stored,      t_high_bit,  t_representation, t_padding, t_padding_limit};
  return std::find(std::begin(all), std::end(all), tag) != std::end(all);
}

/// A frame's tags as text; an absent tag is nullopt.
struct RawFrame {
  std::optional<std::string> position, orientation, spacing, slope, intercept, thickness;

  std::optional<std::string>* slot(std::uint32_t tag) {
    switch (tag) {
      case t_position:
        return &position;
      case t_orientation:
        return &orientation;
      case t_spacing:
        return &spacing;
      case t_slope:
        return &slope;
      case t_intercept:
        return &intercept;
      case t_thickness:
        return &thickness;
      default:
        return nullptr;
    }
  }
  void fill_from(const RawFrame& o) {
    if (!position) position = o.position;
    if (!orientation) orientation = o.orientation;
    if (!spacing) spacing = o.spacing;
    if (!slope) slope = o.slope;
    if (!intercept) intercept = o.intercept;
    if (!thickness) thickness = o.thickness;
  }
};

class HeaderReader {
 public:
  explicit HeaderReader(const Origin& origin) : source_(origin) { h_.origin = origin; }

  FileHeader read() {
    if (source_.size() == 0) throw WalkFault{"", "an empty file, not a DICOM file"};
    const std::uint64_t begin = meta();
    const bool explicit_vr = h_.syntax->explicit_vr;
    h_.pixels = walk_elements(source_, begin, source_.size(), explicit_vr, descend,
                              [this](const Element& e, const std::vector<Level>& levels) { take(e, levels); });
    // An image without pixels was cut short, if between two elements; reports and structures have none.
    const bool image = h_.modality.empty() || h_.modality == "CT" || (h_.sop_class && h_.sop_class->is_ct);
    if (h_.pixels.tag == 0 && image) throw WalkFault{tag_name(t_pixels), "missing: the file ends before it"};
    check_pixels();
    check_frames();
    return std::move(h_);
  }

 private:
  // File meta information (group 2, explicit little endian); returns where the data set begins.
  std::uint64_t meta() {
    std::uint64_t at = 0;
    const std::uint8_t* p = source_.get(128, 4);
    if (p && std::memcmp(p, "DICM", 4) == 0) at = 132;
    std::string uid;
    while ((p = source_.get(at, 8)) && le16(p) == 2) {
      const std::uint32_t tag = make_tag(2, le16(p + 2));
      const std::string vr(reinterpret_cast<const char*>(p + 4), 2);
      std::uint64_t value = at + 8, length = le16(p + 6);
      const bool letters = vr[0] >= 'A' && vr[0] <= 'Z' && vr[1] >= 'A' && vr[1] <= 'Z';
      if (letters && !has_short_length(vr[0], vr[1])) {
        p = source_.get(at + 8, 4);
        if (!p) throw WalkFault{"", "file meta information is cut short"};
        length = le32(p);
        value = at + 12;
      } else if (!letters) {
        length = le32(p + 4);
      }
      if (value > source_.size() || length > source_.size() - value)
        throw WalkFault{tag_name(tag), fmt::format("claims {} bytes, more than the file holds", length)};
      if (tag == t_transfer_syntax && !uid.empty()) throw WalkFault{tag_name(tag), "given twice"};
      if (tag == t_transfer_syntax) uid = text({tag, value, static_cast<std::uint32_t>(length), false});
      if (tag == t_media_class &&
          trimmed(text({tag, value, static_cast<std::uint32_t>(length), false})) == "1.2.840.10008.1.3.10")
        throw WalkFault{"", "a DICOMDIR, not an image"};
      at = value + length;
    }
    if (!p) throw WalkFault{"", at == 0 ? "not a DICOM file" : "ends after its file meta information"};
    if (!uid.empty()) {
      h_.syntax = find_transfer_syntax(uid);
      if (!h_.syntax) throw WalkFault{tag_name(t_transfer_syntax), "unknown transfer syntax"};
      if (h_.syntax->encoding == Encoding::unsupported &&
          (std::strstr(h_.syntax->name, "deflated") || std::strstr(h_.syntax->name, "big endian")))
        throw WalkFault{tag_name(t_transfer_syntax), std::string(h_.syntax->name) + " is not supported"};
      return at;
    }
    // No transfer syntax: files of older programs. Only what begins as a data set does is taken for one.
    const bool letters = p[4] >= 'A' && p[4] <= 'Z' && p[5] >= 'A' && p[5] <= 'Z';
    const std::uint32_t length = letters ? le16(p + 6) : le32(p + 4);
    if (le16(p) != 8 || le16(p + 2) > 0x0100 || length > 4096) throw WalkFault{"", "not a DICOM file"};
    h_.syntax = letters ? &explicit_little_endian() : &implicit_little_endian();
    return at;
  }

  std::string text(const Element& e) {
    if (e.length > 4096) throw WalkFault{tag_name(e.tag), fmt::format("{} bytes, at most 4096 make sense", e.length)};
    const std::uint8_t* p = source_.get(e.offset, e.length);
    if (!p) throw WalkFault{tag_name(e.tag), "is cut short"};
    return std::string(reinterpret_cast<const char*>(p), e.length);
  }
  std::optional<int> unsigned_short(const Element& e) {
    const std::uint8_t* p = e.length >= 2 ? source_.get(e.offset, 2) : nullptr;
    if (!p) return std::nullopt;
    return le16(p);
  }

  void take(const Element& e, const std::vector<Level>& levels) {
    if (!levels.empty()) {
      RawFrame* frame = nullptr;
      if (levels[0].tag == t_shared_groups) frame = &shared_;
      if (levels[0].tag == t_frame_groups) {
        if (levels[0].item >= max_frames) throw WalkFault{tag_name(t_frame_groups), "more items than frames can be"};
        if (levels[0].item >= static_cast<int>(per_frame_.size())) per_frame_.resize(levels[0].item + 1);
        frame = &per_frame_[levels[0].item];
      }
      if (frame && levels.size() == 2) {
        if (auto* slot = frame->slot(e.tag); slot && levels[1].tag == macro_of(e.tag)) {
          if (*slot) fault(e.tag, "given twice in one frame");
          *slot = text(e);
        }
        if (e.tag == t_kernel && h_.kernel.empty()) h_.kernel = known_kernel(text(e));
      }
      return;
    }
    if (auto* slot = top_.slot(e.tag)) {
      if (*slot) fault(e.tag, "given twice");
      *slot = text(e);
      return;
    }
    // Elements ascend; one that matters and comes again would leave it to chance which is meant.
    if (e.tag <= last_tag_ && std::find(seen_.begin(), seen_.end(), e.tag) != seen_.end()) fault(e.tag, "given twice");
    last_tag_ = std::max(last_tag_, e.tag);
    if (matters(e.tag)) seen_.push_back(e.tag);
    switch (e.tag) {
      case t_image_type:
        h_.raw_image_type = text(e);
        h_.image_type = known_image_type(h_.raw_image_type);
        break;
      case t_sop_class:
        h_.has_sop_class = !trimmed(text(e)).empty();
        h_.sop_class = find_sop_class(text(e));
        break;
      case t_modality:
        h_.modality = known_modality(text(e));
        break;
      case t_contrast:
        h_.contrast = e.length > 0 && !trimmed(text(e)).empty();
        break;
      case t_kernel:
        h_.kernel = known_kernel(text(e));
        break;
      case t_patient_position:
        h_.patient_position = known_patient_position(text(e));
        break;
      case t_tilt:
        if (const auto v = parse_decimals(text(e)); v && v->size() == 1) h_.tilt_tag_deg = v->front();
        break;
      case t_series:
        h_.series_uid = std::string(trimmed(text(e)));
        break;
      case t_frame_uid:
        h_.frame_uid = std::string(trimmed(text(e)));
        break;
      case t_samples:
        h_.samples = unsigned_short(e).value_or(0);
        break;
      case t_photometric:
        h_.photometric = std::string(trimmed(text(e)));
        break;
      case t_frames: {
        const auto v = parse_decimals(text(e));
        const bool whole = v && v->size() == 1 && v->front() == std::floor(v->front()) && v->front() >= 0 &&
                           v->front() <= std::numeric_limits<int>::max();
        h_.frame_count = whole ? std::max(1, static_cast<int>(v->front())) : 0;
        break;
      }
      case t_rows:
        h_.rows = unsigned_short(e).value_or(0);
        break;
      case t_columns:
        h_.columns = unsigned_short(e).value_or(0);
        break;
      case t_allocated:
        h_.bits_allocated = unsigned_short(e).value_or(0);
        break;
      case t_stored:
        h_.bits_stored = unsigned_short(e).value_or(0);
        break;
      case t_high_bit:
        h_.high_bit = unsigned_short(e).value_or(-1);
        break;
      case t_representation:
        representation_ = unsigned_short(e).value_or(-1);
        break;
      case t_padding:
        padding(e, h_.padding);
        break;
      case t_padding_limit:
        padding(e, h_.padding_limit);
        break;
      default:
        break;
    }
  }
  void padding(const Element& e, std::optional<std::uint16_t>& out) {
    if (const auto v = unsigned_short(e)) out = static_cast<std::uint16_t>(*v);
  }

  void fault(std::uint32_t tag, const std::string& what) { h_.faults.push_back({tag, what}); }

  void check_pixels() {
    if (h_.pixels.tag == 0) return fault(t_pixels, "missing");
    if (h_.pixels.tag != t_pixels) return fault(h_.pixels.tag, "not supported, only integer pixel data");
    if (h_.syntax->encoding == Encoding::unsupported)
      return fault(t_transfer_syntax, std::string(h_.syntax->name) + " is not supported");
    if (h_.rows == 0) return fault(t_rows, "missing or 0");
    if (h_.columns == 0) return fault(t_columns, "missing or 0");
    const int a = h_.bits_allocated;
    if (a != 8 && a != 16 && a != 32) return fault(t_allocated, fmt::format("{}, must be 8, 16 or 32", a));
    if (h_.bits_stored < 1 || h_.bits_stored > a)
      return fault(t_stored, fmt::format("{}, must be 1 to BitsAllocated {}", h_.bits_stored, a));
    if (h_.high_bit != h_.bits_stored - 1)
      return fault(t_high_bit, fmt::format("{}, must be BitsStored - 1 = {}", h_.high_bit, h_.bits_stored - 1));
    if (representation_ != 0 && representation_ != 1)
      return fault(t_representation, "missing, or neither 0 (unsigned) nor 1 (signed)");
    h_.is_signed = representation_ == 1;
    if (h_.samples != 1) return fault(t_samples, fmt::format("{}, must be 1", h_.samples));
    if (!h_.photometric.empty() && h_.photometric != "MONOCHROME2" && h_.photometric != "MONOCHROME1")
      return fault(t_photometric, "must be MONOCHROME1 or MONOCHROME2");
    if (h_.frame_count < 1 || h_.frame_count > max_frames)
      return fault(t_frames, fmt::format("must be 1 to {}", max_frames));
    const std::uint64_t bytes = h_.frame_bytes() * static_cast<std::uint64_t>(h_.frame_count);
    if (bytes > max_pixel_bytes)
      return fault(t_rows, fmt::format("{} x {} x {} frames make {} bytes, at most 4 GiB a file are read", h_.columns,
                                       h_.rows, h_.frame_count, bytes));
    const std::uint64_t remain = source_.size() - std::min(source_.size(), h_.pixels.offset);
    if (h_.syntax->encoding == Encoding::native) {
      if (h_.pixels.undefined_length) return fault(t_pixels, "undefined length in an uncompressed transfer syntax");
      if (h_.pixels.length > remain)
        return fault(t_pixels, fmt::format("claims {} bytes, {} remain in the file", h_.pixels.length, remain));
      if (h_.pixels.length < bytes)
        return fault(t_pixels, fmt::format("{} bytes, {} are needed", h_.pixels.length, bytes));
    } else {
      if (!h_.pixels.undefined_length)
        return fault(t_pixels, std::string("not encapsulated, as ") + h_.syntax->name + " must be");
      if (h_.frame_bytes() > max_compressed_frame)
        return fault(t_rows,
                     fmt::format("a compressed frame of {} x {}, at most 256 MiB are decoded", h_.columns, h_.rows));
      if (a == 32) return fault(t_allocated, std::string("32 is not supported in ") + h_.syntax->name);
      check_fragments();
    }
  }

  // Which fragments belong to which frame: one each, or as the basic offset table says.
  void check_fragments() {
    std::vector<Fragment> all;
    try {
      all = walk_fragments(source_, h_.pixels.offset, source_.size());
    } catch (const WalkFault& f) {
      return fault(t_pixels, f.what);
    }
    if (all.size() < 2) return fault(t_pixels, "holds no compressed data");
    const Fragment table = all.front();
    h_.fragments.assign(all.begin() + 1, all.end());
    const std::size_t count = h_.fragments.size(), frames = static_cast<std::size_t>(h_.frame_count);
    if (frames == 1) {
      h_.frame_fragments = {{0, count}};
    } else if (count == frames) {
      for (std::size_t i = 0; i < frames; ++i) h_.frame_fragments.push_back({i, i + 1});
    } else {
      if (table.length != frames * 4 || table.length > ByteSource::max_value)
        return fault(t_pixels, fmt::format("{} fragments for {} frames and no offset table", count, frames));
      const std::uint8_t* p = source_.get(table.offset, table.length);
      if (!p) return fault(t_pixels, "the offset table is cut short");
      const std::uint64_t base = h_.fragments.front().offset - 8;
      std::size_t at = 0;
      for (std::size_t i = 0; i < frames; ++i) {
        if (h_.fragments[at].offset - 8 - base != le32(p + 4 * i)) return fault(t_pixels, "a wrong offset table");
        const std::size_t from = at++;
        while (at < count && (i + 1 == frames || h_.fragments[at].offset - 8 - base < le32(p + 4 * (i + 1)))) ++at;
        if (at == count && i + 1 < frames) return fault(t_pixels, "a wrong offset table");
        h_.frame_fragments.push_back({from, at});
      }
    }
    // No codec of ours makes an image larger than that; what would be read at once stays bounded by the image.
    const std::uint64_t most = 4 * h_.frame_bytes() + (1 << 20);
    for (const auto& [from, to] : h_.frame_fragments) {
      std::uint64_t stream = 0;
      for (std::size_t i = from; i < to; ++i) stream += h_.fragments[i].length;
      if (stream > most)
        return fault(t_pixels, fmt::format("{} compressed bytes for a frame of {} bytes", stream, h_.frame_bytes()));
    }
  }

  void check_frames() {
    if (h_.frame_count < 1 || h_.frame_count > max_frames) return;
    if (h_.frame_count > 1 && per_frame_.empty())
      return fault(t_frames, fmt::format("{} frames without functional groups: no geometry", h_.frame_count));
    if (!per_frame_.empty() && static_cast<int>(per_frame_.size()) != h_.frame_count)
      return fault(t_frame_groups, fmt::format("{} items for {} frames", per_frame_.size(), h_.frame_count));
    shared_.fill_from(top_);
    if (per_frame_.empty()) per_frame_.resize(1);
    for (RawFrame& raw : per_frame_) {
      raw.fill_from(shared_);
      const std::size_t before = h_.faults.size();
      h_.frames.push_back(frame_of(raw));
      if (h_.faults.size() > before) return;  // the first is enough
    }
  }

  std::optional<std::vector<double>> decimals(std::uint32_t tag, const std::optional<std::string>& raw,
                                              std::size_t count) {
    if (!raw) {
      fault(tag, "missing");
      return std::nullopt;
    }
    auto v = parse_decimals(*raw);
    if (!v) {
      fault(tag, trimmed(*raw).empty() ? "empty" : "not a number");
      return std::nullopt;
    }
    if (v->size() != count) {
      fault(tag, fmt::format("{} values, must be {}", v->size(), count));
      return std::nullopt;
    }
    return v;
  }

  Frame frame_of(const RawFrame& raw) {
    Frame f;
    if (const auto v = decimals(t_orientation, raw.orientation, 6)) f.orientation = orthonormal(*v);
    if (const auto v = decimals(t_position, raw.position, 3)) {
      f.position_mm = Vec3{(*v)[0], (*v)[1], (*v)[2]};
      for (double c : *v)
        if (!(std::abs(c) <= 1e5)) fault(t_position, "beyond 100 m");
    }
    if (const auto v = decimals(t_spacing, raw.spacing, 2)) {
      f.spacing_mm = {(*v)[1], (*v)[0]};  // the tag gives the step between rows first
      for (double s : *v)
        if (!(s >= 0.005 && s <= 50)) {
          fault(t_spacing, fmt::format("{}, must be 0.005 to 50 mm", s));
          break;
        }
    }
    const bool ct = h_.is_ct();
    if (ct || raw.slope) {
      if (const auto v = decimals(t_slope, raw.slope, 1)) {
        f.slope = v->front();
        if (!(std::abs(*f.slope) >= 1e-6 && std::abs(*f.slope) <= 1e4))
          fault(t_slope, fmt::format("{}, must be 1e-6 to 1e4 in size", *f.slope));
      }
    }
    if (ct || raw.intercept) {
      if (const auto v = decimals(t_intercept, raw.intercept, 1)) {
        f.intercept = v->front();
        if (!(std::abs(*f.intercept) <= 1e6)) fault(t_intercept, fmt::format("{}, must be within +-1e6", *f.intercept));
      }
    }
    if (raw.thickness)
      if (const auto v = parse_decimals(*raw.thickness); v && v->size() == 1 && v->front() > 0)
        f.thickness_mm = v->front();
    return f;
  }

  std::optional<std::array<Vec3, 2>> orthonormal(const std::vector<double>& v) {
    constexpr double tolerance = 2e-3;  // three decimals in the file
    Vec3 a{v[0], v[1], v[2]}, b{v[3], v[4], v[5]};
    if (!(std::abs(norm(a) - 1) <= tolerance && std::abs(norm(b) - 1) <= tolerance)) {
      fault(t_orientation, "its directions are not of unit length");
      return std::nullopt;
    }
    a = normalized(a);
    b = normalized(b);
    const double c = dot(a, b);
    if (!(std::abs(c) <= tolerance)) {
      fault(t_orientation, "its directions are not orthogonal");
      return std::nullopt;
    }
    // What is missing from the right angle is shared by both; the last step takes out the rest of second order.
    const Vec3 u = normalized(a - b * (c / 2));
    b = b - a * (c / 2);
    const Vec3 w = normalized(b - u * dot(u, b));
    const auto positive_zero = [](Vec3 d) { return Vec3{d.x + 0.0, d.y + 0.0, d.z + 0.0}; };
    return std::array<Vec3, 2>{positive_zero(u), positive_zero(w)};
  }

  ByteSource source_;
  FileHeader h_;
  RawFrame top_, shared_;
  std::vector<RawFrame> per_frame_;
  std::vector<std::uint32_t> seen_;
  std::uint32_t last_tag_ = 0;
  int representation_ = -1;
};

}  // namespace

bool FileHeader::is_ct() const { return modality == "CT" && (!has_sop_class || (sop_class && sop_class->is_ct)); }

bool FileHeader::is_localizer() const { return raw_image_type.find("LOCALIZER") != std::string::npos; }

bool FileHeader::has_geometry() const {
  for (const Frame& f : frames)
    if (f.position_mm || f.orientation) return true;
  for (const TagFault& f : faults)  // there, but wrong
    if ((f.tag == t_position || f.tag == t_orientation) && f.what != "missing") return true;
  return false;
}

FileHeader read_header(const Origin& origin) { return HeaderReader(origin).read(); }

}  // namespace trephine::dicom
