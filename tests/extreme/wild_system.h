// SPDX-License-Identifier: Apache-2.0
// Random prescriptions as text, one a seed: 1 to 20 surfaces and an image, all of them valid for the reader, over wild scales. Most numbers
// are comparable with the system's own scale (1e-6 to 1e6 mm), so that a fair part of the rays gets through several surfaces; each kind of number
// is beyond any measure with some probability.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "tests/extreme/wild_gradient.h"
#include "tests/support/point_sets.h"
#include "tests/support/prescriptions.h"

namespace sagitta::test {

using tests::Uniform;

struct WildSystem {
  std::string yaml;
  std::map<std::string, std::string> points;  // files beside it
  double scale = 1, beam_radius = 1;          // mm
};

class WildGenerator {
 public:
  explicit WildGenerator(std::uint64_t seed) : u(0x9e3779b97f4a7c15u * (seed + 1)), gradients_(seed) { u(), u(); }

  WildSystem system() {
    system_.scale = log_uniform(-6, 6);
    system_.beam_radius = system_.scale * log_uniform(-2.5, -0.7);
    index_ = is(.8) ? 1 : u(1, 1.6);
    object_index_ = index_;
    has_points_ = is(.05);
    const int surface_count = 1 + static_cast<int>(20 * std::pow(u(), 1.5)), stop = is(.9) ? 0 : static_cast<int>(u() * surface_count);
    std::string surfaces;
    for (int i = 0; i < surface_count; ++i) surfaces += surface(i == stop, i);
    surfaces += "  - {" + shape(surface_count);
    surfaces += moved() + "}\n";
    const double field_x = u(-20, 20), field_y = u(-20, 20);
    system_.yaml = fmt::format("sagitta: 1\nwavelengths_nm: [550]\naperture: {{entrance_pupil_diameter_mm: {}}}\n", 2 * system_.beam_radius);
    const double distance = (is(.1) ? -1 : 1) * system_.scale * (is(.2) ? log_uniform(3, 9) : log_uniform(0, 2));
    const bool is_finite = is(.35);
    if (is_finite || object_index_ != 1) system_.yaml += fmt::format("object: {{distance_mm: {}, medium: {{index: {}}}}}\n", is_finite ? fmt::format("{}", distance) : ".inf", object_index_);
    system_.yaml += fmt::format("fields: {{angles_deg: [[0, 0], [{}, {}]]}}\nsurfaces:\n", field_x, field_y) + surfaces;
    return std::move(system_);
  }

  // Lines that come toward the first surfaces: most of them through its beam, some almost along it.
  std::vector<GlobalRay> rays(const WildSystem& system, int count) {
    std::vector<GlobalRay> result;
    for (int i = 0; i < count; ++i) {
      const double r = system.beam_radius * (is(.2) ? log_uniform(-9, 1.5) : u(0, 1)), azimuth = u(0, 6.3), tilt = is(.2) ? (1 - log_uniform(-9, 0)) * std::acos(0.0) : u(0, .2), turn = u(0, 6.3);
      const Vec3<double> d = normalized(Vec3<double>{std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt)});
      const Vec3<double> at{r * std::cos(azimuth), r * std::sin(azimuth), 0};
      result.push_back({at + -(system.scale * (is(.1) ? log_uniform(-9, 9) : u(0, 3))) * d, d});
    }
    return result;
  }

 private:
  bool is(double probability) { return u() < probability; }
  double log_uniform(double low, double high) { return std::pow(10.0, u(low, high)); }
  double sign() { return is(.5) ? -1 : 1; }

