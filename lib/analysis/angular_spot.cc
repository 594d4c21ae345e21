// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/angular_spot.h"

#include <algorithm>
#include <cmath>

#include "lib/numerics/instruction_set.h"
#include "lib/numerics/lanes.h"

namespace sagitta::analysis {
namespace {

using numerics::Vec3;

// Across c, near +x where c is near the axis.
Vec3<double> across(const Vec3<double>& c) {
  const Vec3<double> x = std::abs(c.x) < 0.9 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 0, 1};
  return normalized(x - dot(x, c) * c);
}

}  // namespace

AngularSpotCollector::AngularSpotCollector(const Vec3<double>& nodal_point, const Vec3<double>& centre)
    : nodal_point_(nodal_point), forward_(normalized(centre - nodal_point)), right_(across(forward_)), up_(cross(forward_, right_)), chords_(SpotImage(0, 1, 0, 0)) {}

// (1), of one point or of several in a vector.
template <class T>
AngularSpotCollector::Chord<T> AngularSpotCollector::chord_of(const T& x, const T& y, const T& z) const {
  using std::sqrt;
  const T vx = x - T(nodal_point_.x), vy = y - T(nodal_point_.y), vz = z - T(nodal_point_.z);
  const auto along = [&](const Vec3<double>& axis) { return vx * T(axis.x) + vy * T(axis.y) + vz * T(axis.z); };
  const T r = sqrt(vx * vx + vy * vy + vz * vz), scale = sqrt(T(2) / (r * (r + along(forward_))));
  return {along(right_) * scale, along(up_) * scale};
}

void AngularSpotCollector::add(const trace::RayBatch& rays) {
  constexpr std::size_t block_size = 256;
  double a[block_size], b[block_size];
  std::int32_t ended[block_size];
  for (std::size_t from = 0; from < rays.size(); from += block_size) {
    const std::size_t count = std::min(block_size, rays.size() - from);
    const double *x = &rays.x[from], *y = &rays.y[from], *z = &rays.z[from];
    numerics::with_chosen_instructions_flat([&]<int n>() {
      using Vector = numerics::Lanes<n>;
      std::size_t i = 0;
      for (; i + n <= count; i += n) {
        const auto chord = chord_of(Vector::load(x + i), Vector::load(y + i), Vector::load(z + i));
        chord.a.store(a + i), chord.b.store(b + i);
      }
      for (; i < count; ++i) {
        const auto chord = chord_of(x[i], y[i], z[i]);
        a[i] = chord.a, b[i] = chord.b;
      }
    });
    for (std::size_t i = 0; i < count; ++i) {
      const bool has_angle = a[i] * a[i] + b[i] * b[i] < 8;  // not at the nodal point
      ended[i] = has_angle ? rays.ended[from + i] : trace::ending(1, surface::Status::missed);
    }
    chords_.add(a, b, ended, count);
  }
}

AngularSpot AngularSpotCollector::spot(const numerics::Rotation<double>& global_from_local) const {
  const Spot chords = chords_.spot();
  const double square = chords.centroid_x * chords.centroid_x + chords.centroid_y * chords.centroid_y;
  const Vec3<double> local = (1 - square / 2) * forward_ + std::sqrt(1 - square / 4) * (chords.centroid_x * right_ + chords.centroid_y * up_);
  const Vec3<double> d = global_from_local * local;
  return {std::atan(d.x / d.z), std::atan(d.y / d.z), chords.rms_radius, chords.geometric_radius};
}

}  // namespace sagitta::analysis
