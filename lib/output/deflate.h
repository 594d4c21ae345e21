// SPDX-License-Identifier: Apache-2.0
// The zlib format for pictures. What repeats in a picture stands mostly at known distances: the pixel to the left, the row above.
// Matches are looked for there, and where the same six bytes were last seen at the beginning of a match or as single bytes. So a
// byte within a match costs a comparison, where compressors for any kind of data enter every byte into their tables: the sheets
// of lib/output/figure.h take half the time of libdeflate's, and no more bytes.
//
// Each call of add() makes one block of the stream, with Huffman codes of its own. The same bytes give the same stream on every
// machine.
//
// Source: RFC 1950 (zlib), P. Deutsch and J.-L. Gailly, and RFC 1951 (DEFLATE), P. Deutsch, 1996.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sagitta::output {

class ZlibStream {
 public:
  // Where to look for what repeats. Beyond 32768, which the format cannot tell, nothing is found.
  ZlibStream(std::size_t near, std::size_t far) : near_(near), far_(far) {}

  // Adds bytes[from], bytes[from + 1], ... Those before it must be the last ones that were added: matches may reach them.
  void add(std::span<const std::uint8_t> bytes, std::size_t from = 0);

  // The whole stream. The next add() begins another.
  std::string finish();

 private:
  struct Token {
    std::uint16_t symbol;    // a byte as it is, or 256 and the length of a match
    std::uint16_t distance;  // of the match; of a byte 0
  };

  void find_tokens(std::span<const std::uint8_t> bytes, std::size_t from);
  void write_block();

  std::size_t near_, far_;
  std::vector<std::uint32_t> seen_;  // where the bytes of a key were last met
  std::vector<Token> tokens_;
  std::array<std::uint32_t, 256 + 258 + 1> symbol_counts_{};
  std::array<std::uint32_t, 30> distance_counts_{};  // by their codes
  std::string out_ = begin;
  std::uint64_t pending_ = 0;  // the bits that do not fill a byte yet
  unsigned pending_count_ = 0;
  std::uint32_t checksum_ = 1;

  static constexpr const char* begin = "\x78\x01";  // RFC 1950: DEFLATE, a window of 32768 bytes, the fastest kind
};

}  // namespace sagitta::output
