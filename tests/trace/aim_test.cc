// SPDX-License-Identifier: Apache-2.0
// Rays aimed at the stop: exact cases, wide angles, decentred and tilted stops, random systems, and that nothing is lost in silence.
#include "lib/trace/aim.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/trace/pattern.h"
#include "tests/support/random_system.h"

namespace sagitta::test {
namespace {

using numerics::dot;
using numerics::norm;
using trace::PupilPoint;
using trace::RayBatch;

constexpr double degree = std::numbers::pi / 180;
const std::vector<PupilPoint> points{{0, 0}, {0, 1}, {1, 0}, {-0.6, 0.8}, {0.3, -0.5}, {0, -1}, {-1, 0}};

// The scene up to its stop, where rays end: an independent way of it, surface by surface.
RayBatch at_stop(const scene::Scene& scene, const scene::Wavelength& wavelength, RayBatch rays) {
  scene::Scene open = scene;
  for (scene::Surface& surface : open.surfaces) surface.semi_diameter = std::numeric_limits<double>::infinity(), surface.inner_semi_diameter = 0;
  scene::Surface& stop = open.surfaces[static_cast<std::size_t>(scene.stop - 1)];
  stop.mirror = false, stop.image = true;
  for (int number = 1; number <= scene.stop; ++number) trace_surface(open, wavelength, number, rays);
  return rays;
}

// How far rays are from their points of the stop at most, in units of its semi-diameter, and how many are lost.
struct Met {
  double worst = 0;
  std::size_t lost = 0;
};
Met met(const scene::Scene& scene, const scene::Field& field, std::span<const PupilPoint> pupil, const scene::Wavelength& wavelength) {
  const RayBatch launched = launch(scene, field, wavelength, pupil);
  const RayBatch rays = at_stop(scene, wavelength, launched);
  Met result;
  for (std::size_t i = 0; i < pupil.size(); ++i) {
    if (launched.ended[i] != 0) {
      EXPECT_EQ(launched.ended[i], trace::ending(scene.stop, trace::Status::not_converged));
      ++result.lost;
      continue;
    }
    EXPECT_EQ(rays.ended[i], 0);
    const double radius = scene.pupil.stop_semi_diameter;
    result.worst = std::max({result.worst, std::abs(rays.x[i] / radius - pupil[i].x), std::abs(rays.y[i] / radius - pupil[i].y)});
  }
  return result;
}

constexpr double stated = 1e-9;  // aim.h

Vec3<double> at_plane(const RayBatch& rays, std::size_t i, double z) { return rays.position(i) + ((z - rays.z[i]) / rays.n[i]) * rays.direction(i); }

// Behind a plate of thickness t and index n, at d: a ray that meets the first face at y meets the stop at y + t tan(refracted) + d tan(angle).
TEST(Aim, through_a_window_is_exact_at_any_angle) {
  for (const double angle : {0.0, 10.0, 60.0, 80.0, 85.0, 89.0}) {
    const CompiledScene compiled = scene_of("  - {thickness_mm: 3, medium: {index: 1.5}}\n  - {thickness_mm: 2}\n  - {stop: true, thickness_mm: 5}\n  - {}\n", "stop_diameter_mm: 1, aim: stop",
                                            fmt::format("fields: {{angles_deg: [[0, {}]]}}\n", angle));
    const RayBatch rays = launch(compiled.scene, compiled.scene.fields[0], compiled.wavelength(), points);
    const double a = angle * degree, tangent = std::tan(a), refracted = std::sin(a) / std::sqrt(2.25 - std::sin(a) * std::sin(a));
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(rays.ended[i], 0);
      const Vec3<double> p = at_plane(rays, i, 0);
      // 1e-12 of the stop, and some 10 roundings of a place as far away as the ray begins, by a direction that knows its cosine to eps/cosine^2 of it
      const double tolerance = 0.5 * 1e-12 * (1 + tangent) + 10 * 0x1p-52 * (1 + std::abs(p.y)) * (1 + tangent * tangent);
      EXPECT_NEAR(p.x, 0.5 * points[i].x, tolerance) << angle;
      EXPECT_NEAR(p.y, 0.5 * points[i].y - 3 * refracted - 2 * tangent, tolerance) << angle;
    }
  }
}

// With the stop across the centre of a refracting sphere: the chief ray passes the centre undeviated, and one that passes the centre at b outside passes it at
// b/n inside, turned by asin(b/R) - asin(b/(n R)) toward it; it meets the stop, the plane z = R, at (b/n)/cos(its angle to the axis).
TEST(Aim, into_a_sphere_about_the_stop_is_exact_at_any_angle) {
  constexpr double R = 8, n = 1.5, semi_diameter = 2;
  const auto at_stop_of = [&](double b, double a) { return b / n / std::cos(a - std::asin(b / R) + std::asin(b / (n * R))); };
  for (const double angle : {0.0, 20.0, 70.0, 80.0, 85.0}) {
    const double a = angle * degree;
    const CompiledScene compiled = scene_of("  - {conic: {radius_mm: 8}, thickness_mm: 8, medium: {index: 1.5}}\n  - {stop: true, thickness_mm: 5, medium: {index: 1.5}}\n  - {}\n",
                                            "stop_diameter_mm: 4, aim: stop", fmt::format("fields: {{angles_deg: [[0, {}]]}}\n", angle));
    const std::vector<PupilPoint> fan{{0, -1}, {0, -0.4}, {0, 0}, {0, 0.7}, {0, 1}};
    const RayBatch rays = launch(compiled.scene, compiled.scene.fields[0], compiled.wavelength(), fan);
    for (std::size_t i = 0; i < fan.size(); ++i) {
      ASSERT_EQ(rays.ended[i], 0) << angle;
      double low = -0.99 * n * semi_diameter - 1, high = -low;
      for (int k = 0; k < 100; ++k) (at_stop_of((low + high) / 2, a) < semi_diameter * fan[i].y ? low : high) = (low + high) / 2;
      const Vec3<double> from_centre = rays.position(i) - Vec3<double>{0, 0, R}, d = rays.direction(i);
      EXPECT_NEAR(from_centre.y * d.z - from_centre.z * d.y, low, 1e-11) << angle << " " << fan[i].y;  // b: 1e-12 of the stop, n times
    }
  }
}

// With nothing before it the stop is met at its own (x, y), turned and moved as it is; and upright in the middle there is nothing to aim.
TEST(Aim, at_a_decentred_and_tilted_stop_in_front) {
  const CompiledScene compiled = scene_of("  - {stop: true, decenter_mm: [0.5, -1, 0.25], tilt_deg: [30, 0, 0], thickness_mm: 5}\n  - {}\n", "stop_diameter_mm: 4, aim: stop",
                                          "fields: {angles_deg: [[0, 0], [20, -40], [0, 55]]}\n");
  const double c = std::cos(30 * degree), s = std::sin(30 * degree);
  for (const scene::Field& field : compiled.scene.fields) {
    const RayBatch rays = launch(compiled.scene, field, compiled.wavelength(), points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(rays.ended[i], 0);
      const Vec3<double> place{0.5 + 2 * points[i].x, -1 + 2 * c * points[i].y, 0.25 + 2 * s * points[i].y};  // +y turned toward +z
      EXPECT_LE(norm(cross(rays.position(i) - place, rays.direction(i))), 1e-11);
    }
  }
  for (const char* more : {"fields: {angles_deg: [[0, 0], [30, 60]]}\n", "object: {distance_mm: 40}\nfields: {object_heights_mm: [[0, 0], [30, -60]]}\n"}) {
    const CompiledScene aimed = scene_of("  - {stop: true, thickness_mm: 5}\n  - {}\n", "stop_diameter_mm: 4, aim: stop", more);
    const CompiledScene plain = scene_of("  - {stop: true, thickness_mm: 5}\n  - {}\n", "stop_diameter_mm: 4", more);
    for (std::size_t field = 0; field < 2; ++field) {
      const RayBatch a = launch(aimed.scene, aimed.scene.fields[field], aimed.wavelength(), points), b = launch(plain.scene, plain.scene.fields[field], plain.wavelength(), points);
      EXPECT_EQ(a.opl_origin, b.opl_origin);
      for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_LE(norm(a.position(i) - b.position(i)), 1e-14);
        EXPECT_LE(norm(a.direction(i) - b.direction(i)), 1e-15);
        EXPECT_NEAR(a.opl[i], b.opl[i], 1e-14);
      }
    }
  }
}

