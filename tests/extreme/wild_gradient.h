// SPDX-License-Identifier: Apache-2.0
// Random gradient-index media as text, of every form, from those that hardly bend a ray to those in which it turns back, circles or leaves. They have a random sequence of
// their own: the systems without one are what they are without this file.
#pragma once

#include <fmt/core.h>

#include <cmath>
#include <string>

#include "tests/support/point_sets.h"

namespace sagitta::test {

class WildGradients {
 public:
  explicit WildGradients(std::uint64_t seed) : u(0x6a09e667f3bcc909u * (seed + 1)) {
    u(), u();
    has_some_ = u() < .03;
  }

  // Whether there may be any in this system.
  bool has_some() const { return has_some_; }
  // Whether the next gap has one.
  bool next() { return has_some_ && u() < .4; }
  // In a system of this scale (mm), behind a medium of this index, for light that travels so.
  std::string medium(double scale, double beam_radius, double index, double sense) {
    constexpr std::string (WildGradients::*forms[])(){&WildGradients::polynomial, &WildGradients::selfoc, &WildGradients::quadratic, &WildGradients::luneburg, &WildGradients::maxwell};
    scale_ = scale, beam_radius_ = beam_radius, sense_ = sense;
    index_ = u() < .4 && index >= .1 && index <= 10 ? index : u(1.2, 1.7);
    const auto form = static_cast<std::size_t>(u() * 5);
    return "{grin: {" + (this->*forms[form])() + "}}";
  }

 private:
  double log_uniform(double low, double high) { return std::pow(10.0, u(low, high)); }
  double sign() { return u() < .5 ? -1 : 1; }
  // By how much the index changes over the scale: an eye's lens, or a hundred times that.
  double change() { return u() < .7 ? log_uniform(-6, -1.2) : log_uniform(-1.2, .8); }

  std::string polynomial() {
    const double across = u() < .5 ? scale_ : 5 * beam_radius_;
    std::string along_terms, across_terms;
    const int along = static_cast<int>(u() * 4), rings = static_cast<int>(u() * 4);
    double power = 1;
    for (int i = 1; i <= along; ++i) {
      power *= scale_;
      const double a = change() * sign() / i;
      along_terms += fmt::format("{}{}: {}", i > 1 ? ", " : "", i, a / power);
    }
    power = 1;
    for (int k = 1; k <= rings; ++k) {
      power *= across * across;
      const double b = change() * sign() / k;
      across_terms += fmt::format("{}{}: {}", k > 1 ? ", " : "", 2 * k, b / power);
    }
    return fmt::format("polynomial: {{index: {}, z_coefficients: {{{}}}, r_coefficients: {{{}}}}}", index_, along_terms, across_terms);
  }
  std::string selfoc() {
    const double g = u() < .8 ? log_uniform(-2, .7) : log_uniform(.7, 2);  // some 16 pitches
    return fmt::format("selfoc: {{index: {}, g_per_mm: {}}}", index_, g / scale_);
  }
  std::string quadratic() {
    std::string text = fmt::format("quadratic: {{index: {}", index_);
    for (const char* axis : {"x", "y", "z"}) {
      const double linear = change() * sign(), square = change() * sign();
      text += fmt::format(", {0}_per_mm: {1}, {0}2_per_mm2: {2}", axis, linear / scale_, square / (scale_ * scale_));
    }
    return text + "}";
  }
  std::string luneburg() {
    const double radius = scale_ * log_uniform(-.3, 1), centre = sense_ * radius * u(0, 1.2);
    return fmt::format("luneburg: {{index: {}, radius_mm: {}, center_z_mm: {}}}", index_, radius, centre);
  }
  std::string maxwell() {
    const double radius = scale_ * log_uniform(-.3, 1), centre = sense_ * radius * u(0, 1.2), at_centre = index_ * u(1, 2);
    return fmt::format("maxwell: {{index: {}, radius_mm: {}, center_z_mm: {}}}", at_centre, radius, centre);
  }

  tests::Uniform u;
  double scale_ = 1, beam_radius_ = 1, index_ = 1, sense_ = 1;
  bool has_some_ = false;
};

}  // namespace sagitta::test
