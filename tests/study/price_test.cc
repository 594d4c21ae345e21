// SPDX-License-Identifier: Apache-2.0
#include "lib/study/price.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/study/subjects.h"

namespace sagitta::test {
namespace {

using study::Probe;
using study::Variant;

// 1000 points: sampled in 2 ms, prepared in 10 ms; 100 rays compared in 1 ms; 20 ns for launching, 30 for the surface.
Probe probe() {
  Probe probe;
  probe.row.points = 1000;
  probe.row.sampling_s = .002;
  probe.row.prepare_wall_s.median = .01;
  probe.row.compared = 100;
  probe.row.comparing_s = .001;
  probe.row.launching_ns_per_ray = 20;
  probe.row.wall_ns_per_ray.median = 30;
  // Its own: .002 + 7 times .01 + 128 times 1e-5 + (1 + 7 times 33) times 2000 times 5e-8 = .09648; .02 are the rest.
  probe.seconds = .11648;
  probe.exact_s_per_ray = 1e-4;
  return probe;
}

Variant large() {
  Variant variant;
  variant.arrangement.points_per_mm2 = 100;
  variant.rays = 1000000;
  variant.most_compared = 10000;
  return variant;
}

TEST(Price, IsTheSumOfItsParts) {
  // .2 of sampling, 3 times 1 of preparation, .1 of comparison, 8 times 1e6 times 50 ns, .02
  EXPECT_NEAR(seconds_of(large(), 100000, probe()), .2 + 3 + .1 + .4 + .02, 1e-12);
  Variant threaded = large();
  threaded.threads = 3;
  EXPECT_NEAR(seconds_of(threaded, 100000, probe()), .2 + 3 + .1 + .24 + .02, 1e-12);
  Variant many = large();
  many.rays = 100000000;  // 3 s a run: three of them and a first one
  EXPECT_NEAR(seconds_of(many, 100000, probe()), .2 + 3 + .1 + 4 * 5 + .02, 1e-12);
  EXPECT_NEAR(exact_seconds_of(large(), probe(), 4), 10000 * 1e-4 / 4, 1e-15);
  Variant few = large();
  few.rays = 500;
  EXPECT_NEAR(exact_seconds_of(few, probe(), 1), 500 * 1e-4, 1e-15);
}

// 100 times the points: 3 us a ray, 83333 of them in a quarter of a second, and each comparison 1 ms.
TEST(Price, OfTheNearestVertexGrowsWithThePoints) {
  Variant nearest = large();
  nearest.search = study::Search::nearest_vertex;
  EXPECT_NEAR(seconds_of(nearest, 100000, probe()), .2 + 3 + 10 + 8 * .25 / 3e-6 * 3.02e-6 + .02, 1e-9);
}

TEST(Price, ProbeIsOfTheSameKindAndSmall) {
  study::Subject subject(paper_lens(), 1);
  Variant variant = large();
  variant.interpolation = "c1";
  variant.threads = 2;
  const double points = subject.point_count(variant);
  EXPECT_NEAR(points / static_cast<double>(subject.cloud_of(variant).points.size()), 1, .01);
  const Variant probe = probe_of(variant, points);
  EXPECT_EQ(probe.interpolation, "c1");
  EXPECT_EQ(probe.threads, 1);
  EXPECT_EQ(probe.rays, 2000);
  EXPECT_EQ(probe.most_compared, 128);
  EXPECT_NEAR(subject.point_count(probe), 4000, 1000);  // the margin, in spacings, grows
  variant.arrangement = {study::ArrangementKind::rings, 0, 24, 180};
  EXPECT_EQ(subject.point_count(variant), 24 * 180);
  EXPECT_EQ(probe_of(variant, 1e6).arrangement, variant.arrangement);
  variant.interpolation = Variant::as_prescribed;
  EXPECT_EQ(subject.point_count(variant), 0);
  Variant small = large();
  small.rays = 10;
  small.most_compared = 5;
  EXPECT_EQ(probe_of(small, 100).rays, 10);
  EXPECT_EQ(probe_of(small, 100).most_compared, 5);
  EXPECT_EQ(probe_of(small, 100).arrangement, small.arrangement);
}

// What a price is made of is measured: by the clock, and not nothing.
TEST(Price, RowsSayWhatElseTheyTook) {
  study::Subject subject(paper_lens(), 1);
  Variant variant = large();
  variant.arrangement.points_per_mm2 = 4;
  variant.rays = variant.most_compared = 2000;
  const study::Times before = study::times_now(study::Clocked::process);
  const study::Row row = row_of(subject, variant);
  const double wall = (study::times_now(study::Clocked::process) - before).wall;
  for (const double part : {row.sampling_s, row.comparing_s, 1e-9 * row.launching_ns_per_ray * 2000}) {
    EXPECT_GT(part, 0);
    EXPECT_LT(part, wall);
  }
  EXPECT_EQ(row.threads, 1);
}

}  // namespace
}  // namespace sagitta::test
