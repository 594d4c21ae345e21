// SPDX-License-Identifier: Apache-2.0
// Where a map F of the plane takes a place to a target: Newton's method by differences, damped, for many targets side by side, so that the map may do
// its places in batches.
//
//   p' = p + s J^-1 (target - F(p)),   J_ij = dF_i/dp_j by central differences     (1)
//
// s is 1, or as many times halved as it takes for the miss, the larger of |target - F|'s components, to fall. Each target's way depends on nothing but itself:
// where it stands among the others, and who they are, changes no bit.
//
// The differences' step h is a share of 1 + |p|: J is off by h^2 F'''/6 and by the rounding of F over h, 1e-9 of it for maps that are good to 1e-14; the
// end of the search is quadratic down to there, and then as good as F is.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace sagitta::trace {

// A place in the plane; of the pupil, of the stop, of the image.
struct PupilPoint {
  double x = 0, y = 0;
};

// The columns of a 2 x 2 matrix.
struct PlaneSlopes {
  PupilPoint along_x, along_y;

  PupilPoint times(const PupilPoint& v) const { return {along_x.x * v.x + along_y.x * v.y, along_x.y * v.x + along_y.y * v.y}; }
  // Of no number where there is none.
  PlaneSlopes inverse() const {
    const double determinant = along_x.x * along_y.y - along_y.x * along_x.y;
    return {{along_y.y / determinant, -along_x.y / determinant}, {-along_y.x / determinant, along_x.x / determinant}};
  }
};

inline bool is_finite(const PupilPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y); }

struct PlaneSearch {
  PupilPoint target, place;  // the place: where to begin, then the best that was found
  PupilPoint image{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};  // F of it
  PlaneSlopes inverse{};     // J^-1 by the last differences; 0 where none were taken

  double miss() const {
    const double x = std::abs(target.x - image.x), y = std::abs(target.y - image.y);
    return x <= y ? y : x == x ? x : y;  // NaN of either
  }
};

inline constexpr double near_enough = 1e-12;                // a miss that is as good as none
inline constexpr double difference_step = 0x1p-17;          // h
inline constexpr int most_newton_steps = 30, most_halvings = 6;

// `map(places)` gives the images of places, NaN where there is none. A target whose first place has no image stays there, and one whose next places beside it have none where it is.
template <class Map>
void search_plane(const Map& map, std::span<PlaneSearch> all) {
  std::vector<std::size_t> going(all.size());
  std::vector<PupilPoint> places(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) going[i] = i, places[i] = all[i].place;
  std::vector<PupilPoint> images = map(places);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].image = images[i];

  const auto length_at = [](const PupilPoint& p) { return 1 + std::max(std::abs(p.x), std::abs(p.y)); };
  std::vector<PupilPoint> steps(all.size());
  for (int step = 0; step < most_newton_steps; ++step) {
    std::erase_if(going, [&](std::size_t i) { return !(all[i].miss() > near_enough); });
    if (going.empty()) return;

    places.clear();
    for (const std::size_t i : going) {
      const PupilPoint p = all[i].place;
      const double h = difference_step * length_at(p);
      for (const double side : {h, -h}) places.push_back({p.x + side, p.y});
      for (const double side : {h, -h}) places.push_back({p.x, p.y + side});
    }
    images = map(places);
    std::vector<std::size_t> trying;
    for (std::size_t k = 0; k < going.size(); ++k) {
      PlaneSearch& one = all[going[k]];
      const double h = difference_step * length_at(one.place);
      const auto difference = [&](std::size_t forward) -> PupilPoint {
        const PupilPoint &a = images[forward], &b = images[forward + 1];
        return {(a.x - b.x) / (2 * h), (a.y - b.y) / (2 * h)};
      };
      const PlaneSlopes inverse = PlaneSlopes{difference(4 * k), difference(4 * k + 2)}.inverse();
      const PupilPoint s = inverse.times({one.target.x - one.image.x, one.target.y - one.image.y});
      if (!is_finite(s)) continue;
      one.inverse = inverse, steps[going[k]] = s;
      trying.push_back(going[k]);
    }

    going.clear();
    double share = 1;
    for (int halving = 0; halving <= most_halvings && !trying.empty(); ++halving, share /= 2) {
      places.clear();
      for (const std::size_t i : trying) places.push_back({all[i].place.x + share * steps[i].x, all[i].place.y + share * steps[i].y});
      images = map(places);
      std::vector<std::size_t> still;
      for (std::size_t k = 0; k < trying.size(); ++k) {
        PlaneSearch moved = all[trying[k]];
        moved.place = places[k], moved.image = images[k];
        if (moved.miss() < all[trying[k]].miss()) all[trying[k]] = moved, going.push_back(trying[k]);
        else still.push_back(trying[k]);
      }
      trying = std::move(still);
    }
  }
}

}  // namespace sagitta::trace
