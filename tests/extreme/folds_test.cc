// SPDX-License-Identifier: Apache-2.0
// Surfaces that fold under slanted light: gull wings and steep Zernike terms.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "tests/extreme/textbook.h"
#include "tests/support/prescriptions.h"

namespace sagitta::test {
namespace {

TEST(Folds, experiment) {
  std::mt19937_64 random(7);
  const auto uniform = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  std::map<std::string, int> counts;
  int shown = 0;
  for (int system = 0; system < 400; ++system) {
    std::vector<std::pair<int, double>> terms;
    for (const int index : {3, 4, 5, 7, 8, 12, 24}) terms.push_back({index, uniform(-1, 1) * std::pow(10.0, uniform(1, 3.3))});
    const prescription::Shape shape = zernike_shape(uniform(0, 1) < .5 ? 10 : -10, uniform(-2, .5), uniform(2, 4), terms);
    numerics::Arena arena;
    const auto zernike = surface::Zernike::from(shape.parameters, arena);
    const TextbookZernike<long double> exact{{static_cast<long double>(zernike.base.curvature), 1.0L + static_cast<long double>(zernike.base.conic_constant)}, shape.parameters};
    for (int ray = 0; ray < 100; ++ray) {
      const double tilt = uniform(0, 1.2), azimuth = uniform(0, 6.283);
      const Vec3<double> d = numerics::normalized(Vec3<double>{std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)});
      const Vec3<double> at{uniform(-3, 3), uniform(-3, 3), 0};
      const Vec3<double> p = at + -4.0 * d;
      const auto ours = zernike.meet(p, d);
      const auto truth = exact.meet(vec3_cast<long double>(p), vec3_cast<long double>(d));
      std::string key = std::string(surface::status_names[static_cast<std::size_t>(ours.status)]) + " / " + std::string(surface::status_names[static_cast<std::size_t>(truth.status)]);
      if (ours.status == Status::ok && truth.status == Status::ok) {
        const double off = std::abs(ours.path - static_cast<double>(truth.path));
        key += off < 1e-8 ? " same" : " OTHER";
        if (off >= 1e-8 && shown++ < 5) fmt::print("system {} ray {}: {} vs {}, tilt {}\n", system, ray, ours.path, static_cast<double>(truth.path), tilt);
      }
      ++counts[key];
    }
  }
  for (const auto& [key, count] : counts) fmt::print("{:40} {}\n", key, count);
}

}  // namespace
}  // namespace sagitta::test
