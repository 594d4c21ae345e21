// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "lib/output/ply.h"
#include "lib/prescription/cloud_reader.h"
#include "tests/support/program.h"

namespace sagitta::test {
namespace {

using ::testing::HasSubstr;
using numerics::Vec3;

std::vector<Vec3<double>> points_of(const std::string& file, const std::string& format, bool osa_axes = false) {
  prescription::Findings findings;
  const auto cloud = prescription::read_cloud({file, format, osa_axes}, findings);
  EXPECT_TRUE(cloud) << file;
  return cloud ? cloud->points : std::vector<Vec3<double>>{};
}

void expect_same_bits(const std::vector<Vec3<double>>& a, const std::vector<Vec3<double>>& b) {
  ASSERT_EQ(a.size(), b.size());
  ASSERT_FALSE(a.empty());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])), 0);
}

TEST(ConvertCommand, brings_back_every_bit_of_every_format) {
  const Folder folder;
  struct Case {
    std::string format, text;
    bool osa_axes;
  };
  for (const auto& [format, text, osa_axes] :
       {Case{"xyz", "x,y,z\n0.1,-2.5,1e-3\n-0.0,1e300,4.9406564584124654e-310\n3,4,nan\n5,6,\n", false}, Case{"xyz", "0.1 0 0.2\n0 1 0.3\n", true},
        Case{"polar", "ring,meridian,radius,z\n1,33,1.1,-0.1\n1,133,1.2,nan\n2,233,1.3,-0.3\n", false}}) {
    const std::string from = folder.file("points." + format, text), to = folder.path("points.ply");
    const Outcome run = run_program("convert " + from + " -o " + to + " --format " + format + (osa_axes ? " --axes osa" : ""));
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr(to + ": "));
    expect_same_bits(points_of(to, "ply"), points_of(from, format, osa_axes));
  }
  const Outcome counted = run_program("convert " + folder.file("h.xyz", "0 0 nan\n1 0 1\n0 1 nan\n") + " -o " + folder.path("h.ply"));
  EXPECT_EQ(counted.out, folder.path("h.ply") + ": 3 points, 2 of them holes\n");
  // and from its own form again, the same file but for the name in its comment
  const std::string again = folder.path("again.ply");
  EXPECT_EQ(run_program("convert " + folder.path("h.ply") + " --format ply -o " + again).status, 0);
  expect_same_bits(points_of(again, "ply"), points_of(folder.path("h.ply"), "ply"));
}

TEST(ConvertCommand, gives_the_same_trace) {
  const Folder folder;
  const std::string to = folder.path("cornea.ply");
  ASSERT_EQ(run_program("convert " SAGITTA_SOURCE_DIR "/systems/cornea-24x180.xyz -o " + to).status, 0);
  const auto trace = [&](const std::string& points) {
    return run_program("rays " + folder.file("s.yaml", "sagitta: 1\nwavelengths_nm: [543]\naperture: {entrance_pupil_diameter_mm: 3}\nsurfaces:\n"
                                                       "  - {stop: true, delaunay: {" + points + "}, thickness_mm: 24, medium: {index: 1.336}}\n  - {}\n") + " --fan y:11").out;
  };
  const std::string rays = trace("points: " + to + ", format: ply");
  EXPECT_EQ(rays, trace("points: " SAGITTA_SOURCE_DIR "/systems/cornea-24x180.xyz"));
  EXPECT_EQ(parse_rays(rays).size(), 22u);
}

TEST(ConvertCommand, tells_what_is_wrong_and_writes_nothing) {
  const Folder folder;
  const std::string to = folder.path("out.ply"), good = folder.file("good.xyz", "0 0 0\n1 0 0\n");
  const Outcome broken = run_program("convert " + folder.file("broken.xyz", "0 0 0\n1 high 0\n") + " -o " + to);
  EXPECT_EQ(broken.status, 1);
  EXPECT_THAT(broken.err, HasSubstr("broken.xyz:2:3: error: y is no number: \"high\""));
  EXPECT_EQ(run_program("convert " + folder.path("none") + " -o " + to).status, 1);
  const Outcome axes = run_program("convert " + good + " -o " + to + " --format polar --axes osa");
  EXPECT_EQ(axes.status, 2);
  EXPECT_THAT(axes.err, HasSubstr("--axes osa: the format polar itself tells its axes"));
  EXPECT_EQ(run_program("convert " + good + " -o " + to + " --format obj").status, 2);
  EXPECT_EQ(run_program("convert " + good).status, 2);
  const Outcome nowhere = run_program("convert " + good + " -o " + folder.path("no/such/folder.ply"));
  EXPECT_EQ(nowhere.status, 1);
  EXPECT_THAT(nowhere.err, HasSubstr("cannot be created"));
  EXPECT_FALSE(std::filesystem::exists(to));
}

TEST(ConvertCommand, never_overwrites_its_points) {
  const Folder folder;
  const std::string text = "0 0 0\n1 0 0\n0 1 0.5\n", from = folder.file("p.txt", text);
  std::filesystem::create_symlink("p.txt", folder.path("link.ply"));
  std::filesystem::create_hard_link(from, folder.path("hard.ply"));
  for (const char* to : {"p.txt", "./p.txt", "link.ply", "hard.ply"}) {
    const Outcome run = run_program("convert " + from + " -o " + folder.path(to));
    EXPECT_EQ(run.status, 2) << to;
    EXPECT_EQ(run.out, "") << to;
    EXPECT_EQ(run.err, "sagitta convert: -o " + folder.path(to) + ": " + folder.path(to) + " is the file of the points, which would be overwritten\n  hint: give another name\n");
  }
  EXPECT_EQ(read_text(from), text);
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path("link.ply")));
}

TEST(ConvertCommand, writes_nothing_but_printable_text_in_its_header) {
  const Folder folder;
  const std::string file = folder.path("p.ply");
  ASSERT_TRUE(output::write_ply(file, std::vector<Vec3<double>>{{1, 2, 3}}, "a\nend_header\n\xC3\xA4").ok());
  EXPECT_THAT(read_text(file), HasSubstr("comment a?end_header???\n"));
  expect_same_bits(points_of(file, "ply"), {{1, 2, 3}});
}

}  // namespace
}  // namespace sagitta::test
