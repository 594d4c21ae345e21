// SPDX-License-Identifier: Apache-2.0
#include "lib/trace/fields.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lib/scene/first_order.h"
#include "lib/trace/launch.h"
#include "lib/trace/trace.h"

namespace sagitta::trace {
namespace {

using scene::Section;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

scene::FirstOrder paraxial(const scene::Scene& scene, Section section) { return scene::first_order(scene, scene.primary, 1, section); }

Fields scaled(std::span<const PupilPoint> points, bool are_heights, double x_scale, double y_scale) {
  Fields fields;
  for (const PupilPoint& point : points) {
    const scene::Field field{are_heights, point.x * x_scale + 0.0, point.y * y_scale + 0.0};  // no -0
    fields.push_back(std::isfinite(field.x) && std::isfinite(field.y) ? std::optional(field) : std::nullopt);
  }
  return fields;
}

// The search for one place of the image surface.
class ImagePlace {
 public:
  // One unit of a field, a tangent or a mm of the object, is `per_field` mm of the image, or about so much.
  ImagePlace(const scene::Scene& open, const PupilPoint& place, double per_field)
      : scene_(open), place_(place), size_(std::hypot(place.x, place.y)), unit_(std::isfinite(per_field) && per_field != 0 && size_ > 0 ? size_ / std::abs(per_field) : 1) {
    if (!(size_ > 0)) size_ = 1;
  }

  std::optional<scene::Field> field() const {
    constexpr double first_part = 1.0 / 4, least_part = 1.0 / 512;
    constexpr double good_enough = 1e-9;
    PlaneSearch search;
    const auto find = [&](double t, const PupilPoint& start) {
      search.target = {t * place_.x / size_, t * place_.y / size_}, search.place = start;
      search_plane([&](const std::vector<PupilPoint>& starts) { return images(starts); }, std::span(&search, 1));
      return search.miss() <= good_enough;
    };
    if (!find(0, {})) return std::nullopt;
    PupilPoint last = search.place;
    double t_last = 0;
    for (double part = first_part; t_last < 1 && part >= least_part;) {
      const double t = std::min(1.0, t_last + part);
      if (find(t, last)) last = search.place, t_last = t;
      else part /= 2;
    }
    return t_last == 1 ? std::optional(field_at(last)) : std::nullopt;
  }

 private:
  // v: an angle vector, or an object height in units.
  scene::Field field_at(const PupilPoint& v) const {
    if (!scene_.object.at_infinity()) return {true, unit_ * v.x, unit_ * v.y};
    const double angle = std::hypot(v.x, v.y), share = angle > 0 ? std::tan(angle) / angle : 1;
    return {false, share * v.x, share * v.y};
  }
  // In units of the place's distance.
  std::vector<PupilPoint> images(const std::vector<PupilPoint>& starts) const {
    std::vector<PupilPoint> result;
    for (const PupilPoint& v : starts) {
      result.push_back({nan, nan});
      const double length = std::hypot(v.x, v.y);
      if (!(length < (scene_.object.at_infinity() ? std::numbers::pi / 2 : 1e9))) continue;
      RayBatch chief = launch(scene_, field_at(v), scene_.primary, std::vector<PupilPoint>{{0, 0}}, false);
      trace(scene_, scene_.primary, chief);
      if (chief.ended[0] == 0) result.back() = {chief.x[0] / size_, chief.y[0] / size_};
    }
    return result;
  }

  const scene::Scene& scene_;
  PupilPoint place_;
  double size_, unit_;  // mm of the image; mm of the object
};

}  // namespace

Fields fields_of_visual_angles(const scene::Scene& scene, std::span<const PupilPoint> tangents) {
  if (scene.object.at_infinity()) return scaled(tangents, false, 1, 1);
  const auto scale = [&](Section section) { return scene.object.z - paraxial(scene, section).front_nodal_point; };
  return scaled(tangents, true, scale(Section::x), scale(Section::y));
}

Fields fields_of_paraxial_images(const scene::Scene& scene, std::span<const PupilPoint> heights) {
  const auto scale = [&](Section section) {
    const double s = paraxial(scene, section).image_scale;
    return std::isfinite(s) ? 1 / s : nan;
  };
  return scaled(heights, !scene.object.at_infinity(), scale(Section::x), scale(Section::y));
}

Fields fields_of_real_images(const scene::Scene& scene, std::span<const PupilPoint> places) {
  scene::Scene open = scene;
  for (scene::Surface& surface : open.surfaces) surface.semi_diameter = std::numeric_limits<double>::infinity(), surface.inner_semi_diameter = 0;
  const double per_field = paraxial(scene, Section::y).image_scale;
  Fields fields;
  for (const PupilPoint& place : places) fields.push_back(ImagePlace(open, place, per_field).field());
  return fields;
}

}  // namespace sagitta::trace
