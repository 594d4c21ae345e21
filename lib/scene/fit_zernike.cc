// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/fit_zernike.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/numerics/arena.h"
#include "lib/numerics/sum.h"
#include "lib/scene/fit_conic.h"
#include "lib/scene/least_squares_internal.h"
#include "lib/surface/zernike.h"

namespace sagitta::scene {
namespace {

using numerics::Vec3;
using numerics::ZernikeIndexing;
using Points = std::vector<Vec3<double>>;

constexpr double worst_condition = 1000;
constexpr double least_reach = 0.8;  // of R
constexpr double largest_coordinate = 1e9;  // mm, as in scene/triangulate.h

ZernikeSurfaceResult refused(std::string reason, std::string hint) { return {std::nullopt, std::move(reason), std::move(hint)}; }

constexpr std::string_view name_of(ZernikeIndexing indexing) {
  return indexing == ZernikeIndexing::noll ? "noll" : indexing == ZernikeIndexing::fringe ? "fringe" : "osa";
}

struct Reach {
  double nearest = 0, farthest = 0;  // distance from the origin, mm
  std::size_t rings = 0;             // different distances, to 1e-6 of the farthest
};
Reach reach_of(const Points& points) {
  std::vector<double> distances;
  for (const auto& p : points) distances.push_back(std::hypot(p.x, p.y));
  std::sort(distances.begin(), distances.end());
  Reach reach{distances.front(), distances.back(), 1};
  for (std::size_t i = 1; i < distances.size(); ++i) reach.rings += distances[i] - distances[i - 1] > 1e-6 * reach.farthest;
  return reach;
}

// Terms of m = 0, which rings alone tell apart: each needs one.
std::size_t rings_needed(const ZernikeSurfaceRequest& request) {
  std::size_t count = 0;
  for (int j = 0; j < request.terms; ++j)
    count += numerics::zernike_term(request.indexing, numerics::first_zernike_index(request.indexing) + j).m == 0;
  return count;
}

// The largest angle about the origin, in degrees, without a point beyond that distance. There is one.
double widest_sector_deg(const Points& points, double distance) {
  std::vector<double> angles;
  for (const auto& p : points)
    if (std::hypot(p.x, p.y) >= distance) angles.push_back(std::atan2(p.y, p.x));
  std::sort(angles.begin(), angles.end());
  double widest = angles.front() + 2 * std::numbers::pi - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) widest = std::max(widest, angles[i] - angles[i - 1]);
  return widest * 180 / std::numbers::pi;
}

// Why the points do not tell the terms apart, or not where they reach.
ZernikeSurfaceResult refused_by(const Points& points, const Reach& reach, const ZernikeSurfaceRequest& request, double condition) {
  const double R = request.radius_mm, outer = 0.7 * reach.farthest, sector = widest_sector_deg(points, outer);
  const std::string head = fmt::format("the {} points within {:g} mm do not tell {} {} ", points.size(), R, request.terms, request.terms == 1 ? "term" : "terms") +
                           (condition > worst_condition ? fmt::format("apart (condition number {:.3g}): ", condition) : "over all of the circle: ");
  const std::string fewer = ", or ask for fewer terms";
  if (reach.nearest >= 0.9 * reach.farthest)
    return refused(head + fmt::format("they lie on one ring, {:.3g} to {:.3g} mm from the origin", reach.nearest, reach.farthest),
                   "a surface needs several rings");
  if (const std::size_t needed = rings_needed(request); reach.rings < needed)
    return refused(head + fmt::format("they lie on {} rings, and {} are needed", reach.rings, needed), "take a larger radius" + fewer);
  if (reach.farthest < least_reach * R)
    return refused(head + fmt::format("the outermost lies {:.3g} mm from the origin", reach.farthest),
                   fmt::format("take a radius of {:.3g} mm or less", reach.farthest));
  if (sector > 20)
    return refused(head + fmt::format("beyond {:.3g} mm from the origin a sector of {:.0f} degrees holds none", outer, sector),
                   "take a radius within the data" + fewer);
  if (reach.nearest > 0.3 * R)
    return refused(head + fmt::format("the innermost lies {:.3g} mm from the origin", reach.nearest), "take points nearer to the origin" + fewer);
  return refused(head + "they are too few, or lie on too few rings or lines", "ask for fewer terms");
}

// The terms by least squares of what the base conic leaves.
struct Terms {
  std::optional<Eigen::VectorXd> coefficients;  // mm
  double condition = 0;
};
Terms fit_terms(const Points& points, const surface::Conic& base, const ZernikeSurfaceRequest& request) {
  std::vector<numerics::ZernikeTerm> terms;
  for (int j = 0; j < request.terms; ++j)
    terms.push_back(numerics::zernike_term(request.indexing, numerics::first_zernike_index(request.indexing) + j));
  LeastSquares fit(request.terms);
  for (const auto& p : points) {
    auto row = fit.next_row();
    for (Eigen::Index j = 0; j < request.terms; ++j)
      row(j) = numerics::zernike_value(request.indexing, terms[static_cast<std::size_t>(j)], p.x / request.radius_mm, p.y / request.radius_mm);
    row(request.terms) = p.z - base.sag(p.x, p.y);
  }
  const Eigen::VectorXd singular = Eigen::BDCSVD<Eigen::MatrixXd>(fit.scaled_matrix()).singularValues();
  return {fit.solve(), singular(0) / singular(singular.size() - 1)};
}

// Of the residuals at the points. The surface is evaluated as it will be traced.
void set_rms(ZernikeSurface& result, const Points& points) {
  numerics::Arena arena;
  const auto fitted = surface::Zernike::from(zernike_shape(result).parameters, arena);
  numerics::Sum squares;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto& p : points) {
    const double residual = 1e3 * (p.z - fitted.sag(p.x, p.y));
    squares.add(residual * residual);
    low = std::min(low, residual);
    high = std::max(high, residual);
  }
  result.rms_um = std::sqrt(squares.value() / static_cast<double>(points.size()));
  result.peak_to_valley_um = high - low;
}

}  // namespace

