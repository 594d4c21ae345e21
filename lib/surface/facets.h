// SPDX-License-Identifier: Apache-2.0
// A surface of flat facets between measured points, and where a ray meets it.
//
// The facet. Seen along the ray, every vertex v is a point of a plane across it,
//   v' = (right.(v - o), up.(v - o)),                                                                              (1)
// o a point of the ray near the surface, and right, up, forward a right-handed frame, forward = +-d with z >= 0. The ray
// passes through the facet (v0, v1, v2) in the sense of its forward side if all of
//   w0 = v1' x v2',   w1 = v2' x v0',   w2 = v0' x v1'                                                             (2)
// are >= 0 and their sum is > 0. The hit is  v0 + (w1 (v1 - v0) + w2 (v2 - v0)) / (w0 + w1 + w2): a point of the
// facet itself, at any incidence.                                                                                 (3)
//
// No ray is lost between facets. (1) depends on the vertex and the ray alone, so all facets see the same v', only moved
// by rounding; w of the shared edge has the same bits and the opposite sign in the two facets; and since rounding is
// monotone, the sign of a w is that of the exact w of the rounded v', or it is zero, which counts as inside. Facets that
// close up around a point cover it at least once with positive area, so one of them takes the ray.
//
// Finding it. The base sphere predicts a point, the grid gives a facet near it, and a walk along the ray goes from there
// across the edge with the most negative w (Devillers, Pion and Teillaud, Walking in a triangulation, Int. J. Found.
// Comput. Sci. 13, 181 (2002)). The walk is a shortcut, not the proof of a miss: where it comes to a rim, or takes too
// long, every facet in the grid cells under the ray is tested, and of those that the ray passes through in the sense of
// its forward side the one nearest to the predicted point is taken, the hit continuous with the base sphere's.
//
// A ray that meets no facet ends as outside_data, whichever way it passes: points say nothing of what is beyond them,
// so no ray is known to miss the surface.
//
// The normal is (-dz/dx, -dz/dy, 1) of the facet; gradients jump at edges. On an edge or a vertex either facet may answer;
// their sags agree to the rounding of z.
//
// Source: the watertight test of Woop, Benthin and Wald, J. Comput. Graph. Tech. 2, 65 (2013), with a rotation (Duff et
// al., J. Comput. Graph. Tech. 6, 1 (2017)) in place of their shear, and zero inside in place of a second precision.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "lib/numerics/key.h"
#include "lib/surface/crossing.h"
#include "lib/surface/mesh.h"

namespace sagitta::surface {

struct Facets {
  static constexpr std::string_view kind = "delaunay";
  static constexpr bool is_made_of_data = true;  // made by scene/compile from the points, not by from()
  static constexpr std::array keys{
      numerics::Key{"points", numerics::ValueKind::file, "file of the points", true},
      numerics::Key{.name = "format", .kind = numerics::ValueKind::text, .meaning = "format of the file", .choices = "xyz|cso|polar|ply"},
      numerics::Key{.name = "interpolation", .kind = numerics::ValueKind::text, .meaning = "surface between the points", .choices = "c1|linear|cubic|thin_plate|multiquadric"},
      numerics::Key{.name = "axes", .kind = numerics::ValueKind::text, .meaning = "frame of xyz and ply points: the surface's own, or OSA's (x to the examiner's right)", .choices = "local|osa"},
      numerics::Key{.name = "rings", .meaning = "rings of nodes around a facet, of the radial basis functions", .range = {0, 5},
                    .fallback = 2},
      numerics::Key{.name = "shape_mm", .meaning = "shape parameter of the multiquadric (0: the mean edge length)",
                    .range = numerics::not_negative},
      numerics::Key{.name = "smoothing_um", .meaning = "rms by which smoothed heights may leave the points", .range = numerics::not_negative},
      numerics::Key{.name = "max_edge_mm", .kind = numerics::ValueKind::number, .meaning = "facets with a longer edge are holes",
                    .range = {0, std::numeric_limits<double>::infinity(), true, true, true}, .fallback = std::numeric_limits<double>::infinity()}};

  const Mesh* mesh = nullptr;
  double curvature = 0;  // at the vertex, by the contract's least squares (scene/cloud_fit.h)

  double vertex_curvature() const { return curvature; }

  // The facet at (x, y); no_facet where there is none.
  template <class T>
  std::uint32_t facet_at(const T& x, const T& y) const {
    return locate_below<T>(x, y).facet;
  }
  bool covers(double x, double y) const { return facet_at(x, y) != no_facet; }

  template <class T>
  T sag(const T& x, const T& y) const {
    const Found<T> found = locate_below<T>(x, y);
    if (found.facet == no_facet) return not_a_number<T>();
    return found.between([&](const Vec3<T>& v) { return v.z; }, *mesh);
  }

  template <class T>
  Gradient<T> gradient(const T& x, const T& y) const {
    const Found<T> found = locate_below<T>(x, y);
    if (found.facet == no_facet) return {not_a_number<T>(), not_a_number<T>()};
    return {T(mesh->facets[found.facet].slope_x), T(mesh->facets[found.facet].slope_y)};
  }


