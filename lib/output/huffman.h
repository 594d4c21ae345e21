// SPDX-License-Identifier: Apache-2.0
// Huffman codes as DEFLATE has them (P. Deutsch, RFC 1951, 1996, 3.2.2): known by their lengths alone.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace sagitta::output {

template <std::size_t size>
struct HuffmanCodes {
  std::array<std::uint8_t, size> length{};  // in bits; 0: no code
  std::array<std::uint16_t, size> code{};   // as it stands in the stream, its first bit lowest
};

// Codes of no more than `longest` bits, for at least two symbols, which some readers want. Where the shortest stream takes longer
// ones, counts are made more alike until it does not. size <= 2^longest; the sum of the counts fits 32 bits.
template <std::size_t size>
HuffmanCodes<size> huffman_codes(std::array<std::uint32_t, size> counts, unsigned longest) {
  struct Node {
    std::uint32_t count;
    std::uint16_t parent, depth;
  };
  for (std::size_t symbol = 0; std::count(counts.begin(), counts.end(), 0U) > static_cast<std::ptrdiff_t>(size) - 2; ++symbol)
    counts[symbol] = std::max(1U, counts[symbol]);

  HuffmanCodes<size> result;
  std::array<std::uint64_t, size> leaves{};  // count and symbol, the rarest first
  std::array<Node, 2 * size> nodes{};        // the leaves; then what joins two nodes, by growing count, the root last
  for (unsigned deepest = longest + 1; deepest > longest;) {
    std::size_t leaf_count = 0;
    for (std::size_t symbol = 0; symbol < size; ++symbol)
      if (counts[symbol] > 0) leaves[leaf_count++] = (std::uint64_t{counts[symbol]} << 16U) | symbol;
    std::sort(leaves.begin(), leaves.begin() + static_cast<std::ptrdiff_t>(leaf_count));
    for (std::size_t i = 0; i < leaf_count; ++i) nodes[i].count = static_cast<std::uint32_t>(leaves[i] >> 16U);

    std::size_t leaf = 0, inner = leaf_count;
    const std::size_t root = 2 * leaf_count - 2;
    for (std::size_t made = leaf_count; made <= root; ++made) {
      nodes[made].count = 0;
      for (int child = 0; child < 2; ++child) {
        const bool leaf_is_next = leaf < leaf_count && (inner == made || nodes[leaf].count <= nodes[inner].count);
        Node& node = nodes[leaf_is_next ? leaf++ : inner++];
        node.parent = static_cast<std::uint16_t>(made);
        nodes[made].count += node.count;
      }
    }
    nodes[root].depth = 0;
    deepest = 0;
    for (std::size_t i = root; i-- > 0;) {
      nodes[i].depth = static_cast<std::uint16_t>(nodes[nodes[i].parent].depth + 1);
      if (i < leaf_count) {
        result.length[leaves[i] & 0xFFFFU] = static_cast<std::uint8_t>(nodes[i].depth);
        deepest = std::max<unsigned>(deepest, nodes[i].depth);
      }
    }
    for (std::uint32_t& count : counts) count = (count + 1) / 2;
  }

  std::array<std::uint32_t, 17> next{};  // the first code of each length, then the next one
  for (const std::uint8_t bits : result.length)
    if (bits > 0) ++next[bits + 1U];
  for (std::size_t bits = 2; bits < next.size(); ++bits) next[bits] = (next[bits] + next[bits - 1]) << 1U;
  for (std::size_t symbol = 0; symbol < size; ++symbol) {
    const unsigned bits = result.length[symbol];
    if (bits == 0) continue;
    const std::uint32_t code = next[bits]++;
    for (unsigned bit = 0; bit < bits; ++bit)
      result.code[symbol] = static_cast<std::uint16_t>(result.code[symbol] | (code >> bit & 1U) << (bits - 1 - bit));
  }
  return result;
}

}  // namespace sagitta::output
