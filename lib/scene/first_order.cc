// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/first_order.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sagitta::scene {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// A paraxial ray (y, V) at some z, with the size of the terms that made y (the largest so far) and V (their sum). What is
// below their rounding is zero: else an afocal system would have a focal length of 1e17 mm.
struct ParaxialRay {
  double y, v;
  double y_terms = std::abs(y), v_terms = std::abs(v);

  double height() const { return significant(y, y_terms); }
  double slope() const { return significant(v, v_terms); }

 private:
  static double significant(double value, double terms) {
    return std::abs(value) <= 16 * std::numeric_limits<double>::epsilon() * terms ? 0 : value;
  }
};

// The indices of the gaps with the sign of the direction of travel.
std::vector<double> signed_indices(const Scene& scene, const Wavelength& wavelength) {
  std::vector<double> result = wavelength.index;
  double direction = 1;
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
    if (scene.surfaces[i].mirror) direction = -direction;
    result[i + 1] *= direction;
  }
  return result;
}

class Paraxial {
 public:
  Paraxial(const Scene& scene, const Wavelength& wavelength) : scene_(scene), index_(signed_indices(scene, wavelength)) {}

  double index(int gap) const { return index_[static_cast<std::size_t>(gap)]; }
  bool acts(int number) const { return !scene_.surface(number).image && index(number) != index(number - 1); }

  // (1), from just before surface `first` to just behind surface `last`.
  ParaxialRay through(ParaxialRay ray, int first, int last) const {
    for (int i = first; i <= last; ++i) {
      if (i > first) ray = transferred(ray, i);
      if (scene_.surface(i).image) continue;
      const double power = (index(i) - index(i - 1)) * scene_.surface(i).vertex_curvature;
      ray.v -= power * ray.y;
      ray.v_terms += std::abs(power) * ray.y_terms;
    }
    return ray;
  }
  // The same, to the plane of surface `last`, just before it.
  ParaxialRay up_to(ParaxialRay ray, int first, int last) const {
    if (last == first) return ray;
    return transferred(through(ray, first, last - 1), last);
  }

 private:
  ParaxialRay transferred(ParaxialRay ray, int to) const {
    const double rise = (scene_.surface(to).axis_z - scene_.surface(to - 1).axis_z) / index(to - 1) * ray.v;
    return {ray.y + rise, ray.v, std::max(ray.y_terms, std::abs(ray.y) + std::abs(rise)), ray.v_terms};
  }

  const Scene& scene_;
  std::vector<double> index_;
};

// Where a ray with (y, V) at z = 0 crosses the axis in a medium of index n; infinite if it never does.
double crossing(const ParaxialRay& ray, double index) {
  return ray.slope() == 0 ? infinity : -index * ray.y / ray.slope();
}

}  // namespace

FirstOrder first_order(const Scene& scene, const Wavelength& wavelength, double entrance_pupil_semi_diameter) {
  const Paraxial paraxial(scene, wavelength);
  int last = scene.surface_count() - 1;  // the last acting surface
  while (last > 1 && !paraxial.acts(last)) --last;
  const double n = paraxial.index(0), n_after = paraxial.index(last);
  const double z_first = scene.surface(1).axis_z, z_last = scene.surface(last).axis_z;

  FirstOrder result{};
  const ParaxialRay parallel = paraxial.through({1, 0}, 1, last);  // (a, -P)
  const ParaxialRay central = paraxial.through({0, 1}, 1, last);   // (b, d)
  result.power = -parallel.slope();
  // 1/0 = infinity marks what an afocal system does not have.
  result.effective_focal_length = 1 / result.power;
  result.front_focal_length = -n / result.power;
  result.rear_focal_length = n_after / result.power;
  result.back_focal_length = crossing(parallel, n_after);
  result.rear_focal_point = z_last + result.back_focal_length;
  result.front_focal_point = z_first - n * central.v / result.power;
  result.rear_principal_point = result.rear_focal_point - n_after / result.power;
  result.front_principal_point = result.front_focal_point + n / result.power;
  result.rear_nodal_point = result.rear_focal_point - n / result.power;
  result.front_nodal_point = result.front_focal_point + n_after / result.power;

  // Entrance pupil: the stop's height is A y + B V; its centre is seen where A (-z V/n) + B V = 0.
  const double A = paraxial.up_to({1, 0}, 1, scene.stop).height(), B = paraxial.up_to({0, 1}, 1, scene.stop).y;
  result.entrance_pupil.z = A == 0 ? infinity : z_first + n * B / A;
  result.entrance_pupil.magnification = 1 / A;
  result.entrance_pupil.semi_diameter = entrance_pupil_semi_diameter;

  // Exit pupil: through the stop's own refraction and all behind it.
  const int from = scene.stop, to = last < from ? from : last;
  const ParaxialRay through_centre = paraxial.through({0, 1}, from, to);
  const double z_to = scene.surface(to).axis_z;
  result.exit_pupil.z = z_to + crossing(through_centre, paraxial.index(to));
  result.exit_pupil.magnification = 1 / through_centre.slope();
  result.exit_pupil.semi_diameter = std::abs(entrance_pupil_semi_diameter * A * result.exit_pupil.magnification);

  const ParaxialRay axial = scene.object.at_infinity()
                                ? parallel
                                : paraxial.through({(z_first - scene.object.z) / n, 1}, 1, last);
  result.image_z = z_last + crossing(axial, n_after);
  return result;
}

double marginal_height(const Scene& scene, const Wavelength& wavelength, const Pupil& entrance_pupil, int surface_number) {
  const Paraxial paraxial(scene, wavelength);
  ParaxialRay ray{entrance_pupil.semi_diameter, 0};
  if (!scene.object.at_infinity()) {
    const double slope = entrance_pupil.semi_diameter / (entrance_pupil.z - scene.object.z);
    ray = {slope * (scene.surface(1).axis_z - scene.object.z), slope * paraxial.index(0)};
  }
  return std::abs(paraxial.up_to(ray, 1, surface_number).y);
}

}  // namespace sagitta::scene
