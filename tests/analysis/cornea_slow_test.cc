// SPDX-License-Identifier: Apache-2.0
// Corneas given as points, in front of the Navarro eye: acceptance figures 5 and 7 of freeform.md, and the synthetic corneas
// against the surfaces that they are samples of.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>

#include "lib/analysis/job.h"
#include "lib/prescription/cloud_reader.h"
#include "tests/support/point_sets.h"
#include "tests/support/prescriptions.h"
#include "tests/support/synthetic_cornea.h"

namespace sagitta::test {
namespace {

using namespace sagitta::tests;
using Long = long double;

prescription::Model zernike_eye() {
  auto read = prescription::read_prescription(SAGITTA_SOURCE_DIR "/systems/cornea-zernike.yaml");
  EXPECT_TRUE(read.model);
  return std::move(*read.model);
}

struct Interpolation {
  std::string name;
  double shape_mm = 0;
};
// The eye with points in place of its cornea.
prescription::Model with_points(prescription::Model eye, PointCloud cloud, const Interpolation& interpolation) {
  prescription::Shape& shape = eye.surfaces.front().shape;
  shape = {};
  shape.kind = "delaunay";
  shape.parameters.numbers = {{"rings", 2}, {"shape_mm", interpolation.shape_mm}, {"max_edge_mm", std::numeric_limits<double>::infinity()}};
  shape.parameters.texts = {{"points", cloud.file}, {"format", "xyz"}, {"axes", "local"}, {"interpolation", interpolation.name}};
  shape.cloud = std::make_shared<const PointCloud>(std::move(cloud));
  return eye;
}

// rms radius in um on the axis, of at least 6000 rays that all arrive.
double spot_um(const prescription::Model& model, double* at_10_deg = nullptr) {
  const CompiledScene compiled = checked(scene::compile(model));
  analysis::JobRequest request;
  request.want_wavefront = false;
  request.ray_count = 6000;
  const auto results = run_job(compiled.scene, request);
  for (const auto& result : results) EXPECT_EQ(result.rays[surface::Status::ok], result.rays.total());
  EXPECT_GE(results[0].rays.total(), 6000);
  if (at_10_deg) *at_10_deg = 1e3 * results[1].spot->rms_radius;
  return 1e3 * results[0].spot->rms_radius;
}

tests::Height sag_of_the_zernike_cornea(const CompiledScene& compiled) {
  const auto* surface = &std::get<surface::Zernike>(compiled.scene.surface(1).shape);
  return [surface](double x, double y) { return surface->sag(x, y); };
}

// Figure 5. The beam's radius on the cornea is 2 mm, the data go on for 2 spacings.
class ResampledCornea : public testing::Test {
 protected:
  static constexpr double beam = 2;
  double excess_percent(const std::vector<Place2>& places, const Interpolation& interpolation) {
    const double spot = spot_um(with_points(eye, cloud_of(places, sag_of_the_zernike_cornea(compiled)), interpolation));
    return 100 * (spot / zernike - 1);
  }
  static std::vector<Place2> grid(int per_mm) {
    const double half = beam + 2.0 / per_mm;
    const int side = static_cast<int>(std::lround(2 * half * per_mm)) + 1;
    return regular_grid(side, side, half, half);
  }
  static std::vector<Place2> random(int per_mm, std::uint64_t seed) {
    const double half = beam + 2.0 / per_mm;
    return uniform_random(static_cast<int>(4 * half * half * per_mm * per_mm), half, seed);
  }
  const prescription::Model eye = zernike_eye();
  const CompiledScene compiled = checked(scene::compile(eye));
  const double zernike = spot_um(eye);
};

TEST_F(ResampledCornea, linear_widens_the_spot_as_published) {
  for (const auto& [per_mm, percent] : {std::pair{7, 345.0}, {20, 83.0}, {40, 26.0}, {100, 5.0}}) {
    const double excess = excess_percent(grid(per_mm), {"linear"});
    fmt::print("[ report   ] linear, {} per mm: {:+.2f} % of {:.3f} um\n", per_mm, excess, zernike);
    EXPECT_NEAR(excess, percent, .1 * percent) << per_mm;
  }
}

TEST_F(ResampledCornea, radial_functions_widen_the_spot_as_published) {
  const double cubic = excess_percent(grid(7), {"cubic"}), thin_plate = excess_percent(grid(7), {"thin_plate"}),
               multiquadric = excess_percent(grid(7), {"multiquadric", 1.0 / 7});
  fmt::print("[ report   ] 7 per mm: cubic {:+.3f} %, thin plate {:+.3f} %, multiquadric {:+.3f} %\n", cubic, thin_plate, multiquadric);
  EXPECT_LE(std::abs(cubic), 1.5);
  EXPECT_LE(std::abs(thin_plate), 2.5);
  EXPECT_GE(multiquadric, 10);
  EXPECT_LE(multiquadric, 25);
}

TEST_F(ResampledCornea, c1_keeps_the_spot) {
  for (const int per_mm : {7, 20, 40}) {
    const double excess = excess_percent(grid(per_mm), {"c1"});
    fmt::print("[ report   ] c1, {} per mm, regular: {:+.6f} %\n", per_mm, excess);
    EXPECT_LE(std::abs(excess), .01) << per_mm;
  }
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const double excess = excess_percent(random(7, seed), {"c1"});
    fmt::print("[ report   ] c1, 7 per mm, random, seed {}: {:+.6f} %\n", seed, excess);
    EXPECT_LE(std::abs(excess), .02) << seed;
  }
}

std::vector<Place2> rings_of(double first, double step) {
  std::vector<Place2> places;
  for (int k = 0; k < 24; ++k)
    for (int i = 0; i < 180; ++i) {
      const double r = first + step * k, angle = 2 * std::numbers::pi * i / 180;
      places.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
  return places;
}

// Figure 7.
TEST(RingData, c1_keeps_the_spot_that_linear_triples) {
  const prescription::Model eye = zernike_eye();
  const CompiledScene compiled = checked(scene::compile(eye));
  for (const double outer : {3.6, 4.0, 5.2}) {
    const auto cloud = cloud_of(rings_of(outer / 24, outer / 24), sag_of_the_zernike_cornea(compiled));
    double zernike_10 = 0, c1_10 = 0, linear_10 = 0;
    const double zernike = spot_um(eye, &zernike_10), c1 = spot_um(with_points(eye, cloud, {"c1"}), &c1_10),
                 linear = spot_um(with_points(eye, cloud, {"linear"}), &linear_10);
    fmt::print("[ report   ] 24 x 180 to {:.1f} mm: zernike {:.4f}, c1 {:.4f}, linear {:.3f} um; at 10 degrees {:.4f}, {:.4f}, {:.3f} um\n", outer, zernike, c1,
               linear, zernike_10, c1_10, linear_10);
    EXPECT_LE(std::abs(c1 / zernike - 1), .003);
    EXPECT_LE(std::abs(c1_10 / zernike_10 - 1), .003);
  }
}

// The synthetic corneas.
struct Kind {
  Cornea kind;
  std::string name, file;
};
const Kind kinds[] = {{Cornea::normal, "normal", "normal_clean.csv"},
                      {Cornea::keratoconus, "keratoconus", "keratoconus_clean.csv"},
                      {Cornea::post_lasik, "post_LASIK", "postlasik_clean.csv"}};

// In the surface's own frame, x to the examiner's left.
Long exact_sag(const SyntheticCornea& cornea, Long x, Long y) { return cornea.sag(-x, y); }

std::optional<PointCloud> file_of(const std::string& name) {
  const char* given = std::getenv("SAGITTA_SHARED");
  const std::filesystem::path file = std::filesystem::path(given ? given : SAGITTA_SOURCE_DIR "/../shared") / "data/synthetic" / name;
  if (!std::filesystem::exists(file)) return std::nullopt;
  prescription::Findings findings;
  const auto cloud = prescription::read_cloud({file.string(), "xyz", true}, findings);
  EXPECT_TRUE(cloud && !findings.has_errors());
  return *cloud;
}
PointCloud samples_of(const SyntheticCornea& cornea) {
  return cloud_of(rings_of(.2052, .2174), [&](double x, double y) { return static_cast<double>(exact_sag(cornea, x, y)); });
}

// The rays of a 5 mm beam at the image, exact or by the program.
constexpr double beam_radius = 2.5;
trace::RayBatch launched(const scene::Scene& scene) {
  const auto points = trace::pupil_points({trace::PatternKind::hexapolar}, 3000);
  return trace::launch(scene, scene.fields.front(), scene.primary.index.front(), points);  // the first point is the centre: the chief ray
}

// Through the exact cornea by secants and the textbook's refraction in long double, then through the rest of the eye.
trace::RayBatch exact_rays(const scene::Scene& scene, const SyntheticCornea& cornea) {
  trace::RayBatch rays = launched(scene);
  const Long before = scene.primary.index[0], after = scene.primary.index[1], mu = before / after;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto p = numerics::vec3_cast<Long>(rays.position(i)), d = numerics::vec3_cast<Long>(rays.direction(i));
    const auto f = [&](Long t) { return p.z + t * d.z - exact_sag(cornea, p.x + t * d.x, p.y + t * d.y); };
    Long t0 = -p.z / d.z, f0 = f(t0), t = t0 - f0;
    for (int step = 0; step < 50 && t != t0; ++step) {
      const Long at = f(t), next = at == f0 ? t : t - at * (t - t0) / (at - f0);
      t0 = t, f0 = at, t = next;
    }
    EXPECT_LE(std::abs(f(t)), 1e-17L);
    const Vec3<Long> hit = p + t * d;
    const auto slope = cornea.gradient(-hit.x, hit.y);
    const Vec3<Long> N = numerics::normalized(Vec3<Long>{slope[0], -slope[1], 1});  // d/dx of sag(-x, y) is -slope[0]
    const Long cos_i = dot(N, d), cos_t = std::sqrt(1 - mu * mu * (1 - cos_i * cos_i));
    const Vec3<Long> out = mu * d + (cos_t - mu * cos_i) * N;
    rays.set(i, numerics::vec3_cast<double>(hit), numerics::vec3_cast<double>(out), static_cast<double>(rays.opl[i] + before * t));
  }
  for (int number = 2; number <= scene.surface_count(); ++number) trace_surface(scene, scene.primary, number, rays);
  return rays;
}
trace::RayBatch traced(const scene::Scene& scene) {
  trace::RayBatch rays = launched(scene);
  trace::trace(scene, scene.primary, rays);
  return rays;
}

// Optical paths, in waves, to one sphere for both traces: about the exact chief ray's image point, through the middle of the exit
// pupil; their difference about its mean.
struct Difference {
  double rms_waves = 0, worst_waves = 0;
};
Difference difference(const CompiledScene& eye, const trace::RayBatch& exact, const trace::RayBatch& other) {
  const int image = eye.scene.surface_count();
  const auto Q = numerics::vec3_cast<Long>(global_position(eye.scene, image, exact, 0));
  const auto along = numerics::vec3_cast<Long>(global_direction(eye.scene, image, exact, 0));
  const Long R = (static_cast<Long>(eye.first_order.exit_pupil.z) - Q.z) / along.z, index = eye.scene.primary.index[eye.scene.surfaces.size() - 1];
  const auto path = [&](const trace::RayBatch& rays, std::size_t i) {
    const auto p = numerics::vec3_cast<Long>(global_position(eye.scene, image, rays, i)), d = numerics::vec3_cast<Long>(global_direction(eye.scene, image, rays, i));
    const Long b = dot(p - Q, d), root = std::sqrt(b * b - dot(p - Q, p - Q) + R * R);
    return rays.opl[i] + index * (R > 0 ? -b + root : -b - root);
  };
  std::vector<Long> differences;
  Long mean = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_EQ(exact.ended[i], 0);
    EXPECT_EQ(other.ended[i], 0);
    differences.push_back((path(other, i) - path(exact, i)) * 1000 / eye.scene.primary.wavelength_um);
    mean += differences.back() / static_cast<Long>(exact.size());
  }
  Difference result;
  for (const Long one : differences) {
    result.rms_waves += static_cast<double>((one - mean) * (one - mean)) / static_cast<double>(differences.size());
    result.worst_waves = std::max(result.worst_waves, std::abs(static_cast<double>(one - mean)));
  }
  result.rms_waves = std::sqrt(result.rms_waves);
  return result;
}

