// SPDX-License-Identifier: Apache-2.0
#include "lib/output/color_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace sagitta::output {
namespace {

struct Chroma {
  double a, b;
};

Chroma polar(double chroma, double hue_deg) {
  const double hue = hue_deg * std::numbers::pi / 180;
  return {chroma * std::cos(hue), chroma * std::sin(hue)};
}

// The quadratic Bezier curve of the sequential map. The control point pulls it as far toward green as sRGB allows.
Chroma bezier(double u) {
  static const Chroma start = polar(0.14, 295), control = {-0.28, 0.08}, end = polar(0.17, 106);
  const double v = 1 - u;
  return {v * v * start.a + 2 * u * v * control.a + u * u * end.a,
          v * v * start.b + 2 * u * v * control.b + u * u * end.b};
}

// The curve's parameter u at the fraction s of its length, from a table of chords. Its error is of second order in the
// step: about 1e-6 of the length.
double parameter_at(double s) {
  constexpr int step_count = 1024;
  static const std::vector<double> length = [] {
    std::vector<double> sum{0};
    for (int i = 1; i <= step_count; ++i) {
      const Chroma p = bezier((i - 1.0) / step_count), q = bezier(double(i) / step_count);
      sum.push_back(sum.back() + std::hypot(q.a - p.a, q.b - p.b));
    }
    return sum;
  }();
  const double wanted = s * length.back();
  const auto above =
      std::clamp(std::upper_bound(length.begin(), length.end(), wanted), length.begin() + 1, length.end() - 1);
  const double below = *(above - 1);
  return (static_cast<double>(above - 1 - length.begin()) + (wanted - below) / (*above - below)) / step_count;
}

std::uint8_t byte(double encoded) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(encoded, 0.0, 1.0)));
}

}  // namespace

Oklab oklab_color(ColorMap map, double t) {
  t = std::clamp(t, 0.0, 1.0);
  if (map == ColorMap::sequential) {
    constexpr double darkest = 0.29, lightest = 0.92;
    const Chroma ab = bezier(parameter_at(t));
    return {darkest + (lightest - darkest) * t, ab.a, ab.b};
  }
  static const Chroma blue = polar(0.16, 258), red = polar(0.16, 35);
  constexpr double middle = 0.97, ends = 0.50;
  const double size = std::abs(2 * t - 1);
  const Chroma end = t < 0.5 ? blue : red;
  return {middle + (ends - middle) * size, size * end.a, size * end.b};
}

std::array<double, 3> linear_srgb(const Oklab& color) {
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(color.lightness + 0.3963377774 * color.a + 0.2158037573 * color.b);
  const double m = cube(color.lightness - 0.1055613458 * color.a - 0.0638541728 * color.b);
  const double s = cube(color.lightness - 0.0894841775 * color.a - 1.2914855480 * color.b);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

double linear_from_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

double srgb_from_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

Rgb8 exact_color(ColorMap map, double t) {
  if (std::isnan(t)) return no_data_color;
  const std::array<double, 3> linear = linear_srgb(oklab_color(map, t));
  return {byte(srgb_from_linear(linear[0])), byte(srgb_from_linear(linear[1])), byte(srgb_from_linear(linear[2]))};
}

Rgb8 color(ColorMap map, double t) {
  // A component changes by 700 per t at most: from an entry half way to the next by 0.35.
  constexpr int last = 1024;
  using Table = std::array<Rgb8, last + 1>;
  const auto table_of = [](ColorMap which) {
    Table table;
    for (int i = 0; i <= last; ++i) table[static_cast<std::size_t>(i)] = exact_color(which, double(i) / last);
    return table;
  };
  if (std::isnan(t)) return no_data_color;
  const auto entry = static_cast<std::size_t>(std::clamp(t, 0.0, 1.0) * last + 0.5);
  if (map == ColorMap::sequential) {
    static const Table sequential = table_of(map);
    return sequential[entry];
  }
  static const Table diverging = table_of(map);
  return diverging[entry];
}

}  // namespace sagitta::output