// After a plane mirror the way is unfolded.
TEST(Aim, by_a_mirror) {
  const CompiledScene compiled = scene_of("  - {thickness_mm: -7, medium: mirror}\n  - {stop: true, thickness_mm: -5, medium: {index: 1}}\n  - {}\n", "stop_diameter_mm: 2, aim: stop",
                                          "fields: {angles_deg: [[0, 75]]}\n");
  const RayBatch rays = launch(compiled.scene, compiled.scene.fields[0], compiled.wavelength(), points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(rays.ended[i], 0);
    const Vec3<double> p = at_plane(rays, i, 0);
    EXPECT_NEAR(p.x, points[i].x, 1e-12);
    EXPECT_NEAR(p.y, points[i].y - 7 * std::tan(75 * degree), 1e-12 * (1 + std::tan(75 * degree)));
  }
}

// A negative meniscus and a lens behind it: at 80 degrees the pupil is many of its radii away from the paraxial one.
std::string fisheye_of(int front_radius, int rear_radius, int gap) {
  return fmt::format("  - {{conic: {{radius_mm: {}}}, thickness_mm: 1.5, medium: {{index: 1.7}}}}\n  - {{conic: {{radius_mm: {}}}, thickness_mm: {}}}\n", front_radius, rear_radius, gap) +
         "  - {conic: {radius_mm: 30}, thickness_mm: 3, medium: {index: 1.6}}\n  - {conic: {radius_mm: -15}, thickness_mm: 1}\n  - {stop: true, thickness_mm: 1}\n"
         "  - {conic: {radius_mm: 20}, thickness_mm: 3, medium: {index: 1.6}}\n  - {conic: {radius_mm: -9}, thickness_mm: 10}\n  - {}\n";
}
const std::string fisheye = fisheye_of(200, 12, 7), narrower = fisheye_of(80, 8, 4);

