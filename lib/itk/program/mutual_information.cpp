// SPDX-License-Identifier: GPL-3.0-or-later
// The only file of registration that includes ITK.
#include "mutual_information.h"

#include <itkAffineTransform.h>
#include <itkEuler3DTransform.h>
#include <itkMattesMutualInformationImageToImageMetricv4.h>

#include <cmath>

#include "base/degree.h"
#include "itk_image.h"

namespace trephine::itk {
namespace {

using Metric = ::itk::MattesMutualInformationImageToImageMetricv4<Image, Image>;
using Linear = ::itk::MatrixOffsetTransformBase<double, 3, 3>;

constexpr double min_overlap = 0.3;

}  // namespace

LinearMap map_of(const Pose& pose, Vec3 centre) {
  if (pose.size() == 6)
    return rigid_map(Vec3{pose[0], pose[1], pose[2]} / (arm_mm * degree), {pose[3], pose[4], pose[5]}, centre);
  LinearMap map;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) map.matrix.column[c][r] = pose[static_cast<std::size_t>(3 * r + c)] / arm_mm;
  map.offset_mm = Vec3{pose[9], pose[10], pose[11]} + centre - map.matrix * centre;
  return map;
}

Pose rigid_pose(const LinearMap& map, Vec3 centre) {
  // matrix = Rz * Ry * Rx
  const auto& c = map.matrix.column;
  const double x = std::atan2(c[1].z, c[2].z), y = std::asin(std::fmax(-1, std::fmin(1, -c[0].z))),
               z = std::atan2(c[0].y, c[0].x);
  const Vec3 shift = map(centre) - centre;
  return {x * arm_mm, y * arm_mm, z * arm_mm, shift.x, shift.y, shift.z};
}

Pose affine_pose(const LinearMap& map, Vec3 centre) {
  Pose pose(12);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) pose[static_cast<std::size_t>(3 * r + c)] = map.matrix.column[c][r] * arm_mm;
  const Vec3 shift = map(centre) - centre;
  for (int r = 0; r < 3; ++r) pose[static_cast<std::size_t>(9 + r)] = shift[r];
  return pose;
}

struct MutualInformation::Parts {
  Metric::Pointer metric = Metric::New();
  Linear::Pointer transform;
  std::size_t turning = 3;  ///< how many of the first parameters carry the arm
  double places = 0, overlap = 0;
};

MutualInformation::MutualInformation(const grid::Grid<float>& fixed, const grid::Grid<float>& moving,
                                     const std::vector<Vec3>& places, int bins, Vec3 centre, bool affine)
    : parts_(std::make_unique<Parts>()) {
  Linear::InputPointType middle;
  for (unsigned a = 0; a < 3; ++a) middle[a] = centre[static_cast<int>(a)];
  if (affine) {
    parts_->transform = ::itk::AffineTransform<double, 3>::New();
    parts_->turning = 9;
  } else {
    auto euler = ::itk::Euler3DTransform<double>::New();
    euler->SetComputeZYX(true);
    parts_->transform = euler;
  }
  parts_->transform->SetCenter(middle);

  auto samples = Metric::FixedSampledPointSetType::New();
  for (std::size_t i = 0; i < places.size(); ++i) {
    Metric::FixedSampledPointSetType::PointType p;
    for (unsigned a = 0; a < 3; ++a) p[a] = places[i][static_cast<int>(a)];
    samples->SetPoint(i, p);
  }
  parts_->places = static_cast<double>(places.size());

  Metric& metric = *parts_->metric;
  metric.SetFixedImage(image_of(fixed));
  metric.SetMovingImage(image_of(moving));
  metric.SetMovingTransform(parts_->transform);
  metric.SetNumberOfHistogramBins(static_cast<::itk::SizeValueType>(bins));
  metric.SetFixedSampledPointSet(samples);
  metric.SetUseSampledPointSet(true);
  metric.SetUseFixedImageGradientFilter(false);
  metric.SetUseMovingImageGradientFilter(false);
  metric.SetMaximumNumberOfWorkUnits(1);
  metric.Initialize();
}

MutualInformation::~MutualInformation() = default;

double MutualInformation::at(const Pose& pose, Pose* uphill) const {
  Parts& parts = *parts_;
  Linear::ParametersType p(static_cast<unsigned>(pose.size()));
  for (unsigned i = 0; i < pose.size(); ++i) p[i] = pose[i] / (i < parts.turning ? arm_mm : 1);
  parts.transform->SetParameters(p);
  Metric::MeasureType value = 0;
  Metric::DerivativeType slope(static_cast<unsigned>(pose.size()));
  slope.Fill(0);
  if (uphill) uphill->assign(pose.size(), 0);
  try {
    if (uphill)
      parts.metric->GetValueAndDerivative(value, slope);
    else
      value = parts.metric->GetValue();
  } catch (const ::itk::ExceptionObject&) {  // no sample lies within the moving grid
    parts.overlap = 0;
    return 0;
  }
  parts.overlap = static_cast<double>(parts.metric->GetNumberOfValidPoints()) / parts.places;
  if (parts.overlap < min_overlap || !std::isfinite(value)) return 0;
  if (uphill)
    for (unsigned i = 0; i < pose.size(); ++i) (*uphill)[i] = slope[i] / (i < parts.turning ? arm_mm : 1);
  return -value;
}

double MutualInformation::overlap_ratio() const { return parts_->overlap; }

}  // namespace trephine::itk
