// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/contact_c.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace {

// Two slabs of HU along k: 300 to 500 from slice 3, 600 to 900 from slice 6, air from slice 9.
std::vector<int16_t> slabs(const int32_t* size) {
  std::vector<int16_t> v;
  for (int k = 0; k < size[2]; ++k)
    for (int n = 0; n < size[0] * size[1]; ++n)
      v.push_back(k < 3 || k > 8 ? int16_t(-1000) : k < 6 ? int16_t(400) : int16_t(700));
  return v;
}

struct Opened {
  trephine_contact* contact = nullptr;
  ~Opened() { trephine_contact_close(contact); }
};

}  // namespace

TEST(ContactC, FindsWhatACallerInCAsksFor) {
  const int32_t size[3] = {8, 8, 12};
  const double spacing[3] = {0.5, 0.5, 2}, origin[3] = {0, 0, 100};
  const trephine_shape shapes[2] = {{1, 300, 500, TREPHINE_FRONT}, {2, 600, 900, TREPHINE_FRONT_AND_BACK}};
  Opened o;
  o.contact = trephine_contact_open(slabs(size).data(), size, spacing, origin, nullptr, TREPHINE_HU, shapes, 2,
                                    TREPHINE_EXACT, TREPHINE_NEAREST, 1);
  ASSERT_NE(o.contact, nullptr) << trephine_error();
  const double start[3] = {2, 2, 90}, middle[3] = {2, 2, 108}, inner[3] = {2, 2, 114}, end[3] = {2, 2, 130};
  double point[3], normal[3];
  int32_t face = 0, shape = 0;
  ASSERT_EQ(trephine_contact_intersect(o.contact, start, end, point, normal, &face, &shape), 1);
  EXPECT_EQ(shape, 1);
  EXPECT_EQ(face, TREPHINE_FRONT);
  EXPECT_NEAR(point[2], 105, 1e-9);
  EXPECT_LT(normal[2], -0.99);
  ASSERT_EQ(trephine_contact_intersect(o.contact, middle, end, point, normal, &face, &shape), 1);
  EXPECT_EQ(shape, 2);
  EXPECT_EQ(face, TREPHINE_FRONT);
  EXPECT_NEAR(point[2], 111, 1e-9);
  ASSERT_EQ(trephine_contact_intersect(o.contact, inner, end, point, normal, &face, &shape), 1);
  EXPECT_EQ(shape, 2);
  EXPECT_EQ(face, TREPHINE_BACK);
  EXPECT_NEAR(point[2], 117, 1e-9);
  // Out of the first shape, whose back is not touchable.
  EXPECT_EQ(trephine_contact_intersect(o.contact, middle, start, point, normal, &face, &shape), 0);
  const double bad[3] = {std::numeric_limits<double>::quiet_NaN(), 0, 0};
  EXPECT_EQ(trephine_contact_intersect(o.contact, bad, end, point, normal, &face, &shape), -1);
  EXPECT_EQ(trephine_contact_intersect(o.contact, start, end, nullptr, nullptr, nullptr, nullptr), 1);

  // Shape by shape, as a haptic library's callback.
  trephine_shape_view first{o.contact, 1}, second{o.contact, 2};
  EXPECT_EQ(trephine_intersect_surface(start, end, point, normal, &face, &first), 1);
  EXPECT_EQ(trephine_intersect_surface(start, end, point, normal, &face, &second), 0);
  EXPECT_EQ(trephine_intersect_surface(middle, end, point, normal, &face, &first), 0);
  EXPECT_EQ(trephine_intersect_surface(middle, end, point, normal, &face, &second), 1);
  EXPECT_NEAR(point[2], 111, 1e-9);
}

TEST(ContactC, SaysWhatIsWrong) {
  const int32_t size[3] = {8, 8, 12}, none[3] = {8, 0, 12};
  const double spacing[3] = {0.5, 0.5, 2}, flat[3] = {0.5, 0, 2}, origin[3] = {0, 0, 0};
  const double skew[9] = {1, 0, 0, 0.5, 1, 0, 0, 0, 1};
  const trephine_shape good = {1, 300, 500, TREPHINE_FRONT}, wrong = {40, 300, 500, TREPHINE_FRONT};
  const std::vector<int16_t> v = slabs(size);
  const auto open = [&](const int16_t* voxels, const int32_t* n, const double* mm, const double* axes,
                        const trephine_shape& s, int walk) {
    Opened o;
    o.contact = trephine_contact_open(voxels, n, mm, origin, axes, TREPHINE_HU, &s, 1, walk, TREPHINE_NEAREST, 0.5);
    return std::string(o.contact ? "opened" : trephine_error());
  };
  EXPECT_EQ(open(v.data(), size, spacing, nullptr, good, TREPHINE_STEPPED), "opened");
  EXPECT_NE(open(nullptr, size, spacing, nullptr, good, 0).find("voxels"), std::string::npos);
  EXPECT_NE(open(v.data(), none, spacing, nullptr, good, 0).find("size"), std::string::npos);
  EXPECT_NE(open(v.data(), size, flat, nullptr, good, 0).find("spacing"), std::string::npos);
  EXPECT_NE(open(v.data(), size, spacing, skew, good, 0).find("orthonormal"), std::string::npos);
  EXPECT_NE(open(v.data(), size, spacing, nullptr, wrong, 0).find("number"), std::string::npos);
  EXPECT_NE(open(v.data(), size, spacing, nullptr, good, 7).find("walk"), std::string::npos);
}
