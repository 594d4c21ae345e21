// SPDX-License-Identifier: Apache-2.0
#include "lib/trace/aim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "lib/numerics/parallel.h"
#include "lib/numerics/zernike_polynomial.h"
#include "lib/trace/launch.h"
#include "lib/trace/pattern.h"
#include "lib/trace/trace.h"

namespace sagitta::trace {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// The fit: degree 8, so that its terms' squares have the degree 8 in u = r^2. Gauss' nodes in u, 5 of them, are exact to degree 9, evenly spaced azimuths to
// one less than their number.
constexpr int degree = 8, azimuths = 2 * degree + 2, terms = (degree + 1) * (degree + 2) / 2;
struct Ring {
  double u, weight;  // weights add up to 1
};
constexpr std::array<Ring, 5> rings{{{0.04691007703066800, 0.11846344252809454},
                                     {0.23076534494715845, 0.23931433524968324},
                                     {0.5, 0.28444444444444444},
                                     {0.76923465505284155, 0.23931433524968324},
                                     {0.95308992296933200, 0.11846344252809454}}};
constexpr std::size_t sample_count = 1 + rings.size() * azimuths;
constexpr std::size_t place_of(std::size_t ring, std::size_t azimuth) { return 1 + ring * azimuths + azimuth; }

// Continuation in the field's angle.
constexpr double first_part = 5 * std::numbers::pi / 180, least_part = 1.0 / 128;  // rad; of the first

// What a launched ray's numbers stand.
constexpr double farthest = 1e9;

// Chords that shorten the miss by less give way to Newton's method.
constexpr int most_chords = 12;

// Of the place on the stop, in units of its semi-diameter.
constexpr double tolerance = 1e-9;

constexpr std::size_t batch_size = 1024;

scene::Scene up_to_stop(const scene::Scene& scene) {
  scene::Scene front;
  front.surfaces.assign(scene.surfaces.begin(), scene.surfaces.begin() + scene.stop);
  for (scene::Surface& surface : front.surfaces) surface.semi_diameter = std::numeric_limits<double>::infinity(), surface.inner_semi_diameter = 0;
  front.surfaces.back().image = true;
  front.object = scene.object, front.pupil = scene.pupil, front.stop = scene.stop, front.tolerance = scene.tolerance;
  return front;
}

double distance(const PupilPoint& a, const PupilPoint& b) { return std::hypot(a.x - b.x, a.y - b.y); }

bool is_found(const PlaneSearch& one) { return one.miss() <= tolerance; }

double angle_of(const scene::Scene& scene, const scene::Field& field) {
  const double across = std::hypot(field.x, field.y);
  if (!field.is_height) return std::atan(across);
  return scene.pupil.telecentric ? 0 : std::atan(across / std::abs(scene.pupil.z - scene.object.z));
}

}  // namespace

Aim::Aim(const scene::Scene& scene, const scene::Field& field, const scene::Wavelength& wavelength)
    : wavelength_(wavelength), field_(field), front_(up_to_stop(scene)), angle_(angle_of(scene, field)) {
  passes_before_ = find_samples();
  make_fit();
}

std::vector<PupilPoint> Aim::landings(const scene::Field& field, std::span<const PupilPoint> starts) const {
  const auto is_start = [](const PupilPoint& q) { return std::abs(q.x) <= farthest && std::abs(q.y) <= farthest; };
  std::vector<PupilPoint> safe(starts.begin(), starts.end());
  for (PupilPoint& q : safe)
    if (!is_start(q)) q = {};
  RayBatch rays = launch(front_, field, wavelength_.index.front(), safe, false);
  trace(front_, wavelength_, rays);
  const double per_radius = 1 / front_.pupil.stop_semi_diameter;
  std::vector<PupilPoint> places(starts.size(), {nan, nan});
  for (std::size_t i = 0; i < places.size(); ++i)
    if (rays.ended[i] == 0 && is_start(starts[i])) places[i] = {per_radius * rays.x[i], per_radius * rays.y[i]};
  return places;
}

std::int64_t Aim::search(const scene::Field& field, std::span<PlaneSearch> all) const {
  std::int64_t passes = 0;
  const auto map = [&](const std::vector<PupilPoint>& starts) {
    passes += static_cast<std::int64_t>(starts.size());
    return landings(field, starts);
  };
  search_plane(map, all);
  return passes;
}

scene::Field Aim::part_of_field(double t) const {
  const double share = t == 1 ? 1 : angle_ > 0 ? std::tan(t * angle_) / std::tan(angle_) : t;
  return {field_.is_height, share * field_.x, share * field_.y};
}

