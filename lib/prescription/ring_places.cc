// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <tuple>

#include "lib/prescription/ring_places_internal.h"

namespace sagitta::prescription {
namespace {

using Group = std::span<const std::size_t>;  // indices of samples

// [0, 360); exact.
double within_a_turn(double angle_deg) {
  const double rest = std::fmod(angle_deg, 360.0), positive = rest < 0 ? rest + 360 : rest;
  return positive < 360 ? positive : 0;
}

// The samples in the order of `by`, and those that agree in its first part as one group.
template <class By, class Take>
void for_each_group(std::size_t sample_count, By&& by, Take&& take) {
  std::vector<std::size_t> order(sample_count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return std::tuple_cat(by(a), std::tuple(a)) < std::tuple_cat(by(b), std::tuple(b)); });
  for (auto begin = order.begin(); begin != order.end();) {
    const auto end = std::find_if(begin, order.end(), [&](std::size_t i) { return std::get<0>(by(i)) != std::get<0>(by(*begin)); });
    take(Group(begin, end));
    begin = end;
  }
}

}  // namespace

bool is_missing_marker(std::string_view text) { return text == "-1" || text == "-1000"; }

numerics::Vec3<double> in_eye_frame(double radius, double meridian_deg, double elevation) {
  const double turn = within_a_turn(meridian_deg);
  const int quadrant = static_cast<int>(turn / 90);
  const double angle = (turn - 90 * quadrant) * (std::numbers::pi / 180);
  const double c = std::cos(angle), s = std::sin(angle);
  const double cosine[] = {c, -s, -c, s}, sine[] = {s, c, -s, -c};
  return {0 - radius * cosine[quadrant], 0 + radius * sine[quadrant], -elevation};  // no -0 from a radius of 0
}

std::vector<double> places_of(const std::vector<RingSample>& samples) {
  std::vector<double> placed(samples.size()), turn(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) placed[i] = samples[i].radius, turn[i] = within_a_turn(samples[i].meridian_deg);
  if (std::none_of(placed.begin(), placed.end(), [](double r) { return std::isnan(r); })) return placed;
  const auto is_missing = [&](std::size_t i) { return std::isnan(samples[i].radius); };

  // Around each ring, linearly in the angle between the nearest neighbours that are there.
  const auto around_the_ring = [&](Group ring) {
    const std::size_t count = ring.size();
    std::size_t first = 0;
    while (first < count && is_missing(ring[first])) ++first;
    if (first == count) return;
    for (std::size_t left = first; left < first + count;) {
      const std::size_t from = ring[left % count];
      std::size_t right = left + 1;
      while (is_missing(ring[right % count])) ++right;
      const std::size_t to = ring[right % count];
      const auto angle_from_left = [&](std::size_t i) { return within_a_turn(turn[i] - turn[from]); };
      const double whole = from == to ? 360 : angle_from_left(to);
      for (std::size_t k = left + 1; k < right; ++k) {
        const std::size_t i = ring[k % count];
        const double share = whole > 0 ? angle_from_left(i) / whole : 0;
        placed[i] = samples[from].radius + (samples[to].radius - samples[from].radius) * share;
      }
      left = right;
    }
  };
  for_each_group(samples.size(), [&](std::size_t i) { return std::tuple(samples[i].ring, turn[i]); }, around_the_ring);

  // Out along each meridian: runs of missing samples between measured ones.
  const auto along_the_meridian = [&](Group meridian) {
    double inner = 0;
    for (std::size_t k = 0; k < meridian.size(); ++k) {
      const std::size_t first = k;
      while (k < meridian.size() && is_missing(meridian[k])) ++k;
      const bool is_bounded = k < meridian.size();
      const double outer = is_bounded ? samples[meridian[k]].radius : std::numeric_limits<double>::infinity();
      for (std::size_t missing = first; missing < k; ++missing) {
        double& r = placed[meridian[missing]];
        // A ring missing all around is a hole between two others; inside the first it is none, as no apex is.
        if (std::isnan(r) ? inner == 0 : r > inner && r < outer) continue;
        const double share = static_cast<double>(missing - first + 1) / static_cast<double>(k - first + 1);
        r = is_bounded ? inner + (outer - inner) * share : std::numeric_limits<double>::quiet_NaN();
      }
      inner = outer;
    }
  };
  for_each_group(samples.size(), [&](std::size_t i) { return std::tuple(turn[i], samples[i].ring); }, along_the_meridian);
  return placed;
}

}  // namespace sagitta::prescription
