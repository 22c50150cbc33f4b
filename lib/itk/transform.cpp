// SPDX-License-Identifier: GPL-3.0-or-later
#include "itk/transform.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "base/degree.h"
#include "base/error.h"
#include "base/text.h"
#include "base/write_file.h"
#include "itk/header_numbers.h"

namespace trephine::itk {
namespace {

constexpr std::uint64_t max_bytes = 1 << 16;

Mat3 product(const Mat3& a, const Mat3& b) { return {{a * b.column[0], a * b.column[1], a * b.column[2]}}; }

Mat3 turn(int axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  if (axis == 0) return {{Vec3{1, 0, 0}, Vec3{0, c, s}, Vec3{0, -s, c}}};
  if (axis == 1) return {{Vec3{c, 0, -s}, Vec3{0, 1, 0}, Vec3{s, 0, c}}};
  return {{Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}}};
}

LinearMap about(const Mat3& m, Vec3 shift, Vec3 centre) { return {m, shift + centre - m * centre}; }

using detail::bad;
using detail::numbers_of;

Vec3 vec_at(const std::vector<double>& v, std::size_t i) { return {v[i], v[i + 1], v[i + 2]}; }

Mat3 matrix_of(const std::vector<double>& rows) {
  Mat3 m;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) m.column[c][r] = rows[static_cast<std::size_t>(3 * r + c)];
  return m;
}

Mat3 rotation_of_versor(Vec3 v) {
  const double square = dot(v, v);
  if (square > 1 + 1e-9) bad("Parameters", "the versor is longer than 1");
  const double w = std::sqrt(std::max(0.0, 1 - square));
  return matrix_of({1 - 2 * (v.y * v.y + v.z * v.z), 2 * (v.x * v.y - v.z * w), 2 * (v.x * v.z + v.y * w),
                    2 * (v.x * v.y + v.z * w), 1 - 2 * (v.x * v.x + v.z * v.z), 2 * (v.y * v.z - v.x * w),
                    2 * (v.x * v.z - v.y * w), 2 * (v.y * v.z + v.x * w), 1 - 2 * (v.x * v.x + v.y * v.y)});
}

}  // namespace

LinearMap linear_map(const std::string& kind, const std::vector<double>& p, const std::vector<double>& fixed) {
  const std::string name = kind.substr(0, kind.find('_'));
  if (kind != name + "_double_3_3" && kind != name + "_float_3_3") bad("Transform", "is not of three dimensions");
  for (const std::vector<double>* numbers : {&p, &fixed})
    for (const double v : *numbers)
      if (!std::isfinite(v)) bad("Parameters", "holds what is no finite number");
  const auto needs = [&](std::size_t count) {
    if (p.size() != count) bad("Parameters", "must hold " + std::to_string(count) + " numbers");
  };
  if (fixed.size() != 3 && fixed.size() != 4 && !(fixed.empty() && name == "TranslationTransform"))
    bad("FixedParameters", "must hold three numbers");
  const Vec3 centre = fixed.empty() ? Vec3{} : vec_at(fixed, 0);
  if (name == "AffineTransform" || name == "MatrixOffsetTransformBase") {
    needs(12);
    return about(matrix_of(p), vec_at(p, 9), centre);
  }
  if (name == "Euler3DTransform") {
    needs(6);
    const bool zyx = fixed.size() == 4 && fixed[3] != 0;
    const Mat3 x = turn(0, p[0]), y = turn(1, p[1]), z = turn(2, p[2]);
    return about(zyx ? product(z, product(y, x)) : product(z, product(x, y)), vec_at(p, 3), centre);
  }
  if (name == "VersorRigid3DTransform") {
    needs(6);
    return about(rotation_of_versor(vec_at(p, 0)), vec_at(p, 3), centre);
  }
  if (name == "TranslationTransform") {
    needs(3);
    return {Mat3{}, vec_at(p, 0)};
  }
  bad("Transform", "is no affine or rigid transform");
}

LinearMap then(const LinearMap& first, const LinearMap& second) {
  return {product(second.matrix, first.matrix), second(first.offset_mm)};
}

LinearMap inverse(const LinearMap& map) {
  const auto& c = map.matrix.column;
  const double d = determinant(map.matrix);
  if (!(std::fabs(d) > 1e-9) || !std::isfinite(d)) bad("Parameters", "the transform cannot be inverted");
  const Vec3 rows[3] = {cross(c[1], c[2]) / d, cross(c[2], c[0]) / d, cross(c[0], c[1]) / d};
  LinearMap back;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) back.matrix.column[k][i] = rows[i][k];
  back.offset_mm = -(back.matrix * map.offset_mm);
  return back;
}

LinearMap rigid_map(Vec3 angles_deg, Vec3 shift_mm, Vec3 centre_mm) {
  const Mat3 m =
      product(turn(2, angles_deg.z * degree), product(turn(1, angles_deg.y * degree), turn(0, angles_deg.x * degree)));
  return about(m, shift_mm, centre_mm);
}

double angle_deg(const LinearMap& map) {
  const auto& c = map.matrix.column;
  const Vec3 twice_sine{c[1].z - c[2].y, c[2].x - c[0].z, c[0].y - c[1].x};
  return std::atan2(norm(twice_sine), c[0].x + c[1].y + c[2].z - 1) / degree;
}

bool is_rigid(const LinearMap& map) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::fabs(dot(map.matrix.column[i], map.matrix.column[k]) - (i == k)) < 1e-6)) return false;
  return determinant(map.matrix) > 0;
}

std::string encode_tfm(const LinearMap& map) {
  std::string text = "#Insight Transform File V1.0\n#Transform 0\nTransform: AffineTransform_double_3_3\nParameters:";
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) text += " " + to_text(map.matrix.column[c][r]);
  for (int r = 0; r < 3; ++r) text += " " + to_text(map.offset_mm[r]);
  return text + "\nFixedParameters: 0 0 0\n";
}

LinearMap decode_tfm(std::string_view text) {
  std::map<std::string, std::string> keys;
  const std::vector<std::string> lines = split_at(text, '\n');
  if (lines.empty() || lines[0].rfind("#Insight Transform File V1.0", 0) != 0)
    bad("", "is no text file of an ITK transform");
  for (std::string line : lines) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const std::size_t colon = line.find(':');
    if (line.empty() || line[0] == '#' || colon == std::string::npos) continue;
    const std::string key = line.substr(0, colon);
    if (!keys.emplace(key, line.substr(std::min(line.size(), colon + 2))).second)
      bad(key, "is given twice: only one transform can be read");
  }
  for (const char* key : {"Transform", "Parameters"})
    if (keys.count(key) == 0) bad(key, "is missing");
  const LinearMap map = linear_map(keys["Transform"], numbers_of("Parameters", keys["Parameters"]),
                                   numbers_of("FixedParameters", keys["FixedParameters"]));
  inverse(map);
  return map;
}

LinearMap read_tfm(const std::filesystem::path& file) {
  const std::vector<char> bytes = read_file(file, max_bytes);
  return with_file(file.string(), [&] { return decode_tfm({bytes.data(), bytes.size()}); });
}

}  // namespace trephine::itk
