// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Small writers of label files, as other programs make them: .nii, .nii.gz (NIfTI-1 and 2, either byte order, any
// datatype), .nrrd and .seg.nrrd.
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "base/text.h"
#include "grid/grid.h"
#include "grid/nrrd_header.h"

namespace trephine {

/// Whole numbers on a lattice (LPS), layers fastest.
struct TestLabels {
  grid::Lattice lattice;
  int layers = 1;
  std::vector<int> values;
};

enum class Form { sform, qform, pixdim };

struct NiftiStyle {
  int version = 1;
  Form form = Form::sform;
  bool big_endian = false, gzip = false;
  int datatype = 4;
  double slope = 0, inter = 0;  ///< stored = (value - inter) / slope
  double per_mm = 1;            ///< units in a mm: 0.001 metres, 1000 micrometres
  std::size_t extension_bytes = 0;
};

class ByteWriter {
 public:
  ByteWriter(std::size_t size, bool big) : bytes(size, '\0'), big_(big) {}
  template <class T>
  void put(std::size_t at, T v) {
    char b[sizeof(T)];
    std::memcpy(b, &v, sizeof(T));
    if (big_) std::reverse(b, b + sizeof(T));
    bytes.replace(at, sizeof(T), b, sizeof(T));
  }
  template <class T>
  void append(T v) {
    const std::size_t at = bytes.size();
    bytes.resize(at + sizeof(T));
    put(at, v);
  }
  std::string bytes;

