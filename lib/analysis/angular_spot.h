// SPDX-License-Identifier: Apache-2.0
// The spot of a field and wavelength as angles, seen from the rear nodal point N' on the axis: on a retina or another curved image surface
// x and y alone are a spot's shadow, and an angle at N' is, paraxially, the angle in object space.
//
// With v = P - N' of a ray's image point P and the orthonormal (right, up, c), c towards a provisional centre of the spot:
//   (a, b) = (v.right, v.up) sqrt(2/(r (r + v.c))),  r = |v|                                                       (1)
// Lambert's azimuthal map: |(a, b)| is the chord 2 sin(theta/2) of the angle theta between v and c. Centroid and radii are those of
// spot.h in (a, b), taken as radians: a chord differs from its angle by theta^2/24, .002 % of 1.3 degrees, distances in a spot that
// wide by as little. The direction of the centroid is given as fields are: d ~ (tan ax, tan ay, 1), global.
//
// Source: J. P. Snyder, Map Projections, USGS Professional Paper 1395 (1987), p. 185.
#pragma once

#include "lib/analysis/spot.h"
#include "lib/numerics/rigid_transform.h"

namespace sagitta::analysis {

// In radians; NaN where no ray arrived but at the nodal point itself.
struct AngularSpot {
  double centroid_x = 0, centroid_y = 0;  // ax, ay
  double rms_radius = 0, geometric_radius = 0;
};

class AngularSpotCollector {
 public:
  // Both in the image surface's frame.
  AngularSpotCollector(const numerics::Vec3<double>& nodal_point, const numerics::Vec3<double>& centre);

  void add(const trace::RayBatch& rays);
  AngularSpot spot(const numerics::Rotation<double>& global_from_local) const;

 private:
  template <class T>
  struct Chord {
    T a, b;
  };
  template <class T>
  Chord<T> chord_of(const T& x, const T& y, const T& z) const;

  numerics::Vec3<double> nodal_point_, forward_, right_, up_;
  SpotCollector chords_;
};

}  // namespace sagitta::analysis
