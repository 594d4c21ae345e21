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

// The fits of a few vertices at a time, into the results.
class VertexFits {
 public:
  VertexFits(const Mesh& mesh, const Neighbours& neighbours, numerics::UnsetArray<CubicFit>& fits,
             std::vector<char>& reaches_rim)
      : mesh_(mesh), fits_(fits), reaches_rim_(reaches_rim), neighbours_(neighbours), rings_(neighbours) {}

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
      const double square = square_of_distance(vertex, next), not_shortest = square > shortest ? square : shortest;
      second = not_shortest < second ? not_shortest : second;
      shortest = square < shortest ? square : shortest;
      longest = square > longest ? square : longest;
    }
    if (!(longest > narrow * narrow * second)) return;
    rings_.add_all([&](std::uint32_t next) { return square_of_distance(vertex, next) <= longest; });
  }
  std::span<const std::uint32_t> thinned_out(std::span<const std::uint32_t> around) {
    sorted_.assign(around.begin(), around.end());
    std::sort(sorted_.begin(), sorted_.end());
    const std::size_t stride = 1 + sorted_.size() / enough_points;
    std::size_t kept = 0;
    for (std::size_t i = stride / 2; i < sorted_.size(); i += stride) sorted_[kept++] = sorted_[i];
    return std::span(sorted_).first(kept);
  }

  // True if further rings would add nothing that may be taken. Points are fitted in the order in which rings reach them:
  // by the order of the facets around each vertex, which is the same in every mesh that has these facets.
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
    std::span<const std::uint32_t> around = rings_.vertices().subspan(1);
    char reaches_rim = 0;  // (a vertex of the rim has neighbours there)
    for (const std::uint32_t v : around) reaches_rim |= neighbours_.is_on_rim(v);
    reaches_rim_[vertex] = reaches_rim;
    if (around.size() > most_points) around = thinned_out(around);
    cubics_.put(lane, mesh_.vertices[vertex], mesh_.vertices, around);
    return is_all;
  }

  const Mesh& mesh_;
  numerics::UnsetArray<CubicFit>& fits_;
  std::vector<char>& reaches_rim_;
  const Neighbours& neighbours_;
  Rings rings_;
  CubicFits cubics_;
  std::vector<std::uint32_t> waiting_, unfinished_, sorted_;
};

CloughTocherPatch patch_of(const Mesh& mesh, std::uint32_t facet, const numerics::UnsetArray<CubicFit>& fits) {
  const surface::Corners& corner = mesh.corners[facet];
  CloughTocherPatch::Corner corners[3];
  CloughTocherPatch::Slope slopes[3];
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t v = corner[i];
    corners[i] = {mesh.vertices[v], fits[v].gradient()};
    // The two facets of an edge have its ends the other way round, and slopes of the same bits: signs and sums are exact.
    const std::uint32_t a = corner[(i + 1) % 3], b = corner[(i + 2) % 3];
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
  numerics::UnsetArray<CubicFit> fits(mesh.vertex_count);
  {
    const Neighbours neighbours(mesh);
    share(mesh.vertex_count, thread_count, [&] { return VertexFits(mesh, neighbours, fits, result.reaches_rim); });
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
