// SPDX-License-Identifier: Apache-2.0
// The same input gives the same bytes: with each instruction set of the kernels, and on any number of threads. On a
// machine without AVX-512 (or AVX2) the choices fall together and less is shown.
#include <gtest/gtest.h>

#include <string>

#include "tests/support/program.h"

namespace sagitta::test {
namespace {

struct Files {
  std::string summary, spot, wavefront;
  friend bool operator==(const Files&, const Files&) = default;
};

Files trace_shipped(const std::string& system, const std::string& isa, int thread_count) {
  const Folder folder;
  const Outcome run = run_program("trace '" SAGITTA_SOURCE_DIR "/systems/" + system + "' --rays 3000 --threads " +
                                      std::to_string(thread_count) + " -o '" + folder.path() + "'",
                                  "SAGITTA_ISA=" + isa + " ");
  EXPECT_EQ(run.status, 0) << run.err;
  return {read_text(folder.path("summary.json")), read_text(folder.path("spot.exr")), read_text(folder.path("wavefront.exr"))};
}

class SameBits : public testing::TestWithParam<const char*> {};

TEST_P(SameBits, WithEachInstructionSetAndAnyNumberOfThreads) {
  const Files expected = trace_shipped(GetParam(), "x86-64", 1);
  EXPECT_GT(expected.summary.size(), 1000u);
  EXPECT_GT(expected.spot.size(), 10000u);
  EXPECT_GT(expected.wavefront.size(), 10000u);
  EXPECT_TRUE(trace_shipped(GetParam(), "x86-64-v3", 1) == expected);
  EXPECT_TRUE(trace_shipped(GetParam(), "x86-64-v4", 1) == expected);
  EXPECT_TRUE(trace_shipped(GetParam(), "x86-64-v4", 3) == expected);
}

INSTANTIATE_TEST_SUITE_P(Systems, SameBits,
                         testing::Values("double-gauss.yaml", "navarro-eye.yaml", "ritchey-chretien.yaml", "cornea-zernike.yaml",
                                         "cornea-delaunay.yaml", "eye-with-measured-cornea.yaml", "three-mirror-compact.yaml"));

}  // namespace
}  // namespace sagitta::test
