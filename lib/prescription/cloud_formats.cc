// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <system_error>

#include "lib/prescription/cloud_formats_internal.h"

namespace sagitta::prescription {
namespace {

// Grows with the lines, so that a small file takes little memory.
constexpr std::size_t first_buffer_bytes = std::size_t{1} << 16, most_buffer_bytes = std::size_t{1} << 20;

std::string reason_of(int error) { return "cannot be read: " + std::generic_category().message(error); }

}  // namespace

LineReader::LineReader(const std::string& file) : file_(std::fopen(file.c_str(), "rb")), buffer_(first_buffer_bytes) {
  if (!file_) fault_ = reason_of(errno);
}

// Moves what is unread to the front and reads on behind it.
bool LineReader::fill() {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  before_ += begin_;
  begin_ = 0;
  if (end_ == buffer_.size()) {
    if (end_ == most_buffer_bytes) {
      fault_ = "a line of more than a megabyte: this is no text of points";
      return false;
    }
    buffer_.resize(2 * end_);
  }
  const std::size_t wanted = buffer_.size() - end_;
  const std::size_t got = std::fread(buffer_.data() + end_, 1, wanted, file_.get());
  if (got < wanted) {
    if (std::ferror(file_.get())) {
      fault_ = reason_of(errno);
      return false;
    }
    at_end_ = true;
  }
  end_ += got;
  return true;
}

bool LineReader::next() {
  if (!fault_.empty()) return false;
  const char* stop = nullptr;
  for (std::size_t searched = 0;;) {
    stop = static_cast<const char*>(std::memchr(buffer_.data() + begin_ + searched, '\n', end_ - begin_ - searched));
    if (stop || at_end_) break;
    searched = end_ - begin_;
    if (!fill()) {
      ++number_;
      return false;
    }
  }
  if (!stop && begin_ == end_) return false;
  if (number_ == std::numeric_limits<std::int32_t>::max()) {
    fault_ = "more than 2147483647 lines";
    return false;
  }
  ++number_;
  const char* start = buffer_.data() + begin_;
  line_ = {start, static_cast<std::size_t>((stop ? stop : buffer_.data() + end_) - start)};
  begin_ = stop ? static_cast<std::size_t>(stop + 1 - buffer_.data()) : end_;
  if (number_ == 1 && line_.starts_with("\xEF\xBB\xBF")) line_.remove_prefix(3);
  if (line_.ends_with('\r')) line_.remove_suffix(1);
  if (std::memchr(line_.data(), '\0', line_.size())) {
    fault_ = "a zero byte: this is no text of points (UTF-8 or Latin-1 is read, UTF-16 is not)";
    return false;
  }
  return true;
}

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

void split_at_blanks(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  for (const char *at = line.data(), *end = at + line.size();;) {
    while (at != end && is_blank(*at)) ++at;
    if (at == end) return;
    const char* const begin = at;
    while (at != end && !is_blank(*at)) ++at;
    fields.emplace_back(begin, static_cast<std::size_t>(at - begin));
  }
}

std::string quoted(std::string_view text) { return fmt::format("\"{}\"", excerpt(std::string(trimmed(text)))); }

CloudNumber parse_cloud_number(std::string_view field, bool decimal_comma) {
  field = trimmed(field);
  if (field.empty()) return {NumberFault::empty};
  std::array<char, 64> copy;
  if (decimal_comma) {
    if (const std::size_t comma = field.find(','); comma != std::string_view::npos) {
      if (field.size() > copy.size() || field.find('.') != std::string_view::npos) return {NumberFault::garbage};
      std::copy(field.begin(), field.end(), copy.begin());
      copy[comma] = '.';
      field = {copy.data(), field.size()};
    }
  }
  if (field.starts_with('+') && !field.starts_with("+-")) field.remove_prefix(1);
  double value = 0;
  const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (end != field.data() + field.size() || status == std::errc::invalid_argument) return {NumberFault::garbage};
  if (status == std::errc::result_out_of_range) return {NumberFault::out_of_range};
  if (std::isinf(value)) return {NumberFault::infinite};
  return {NumberFault::none, value};
}

std::string_view meaning_of(NumberFault fault) {
  switch (fault) {
    case NumberFault::empty: return "missing";
    case NumberFault::garbage: return "no number";
    case NumberFault::infinite: return "infinite";
    case NumberFault::out_of_range: return "outside the range of numbers (1e-308 to 1e308)";
    case NumberFault::none: break;
  }
  return {};
}

void CloudErrors::add(Place place, std::string what, std::string hint) {
  if (++count_ <= most) findings_.error(std::move(place), std::move(what), std::move(hint));
}

void CloudErrors::finish() {
  if (count_ > most) findings_.note({file_, 0, 0}, fmt::format("{} more errors in this file", count_ - most));
}

void Tally::tell(const CloudErrors& errors, Findings& findings, std::string_view what, std::string_view became) const {
  if (count == 0) return;
  findings.note(errors.at(first_line),
                fmt::format("{} {} {}, the first one here: {}", count, count == 1 ? "line" : "lines", what, became));
}

}  // namespace sagitta::prescription