TEST(Aim, of_a_fisheye_meets_the_stop_at_80_degrees_and_beyond) {
  const CompiledScene compiled = scene_of(fisheye, "stop_diameter_mm: 0.5, aim: stop", "fields: {angles_deg: [[0, 40], [50, -60], [0, 80], [0, 85], [-85, 0]]}\n");
  for (const scene::Field& field : compiled.scene.fields) {
    const Met all = met(compiled.scene, field, trace::pupil_points({}, 500), compiled.wavelength());
    EXPECT_EQ(all.lost, 0u) << field.y;
    EXPECT_LE(all.worst, stated);
  }
  const trace::AimedPupil chief = trace::Launcher(compiled.scene, compiled.scene.fields[3], compiled.wavelength()).at_entrance_pupil(std::vector<PupilPoint>{{0, 0}});
  EXPECT_GT(chief.points[0].y, 100);  // radii of the paraxial pupil
}

// The map is folded there: other rays of the field meet the same place of the stop. The one that is meant is the one that comes from the axis without a jump: from degree to degree the
// chief ray's place across the bundle goes on as it went.
TEST(Aim, of_a_fisheye_stays_on_its_branch) {
  std::string angles;
  for (int angle = 0; angle <= 88; ++angle) angles += fmt::format("{}[0, {}]", angle > 0 ? ", " : "", angle);
  const CompiledScene compiled = scene_of(fisheye, "stop_diameter_mm: 0.5, aim: stop", "fields: {angles_deg: [" + angles + "]}\n");
  std::vector<double> u;
  for (int angle = 0; angle <= 88; ++angle) {
    const trace::AimedPupil chief = trace::Launcher(compiled.scene, compiled.scene.fields[static_cast<std::size_t>(angle)], compiled.wavelength()).at_entrance_pupil(std::vector<PupilPoint>{{0, 0}});
    ASSERT_TRUE(chief.found[0]) << angle;
    u.push_back(chief.points[0].y * std::cos(angle * degree));
  }
  for (std::size_t k = 2; k < u.size(); ++k) EXPECT_LE(std::abs(u[k] - 2 * u[k - 1] + u[k - 2]), 0.1 * (u[k] - u[k - 1]) + 0.01) << k;
  EXPECT_GT(u.back(), 20);
}

