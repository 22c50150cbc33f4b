// SPDX-License-Identifier: GPL-3.0-or-later
// DICOM files by hand: every byte of them can be made wrong, which a library would not allow.
#pragma once
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/text.h"
#include "base/vec3.h"
#include "grid/grid.h"
#include "scratch_folder.h"

namespace synthetic {

using trephine::Vec3;

inline std::string little(std::uint64_t v, int bytes) {
  std::string s;
  for (int i = 0; i < bytes; ++i) s += static_cast<char>(v >> (8 * i));
  return s;
}

inline std::string decimals(const std::vector<double>& v) {
  std::string s;
  for (const double x : v) s += (s.empty() ? "" : "\\") + trephine::to_text(x);
  return s;
}

constexpr std::uint32_t tag(unsigned g, unsigned e) { return (g << 16) | e; }

/// Elements by tag, with their VR. Order of writing: ascending.
struct DataSet {
  struct Value {
    std::string vr, bytes;
    std::optional<std::uint32_t> claimed_length;  ///< written instead of the true one
  };
  std::map<std::uint32_t, Value> elements;

  void text(std::uint32_t t, const std::string& vr, std::string v) {
    if (v.size() % 2) v += vr == "UI" ? '\0' : ' ';
    elements[t] = {vr, v, {}};
  }
  void number(std::uint32_t t, unsigned v) { elements[t] = {"US", little(v, 2), {}}; }

  std::string bytes(bool explicit_vr = true, std::uint32_t from = 0, std::uint32_t to = 0xffffffff) const {
    std::string out;
    for (const auto& [t, v] : elements) {
      if (t < from || t > to) continue;
      out += little(t >> 16, 2) + little(t & 0xffff, 2);
      const std::uint32_t length = v.claimed_length.value_or(static_cast<std::uint32_t>(v.bytes.size()));
      if (!explicit_vr)
        out += little(length, 4);
      else if (v.vr == "OB" || v.vr == "OW" || v.vr == "SQ" || v.vr == "UN" || v.vr == "UT")
        out += v.vr + std::string(2, '\0') + little(length, 4);
      else
        out += v.vr + little(length, 2);
      out += v.bytes;
    }
    return out;
  }
};

inline std::string file_bytes(const DataSet& d, const std::string& syntax = "1.2.840.10008.1.2.1") {
  DataSet meta;
  meta.elements[tag(2, 0x01)] = {"OB", std::string("\0\1", 2), {}};
  meta.text(tag(2, 0x10), "UI", syntax);
  DataSet length;
  length.elements[tag(2, 0)] = {"UL", little(meta.bytes().size(), 4), {}};
  return std::string(128, '\0') + "DICM" + length.bytes() + meta.bytes() + d.bytes(syntax != "1.2.840.10008.1.2");
}

/// 16-bit words as RLE, each byte plane one segment of literal runs of one: PS3.5 annex G.
inline std::string rle_stream(const std::string& words) {
  std::string high, low;
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    low += std::string(1, '\0') + words[i];
    high += std::string(1, '\0') + words[i + 1];
  }
  std::string stream = little(2, 4) + little(64, 4) + little(64 + high.size(), 4);
  stream.resize(64, '\0');
  return stream + high + low;
}

/// A compressed frame as pixel data: an empty offset table, one fragment, the end.
inline DataSet::Value encapsulated(std::string stream) {
  if (stream.size() % 2) stream += '\0';
  const auto item = [](const std::string& bytes) { return little(0xe000fffe, 4) + little(bytes.size(), 4) + bytes; };
  return {"OB", item("") + item(stream) + little(0xe0ddfffe, 4) + little(0, 4), 0xffffffff};
}

/// Gaussian blobs on a background: their centroids are known.
struct Blob {
  Vec3 centre_mm;
  double sigma_mm = 5, amplitude_hu = 1000;
};

struct Scan {
  int columns = 48, rows = 40, slices = 20;
  double dx_mm = 1.5, dy_mm = 1.5, step_mm = 2;
  Vec3 u{1, 0, 0}, v{0, 1, 0};
  Vec3 centre_mm{0, 0, 0};       ///< the middle of the stack
  Vec3 drift_per_mm{0, 0, 0};    ///< added to a slice's position per mm along the normal: tan(tilt) * v
  std::vector<double> along_mm;  ///< positions along the normal; empty: uniform about the centre
  std::vector<Blob> blobs;
  double background_hu = 0;

  int bits_allocated = 16, bits_stored = 16;
  bool is_signed = false;
  double slope = 1, intercept = -1024;
  std::string uid = "1.2.3.4.5";
  std::string modality = "CT", sop_class = "1.2.840.10008.5.1.4.1.1.2", image_type = "ORIGINAL\\PRIMARY\\AXIAL";
  std::string syntax = "1.2.840.10008.1.2.1";
  std::string kernel = "H31s";
  /// The stored value of a voxel instead of what the blobs give.
  std::function<std::optional<std::int64_t>(int i, int j, int k)> stored;
  /// Changes slice k's data set before it is written.
  std::function<void(int k, DataSet&)> edit;

