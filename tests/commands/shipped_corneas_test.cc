// SPDX-License-Identifier: Apache-2.0
// The point clouds of the shipped eyes and the formulas behind them.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>

#include "lib/prescription/cloud_reader.h"
#include "tests/support/prescriptions.h"
#include "tools/model_corneas.h"

namespace sagitta::test {
namespace {

using Sag = double (*)(double, double);

struct Shipped {
  std::string system, synthetic;  // in systems/, and in the shared data
  Sag sag;
};
void PrintTo(const Shipped& shipped, std::ostream* stream) { *stream << shipped.system; }

class ShippedCornea : public testing::TestWithParam<Shipped> {};

// 0.02 um rms inside 2.5 mm is what is asked of c1 on clean corneas; the axes are those of the examiner, x to the right.
TEST_P(ShippedCornea, traces_as_a_surface_that_is_the_formula) {
  const auto read = prescription::read_prescription(SAGITTA_SOURCE_DIR "/systems/" + GetParam().system);
  ASSERT_TRUE(read.model);
  const auto& cloud = *read.model->surfaces[0].shape.cloud;
  ASSERT_EQ(cloud.points.size(), 24u * 180u);
  for (const auto& point : cloud.points) ASSERT_EQ(point.z, GetParam().sag(-point.x, point.y));
  const CompiledScene compiled = checked(scene::compile(*read.model));
  double squares = 0;
  int count = 0;
  for (int i = -100; i <= 100; ++i)
    for (int j = -100; j <= 100; ++j) {
      const double x = 0.025 * i + 1e-3, y = 0.025 * j - 7e-4;
      if (std::hypot(x, y) > 2.5) continue;
      const double sag = std::visit([&](const auto& shape) { return shape.sag(x, y); }, compiled.scene.surface(1).shape);
      squares += std::pow(sag - GetParam().sag(-x, y), 2);
      ++count;
    }
  EXPECT_GT(count, 31000);
  const double rms_um = 1e3 * std::sqrt(squares / count);
  std::printf("[ report   ] %s: c1 sag error %.2e um rms inside 2.5 mm\n", GetParam().system.c_str(), rms_um);
  EXPECT_LE(rms_um, 0.02);
}

// x, y, z there have 9 decimals, so z is off by 5e-10 and by its slope (below 0.45 inside 3 mm) times that in x and in y:
// 1e-9 at most. Beyond the 3 mm over which the Zernike terms are normalised those data go on in another way.
TEST_P(ShippedCornea, formula_agrees_with_the_synthetic_data) {
  const char* given = std::getenv("SAGITTA_SHARED");
  const std::filesystem::path file =
      std::filesystem::path(given ? given : SAGITTA_SOURCE_DIR "/../shared") / "data/synthetic" / GetParam().synthetic;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there (the test data are optional)";
  prescription::Findings findings;
  const auto cloud = prescription::read_cloud({file.string(), "xyz", true}, findings);
  ASSERT_TRUE(cloud);
  int count = 0;
  for (const auto& point : cloud->points) {
    if (std::isnan(point.z) || std::hypot(point.x, point.y) > 3) continue;
    ASSERT_NEAR(point.z, GetParam().sag(-point.x, point.y), 1e-9);
    ++count;
  }
  EXPECT_GT(count, 2000);
}

INSTANTIATE_TEST_SUITE_P(Eyes, ShippedCornea,
                         testing::Values(Shipped{"eye-with-measured-cornea.yaml", "normal_clean.csv", tools::normal_cornea},
                                         Shipped{"keratoconic-eye.yaml", "keratoconus_clean.csv", tools::keratoconic_cornea}),
                         [](const auto& one) { return one.param.synthetic.substr(0, one.param.synthetic.find('_')); });

}  // namespace
}  // namespace sagitta::test
