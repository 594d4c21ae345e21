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

prescription::Model zernike_eye_on_the_axis() {
  auto read = prescription::read_prescription(SAGITTA_SOURCE_DIR "/systems/cornea-zernike.yaml");
  EXPECT_TRUE(read.model);
  read.model->fields.points = {{0, 0}};
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
  shape.parameters.numbers = {{"rings", 2}, {"shape_mm", interpolation.shape_mm}, {"smoothing_um", 0}, {"max_edge_mm", std::numeric_limits<double>::infinity()}};
  shape.parameters.texts = {{"points", cloud.file}, {"format", "xyz"}, {"axes", "local"}, {"interpolation", interpolation.name}};
  shape.cloud = std::make_shared<const PointCloud>(std::move(cloud));
  return eye;
}

tests::Height sag_of_the_zernike_cornea(const CompiledScene& compiled) {
  const auto* surface = &std::get<surface::Zernike>(compiled.scene.surface(1).shape);
  return [surface](double x, double y) { return surface->sag(x, y); };
}

// On the axis, of at least 6000 rays that all arrive, in um.
double spot_um(const prescription::Model& model) {
  const CompiledScene compiled = checked(scene::compile(model));
  analysis::JobRequest request;
  request.want_wavefront = false;
  request.ray_count = 6000;
  const auto result = run_job(compiled.scene, request).front();
  EXPECT_EQ(result.rays[surface::Status::ok], result.rays.total());
  EXPECT_GE(result.rays.total(), 6000);
  return 1e3 * result.spot->rms_radius;
}

// The cornea alone in front of index 1.376, as the paper's section 3.C has it, with its image plane at the best focus: the
// square of the rms radius is a parabola over the plane's place.
prescription::Model cornea_alone(prescription::Model model) {
  model.surfaces.resize(2);
  model.surfaces[0].stop = true;
  model.surfaces[0].medium = medium::constant("cornea", 1.376);
  model.surfaces[1] = {};
  model.surfaces[1].medium = medium::air();
  const auto square_at = [&](double thickness) {
    model.surfaces[0].thickness_mm = thickness;
    return std::pow(spot_um(model), 2);
  };
  const double middle = 28, step = 0.5, before = square_at(middle - step), at = square_at(middle), behind = square_at(middle + step);
  model.surfaces[0].thickness_mm = middle + step * (before - behind) / (2 * (before - 2 * at + behind));
  return model;
}

// Figure 5. The beam's radius on the cornea is 2 mm, the data go on for 2 spacings.
//   freeform.md does not say where the spot is. In the Navarro eye the slopes' errors turn into 48 um at 7 per mm; behind the
// cornea alone into h/sqrt(6) times curvature times radius, 59 um, which is what the published ratios need. Its spot of 13.6 um
// was of other coefficients than the shipped ones, whose spot is 13.1 um.
class ResampledCornea : public testing::Test {
 protected:
  static constexpr double beam = 2;
  double excess_percent(const prescription::Model& of, const std::vector<Place2>& places, const Interpolation& interpolation) const {
    const double spot = spot_um(with_points(of, cloud_of(places, sag), interpolation));
    return 100 * (spot / spot_um(of) - 1);
  }
  // Shifted by a part of its spacing.
  static std::vector<Place2> grid(int per_mm, double shift_x = 0, double shift_y = 0) {
    const double half = beam + 2.5 / per_mm;
    const int side = static_cast<int>(std::lround(2 * half * per_mm)) + 1;
    std::vector<Place2> places = regular_grid(side, side, half, half);
    for (Place2& place : places) place.x += shift_x / per_mm, place.y += shift_y / per_mm;
    return places;
  }
  static std::vector<Place2> random(int per_mm, std::uint64_t seed) {
    const double half = beam + 2.0 / per_mm;
    return uniform_random(static_cast<int>(4 * half * half * per_mm * per_mm), half, seed);
  }
  // The mean over some places of the grid: at 100 per mm the excess of one varies by a fifth of itself with the rays.
  double mean_excess_percent(const prescription::Model& of, int per_mm) const {
    constexpr int grids = 12;
    Uniform u(static_cast<std::uint64_t>(per_mm));
    double mean = 0;
    for (int i = 0; i < grids; ++i) {
      const double x = u(-.5, .5), y = u(-.5, .5);
      mean += excess_percent(of, grid(per_mm, x, y), {"linear"}) / grids;
    }
    return mean;
  }
  const prescription::Model eye = zernike_eye_on_the_axis(), alone = cornea_alone(eye);
  const CompiledScene compiled = checked(scene::compile(eye));
  const tests::Height sag = sag_of_the_zernike_cornea(compiled);
};

