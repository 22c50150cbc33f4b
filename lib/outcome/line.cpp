// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/line.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace trephine::outcome {

Line line_through(const std::vector<Vec3>& points) {
  Line line;
  for (const Vec3& p : points) line.at_mm += p * (1.0 / double(points.size()));
  Eigen::Matrix3d c = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points) {
    const Vec3 d = p - line.at_mm;
    const Eigen::Vector3d v(d.x, d.y, d.z);
    c += v * v.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(c);
  const Eigen::Vector3d v = axes.eigenvectors().col(2);
  line.way = normalized(Vec3{v.x(), v.y(), v.z()});
  if (dot(line.way, points.back() - points.front()) < 0) line.way = -line.way;
  for (const Vec3& p : points) {
    const Vec3 d = p - line.at_mm;
    line.off_mm = std::max(line.off_mm, norm(d - line.way * dot(d, line.way)));
  }
  return line;
}

Rod rod_of(const std::vector<Vec3>& points) {
  Rod rod;
  rod.line = line_through(points);
  double low = 0, high = 0, sum = 0;
  for (const Vec3& p : points) {
    const Vec3 d = p - rod.line.at_mm;
    const double along = dot(d, rod.line.way);
    low = std::min(low, along), high = std::max(high, along);
    const double across = norm(d - rod.line.way * along);
    sum += across * across;
  }
  rod.length_mm = high - low;
  rod.across_mm = std::sqrt(sum / double(points.size()));
  return rod;
}

}  // namespace trephine::outcome
