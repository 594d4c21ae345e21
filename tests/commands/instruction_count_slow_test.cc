// SPDX-License-Identifier: Apache-2.0
// A guard of speed that a noisy machine cannot fool: the instructions of six systems, counted by tools/count-instructions, beside
// those of instruction_counts.txt. 10 %: a layout of the program that differs by chance moves them by far less than one.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>

#include "tests/support/program.h"

namespace sagitta {
namespace {

constexpr double tolerance = 0.1;

struct Count {
  double whole = 0, job = 0, tracing = 0;
};
struct Counts {
  std::string compiler, library;
  std::map<std::string, Count> of;  // by system
};

Counts parse(const std::string& text) {
  Counts counts;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::string first;
    words >> first;
    if (first.empty() || first == "#") continue;
    if (first == "compiler" || first == "library")
      (first == "compiler" ? counts.compiler : counts.library) = line;
    else if (Count& count = counts.of[first]; !(words >> count.whole >> count.job >> count.tracing))
      ADD_FAILURE() << "not three numbers: " << line;
  }
  return counts;
}

void compare(const std::string& system, const char* what, double got, double expected) {
  EXPECT_GT(expected, 0) << system;
  const double change = got / expected - 1;
  EXPECT_LE(std::abs(change), tolerance) << system << ", " << what << ": " << 100 * change << " % instructions, " << got << " instead of " << expected
                                         << (change < 0 ? "; fewer is fine: renew" : "; if that has its reason, renew")
                                         << " tests/commands/instruction_counts.txt as its head says";
}

TEST(Instructions, OfSixSystemsAreAsManyAsTheyWere) {
#if !defined(__x86_64__) || defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
  GTEST_SKIP() << "counts are of the optimised program for x86-64";
#else
  if (!__builtin_cpu_supports("x86-64-v3")) GTEST_SKIP() << "counts are of AVX2, which this processor lacks";
#endif
  if (std::system("valgrind --version >/dev/null 2>&1 && command -v callgrind_annotate >/dev/null") != 0)
    GTEST_SKIP() << "valgrind is not installed (Debian: valgrind)";
  const std::string root = SAGITTA_SOURCE_DIR;
  const Counts expected = parse(test::read_text(root + "/tests/commands/instruction_counts.txt"));
  ASSERT_EQ(expected.of.size(), 6u);

  const test::Folder folder;
  const auto count = [&](const std::string& systems) {
    const std::string command = "'" + root + "/tools/count-instructions' '" SAGITTA_PROGRAM "' " + systems + " >'" + folder.path("counts") + "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return parse(test::read_text(folder.path("counts")));
  };
  Counts got = count("''");  // the versions alone
  if (got.compiler != expected.compiler) GTEST_SKIP() << "counted with another compiler: " << got.compiler << " instead of " << expected.compiler;
  if (got.library != expected.library) GTEST_SKIP() << "counted with another C library: " << got.library << " instead of " << expected.library;
  got = count("");
  ASSERT_EQ(got.of.size(), 6u);
  for (const auto& [system, then] : expected.of) {
    const Count now = got.of[system];
    compare(system, "whole program", now.whole, then.whole);
    compare(system, "launch, tracing and analysis", now.job, then.job);
    compare(system, "tracing", now.tracing, then.tracing);
  }
}

}  // namespace
}  // namespace sagitta
