// SPDX-License-Identifier: Apache-2.0
// A ray through a gradient-index medium to the next surface, in that surface's frame.
//
// Steps (leap.h) are as long as the tolerance allows, turn the ray by a radian at most, and reach little beyond where its tangent meets the surface. Within each
// the ray is looked at in four places, on the polynomial through both ends. It crosses where its height above the sag,
//   g = z - S(x, y),                                                                                                 (1)
// changes its sign from the side on which it comes; the crossing is drawn in on that polynomial, and then found by Newton's method on the ray itself: a step from
// the start to there (beyond the surface's domain, where there is no height, the chords between these places tell), the surface's own meet() along the tangent, a path d left over, and so on until the ray turns on d by less than the square root of
// rounding. Then the rest is straight, its turn to second order:
//   r + d p/n,   p + (d/n) (pull + pull')/2,   S + d (n + n')/2                                                        (2)
// So a hit is on the surface to rounding, and the path to it as good as the steps.
//
// Which crossing: that of the tangent, continued. Where the tangent's path to the surface is negative the ray goes back; so a virtual path is integrated
// like any other. Where the tangent misses, the ray goes forward if it is before the surface. Of several crossings the first on that way is the hit, from the
// side on which the ray comes; a ray that goes there and back within a quarter of a step, as where it turns, is seen by where it is nearest. A surface that is folded
// more finely than that, as a polynomial far beyond its normalization radius is, may be met at a later crossing than the first.
//
// missed         the ray leaves the medium (n is no index any more) or the neighbourhood (a thousand times the distances that there were), without a crossing
// outside_data   likewise, where it came through a hole or beyond the points of a measured surface
// not_converged  a step falls below rounding, a crossing cannot be settled, there are 5000 steps, or the ray has turned by 20 radians and gone ten times as far as
//                it has got, with the distances that there were: it circles, and whether it ever comes is not known
#pragma once

#include "lib/gradient_index/leap.h"
#include "lib/surface/crossing.h"

namespace sagitta::gradient_index {

using surface::Crossing, surface::Status;

inline constexpr int most_steps = 5000;
inline constexpr double least_squared_index = 1e-6, largest_squared_index = 1e6;
inline bool is_squared_index(double n2) { return n2 >= least_squared_index && n2 <= largest_squared_index; }

template <class T>
struct Arrival {
  State<T> state;       // at the hit
  Vec3<T> direction;    // p/|p|
  Crossing<T> crossing; // path: nothing is left of it. Where its status is not ok the rest is void
  int steps;
};

template <class T>
struct TangentPlane {
  T sag;
  surface::Gradient<T> slope;
};

// `surface` has meet(place, direction), a Crossing<T>; tangent(x, y), a TangentPlane<T>; and sag(x, y) in doubles.
template <class T, class Medium, class Surface>
class Traveller {
 public:
  Traveller(const Medium& medium, const Surface& surface, const Tolerance& tolerance) : medium_(medium), surface_(surface), tolerance_(tolerance) {}

  // From a place in the surface's frame, in a unit direction.
  Arrival<T> go(const Vec3<T>& start, const Vec3<T>& direction) {
    using std::sqrt;
    from_ = {start, direction, T(0)};
    at_ = medium_.at(start);
    if (!is_squared_index(index_squared())) return lost(Status::missed);
    from_.optical_direction = T(sqrt(at_.squared_index)) * direction;
    const Crossing<T> tangent = surface_.meet(start, direction);
    if (tangent.status == Status::ok && size_of(tangent.path) <= 8 * rounding * size_of(start)) return arrive(from_, at_, tangent);
    look_ahead(tangent);
    while (steps_ < most_steps && !circles()) {
      const double turn_limit = std::sqrt(index_squared()) / size_of(at_.pull);
      const double h = sense_ * std::min(length_, turn_limit);
      if (!(std::abs(h) * std::sqrt(index_squared()) > 4 * rounding * size_of(from_.position))) break;
      ++steps_;
      const Leap<T> next = leap(medium_, from_, at_, T(h), tolerance_);
      if (!(next.error <= 1)) {
        length_ = std::abs(h) * step_factor(next.error);
        continue;
      }
      const InMedium<T> at_next = medium_.at(next.behind.position);
      switch (look_within(next.behind, at_next, h)) {
        case Found::crossing: return arrival_;
        case Found::nothing_settled: length_ = std::abs(h) / 4; continue;
        case Found::none: break;
      }
      gone_ += std::abs(h) * std::sqrt(index_squared());
      turned_ += size_of(Vec3<T>(unit(next.behind.optical_direction) - unit(from_.optical_direction)));
      from_ = next.behind, at_ = at_next;
      if (!is_squared_index(index_squared()) || has_left()) return lost(why_);
      length_ = std::abs(h) * step_factor(next.error);
      const Crossing<T> ahead = surface_.meet(from_.position, unit(from_.optical_direction));
      if (ahead.status == Status::ok) length_ = std::min(length_, std::max(beyond * size_of(ahead.path) / std::sqrt(index_squared()), 2 * std::abs(h)));
    }
    return lost(why_ == Status::outside_data ? why_ : Status::not_converged);
  }

