// SPDX-License-Identifier: Apache-2.0
// What becomes of a ray: bits that depend on nothing but the ray, apertures, endings and the frames they are told in.
#include "lib/trace/trace.h"

#include <cmath>
#include <cstring>

#include "tests/support/random_system.h"

namespace sagitta::test {
namespace {

using surface::Status;
using trace::RayBatch, trace::SurfaceBySurface;

bool same_bits(const RayBatch& a, std::size_t from, const RayBatch& b) {
  const auto equal = [&](const std::vector<double>& one, const std::vector<double>& other) {
    return std::memcmp(&one[from], other.data(), other.size() * sizeof(double)) == 0;
  };
  return equal(a.x, b.x) && equal(a.y, b.y) && equal(a.z, b.z) && equal(a.l, b.l) && equal(a.m, b.m) && equal(a.n, b.n) &&
         equal(a.opl, b.opl) && std::memcmp(&a.ended[from], b.ended.data(), b.size() * sizeof(std::int32_t)) == 0;
}

bool has_dummy(const CompiledScene& compiled) {
  for (int number = 1; number <= compiled.scene.surface_count(); ++number) {
    const auto gap = static_cast<std::size_t>(number);
    if (compiled.scene.surface(number).does_nothing(compiled.wavelength().index[gap - 1], compiled.wavelength().index[gap])) return true;
  }
  return false;
}

TEST(Trace, gives_the_same_bits_for_any_thread_count) {
  Uniform u(11);
  for (int i = 0; i < 10; ++i) {
    const CompiledScene compiled = checked(scene::compile(random_model(u)));
    const RayBatch start = batch_of(random_rays(u, 10000));  // 40 blocks: enough for 8 threads
    RayBatch one = start;
    trace::trace(compiled.scene, compiled.wavelength(), one, 1);
    EXPECT_EQ(count_statuses(one).total(), 10000);
    for (const int threads : {2, 3, 8, 0}) {
      RayBatch many = start;
      trace::trace(compiled.scene, compiled.wavelength(), many, threads);
      EXPECT_TRUE(same_bits(one, 0, many)) << threads << " threads";
    }
  }
}

TEST(Trace, a_ray_does_not_depend_on_its_neighbours) {
  Uniform u(12);
  for (int i = 0; i < 20; ++i) {
    const CompiledScene compiled = checked(scene::compile(random_model(u)));
    const std::vector<GlobalRay> rays = random_rays(u, 1000);
    RayBatch all = batch_of(rays);
    trace::trace(compiled.scene, compiled.wavelength(), all);
    for (const auto& [from, count] : {std::pair{0, 1}, {1, 2}, {3, 7}, {10, 255}, {100, 256}, {255, 257}, {488, 512}, {999, 1}}) {
      RayBatch part = batch_of({rays.begin() + from, rays.begin() + from + count});
      trace::trace(compiled.scene, compiled.wavelength(), part);
      EXPECT_TRUE(same_bits(all, static_cast<std::size_t>(from), part)) << from << ' ' << count;
    }
  }
}

TEST(Trace, surface_by_surface_is_the_same_as_all_at_once) {
  Uniform u(13);
  int with_dummies = 0;
  for (int i = 0; i < 60; ++i) {
    const CompiledScene compiled = checked(scene::compile(random_model(u)));
    with_dummies += has_dummy(compiled);
    RayBatch at_once = batch_of(random_rays(u, 600));
    SurfaceBySurface stepwise(compiled.scene, compiled.wavelength(), at_once);
    trace::trace(compiled.scene, compiled.wavelength(), at_once);
    for (int number = 1; number < compiled.scene.surface_count(); ++number) stepwise.next();
    EXPECT_TRUE(same_bits(at_once, 0, stepwise.next()));
  }
  EXPECT_GE(with_dummies, 3);
}

// A plane in one medium is not traced: what comes behind it has the bits of the system without it, the gaps (exact in binary)
// added up.
TEST(Trace, dummy_planes_are_passed_by) {
  const std::string front = "  - {stop: true, conic: {radius_mm: 20, conic_constant: -0.5}, thickness_mm: ", back =
      "  - {conic: {radius_mm: -30}, thickness_mm: 8}\n  - {}\n", glass = ", medium: {index: 1.5}}\n";
  const CompiledScene with = scene_of(front + "1.5" + glass + "  - {thickness_mm: 0.25" + glass + "  - {plane: {}, thickness_mm: -0.75" + glass + back);
  const CompiledScene without = scene_of(front + "1" + glass + back);
  ASSERT_TRUE(has_dummy(with) && !has_dummy(without));
  Uniform u(17);
  std::vector<GlobalRay> rays = random_rays(u, 700);
  rays[5] = {{100, 0, 0}, {0, 0, 1}};  // misses the first surface
  RayBatch one = batch_of(rays), other = one;
  trace::trace(with.scene, with.wavelength(), one);
  trace::trace(without.scene, without.wavelength(), other);
  ASSERT_EQ(one.status(5), Status::missed);
  EXPECT_GT(count_statuses(other)[Status::ok], 600);
  for (std::size_t i = 0; i < other.size(); ++i)
    if (other.ended_at(i) > 1) other.ended[i] += 16;  // two surfaces less
  EXPECT_TRUE(same_bits(one, 0, other));
}

TEST(Trace, a_ray_parallel_to_a_dummy_plane_misses_it_and_its_neighbours_do_not_notice) {
  const CompiledScene compiled = scene_of("  - {stop: true, thickness_mm: 5, semi_diameter_mm: 10}\n  - {thickness_mm: 3, tilt_deg: [90, 0, 0]}\n  - {}\n");
  const std::vector<GlobalRay> rays{{{0, 1, -1}, {0, 0, 1}}, {{0, 0, -1}, {0, 0.6, 0.8}}};
  RayBatch both = batch_of(rays), alone = batch_of({rays[1]});
  // In the tilted plane's frame z is the old -y or y: a ray along the old z has no z component there, but for the sine of 90
  // degrees' rounding. So the direction is set along the plane exactly.
  const auto& row = compiled.scene.surface(2).local_from_previous.rotation.row_z;
  ASSERT_EQ(row.x, 0);
  both.m[0] = row.z, both.n[0] = -row.y;
  trace::trace(compiled.scene, compiled.wavelength(), both);
  trace::trace(compiled.scene, compiled.wavelength(), alone);
  EXPECT_EQ(both.status(0), Status::missed);
  EXPECT_EQ(both.ended_at(0), 2);
  RayBatch stepwise = batch_of(rays);
  stepwise.m[0] = row.z, stepwise.n[0] = -row.y;
  for (int number = 1; number <= 2; ++number) trace_surface(compiled.scene, compiled.wavelength(), number, stepwise);
  EXPECT_EQ(both.ended[0], stepwise.ended[0]);
  EXPECT_EQ(both.position(0), stepwise.position(0));
  EXPECT_EQ(both.direction(0), stepwise.direction(0));
  EXPECT_TRUE(same_bits(both, 1, alone));
}

// What a scene does not need is left out, and the rest has the same bits: OPL where there is no column for it, aperture tests
// where there are no semi-diameters.
TEST(Trace, without_opl_and_apertures_the_rest_has_the_same_bits) {
  Uniform u(18);
  for (int i = 0; i < 20; ++i) {
    CompiledScene compiled = checked(scene::compile(random_model(u)));
    const RayBatch start = batch_of(random_rays(u, 600));
    RayBatch with = start, without = start;
    without.opl.clear();
    trace::trace(compiled.scene, compiled.wavelength(), with);
    trace::trace(compiled.scene, compiled.wavelength(), without);
    EXPECT_TRUE(without.opl.empty());
    without.opl = with.opl;
    EXPECT_TRUE(same_bits(with, 0, without));

    for (auto& surface : compiled.scene.surfaces) surface.semi_diameter = std::numeric_limits<double>::infinity(), surface.inner_semi_diameter = 0;
    RayBatch open = start, wide = start;
    if (has_dummy(compiled)) continue;  // with a semi-diameter it is none
    trace::trace(compiled.scene, compiled.wavelength(), open);
    for (auto& surface : compiled.scene.surfaces) surface.semi_diameter = 1e150;
    trace::trace(compiled.scene, compiled.wavelength(), wide);
    EXPECT_TRUE(same_bits(open, 0, wide));
  }
}

// A shape is compiled to the least one that is the same surface.
TEST(Trace, shapes_are_in_their_least_form) {
  const CompiledScene compiled = scene_of(
      "  - {stop: true, conic: {radius_mm: .inf, conic_constant: -3}, thickness_mm: 1, medium: {index: 1.5}}\n"
      "  - {conic: {radius_mm: 20}, thickness_mm: 1}\n"
      "  - {conic: {radius_mm: 20, conic_constant: -1}, thickness_mm: 1, medium: {index: 1.5}}\n"
      "  - {zernike: {radius_mm: 20, normalization_radius_mm: 3, indexing: osa, coefficients_um: {4: 0, 12: 0}}, thickness_mm: 1}\n"
      "  - {zernike: {normalization_radius_mm: 3, indexing: osa, coefficients_um: {4: 0}}, thickness_mm: 1, medium: {index: 1.5}}\n"
      "  - {zernike: {normalization_radius_mm: 3, indexing: osa, coefficients_um: {4: 1e-3, 12: 0}}, thickness_mm: 1}\n"
      "  - {}\n");
  const auto is = [&]<class Shape>(int number, Shape) { return std::holds_alternative<Shape>(compiled.scene.surface(number).shape); };
  EXPECT_TRUE(is(1, surface::Plane{}));
  EXPECT_TRUE(is(2, surface::Sphere{}));
  EXPECT_TRUE(is(3, surface::Conic{}));
  EXPECT_TRUE(is(4, surface::Sphere{}));
  EXPECT_TRUE(is(5, surface::Plane{}));
  EXPECT_TRUE(is(6, surface::Zernike{}));
  EXPECT_EQ(std::get<surface::Zernike>(compiled.scene.surface(6).shape).polynomial.degree, 2);  // the highest term is zero
}

TEST(Trace, an_empty_batch_is_fine) {
  const CompiledScene compiled = scene_of("  - {stop: true, thickness_mm: 1}\n  - {}\n");
  RayBatch none;
  trace::trace(compiled.scene, compiled.wavelength(), none, 4);
  EXPECT_EQ(none.size(), 0u);
  EXPECT_EQ(count_statuses(none).total(), 0);
}

// Apertures on each of three surfaces (stop, refracting, image), of each shape: inside, in the obscuration, on its rim, on
// the outer rim, beyond it. Numbers are exact in binary, and rays parallel to the axis keep their height in a plate and on
// flat-on-axis shapes with equal indices.
TEST(Trace, apertures_clip_on_every_surface_and_shape) {
  const std::vector<std::string> shapes{"plane: {}", "conic: {radius_mm: 64}",
                                        "zernike: {radius_mm: 64, normalization_radius_mm: 4, indexing: osa, coefficients_um: {4: 1}}"};
  const double heights[] = {0, 0.4375, 0.5, 1, 2, 2.0625};
  const Status expected[] = {Status::clipped, Status::clipped, Status::ok, Status::ok, Status::ok, Status::clipped};
  int count = 0;
  for (const std::string& shape : shapes)
    for (int clipping = 1; clipping <= 3; ++clipping) {
      std::string surfaces;
      for (int number = 1; number <= 3; ++number)
        surfaces += "  - {" + shape + (number == 1 ? ", stop: true" : "") + (number < 3 ? ", thickness_mm: 4" : "") +
                    (number == clipping ? ", semi_diameter_mm: 2, inner_semi_diameter_mm: 0.5" : "") + "}\n";
      const CompiledScene compiled = scene_of(surfaces);
      std::vector<GlobalRay> rays;
      for (const double height : heights) rays.push_back({{0, -height, -1}, {0, 0, 1}});
      RayBatch batch = batch_of(rays);
      trace::trace(compiled.scene, compiled.wavelength(), batch);
      for (std::size_t i = 0; i < rays.size(); ++i, ++count) {
        EXPECT_EQ(batch.status(i), expected[i]) << shape << " on " << clipping << ", height " << heights[i];
        EXPECT_EQ(batch.ended_at(i), expected[i] == Status::ok ? 0 : clipping);
        const GlobalRay end = global_ray(compiled.scene, batch, i);
        const double sag = std::visit([&](const auto& one) { return one.sag(0.0, -heights[i]); }, compiled.scene.surface(1).shape);
        EXPECT_NEAR(end.p.z, sag + 4 * (frame_of(compiled.scene, batch, i) - 1), 1e-14);  // the hit that was clipped
        EXPECT_EQ(end.d, (Vec3<double>{0, 0, 1}));
        EXPECT_NEAR(batch.opl[i], end.p.z + 1, 1e-14);
      }
    }
  EXPECT_EQ(count, 54);
}

TEST(Trace, a_clipped_ray_keeps_the_hit_and_the_incident_direction) {
  const CompiledScene compiled = scene_of("  - {stop: true, conic: {radius_mm: 10}, thickness_mm: 5, medium: {index: 1.5}, semi_diameter_mm: 1}\n"
                                          "  - {conic: {radius_mm: -7}, thickness_mm: 5}\n  - {}\n");
  RayBatch batch = batch_of({{{0, 6, -4}, {0, 0, 1}}});
  trace::trace(compiled.scene, compiled.wavelength(), batch);
  EXPECT_EQ(batch.status(0), Status::clipped);
  EXPECT_EQ(batch.ended_at(0), 1);
  const GlobalRay end = global_ray(compiled.scene, batch, 0);
  EXPECT_EQ(end.p.y, 6);
  EXPECT_NEAR(end.p.z, 2, 4e-15);  // 10 - sqrt(100 - 36)
  EXPECT_EQ(end.d, (Vec3<double>{0, 0, 1}));
  EXPECT_NEAR(batch.opl[0], 6, 4e-15);
}

// A ray that meets no surface keeps its last good state, in global coordinates, whatever frame it ended in and whatever
// comes behind.
TEST(Trace, a_missed_ray_keeps_its_last_good_state) {
  const CompiledScene compiled = scene_of("  - {stop: true, thickness_mm: 5, medium: {index: 1.5}}\n"
                                          "  - {conic: {radius_mm: 3}, thickness_mm: 5, decenter_mm: [0.5, -1, 0.25], tilt_deg: [20, -10, 33]}\n"
                                          "  - {conic: {radius_mm: -30}, thickness_mm: 5, tilt_deg: [1, 2, 3]}\n  - {}\n");
  RayBatch batch = batch_of({{{0, 8, -4}, {0, 0, 1}}, {{0.25, -1, -4}, {0, 0, 1}}});
  trace::trace(compiled.scene, compiled.wavelength(), batch);
  EXPECT_EQ(batch.status(0), Status::missed);
  EXPECT_EQ(batch.ended_at(0), 2);
  const GlobalRay end = global_ray(compiled.scene, batch, 0);
  EXPECT_LE(norm(end.p - Vec3<double>{0, 8, 0}), 1e-14);
  EXPECT_LE(norm(end.d - Vec3<double>{0, 0, 1}), 1e-15);
  EXPECT_EQ(batch.opl[0], 4);
  EXPECT_EQ(batch.ended[1], 0);
}

TEST(Trace, a_totally_reflected_ray_keeps_the_hit_and_the_incident_direction) {
  // 45 degrees inside glass; the surface is tilted, and moved up by 1
  const CompiledScene compiled = scene_of("  - {stop: true, thickness_mm: 5, medium: {index: 1.5}}\n"
                                          "  - {thickness_mm: 5, tilt_deg: [45, 0, 0], decenter_mm: [0, 1, 0]}\n  - {}\n");
  RayBatch batch = batch_of({{{2, 3, -4}, {0, 0, 1}}});
  trace::trace(compiled.scene, compiled.wavelength(), batch);
  EXPECT_EQ(batch.status(0), Status::total_reflection);
  EXPECT_EQ(batch.ended_at(0), 2);
  const GlobalRay end = global_ray(compiled.scene, batch, 0);
  // a positive tilt about x turns +y toward +z: at y = 3, 2 above the turned plane's vertex, z = 5 + 2
  EXPECT_LE(norm(end.p - Vec3<double>{2, 3, 7}), 1e-14);
  EXPECT_LE(norm(end.d - Vec3<double>{0, 0, 1}), 1e-15);
  EXPECT_NEAR(batch.opl[0], 4 + 1.5 * 7, 1e-14);
}

TEST(Trace, the_image_surface_ends_rays_undeflected_whatever_its_medium) {
  for (const std::string medium : {"{index: 1.7}", "air"}) {
    const CompiledScene compiled = scene_of("  - {stop: true, thickness_mm: 5, medium: {index: 1.5}}\n  - {conic: {radius_mm: -20}, medium: " + medium + "}\n");
    const Vec3<double> d = numerics::normalized(Vec3<double>{0.1, 0.2, 1});
    RayBatch batch = batch_of({{{0, 1, -4}, d}});
    trace::trace(compiled.scene, compiled.wavelength(), batch);
    EXPECT_EQ(batch.ended[0], 0);
    EXPECT_NEAR(batch.m[0], d.y / 1.5, 1e-15) << medium;  // Snell at the plane only
    EXPECT_GT(batch.n[0], 0) << medium;
  }
}

// The reader refuses a mirror there; a scene made otherwise must not deflect either (a mutant that refracts or reflects).
TEST(Trace, the_image_surface_of_a_scene_does_not_deflect_even_if_it_is_a_mirror) {
  const CompiledScene compiled = scene_of("  - {stop: true, thickness_mm: 5, medium: {index: 1.5}}\n  - {conic: {radius_mm: -20}}\n");
  scene::Scene scene = compiled.scene;
  scene.surfaces.back().mirror = true;
  scene::Wavelength wavelength = compiled.wavelength();
  wavelength.index.back() = 1.7;
  const Vec3<double> d = numerics::normalized(Vec3<double>{0.1, 0.2, 1});
  RayBatch batch = batch_of({{{0, 1, -4}, d}});
  trace::trace(scene, wavelength, batch);
  EXPECT_EQ(batch.ended[0], 0);
  EXPECT_NEAR(batch.m[0], d.y / 1.5, 1e-15);
  EXPECT_GT(batch.n[0], 0);
}

// The path to the image surface counts in the medium before it.
TEST(Trace, paths_count_in_the_medium_before_the_surface) {
  const CompiledScene compiled = scene_of("  - {stop: true, thickness_mm: 5, medium: {index: 1.5}}\n  - {thickness_mm: 7, medium: {index: 1.25}}\n  - {}\n",
                                          "entrance_pupil_diameter_mm: 4", "object: {medium: {index: 2}}\n");
  RayBatch batch = batch_of({{{0, 0, -4}, {0, 0, 1}}});
  trace::trace(compiled.scene, compiled.wavelength(), batch);
  EXPECT_NEAR(batch.opl[0], 2 * 4 + 1.5 * 5 + 1.25 * 7, 1e-14);
}

TEST(Trace, counts_tell_status_and_surface) {
  RayBatch rays(6);
  rays.ended = {0, trace::ending(3, Status::missed), 0, trace::ending(3, Status::clipped), trace::ending(12, Status::missed), trace::ending(3, Status::missed)};
  const trace::StatusCounts counts = count_statuses(rays);
  EXPECT_EQ(counts.total(), 6);
  EXPECT_EQ(counts[Status::ok], 2);
  EXPECT_EQ(counts[Status::missed], 3);
  EXPECT_EQ(counts[Status::clipped], 1);
  EXPECT_EQ(counts.endings.size(), 3u);
  EXPECT_EQ(counts.endings.at(trace::ending(3, Status::missed)), 2);
}

}  // namespace
}  // namespace sagitta::test