TEST_F(ResampledCornea, linear_widens_the_spot_as_published) {
  const double spot_alone = spot_um(alone), spot_in_eye = spot_um(eye);
  for (const auto& [per_mm, percent] : {std::pair{7, 345.0}, {20, 83.0}, {40, 26.0}, {100, 5.0}}) {
    const double excess = mean_excess_percent(alone, per_mm), in_eye = mean_excess_percent(eye, per_mm);
    fmt::print("[ report   ] linear, {} per mm: {:+.2f} % of {:.3f} um behind the cornea alone; {:+.2f} % of {:.3f} um in the eye\n", per_mm, excess, spot_alone,
               in_eye, spot_in_eye);
    EXPECT_NEAR(excess, percent, .1 * percent) << per_mm;
    // The facets' own spot, derived: in a cell of spacing h slopes are off by curvature times the distance from its middle,
    // h/sqrt(6) rms, and curvature x focal length x (n - 1)/n is 1 for a sphere, 1.02 rms for this cornea (astigmatism of
    // 2 %, asphericity). It adds in quadrature; 12 x 6000 rays leave 4 % of a fifth at 100 per mm.
    const double own = 1e3 / per_mm / std::sqrt(6.0) * 1.02, derived = 100 * (std::hypot(own / spot_alone, 1) - 1);
    EXPECT_NEAR(excess, derived, .06 * derived) << per_mm;
  }
}

TEST_F(ResampledCornea, radial_functions_widen_the_spot_as_published) {
  for (const auto& [name, of] : {std::pair{"behind the cornea alone", &alone}, {"in the eye", &eye}}) {
    const double cubic = excess_percent(*of, grid(7), {"cubic"}), thin_plate = excess_percent(*of, grid(7), {"thin_plate"}),
                 multiquadric = excess_percent(*of, grid(7), {"multiquadric", 1.0 / 7});
    fmt::print("[ report   ] 7 per mm, {}: cubic {:+.3f} %, thin plate {:+.3f} %, multiquadric {:+.3f} %\n", name, cubic, thin_plate, multiquadric);
    EXPECT_LE(std::abs(cubic), 1.5);
    EXPECT_LE(std::abs(thin_plate), 2.5);
    if (of == &eye) continue;
    EXPECT_GE(multiquadric, 10);
    EXPECT_LE(multiquadric, 25);
  }
}

