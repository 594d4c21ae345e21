// SPDX-License-Identifier: Apache-2.0
// The architecture of README.md, held: which folder includes which, where each heavy library lives, and the form of a
// source file. Every test reads the tree as it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Source {
  std::string path;  // from the root of the project, "lib/scene/scene.h"
  std::vector<std::string> lines;

  std::string folder() const { return path.substr(0, path.rfind('/')); }
};

std::vector<Source> read_sources(const std::set<std::string>& folders) {
  std::vector<Source> sources;
  const fs::path root(SAGITTA_SOURCE_DIR);
  for (const auto& folder : folders)
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const fs::path extension = entry.path().extension();
      if (!entry.is_regular_file() || (extension != ".h" && extension != ".cc")) continue;
      Source source{fs::relative(entry.path(), root).generic_string(), {}};
      std::ifstream stream(entry.path());
      for (std::string line; std::getline(stream, line);) source.lines.push_back(line);
      sources.push_back(std::move(source));
    }
  std::sort(sources.begin(), sources.end(), [](const Source& a, const Source& b) { return a.path < b.path; });
  return sources;
}

struct Include {
  const Source* from;
  std::string what;  // without its brackets or quotes
  bool quoted;
};

std::vector<Include> includes_of(const std::vector<Source>& sources) {
  static const std::regex pattern(R"re(^\s*#\s*include\s*(["<])([^">]+)[">].*)re");
  std::vector<Include> includes;
  std::smatch match;
  for (const Source& source : sources)
    for (const std::string& line : source.lines)
      if (std::regex_match(line, match, pattern)) includes.push_back({&source, match[2], match[1] == "\""});
  return includes;
}

// What a folder of lib/ may include besides itself: the table of README.md.
const std::map<std::string, std::set<std::string>> layers{
    {"lib/numerics", {}},
    {"lib/medium", {"lib/numerics"}},
    {"lib/surface", {"lib/numerics"}},
    {"lib/gradient_index", {"lib/numerics", "lib/surface"}},
    {"lib/prescription", {"lib/numerics", "lib/medium", "lib/surface", "lib/gradient_index"}},
    {"lib/lens_file", {"lib/numerics", "lib/medium", "lib/surface", "lib/prescription"}},
    {"lib/scene", {"lib/numerics", "lib/surface", "lib/gradient_index"}},
    {"lib/trace", {"lib/numerics", "lib/surface", "lib/gradient_index", "lib/scene"}},
    {"lib/analysis", {"lib/numerics", "lib/surface", "lib/gradient_index", "lib/scene", "lib/trace"}},
    {"lib/study", {"lib/numerics", "lib/medium", "lib/surface", "lib/gradient_index", "lib/prescription", "lib/scene", "lib/trace", "lib/analysis"}},
    {"lib/output", {"lib/numerics", "lib/surface", "lib/scene", "lib/trace", "lib/analysis", "lib/study"}}};

// The bridge from the model to the scene: these files of lib/scene alone know the prescription.
bool is_bridge(const std::string& path) {
  static const std::regex pattern("lib/scene/(compile|triangulate|cloud_fit|fit_zernike)[a-z_]*\\.(h|cc)");
  return std::regex_match(path, pattern);
}

bool is_allowed(const std::string& from_path, const std::string& from_folder, const std::string& to_folder) {
  if (from_folder == to_folder) return true;
  if (is_bridge(from_path) && (to_folder == "lib/prescription" || to_folder == "lib/medium")) return true;
  const auto row = layers.find(from_folder);
  return row != layers.end() && row->second.contains(to_folder);
}

