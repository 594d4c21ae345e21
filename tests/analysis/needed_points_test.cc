// SPDX-License-Identifier: Apache-2.0
// Systems compiled with what their rays need of the point clouds, against the same with all points: every result has the
// same bits.
#include <cmath>
#include <tuple>

#include "lib/analysis/job.h"
#include "tests/support/point_sets.h"
#include "tests/support/prescriptions.h"

namespace sagitta::test {
namespace {

using namespace sagitta::tests;
using prescription::Model;
using surface::Status;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// A cornea with bumps.
double bumpy(double x, double y) { return sphere(15)(x, y) + 2e-3 * std::sin(3 * x) * std::cos(2 * y); }

prescription::Shape shape_of(PointCloud cloud, const std::string& interpolation) {
  prescription::Shape shape;
  shape.kind = "delaunay";
  shape.parameters.numbers = {{"rings", 2}, {"shape_mm", interpolation == "multiquadric" ? 0.2 : 0}, {"smoothing_um", 0},
                              {"max_edge_mm", std::numeric_limits<double>::infinity()}};
  shape.parameters.texts = {{"interpolation", interpolation}};
  shape.cloud = std::make_shared<PointCloud>(std::move(cloud));
  return shape;
}

// One surface of points behind a plane stop, and a focal plane.
Model model_of(prescription::Shape shape, double pupil_diameter = 1.2) {
  Model model;
  model.wavelengths_nm = {550};
  model.aperture.value = pupil_diameter;
  model.surfaces = {surface_of({}, 2, 1), surface_of(std::move(shape), 40, 1.5), surface_of({}, 0, 1)};
  model.surfaces[0].stop = true;
  return model;
}

void append(std::string& bytes, const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); }
template <class T>
void append_all(std::string& bytes, const std::vector<T>& values) {
  for (const T& value : values) append(bytes, value);
}

// Everything that tables, pictures and EXR files are made of.
std::string bytes_of(const std::vector<analysis::JobResult>& results) {
  std::string bytes;
  for (const auto& result : results) {
    append(bytes, result.rays.of);
    for (const auto& [ended, count] : result.rays.endings) append(bytes, ended), append(bytes, count);
    for (const auto& one : result.coverage) append(bytes, one.share);
    const auto& spot = *result.spot;
    for (const double value : {spot.centroid_x, spot.centroid_y, spot.rms_radius, spot.geometric_radius}) append(bytes, value);
    append(bytes, result.spot_image->pixel_mm);
    append_all(bytes, result.spot_image->counts);
    bytes += result.wavefront->reason;
    if (!result.wavefront->wavefront) continue;
    const auto& wavefront = *result.wavefront->wavefront;
    append_all(bytes, wavefront.opd_waves);
    append_all(bytes, wavefront.mask);
    for (const double value : {wavefront.reference_radius, wavefront.rms_waves, wavefront.peak_to_valley_waves}) append(bytes, value);
    if (wavefront.zernike) append_all(bytes, wavefront.zernike->coefficients);
  }
  return bytes;
}

// Runs the job on all points and on those that it needs; returns the parts.
std::vector<scene::CloudPart> compare(const Model& model, const std::string& name) {
  const auto whole = scene::compile(model), part = scene::compile(model, analysis::beam_of_job());
  EXPECT_TRUE(whole.scene && part.scene) << name;
  if (!whole.scene || !part.scene) return {};
  EXPECT_TRUE(whole.parts.empty());
  analysis::JobRequest request;
  request.ray_count = 3000;
  const std::string wanted = bytes_of(run_job(*whole.scene, request));
  EXPECT_EQ(bytes_of(run_job(*part.scene, request)) == wanted, true) << name;
  EXPECT_GT(wanted.size(), 1000u);
  return part.parts;
}

TEST(NeededPoints, ResultsHaveTheSameBitsOnEveryLayout) {
  int parts = 0, systems = 0;
  // (radial functions of 10,000 points take seconds)
  for (const auto& [interpolation, count, pupil] : {std::tuple("c1", 10000, 0.8), {"linear", 10000, 0.8}, {"thin_plate", 3000, 0.2}})
    for (const Layout& layout : all_layouts(count)) {
      const auto found = compare(model_of(shape_of(cloud_of(layout.places, bumpy), interpolation), pupil), layout.name + " " + interpolation);
      ++systems;
      parts += !found.empty();
      for (const auto& part : found) {
        EXPECT_EQ(part.surface, 2);
        EXPECT_EQ(part.points, layout.places.size());
        EXPECT_LT(part.used, part.points / 2);
      }
      if (layout.name == "regular" || layout.name == "uniform random") {
        ASSERT_EQ(found.size(), 1u) << layout.name;
        EXPECT_LT(found[0].used, 1500u) << layout.name;
      }
    }
  EXPECT_EQ(systems, 18);
  EXPECT_GE(parts, 12);
}

TEST(NeededPoints, ResultsHaveTheSameBitsForTheOtherRadialFunctions) {
  for (const std::string interpolation : {"cubic", "multiquadric"})
    EXPECT_EQ(compare(model_of(shape_of(cloud_of(uniform_random(5000, 5, 3), bumpy), interpolation), 0.5), interpolation).size(), 1u);
  Model of_mean_edges = model_of(shape_of(cloud_of(uniform_random(3000, 5, 3), bumpy), "multiquadric"), 0.3);
  of_mean_edges.surfaces[1].shape.parameters.numbers["shape_mm"] = 0;
  EXPECT_TRUE(compare(of_mean_edges, "shape from the whole mesh").empty());
}

TEST(NeededPoints, ResultsHaveTheSameBitsForTiltsFieldsWavelengthsAndCloudsInARow) {
  Uniform u(17);
  int parts = 0;
  for (int k = 0; k < 12; ++k) {
    const auto cloud = [&] { return cloud_of(uniform_random(20000, 6, static_cast<std::uint64_t>(k) + 20), bumpy); };
    Model model = model_of(shape_of(cloud(), k % 2 == 0 ? "c1" : "linear"), 1);
    model.wavelengths_nm = {550, 600};
    model.fields.points = {{0, 0}, {u(-12, 12), u(-12, 12)}};
    model.surfaces[1].decenter_mm = {u(-1, 1), u(-1, 1), 0};
    model.surfaces[1].tilt_deg = {u(-25, 25), u(-25, 25), u(-180, 180)};
    model.surfaces[1].thickness_mm = 3;
    model.surfaces.insert(model.surfaces.begin() + 2, surface_of(shape_of(cloud(), "c1"), 30, 1.3));
    model.surfaces[2].tilt_deg = {u(-10, 10), u(-10, 10), 0};
    parts += static_cast<int>(compare(model, std::to_string(k)).size());
  }
  EXPECT_GE(parts, 20);  // of 24
}

TEST(NeededPoints, ATiltedBeamIsFollowedThroughTheDepthOfTheData) {
  // It comes to the surface 0.9 mm beside where it passes the height of the lowest point: farther than a part reaches beyond its
  // footprint.
  Model model = model_of(shape_of(cloud_of(uniform_random(150000, 8, 12), sphere(12)), "linear"), 0.4);
  model.surfaces[0].thickness_mm = 0;
  model.surfaces[1].decenter_mm = {5, 0, 0};
  model.fields.points = {{50, 0}};
  EXPECT_EQ(compare(model, "deep").size(), 1u);
}

TEST(NeededPoints, AHoleInTheBeamOrABeamOverTheEdgeWantsAllPoints) {
  for (const std::string interpolation : {"c1", "linear"}) {
    PointCloud holed = cloud_of(uniform_random(10000, 5, 4), bumpy);
    for (auto& p : holed.points)
      if (std::hypot(p.x - 0.1, p.y) < 0.1) p.z = nan;
    EXPECT_TRUE(compare(model_of(shape_of(holed, interpolation)), "hole").empty());
    Model over_edge = model_of(shape_of(cloud_of(uniform_random(10000, 5, 4), bumpy), interpolation));
    over_edge.surfaces[1].decenter_mm = {4.8, 0, 0};
    EXPECT_TRUE(compare(over_edge, "edge").empty());
    // a hole beside the beam is none of its business
    for (auto& p : holed.points)
      if (std::hypot(p.x - 3, p.y) < 0.2) p.z = nan;
    for (auto& p : holed.points)
      if (std::isnan(p.z) && p.x < 1) p.z = bumpy(p.x, p.y);
    EXPECT_EQ(compare(model_of(shape_of(holed, interpolation)), "hole beside the beam").size(), 1u);
  }
}

TEST(NeededPoints, NoPartIsTakenWhereALineCouldMeetTheDataTwice) {
  // Steep ripples and a beam at 40 degrees: it may cross a facet from behind.
  const auto rippled = [](double x, double y) { return 0.3 * std::sin(8 * x) + 0 * y; };
  Model model = model_of(shape_of(cloud_of(uniform_random(20000, 6, 8), rippled), "linear"), 0.4);
  model.fields.points = {{40, 0}};
  model.surfaces[0].thickness_mm = 0;
  EXPECT_TRUE(compare(model, "ripples").empty());
}

// Given rays, each bit for bit.
bool have_same_bits(const Model& model, const std::vector<GlobalRay>& rays, std::size_t wanted_parts) {
  const trace::RaySource source = [&](const scene::Scene&, const auto& take) { take({batch_of(rays)}); };
  const auto whole = scene::compile(model), part = scene::compile(model, trace::beam_of(source));
  EXPECT_EQ(part.parts.size(), wanted_parts);
  if (!whole.scene || !part.scene) return false;
  const auto bytes = [&](const scene::Scene& scene) {
    trace::RayBatch batch = batch_of(rays);
    trace::trace(scene, scene.primary, batch);
    std::string result;
    for (const auto* column : {&batch.x, &batch.y, &batch.z, &batch.l, &batch.m, &batch.n, &batch.opl}) append_all(result, *column);
    append_all(result, batch.ended);
    return result;
  };
  return bytes(*whole.scene) == bytes(*part.scene);
}

TEST(NeededPoints, RaysThroughNodesAndEdgesOfARegularGridHaveTheSameBits) {
  for (const std::string interpolation : {"linear", "c1"}) {
    const Model model = model_of(shape_of(cloud_of(regular_grid(129, 129, 8, 8), bumpy), interpolation));
    std::vector<GlobalRay> rays;
    for (int i = -4; i <= 4; ++i)
      for (int j = -4; j <= 4; ++j) rays.push_back({{i / 16.0, j / 16.0, -1}, {0, 0, 1}});  // nodes (8ths), edges and diagonals
    EXPECT_TRUE(have_same_bits(model, rays, 1)) << interpolation;
  }
}

TEST(NeededPoints, SingleRaysAndRaysFarApart) {
  const Model model = model_of(shape_of(cloud_of(uniform_random(20000, 6, 9), bumpy), "c1"));
  Uniform u(31);
  for (int k = 0; k < 20; ++k) {
    const Vec3<double> d = numerics::normalized(Vec3<double>{u(-0.3, 0.3), u(-0.3, 0.3), 1});
    EXPECT_TRUE(have_same_bits(model, {{{u(-3, 3), u(-3, 3), 0}, d}}, 1));
  }
  EXPECT_TRUE(have_same_bits(model, {{{-5, -5, 0}, {0, 0, 1}}, {{5, 5, 0}, {0, 0, 1}}}, 0));
  EXPECT_TRUE(have_same_bits(model, {{{0, 0, 0}, {0, 0, 1}}, {{0, 0, 0}, {0.8, 0.6, 1e-9}}}, 0));  // along the surface
  EXPECT_TRUE(have_same_bits(model, {{{0, 0, 0}, {0, 0, 1}}, {{40, 0, 0}, {0, 0, 1}}}, 0));  // beside the data
}

TEST(NeededPoints, AnApertureDoesNotHideRaysFromTheSurfacesBehindIt) {
  Model model = model_of(shape_of(cloud_of(uniform_random(20000, 6, 10), bumpy), "c1"), 2);
  model.surfaces[0].semi_diameter_mm = 0.43;
  model.surfaces[0].inner_semi_diameter_mm = 0.41;
  EXPECT_EQ(compare(model, "ring").size(), 1u);
}

TEST(NeededPoints, WhatIsWrongInTheCloudIsToldAsWithAllPoints) {
  PointCloud cloud = cloud_of(uniform_random(10000, 5, 4), bumpy);
  cloud.points.push_back({cloud.points[0].x, cloud.points[0].y, 1});
  const Model far = model_of(shape_of(cloud, "c1"), 0.5);
  ASSERT_GT(std::hypot(cloud.points[0].x, cloud.points[0].y), 2);
  EXPECT_FALSE(scene::compile(far).scene);
  EXPECT_TRUE(scene::compile(far, analysis::beam_of_job()).scene);  // not needed, not looked at
  cloud.points.back() = {0.01, 0.01, 0};
  cloud.points.push_back({0.01, 0.01, 1});
  const auto near = scene::compile(model_of(shape_of(cloud, "c1"), 0.5), analysis::beam_of_job());
  EXPECT_FALSE(near.scene);
  EXPECT_EQ(near.findings.error_count(), 1);
}

}  // namespace
}  // namespace sagitta::test
