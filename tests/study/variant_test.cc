// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "lib/study/newton.h"
#include "tests/study/subjects.h"

namespace sagitta::test {
namespace {

using study::ArrangementKind;
using study::Row;
using study::Variant;

Variant linear(double density, ArrangementKind kind = ArrangementKind::regular) {
  Variant variant;
  variant.arrangement = {kind, density};
  variant.rays = 4000;
  variant.pattern = {trace::PatternKind::random, 2};
  return variant;
}

// A grid of spacing h on a surface of curvature k is off by k h^2/6 in sag and k h (sqrt 2 + asinh 1)/6 in slope, in the mean over a cell
// (tests/surface/lens_slow_test.cc). k grows from 1/R to 1/R (1 - (12.5/R)^2)^(-3/2) at the rim, by 2 % in the mean; a slope s turns an axial
// ray by (1 - 1/n) s, less a percent at the rim. 4000 rays of standard deviation half the mean: five standard errors are 4 %.
TEST(Measured, LensOfFlatFacetsIsOffAsDerived) {
  study::Subject subject(paper_lens(), 1);
  const Row row = row_of(subject, linear(16));
  const double h = .25, k = 1 / 65.77, n = 1.64134164;
  EXPECT_NEAR(row.surface.distance_um.mean / (1e3 * k * h * h / 6), 1.02, .05);
  EXPECT_NEAR(row.surface.angle_arcmin.mean / (3437.75 * (1 - 1 / n) * k * h * (std::sqrt(2.0) + std::asinh(1.0)) / 6), 1, .05);
  EXPECT_EQ(row.surface.found.by_both, 4000);
  EXPECT_EQ(row.spot.found.by_both, 4000);
  EXPECT_GT(row.spot.rms_radius_percent, 50);  // slopes of h/sqrt 6 k in focus, against a spot of 43 um
  EXPECT_GT(row.wavefront_rms_waves, .1);
  EXPECT_LT(row.wavefront_rms_without_tilt_waves, .2);
}

TEST(Measured, RowSaysWhatItIsOf) {
  study::Subject subject(paper_lens(), 1);
  EXPECT_NEAR(subject.beam_radius(), 12.5, 1e-12);
  for (const auto kind : {ArrangementKind::regular, ArrangementKind::jittered, ArrangementKind::random, ArrangementKind::rings}) {
    const Row row = row_of(subject, linear(4, kind));
    EXPECT_EQ(row.points, static_cast<std::int64_t>(subject.cloud_of(linear(4, kind)).points.size()));
    EXPECT_NEAR(row.points_per_mm2, 4, .2) << name_of(kind);
    EXPECT_GT(row.cloud_radius_mm, 12.5 + 1);
    EXPECT_GT(row.triangles, 1.8 * static_cast<double>(row.points));  // 2 for every point but those of the hull
    EXPECT_LT(row.triangles, 2 * row.points);
    EXPECT_EQ(row.surface.found.by_one_only(), 0) << name_of(kind);
    EXPECT_EQ(row.rays, 4000);
    EXPECT_EQ(row.compared, 4000);
    for (const study::Spread& spread : {row.prepare_s, row.prepare_wall_s, row.ns_per_ray, row.wall_ns_per_ray}) {
      EXPECT_GE(spread.runs, 3);
      EXPECT_TRUE(0 < spread.least && spread.least <= spread.median && spread.median <= spread.most);
    }
    EXPECT_LT(row.ns_per_ray.median, 1e5);
  }
}

TEST(Measured, SurfaceAsPrescribedIsOffByRoundingAlone) {
  study::Subject subject(paper_lens(10), 1);
  Variant variant = linear(0);
  variant.interpolation = Variant::as_prescribed;
  const Row row = row_of(subject, variant);
  EXPECT_LT(row.surface.distance_um.max, 1e3 * 40 * 2.2e-16 * 30);
  EXPECT_LT(row.surface.angle_arcmin.max, 3437.75 * 40 * 2.2e-16 * 2);
  EXPECT_GT(row.surface.distance_um.max, 0);  // as nothing that is compared with itself
  EXPECT_EQ(row.wavefront_rms_waves, 0);
  EXPECT_EQ(row.points, 0);
  variant.most_compared = 300;
  EXPECT_EQ(row_of(subject, variant).compared, 300);
  EXPECT_EQ(row_of(subject, variant).rays, 4000);
}

TEST(Measured, ErrorsAreTheSameFromTheKeptTruthAndOnTwoThreads) {
  study::Subject subject(paper_lens(), 1);
  Variant other = linear(4);
  other.pattern = {};
  Variant threaded = linear(9);
  threaded.threads = 2;
  const Row first = row_of(subject, linear(9));
  row_of(subject, other);  // another truth in between
  const Row again = row_of(subject, linear(9)), kept = row_of(subject, linear(9)), two = row_of(subject, threaded);
  for (const Row& row : {again, kept, two}) {
    EXPECT_EQ(row.surface.distance_um.mean, first.surface.distance_um.mean);
    EXPECT_EQ(row.surface.angle_arcmin.rms, first.surface.angle_arcmin.rms);
    EXPECT_EQ(row.spot.rms_radius_um, first.spot.rms_radius_um);
    EXPECT_EQ(row.wavefront_rms_waves, first.wavefront_rms_waves);
  }
}

// Against itself a rough surface of long waves is only as far off as a smooth one; against the clean one the roughness is the error.
TEST(Measured, RoughnessCountsAgainstTheCleanSurface) {
  study::Subject subject(paper_lens(), 1);
  Variant noisy = linear(16);
  noisy.rays = 1000;
  noisy.noise = {2, 4000};
  Variant against_clean = noisy;
  against_clean.is_against_clean = true;
  const Row smooth = row_of(subject, linear(16)), rough = row_of(subject, noisy), clean = row_of(subject, against_clean);
  // The roughness adds a curvature of sqrt(12) s/l^2 = 4.3e-4/mm rms along a line to 1/65.77 = 1.52e-2/mm, in quadrature .1 %; 1000 rays: 8 %.
  EXPECT_NEAR(rough.surface.distance_um.mean / smooth.surface.distance_um.mean, 1, .1);
  // 30 independent patches in the pupil: an rms of 2 um to a tenth, three times.
  EXPECT_NEAR(clean.surface.distance_um.rms, 2, .6);
  EXPECT_TRUE(std::isnan(rough.wavefront_rms_waves));
  EXPECT_GT(clean.wavefront_rms_waves, 0);
  noisy.rays = 500;
  EXPECT_EQ(row_of(subject, noisy).surface.found.by_both, 500);
  noisy.seed = 2;
  const Row other_seed = row_of(subject, noisy);
  EXPECT_NE(other_seed.surface.distance_um.mean, rough.surface.distance_um.mean);
  EXPECT_NEAR(other_seed.surface.distance_um.mean / smooth.surface.distance_um.mean, 1, .15);  // against its own surface; 500 rays
}

// Truths and rough points that a subject keeps, or has beforehand, are those that it would make: variants that share some of them, in an order in which
// each comes again after others.
TEST(Measured, WhatASubjectKeepsIsWhatItWouldMake) {
  std::vector<Variant> variants;
  for (const std::uint64_t seed : {1, 2})
    for (const double length : {1000.0, 4000.0})
      for (const double density : {4.0, 9.0})
        for (const bool is_against_clean : {false, true}) {
          Variant variant = linear(density);
          variant.rays = 300;
          variant.noise = {2, length};
          variant.is_against_clean = is_against_clean;
          variant.seed = seed;
          variant.prepare_repeats = 1;
          variants.push_back(variant);
        }
  for (const std::uint64_t seed : {1, 2}) {  // nothing but the seed changes
    Variant variant = variants.back();
    variant.is_against_clean = false;
    variant.seed = seed;
    variants.push_back(variant);
  }
  Variant clean = linear(4);
  clean.rays = 300;
  variants.push_back(clean);
  variants.push_back(variants.front());
  clean.interpolation = Variant::as_prescribed;
  clean.noise = {2, 1000};  // no points, but a rough truth
  variants.push_back(clean);

  study::Subject keeping(paper_lens(), 1), knowing(paper_lens(), 1);
  for (const Variant& variant : variants) {
    study::Subject fresh(paper_lens(), 1);
    const Row expected = row_of(fresh, variant), kept = row_of(keeping, variant);
    knowing.know_truth(variant, 2);
    knowing.know_rough_cloud(variant, 2);
    const Row known = row_of(knowing, variant);
    for (const Row& row : {kept, known}) {
      EXPECT_EQ(row.points, expected.points);
      EXPECT_EQ(row.surface.distance_um.mean, expected.surface.distance_um.mean);
      EXPECT_EQ(row.surface.angle_arcmin.rms, expected.surface.angle_arcmin.rms);
      EXPECT_EQ(row.spot.true_rms_radius_um, expected.spot.true_rms_radius_um);
    }
    EXPECT_EQ(knowing.cloud_of(variant).points.size(), static_cast<std::size_t>(expected.points));
  }
}

TEST(Measured, PreparationIsRepeatedAsOftenAsAskedFor) {
  study::Subject subject(paper_lens(), 1);
  Variant variant = linear(400);  // some .2 s: longer than what is repeated anyway
  variant.rays = 100;
  for (const int repeats : {1, 2, 3}) {
    variant.prepare_repeats = repeats;
    EXPECT_EQ(row_of(subject, variant).prepare_s.runs, repeats);
  }
}

// The stop behind the surface: its image, the entrance pupil, depends on the curvature at the vertex, and a rough cloud has another one. Launched
// by that, rays would come to places some 1e-3 of 12 mm away.
TEST(Measured, BothSidesAreLaunchedByTheSystemAsPrescribed) {
  auto model = paper_lens();
  model.surfaces.front().stop = false;
  model.surfaces.front().thickness_mm = 20;
  model.surfaces.insert(model.surfaces.begin() + 1, surface_of({}, 140, 1.64134164));
  model.surfaces[1].stop = true;
  model.aperture.kind = prescription::ApertureKind::stop_diameter_mm;
  study::Subject subject(model, 1);
  Variant noisy = linear(16);
  noisy.rays = 1000;
  const Row smooth = row_of(subject, noisy);
  noisy.noise = {2, 4000};
  EXPECT_NEAR(row_of(subject, noisy).surface.distance_um.mean / smooth.surface.distance_um.mean, 1, .1);
  noisy.is_against_clean = true;
  // To the sphere through the same exit pupil: the wavefront is off by (n - 1) times the roughness, with its tilt left out at most so.
  EXPECT_LT(row_of(subject, noisy).wavefront_rms_without_tilt_waves, 1.5 * .64 * 2 / .855);
}

TEST(Measured, NearestVertexLosesRaysOfRandomPoints) {
  study::Subject subject(paper_lens(), 1);
  Variant variant = linear(4, ArrangementKind::random);
  const Row walk = row_of(subject, variant);
  variant.search = study::Search::nearest_vertex;
  const Row nearest = row_of(subject, variant);
  EXPECT_EQ(walk.surface.found.by_one_only(), 0);
  // 4.8 % of 4000 in one cloud of 2500 points, whose cells differ: five standard errors of 190 rays.
  EXPECT_NEAR(static_cast<double>(nearest.surface.found.by_truth_only), .048 * 4000, 70);
  EXPECT_NEAR(nearest.surface.angle_arcmin.mean / walk.surface.angle_arcmin.mean, 1, .05);  // of the others the facets are the same
  EXPECT_GT(nearest.ns_per_ray.median, 10 * walk.ns_per_ray.median);
  EXPECT_TRUE(std::isnan(nearest.wavefront_rms_waves));
}

TEST(Measured, ToleranceBoundsTheErrorOfNewtonsMethod) {
  study::Subject subject(system_of({surface_of(zernike_shape(9, -.4, 4, {{6, 3}, {12, 5}}), 25, 1.5)}, 6, {8}), 1);
  double looks = 0;
  for (const double tolerance : {1e-2, 1e-4, 1e-8, 1e-12}) {
    Variant variant = linear(0);
    variant.interpolation = Variant::as_prescribed;
    variant.tolerance_mm = tolerance;
    const Row row = row_of(subject, variant);
    // |f| <= tolerance at the hit that is returned, and f falls along the ray at cos 8 degrees less the slope, .7 at least; beside rounding.
    EXPECT_LE(row.surface.distance_um.max, 1e3 * (tolerance / .6 + 1e-14)) << tolerance;
    EXPECT_GE(row.looks_per_ray, looks);
    looks = row.looks_per_ray;
  }
  EXPECT_GT(looks, 2);
  EXPECT_LT(looks, 6);
}

TEST(Newton, SaysWhereItDoesNotArrive) {
  const surface::Conic sphere{.1, 0};
  EXPECT_EQ(study::meet_to_tolerance(sphere, Vec3<double>{12, 0, -1}, {0, 0, 1}, 1e-9).crossing.status, surface::Status::missed);
  EXPECT_EQ(study::meet_to_tolerance(sphere, Vec3<double>{12, 0, -1}, {1, 0, 0}, 1e-9).crossing.status, surface::Status::missed);
  // |f| <= 0 is not reached where rounding leaves an ulp: the looks end, and say so. The sag of r = 3, c = 1/4, K = -2 is 1 exactly: reached.
  const auto reached = study::meet_to_tolerance(surface::Conic{.25, -2}, Vec3<double>{3, 0, -1}, {0, 0, 1}, 0);
  EXPECT_EQ(reached.crossing.status, surface::Status::ok);
  EXPECT_EQ(reached.crossing.path, 2);
  EXPECT_EQ(study::meet_to_tolerance(surface::Conic{.25, -2}, Vec3<double>{3, 0, -1}, {0, 0, 1}, NAN).crossing.status, surface::Status::not_converged);
}

TEST(Measured, SaysWhyThereIsNoRow) {
  study::Subject subject(paper_lens(), 1);
  Variant variant = linear(4);
  variant.interpolation = "c1";
  variant.search = study::Search::nearest_vertex;
  EXPECT_EQ(subject.measure(variant).reason, "the nearest vertex is looked for on linear facets only");
  variant = linear(4);
  variant.tolerance_mm = 1e-6;
  EXPECT_EQ(subject.measure(variant).reason, "a tolerance is for surfaces as prescribed: between points nothing is iterated to one");
  EXPECT_EQ(study::measure(paper_lens(), 5, linear(4)).reason, "there is no surface 5: the system has 1 to 2");
  EXPECT_EQ(study::Subject(paper_lens(), 1, 3).measure(linear(4)).reason, "there is no field 3: the system has 0 to 0");
  variant = linear(4);
  variant.interpolation = "quintic";
  EXPECT_EQ(subject.measure(variant).reason, "there is no interpolation 'quintic': it is analytic or c1, linear, cubic, thin_plate, multiquadric");
  EXPECT_NE(subject.measure(linear(0)).reason.find("places"), std::string::npos) << subject.measure(linear(0)).reason;
}

// A system whose other surface is a Delaunay surface has no exact rays; that of the surface under study would not do either.
TEST(Measured, SystemOfPointsHasNoTruth) {
  study::Subject lens(paper_lens(), 1);
  auto model = paper_lens();
  prescription::Shape& shape = model.surfaces.front().shape;
  shape.kind = "delaunay";
  shape.parameters.numbers = {{"rings", 2}, {"shape_mm", 0}, {"smoothing_um", 0}, {"max_edge_mm", INFINITY}};
  shape.parameters.texts = {{"points", "p"}, {"format", "xyz"}, {"axes", "local"}, {"interpolation", "linear"}};
  shape.cloud = std::make_shared<const prescription::PointCloud>(lens.cloud_of(linear(1)));
  for (const int surface : {1, 2})
    EXPECT_EQ(study::measure(model, surface, linear(1)).reason,
              "surface 1 is made of points (flat facets), which have no exact rays: it must be a plane, a conic or a zernike surface");
}

}  // namespace
}  // namespace sagitta::test