  Vec3 normal() const { return trephine::cross(u, v); }
  int count() const { return along_mm.empty() ? slices : static_cast<int>(along_mm.size()); }
  double along(int k) const {
    return along_mm.empty() ? (k - (slices - 1) / 2.0) * step_mm : along_mm[static_cast<std::size_t>(k)];
  }
  Vec3 position(int k) const {
    const double a = along(k);
    return centre_mm + normal() * a + drift_per_mm * a - u * (dx_mm * (columns - 1) / 2.0) -
           v * (dy_mm * (rows - 1) / 2.0);
  }
  double hu(Vec3 p) const {
    double sum = background_hu;
    for (const Blob& b : blobs) {
      const Vec3 d = p - b.centre_mm;
      sum += b.amplitude_hu * std::exp(-dot(d, d) / (2 * b.sigma_mm * b.sigma_mm));
    }
    return sum;
  }

  DataSet slice(int k) const {
    DataSet d;
    d.text(tag(0x0008, 0x0008), "CS", image_type);
    d.text(tag(0x0008, 0x0016), "UI", sop_class);
    d.text(tag(0x0008, 0x0018), "UI", uid + "." + std::to_string(k + 1));
    d.text(tag(0x0008, 0x0060), "CS", modality);
    d.text(tag(0x0010, 0x0010), "PN", "CANARY^NAME");
    d.text(tag(0x0018, 0x0050), "DS", trephine::to_text(step_mm));
    d.text(tag(0x0018, 0x1210), "SH", kernel);
    d.text(tag(0x0018, 0x5100), "CS", "HFS");
    d.text(tag(0x0020, 0x000e), "UI", uid);
    const Vec3 p = position(k);
    d.text(tag(0x0020, 0x0032), "DS", decimals({p.x, p.y, p.z}));
    d.text(tag(0x0020, 0x0037), "DS", decimals({u.x, u.y, u.z, v.x, v.y, v.z}));
    d.number(tag(0x0028, 0x0002), 1);
    d.text(tag(0x0028, 0x0004), "CS", "MONOCHROME2");
    d.number(tag(0x0028, 0x0010), static_cast<unsigned>(rows));
    d.number(tag(0x0028, 0x0011), static_cast<unsigned>(columns));
    d.text(tag(0x0028, 0x0030), "DS", decimals({dy_mm, dx_mm}));
    d.number(tag(0x0028, 0x0100), static_cast<unsigned>(bits_allocated));
    d.number(tag(0x0028, 0x0101), static_cast<unsigned>(bits_stored));
    d.number(tag(0x0028, 0x0102), static_cast<unsigned>(bits_stored - 1));
    d.number(tag(0x0028, 0x0103), is_signed);
    d.text(tag(0x0028, 0x1052), "DS", trephine::to_text(intercept));
    d.text(tag(0x0028, 0x1053), "DS", trephine::to_text(slope));
    std::string pixels;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        std::optional<std::int64_t> word;
        if (stored) word = stored(i, j, k);
        if (!word) word = std::llround((hu(p + u * (dx_mm * i) + v * (dy_mm * j)) - intercept) / slope);
        pixels +=
            little(static_cast<std::uint64_t>(*word) & ((std::uint64_t{1} << bits_stored) - 1), bits_allocated / 8);
      }
    d.elements[tag(0x7fe0, 0x0010)] = {"OW", pixels, {}};
    if (edit) edit(k, d);
    return d;
  }

  /// One file a slice; `name` gives its file name.
  void write(const ScratchFolder& folder, const std::function<std::string(int)>& name = nullptr) const {
    for (int k = 0; k < count(); ++k)
      folder.write(name ? name(k) : "slice" + std::to_string(1000 + k) + ".dcm", file_bytes(slice(k), syntax));
  }
};

/// Four blobs at the corners of an irregular tetrahedron, of different heights. Apart enough for find_blob where sigma
/// is at most a third of the extent.
inline std::vector<Blob> four_blobs(double extent_mm, double sigma_mm) {
  const double e = extent_mm;
  return {{{e, 0.9 * e, -0.8 * e}, sigma_mm, 1000},  // the marker on the left: +x
          {{-0.9 * e, e, 0.85 * e}, sigma_mm, 800},
          {{-0.8 * e, -e, -0.9 * e}, sigma_mm, 600},
          {{0.9 * e, -0.85 * e, e}, sigma_mm, 400}};
}

/// Same raster, type and voxels (Grid's own == is its lattice's).
inline bool same_volume(const trephine::grid::HuVolume& a, const trephine::grid::HuVolume& b) {
  if (a.index() != b.index() || trephine::grid::lattice_of(a) != trephine::grid::lattice_of(b)) return false;
  return std::visit([&](const auto& g) { return g.voxels == std::get<std::decay_t<decltype(g)>>(b).voxels; }, a);
}

/// The blob's centroid in the volume, from what is above the background within 3.5 sigma, and the largest value there.
struct Found {
  Vec3 centroid_mm;
  double peak_hu = 0;
};
inline Found find_blob(const trephine::grid::HuVolume& volume, const Blob& blob, double background_hu) {
  return std::visit(
      [&](const auto& g) {
        Found f;
        double sum = 0;
        for (int k = 0; k < g.size[2]; ++k)
          for (int j = 0; j < g.size[1]; ++j)
            for (int i = 0; i < g.size[0]; ++i) {
              const Vec3 p = g.to_world_mm({double(i), double(j), double(k)});
              if (norm(p - blob.centre_mm) > 3.5 * blob.sigma_mm) continue;
              const double w = double(g.at(i, j, k)) - background_hu;
              sum += w;
              f.centroid_mm += w * (p - blob.centre_mm);
              f.peak_hu = std::max(f.peak_hu, w);
            }
        f.centroid_mm = blob.centre_mm + f.centroid_mm / sum;
        return f;
      },
      volume);
}

}  // namespace synthetic