struct Errors {
  double sag_rms_um = 0, sag_worst_um = 0;
  Difference wavefront;
};
Errors errors_of(const PointCloud& cloud, const SyntheticCornea& cornea, const std::string& interpolation) {
  prescription::Model model = with_points(zernike_eye(), cloud, {interpolation});
  model.wavelengths_nm = {555};
  model.aperture.value = 2 * beam_radius;
  model.fields.points = {{0, 0}};
  const CompiledScene eye = checked(scene::compile(model));
  Errors errors;
  Uniform u(1);
  constexpr int samples = 20000;
  for (int i = 0; i < samples; ++i) {
    const double r = beam_radius * std::sqrt(u()), angle = u(0, 2 * std::numbers::pi), x = r * std::cos(angle), y = r * std::sin(angle);
    const double sag = std::visit([&](const auto& shape) { return shape.sag(x, y); }, eye.scene.surface(1).shape);
    const double error = 1e3 * static_cast<double>(sag - exact_sag(cornea, x, y));
    errors.sag_rms_um += error * error / samples;
    errors.sag_worst_um = std::max(errors.sag_worst_um, std::abs(error));
  }
  errors.sag_rms_um = std::sqrt(errors.sag_rms_um);
  errors.wavefront = difference(eye, exact_rays(eye.scene, cornea), traced(eye.scene));
  return errors;
}

