// SPDX-License-Identifier: Apache-2.0
#include "lib/scene/fit_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lib/numerics/parallel.h"
#include "lib/scene/cubic_fit.h"
#include "lib/scene/rings.h"

namespace sagitta::scene {
namespace {

using numerics::Vec3;
using surface::CloughTocherPatch;
using surface::Mesh;

constexpr std::size_t block_size = 2048;  // vertices or facets
constexpr int least_rings = 2;
constexpr double narrow = 20;                   // longest edge of a vertex over its second shortest: both ways along a line
constexpr std::size_t enough_points = 150;     // of many
constexpr std::size_t most_points = 300;  // where a neighbourhood grows no more

// In the order of their numbers, so that the bits do not depend on the order in which rings reach them. Few are sorted by
// counting for each how many are less: nothing could predict the branches of another sort.
void sort_by_number(std::span<const std::uint32_t> vertices, std::vector<std::uint32_t>& sorted) {
  sorted.assign(vertices.begin(), vertices.end());
  if (vertices.size() > 64) return std::sort(sorted.begin(), sorted.end());
  for (const std::uint32_t vertex : vertices) {
    std::uint32_t rank = 0;
    for (const std::uint32_t other : vertices) rank += other < vertex;
    sorted[rank] = vertex;
  }
}

// The fits of a few vertices at a time, into the results.
class VertexFits {
 public:
  VertexFits(const Mesh& mesh, const Neighbours& neighbours, const std::vector<char>& is_on_rim, std::vector<CubicFit>& fits,
             std::vector<char>& reaches_rim)
      : mesh_(mesh), is_on_rim_(is_on_rim), fits_(fits), reaches_rim_(reaches_rim), neighbours_(neighbours), rings_(neighbours) {}

  // From two rings on, with more for those vertices alone that need them.
  void operator()(std::uint32_t begin, std::uint32_t end) {
    waiting_.clear();
    for (std::uint32_t vertex = begin; vertex < end; ++vertex) waiting_.push_back(vertex);
    for (int rings = least_rings; !waiting_.empty(); rings += rings / 2) {
      unfinished_.clear();
      for (std::size_t from = 0; from < waiting_.size(); from += CubicFits::lanes)
        fit(std::span(waiting_).subspan(from, std::min(CubicFits::lanes, waiting_.size() - from)), rings);
      waiting_.swap(unfinished_);
    }
  }

 private:
  void fit(std::span<const std::uint32_t> vertices, int rings) {
    std::array<bool, CubicFits::lanes> is_all{};
    for (std::size_t lane = 0; lane < vertices.size(); ++lane) is_all[lane] = gather(vertices[lane], rings, lane);
    const auto fitted = cubics_.solve();
    for (std::size_t lane = 0; lane < vertices.size(); ++lane) {
      if (fitted[lane].terms == CubicFit::cubic_terms || is_all[lane]) fits_[vertices[lane]] = fitted[lane];
      else unfinished_.push_back(vertices[lane]);
    }
  }

  double square_of_distance(std::uint32_t a, std::uint32_t b) const {
    const double dx = mesh_.vertices[b].x - mesh_.vertices[a].x, dy = mesh_.vertices[b].y - mesh_.vertices[a].y;
    return dx * dx + dy * dy;
  }

  // Where points stand much nearer to each other along a line than across it, rings are long and narrow: the slope along it
  // would come from its nearest points alone, with all that the far ones ahead and behind lack of a cubic. Then all points
  // within the longest edge count, thinned out evenly (their numbers run along a curve).
  void widen(std::uint32_t vertex) {
    double shortest = std::numeric_limits<double>::infinity(), second = shortest, longest = 0;  // squares
    for (const std::uint32_t next : neighbours_.of(vertex)) {
      const double square = square_of_distance(vertex, next);
      second = std::min(second, std::max(shortest, square));
      shortest = std::min(shortest, square);
      longest = std::max(longest, square);
    }
    if (!(longest > narrow * narrow * second)) return;
    rings_.add_all([&](std::uint32_t next) { return square_of_distance(vertex, next) <= longest; });
  }
  void thin_out() {
    const std::size_t stride = 1 + sorted_.size() / enough_points;
    std::size_t kept = 0;
    for (std::size_t i = stride / 2; i < sorted_.size(); i += stride) sorted_[kept++] = sorted_[i];
    sorted_.resize(kept);
  }

