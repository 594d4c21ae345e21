// SPDX-License-Identifier: Apache-2.0
// 2026-11-22: a harmless reference in the kernel's loop kept it from becoming a vector loop, five times slower, and no test
// saw it. So the machine code is read. Each of the conic's and the sphere's twelve loops (none, refract, reflect; with and
// without OPL and apertures) takes a packed square root in the widest registers, one instruction set each; and no
// operation on lanes has stayed a function of its own, which would be one for any machine (numerics/lanes.h).
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
  const std::string roots = "objdump -d --no-show-raw-insn '" SAGITTA_PROGRAM "' | grep -w ";
  EXPECT_GE(count_of(roots + "vsqrtpd | grep -c zmm"), 24);
  EXPECT_GE(count_of(roots + "vsqrtpd | grep -c ymm"), 24);
  EXPECT_GE(count_of(roots + "sqrtpd | grep -c xmm"), 24);
  EXPECT_EQ(count_of("nm -C '" SAGITTA_CORE "' 2>/dev/null | grep 'Lanes<' | grep -vc 'run_flat_for'"), 0);
}

}  // namespace