TEST(Aim, of_the_wide_angle_eye_meets_the_stop_at_85_degrees) {
  const CompiledScene eye = scene_of("  - {conic: {radius_mm: 7.72, conic_constant: -0.26}, thickness_mm: 0.55, medium: {index: 1.3777}}\n"
                                     "  - {conic: {radius_mm: 6.5}, thickness_mm: 3.05, medium: {index: 1.3391}}\n  - {stop: true, thickness_mm: 0, medium: {index: 1.3391}}\n"
                                     "  - {conic: {radius_mm: 10.2, conic_constant: -3.1316}, thickness_mm: 20, medium: {index: 1.4222}}\n  - {conic: {radius_mm: -12}}\n",
                                     "stop_diameter_mm: 4, aim: stop", "fields: {angles_deg: [[0, 0], [0, 80], [0, 85], [60, 60]]}\n");
  for (const scene::Field& field : eye.scene.fields) {
    const Met all = met(eye.scene, field, trace::pupil_points({}, 1000), eye.wavelength());
    EXPECT_EQ(all.lost, 0u);
    EXPECT_LE(all.worst, 1e-12);  // smooth: the last chord leaves what rounding does
  }
}

// A larger stop is only met in part: what is found meets it, and what is not found no ray of a dense scan meets either, but for those beside the edge.
TEST(Aim, finds_what_a_dense_scan_finds) {
  const CompiledScene compiled = scene_of(narrower, "stop_diameter_mm: 2, aim: stop", "fields: {angles_deg: [[0, 80], [20, 77]]}\n");
  const scene::Scene& scene = compiled.scene;
  constexpr int half = 12;
  for (const scene::Field& field : scene.fields) {
    bool is_reached[2 * half + 1][2 * half + 1] = {};
    for (int i = -300; i <= 300; ++i) {
      std::vector<PupilPoint> starts;
      for (int j = 0; j <= 1200; ++j) starts.push_back({i * 0.1, 10 + j * 0.04});
      const RayBatch rays = at_stop(scene, compiled.wavelength(), launch(scene, field, 1, starts));
      for (std::size_t k = 0; k < rays.size(); ++k)
        if (rays.ended[k] == 0 && std::hypot(rays.x[k], rays.y[k]) <= 1) is_reached[std::lround(half * rays.x[k]) + half][std::lround(half * rays.y[k]) + half] = true;
    }
    std::vector<PupilPoint> cells;
    for (int i = -half; i <= half; ++i)
      for (int j = -half; j <= half; ++j)
        if (i * i + j * j < (half - 1) * (half - 1)) cells.push_back({static_cast<double>(i) / half, static_cast<double>(j) / half});
    const Met all = met(scene, field, cells, compiled.wavelength());
    EXPECT_LE(all.worst, 1e-11);  // what is left of the last step's miss where it leaves a half of it, 1e-12, and rounding at such angles
    const RayBatch launched = launch(scene, field, compiled.wavelength(), cells);
    int found = 0, beside = 0;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const bool scanned = is_reached[std::lround(half * cells[k].x) + half][std::lround(half * cells[k].y) + half];
      found += launched.ended[k] == 0;
      beside += scanned && launched.ended[k] != 0;
    }
    EXPECT_GT(found, 100);
    EXPECT_LE(beside, 2 * half);  // the cells that the edge passes through
  }
  EXPECT_GT(met(scene, scene.fields[0], points, compiled.wavelength()).lost, 0u);
}

