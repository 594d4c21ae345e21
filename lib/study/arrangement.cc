// SPDX-License-Identifier: Apache-2.0
#include "lib/study/arrangement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/study/uniform.h"

namespace sagitta::study {
namespace {

constexpr double meridians_per_ring = 7.5;

struct Rings {
  int rings, meridians;
};
Rings rings_of(const Arrangement& arrangement, double radius) {
  if (arrangement.rings > 0 && arrangement.meridians > 0) return {arrangement.rings, arrangement.meridians};
  const double rings = std::sqrt(arrangement.points_per_mm2 * std::numbers::pi / meridians_per_ring) * radius;
  return {std::max(1, static_cast<int>(std::lround(rings))), std::max(3, static_cast<int>(std::lround(meridians_per_ring * rings)))};
}

// Row by row, so that a seed gives a cell the same numbers whatever lies outside the disc.
std::vector<Site> grid(double h, double radius, bool is_jittered, std::uint64_t seed) {
  const double shift_x = (std::numbers::sqrt2 - 1) * h, shift_y = (std::numbers::sqrt3 - 1) * h;
  const auto reach = static_cast<std::int64_t>(radius / h) + 2;
  Uniform u(seed, Stream::sites);
  std::vector<Site> sites;
  for (std::int64_t j = -reach; j <= reach; ++j)
    for (std::int64_t i = -reach; i <= reach; ++i) {
      Site site{static_cast<double>(i) * h + shift_x, static_cast<double>(j) * h + shift_y};
      if (is_jittered) {
        site.x += h * u(-.5, .5);
        site.y += h * u(-.5, .5);
      }
      if (site.x * site.x + site.y * site.y <= radius * radius) sites.push_back(site);
    }
  return sites;
}

std::vector<Site> random(std::int64_t count, double radius, std::uint64_t seed) {
  Uniform u(seed, Stream::sites);
  std::vector<Site> sites;
  while (static_cast<std::int64_t>(sites.size()) < count) {
    const double x = u(-1, 1), y = u(-1, 1);
    if (x * x + y * y <= 1) sites.push_back({radius * x, radius * y});
  }
  return sites;
}

std::vector<Site> rings(const Rings& numbers, double radius) {
  std::vector<Site> sites;
  for (int k = 1; k <= numbers.rings; ++k)
    for (int i = 0; i < numbers.meridians; ++i) {
      const double r = radius * k / numbers.rings, angle = 2 * std::numbers::pi * i / numbers.meridians;
      sites.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
  return sites;
}

}  // namespace

std::optional<ArrangementKind> arrangement_named(std::string_view name) {
  const auto found = std::find(arrangement_names.begin(), arrangement_names.end(), name);
  if (found == arrangement_names.end()) return std::nullopt;
  return static_cast<ArrangementKind>(found - arrangement_names.begin());
}

double spacing_of(const Arrangement& arrangement, double radius) {
  if (arrangement.kind == ArrangementKind::rings) return radius / rings_of(arrangement, radius).rings;
  return 1 / std::sqrt(arrangement.points_per_mm2);
}

std::vector<Site> sites_over_disc(const Arrangement& arrangement, double radius, std::uint64_t seed) {
  const bool has_numbers = arrangement.kind == ArrangementKind::rings && arrangement.rings > 0 && arrangement.meridians > 0;
  if (!(radius > 0) || !(arrangement.points_per_mm2 > 0 || has_numbers)) return {};
  const double h = spacing_of(arrangement, radius);
  switch (arrangement.kind) {
    case ArrangementKind::regular: return grid(h, radius, false, seed);
    case ArrangementKind::jittered: return grid(h, radius, true, seed);
    case ArrangementKind::random: return random(std::llround(arrangement.points_per_mm2 * std::numbers::pi * radius * radius), radius, seed);
    case ArrangementKind::rings: return rings(rings_of(arrangement, radius), radius);
  }
  return {};
}

}  // namespace sagitta::study