  // True if further rings would add nothing that may be taken.
  bool gather(std::uint32_t vertex, int rings, std::size_t lane) {
    rings_.start({vertex});
    bool is_all = false;
    for (int ring = 1; ring <= rings && !is_all; ++ring) {
      const std::size_t before = rings_.vertices().size();
      rings_.add_ring();
      const std::size_t now = rings_.vertices().size();
      is_all = now == before || (ring >= least_rings && now >= most_points);
    }
    widen(vertex);
    sort_by_number(rings_.vertices().subspan(1), sorted_);
    // (a vertex of the rim has neighbours there)
    reaches_rim_[vertex] = std::any_of(sorted_.begin(), sorted_.end(), [&](std::uint32_t v) { return is_on_rim_[v]; });
    if (sorted_.size() > most_points) thin_out();
    cubics_.put(lane, mesh_.vertices[vertex], mesh_.vertices, sorted_);
    return is_all;
  }

  const Mesh& mesh_;
  const std::vector<char>& is_on_rim_;
  std::vector<CubicFit>& fits_;
  std::vector<char>& reaches_rim_;
  const Neighbours& neighbours_;
  Rings rings_;
  CubicFits cubics_;
  std::vector<std::uint32_t> waiting_, unfinished_, sorted_;
};

CloughTocherPatch patch_of(const Mesh& mesh, std::uint32_t facet, const std::vector<CubicFit>& fits) {
  const surface::Corners& corner = mesh.corners[facet];
  CloughTocherPatch::Corner corners[3];
  CloughTocherPatch::Slope slopes[3];
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t v = corner[i];
    corners[i] = {mesh.vertices[v], fits[v].gradient(0, 0)};
    // both facets of the edge take its ends in the same order, so their slopes have the same bits
    const auto [a, b] = std::minmax(corner[(i + 1) % 3], corner[(i + 2) % 3]);
    const double X = (mesh.vertices[b].x - mesh.vertices[a].x) / 2, Y = (mesh.vertices[b].y - mesh.vertices[a].y) / 2;
    const auto from_a = fits[a].gradient(X, Y), from_b = fits[b].gradient(-X, -Y);
    slopes[i] = {(from_a.x + from_b.x) / 2, (from_a.y + from_b.y) / 2};
  }
  return CloughTocherPatch::of(corners, mesh.facets[facet], slopes);
}

// work(begin, end) on blocks of 0 .. count
template <class MakeWorker>
void share(std::uint32_t count, int thread_count, const MakeWorker& make_worker) {
  numerics::share_blocks((count + block_size - 1) / block_size, thread_count, [&] {
    return [&, worker = make_worker()](std::size_t block) mutable {
      worker(static_cast<std::uint32_t>(block * block_size), static_cast<std::uint32_t>(std::min<std::size_t>(count, (block + 1) * block_size)));
    };
  });
}

}  // namespace

PatchFit fit_patches(const Mesh& mesh, int thread_count) {
  PatchFit result;
  result.reaches_rim.resize(mesh.vertex_count);
  std::vector<CubicFit> fits(mesh.vertex_count);
  {
    const Neighbours neighbours(mesh);
    const std::vector<char> is_on_rim = vertices_on_rim(mesh);
    share(mesh.vertex_count, thread_count, [&] { return VertexFits(mesh, neighbours, is_on_rim, fits, result.reaches_rim); });
  }
  result.patches.resize(mesh.facet_count);
  share(mesh.facet_count, thread_count, [&] {
    return [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t f = begin; f < end; ++f) result.patches[f] = patch_of(mesh, f, fits);
    };
  });
  return result;
}

}  // namespace sagitta::scene