TEST(Aim, of_every_pattern_meets_the_stop) {
  const CompiledScene compiled = scene_of(fisheye, "stop_diameter_mm: 0.5, aim: stop", "fields: {angles_deg: [[20, 50]]}\n");
  for (const char* pattern : {"hexapolar", "square", "random:3", "fan_x", "fan_y"}) {
    const Met all = met(compiled.scene, compiled.scene.fields[0], trace::pupil_points(*trace::parse_pattern(pattern), 301), compiled.wavelength());
    EXPECT_EQ(all.lost, 0u) << pattern;
    EXPECT_LE(all.worst, 1e-12) << pattern;
  }
}

// Where the chief ray itself goes nowhere, the rest is found.
TEST(Aim, finds_a_part_without_the_chief_ray) {
  const CompiledScene compiled = scene_of(fisheye_of(40, 8, 7), "stop_diameter_mm: 2, aim: stop", "fields: {angles_deg: [[0, 85]]}\n");
  const RayBatch rays = launch(compiled.scene, compiled.scene.fields[0], compiled.wavelength(), trace::pupil_points({}, 500));
  EXPECT_EQ(rays.ended.back(), trace::ending(5, trace::Status::not_converged));  // the last point is the centre
  EXPECT_GT(std::count(rays.ended.begin(), rays.ended.end(), 0), 100);
}

// Behind a lens that turns the pupil upside down, a point of the stop is no beginning for its own search: it misses the ball.
TEST(Aim, finds_a_disc_on_the_other_side_of_the_centre) {
  const CompiledScene compiled = scene_of("  - {conic: {radius_mm: -2.5}, decenter_mm: [0, 3, 0], thickness_mm: 5}\n  - {conic: {radius_mm: 200}, thickness_mm: 0, medium: {index: 1.5}}\n"
                                          "  - {conic: {radius_mm: -200}, thickness_mm: 400}\n  - {stop: true, thickness_mm: 5}\n  - {}\n", "stop_diameter_mm: 8, aim: stop");
  const Met all = met(compiled.scene, compiled.scene.fields[0], std::vector<PupilPoint>{{0, -0.75}, {0.05, -0.7}, {-0.1, -0.8}}, compiled.wavelength());
  EXPECT_EQ(all.lost, 0u);
  EXPECT_LE(all.worst, stated);
}

// Objects at a finite distance, and beams that are telecentric in object space.
// Rays go on from a ball of radius 1 alone, beside the axis, and bend nowhere: of the stop a disc about (0, 0.75) is reached, on which no sample about the centre lies.
TEST(Aim, finds_a_disc_beside_the_centre) {
  for (const char* field : {"0", "25"}) {
    const CompiledScene compiled = scene_of("  - {conic: {radius_mm: -1}, decenter_mm: [0, 3, 0], thickness_mm: 0}\n  - {stop: true, thickness_mm: 5}\n  - {}\n", "stop_diameter_mm: 8, aim: stop",
                                            std::string("fields: {angles_deg: [[0, ") + field + "]]}\n");
    const Met all = met(compiled.scene, compiled.scene.fields[0], std::vector<PupilPoint>{{0, 0.75}, {0.05, 0.7}, {-0.1, 0.8}}, compiled.wavelength());
    EXPECT_EQ(all.lost, 0u) << field;
    EXPECT_LE(all.worst, stated);
    EXPECT_EQ(met(compiled.scene, compiled.scene.fields[0], std::vector<PupilPoint>{{0, 0}, {0.5, 0}}, compiled.wavelength()).lost, 2u);
  }
}

