// SPDX-License-Identifier: Apache-2.0
// Writes a surface of a prescription, or a model cornea, as points on rings and meridians, as a Placido topographer would
// measure it: the point clouds of systems/ (tools/make-data calls it). The points are x, y, z in mm with 17 digits, in the
// surface's own frame; those of the model corneas have OSA axes.
#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

#include "lib/output/atomic_file.h"
#include "lib/prescription/reader.h"
#include "lib/scene/compile.h"
#include "tools/model_corneas.h"

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

struct Sampled {
  std::string name;
  std::function<double(double, double)> sag;
};

std::optional<Sampled> surface_of(const std::string& file, int number) {
  const auto read = prescription::read_prescription(file);
  for (const auto& finding : read.findings.all()) fmt::print(stderr, "{}\n", prescription::format(finding));
  if (!read.model) return std::nullopt;
  const auto compiled = scene::compile(*read.model);
  if (!compiled.scene || number < 1 || number > compiled.scene->surface_count()) return std::nullopt;
  return Sampled{fmt::format("Surface {} of {}", number, read.model->name), [scene = *compiled.scene, number](double x, double y) {
                   return std::visit([&](const auto& shape) { return shape.sag(x, y); }, scene.surface(number).shape);
                 }};
}

std::optional<Sampled> sampled(const std::string& what) {
  if (what == "normal") return Sampled{"A normal cornea, OSA axes", tools::normal_cornea};
  if (what == "keratoconus") return Sampled{"A keratoconic cornea, OSA axes", tools::keratoconic_cornea};
  const std::size_t colon = what.rfind(':');
  return colon == std::string::npos ? std::nullopt : surface_of(what.substr(0, colon), parse(std::string_view(what).substr(colon + 1)));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    fmt::print(stderr, "usage: sample-rings SURFACE RINGS MERIDIANS RING_STEP_UM OUTPUT.xyz\n"
                       "SURFACE: SYSTEM.yaml:NUMBER, normal or keratoconus\n");
    return 2;
  }
  const auto surface = sampled(argv[1]);
  const int rings = parse(argv[2]), meridians = parse(argv[3]), step_um = parse(argv[4]);
  if (!surface || rings < 1 || meridians < 3 || step_um < 1) {
    fmt::print(stderr, "sample-rings: no such surface, or too few rings or meridians\n");
    return 1;
  }
  std::string text = fmt::format("# {}: {} rings x {} meridians, rings every {} um. Made by tools/make-data.\nx_mm,y_mm,z_mm\n",
                                 surface->name, rings, meridians, step_um);
  for (int ring = 1; ring <= rings; ++ring)
    for (int i = 0; i < meridians; ++i) {
      const Angle angle = meridian(i, meridians);
      const double r = ring * step_um / 1000.0, x = r * angle.cosine, y = r * angle.sine;
      text += fmt::format("{:.17g},{:.17g},{:.17g}\n", x, y, surface->sag(x, y));
    }
  const auto result = output::write_file(argv[5], text);
  if (!result.ok()) fmt::print(stderr, "sample-rings: {}\n", result.error);
  return result.ok() ? 0 : 1;
}
