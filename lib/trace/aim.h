// SPDX-License-Identifier: Apache-2.0
// Real ray aiming: which point q of the launch's pupil (launch.h; not confined to its disc) sends a ray to a given point of the stop.
//
//   S(q) = p,   S the ray's place on the stop surface, in its own local x and y, in units of the stop's semi-diameter        (1)
//
// A pupil point p then stands for the place p on the stop, decentred, tilted and curved as that may be, at the ray's own wavelength. Nothing is clipped on the way, and what
// the stop itself does to the ray (refraction, reflection) comes behind.
//
// How (1) is solved, for one field and wavelength:
//   the centre     from the field on the axis outwards in steps of some 5 degrees (continuation), each from the two before: where the real pupil is far from the
//                  paraxial one, at 80 degrees say, no other beginning finds it; each by damped Newton (plane_search.h)
//   some points    over the stop, on rings from the centre outwards, likewise
//   the fit        q(p), polynomials of degree 8 through these (Zernike terms by quadrature that is exact for them, as polynomials)
//   every ray      q from the fit, then the chord method with the fit's own slopes
//                    q' = q - Q(p) (S(q) - p),   Q = dq/dp of the fit                                                         (2)
//                  until |S(q) - p| <= 1e-9 in each component, and once more. Where the slopes are off by e of themselves each step leaves e of the miss: e is what the
//                  last step left, and the next must leave 1e-12
// Where some of the points cannot be reached there is no fit, and the nearest point that was gives q and its slopes. A ray that (2) does not bring nearer by a half each time goes by
// damped Newton from there. One that is not found so is lost: not_converged, at the stop. That is no proof that there is none.
//
// Error: of the place on the stop 1e-9 of its semi-diameter at most before the last step of (2), which leaves what the tracer's rounding does: some 10 ulps of the distances on the way,
// 1e-14 mm in an eye, which is 1e-14 of its pupil. (In a gradient-index medium the rays that are meant are those that the tracer integrates.) Behind flat facets S jumps; there many points of the stop are met by no ray.
//
// One ray's result depends on nothing but the ray, its field and its wavelength: the same bits for any number of threads and rays.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lib/scene/scene.h"
#include "lib/trace/plane_search.h"

namespace sagitta::trace {

// What the launch takes in place of points of the stop. A ray that was not found has some place near the chief ray's.
struct AimedPupil {
  std::vector<PupilPoint> points;
  std::vector<bool> found;
  std::int64_t passes = 0;  // rays traced to the stop for it
};

class Aim {
 public:
  // The scene and the wavelength outlive it.
  Aim(const scene::Scene& scene, const scene::Field& field, const scene::Wavelength& wavelength);

  AimedPupil at(std::span<const PupilPoint> stop_points, int thread_count = 1) const;
  std::int64_t passes_before() const { return passes_before_; }  // rays traced to the stop to make it

 private:
  // The rays' places on the stop, NaN of those that do not come there; of rays of the field, or of one that is nearer to the axis.
  std::vector<PupilPoint> landings(const scene::Field& field, std::span<const PupilPoint> starts) const;
  // How many rays it took; so with the others.
  std::int64_t search(const scene::Field& field, std::span<PlaneSearch> all) const;
  // The field at the share t of its angle.
  scene::Field part_of_field(double t) const;
  std::int64_t search_from_axis(PlaneSearch& one) const;
  std::int64_t find_samples();
  void make_fit();
  struct Beginning {
    PupilPoint start;
    PlaneSlopes slopes;  // dq/dp there
  };
  Beginning from_fit(const PupilPoint& target) const;
  Beginning from_nearest(const PupilPoint& target) const;  // of no number where no sample was found
  std::int64_t aim_by_chords(std::span<const PupilPoint> targets, std::span<PupilPoint> starts, std::span<char> found) const;
  std::int64_t aim_by_newton(std::span<const PupilPoint> targets, std::span<PupilPoint> starts, std::span<char> found) const;

  const scene::Wavelength& wavelength_;
  scene::Field field_;
  scene::Scene front_;  // up to the stop, which ends rays; without apertures
  double angle_ = 0;    // of the field's chief ray, paraxially
  std::vector<PlaneSearch> samples_;  // the centre, then ring by ring
  std::vector<double> fit_x_, fit_y_;           // coefficients; none where there is no fit
  std::int64_t passes_before_ = 0;
};

}  // namespace sagitta::trace
