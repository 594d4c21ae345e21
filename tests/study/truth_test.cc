// SPDX-License-Identifier: Apache-2.0
// The exact rays against closed forms that know nothing of the templates, and against the tracer where it has no more than rounding.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/study/truth.h"
#include "lib/study/uniform.h"
#include "lib/trace/pattern.h"
#include "tests/study/subjects.h"

namespace sagitta::test {
namespace {

using study::TrueRay;
using study::TrueRays;
using surface::Status;
using Long = long double;

const std::vector<trace::PupilPoint> pupil = trace::pupil_points({trace::PatternKind::random, 4}, 300);

TrueRays rays_of(const scene::Scene& scene, const study::TrueRaysRequest& request, std::span<const trace::PupilPoint> points = pupil) {
  const auto result = study::true_rays(scene, scene.primary, scene.fields.front(), points, request);
  EXPECT_TRUE(result.rays) << result.reason;
  return result.rays.value_or(TrueRays{});
}

// Rays along the axis through an ellipsoid of K = -1/n^2 meet in one point, n R/(n - 1) behind its vertex (Cartesian oval): n = 2,
// K = -1/4, R = 8 and 16 mm are exact doubles, so nothing is left but the arithmetic's own rounding, 1e-50 of 16 mm, a few times.
TEST(TrueRays, MeetInTheFocusOfACartesianOvalToFiftyDigits) {
  const auto compiled = checked(scene::compile(system_of({surface_of(conic_shape(8, -.25), 16, 2)}, 10)));
  const TrueRays rays = rays_of(compiled.scene, {});
  ASSERT_EQ(rays.at_image.size(), 300u);
  for (const TrueRay& ray : rays.at_image) {
    EXPECT_EQ(ray.ended, 0);
    EXPECT_LT(std::hypot(ray.position.x, ray.position.y), 1e-46L);
  }
}

TEST(TrueRays, MeetInTheFocusOfAParabolicMirrorToFiftyDigits) {
  const auto compiled = checked(scene::compile(system_of({surface_of(conic_shape(-64, -1), -32, 0)}, 40)));
  for (const TrueRay& ray : rays_of(compiled.scene, {}).at_image) {
    EXPECT_EQ(ray.ended, 0);
    EXPECT_LT(std::hypot(ray.position.x, ray.position.y), 1e-46L);
  }
}

// The lens of section 3.A by the textbook, in long double: the hit z = R - sqrt(R^2 - r^2) without cancellation, the ray turned by
// asin(r/R) - asin(r/(n R)) toward the axis. Its rounding is 1e-19 of a few numbers of about 1, and of 12.5 mm.
TEST(TrueRays, AreThoseOfTheTextbookOnASphere) {
  const auto compiled = checked(scene::compile(paper_lens()));
  const Long c = std::get<surface::Sphere>(compiled.scene.surface(1).shape).curvature, index = compiled.scene.primary.index[1];
  const auto launched = trace::launch(compiled.scene, compiled.scene.fields.front(), 1, pupil);
  for (const auto digits : {study::Digits::fifty, study::Digits::extended}) {
    const TrueRays rays = rays_of(compiled.scene, {.digits = digits});
    for (std::size_t i = 0; i < pupil.size(); ++i) {
      const Long x = launched.x[i], y = launched.y[i], r = std::hypot(x, y), root = std::sqrt((1 - c * r) * (1 + c * r));
      const Long turned = std::asin(c * r) - std::asin(c * r / index);
      const TrueRay& ray = rays.at_surface[i];
      EXPECT_EQ(ray.position.x, x);
      EXPECT_EQ(ray.position.y, y);
      EXPECT_NEAR(static_cast<double>(ray.position.z - c * r * r / (1 + root)), 0, 1e-17);
      EXPECT_NEAR(static_cast<double>(ray.direction.x + std::sin(turned) * x / r), 0, 1e-18);
      EXPECT_NEAR(static_cast<double>(ray.direction.z - std::cos(turned)), 0, 1e-18);
    }
  }
}

prescription::Model tilted_zernike_eye() {
  auto zernike = surface_of(zernike_shape(7.72, -.26, 3, {{4, -2}, {6, 1.5}, {12, .7}, {17, -.3}}), 3.6, 1.376);
  zernike.tilt_deg = {2, -3, 10};
  zernike.decenter_mm = {.2, -.1, .05};
  return system_of({zernike, surface_of(conic_shape(10.2, -3.1), 4, 1.42), surface_of(conic_shape(-6, 0), 16, 1.336)}, 4, {7});
}

// Coordinates up to 16 mm, angles up to 30 degrees: some 40 operations of eps 16 mm each, at three surfaces that at most double what comes to
// them (tests/trace/oracle_test.cc derives the bound ray by ray).
TEST(TrueRays, AreThoseOfTheTracerToItsRounding) {
  const auto compiled = checked(scene::compile(tilted_zernike_eye()));
  const TrueRays exact = rays_of(compiled.scene, {});
  trace::RayBatch rays = trace::launch(compiled.scene, compiled.scene.fields.front(), 1, pupil);
  const double tolerance = 40 * 2.2e-16 * 16 * 8;
  const auto compare = [&](const std::vector<TrueRay>& with) {
    int compared = 0;
    for (std::size_t i = 0; i < pupil.size(); ++i) {
      ASSERT_EQ(rays.ended[i], with[i].ended);
      EXPECT_LT(norm(numerics::vec3_cast<Long>(rays.position(i)) - with[i].position), tolerance);
      EXPECT_LT(norm(numerics::vec3_cast<Long>(rays.direction(i)) - with[i].direction), tolerance);
      ++compared;
    }
    EXPECT_EQ(compared, 300);
  };
  for (int number = 1; number <= compiled.scene.surface_count(); ++number) {
    trace_surface(compiled.scene, compiled.scene.primary, number, rays);
    compare(number == 4 ? exact.at_image : rays_of(compiled.scene, {.surface_number = number}).at_surface);
  }
  compare(exact.at_image);
}

// Every way to be lost, with the surface that says so: beyond and inside apertures, by total reflection, past the sphere.
TEST(TrueRays, EndAsTheTracersDo) {
  auto first = surface_of(conic_shape(30, 0), 2, 1.5), second = surface_of(conic_shape(-6, 0), 10, 1);
  first.semi_diameter_mm = 7;
  first.inner_semi_diameter_mm = 1;
  const auto compiled = checked(scene::compile(system_of({first, second}, 16)));
  const TrueRays exact = rays_of(compiled.scene, {});
  trace::RayBatch rays = trace::launch(compiled.scene, compiled.scene.fields.front(), 1, pupil);
  trace::trace(compiled.scene, compiled.scene.primary, rays);
  trace::StatusCounts counts;
  for (std::size_t i = 0; i < pupil.size(); ++i) {
    EXPECT_EQ(exact.at_image[i].ended, rays.ended[i]) << i;
    counts.add(exact.at_image[i].ended);
    EXPECT_EQ(exact.at_surface[i].ended != 0, rays.ended_at(i) == 1);
  }
  EXPECT_GT(counts[Status::ok], 50);
  EXPECT_GT(counts[Status::clipped], 10);
  EXPECT_GT(counts[Status::total_reflection], 10);
  EXPECT_GT(counts[Status::missed], 5);
}

// On a rough surface the hit lies on the sag with the roughness, the normal is that of their sum (Snell, from the gradient by hand), and
// long double says the same as 50 digits to its own rounding: phases up to 1e3 rad of 2^-64, times the amplitudes, below the rounding of 1 mm.
TEST(TrueRays, MeetARoughSurface) {
  auto model = system_of({surface_of(conic_shape(20, -.5), 30, 1.5)}, 6, {5});
  const auto compiled = checked(scene::compile(model));
  const study::Roughness roughness(1e-4, .05, 3, 64);
  const auto points = std::span(pupil).first(40);
  const TrueRays rays = rays_of(compiled.scene, {.roughness = &roughness}, points),
                 extended = rays_of(compiled.scene, {.roughness = &roughness, .digits = study::Digits::extended}, points),
                 bare = rays_of(compiled.scene, {}, points);
  const auto& conic = std::get<surface::Conic>(compiled.scene.surface(1).shape);
  const auto launched = trace::launch(compiled.scene, compiled.scene.fields.front(), 1, points);
  double farthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const TrueRay& ray = rays.at_surface[i];
    ASSERT_EQ(ray.ended, 0);
    const auto height = roughness.height(ray.position.x, ray.position.y);
    EXPECT_LT(std::abs(ray.position.z - conic.sag(ray.position.x, ray.position.y) - height.z), 1e-18L);
    const auto slope = conic.gradient(ray.position.x, ray.position.y);
    const Vec3<Long> normal = numerics::normalized(Vec3<Long>{-slope.x - height.dz_dx, -slope.y - height.dz_dy, 1});
    const auto before = numerics::normalized(numerics::vec3_cast<Long>(launched.direction(i)));
    EXPECT_LT(norm(cross(normal, before) - Long(1.5) * cross(normal, ray.direction)), 2e-18L);  // n sin = n' sin, in one plane
    EXPECT_LT(norm(ray.position - extended.at_surface[i].position), 1e-17L);
    EXPECT_LT(norm(ray.direction - extended.at_surface[i].direction), 1e-17L);
    EXPECT_EQ(rays.at_image[i].position.z, 0);  // the image plane is not rough
    farthest = std::max(farthest, static_cast<double>(norm(ray.position - bare.at_surface[i].position)));
  }
  EXPECT_GT(farthest, 5e-5);
  EXPECT_LT(farthest, 5e-4);
}

// A launched direction of doubles is not of unit length: it stands for its line.
TEST(TrueRays, HaveDirectionsOfUnitLength) {
  int rounded = 0;
  for (int angle = 1; angle <= 30; ++angle) {
    const auto compiled = checked(scene::compile(system_of({surface_of({}, 10, 1)}, 4, {static_cast<double>(angle)})));
    const auto points = std::span(pupil).first(1);
    const auto length = [](const Vec3<Long>& d) { return std::sqrt(dot(d, d)); };
    rounded += std::abs(length(numerics::vec3_cast<Long>(trace::launch(compiled.scene, compiled.scene.fields.front(), 1, points).direction(0))) - 1) > 1e-17L;
    EXPECT_LT(std::abs(length(rays_of(compiled.scene, {}, points).at_image.front().direction) - 1), 3e-19L) << angle;
  }
  EXPECT_GT(rounded, 5);
}

TEST(TrueRays, AreTheSameOnAnyNumberOfThreads) {
  const auto compiled = checked(scene::compile(tilted_zernike_eye()));
  const TrueRays one = rays_of(compiled.scene, {.thread_count = 1}), three = rays_of(compiled.scene, {.thread_count = 3});
  for (std::size_t i = 0; i < pupil.size(); ++i) {
    EXPECT_TRUE(one.at_surface[i].position == three.at_surface[i].position);
    EXPECT_TRUE(one.at_image[i].direction == three.at_image[i].direction);
  }
}

TEST(TrueRays, ThereAreNoneWithoutTheSurface) {
  const auto compiled = checked(scene::compile(paper_lens()));
  for (const int number : {0, 3})
    EXPECT_EQ(study::true_rays(compiled.scene, compiled.scene.primary, compiled.scene.fields.front(), pupil, {.surface_number = number}).reason,
              "there is no surface " + std::to_string(number) + ": the system has 1 to 2");
}

}  // namespace
}  // namespace sagitta::test