TEST(Aim, from_a_near_object_and_in_a_telecentric_beam) {
  const std::string doublet = "  - {conic: {radius_mm: 20}, thickness_mm: 4, medium: {index: 1.6}}\n  - {conic: {radius_mm: -30}, thickness_mm: 10, decenter_mm: [0, 0.3, 0]}\n";
  for (const char* more : {"object: {distance_mm: 30}\nfields: {object_heights_mm: [[0, 0], [1, -4]]}\n", "object: {distance_mm: -200}\nfields: {angles_deg: [[0, 0], [5, 8]]}\n"}) {
    const CompiledScene near = scene_of(doublet + "  - {stop: true, thickness_mm: 5, decenter_mm: [0.4, 0, 0], tilt_deg: [0, 12, 0]}\n  - {}\n", "entrance_pupil_diameter_mm: 6, aim: stop", more);
    for (const scene::Field& field : near.scene.fields) {
      const Met all = met(near.scene, field, trace::pupil_points({}, 300), near.wavelength());
      EXPECT_EQ(all.lost, 0u) << more;
      EXPECT_LE(all.worst, stated) << more;
    }
    const RayBatch rays = launch(near.scene, near.scene.fields[1], near.wavelength(), points), plain = launch(near.scene, near.scene.fields[1], 1, points);
    EXPECT_EQ(rays.opl_origin, plain.opl_origin);
    EXPECT_GT(norm(rays.direction(0) - plain.direction(0)), 1e-3);  // it is the direction that is solved for
  }
  // A parabola's focal plane is f = 50 behind: 1/(n/f) with one surface
  const CompiledScene telecentric = scene_of("  - {conic: {radius_mm: 25, conic_constant: -0.5}, thickness_mm: 75, medium: {index: 1.5}}\n  - {stop: true, thickness_mm: 5, medium: {index: 1.5}}\n  - {}\n",
                                             "object_na: 0.1, aim: stop", "object: {distance_mm: 60}\nfields: {object_heights_mm: [[0, 0], [0, 8], [-6, 3]]}\n");
  ASSERT_TRUE(telecentric.scene.pupil.telecentric);
  for (const scene::Field& field : telecentric.scene.fields) {
    const Met all = met(telecentric.scene, field, trace::pupil_points({}, 300), telecentric.wavelength());
    EXPECT_EQ(all.lost, 0u);
    EXPECT_LE(all.worst, 1e-12);
    const RayBatch rays = launch(telecentric.scene, field, telecentric.wavelength(), points);
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(rays.position(i).y, field.y);
  }
}

// The stop's own shape, an aperture on the way and one at the stop, and what the stop does to rays change nothing of what is met.
TEST(Aim, takes_no_notice_of_apertures_and_of_what_the_stop_does) {
  const auto system = [](const char* of_first, const char* of_stop) {
    return scene_of(fmt::format("  - {{conic: {{radius_mm: 20}}, thickness_mm: 6, medium: {{index: 1.5}}{}}}\n  - {{stop: true, conic: {{radius_mm: -9}}, thickness_mm: 5{}}}\n  - {{}}\n", of_first, of_stop),
                    "stop_diameter_mm: 5, aim: stop", "fields: {angles_deg: [[0, 35]]}\n");
  };
  const CompiledScene open = system("", ""), clipping = system(", semi_diameter_mm: 2, inner_semi_diameter_mm: 1", ", inner_semi_diameter_mm: 1, semi_diameter_mm: 2");
  const CompiledScene mirror = system("", ", medium: mirror"), dense = system("", ", medium: {index: 1.9}");
  const std::vector<PupilPoint> pupil = trace::pupil_points({}, 200);
  const RayBatch expected = launch(open.scene, open.scene.fields[0], open.wavelength(), pupil);
  for (const CompiledScene* other : {&clipping, &mirror, &dense}) {
    const RayBatch rays = launch(other->scene, other->scene.fields[0], other->wavelength(), pupil);
    EXPECT_EQ(rays.x, expected.x);
    EXPECT_EQ(rays.y, expected.y);
    EXPECT_EQ(rays.ended, std::vector<std::int32_t>(pupil.size(), 0));
  }
  EXPECT_LE(met(open.scene, open.scene.fields[0], pupil, open.wavelength()).worst, 1e-12);
  RayBatch rays = launch(clipping.scene, clipping.scene.fields[0], clipping.wavelength(), pupil);
  trace::trace(clipping.scene, clipping.wavelength(), rays);
  const trace::StatusCounts counts = count_statuses(rays);
  EXPECT_GT(counts[trace::Status::clipped], 50);
  EXPECT_EQ(counts.total(), static_cast<std::int64_t>(pupil.size()));
}

