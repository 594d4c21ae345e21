// SPDX-License-Identifier: Apache-2.0
// A few of the random systems of random_search_slow_test.cc, and one alone: SAGITTA_SEED=123 replays what was found with that seed, and
// prints the system. (Some have surfaces of points, delaunay, or of heights on a grid, or gradient-index media.)
#include <cstdlib>

#include "tests/extreme/wild_search.h"

namespace sagitta::test {
namespace {

TEST(RandomSearch, LawsHoldInAFewWildSystems) {
  const Found found = search_systems(0, 120);
  for (const std::string& complaint : found.complaints) ADD_FAILURE() << complaint;
  EXPECT_EQ(found.counts.at("systems"), 120);
  EXPECT_GE(found.counts.at("rays through 3 surfaces or more"), 400);  // of 840
  EXPECT_GE(found.counts.at("rays through 8 surfaces or more"), 100);
  for (const char* law : {"within its bound", "on the surface and the ray", "Snell and coplanarity", "Fermat", "sent back"}) EXPECT_GE(found.counts.at(law), 2500) << law;
  for (const char* law : {"turned about the axis", "mirrored in x"}) EXPECT_GE(found.counts.at(law), 600) << law;
  for (const char* law : {"turned by 90 degrees", "verify"}) EXPECT_GE(found.counts.at(law), 50) << law;
  EXPECT_GE(found.counts.at("at bicubic grid"), 10);
}

TEST(RandomSearch, LawsHoldInAFewWildGradients) {
  const Found found = search_gradients(0, 600);
  for (const std::string& complaint : found.complaints) ADD_FAILURE() << complaint;
  EXPECT_GE(found.counts.at("systems"), 12);
  EXPECT_GE(found.counts.at("the same bits alone"), 60);
  for (const char* law : {"within its bound, in gradients", "sent back in gradients"}) EXPECT_GE(found.counts.at(law), 60) << law;
}

// 2026-11-23, seed 2939: a hit by the tangent plane, from a surface that bends away from it (gradient_index/travel.h).
TEST(RandomSearch, LawsHoldInWhatItFoundInGradients) {
  const Found found = Examination(2939, true).take();
  for (const std::string& complaint : found.complaints) ADD_FAILURE() << complaint;
  EXPECT_GE(found.counts.at("within its bound, in gradients"), 10);
}

TEST(RandomSearch, ReplaysOneSeed) {
  const char* seed = std::getenv("SAGITTA_SEED");
  if (!seed) GTEST_SKIP() << "SAGITTA_SEED is not set";
  Examination one(std::strtoull(seed, nullptr, 10), true);
  fmt::print("{}", one.yaml());
  const Found found = one.take();
  for (const auto& [name, count] : found.counts) fmt::print("{:8} {}\n", count, name);
  for (const auto& [name, worst] : found.worst) fmt::print("{:.3g} {}: {}\n", worst.value, name, worst.where);
  for (const std::string& complaint : found.complaints) ADD_FAILURE() << complaint;
}

}  // namespace
}  // namespace sagitta::test
