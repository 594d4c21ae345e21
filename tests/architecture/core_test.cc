// SPDX-License-Identifier: Apache-2.0
// The core library stands alone: what it takes from elsewhere is read from its symbols, nothing of which is left to the readers,
// the outputs, or the libraries that these need.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <set>
#include <string>

namespace {

// Of libsagitta_core.a, by nm with these options.
std::set<std::string> symbols(const std::string& options) {
  std::set<std::string> names;
  std::FILE* pipe = popen(("nm --format=just-symbols " + options + " '" SAGITTA_CORE "' 2>&1").c_str(), "r");
  if (!pipe) return names;
  std::array<char, 1 << 16> line{};
  while (std::fgets(line.data(), line.size(), pipe)) {
    std::string name(line.data());
    name.erase(name.find_last_not_of("\n") + 1);
    names.insert(name);
  }
  pclose(pipe);
  return names;
}

bool is_ours(const std::string& name) { return name.find("7sagitta") != std::string::npos; }

TEST(Core, TakesNothingOfItsOwnFromOutsideButTheTriangulation) {
  const std::set<std::string> defined = symbols("--defined-only");
  int checked = 0;
  for (const std::string& name : symbols("--undefined-only")) {
    if (!is_ours(name)) continue;
    ++checked;
    const bool is_of_triangulation = name.find("8delaunay") != std::string::npos || name.find("12triangulator") != std::string::npos;
    EXPECT_TRUE(defined.contains(name) || is_of_triangulation) << name;
  }
  EXPECT_GT(checked, 20);
}

TEST(Core, NeedsNoLibraryThatReadsOrWritesFiles) {
  const std::set<std::string> names = symbols("--undefined-only");
  EXPECT_GT(names.size(), 100u);
  for (const std::string& name : names)
    for (const char* library : {"YAML", "Imf", "Imath", "cairo", "FT_", "png_", "nlohmann", "CGAL", "__gmp"})
      EXPECT_EQ(name.find(library), std::string::npos) << name;
}

}  // namespace