// In a gradient the rays that are aimed are those that the tracer integrates, to whatever tolerance.
TEST(Aim, through_a_gradient_is_of_the_rays_that_are_traced) {
  const auto system = [](const char* tolerance) {
    return scene_of("  - {conic: {radius_mm: 12}, thickness_mm: 6, medium: {grin: {polynomial: {index: 1.4, z_coefficients: {1: 0.01}, r_coefficients: {2: -0.003}}}}}\n"
                    "  - {stop: true, conic: {radius_mm: -20}, thickness_mm: 5, medium: {index: 1.4}}\n  - {}\n", "stop_diameter_mm: 4, aim: stop",
                    std::string("fields: {angles_deg: [[0, 0], [0, 50]]}\n") + tolerance);
  };
  for (const char* tolerance : {"", "tolerance_mm: 1e-6\n", "tolerance_mm: 1e-3\n"}) {
    const CompiledScene compiled = system(tolerance);
    for (const scene::Field& field : compiled.scene.fields) {
      const Met all = met(compiled.scene, field, trace::pupil_points({}, 60), compiled.wavelength());
      EXPECT_EQ(all.lost, 0u) << tolerance;
      EXPECT_LE(all.worst, stated) << tolerance;
    }
  }
}

TEST(Aim, of_random_systems_meets_the_stop_or_is_counted) {
  Uniform u(41);
  std::size_t rays = 0, lost = 0, systems = 0;
  for (int i = 0; i < 150; ++i) {
    prescription::Model model = random_model(u);
    for (auto& surface : model.surfaces) surface.stop = false;
    model.surfaces[static_cast<std::size_t>(u() * static_cast<double>(model.surfaces.size() - 1))].stop = true;
    model.aperture.is_of_stop = true;
    model.fields.points = {{0, 0}, {u(-20, 20), u(-20, 20)}};
    const scene::CompileResult compiled = scene::compile(model);
    if (!compiled.scene) continue;
    ++systems;
    for (const scene::Field& field : compiled.scene->fields) {
      const auto pupil = trace::pupil_points({trace::PatternKind::random, static_cast<std::uint64_t>(i)}, 60);
      const Met all = met(*compiled.scene, field, pupil, compiled.scene->primary);
      EXPECT_LE(all.worst, stated) << i;
      rays += pupil.size(), lost += all.lost;
    }
  }
  EXPECT_GT(systems, 100u);
  EXPECT_LT(static_cast<double>(lost), 0.25 * static_cast<double>(rays));
}

// A ray's start depends on nothing but the ray: in whatever company, on any number of threads.
TEST(Aim, has_the_same_bits_alone_and_among_others) {
  for (const char* diameter : {"0.4", "2"}) {  // by the fit, and without
    const CompiledScene compiled = scene_of(fisheye, fmt::format("stop_diameter_mm: {}, aim: stop", diameter), "fields: {angles_deg: [[0, 80]]}\n");
    const trace::Launcher launcher(compiled.scene, compiled.scene.fields[0], compiled.wavelength());
    const std::vector<PupilPoint> pupil = trace::pupil_points({}, 9000);
    const RayBatch all = launcher(pupil), shared = launcher(pupil, true, 3);
    EXPECT_TRUE(all.x == shared.x && all.y == shared.y && all.z == shared.z && all.m == shared.m && all.opl == shared.opl && all.ended == shared.ended);
    for (std::size_t i = 0; i < pupil.size(); i += 511) {
      const RayBatch one = launch(compiled.scene, compiled.scene.fields[0], compiled.wavelength(), std::vector<PupilPoint>{pupil[i]});
      EXPECT_TRUE(one.x[0] == all.x[i] && one.y[0] == all.y[i] && one.z[0] == all.z[i] && one.opl[0] == all.opl[i] && one.ended[0] == all.ended[i]) << i;
    }
  }
}