int most_zernike_terms(ZernikeIndexing indexing) {
  return std::min(1326, numerics::last_zernike_index(indexing) - numerics::first_zernike_index(indexing) + 1);
}

ZernikeSurfaceResult fit_zernike_surface(const prescription::PointCloud& cloud, const ZernikeSurfaceRequest& request) {
  const double R = request.radius_mm;
  const int most_terms = most_zernike_terms(request.indexing);
  if (!(R > 0) || !std::isfinite(R)) return refused(fmt::format("the radius must be positive, not {:g} mm", R), "about that of the pupil, 3 mm");
  if (request.terms < 1 || request.terms > most_terms)
    return refused(fmt::format("the terms of {} may be 1 to {}, not {}", name_of(request.indexing), most_terms, request.terms), "36 are usual");

  ZernikeSurface result;
  result.normalization_radius_mm = R;
  result.indexing = request.indexing;
  result.points.file = cloud.file;
  result.points.has_lines = cloud.has_lines;
  Points points;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const auto& p = cloud.points[i];
    const double distance = std::hypot(p.x, p.y);
    if (!std::isnan(p.z)) nearest = std::min(nearest, distance);
    if (!(distance <= R * (1 + 1e-12))) continue;  // a ring of radius R is inside, whichever way its points were rounded
    if (std::abs(p.z) > largest_coordinate) return refused(fmt::format("the point ({:.9g}, {:.9g}, {:.9g}) is beyond +-1e9 mm", p.x, p.y, p.z), "coordinates are in mm");
    result.points.points.push_back(p);
    result.points.lines.push_back(i < cloud.lines.size() ? cloud.lines[i] : static_cast<std::uint32_t>(i + 1));
    if (!std::isnan(p.z)) points.push_back(p);
  }
  result.point_count = points.size();
  if (points.empty())
    return refused(fmt::format("no point lies within {:g} mm of the surface's origin", R),
                   std::isfinite(nearest) ? fmt::format("the nearest lies {:.3g} mm from it", nearest) : "the file holds no point with a height");
  if (points.size() < static_cast<std::size_t>(request.terms))
    return refused(fmt::format("{} {} within {:g} mm {} too few for {} terms", points.size(), points.size() == 1 ? "point" : "points", R,
                               points.size() == 1 ? "is" : "are", request.terms),
                   fmt::format("take a larger radius, or ask for {} terms or fewer", points.size()));

  const Reach reach = reach_of(points);
  const auto base = fit_sphere_and_conic(points);
  if (!base) return refused_by(points, reach, request, std::numeric_limits<double>::infinity());
  result.sphere_radius_mm = 1 / base->sphere.conic.curvature;
  result.sphere_vertex_mm = base->sphere.vertex_z;
  result.sphere_rms_um = 1e3 * base->sphere.rms;
  result.radius_mm = 1 / base->conic.conic.curvature;
  result.conic_constant = base->conic.conic.conic_constant;
  result.conic_is_sphere = base->conic_is_sphere;
  result.vertex_mm = base->conic.vertex_z;
  result.conic_rms_um = 1e3 * base->conic.rms;

  // The base as it is written into the shape: its curvature comes back from the radius.
  const Terms terms = fit_terms(points, {1 / result.radius_mm, result.conic_constant}, request);
  result.condition_number = terms.condition;
  if (!terms.coefficients || !(terms.condition <= worst_condition) || !(reach.farthest >= least_reach * R))
    return refused_by(points, reach, request, terms.condition);
  for (const double mm : *terms.coefficients) result.coefficients_um.push_back(1e3 * mm);
  set_rms(result, points);
  return {std::move(result), {}, {}};
}

prescription::Shape zernike_shape(const ZernikeSurface& surface) {
  prescription::Shape shape;
  shape.kind = surface::Zernike::kind;
  shape.parameters.numbers = {{"radius_mm", surface.radius_mm}, {"conic_constant", surface.conic_constant},
                              {"normalization_radius_mm", surface.normalization_radius_mm}};
  shape.parameters.texts = {{"indexing", std::string(name_of(surface.indexing))}};
  auto& coefficients = shape.parameters.indexed["coefficients_um"];
  int index = numerics::first_zernike_index(surface.indexing);
  for (const double um : surface.coefficients_um) coefficients.emplace_back(index++, um);
  return shape;
}

}  // namespace sagitta::scene
