// SPDX-License-Identifier: Apache-2.0
// Colour maps that are perceptually even by construction: paths of constant speed in OKLab.
//
// sequential  from dark blue-violet over teal and green to light yellow. In the plane (a, b) a quadratic Bezier curve,
//             run through at constant speed; the lightness L grows evenly along it. So both L and the distance
//             dE = |(dL, da, db)| are the same from step to step.
// diverging   for signed quantities, zero in the middle: two straight lines from a near white, one to blue (negative)
//             and one to orange-red (positive), of the same lightness and chroma at the same |value|.
//
// OKLab to linear sRGB: B. Ottosson, "A perceptual color space for image processing" (2020),
// https://bottosson.github.io/posts/oklab/. Linear to encoded sRGB: IEC 61966-2-1.
#pragma once

#include <array>
#include <cstdint>

namespace sagitta::output {

enum class ColorMap { sequential, diverging };

using Rgb8 = std::array<std::uint8_t, 3>;  // encoded sRGB

struct Oklab {
  double lightness = 0, a = 0, b = 0;
};

// The colour of t in [0, 1]; beyond, that of the nearer end. t must not be NaN.
Oklab oklab_color(ColorMap map, double t);

// The same in encoded sRGB, every component the nearest of 0 to 255; NaN, "no data", is a neutral grey.
Rgb8 exact_color(ColorMap map, double t);
// The same from a table, for pictures: no component is off by more than 1.
Rgb8 color(ColorMap map, double t);
inline constexpr Rgb8 no_data_color{217, 217, 217};

std::array<double, 3> linear_srgb(const Oklab& color);  // components in [0, 1] where the colour is in gamut
double linear_from_srgb(double encoded);                // both on [0, 1]
double srgb_from_linear(double linear);

}  // namespace sagitta::output
