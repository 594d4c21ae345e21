// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/fit_zernike.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <set>

#include "lib/numerics/arena.h"
#include "lib/surface/zernike.h"
#include "tests/support/point_sets.h"

namespace sagitta::scene {
namespace {

using namespace sagitta::tests;
using numerics::ZernikeIndexing;
using ::testing::HasSubstr;
constexpr double infinity = std::numeric_limits<double>::infinity();

constexpr std::array indexings{ZernikeIndexing::osa, ZernikeIndexing::noll, ZernikeIndexing::fringe};

surface::Zernike traced(const ZernikeSurface& fitted, numerics::Arena& arena) {
  return surface::Zernike::from(zernike_shape(fitted).parameters, arena);
}

// A conic at height `vertex` with terms that no conic can take the place of on evenly spaced meridians: m is not 0.
double term_um(ZernikeIndexing indexing, int index) {
  return numerics::zernike_term(indexing, index).m == 0 ? 0 : std::cos(1.7 * index);
}
Height bumpy(ZernikeIndexing indexing, surface::Conic base, double vertex, double radius) {
  return [=](double x, double y) {
    double um = 0;
    for (int j = 0, first = numerics::first_zernike_index(indexing); j < 36; ++j)
      um += term_um(indexing, first + j) * numerics::zernike_value(indexing, numerics::zernike_term(indexing, first + j), x / radius, y / radius);
    return vertex + base.sag(x, y) + 1e-3 * um;
  };
}

// Rounding of heights up to 0.9 mm, 1e-16 mm, enlarged by the condition of the conic's fit (its columns 1, u and u^2 over
// (0, 9 mm^2): below 100) and of the terms' (asserted below 10), and the few hundred operations of QR: 1e-11 mm in height.
constexpr double rounding_um = 1e-8;

TEST(FitZernikeSurface, FindsAConicWithTermsInEveryIndexing) {
  const surface::Conic cornea{1 / 7.72, -0.26};
  int compared = 0;
  for (const ZernikeIndexing indexing : indexings) {
    for (const double vertex : {0.0, 0.25}) {
      const auto fit = fit_zernike_surface(cloud_of(polar_rings(20, 60, 3, true), bumpy(indexing, cornea, vertex, 3)), {36, 3, indexing});
      ASSERT_TRUE(fit.surface) << fit.reason;
      const ZernikeSurface& found = *fit.surface;
      EXPECT_LT(found.condition_number, 10);
      EXPECT_GE(found.condition_number, 1);
      EXPECT_EQ(found.point_count, 1201u);
      EXPECT_NEAR(found.radius_mm, 7.72, 1e-9);  // 1e-11 mm of 0.6 mm, times the radius
      EXPECT_NEAR(found.conic_constant, -0.26, 1e-8);
      EXPECT_NEAR(found.vertex_mm, vertex, 1e-11);
      ASSERT_EQ(found.coefficients_um.size(), 36u);
      for (int j = 0, first = numerics::first_zernike_index(indexing); j < 36; ++j, ++compared)
        EXPECT_NEAR(found.coefficients_um[static_cast<std::size_t>(j)], term_um(indexing, first + j) + (j == 0 ? 1e3 * vertex : 0), rounding_um) << j;
      EXPECT_LE(found.rms_um, rounding_um);
      EXPECT_LE(found.peak_to_valley_um, rounding_um);
      EXPECT_EQ(found.normalization_radius_mm, 3);
      // The coefficients are their own rms in the orthonormal indexings, and the conic leaves just that.
      EXPECT_GT(found.conic_rms_um, 1);
    }
  }
  EXPECT_EQ(compared, 216);
}

}  // namespace
}  // namespace sagitta::scene
