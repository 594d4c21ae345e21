// SPDX-License-Identifier: Apache-2.0
#include "lib/output/deflate.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>

#include "lib/output/huffman.h"

namespace sagitta::output {
namespace {

static_assert(std::endian::native == std::endian::little, "bytes are compared and written as the words that they make");

constexpr std::size_t longest_match = 258, farthest = 32768;
constexpr std::size_t least_near_match = 3, least_far_match = 6;  // a far match takes a dozen bits more
constexpr std::size_t good_match = 32;                            // better ones are not looked for
constexpr std::uint32_t never = std::numeric_limits<std::uint32_t>::max();

// How many bytes agree, `most` at most.
std::size_t agreement(const std::uint8_t* a, const std::uint8_t* b, std::size_t most) {
  std::size_t count = 0;
  for (; count + 8 <= most; count += 8) {
    std::uint64_t p = 0, q = 0;
    std::memcpy(&p, a + count, 8);
    std::memcpy(&q, b + count, 8);
    if (p != q) return count + static_cast<std::size_t>(std::countr_zero(p ^ q)) / 8;
  }
  while (count < most && a[count] == b[count]) ++count;
  return count;
}

// The place of six bytes among 8192; eight are read.
std::size_t key_of(const std::uint8_t* bytes) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  return static_cast<std::size_t>(((word << 16U) * 0x9E3779B97F4A7C15U) >> 51U);  // 2^64 over the golden ratio
}

// How a length or a distance is written: a code, and bits that follow it (RFC 1951, 3.2.5).
struct Value {
  std::uint16_t code, extra_bits, extra;
};

// The codes of 3.2.5 for v = 0, 1, ...: the first 2^(k+1) for one v each, then for each further bit of v another 2^k.
constexpr Value value_of(unsigned v, unsigned k) {
  const unsigned width = static_cast<unsigned>(std::bit_width(v)), extra_bits = width <= k + 1 ? 0 : width - k - 1;
  return {static_cast<std::uint16_t>((extra_bits << k) + (v >> extra_bits)), static_cast<std::uint16_t>(extra_bits),
          static_cast<std::uint16_t>(v & ((1U << extra_bits) - 1))};
}

constexpr Value distance_value(unsigned distance) { return value_of(distance - 1, 1); }

constexpr std::size_t bytes_as_they_are = 256;
constexpr std::uint16_t end_of_block = 256;  // bytes are codes 0 to 255
constexpr auto length_values = [] {
  std::array<Value, longest_match + 1> values{};
  for (unsigned length = 3; length < longest_match; ++length) {
    values[length] = value_of(length - 3, 2);
    values[length].code = static_cast<std::uint16_t>(values[length].code + end_of_block + 1);
  }
  values[longest_match] = {285, 0, 0};
  return values;
}();

}  // namespace

void ZlibStream::find_tokens(std::span<const std::uint8_t> bytes, std::size_t from) {
  tokens_.clear();
  symbol_counts_.fill(0);
  distance_counts_.fill(0);
  seen_.assign(8192, never);
  for (std::size_t at = from; at < bytes.size();) {
    const std::uint8_t* here = bytes.data() + at;
    const std::size_t most = std::min(longest_match, bytes.size() - at);
    std::size_t length = 0, distance = 0;
    const auto look_at = [&](std::size_t candidate, std::size_t least) {
      if (candidate > at || candidate > farthest) return;
      if (const std::size_t found = agreement(here, here - candidate, most); found >= least) length = found, distance = candidate;
    };
    look_at(near_, least_near_match);
    if (length < most) look_at(far_, std::max(least_far_match, length + 3));
    if (length < good_match && most >= sizeof(std::uint64_t)) {
      std::uint32_t& seen = seen_[key_of(here)];
      if (seen != never) look_at(at - seen, std::max(least_far_match, length + 1));
      seen = static_cast<std::uint32_t>(at);
    }
    const std::size_t symbol = length > 0 ? bytes_as_they_are + length : *here;
    tokens_.push_back({static_cast<std::uint16_t>(symbol), static_cast<std::uint16_t>(distance)});
    ++symbol_counts_[symbol];
    if (length > 0) ++distance_counts_[distance_value(static_cast<unsigned>(distance)).code];
    at += std::max<std::size_t>(1, length);
  }
}