void expect_c1_to_be_exact_enough(const PointCloud& cloud, const Kind& kind, const std::string& source) {
  const SyntheticCornea cornea(kind.kind);
  for (const std::string interpolation : {"c1", "linear"}) {
    const Errors errors = errors_of(cloud, cornea, interpolation);
    fmt::print("[ report   ] {}, {}, {}: sag {:.5f} um rms, {:.4f} at worst; wavefront {:.5f} waves rms, {:.4f} at worst\n", kind.name, source, interpolation,
               errors.sag_rms_um, errors.sag_worst_um, errors.wavefront.rms_waves, errors.wavefront.worst_waves);
    EXPECT_TRUE(std::isfinite(errors.sag_rms_um) && std::isfinite(errors.wavefront.rms_waves));
    if (interpolation == "c1") {
      EXPECT_LE(errors.sag_rms_um, .02);
      EXPECT_LE(errors.wavefront.rms_waves, .02);
    } else {
      // Unusable for wavefronts: rings .2174 mm apart on a curvature of .13/mm leave .13 x .2174^2/8 = .77 um of sag between
      // them, .52 waves; about a wave from place to place.
      EXPECT_GE(errors.wavefront.worst_waves, .4);
    }
  }
}

class SyntheticCorneas : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Kinds, SyntheticCorneas, testing::Range<std::size_t>(0, 3), [](const auto& one) { return kinds[one.param].name; });

TEST_P(SyntheticCorneas, c1_through_samples_of_the_formula_is_the_cornea) {
  const Kind& kind = kinds[GetParam()];
  expect_c1_to_be_exact_enough(samples_of(SyntheticCornea(kind.kind)), kind, "24 x 180 samples");
}

TEST_P(SyntheticCorneas, c1_through_the_shared_points_is_the_cornea) {
  const Kind& kind = kinds[GetParam()];
  const auto cloud = file_of(kind.file);
  if (!cloud) GTEST_SKIP() << kind.file << " is not there (the test data are optional)";
  // That they are samples of the formula: x, y and z of nine decimals, on slopes below 0.5.
  const SyntheticCornea cornea(kind.kind);
  int compared = 0;
  for (const auto& p : cloud->points) {
    if (!(std::hypot(p.x, p.y) < 3)) continue;
    EXPECT_NEAR(p.z, static_cast<double>(exact_sag(cornea, p.x, p.y)), 1.05e-9);
    ++compared;
  }
  EXPECT_GT(compared, 2300);
  expect_c1_to_be_exact_enough(*cloud, kind, kind.file);
}

}  // namespace
}  // namespace sagitta::test