  // The facet itself where it covers (x, y); else its neighbour on that side, no_facet beyond a rim.
  template <class T>
  std::uint32_t next_toward(std::uint32_t facet, const T& x, const T& y) const {
    const Found<T> seen = View<T>(Vec3<T>{x, y, T(mesh->base.centre.z)}, Vec3<T>{T(0), T(0), T(1)}).weigh(*mesh, facet);
    const int least = seen.least();
    return seen.w[least] < T(0) ? mesh->facets[facet].neighbour[least] : facet;
  }

  struct NotCounted {
    constexpr void operator()() const {}
  };

  // The facet that the line start + t d meets, and where; no_facet where it meets none.
  template <class T>
  struct Hit {
    std::uint32_t facet = no_facet;
    T path{};
    Vec3<T> point{};
  };
  // `visited` is called once for every facet that is tested.
  template <class T, class Visited = NotCounted>
  Hit<T> find(const Vec3<T>& start, const Vec3<T>& d, Visited&& visited = {}) const {
    // From the point of the ray nearest to the middle of the data: a start far away costs its own rounding only.
    const T to_middle = dot(vec3_cast<T>(mesh->base.centre) - start, d);
    const Vec3<T> p = start + to_middle * d;
    const T predicted = mesh->base.path(p, d);
    const T near = predicted - predicted == T(0) ? predicted : T(0);  // passes by, or not finite: there is no better guess
    const Vec3<T> o = p + near * d;
    Found<T> found = walk(View<T>(o, d), visited);
    if (found.facet == no_facet) found = search(p, d, near, visited);
    if (found.facet == no_facet) return {};
    const T path = found.between([&](const Vec3<T>& v) { return dot(v - o, d); }, *mesh);
    return {found.facet, to_middle + (near + path), o + path * d};
  }

  template <class T, class Visited = NotCounted>
  Crossing<T> meet(const Vec3<T>& start, const Vec3<T>& d, Visited&& visited = {}) const {
    const Hit<T> hit = find(start, d, visited);
    if (hit.facet == no_facet) return no_crossing<T>(Status::outside_data);
    const Facet& facet = mesh->facets[hit.facet];
    const T a = facet.slope_x, b = facet.slope_y;
    return {hit.path, hit.point, {-a, -b, T(1)}, d.z - a * d.x - b * d.y, Status::ok};
  }

 private:
  // A facet with its weights (2).
  template <class T>
  struct Found {
    std::uint32_t facet = no_facet;
    T w[3] = {T(0), T(0), T(0)};

    int least() const { return w[0] < w[1] ? (w[0] < w[2] ? 0 : 2) : (w[1] < w[2] ? 1 : 2); }

    // (3) for a quantity of the vertices.
    template <class Quantity>
    T between(Quantity&& quantity, const Mesh& of) const {
      const auto at = [&](int i) { return quantity(numerics::vec3_cast<T>(of.vertices[of.facets[facet].corner[i]])); };
      const T at0 = at(0);
      return at0 + (w[1] * (at(1) - at0) + w[2] * (at(2) - at0)) / (w[0] + w[1] + w[2]);
    }
  };

  // What is seen along the line o + t d.
  template <class T>
  struct View {
    Vec3<T> o, right, up;

    View(const Vec3<T>& origin, const Vec3<T>& d) : o(origin) {
      const Vec3<T> f = d.z < T(0) ? -d : d;
      const T s = T(1) / (T(1) + f.z), xy = -(f.x * f.y * s);
      right = {T(1) - f.x * f.x * s, xy, -f.x};
      up = {xy, T(1) - f.y * f.y * s, -f.y};
    }

    Found<T> weigh(const Mesh& mesh, std::uint32_t index) const {
      T x[3], y[3];
      for (int i = 0; i < 3; ++i) {
        const Vec3<T> v = numerics::vec3_cast<T>(mesh.vertices[mesh.facets[index].corner[i]]) - o;
        x[i] = dot(right, v);  // (1)
        y[i] = dot(up, v);
      }
      return {index, {x[1] * y[2] - y[1] * x[2], x[2] * y[0] - y[2] * x[0], x[0] * y[1] - y[0] * x[1]}};  // (2)
    }
  };

  template <class T>
  static bool passes_through(const Found<T>& facet) {
    const T* w = facet.w;
    return w[0] >= T(0) && w[1] >= T(0) && w[2] >= T(0) && w[0] + w[1] + w[2] > T(0);
  }

  static constexpr int longest_walk = 1000;  // far longer than any that does not go in circles on even data