// In u = q cos(angle), for where the real pupil lies at a distance z from the paraxial one, q is z tan(angle): each next start lies on the line through the last two.
// (The map may be folded at large angles; from farther away the search ends on another branch of it.)
std::int64_t Aim::search_from_axis(PlaneSearch& one) const {
  const auto cosine = [&](double t) { return std::cos(t * angle_); };
  std::int64_t passes = 0;
  const auto look = [&](double t, const PupilPoint& u) {
    one.place = {u.x / cosine(t), u.y / cosine(t)};
    passes += search(part_of_field(t), {&one, 1});
    return is_found(one);
  };
  const auto begin_anywhere = [&](double t) {  // nearest to the target of many, far beyond the pupil too
    std::vector<PupilPoint> starts = pupil_points({}, 1000);
    for (PupilPoint& q : starts) q = {12 * q.x, 12 * q.y};
    const std::vector<PupilPoint> places = landings(part_of_field(t), starts);
    passes += static_cast<std::int64_t>(starts.size());
    std::size_t best = 0;
    for (std::size_t i = 1; i < places.size(); ++i)
      if (!is_finite(places[best]) || distance(places[i], one.target) < distance(places[best], one.target)) best = i;
    return look(t, {starts[best].x * cosine(t), starts[best].y * cosine(t)});
  };
  struct Known {
    double t;
    PupilPoint u;
  };
  const bool begins = look(0, one.target) || begin_anywhere(0);
  Known before{0, one.place}, last = before;
  const double first = angle_ > 0 ? std::min(1.0, first_part / angle_) : 1;
  for (double part = first; begins && last.t < 1 && part >= least_part * first;) {
    const double t = last.t + part > 1 - part / 4 ? 1 : last.t + part, ahead = last.t > before.t ? (t - last.t) / (last.t - before.t) : 0;
    const PupilPoint expected{last.u.x + ahead * (last.u.x - before.u.x), last.u.y + ahead * (last.u.y - before.u.y)};
    if (look(t, expected)) {
      before = last, last = {t, {one.place.x * cosine(t), one.place.y * cosine(t)}};
      part = std::min(1.5 * part, first);
    } else {
      part /= 2;
    }
  }
  if (last.t < 1) begin_anywhere(1);
  return passes;
}

std::int64_t Aim::find_samples() {
  samples_.resize(sample_count);
  for (std::size_t ring = 0; ring < rings.size(); ++ring)
    for (std::size_t k = 0; k < azimuths; ++k) {
      const double r = std::sqrt(rings[ring].u), at = 2 * std::numbers::pi * static_cast<double>(k) / azimuths;
      samples_[place_of(ring, k)].target = {r * std::cos(at), r * std::sin(at)};
    }
  std::int64_t passes = search_from_axis(samples_[0]);
  // A ring's beginnings go on along its radius, as far as the rings before were found.
  for (std::size_t ring = 0; ring < rings.size(); ++ring) {
    const auto r = [&](std::size_t of) { return std::sqrt(rings[of].u); };
    const double ahead = ring == 0 ? 0 : (r(ring) - r(ring - 1)) / (r(ring - 1) - (ring > 1 ? r(ring - 2) : 0));
    const std::span<PlaneSearch> of_ring(&samples_[place_of(ring, 0)], azimuths);
    const auto inner = [&](std::size_t k) -> const PlaneSearch& { return ring > 0 ? samples_[place_of(ring - 1, k)] : samples_[0]; };
    const auto expected = [&](std::size_t k) {
      const PlaneSearch& inmost = ring > 1 ? samples_[place_of(ring - 2, k)] : samples_[0];
      return PupilPoint{inner(k).place.x + ahead * (inner(k).place.x - inmost.place.x), inner(k).place.y + ahead * (inner(k).place.y - inmost.place.y)};
    };
    for (std::size_t k = 0; k < azimuths; ++k) of_ring[k].place = is_found(inner(k)) ? expected(k) : PupilPoint{nan, nan};
    passes += search(field_, of_ring);
  }
  // Where nothing is found about the centre, each from the axis, from the rim inwards, until a ring has some.
  if (std::none_of(samples_.begin(), samples_.end(), [&](const PlaneSearch& one) { return is_found(one); }))
    for (std::size_t ring = rings.size(); ring-- > 0;) {
      for (std::size_t k = 0; k < azimuths; ++k) passes += search_from_axis(samples_[place_of(ring, k)]);
      if (std::any_of(samples_.begin(), samples_.end(), [&](const PlaneSearch& one) { return is_found(one); })) break;
    }
  return passes;
}

void Aim::make_fit() {
  if (!std::all_of(samples_.begin(), samples_.end(), [&](const PlaneSearch& one) { return is_found(one); })) return;
  fit_x_.assign(terms, 0), fit_y_.assign(terms, 0);
  for (int term = 0; term < terms; ++term) {
    const numerics::ZernikeTerm zernike = numerics::osa_term(term);
    const double norm = zernike_norm(numerics::ZernikeIndexing::osa, zernike);
    double of_x = 0, of_y = 0;
    for (std::size_t ring = 0; ring < rings.size(); ++ring)
      for (std::size_t k = 0; k < azimuths; ++k) {
        const PlaneSearch& one = samples_[place_of(ring, k)];
        const double share = rings[ring].weight / azimuths * zernike_value(numerics::ZernikeIndexing::osa, zernike, one.target.x, one.target.y);
        of_x += share * one.place.x, of_y += share * one.place.y;
      }
    add_zernike_term(zernike, norm * of_x, degree, fit_x_);
    add_zernike_term(zernike, norm * of_y, degree, fit_y_);
  }
}

