// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean/burr_hole_params.h"

#include <vector>

#include "base/error.h"

namespace trephine::boolean {
namespace {

Vec3 vector_of(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

}  // namespace

void check_request(const BurrHoleParams& params, ExitCode code) {
  const bool has_position = norm(vector_of(params.position_mm)) > 0;
  if (params.at == BurrHoleRequest::At::position && !has_position)
    throw Error(code, "", "position_mm", "is missing: `at` is position");
  if (params.at == BurrHoleRequest::At::kocher && has_position)
    throw Error(code, "", "position_mm", "is not looked at where `at` is kocher");
  std::vector<std::string> ways;
  if (norm(vector_of(params.direction)) > 0) ways.push_back("direction");
  if (norm(vector_of(params.target_mm)) > 0) ways.push_back("target_mm");
  if (!params.toward.empty()) ways.push_back("toward");
  if (ways.size() > 1) throw Error(code, "", ways[0], "and " + ways[1] + " contradict each other, give one of them");
  if (params.min_before_suture_mm > params.max_before_suture_mm)
    throw Error(code, "", "min_before_suture_mm", "is above max_before_suture_mm");
}

std::string missing_landmark(const BurrHoleParams& params, const std::map<std::string, Vec3>& landmarks_mm) {
  const auto known = [&](const std::string& landmark) { return landmarks_mm.count(landmark) > 0; };
  if (params.at == BurrHoleRequest::At::kocher) {
    if (!known("nasion")) return "nasion";
    if (!known("inion") && !known("vertex")) return "inion";
  }
  return params.toward.empty() || known(params.toward) ? "" : params.toward;
}

BurrHoleRequest request_of(const BurrHoleParams& params, const std::map<std::string, Vec3>& landmarks_mm,
                           ExitCode code) {
  check_request(params, code);
  if (const std::string missing = missing_landmark(params, landmarks_mm); !missing.empty())
    throw Error(code, "", "landmarks." + missing, std::string("is missing; ") + how_to_give_a_landmark);
  BurrHoleRequest r;
  r.at = params.at;
  r.side = params.side;
  r.name = params.name;
  r.position_mm = vector_of(params.position_mm);
  r.diameter_mm = params.diameter_mm;
  r.along_mm = params.along_mm;
  r.lateral_mm = params.lateral_mm;
  const Vec3 direction = vector_of(params.direction);
  if (const double length = norm(direction); length > 0) r.direction = direction / length;
  const Vec3 target = vector_of(params.target_mm);
  if (norm(target) > 0) r.toward_mm = target;
  if (!params.toward.empty()) r.toward_mm = landmarks_mm.at(params.toward);
  return r;
}

}  // namespace trephine::boolean