TEST(Architecture, EveryFolderIncludesOnlyTheFoldersBelowIt) {
  const auto sources = read_sources({"lib"});
  int checked = 0;
  for (const Include& include : includes_of(sources)) {
    if (!include.quoted) continue;
    EXPECT_TRUE(include.what.starts_with("lib/")) << include.from->path << " includes \"" << include.what << "\": paths begin at the root";
    const std::string to_folder = include.what.substr(0, include.what.rfind('/'));
    EXPECT_TRUE(is_allowed(include.from->path, include.from->folder(), to_folder)) << include.from->path << " includes " << include.what;
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

TEST(Architecture, EveryFolderOfLibHasItsRow) {
  std::set<std::string> folders;
  for (const Source& source : read_sources({"lib"})) folders.insert(source.folder());
  std::set<std::string> rows;
  for (const auto& [folder, below] : layers) rows.insert(folder);
  EXPECT_EQ(folders, rows);
}

TEST(Architecture, AnInternalHeaderStaysInItsFolder) {
  const auto sources = read_sources({"lib", "tools"});
  int checked = 0;
  for (const Include& include : includes_of(sources)) {
    if (!include.what.ends_with("_internal.h")) continue;
    EXPECT_EQ(include.what.substr(0, include.what.rfind('/')), include.from->folder()) << include.from->path << " includes " << include.what;
    ++checked;
  }
  EXPECT_GT(checked, 0);
}

// A library that takes long to compile, or whose types must not spread, lives in few files.
TEST(Architecture, EveryHeavyLibraryLivesWhereItIsSaidToLive) {
  struct Home {
    std::string library;
    std::regex header;
    std::set<std::string> files;
  };
  const std::vector<Home> homes{
      {"CGAL", std::regex("CGAL/.*"), {"lib/scene/triangulate_cgal.cc"}},
      {"Boost", std::regex("boost/.*"), {"lib/study/fifty_digits_internal.h"}},
      {"Eigen", std::regex("Eigen/.*"), {"lib/analysis/zernike_fit.cc", "lib/scene/fit_conic.cc", "lib/scene/fit_radial.cc", "lib/scene/fit_zernike.cc",
       "lib/scene/least_squares_internal.h", "lib/scene/smooth.cc"}},
      {"yaml-cpp", std::regex("yaml-cpp/.*"), {"lib/prescription/yaml_tree.cc"}},
      {"OpenEXR", std::regex("(OpenEXR/|Imath/)?(openexr|Imf|Imath|Iex).*"), {"lib/output/exr.cc"}},
      {"Cairo and FreeType", std::regex("cairo.*|ft2build.*|freetype.*"), {"lib/output/canvas.cc"}},
      {"libpng and zlib", std::regex("(png|zlib)\\.h"), {"lib/output/raster.cc"}},
      {"libdeflate", std::regex("libdeflate\\.h"), {"lib/output/exr.cc"}},
      {"nlohmann-json", std::regex("nlohmann/.*"), {"lib/output/fit_report.cc", "lib/output/rounding_report.cc", "lib/output/summary_internal.h", "lib/prescription/schema.cc"}},
      {"CLI11", std::regex("CLI/.*"), {"tools/sagitta.cc"}},
      {"Google Benchmark", std::regex("benchmark/.*"), {"tools/bench.cc", "tools/bench_growth.cc", "tools/bench_jobs.cc", "tools/bench_kernels.cc", "tools/bench_limit.cc", "tools/bench_preparation.cc",
                                                                "tools/bench_stability.cc", "tools/bench_startup.cc"}},
      {"Embree", std::regex("embree[34]/.*"), {"tools/bench_embree.cc"}}};
  const auto sources = read_sources({"lib", "tools"});
  std::map<std::string, std::set<std::string>> found;
  for (const Include& include : includes_of(sources))
    for (const Home& home : homes)
      if (std::regex_match(include.what, home.header)) found[home.library].insert(include.from->path);
  for (const Home& home : homes) EXPECT_EQ(found[home.library], home.files) << home.library;
}

TEST(Architecture, EverySourceNamesItsLicence) {
  int checked = 0;
  for (const Source& source : read_sources({"lib", "tools", "tests"})) {
    ASSERT_FALSE(source.lines.empty()) << source.path;
    EXPECT_EQ(source.lines.front(), "// SPDX-License-Identifier: Apache-2.0") << source.path;
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

TEST(Architecture, NoFileIsLongerThan400Lines) {
  for (const Source& source : read_sources({"lib", "tools"})) EXPECT_LE(source.lines.size(), 400u) << source.path;
}

TEST(Architecture, NoSourceNamesAPlaceOfOneMachine) {
  static const std::regex place(R"re(.*["' (](/home/|/root/|/work/|/tmp/|/Users/|/mnt/|/opt/).*)re");
  int checked = 0;
  for (const Source& source : read_sources({"lib", "tools", "tests"}))
    for (std::size_t i = 0; i < source.lines.size(); ++i) {
      if (source.path == "tests/architecture/architecture_test.cc") continue;
      EXPECT_FALSE(std::regex_match(source.lines[i], place)) << source.path << ":" << i + 1;
      ++checked;
    }
  EXPECT_GT(checked, 5000);
}

TEST(Architecture, TheTopLevelHoldsWhatReadmeNames) {
  const std::set<std::string> expected{"CMakeLists.txt", "LICENSE", "README.md", "lib", "materials", "systems", "tests", "tools"};
  std::set<std::string> found;
  for (const auto& entry : fs::directory_iterator(fs::path(SAGITTA_SOURCE_DIR))) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(".") && !name.starts_with("build") && name != "out") found.insert(name);
  }
  EXPECT_EQ(found, expected);
}

}  // namespace