TEST_F(ResampledCornea, c1_keeps_the_spot) {
  for (const auto& [name, of] : {std::pair{"behind the cornea alone", &alone}, {"in the eye", &eye}}) {
    for (const int per_mm : {7, 20, 40}) {
      const double excess = excess_percent(*of, grid(per_mm), {"c1"});
      fmt::print("[ report   ] c1, {} per mm, regular, {}: {:+.6f} %\n", per_mm, name, excess);
      EXPECT_LE(std::abs(excess), .01) << per_mm;
    }
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
      const double excess = excess_percent(*of, random(7, seed), {"c1"});
      fmt::print("[ report   ] c1, 7 per mm, random, seed {}, {}: {:+.6f} %\n", seed, name, excess);
      EXPECT_LE(std::abs(excess), .02) << seed;
    }
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

// Figure 7: c1 within .3 % of the Zernike trace, linear about 45 um against 13.6 um. How far the rings reach is not said, and
// the linear spot goes with their distance: 3.6 mm is systems/cornea-delaunay.yaml, 4 mm comes nearest in the eye.
TEST(RingData, c1_keeps_the_spot_that_linear_triples) {
  const prescription::Model eye = zernike_eye_on_the_axis(), alone = cornea_alone(eye);
  const CompiledScene compiled = checked(scene::compile(eye));
  const auto sag = sag_of_the_zernike_cornea(compiled);
  for (const auto& [name, of] : {std::pair{"in the eye", &eye}, {"behind the cornea alone", &alone}})
    for (const double outer : {3.0, 3.6, 4.0, 5.2}) {
      const auto cloud = cloud_of(rings_of(outer / 24, outer / 24), sag);
      const double zernike = spot_um(*of), c1 = spot_um(with_points(*of, cloud, {"c1"})), linear = spot_um(with_points(*of, cloud, {"linear"}));
      fmt::print("[ report   ] 24 x 180 to {:.1f} mm, {}: zernike {:.4f} um, c1 {:+.4f} %, linear {:.3f} um\n", outer, name, zernike, 100 * (c1 / zernike - 1), linear);
      EXPECT_LE(std::abs(c1 / zernike - 1), .003) << outer;
      if (of == &eye && (outer == 3.6 || outer == 4.0)) {
        EXPECT_NEAR(linear, 45, 4.5) << outer;
      }
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

// Optical paths, in waves, to a sphere about a chief ray's image point, through the middle of the exit pupil; their difference
// about its mean. The sphere is the exact chief ray's for both traces, or each trace has its own, as the program's wavefronts have:
// then the slope at the chief ray's hit counts as tilt.
struct Difference {
  double rms_waves = 0, worst_waves = 0;
};
Difference difference(const CompiledScene& eye, const trace::RayBatch& exact, const trace::RayBatch& other, bool each_its_own) {
  const int image = eye.scene.surface_count();
  const auto path = [&](const trace::RayBatch& rays, std::size_t i) {
    const trace::RayBatch& chief = each_its_own ? rays : exact;
    const auto Q = numerics::vec3_cast<Long>(global_position(eye.scene, image, chief, 0));
    const auto along = numerics::vec3_cast<Long>(global_direction(eye.scene, image, chief, 0));
    const Long R = (static_cast<Long>(eye.first_order.exit_pupil.z) - Q.z) / along.z, index = eye.scene.primary.index[eye.scene.surfaces.size() - 1];
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
  Difference wavefront, own_wavefront;
};
Errors errors_of(const PointCloud& cloud, const SyntheticCornea& cornea, const std::string& interpolation) {
  prescription::Model model = with_points(zernike_eye_on_the_axis(), cloud, {interpolation});
  model.wavelengths_nm = {555};
  model.aperture.value = 2 * beam_radius;
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
  const trace::RayBatch exact = exact_rays(eye.scene, cornea), other = traced(eye.scene);
  errors.wavefront = difference(eye, exact, other, false);
  errors.own_wavefront = difference(eye, exact, other, true);
  return errors;
}

// The figures asked for: .02 um and .02 waves. To each trace's own sphere, where the slope under the chief ray counts, they are
// asked of the shared files; on exact circles without a point at the apex the slope there is extrapolated, and only reported.
void expect_c1_to_be_exact_enough(const PointCloud& cloud, const Kind& kind, const std::string& source, bool to_its_own_sphere_too) {
  const SyntheticCornea cornea(kind.kind);
  for (const std::string interpolation : {"c1", "linear"}) {
    const Errors errors = errors_of(cloud, cornea, interpolation);
    fmt::print("[ report   ] {}, {}, {}: sag {:.5f} um rms, {:.4f} at worst; wavefront {:.5f} waves rms, {:.4f} at worst; to its own sphere {:.5f}\n", kind.name, source, interpolation,
               errors.sag_rms_um, errors.sag_worst_um, errors.wavefront.rms_waves, errors.wavefront.worst_waves, errors.own_wavefront.rms_waves);
    EXPECT_TRUE(std::isfinite(errors.sag_rms_um) && std::isfinite(errors.wavefront.rms_waves));
    if (interpolation == "c1") {
      EXPECT_LE(errors.sag_rms_um, .02);
      EXPECT_LE(errors.wavefront.rms_waves, .02);
      if (to_its_own_sphere_too) {
        EXPECT_LE(errors.own_wavefront.rms_waves, .02);
      }
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
  expect_c1_to_be_exact_enough(samples_of(SyntheticCornea(kind.kind)), kind, "24 x 180 samples", false);
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
  expect_c1_to_be_exact_enough(*cloud, kind, kind.file, true);
}

}  // namespace
}  // namespace sagitta::test
