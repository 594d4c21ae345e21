// SPDX-License-Identifier: Apache-2.0
// Spot diagram: where the rays of one field and wavelength meet the image surface, in its local x, y (mm).
//
//   centroid = mean (x, y);   rms radius = sqrt(mean |(x, y) - centroid|^2);   geometric radius = max |(x, y) - centroid|
//
// Rays are collected batch by batch and not kept, so any number of them takes the same memory. Sums run about a
// provisional centre, in the order of the rays and with compensation; the point farthest from the centroid, which is
// known only at the end, is a vertex of the points' convex hull, which is kept.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/numerics/column_sum.h"
#include "lib/numerics/convex_hull.h"
#include "lib/trace/ray_batch.h"

namespace sagitta::analysis {

struct Spot {
  trace::StatusCounts rays;
  double centroid_x = 0, centroid_y = 0;  // NaN where no ray arrived
  double rms_radius = 0, geometric_radius = 0;
};

// Ray counts per pixel of a square image; row 0 is the top (largest y). Its centre is the corner of four pixels, so
// pixels of twice the size hold the sums of four.
struct SpotImage {
  int size = 0;  // even; 0: no image
  double pixel_mm = 0, centre_x = 0, centre_y = 0;
  std::vector<std::uint32_t> counts;  // size x size

  SpotImage(int image_size, double pixel, double x, double y);
  // A ray beyond the edge doubles the pixels until it lies inside.
  void add(double x, double y);
  // The same for at most 256 rays given from the centre, in vectors of n (numerics/lanes.h): the last one's unused lanes hold
  // rays of the set again, and do not count.
  template <int n>
  void add_from_centre(const double* dx, const double* dy, std::size_t count);
  void double_pixels();

 private:
  double pixels_per_mm_;
};

class SpotCollector {
 public:
  // `image` is empty and tells the scale to begin with; its centre is the provisional centre. One of size 0 stays so, and costs nothing.
  explicit SpotCollector(SpotImage image) : image_(std::move(image)) {}

  void add(const trace::RayBatch& rays) { add(rays.x.data(), rays.y.data(), rays.ended.data(), rays.size()); }
  // Columns of a batch; `ended` as there.
  void add(const double* x, const double* y, const std::int32_t* ended, std::size_t count);
  Spot spot() const;
  const SpotImage& image() const { return image_; }
  // Doubles the pixels until they are at least so large.
  SpotImage image_with(double pixel_mm) const;

 private:
  void add_block(const double* x, const double* y, const std::int32_t* ended, std::size_t count);

  trace::StatusCounts rays_;
  numerics::ColumnSum x_, y_, squares_;  // about the image's centre
  numerics::ConvexHull hull_;
  SpotImage image_;
};

}  // namespace sagitta::analysis