 private:
  bool big_;
};

/// The quaternion (b, c, d) and qfac of a direction matrix (RAS).
inline std::array<double, 4> quaternion_of(Mat3 m) {
  double qfac = 1;
  if (determinant(m) < 0) {
    qfac = -1;
    m.column[2] = -m.column[2];
  }
  const double r11 = m.column[0].x, r21 = m.column[0].y, r31 = m.column[0].z, r12 = m.column[1].x, r22 = m.column[1].y,
               r32 = m.column[1].z, r13 = m.column[2].x, r23 = m.column[2].y, r33 = m.column[2].z;
  const double a2 = 1 + r11 + r22 + r33;
  double a, b, c, d;
  if (a2 > 0.5) {
    a = 0.5 * std::sqrt(a2);
    b = (r32 - r23) / (4 * a), c = (r13 - r31) / (4 * a), d = (r21 - r12) / (4 * a);
  } else if (r11 > r22 && r11 > r33) {
    b = 0.5 * std::sqrt(1 + r11 - r22 - r33);
    a = (r32 - r23) / (4 * b), c = (r12 + r21) / (4 * b), d = (r13 + r31) / (4 * b);
  } else if (r22 > r33) {
    c = 0.5 * std::sqrt(1 + r22 - r11 - r33);
    a = (r13 - r31) / (4 * c), b = (r12 + r21) / (4 * c), d = (r23 + r32) / (4 * c);
  } else {
    d = 0.5 * std::sqrt(1 + r33 - r11 - r22);
    a = (r21 - r12) / (4 * d), b = (r13 + r31) / (4 * d), c = (r23 + r32) / (4 * d);
  }
  if (a < 0) b = -b, c = -c, d = -d;
  return {b, c, d, qfac};
}

template <class Real, class Code, class Size>
void put_header(ByteWriter& w, const TestLabels& t, const NiftiStyle& s, const std::array<std::size_t, 8>& at) {
  const grid::Lattice& l = t.lattice;
  const auto ras = [](Vec3 v) { return Vec3{-v.x, -v.y, v.z}; };
  Mat3 m;
  for (int a = 0; a < 3; ++a) m.column[a] = ras(l.direction.column[a]);
  const Vec3 origin = ras(l.origin_mm) * s.per_mm;
  const auto q = quaternion_of(m);
  const int dims[8] = {3, l.size[0], l.size[1], l.size[2], 1, 1, 1, 1};
  const double pix[8] = {q[3], l.spacing_mm.x * s.per_mm, l.spacing_mm.y * s.per_mm, l.spacing_mm.z * s.per_mm, 0, 0, 0,
                         0};
  for (std::size_t i = 0; i < 8; ++i) {
    w.put<Size>(at[0] + i * sizeof(Size), Size(dims[i]));
    w.put<Real>(at[1] + i * sizeof(Real), Real(pix[i]));
  }
  w.put<Real>(at[2], Real(s.slope));
  w.put<Real>(at[2] + sizeof(Real), Real(s.inter));
  w.put<Code>(at[3], Code(s.form == Form::qform));
  w.put<Code>(at[4], Code(s.form == Form::sform));
  for (int i = 0; i < 3; ++i) {
    w.put<Real>(at[5] + std::size_t(i) * sizeof(Real), Real(q[std::size_t(i)]));
    w.put<Real>(at[6] + std::size_t(i) * sizeof(Real), Real(origin[i]));
    for (int c = 0; c < 3; ++c)
      w.put<Real>(at[7] + std::size_t(i * 4 + c) * sizeof(Real), Real(m.column[c][i] * l.spacing_mm[c] * s.per_mm));
    w.put<Real>(at[7] + std::size_t(i * 4 + 3) * sizeof(Real), Real(origin[i]));
  }
}

inline std::string nifti_bytes(const TestLabels& t, const NiftiStyle& s) {
  const std::size_t header = s.version == 1 ? 348 : 540;
  ByteWriter w(header, s.big_endian);
  w.put<std::int32_t>(0, std::int32_t(header));
  const int bits = s.datatype == 2 || s.datatype == 256                       ? 8
                   : s.datatype == 4 || s.datatype == 512                     ? 16
                   : s.datatype == 8 || s.datatype == 16 || s.datatype == 768 ? 32
                                                                              : 64;
  const double offset = double(header + 4 + s.extension_bytes);
  const int units = s.per_mm == 0.001 ? 1 : s.per_mm == 1000 ? 3 : 2;
  if (s.version == 1) {
    put_header<float, std::int16_t, std::int16_t>(w, t, s, {40, 76, 112, 252, 254, 256, 268, 280});
    w.put<std::int16_t>(70, std::int16_t(s.datatype));
    w.put<std::int16_t>(72, std::int16_t(bits));
    w.put<float>(108, float(offset));
    w.put<std::uint8_t>(123, std::uint8_t(units));
    w.bytes.replace(344, 4, std::string("n+1\0", 4));
  } else {
    put_header<double, std::int32_t, std::int64_t>(w, t, s, {16, 104, 176, 344, 348, 352, 376, 400});
    w.put<std::int16_t>(12, std::int16_t(s.datatype));
    w.put<std::int16_t>(14, std::int16_t(bits));
    w.put<std::int64_t>(168, std::int64_t(offset));
    w.put<std::int32_t>(500, units);
    w.bytes.replace(4, 8, std::string("n+2\0\r\n\x1a\n", 8));
  }
  w.bytes.append(4 + s.extension_bytes, '\0');
  for (const int value : t.values) {
    const double v = s.slope != 0 ? (value - s.inter) / s.slope : value;
    switch (s.datatype) {
      case 2:
        w.append<std::uint8_t>(std::uint8_t(v));
        break;
      case 4:
        w.append<std::int16_t>(std::int16_t(v));
        break;
      case 8:
        w.append<std::int32_t>(std::int32_t(v));
        break;
      case 16:
        w.append<float>(float(v));
        break;
      case 64:
        w.append<double>(v);
        break;
      case 256:
        w.append<std::int8_t>(std::int8_t(v));
        break;
      case 512:
        w.append<std::uint16_t>(std::uint16_t(v));
        break;
      case 768:
        w.append<std::uint32_t>(std::uint32_t(v));
        break;
      case 1024:
        w.append<std::int64_t>(std::int64_t(v));
        break;
      default:
        w.append<std::uint64_t>(std::uint64_t(v));
    }
  }
  return s.gzip ? grid::detail::gzip_compress(w.bytes) : w.bytes;
}

/// A NRRD of unsigned char, gzip; `keys` are whole lines ("Segment0_Name:=brain").
inline std::string nrrd_bytes(const TestLabels& t, const std::vector<std::string>& keys, bool ras = false) {
  const auto text = [&](Vec3 v) {
    if (ras) v = {-v.x, -v.y, v.z};
    return "(" + to_text(v.x) + "," + to_text(v.y) + "," + to_text(v.z) + ")";
  };
  const grid::Lattice& l = t.lattice;
  const bool list = t.layers > 1;
  std::string out = "NRRD0004\ntype: unsigned char\ndimension: " + std::string(list ? "4" : "3") +
                    "\nspace: " + (ras ? "right-anterior-superior" : "left-posterior-superior") + "\nsizes:";
  if (list) out += " " + std::to_string(t.layers);
  for (const int n : l.size) out += " " + std::to_string(n);
  out += "\nspace directions:" + std::string(list ? " none" : "");
  for (int a = 0; a < 3; ++a) out += " " + text(l.direction.column[a] * l.spacing_mm[a]);
  out += "\nkinds:" + std::string(list ? " list" : "") +
         " domain domain domain\nencoding: gzip\nspace origin: " + text(l.origin_mm) + "\n";
  for (const std::string& k : keys) out += k + "\n";
  std::string data;
  for (const int v : t.values) data.push_back(static_cast<char>(v));
  return out + "\n" + grid::detail::gzip_compress(data);
}

}  // namespace trephine
