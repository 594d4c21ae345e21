// SPDX-License-Identifier: Apache-2.0
// A surface of flat facets between measured points.
//
// A ray meets the facet that facet_location.h finds, on its plane. A ray that meets no facet ends as outside_data,
// whichever way it passes: points say nothing of what is beyond them, so no ray is known to miss the surface.
//
// The normal is (-dz/dx, -dz/dy, 1) of the facet; gradients jump at edges. On an edge or a vertex either facet may answer;
// their sags agree to the rounding of z.
//
// The sag is right to O(h^2), the slope to O(h), h the distance of the points.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "lib/numerics/key.h"
#include "lib/surface/block.h"
#include "lib/surface/facet_block.h"

namespace sagitta::surface {

struct Facets {
  static constexpr std::string_view kind = "delaunay";
  static constexpr bool is_made_of_data = true;  // made by scene/compile from the points, not by from()
  static constexpr std::array keys{
      numerics::Key{"points", numerics::ValueKind::file, "file of the points", true},
      numerics::Key{.name = "format", .kind = numerics::ValueKind::text, .meaning = "format of the file", .choices = "xyz|cso|polar|ply"},
      numerics::Key{.name = "interpolation", .kind = numerics::ValueKind::text, .meaning = "surface between the points", .choices = "c1|linear|cubic|thin_plate|multiquadric"},
      numerics::Key{.name = "axes", .kind = numerics::ValueKind::text, .meaning = "frame of xyz and ply points: the surface's own, or OSA's (x to the examiner's right)", .choices = "local|osa"},
      numerics::Key{.name = "rings", .meaning = "rings of nodes around a facet, of the radial basis functions", .range = {.low = 0, .high = 5, .whole = true},
                    .fallback = 2, .only_with = "interpolation", .only_choices = "cubic|thin_plate|multiquadric"},
      numerics::Key{.name = "shape_mm", .meaning = "shape parameter of the multiquadric (0: the mean edge length)",
                    .range = numerics::not_negative, .only_with = "interpolation", .only_choices = "multiquadric"},
      numerics::Key{.name = "smoothing_um", .meaning = "rms by which smoothed heights may leave the points", .range = numerics::not_negative},
      numerics::Key{.name = "max_edge_mm", .kind = numerics::ValueKind::number, .meaning = "facets with a longer edge are holes",
                    .range = {0, std::numeric_limits<double>::infinity(), true, true, true}, .fallback = std::numeric_limits<double>::infinity()}};

  const Mesh* mesh = nullptr;
  double curvature = 0;  // at the vertex, by the contract's least squares (scene/cloud_fit.h)

  static constexpr std::string_view kernel() { return "flat facets"; }
  std::size_t data_bytes() const { return mesh ? mesh->data_bytes() : 0; }
  double vertex_curvature() const { return curvature; }

  // The facet at (x, y); no_facet where there is none.
  template <class T>
  std::uint32_t facet_at(const T& x, const T& y) const {
    AimedLine<T> line = vertical(x, y);
    return locate(*mesh, line, [] {}).facet;
  }
  bool covers(double x, double y) const { return facet_at(x, y) != no_facet; }

  template <class T>
  T sag(const T& x, const T& y) const {
    const std::uint32_t f = facet_at(x, y);
    if (f == no_facet) return not_a_number<T>();
    const Facet& facet = mesh->facets[f];
    const T X = x - T(mesh->centre.x), Y = y - T(mesh->centre.y);
    return T(mesh->centre.z) + (T(facet.z) + T(facet.slope_x) * (X - T(facet.x)) + T(facet.slope_y) * (Y - T(facet.y)));
  }

  template <class T>
  Gradient<T> gradient(const T& x, const T& y) const {
    const std::uint32_t f = facet_at(x, y);
    if (f == no_facet) return {not_a_number<T>(), not_a_number<T>()};
    return {T(mesh->facets[f].slope_x), T(mesh->facets[f].slope_y)};
  }

  // The facet itself where it covers (x, y); else its neighbour on that side, no_facet beyond a rim.
  template <class T>
  std::uint32_t next_toward(std::uint32_t facet, const T& x, const T& y) const {
    const Weighed<T> seen = View<T>(vertical(x, y)).weigh(*mesh, facet);
    const int least = seen.least();
    return seen.w[least] < T(0) ? mesh->facets[facet].neighbour[least] : facet;
  }

  // The facet that the line start + t d meets, and where; no_facet where it meets none.
  template <class T>
  struct Hit {
    std::uint32_t facet = no_facet;
    T path{};
    Vec3<T> point{};
  };
  struct NotCounted {
    constexpr void operator()() const {}
  };
  // `visited` is called once for every facet that is tested.
  template <class T, class Visited = NotCounted>
  Hit<T> find(const Vec3<T>& start, const Vec3<T>& d, Visited&& visited = {}) const {
    AimedLine<T> line = aim(*mesh, start, d);
    const auto [facet, path] = locate(*mesh, line, visited);
    if (facet == no_facet) return {};
    return {facet, line.path + path, numerics::vec3_cast<T>(mesh->centre) + (line.o + path * line.d)};
  }

  template <class T, class Visited = NotCounted>
  Crossing<T> meet(const Vec3<T>& start, const Vec3<T>& d, Visited&& visited = {}) const {
    return crossing_at(find(start, d, visited), d);
  }
  [[gnu::always_inline]] void meet_block(const BlockOfLines& lines, BlockOfCrossings& crossings) const {
    FacetsOfBlock found;
    meet_block(lines, crossings, found);
  }
  [[gnu::always_inline]] void meet_block(const BlockOfLines& lines, BlockOfCrossings& crossings, FacetsOfBlock& found) const {
    locate_block(*mesh, lines, found);
    for (int i = 0; i < lines.count; ++i) {
      const double path = found.path[i];
      crossings.path[i] = found.o.path[i] + path;
      crossings.x[i] = mesh->centre.x + (found.o.x[i] + path * lines.l[i]);
      crossings.y[i] = mesh->centre.y + (found.o.y[i] + path * lines.m[i]);
      crossings.z[i] = mesh->centre.z + (found.o.z[i] + path * lines.n[i]);
      crossings.slope_x[i] = found.slope_x[i];
      crossings.slope_y[i] = found.slope_y[i];
      crossings.status[i] = static_cast<std::int32_t>(found.facet[i] == no_facet ? Status::outside_data : Status::ok);
    }
  }
  template <class T>
  Crossing<T> crossing_at(const Hit<T>& hit, const Vec3<T>& d) const {
    if (hit.facet == no_facet) return no_crossing<T>(Status::outside_data);
    const T a(mesh->facets[hit.facet].slope_x), b(mesh->facets[hit.facet].slope_y);
    return {hit.path, hit.point, {-a, -b, T(1)}, d.z - a * d.x - b * d.y, Status::ok};
  }

 private:
  template <class T>
  AimedLine<T> vertical(const T& x, const T& y) const {
    return aim(*mesh, Vec3<T>{x, y, T(mesh->centre.z)}, Vec3<T>{T(0), T(0), T(1)});
  }
};

}  // namespace sagitta::surface