Aim::Beginning Aim::from_fit(const PupilPoint& target) const {
  const auto x = numerics::Polynomial{degree, fit_x_.data()}.evaluate(target.x, target.y), y = numerics::Polynomial{degree, fit_y_.data()}.evaluate(target.x, target.y);
  return {{x.value, y.value}, {{x.along_x, y.along_x}, {x.along_y, y.along_y}}};
}

Aim::Beginning Aim::from_nearest(const PupilPoint& target) const {
  const auto squared_distance = [&](const PlaneSearch& one) {
    const double x = one.target.x - target.x, y = one.target.y - target.y;
    return x * x + y * y;
  };
  const PlaneSearch* nearest = nullptr;
  for (const PlaneSearch& one : samples_)
    if (is_found(one) && (!nearest || squared_distance(one) < squared_distance(*nearest))) nearest = &one;
  if (!nearest) return {{nan, nan}, {}};
  const PupilPoint step = nearest->inverse.times({target.x - nearest->target.x, target.y - nearest->target.y});
  return {{nearest->place.x + step.x, nearest->place.y + step.y}, nearest->inverse};
}

std::int64_t Aim::aim_by_chords(std::span<const PupilPoint> targets, std::span<PupilPoint> starts, std::span<char> found) const {
  std::vector<PlaneSlopes> slopes(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Beginning beginning = fit_x_.empty() ? from_nearest(targets[i]) : from_fit(targets[i]);
    starts[i] = beginning.start, slopes[i] = beginning.slopes;
  }
  std::int64_t passes = 0;
  std::vector<std::size_t> going(targets.size());
  for (std::size_t i = 0; i < going.size(); ++i) going[i] = i;
  std::vector<double> misses(targets.size(), std::numeric_limits<double>::infinity());
  std::vector<PupilPoint> places;
  for (int chord = 0; chord < most_chords && !going.empty(); ++chord) {
    places.clear();
    for (const std::size_t i : going) places.push_back(starts[i]);
    const std::vector<PupilPoint> images = landings(field_, places);
    passes += static_cast<std::int64_t>(places.size());
    std::size_t k = 0;
    std::erase_if(going, [&](std::size_t i) {
      const PupilPoint& image = images[k++];
      const PupilPoint off{targets[i].x - image.x, targets[i].y - image.y}, step = slopes[i].times(off);
      const double miss = std::max(std::abs(off.x), std::abs(off.y));
      if (!is_finite(step) || !(miss <= misses[i] / 2)) return true;  // to Newton's method
      const double left = miss / misses[i];  // of the miss, by this step too
      misses[i] = miss;
      starts[i] = {starts[i].x + step.x, starts[i].y + step.y};
      found[i] = miss <= tolerance && left * miss <= tolerance / 1000;
      return found[i] != 0;
    });
  }
  return passes;
}

std::int64_t Aim::aim_by_newton(std::span<const PupilPoint> targets, std::span<PupilPoint> starts, std::span<char> found) const {
  std::vector<PlaneSearch> searches;
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (found[i]) continue;
    starts[i] = {};
    searches.push_back({targets[i], from_nearest(targets[i]).start});
    which.push_back(i);
  }
  const std::int64_t passes = search(field_, searches);
  for (std::size_t k = 0; k < which.size(); ++k)
    if (is_found(searches[k])) starts[which[k]] = searches[k].place, found[which[k]] = true;
  return passes;
}

AimedPupil Aim::at(std::span<const PupilPoint> stop_points, int thread_count) const {
  AimedPupil result{std::vector<PupilPoint>(stop_points.size()), std::vector<bool>(stop_points.size()), 0};
  const std::size_t batches = (stop_points.size() + batch_size - 1) / batch_size;
  std::vector<char> found(stop_points.size(), 0);
  std::vector<std::int64_t> passes(batches, 0);
  numerics::share_blocks(batches, thread_count, [&] {
    return [&](std::size_t batch) {
      const std::size_t from = batch * batch_size, count = std::min(batch_size, stop_points.size() - from);
      const auto targets = stop_points.subspan(from, count);
      const std::span<PupilPoint> starts = std::span(result.points).subspan(from, count);
      const std::span<char> are_found = std::span(found).subspan(from, count);
      passes[batch] = aim_by_chords(targets, starts, are_found) + aim_by_newton(targets, starts, are_found);
    };
  });
  for (std::size_t i = 0; i < found.size(); ++i) result.found[i] = found[i] != 0;
  for (const std::int64_t one : passes) result.passes += one;
  return result;
}

}  // namespace sagitta::trace
