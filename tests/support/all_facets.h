// SPDX-License-Identifier: Apache-2.0
// Which facets does a ray cross? By testing all of them, one after the other, in long double: no frame, no order, no grid,
// no walk. The judge of every way of locating facets.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "lib/surface/facets.h"

namespace sagitta::tests {

using numerics::Vec3;
using Real = long double;

// The edges that have a facet on one side only.
inline std::vector<std::array<std::uint32_t, 2>> rim_edges(const surface::Mesh& mesh) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (std::uint32_t f = 0; f < mesh.facet_count; ++f) {
    const auto corner = mesh.corners[f];
    for (std::size_t i = 0; i < 3; ++i)
      if (mesh.facets[f].neighbour[i] == surface::no_facet) edges.push_back({corner[(i + 1) % 3], corner[(i + 2) % 3]});
  }
  return edges;
}

class AllFacets {
 public:
  explicit AllFacets(const surface::Mesh& mesh) : mesh_(mesh) {
    constexpr double inf = std::numeric_limits<double>::infinity();
    Vec3<double> low{inf, inf, inf}, high = -low;
    for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) {
      const auto& p = mesh.vertices[v];
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    middle_ = 0.5 * (low + high);
    balls_.reserve(mesh.facet_count);
    for (std::uint32_t f = 0; f < mesh.facet_count; ++f) {
      const auto [a, b, c] = vertices(f);
      const Vec3<double> centre = 1.0 / 3 * (a + b + c);
      const double reach = std::max({dot(a - centre, a - centre), dot(b - centre, b - centre), dot(c - centre, c - centre)});
      balls_.push_back({centre - middle_, 1.01 * reach});
    }
  }

  struct Crossed {
    std::uint32_t facet;
    Real path;       // along the line
    Real least;      // of the barycentric coordinates: negative outside
    bool forward;    // the line crosses to the facet's +z side as it travels to +z, or to its -z side to -z
    Real rounding;   // of `least`, in a program that moves the line by `shift`
  };
  // Every facet that the line p + t d passes at all near, and those within `slack` of it (barycentric) that it crosses.
  // `shift` is what rounding may move a line by: 3e-14 mm is 4 ulp of 30 mm.
  std::vector<Crossed> crossed_by(const Vec3<double>& p, const Vec3<double>& d, Real shift = 3e-14L) const {
    std::vector<Crossed> found;
    const Vec3<double> start = p - middle_, near = start - dot(start, d) * d;
    for (std::uint32_t f = 0; f < balls_.size(); ++f) {
      // The line passes the ball around the facet: cheap, and 1 % of its size away from any decision.
      const Vec3<double> from_line = cross(balls_[f].centre - near, d);
      if (dot(from_line, from_line) > balls_[f].reach) continue;
      const auto [a, b, c] = vertices(f);
      const auto exact = [](const Vec3<double>& v) { return numerics::vec3_cast<Real>(v); };
      // Cramer's rule (Moeller and Trumbore).
      const Vec3<Real> e1 = exact(b) - exact(a), e2 = exact(c) - exact(a), o = exact(p) - exact(a), D = exact(d);
      const Vec3<Real> n = cross(e1, e2);
      const Real determinant = -dot(n, D), t = dot(n, o) / determinant;
      const Real u = dot(cross(D, e2), o) / determinant, v = dot(cross(e1, D), o) / determinant;
      const Real edge = std::sqrt(std::max({dot(e1, e1), dot(e2, e2), dot(e2 - e1, e2 - e1)}));
      // A line moved across itself by `shift` changes a coordinate by at most shift * edge / |determinant|.
      found.push_back({f, t, std::min({u, v, 1 - u - v}), (dot(n, D) > 0) == (D.z > 0), shift * edge / std::abs(determinant)});
    }
    return found;
  }

  // What a program may say of the line.
  struct Verdict {
    bool must_hit = false;     // some facet is crossed by more than rounding
    bool may_hit = false;      // some facet is crossed, or missed by no more than rounding
    bool decidable = true;     // no edge is nearer to the line than rounding
    int crossings = 0;         // facets crossed in the forward sense
    std::vector<Crossed> candidates;
    bool has_path(double path, Real tolerance) const {
      return std::any_of(candidates.begin(), candidates.end(), [&](const Crossed& c) { return std::abs(c.path - Real(path)) <= tolerance; });
    }
  };
  Verdict judge(const Vec3<double>& p, const Vec3<double>& d, Real shift = 3e-14L) const {
    Verdict verdict;
    for (const Crossed& facet : crossed_by(p, d, shift)) {
      if (std::abs(facet.least) <= facet.rounding) verdict.decidable = false;
      if (!facet.forward || !(facet.least >= -facet.rounding)) continue;
      verdict.may_hit = true;
      verdict.must_hit |= facet.least > facet.rounding;
      verdict.crossings += facet.least >= 0;
      verdict.candidates.push_back(facet);
    }
    return verdict;
  }

  std::array<Vec3<double>, 3> vertices(std::uint32_t facet) const {
    const auto corner = mesh_.corners[facet];
    return {mesh_.vertices[corner[0]], mesh_.vertices[corner[1]], mesh_.vertices[corner[2]]};
  }

 private:
  struct Ball {
    Vec3<double> centre;  // from the middle of the data
    double reach;
  };
  const surface::Mesh& mesh_;
  Vec3<double> middle_;
  std::vector<Ball> balls_;
};

}  // namespace sagitta::tests
