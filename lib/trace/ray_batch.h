// SPDX-License-Identifier: Apache-2.0
// Many rays as columns (struct of arrays). While a ray travels, its position and direction are in the local frame of the
// surface it was last sent to; a ray that ended stays in the frame of the surface that ended it, with its last good
// position, direction and OPL (for clipped and totally reflected rays: the hit, with the incident direction).
//
// The optical path length of ray i is opl_origin + opl[i]: the part common to all rays is kept apart, so that
// differences between rays keep their digits however far the object is.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <vector>

#include "lib/numerics/vec3.h"
#include "lib/surface/status.h"

namespace sagitta::trace {

using numerics::Vec3;
using surface::Status;

// The columns from some ray on, as the kernels see them. ended: 0 while the ray travels, else 8 * surface number + status.
// opl: null in a batch without.
struct RayColumns {
  double *x, *y, *z, *l, *m, *n, *opl;
  std::int32_t* ended;
};

struct RayBatch {
  explicit RayBatch(std::size_t ray_count = 0, bool with_opl = true) { resize(ray_count, with_opl); }

  void resize(std::size_t ray_count, bool with_opl = true) {
    for (auto* column : {&x, &y, &z, &l, &m, &n}) column->resize(ray_count);
    opl.resize(with_opl ? ray_count : 0);
    ended.assign(ray_count, 0);
  }
  std::size_t size() const { return ended.size(); }
  RayColumns columns(std::size_t from) {
    return {&x[from], &y[from], &z[from], &l[from], &m[from], &n[from], opl.empty() ? nullptr : &opl[from], &ended[from]};
  }

  Vec3<double> position(std::size_t ray) const { return {x[ray], y[ray], z[ray]}; }
  Vec3<double> direction(std::size_t ray) const { return {l[ray], m[ray], n[ray]}; }
  double optical_path_length(std::size_t ray) const { return opl_origin + opl[ray]; }
  Status status(std::size_t ray) const { return static_cast<Status>(ended[ray] % 8); }
  int ended_at(std::size_t ray) const { return ended[ray] / 8; }  // surface number; 0 while it travels
  void set(std::size_t ray, const Vec3<double>& position, const Vec3<double>& direction, double path) {
    x[ray] = position.x, y[ray] = position.y, z[ray] = position.z;
    l[ray] = direction.x, m[ray] = direction.y, n[ray] = direction.z;
    if (!opl.empty()) opl[ray] = path;
  }

  std::vector<double> x, y, z, l, m, n, opl;
  std::vector<std::int32_t> ended;
  double opl_origin = 0;
};

constexpr std::int32_t ending(int surface_number, Status status) { return 8 * surface_number + static_cast<int>(status); }

// How many rays ended each way, and where.
struct StatusCounts {
  std::array<std::int64_t, surface::status_count> of{};
  std::map<std::int32_t, std::int64_t> endings;  // RayBatch::ended of the lost rays -> how many

  void add(std::int32_t ended) {
    ++of[static_cast<std::size_t>(ended % 8)];
    if (ended != 0) ++endings[ended];
  }
  std::int64_t operator[](Status status) const { return of[static_cast<std::size_t>(status)]; }
  std::int64_t total() const { return std::accumulate(of.begin(), of.end(), std::int64_t{0}); }
};
inline StatusCounts count_statuses(const RayBatch& rays) {
  StatusCounts counts;
  for (const std::int32_t ended : rays.ended) counts.add(ended);
  return counts;
}

}  // namespace sagitta::trace