void ZlibStream::write_block() {
  std::array<std::uint32_t, 286> counts{};
  std::array<std::uint32_t, 19> length_counts{};
  std::copy_n(symbol_counts_.begin(), bytes_as_they_are, counts.begin());
  for (std::size_t length = 3; length <= longest_match; ++length) counts[length_values[length].code] += symbol_counts_[bytes_as_they_are + length];
  counts[end_of_block] = 1;
  const auto codes = huffman_codes(counts, 15);
  const auto distance_codes = huffman_codes(distance_counts_, 15);
  for (const std::uint8_t length : codes.length) ++length_counts[length];
  for (const std::uint8_t length : distance_codes.length) ++length_counts[length];
  const auto length_codes = huffman_codes(length_counts, 7);

  const std::size_t before = out_.size();
  constexpr std::size_t most_of_header = 300, most_of_token = 6;  // 48 bits
  out_.resize(before + most_of_header + most_of_token * (tokens_.size() + 1) + sizeof pending_);
  char* to = out_.data() + before;
  std::uint64_t pending = pending_;
  unsigned pending_count = pending_count_;
  const auto put = [&](std::uint64_t bits, unsigned bit_count) {
    pending |= bits << pending_count;
    pending_count += bit_count;
  };
  const auto put_code = [&](const auto& all, std::size_t symbol) { put(all.code[symbol], all.length[symbol]); };
  const auto flush = [&] {  // after at most 56 bits
    std::memcpy(to, &pending, sizeof pending);
    to += pending_count / 8;
    pending >>= pending_count & ~7U;
    pending_count &= 7U;
  };
  put(0b100, 3);  // not the last one, with codes of its own
  put(codes.code.size() - 257, 5);
  put(distance_codes.code.size() - 1, 5);
  put(length_codes.code.size() - 4, 4);
  for (const std::size_t symbol : {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15}) put(length_codes.length[symbol], 3), flush();
  for (const std::uint8_t length : codes.length) put_code(length_codes, length), flush();
  for (const std::uint8_t length : distance_codes.length) put_code(length_codes, length), flush();
  // What stands for each symbol, and for each distance's code, the last of them for none: no branch depends on what comes next.
  struct Bits {
    std::uint32_t bits = 0, count = 0;
  };
  std::array<Bits, 256 + longest_match + 1> of_symbol{};
  for (std::size_t byte = 0; byte < bytes_as_they_are; ++byte) of_symbol[byte] = {codes.code[byte], codes.length[byte]};
  for (std::size_t length = 3; length <= longest_match; ++length) {
    const Value& value = length_values[length];
    const std::uint32_t count = codes.length[value.code];
    of_symbol[bytes_as_they_are + length] = {codes.code[value.code] | std::uint32_t{value.extra} << count, count + value.extra_bits};
  }
  std::array<Bits, distance_codes.code.size() + 1> of_distance{};
  for (std::size_t code = 0; code < distance_codes.code.size(); ++code) of_distance[code] = {distance_codes.code[code], distance_codes.length[code]};
  for (const Token& token : tokens_) {
    const Value distance = distance_value(std::max<unsigned>(1, token.distance));
    const Bits& symbol = of_symbol[token.symbol];
    const Bits& code = of_distance[token.distance > 0 ? distance.code : of_distance.size() - 1];
    put(symbol.bits, symbol.count);
    put(code.bits, code.count);
    put(distance.extra, distance.extra_bits);
    flush();
  }
  put_code(codes, end_of_block);
  flush();
  out_.resize(static_cast<std::size_t>(to - out_.data()));
  pending_ = pending;
  pending_count_ = pending_count;
}

void ZlibStream::add(std::span<const std::uint8_t> bytes, std::size_t from) {
  checksum_ = libdeflate_adler32(checksum_, bytes.data() + from, bytes.size() - from);
  find_tokens(bytes, from);
  write_block();
}

std::string ZlibStream::finish() {
  pending_ |= std::uint64_t{0b011} << pending_count_;  // the last block, with the codes of the standard, whose end is seven zeros
  for (unsigned bit = 0; bit < pending_count_ + 10; bit += 8) out_.push_back(static_cast<char>(pending_ >> bit & 0xFFU));
  for (const unsigned shift : {24U, 16U, 8U, 0U}) out_.push_back(static_cast<char>(checksum_ >> shift & 0xFFU));
  pending_ = 0;
  pending_count_ = 0;
  checksum_ = 1;
  return std::exchange(out_, begin);
}

}  // namespace sagitta::output
