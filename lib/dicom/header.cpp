// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "dicom/attributes.h"
#include "dicom/header_frame.h"
#include "dicom/header_tags.h"

namespace trephine::dicom {
namespace {

bool descend(std::uint32_t tag) {
  switch (tag) {
    case t_modality_lut:  // only that it is there
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

/// Tags, other than those of RawFrame, on which HU or the choice of files depends.
bool matters(std::uint32_t tag) {
  static constexpr std::uint32_t all[] = {
      t_image_type,  t_sop_class,        t_modality,       t_series,       t_samples,
      t_photometric, t_frames,           t_rows,           t_columns,      t_allocated,
      t_stored,      t_high_bit,         t_representation, t_padding,      t_padding_limit,
      t_study,       t_frame_uid,        t_acquisition,    t_kernel,       t_kvp,
      t_contrast,    t_patient_position, t_burned_in,      t_rescale_type, t_aspect};
  return is_identity_tag(tag) || std::find(std::begin(all), std::end(all), tag) != std::end(all);
}

class HeaderReader {
 public:
  explicit HeaderReader(const Origin& origin) : source_(origin) {
    h_.origin = origin;
    h_.said.resize(attributes().size());
  }

  FileHeader read() {
    if (source_.size() == 0) throw WalkFault{"", "an empty file, not a DICOM file", true};
    if (const std::uint8_t* p = source_.get(0, 4); p && std::memcmp(p, "PK\3\4", 4) == 0)
      throw WalkFault{"", "a ZIP archive, not a DICOM file: choose the archive itself in place of its folder"};
    const std::uint64_t begin = meta();
    const bool explicit_vr = h_.syntax->explicit_vr;
    h_.pixels = walk_elements(source_, begin, source_.size(), explicit_vr, descend,
                              [this](const Element& e, const std::vector<Level>& levels) { take(e, levels); });
    // An image without pixels was cut short between two elements. Reports and structure sets have no pixels.
    const bool image = h_.modality.empty() || h_.modality == "CT" || (h_.sop_class && h_.sop_class->is_ct);
    if (h_.pixels.tag == 0 && image) throw WalkFault{tag_name(t_pixels), "missing: the file ends before it"};
    check_pixels(h_, source_, representation_);
    check_frames();
    check_rest();
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
      h_.syntax = find_transfer_syntax(trimmed(uid));
      if (!h_.syntax) throw WalkFault{tag_name(t_transfer_syntax), "unknown transfer syntax"};
      if (h_.syntax->encoding == Encoding::unreadable)
        throw WalkFault{tag_name(t_transfer_syntax), std::string(h_.syntax->name) + " is not supported"};
      return at;
    }
    // Files of older programs have no transfer syntax. They are accepted only if they begin as a data set does.
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

  // What is compared over the series; of a long text the beginning.
  void compare(const Element& e) {
    const int which = find_attribute(e.tag);
    if (which < 0) return;
    const Attribute& a = attributes()[static_cast<std::size_t>(which)];
    if (a.rule == AttributeRule::own || a.rule == AttributeRule::fixed) return;
    const std::uint32_t length = std::min<std::uint32_t>(e.length, 4096);
    const std::uint8_t* p = source_.get(e.offset, length);
    std::string_view value(reinterpret_cast<const char*>(p), p ? length : 0);
    if (e.tag == t_image_type)  // what follows names a scanner's own steps, which differ by slice
      for (std::size_t at = 0, parts = 0; at < value.size(); ++at)
        if (value[at] == '\\' && ++parts == 3) value = value.substr(0, at);
    h_.said[static_cast<std::size_t>(which)] = digest_of(value, a.vr);
  }

  void take(const Element& e, const std::vector<Level>& levels) {
    if (!levels.empty()) {
      if (levels[0].tag == t_modality_lut && levels.size() == 1) modality_lut_ = true;
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
        if (e.tag == t_rescale_type && levels[1].tag == macro_of(e.tag)) take_rescale_type(e);
        if (e.tag == t_kernel && h_.kernel.empty()) h_.kernel = known_kernel(text(e));
      }
      return;
    }
    compare(e);
    if (auto* slot = top_.slot(e.tag)) {
      if (*slot) fault(e.tag, "given twice");
      *slot = text(e);
      return;
    }
    // Elements stand in ascending order. If one that matters occurred twice, it would be unclear which of them holds.
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
        h_.contrast = known_contrast(text(e));
        break;
      case t_kernel:
        h_.kernel = known_kernel(text(e));
        break;
      case t_kvp:
        if (const auto v = parse_decimals(text(e)); v && v->size() == 1) h_.kvp = v->front();
        break;
      case t_rescale_type:
        take_rescale_type(e);
        break;
      case t_burned_in:
        h_.burned_in = trimmed(text(e)) == "YES";
        break;
      case t_lossy:
        h_.lossy = trimmed(text(e)) == "01";
        break;
      case t_quality:
        h_.quality_control = trimmed(text(e)) == "YES";
        break;
      case t_aspect:
        aspect_ = parse_decimals(text(e));
        break;
      case t_study:
        h_.study_uid = std::string(trimmed(text(e)));
        break;
      case t_acquisition:
        h_.acquisition = std::string(trimmed(text(e)));
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
        if (is_identity_tag(e.tag)) h_.identity.take(e.tag, text(e));
        break;
    }
  }
  void padding(const Element& e, std::optional<std::uint16_t>& out) {
    if (const auto v = unsigned_short(e)) out = static_cast<std::uint16_t>(*v);
  }

  void fault(std::uint32_t tag, const std::string& what) { h_.faults.push_back({tag, what}); }

  // Of several frames the first that is something else than HU.
  void take_rescale_type(const Element& e) {
    if (h_.rescale_type.empty() || h_.rescale_type == "HU") h_.rescale_type = known_rescale_type(text(e));
  }

  // What follows the pixel data must not say anything else of the image: it would be left to chance which is meant.
  void check_rest() {
    if (h_.pixels.tag != t_pixels) return;
    std::uint64_t at = h_.pixels.offset + h_.pixels.length;
    if (h_.pixels.undefined_length) {
      if (h_.fragments.empty()) return;
      at = h_.fragments.back().offset + h_.fragments.back().length + 8;  // and the delimiter
    }
    const auto another_file = [this](std::uint64_t from) {
      const std::uint8_t* p = source_.get(from + 128, 4);
      if (!p || std::memcmp(p, "DICM", 4) != 0) return false;
      fault(t_pixels, "another file follows it: two files were joined");
      return true;
    };
    if (at >= source_.size() || another_file(at)) return;
    bool told = false;
    const auto visit = [&](const Element& e, const std::vector<Level>&) {
      if (told) return;
      told = another_file(e.offset + e.length);
      if (told || !(matters(e.tag) || top_.slot(e.tag))) return;
      told = true;
      fault(e.tag, "given after the pixel data");
    };
    try {
      const auto nowhere = [](std::uint32_t) { return false; };
      if (walk_elements(source_, at, source_.size(), h_.syntax->explicit_vr, nowhere, visit).tag != 0)
        fault(t_pixels, "given twice");
    } catch (const WalkFault&) {  // padding to a block's size and the like
    }
  }

  void check_frames() {
    if (modality_lut_)
      fault(t_modality_lut, "must be absent: values come from RescaleSlope and RescaleIntercept alone");
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
      h_.frames.push_back(frame_of(raw, h_.is_ct(), h_.faults));
      if (h_.faults.size() > before) return;  // the first is enough
    }
    check_aspect();
  }

  void check_aspect() {
    if (!aspect_ || h_.frames.empty() || !h_.frames.front().spacing_mm) return;
    const auto [x, y] = *h_.frames.front().spacing_mm;
    const std::vector<double>& a = *aspect_;  // of the height of a pixel to its width
    if (a.size() != 2 || !(a[0] > 0 && a[1] > 0) || !(std::abs(a[0] / a[1] / (y / x) - 1) <= 0.01))
      fault(t_aspect, "contradicts PixelSpacing");
  }

  ByteSource source_;
  FileHeader h_;
  RawFrame top_, shared_;
  std::vector<RawFrame> per_frame_;
  std::vector<std::uint32_t> seen_;
  std::uint32_t last_tag_ = 0;
  int representation_ = -1;
  bool modality_lut_ = false;
  std::optional<std::vector<double>> aspect_;
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