  double radius() { return sign() * system_.scale * (is(.08) ? log_uniform(-3, 9) : log_uniform(-.3, 1.5)); }
  double conic_constant() {
    const double kind = u();
    if (kind < .2) return 0;
    if (kind < .3) return -1;
    if (kind < .45) return -1 + sign() * log_uniform(-15, -1);
    if (kind < .8) return u(-3, 1.2);
    if (kind < .95) return -1 + sign() * log_uniform(0, 3);
    return sign() * log_uniform(3, 8);
  }
  std::string zernike() {
    const double norm_radius = system_.beam_radius * (is(.1) ? log_uniform(-1, 3) : u(1, 6)), size = 1e3 * norm_radius * (is(.15) ? log_uniform(-2, 0) : log_uniform(-7, -2));
    std::map<int, double> terms;
    const int most = is(.1) ? 230 : is(.3) ? 90 : 28, count = 1 + static_cast<int>(u() * 8);  // orders to 20, 12 and 6
    for (int i = 0; i < count; ++i) terms[static_cast<int>(u() * most)] = size * u(-1, 1);
    std::string list;
    for (const auto& [index, um] : terms) list += fmt::format("{}{}: {}", list.empty() ? "" : ", ", index, um);
    const double R = radius(), K = conic_constant();
    const std::string base = is(.2) ? "" : fmt::format("radius_mm: {}, conic_constant: {}, ", R, K);
    return fmt::format("zernike: {{{}normalization_radius_mm: {}, indexing: osa, coefficients_um: {{{}}}}}", base, norm_radius, list);
  }
  // Of sums of powers: each term is at norm_radius as large as a Zernike term may be (and of numbers that the reader takes).
  struct Terms {
    double norm_radius, size;
    std::string list;
  };
  Terms terms(int first, int most, bool over_norm_radius) {
    Terms result{system_.beam_radius * (is(.1) ? log_uniform(-1, 3) : u(1, 6)), 0, {}};
    result.size = result.norm_radius * (is(.15) ? log_uniform(-2, 0) : log_uniform(-7, -2));
    std::map<int, double> of;
    const int count = 1 + static_cast<int>(u() * 6);
    for (int i = 0; i < count; ++i) of[first + static_cast<int>(u() * (most - first + 1))] = result.size * u(-1, 1);
    for (const auto& [index, mm] : of)
      result.list += fmt::format("{}{}: {}", result.list.empty() ? "" : ", ", index, over_norm_radius ? std::copysign(std::clamp(std::abs(mm) / std::pow(result.norm_radius, index), 1e-100, 1e100), mm) : mm);
    return result;
  }
  std::string straight_or(double radius) { return is(.1) ? ".inf" : fmt::format("{}", radius); }
  std::string asphere() {
    const double R = radius(), K = conic_constant();
    const std::string base = straight_or(R), powers = terms(2, is(.1) ? 40 : is(.4) ? 20 : 10, true).list;
    return fmt::format("asphere: {{radius_mm: {}, conic_constant: {}, coefficients: {{{}}}}}", base, K, powers);
  }
  // The sections' radii apart, more or less: a cornea, a saddle, a cylinder.
  double other_radius(double of) { return is(.3) ? radius() : of * (1 + sign() * log_uniform(-15, -.3)); }
  std::string biconic() {
    const double R = radius(), other = other_radius(R), K_x = conic_constant(), K_y = is(.3) ? K_x : conic_constant();
    const std::string x = straight_or(R), y = straight_or(other);
    return fmt::format("biconic: {{radius_x_mm: {}, radius_y_mm: {}, conic_constant_x: {}, conic_constant_y: {}}}", x, y, K_x, K_y);
  }
  std::string toroid() {
    const double R = radius(), other = other_radius(R), K = conic_constant();
    const std::string rotation = straight_or(R), curve = straight_or(other), powers = is(.5) ? "" : ", coefficients: {" + terms(2, is(.2) ? 20 : 8, true).list + "}";
    return fmt::format("toroid: {{radius_rotation_mm: {}, radius_mm: {}, conic_constant: {}{}}}", rotation, curve, K, powers);
  }
  std::string xy_polynomial() {
    const double R = radius(), K = conic_constant();
    const std::string base = is(.2) ? "" : fmt::format("radius_mm: {}, conic_constant: {}, ", R, K);
    const Terms of = terms(1, is(.1) ? 230 : is(.3) ? 65 : 20, false);
    return fmt::format("xy_polynomial: {{{}normalization_radius_mm: {}, coefficients: {{{}}}}}", base, of.norm_radius, of.list);
  }
  // A sphere with ripples, at places that are on a grid or strewn.
  std::string points(int number) {
    const double R = radius(), half = system_.beam_radius * u(1.5, 4), strewn = is(.3) ? 0 : .4, ripple = half * log_uniform(-6, -2);
    const int side = 5 + static_cast<int>(u() * 6);
    std::string text;
    for (int i = 0; i < side; ++i)
      for (int j = 0; j < side; ++j) {
        const double step = 2 * half / (side - 1), x = -half + (i + strewn * u(-1, 1)) * step, y = -half + (j + strewn * u(-1, 1)) * step;
        text += fmt::format("{} {} {}\n", x, y, (x * x + y * y) / (2 * R) + ripple * u(-1, 1));
      }
    const std::string file = fmt::format("points-{}.xyz", number);
    system_.points[file] = text;
    constexpr const char* interpolations[]{"linear", "c1", "cubic", "thin_plate", "multiquadric"};
    return fmt::format("delaunay: {{points: {}, format: xyz, interpolation: {}}}", file, interpolations[static_cast<int>(u() * 5)]);
  }
  // Waves, bumps and noise on a grid over the beam, with their slopes or without, on a base or on none; here and there a hole.
  std::string grid(int number) {
    const int count_x = 5 + static_cast<int>(u() * 5), count_y = 5 + static_cast<int>(u() * 5);
    const double half = system_.beam_radius * u(1.2, 5), hx = 2 * half / (count_x - 1), hy = hx * log_uniform(-.5, .5), size = half * (is(.15) ? log_uniform(-2, 0) : log_uniform(-7, -2));
    const double wave = half * log_uniform(-.7, .5), phase = u(0, 6.3), noise = is(.3) ? size * log_uniform(-4, 0) : 0;
    const bool has_slopes = is(.6), has_holes = is(.3);
    const double middle_x = is(.3) ? half * u(-.5, .5) : 0, middle_y = is(.3) ? half * u(-.5, .5) : 0;
    std::string text = fmt::format("{} {} {} {} 0 {} {}\n", count_x, count_y, hx, hy, middle_x, middle_y);
    for (int j = count_y - 1; j >= 0; --j)
      for (int i = 0; i < count_x; ++i) {
        const double x = (i - (count_x - 1) / 2.0) * hx / wave + phase, y = (j - (count_y - 1) / 2.0) * hy / wave;
        const double z = size * std::sin(x) * std::cos(y) + noise * u(-1, 1);
        const bool is_hole = has_holes && is(.1);
        if (has_slopes) text += fmt::format("{} {} {} {} {}\n", z, size / wave * std::cos(x) * std::cos(y), -size / wave * std::sin(x) * std::sin(y), -size / wave / wave * std::cos(x) * std::sin(y), is_hole ? 1 : 0);
        else text += is_hole ? "nan\n" : fmt::format("{}\n", z);
      }
    const std::string file = fmt::format("grid-{}.dat", number);
    system_.points[file] = text;
    const double R = radius(), K = conic_constant();
    return fmt::format("grid: {{points: {}{}}}", file, is(.3) ? "" : fmt::format(", radius_mm: {}, conic_constant: {}", straight_or(R), K));
  }
  std::string shape(int number) {
    if (has_points_ && is(.4)) return is(.5) ? grid(number) : points(number);
    const double kind = u();
    if (kind < .1) return "plane: {}";
    if (kind < .3) return fmt::format("conic: {{radius_mm: {}}}", radius());
    if (kind >= .95) return xy_polynomial();
    if (kind >= .9) return toroid();
    if (kind >= .85) return biconic();
    if (kind >= .75) return asphere();
    if (kind >= .6) return zernike();
    const double R = radius(), K = conic_constant();
    return fmt::format("conic: {{radius_mm: {}, conic_constant: {}}}", R, K);
  }
  // One after the other: a compiler may take the arguments of a call in any order.
  std::string three(double most, double most_of_last) {
    const double a = u(-most, most), b = u(-most, most), c = u(-most_of_last, most_of_last);
    return fmt::format("[{}, {}, {}]", a, b, c);
  }
  std::string moved() {
    std::string result;
    if (is(.2)) {
      const double size = is(.1) ? system_.scale * log_uniform(-9, 3) : system_.beam_radius * u(0, .5);
      result += fmt::format(", decenter_mm: {}", three(size, size));
    }
    if (is(.2)) {
      const double most = is(.15) ? 85 : 8;
      result += fmt::format(", tilt_deg: {}", three(most, 180));
    }
    return result;
  }
  std::string medium() {
    const double kind = u();
    if (kind < .1) {
      sense_ = -sense_;
      return "mirror";
    }
    if (gradients_.next()) return gradients_.medium(system_.scale, system_.beam_radius, index_, sense_);
    if (kind < .3) index_ = is(.5) ? index_ : 1;
    else if (kind < .42) index_ *= 1 + sign() * log_uniform(-14, -2);
    else index_ = kind < .46 ? log_uniform(-1, 1) : u(1, 1.9);
    index_ = std::clamp(index_, .01, 100.0);
    return fmt::format("{{index: {}}}", index_);
  }
  std::string surface(bool is_stop, int number) {
    std::string text = is_stop ? "stop: true, " : "";
    text += is(.08) ? "plane: {}" : shape(number);
    text += ", medium: " + medium();
    const double gap = is(.03) ? 0 : is(.06) ? sign() * log_uniform(-9, 4) : sense_ * log_uniform(-2, .2);
    text += fmt::format(", thickness_mm: {}", gap * system_.scale);
    text += moved();
    if (is(.08)) text += fmt::format(", semi_diameter_mm: {}", system_.beam_radius * log_uniform(-.3, 1.5));
    if (is(.03)) text += fmt::format(", inner_semi_diameter_mm: {}", system_.beam_radius * log_uniform(-6, -.3));
    return "  - {" + text + "}\n";
  }

  Uniform u;
  WildGradients gradients_;
  WildSystem system_;
  double index_ = 1, object_index_ = 1, sense_ = 1;
  bool has_points_ = false;
};

}  // namespace sagitta::test
