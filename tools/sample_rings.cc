// SPDX-License-Identifier: Apache-2.0
// Writes a surface of a prescription as points on rings and meridians, as a Placido topographer would measure it: the
// data of systems/cornea-delaunay.yaml (tools/make-data calls it). The points are x, y, z in mm with 17 digits, in the
// surface's own frame.
#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include "lib/output/atomic_file.h"
#include "lib/prescription/reader.h"
#include "lib/scene/compile.h"

namespace {

using namespace sagitta;

// cos and sin of 2 pi i/count, exact on the axes and diagonals' symmetry kept by reduction to the first octant.
struct Angle {
  double cosine, sine;
};
Angle meridian(int i, int count) {
  const int eighth = 8 * i / count;  // octant
  const auto in_octant = [&](int numerator) { return 2 * std::numbers::pi * numerator / (8.0 * count); };
  const int rest = 8 * i - eighth * count;                             // eighths of a step into the octant
  const double angle = in_octant(eighth % 2 == 0 ? rest : count - rest);  // 0 to pi/4
  const double c = std::cos(angle), s = std::sin(angle);
  switch (eighth) {
    case 0: return {c, s};
    case 1: return {s, c};
    case 2: return {-s, c};
    case 3: return {-c, s};
    case 4: return {-c, -s};
    case 5: return {-s, -c};
    case 6: return {s, -c};
    default: return {c, -s};
  }
}

int parse(std::string_view text) {
  int value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  return fault == std::errc{} && end == text.data() + text.size() ? value : -1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 7) {
    fmt::print(stderr, "usage: sample-rings SYSTEM.yaml SURFACE_NUMBER RINGS MERIDIANS RING_STEP_UM OUTPUT.xyz\n");
    return 2;
  }
  const int number = parse(argv[2]), rings = parse(argv[3]), meridians = parse(argv[4]), step_um = parse(argv[5]);
  const auto read = prescription::read_prescription(argv[1]);
  for (const auto& finding : read.findings.all()) fmt::print(stderr, "{}\n", prescription::format(finding));
  if (!read.model) return 1;
  const auto compiled = scene::compile(*read.model);
  if (!compiled.scene || number < 1 || number > compiled.scene->surface_count() || rings < 1 || meridians < 3 || step_um < 1) {
    fmt::print(stderr, "sample-rings: no such surface, or too few rings or meridians\n");
    return 1;
  }
  std::string text = fmt::format("# Surface {} of {}: {} rings x {} meridians, rings every {} um. Made by tools/make-data.\nx_mm,y_mm,z_mm\n",
                                 number, read.model->name, rings, meridians, step_um);
  for (int ring = 1; ring <= rings; ++ring)
    for (int i = 0; i < meridians; ++i) {
      const Angle angle = meridian(i, meridians);
      const double r = ring * step_um / 1000.0, x = r * angle.cosine, y = r * angle.sine;
      const double z = std::visit([&](const auto& shape) { return shape.sag(x, y); }, compiled.scene->surface(number).shape);
      text += fmt::format("{:.17g},{:.17g},{:.17g}\n", x, y, z);
    }
  const auto result = output::write_file(argv[6], text);
  if (!result.ok()) fmt::print(stderr, "sample-rings: {}\n", result.error);
  return result.ok() ? 0 : 1;
}
