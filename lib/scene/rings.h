// SPDX-License-Identifier: Apache-2.0
// Topological rings: the vertices that share an edge with some vertices, those that share one with these, and so on. On
// data of rings or scan lines, where the nearest points in space all lie on one line, they are the right neighbours.
#pragma once

#include <array>
#include <initializer_list>
#include <span>
#include <vector>

#include "lib/surface/mesh.h"

namespace sagitta::scene {

// The vertices that share an edge with each vertex, as lists end to end.
class Neighbours {
 public:
  explicit Neighbours(const surface::Mesh& mesh) : begin_(mesh.vertex_count + 1, 0), is_on_rim_(mesh.vertex_count, false) {
    // Each facet gives each corner the next one anticlockwise: all neighbours of a vertex that facets surround. On a rim
    // the edge has no facet that would give it the other way round.
    std::vector<std::array<std::uint32_t, 2>> rim;
    for (std::uint32_t f = 0; f < mesh.facet_count; ++f) {
      const auto& [a, b, c] = mesh.corners[f];
      const auto& across = mesh.facets[f].neighbour;
      if (across[0] == surface::no_facet) rim.push_back({c, b});
      if (across[1] == surface::no_facet) rim.push_back({a, c});
      if (across[2] == surface::no_facet) rim.push_back({b, a});
    }
    for (const auto& [a, b] : rim) is_on_rim_[a] = is_on_rim_[b] = true;
    const auto for_each_pair = [&](auto&& take) {
      for (std::uint32_t f = 0; f < mesh.facet_count; ++f) {
        const auto& [a, b, c] = mesh.corners[f];
        take(a, b), take(b, c), take(c, a);
      }
      for (const auto& [a, b] : rim) take(a, b);
    };
    for_each_pair([&](std::uint32_t vertex, std::uint32_t) { ++begin_[vertex + 1]; });
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    list_.resize(begin_.back());
    std::vector<std::uint32_t> filled(begin_.begin(), begin_.end() - 1);
    for_each_pair([&](std::uint32_t vertex, std::uint32_t next) { list_[filled[vertex]++] = next; });
  }
  std::size_t vertex_count() const { return begin_.size() - 1; }
  std::span<const std::uint32_t> of(std::uint32_t vertex) const {
    return {list_.data() + begin_[vertex], begin_[vertex + 1] - begin_[vertex]};
  }
  // Or on a hole.
  bool is_on_rim(std::uint32_t vertex) const { return is_on_rim_[vertex]; }

 private:
  std::vector<std::uint32_t> begin_, list_;
  std::vector<char> is_on_rim_;
};

// Grows ring by ring around a set of vertices.
class Rings {
 public:
  explicit Rings(const Neighbours& neighbours) : neighbours_(neighbours), seen_(neighbours.vertex_count(), 0) {}

  void start(std::initializer_list<std::uint32_t> vertices) {
    ++round_;
    count_ = ring_begin_ = 0;
    take({vertices.begin(), vertices.end()});
  }
  void add_ring() {
    for (const std::size_t end = count_; ring_begin_ < end; ++ring_begin_) take(neighbours_.of(vertices_[ring_begin_]));
  }
  // All that are reached through vertices for which is_near holds.
  template <class IsNear>
  void add_all(IsNear&& is_near) {
    for (; ring_begin_ < count_; ++ring_begin_)
      for (const std::uint32_t next : neighbours_.of(vertices_[ring_begin_]))
        if (is_near(next)) take({&next, 1});
  }
  // In the order in which they were reached, the start first.
  std::span<const std::uint32_t> vertices() const { return {vertices_.data(), count_}; }

 private:
  // Without branches on what was seen, which nothing could predict.
  void take(std::span<const std::uint32_t> vertices) {
    if (vertices_.size() < count_ + vertices.size()) vertices_.resize(2 * (count_ + vertices.size()));
    std::uint32_t *const list = vertices_.data(), *const seen = seen_.data();
    const std::uint32_t round = round_;
    std::size_t count = count_;
    for (const std::uint32_t vertex : vertices) {
      list[count] = vertex;
      count += seen[vertex] != round;
      seen[vertex] = round;
    }
    count_ = count;
  }

  const Neighbours& neighbours_;
  std::vector<std::uint32_t> seen_;  // the round in which it was reached last
  std::uint32_t round_ = 0;
  std::vector<std::uint32_t> vertices_;
  std::size_t count_ = 0;
  std::size_t ring_begin_ = 0;       // where the last ring begins
};

}  // namespace sagitta::scene