 private:
  static constexpr double beyond = 1.05;
  const double rounding = static_cast<double>(std::numeric_limits<T>::epsilon());
  enum class Found { none, crossing, nothing_settled };

  static Vec3<T> unit(const Vec3<T>& v) { return numerics::normalized(v); }
  static State<double> in_doubles(const State<T>& s) {
    return {numerics::vec3_cast<double>(s.position), numerics::vec3_cast<double>(s.optical_direction), static_cast<double>(s.opl)};
  }
  double index_squared() const { return static_cast<double>(at_.squared_index); }
  Arrival<T> lost(Status why) const { return {from_, from_.optical_direction, surface::no_crossing<T>(why), steps_}; }

  double height(const Vec3<double>& place) const { return place.z - surface_.sag(place.x, place.y); }
  // On the side from which the hit is to be met. NaN is on neither.
  bool is_before(double g) const { return g * side_ > 0; }

  // Which way the ray goes, and how far a first step may be.
  void look_ahead(const Crossing<T>& tangent) {
    const auto start = in_doubles(from_);
    const bool meets = tangent.status == Status::ok;
    const double heading = start.optical_direction.z < 0 ? -1 : 1, g = height(start.position), away = size_of(start.position);
    const bool goes_back = meets ? tangent.path < T(0) : g * heading > 0;
    sense_ = goes_back ? -1 : 1;
    side_ = -heading * sense_;
    was_before_ = is_before(g);
    if (tangent.status == Status::outside_data) why_ = Status::outside_data;
    const double first = meets ? beyond * size_of(tangent.path) : away > 0 ? away : 1;
    length_ = first / std::sqrt(index_squared());
    scale_ = std::max(away, first);
  }

  bool has_left() const {
    const auto here = in_doubles(from_);
    return norm(here.position) > 1000 * scale_ && sense_ * dot(here.position, here.optical_direction) > 0;
  }

  bool circles() const { return turned_ > 20 && gone_ > 10 * (scale_ + size_of(from_.position)); }

  // Whether the ray crosses the surface in the step to `to`.
  Found look_within(const State<T>& to, const InMedium<T>& at_to, double h) {
    const State<double> a = in_doubles(from_), b = in_doubles(to);
    const auto pull_a = numerics::vec3_cast<double>(at_.pull), pull_b = numerics::vec3_cast<double>(at_to.pull);
    const auto place_at = [&](double part) { return part == 0 ? a.position : part == 1 ? b.position : place_within(a, pull_a, b, pull_b, h, part); };
    const auto height_at = [&](double part) { return height(place_at(part)); };
    // Whether it comes nearer there, over the last thousandth of the step: rounding does not show in that.
    const auto comes_nearer = [&](double part) { return (height_at(part) - height_at(part - 1e-3)) * side_ < 0; };
    double behind = 0;  // the part of the step that is behind
    bool was_before = was_before_, came_nearer = came_nearer_, had_height = !std::isnan(height_at(0));
    for (const double part : {0.25, 0.5, 0.75, 1.0}) {
      const double g = height_at(part);
      const bool has_height = !std::isnan(g), is_before_here = is_before(g), comes_nearer_here = comes_nearer(part);
      double beyond_it = part;  // where the surface is behind
      bool crosses = was_before && !is_before_here;
      if (was_before && is_before_here && came_nearer && !comes_nearer_here) {  // perhaps there and back: nearest in between
        const double nearest = last_where(comes_nearer, behind + 1e-3, part) - 0.5e-3;
        if (!is_before(height_at(nearest))) beyond_it = nearest, crosses = true;
      }
      if (crosses) {
        const double low = last_where([&](double where) { return is_before(height_at(where)); }, behind, beyond_it);
        const Found found = settle(T(low * h), T(std::min(low + 1e-6, part) * h), h);
        if (found != Found::none) return found;
      } else if (!had_height || !has_height) {  // a surface that ends there: what the chord meets
        if (const double share = met_by_chord(place_at(behind), place_at(part)); share <= 1)
          if (const Found found = settle(T((behind + share * (part - behind)) * h), T(part * h), h); found != Found::none) return found;
      }
      had_height = has_height;
      was_before = is_before_here, came_nearer = comes_nearer_here, behind = part;
    }
    was_before_ = was_before, came_nearer_ = came_nearer;
    return Found::none;
  }
  // The share of the way at which a chord meets the surface from the side on which the ray comes; infinite where it does not.
  double met_by_chord(const Vec3<double>& from, const Vec3<double>& to) const {
    const double length = norm(to - from);
    const Crossing<T> met = surface_.meet(numerics::vec3_cast<T>(from), numerics::vec3_cast<T>((1 / length) * (to - from)));
    const bool is_on_the_way = met.status == Status::ok && met.path >= T(0) && static_cast<double>(met.along) * side_ < 0;
    return is_on_the_way ? static_cast<double>(met.path) / length : std::numeric_limits<double>::infinity();
  }
  // It is so at `low`, not at `high`: the last place where it is, to 1e-6.
  template <class IsSo>
  static double last_where(const IsSo& is_so, double low, double high) {
    while (high - low > 1e-6) {
      const double middle = (low + high) / 2;
      (is_so(middle) ? low : high) = middle;
    }
    return low;
  }