  template <class T, class Visited>
  Found<T> walk(const View<T>& view, Visited&& visited) const {
    const std::int64_t column = mesh->column(double(view.o.x)), row = mesh->row(double(view.o.y));
    if (column < 0 || row < 0 || column >= mesh->columns || row >= mesh->rows) return {};
    const std::size_t cell = mesh->cell(column, row);
    if (mesh->cell_begin[cell] == mesh->cell_begin[cell + 1]) return {};
    std::uint32_t at = mesh->cell_facets[mesh->cell_begin[cell]];
    for (int step = 0; step < longest_walk && at != no_facet; ++step) {
      visited();
      const Found<T> facet = view.weigh(*mesh, at);
      if (passes_through(facet)) return facet;
      const int least = facet.least();
      if (!(facet.w[least] < T(0))) break;  // seen edge-on, or not a number
      at = mesh->facets[at].neighbour[least];
    }
    return {};
  }

  // All facets in the cells under the line p + t d, p near the middle; the one nearest to t = near.
  template <class T, class Visited>
  Found<T> search(const Vec3<T>& p, const Vec3<T>& d, const T& near, Visited&& visited) const {
    // The part of the line inside the bounding box. The margin covers the rounding of the box's own arithmetic and of
    // (1), a few times 1e-16 of the coordinates, by far.
    const auto length = [](const Vec3<double>& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
    const double margin = 1e-9 * length(mesh->high - mesh->low) + 1e-14 * (length(mesh->high) + length(mesh->low));
    const Vec3<double> q = numerics::vec3_cast<double>(p), e = numerics::vec3_cast<double>(d);
    double first = -std::numeric_limits<double>::infinity(), last = -first;
    const auto clip = [&](double from, double direction, double low, double high) {
      if (direction == 0) {
        if (!(from >= low - margin && from <= high + margin)) last = not_a_number<double>();
        return;
      }
      const double one = (low - margin - from) / direction, other = (high + margin - from) / direction;
      const double enter = one < other ? one : other, leave = one < other ? other : one;
      if (!(enter <= first)) first = enter;
      if (!(leave >= last)) last = leave;
    };
    clip(q.x, e.x, mesh->low.x, mesh->high.x);
    clip(q.y, e.y, mesh->low.y, mesh->high.y);
    clip(q.z, e.z, mesh->low.z, mesh->high.z);
    if (!(first <= last)) return {};

    const View<T> view(p, d);
    Found<T> nearest{};
    T least_distance{};
    const auto look_into = [&](std::size_t cell) {
      for (std::uint32_t k = mesh->cell_begin[cell]; k < mesh->cell_begin[cell + 1]; ++k) {
        visited();
        const Found<T> facet = view.weigh(*mesh, mesh->cell_facets[k]);
        if (!passes_through(facet)) continue;
        const T from_near = facet.between([&](const Vec3<T>& v) { return dot(v - p, d); }, *mesh) - near;
        const T distance = from_near < T(0) ? -from_near : from_near;
        if (nearest.facet != no_facet && !(distance < least_distance)) continue;
        nearest = facet;
        least_distance = distance;
      }
    };
    // Column by column: the rows that the line runs through inside the column.
    const auto clamped = [](std::int64_t i, std::uint32_t count) { return i < 0 ? 0 : i < count ? i : std::int64_t{count} - 1; };
    const double x0 = q.x + first * e.x, x1 = q.x + last * e.x;
    const double y0 = q.y + first * e.y, y1 = q.y + last * e.y;
    const std::int64_t from_column = clamped(mesh->column((x0 < x1 ? x0 : x1) - margin), mesh->columns);
    const std::int64_t to_column = clamped(mesh->column((x0 < x1 ? x1 : x0) + margin), mesh->columns);
    for (std::int64_t column = from_column; column <= to_column; ++column) {
      double t0 = 0, t1 = 1;  // of the part inside the column, from (x0, y0) to (x1, y1)
      if (from_column < to_column) {
        const auto fraction = [&](double x) {
          const double t = (x - x0) / (x1 - x0);
          return t > 0 ? (t < 1 ? t : 1.0) : 0.0;
        };
        t0 = fraction(mesh->low.x + static_cast<double>(column) / mesh->columns_per_mm - margin);
        t1 = fraction(mesh->low.x + static_cast<double>(column + 1) / mesh->columns_per_mm + margin);
      }
      const double ya = y0 + t0 * (y1 - y0), yb = y0 + t1 * (y1 - y0);
      const std::int64_t from_row = clamped(mesh->row((ya < yb ? ya : yb) - margin), mesh->rows);
      const std::int64_t to_row = clamped(mesh->row((ya < yb ? yb : ya) + margin), mesh->rows);
      for (std::int64_t row = from_row; row <= to_row; ++row) look_into(mesh->cell(column, row));
    }
    return nearest;
  }

  // The facet below or above (x, y).
  template <class T>
  Found<T> locate_below(const T& x, const T& y) const {
    const Vec3<T> o{x, y, T(mesh->base.centre.z)}, along_z{T(0), T(0), T(1)};
    const Found<T> found = walk(View<T>(o, along_z), NotCounted{});
    return found.facet != no_facet ? found : search(o, along_z, T(0), NotCounted{});
  }
};

}  // namespace sagitta::surface