// What it costs: the fit begins so near that a ray is traced to the stop twice at most, and once where the pupil's aberration is small.
TEST(Aim, traces_a_ray_to_the_stop_twice) {
  const CompiledScene compiled = scene_of(fisheye, "stop_diameter_mm: 0.5, aim: stop", "fields: {angles_deg: [[0, 0], [0, 40], [-30, 60]]}\n");
  const std::vector<PupilPoint> pupil = trace::pupil_points({}, 2000);
  for (const auto& [field, most] : {std::pair(0, 1.0), std::pair(1, 1.01), std::pair(2, 2.0)}) {
    const trace::Launcher launcher(compiled.scene, compiled.scene.fields[static_cast<std::size_t>(field)], compiled.wavelength());
    EXPECT_LE(static_cast<double>(launcher.at_entrance_pupil(pupil).passes) / static_cast<double>(pupil.size()), most) << field;
    EXPECT_LT(launcher.aim()->passes_before(), 2000);
  }
}

// Without aim nothing of it is done, and the rays are those of the paraxial pupil, bit for bit.
TEST(Aim, is_not_there_unless_it_is_asked_for) {
  const CompiledScene compiled = scene_of(fisheye, "stop_diameter_mm: 2", "fields: {angles_deg: [[0, 40]]}\n");
  const trace::Launcher launcher(compiled.scene, compiled.scene.fields[0], compiled.wavelength());
  EXPECT_FALSE(launcher.aim());
  const RayBatch rays = launcher(points), plain = launch(compiled.scene, compiled.scene.fields[0], 1, points);
  EXPECT_TRUE(rays.x == plain.x && rays.y == plain.y && rays.z == plain.z && rays.m == plain.m && rays.opl == plain.opl);
}

// The semi-diameter of the stop that (1, 0) stands for: as given, or what the paraxial beam has there.
TEST(Aim, knows_the_semi_diameter_of_the_stop) {
  const auto of = [](const char* aperture, const char* more) { return scene_of(fisheye, aperture, more).scene.pupil; };
  const scene::LaunchPupil by_stop = of("stop_diameter_mm: 3, aim: stop", "");
  EXPECT_EQ(by_stop.stop_semi_diameter, 1.5);
  EXPECT_NEAR(of(fmt::format("entrance_pupil_diameter_mm: {:.17g}, aim: stop", 2 * by_stop.semi_diameter).c_str(), "").stop_semi_diameter, 1.5, 1e-14);
  // the marginal ray of a near object, in closed form: a thin lens of f = 20 (n = 1.5), object at 30, the stop 10 behind; sin u = .1
  const double tangent = 0.1 / std::sqrt(0.99), height = 30 * tangent;
  const CompiledScene near = scene_of("  - {conic: {radius_mm: 20}, thickness_mm: 0, medium: {index: 1.5}}\n  - {conic: {radius_mm: -20}, thickness_mm: 10}\n  - {stop: true, thickness_mm: 5}\n  - {}\n",
                                      "object_na: 0.1, aim: stop", "object: {distance_mm: 30}\n");
  EXPECT_NEAR(near.scene.pupil.stop_semi_diameter, std::abs(height + 10 * (tangent - height / 20)), 1e-13);
}

}  // namespace
}  // namespace sagitta::test
