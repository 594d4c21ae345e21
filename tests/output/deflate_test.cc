// SPDX-License-Identifier: Apache-2.0
#include "lib/output/deflate.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>
#include <random>

#include "lib/output/huffman.h"

namespace sagitta::output {
namespace {

using Bytes = std::vector<std::uint8_t>;

// What zlib makes of a stream of `size` bytes; nothing where it finds fault with it, or bytes behind it.
Bytes inflated(const std::string& stream, std::size_t size) {
  Bytes bytes(size + 1);
  uLongf given = bytes.size();
  uLong taken = stream.size();
  const int fault = uncompress2(bytes.data(), &given, reinterpret_cast<const Bytef*>(stream.data()), &taken);
  if (fault != Z_OK || taken != stream.size()) return {};
  bytes.resize(given);
  return bytes;
}

std::string packed(const Bytes& bytes, std::size_t near, std::size_t far) {
  ZlibStream stream(near, far);
  stream.add(bytes);
  return stream.finish();
}

// Runs, rows that return, and noise of `kinds` bytes, in random order.
Bytes picture_like(std::mt19937& random, std::size_t size, std::size_t row, unsigned kinds) {
  Bytes bytes;
  while (bytes.size() < size) {
    const std::size_t count = std::min<std::size_t>(size - bytes.size(), 1 + random() % 700);
    switch (random() % 3) {
      case 0: bytes.insert(bytes.end(), count, static_cast<std::uint8_t>(random())); break;
      case 1:
        for (std::size_t i = 0; i < count; ++i) bytes.push_back(bytes.size() >= row ? bytes[bytes.size() - row] : std::uint8_t{7});
        break;
      default:
        for (std::size_t i = 0; i < count; ++i) bytes.push_back(static_cast<std::uint8_t>(random() % kinds));
    }
  }
  return bytes;
}

TEST(ZlibStream, IsWhatZlibReads) {
  std::mt19937 random(1);
  std::size_t checked = 0;
  for (const std::size_t size : {1, 2, 3, 7, 8, 9, 257, 258, 259, 260, 5000, 70000, 200000})
    for (const std::size_t far : {1, 6, 100, 32767, 32768, 32769, 100000})
      for (const unsigned kinds : {1, 2, 3, 17, 256}) {
        const Bytes bytes = picture_like(random, size, far, kinds);
        EXPECT_EQ(inflated(packed(bytes, 3, far), size), bytes) << size << " " << far << " " << kinds;
        ++checked;
      }
  EXPECT_EQ(checked, 13U * 7 * 5);
}

TEST(ZlibStream, NoBytesAreAStreamToo) {
  ZlibStream stream(1, 2);
  const std::string none = stream.finish();
  EXPECT_EQ(none, std::string("\x78\x01\x03\x00\x00\x00\x00\x01", 8));  // RFC 1950 and 1951, by hand
  stream.add({});
  EXPECT_EQ(inflated(stream.finish(), 0), Bytes());
}

TEST(ZlibStream, BlocksFollowOneAnotherAndReachBack) {
  std::mt19937 random(2);
  constexpr std::size_t row = 300;
  const Bytes bytes = picture_like(random, 40 * row, row, 5);
  ZlibStream stream(3, row);
  for (int round = 0; round < 2; ++round) {  // a finished stream begins another
    stream.add(std::span(bytes).first(row));
    for (std::size_t i = 1; i < 40; ++i) stream.add(std::span(bytes).subspan((i - 1) * row, 2 * row), row);
    EXPECT_EQ(inflated(stream.finish(), bytes.size()), bytes);
  }

  Bytes noise(row);  // a second row like the first says nothing new, if the second block sees the first
  for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random());
  Bytes twice = noise;
  twice.insert(twice.end(), noise.begin(), noise.end());
  ZlibStream once(3, row), again(3, row);
  once.add(noise);
  again.add(noise);
  again.add(twice, row);
  const std::string stream_of_two = again.finish();
  EXPECT_EQ(inflated(stream_of_two, twice.size()), twice);
  EXPECT_LT(stream_of_two.size(), once.finish().size() + 100);
}

TEST(ZlibStream, WhatRepeatsAtTheGivenDistancesIsPackedAway) {
  std::mt19937 random(3);
  Bytes row(6000), rows;
  for (std::uint8_t& byte : row) byte = static_cast<std::uint8_t>(random());
  for (int i = 0; i < 20; ++i) rows.insert(rows.end(), row.begin(), row.end());
  EXPECT_LT(packed(rows, 3, row.size()).size(), row.size() + 1500);  // 19 rows by 24 matches of less than 24 bits each
  const Bytes flat(1000000, 9);
  EXPECT_LT(packed(flat, 1, 5000).size(), 1200U);  // 3876 matches of 2 bits
}

TEST(ZlibStream, WhatReturnsFromElsewhereIsFoundByItsFirstBytes) {
  std::mt19937 random(6);
  Bytes bytes(4000);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  bytes.insert(bytes.end(), bytes.begin(), bytes.begin() + 3000);  // 4000 back, at neither of the distances
  const std::string stream = packed(bytes, 3, 100);
  EXPECT_EQ(inflated(stream, bytes.size()), bytes);
  EXPECT_LT(stream.size(), 4000U + 500);
}

// The bits that the best codes of all take: Huffman's own way, without a limit.
std::uint64_t least_bits(const auto& counts) {
  std::priority_queue<std::uint64_t, std::vector<std::uint64_t>, std::greater<>> queue;
  for (const std::uint32_t count : counts)
    if (count > 0) queue.push(count);
  std::uint64_t bits = 0;
  while (queue.size() > 1) {
    std::uint64_t sum = queue.top();
    queue.pop();
    sum += queue.top();
    queue.pop();
    bits += sum;
    queue.push(sum);
  }
  return bits;
}

TEST(HuffmanCodes, AreTheShortestAndNoneBeginsAnother) {
  std::mt19937 random(4);
  for (int round = 0; round < 300; ++round) {
    std::array<std::uint32_t, 60> counts{};
    const std::size_t used = 2 + random() % 59;
    for (std::size_t i = 0; i < used; ++i) counts[i] = 1 + static_cast<std::uint32_t>(random() % (1 + round * round));
    std::shuffle(counts.begin(), counts.end(), random);
    const auto codes = huffman_codes(counts, 15);
    std::uint64_t bits = 0, kraft = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      EXPECT_EQ(codes.length[i] > 0, counts[i] > 0);
      bits += std::uint64_t{counts[i]} * codes.length[i];
      if (codes.length[i] > 0) kraft += 1U << (15U - codes.length[i]);
      for (std::size_t j = 0; j < i; ++j) {
        const unsigned shorter = std::min(codes.length[i], codes.length[j]);
        EXPECT_TRUE(shorter == 0 || ((codes.code[i] ^ codes.code[j]) & ((1U << shorter) - 1)) != 0);
      }
    }
    EXPECT_EQ(bits, least_bits(counts));
    EXPECT_EQ(kraft, 1U << 15U);  // and no bit is left unused
  }
}

TEST(HuffmanCodes, AreNoLongerThanIsAsked) {
  std::array<std::uint32_t, 30> fibonacci{1, 1};  // its best codes have 29 bits
  for (std::size_t i = 2; i < fibonacci.size(); ++i) fibonacci[i] = fibonacci[i - 1] + fibonacci[i - 2];
  for (const unsigned longest : {5U, 7U, 15U}) {
    const auto codes = huffman_codes(fibonacci, longest);
    double kraft = 0;
    for (const std::uint8_t length : codes.length) kraft += std::ldexp(1.0, -length);
    EXPECT_EQ(kraft, 1);
    EXPECT_LE(*std::max_element(codes.length.begin(), codes.length.end()), longest);
  }
}

TEST(HuffmanCodes, AreTwoAtLeast) {
  for (const std::size_t used : {0, 1, 5}) {
    std::array<std::uint32_t, 30> counts{};
    if (used > 0) counts[used] = 100;
    const auto codes = huffman_codes(counts, 15);
    EXPECT_EQ(std::accumulate(codes.length.begin(), codes.length.end(), 0), 2);
  }
}

}  // namespace
}  // namespace sagitta::output
