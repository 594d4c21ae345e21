// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/first_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "lib/gradient_index/paraxial.h"

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

// A gap along the axis. Indices have the sign of the direction of travel.
struct AxialGap {
  double index_start, index_end;                          // behind the surface before it, before the surface behind it
  std::optional<gradient_index::ParaxialTransfer> curved{};  // in a gradient
};

std::vector<AxialGap> axial_gaps(const Scene& scene, const Wavelength& wavelength) {
  std::vector<AxialGap> gaps{{wavelength.index.front(), wavelength.index.front()}};
  double direction = 1;
  for (int number = 1; number <= scene.surface_count(); ++number) {
    if (scene.surface(number).mirror) direction = -direction;
    const double index = direction * wavelength.index[static_cast<std::size_t>(number)];
    gaps.push_back({index, index});
    const GradientGap* gradient = wavelength.gradient(number);
    if (!gradient) continue;
    const double thickness = scene.surface(number + 1).axis_z - scene.surface(number).axis_z;
    const auto transfer = paraxial_transfer(gradient->form, gradient->axial_shift, thickness, direction);
    gaps.back() = {direction * transfer.index_start, direction * transfer.index_end, transfer};
  }
  return gaps;
}

class Paraxial {
 public:
  Paraxial(const Scene& scene, const Wavelength& wavelength, Section section = Section::y) : scene_(scene), section_(section), gaps_(axial_gaps(scene, wavelength)) {}

  double index_before(int number) const { return gap(number - 1).index_end; }
  double index_behind(int number) const { return scene_.surface(number).image ? index_before(number) : gap(number).index_start; }
  // The last one that turns rays or ends a gap in which they are turned.
  int last_acting() const {
    int last = scene_.surface_count();
    while (last > 1 && index_behind(last) == index_before(last) && !gap(last - 1).curved) --last;
    return last;
  }

  // (1), from just before surface `first` to just behind surface `last`.
  ParaxialRay through(ParaxialRay ray, int first, int last) const {
    for (int i = first; i <= last; ++i) {
      if (i > first) ray = transferred(ray, i);
      if (scene_.surface(i).image) continue;
      const double power = (index_behind(i) - index_before(i)) * curvature(i);
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
  double curvature(int number) const { return section_ == Section::y ? scene_.surface(number).vertex_curvature : scene_.surface(number).vertex_curvature_x; }
  const AxialGap& gap(int number) const { return gaps_[static_cast<std::size_t>(number)]; }
  ParaxialRay transferred(ParaxialRay ray, int to) const {
    if (const auto& by = gap(to - 1).curved) {
      const double y_terms = std::abs(by->y_y) * ray.y_terms + std::abs(by->y_v) * ray.v_terms, v_terms = std::abs(by->v_y) * ray.y_terms + std::abs(by->v_v) * ray.v_terms;
      return {by->y_y * ray.y + by->y_v * ray.v, by->v_y * ray.y + by->v_v * ray.v, y_terms, v_terms};
    }
    const double rise = (scene_.surface(to).axis_z - scene_.surface(to - 1).axis_z) / index_before(to) * ray.v;
    return {ray.y + rise, ray.v, std::max(ray.y_terms, std::abs(ray.y) + std::abs(rise)), ray.v_terms};
  }

  const Scene& scene_;
  Section section_;
  std::vector<AxialGap> gaps_;
};

// Where a ray with (y, V) at z = 0 crosses the axis in a medium of index n; infinite if it never does.
double crossing(const ParaxialRay& ray, double index) {
  return ray.slope() == 0 ? infinity : -index * ray.y / ray.slope();
}

}  // namespace

FirstOrder first_order(const Scene& scene, const Wavelength& wavelength, double entrance_pupil_semi_diameter, Section section) {
  const Paraxial paraxial(scene, wavelength, section);
  const int last = paraxial.last_acting();
  const double n = paraxial.index_before(1), n_after = paraxial.index_behind(last);
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
  result.exit_pupil.z = z_to + crossing(through_centre, paraxial.index_behind(to));
  result.exit_pupil.magnification = 1 / through_centre.slope();
  result.exit_pupil.semi_diameter = std::abs(entrance_pupil_semi_diameter * A * result.exit_pupil.magnification);

  const ParaxialRay axial = scene.object.at_infinity()
                                ? parallel
                                : paraxial.through({(z_first - scene.object.z) / n, 1}, 1, last);
  result.image_z = z_last + crossing(axial, n_after);
  result.image_scale = scene.object.at_infinity() ? n / result.power : 1 / axial.slope();
  return result;
}

double marginal_height(const Scene& scene, const Wavelength& wavelength, const Pupil& entrance_pupil, int surface_number) {
  if (!scene.object.at_infinity()) return height_from_object(scene, wavelength, entrance_pupil.semi_diameter / (entrance_pupil.z - scene.object.z), surface_number);
  return std::abs(Paraxial(scene, wavelength).up_to({entrance_pupil.semi_diameter, 0}, 1, surface_number).y);
}

double height_from_object(const Scene& scene, const Wavelength& wavelength, double tangent, int surface_number) {
  const Paraxial paraxial(scene, wavelength);
  return std::abs(paraxial.up_to({tangent * (scene.surface(1).axis_z - scene.object.z), tangent * paraxial.index_before(1)}, 1, surface_number).y);
}

}  // namespace sagitta::scene
