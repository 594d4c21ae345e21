// SPDX-License-Identifier: Apache-2.0
// 2026-11-22: a harmless reference in the kernel's loop kept it from becoming a vector loop, five times slower, and no test
// saw it. So the machine code is read: each of the conic's six loops (centred or not; none, refract, reflect) takes a packed
// square root in the widest registers, one instruction set each.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>

namespace {

int count_of(const std::string& command) {
  std::FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return -1;
  std::array<char, 64> line{};
  int count = -1;
  if (std::fgets(line.data(), line.size(), pipe)) count = std::stoi(line.data());
  pclose(pipe);
  return count;
}

TEST(Kernels, AreVectorLoops) {
#if !defined(__x86_64__) || defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
  GTEST_SKIP() << "only the optimised program for x86-64 has vector loops";
#endif
  const std::string roots = "objdump -d --no-show-raw-insn '" SAGITTA_PROGRAM "' | grep vsqrtpd | grep -c ";
  EXPECT_GE(count_of(roots + "zmm"), 6);
  EXPECT_GE(count_of(roots + "ymm"), 6);
}

}  // namespace
