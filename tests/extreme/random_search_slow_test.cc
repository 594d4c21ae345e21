// SPDX-License-Identifier: Apache-2.0
// 1e5 random systems, seeds 0 to 99999, through the laws of wild_laws.h: prescriptions of 1 to 20 surfaces over wild scales, from text by the reader and
// the compile step. What fails names its seed, and SAGITTA_SEED=123 build/test_extreme --gtest_filter=RandomSearch.ReplaysOneSeed prints
// and replays it. (Some have surfaces of points, delaunay, or of heights on a grid, or gradient-index media.)
#include "tests/extreme/wild_search.h"

namespace sagitta::test {
namespace {

constexpr std::uint64_t systems_a_test = 5000;

class WildSystems : public testing::TestWithParam<std::uint64_t> {};

TEST_P(WildSystems, KeepTheLaws) {
  const std::uint64_t first = GetParam() * systems_a_test;
  const Found found = search_systems(first, systems_a_test);
  for (const std::string& complaint : found.complaints) ADD_FAILURE() << complaint;
  const auto count = [&](const char* name) {
    const auto at = found.counts.find(name);
    return at == found.counts.end() ? 0 : at->second;
  };
  const auto systems = static_cast<std::int64_t>(systems_a_test);
  EXPECT_EQ(count("systems"), systems);
  EXPECT_LE(count("refused"), systems / 100);
  EXPECT_GE(count("rays"), 6 * systems);
  EXPECT_GE(count("ok"), count("rays") / 3);
  EXPECT_GE(count("rays through 3 surfaces or more"), count("rays") / 2);
  EXPECT_GE(count("rays through 8 surfaces or more"), count("rays") / 8);
  EXPECT_GE(count("passages"), 30 * systems);
  EXPECT_LE(count("passages of which nothing is known"), count("passages") / 1000);
  EXPECT_GE(count("passages in gradients"), 900);
  EXPECT_LE(count("passages in gradients of which nothing is known"), count("passages in gradients") / 20);
  EXPECT_LE(count("given up by one of the two in gradients"), count("passages in gradients") / 50);
  EXPECT_LE(count("another crossing in gradients"), count("passages in gradients") / 100);
  for (const char* law : {"within its bound, in gradients", "sent back in gradients"}) EXPECT_GE(count(law), 900) << law;
  EXPECT_LE(count("end differently"), count("passages") / 1000);
  EXPECT_LE(count("given up by one of the two"), count("passages") / 10000);
  for (const char* law : {"within its bound", "on the surface and the ray", "Snell and coplanarity", "Fermat", "sent back"}) EXPECT_GE(count(law), 28 * systems) << law;
  EXPECT_GE(count("turned about the axis"), 10 * systems);
  EXPECT_GE(count("mirrored in x"), 6 * systems);
  EXPECT_GE(count("turned by 90 degrees"), systems / 2);  // those of closed forms alone
  EXPECT_GE(count("verify"), systems / 2);
  EXPECT_GE(count("at bicubic grid"), systems / 10);
  for (const auto& [name, how_many] : found.counts) fmt::print("random search | seeds from {} | {} | {} |\n", first, name, how_many);
  for (const auto& [name, worst] : found.worst) fmt::print("random search | seeds from {} | worst: {} | {:.3g} | {} |\n", first, name, worst.value, worst.where);
}

INSTANTIATE_TEST_SUITE_P(RandomSearch, WildSystems, testing::Range<std::uint64_t>(0, 20), [](const auto& of) { return "seeds_from_" + std::to_string(of.param * systems_a_test); });

}  // namespace
}  // namespace sagitta::test