  // Newton's method on the ray, from t on, a time within the step; the polynomial says that the ray has crossed at t_behind. none: there it leaves the domain of the
  // sag, and crosses nothing.
  Found settle(T t, const T& t_behind, double h) {
    constexpr int most_looks = 12;
    const auto at_time = [&](const T& time) { return leap(medium_, from_, at_, time, tolerance_).behind; };
    for (int look = 0; look < most_looks; ++look) {
      const State<T> state = at_time(t);
      const InMedium<T> at = medium_.at(state.position);
      const double n = std::sqrt(static_cast<double>(at.squared_index)), step = std::abs(h) * n;
      const auto [crossing, bends_away] = crossing_near(state, step);
      const double d = size_of(crossing.path);
      if (!(d <= step)) break;  // another crossing, far away, or none
      const double turn = d * std::max(size_of(at.pull), size_of(medium_.at(crossing.point).pull)) / (n * n);
      if ((turn * turn <= rounding && d <= 1e-3 * step && bends_away <= 8 * rounding * size_of(state.position)) || d <= 8 * rounding * size_of(state.position)) {
        arrival_ = arrive(state, at, crossing);
        return Found::crossing;
      }
      t = t + crossing.path / sqrt_of(at.squared_index);
    }
    return std::isnan(height(in_doubles(at_time(t_behind)).position)) ? Found::none : Found::nothing_settled;
  }
  // By the surface's own meet(), or, of a ray that has turned over, which meet() would send to its other crossing, by the tangent plane below the place: then what is
  // met in the end, when it bends away from that plane by nothing, is the surface too.
  struct Near {
    Crossing<T> crossing;
    double bends_away;  // the surface, there, from where the crossing is
  };
  Near crossing_near(const State<T>& state, double step) {
    const Vec3<T> d = unit(state.optical_direction);
    const Crossing<T> met = surface_.meet(state.position, d);
    if (met.status == Status::outside_data) why_ = Status::outside_data;
    if (met.status == Status::ok && size_of(met.path) <= step) return {met, 0};
    const auto tangent = surface_.tangent(state.position.x, state.position.y);
    const T along = d.z - tangent.slope.x * d.x - tangent.slope.y * d.y, path = (tangent.sag - state.position.z) / along;
    if (!(static_cast<double>(along) * sense_ * side_ < 0)) return {surface::no_crossing<T>(Status::missed), 0};
    const Vec3<T> point = state.position + path * d;
    const auto slope = surface_.tangent(point.x, point.y).slope;
    const double turns = std::hypot(size_of(T(slope.x - tangent.slope.x)), size_of(T(slope.y - tangent.slope.y)));
    if (!(turns >= 0)) return {surface::no_crossing<T>(Status::missed), 0};  // NaN beyond the surface's domain
    const Vec3<T> normal{-slope.x, -slope.y, T(1)};
    return {{path, point, normal, dot(d, normal), Status::ok}, turns * size_of(path)};
  }
  static T sqrt_of(const T& x) {
    using std::sqrt;
    return sqrt(x);
  }

  // (2)
  Arrival<T> arrive(const State<T>& state, const InMedium<T>& at, const Crossing<T>& crossing) const {
    const InMedium<T> there = medium_.at(crossing.point);
    const T n = sqrt_of(at.squared_index), d = crossing.path;
    Arrival<T> result{{crossing.point, state.optical_direction + (d / n * T(0.5)) * (at.pull + there.pull), state.opl + d * (n + sqrt_of(there.squared_index)) * T(0.5)},
                      {}, crossing, steps_};
    result.direction = unit(result.state.optical_direction);
    result.crossing.path = T(0);
    result.crossing.along = dot(result.direction, crossing.normal);
    return result;
  }

  const Medium& medium_;
  const Surface& surface_;
  Tolerance tolerance_;
  State<T> from_{};
  InMedium<T> at_{};
  Arrival<T> arrival_{};
  Status why_ = Status::missed;
  double sense_ = 1, side_ = -1, length_ = 0, scale_ = 0, gone_ = 0, turned_ = 0;
  bool was_before_ = false, came_nearer_ = true;
  int steps_ = 0;
};

}  // namespace sagitta::gradient_index
