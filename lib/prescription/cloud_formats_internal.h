// SPDX-License-Identifier: Apache-2.0
// What the readers of point clouds share: lines in bounded memory, numbers, and a bounded list of errors. One reader a
// format, listed in cloud_reader.cc.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "lib/prescription/cloud_reader.h"

namespace sagitta::prescription {

std::shared_ptr<const PointCloud> read_xyz(const CloudRequest& request, Findings& findings);
std::shared_ptr<const PointCloud> read_cso(const CloudRequest& request, Findings& findings);
std::shared_ptr<const PointCloud> read_polar(const CloudRequest& request, Findings& findings);
std::shared_ptr<const PointCloud> read_ply(const CloudRequest& request, Findings& findings);

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

// The lines of a text file, read a megabyte at a time. Ends LF or CRLF, the last one may lack its end; a UTF-8 byte
// order mark is dropped. What is no text (a zero byte, a line longer than a megabyte) ends the reading with a fault.
class LineReader {
 public:
  explicit LineReader(const std::string& file);

  bool next();                                  // false: at the end, or at a fault
  std::string_view line() const { return line_; }
  std::uint32_t number() const { return number_; }  // of the line, from 1; 0 before the first
  std::uint64_t offset() const { return before_ + begin_; }  // in the file, of what comes behind the line
  const std::string& fault() const { return fault_; }  // "" unless the file cannot be read on

 private:
  bool fill();

  std::unique_ptr<std::FILE, CloseFile> file_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // of what is unread in the buffer
  std::uint64_t before_ = 0;         // bytes of the file before the buffer
  bool at_end_ = false;
  std::string_view line_;
  std::uint32_t number_ = 0;
  std::string fault_;
};

enum class NumberFault { none, empty, garbage, infinite, out_of_range };
struct CloudNumber {
  NumberFault fault = NumberFault::none;
  double value = 0;  // finite, or NaN for `nan`
};
// The whole of a field without the blanks around it. `decimal_comma`: 1,5 is 1.5 (as well as 1.5).
CloudNumber parse_cloud_number(std::string_view field, bool decimal_comma);
// "no number", "infinite", ...: what is wrong with the value of a field.
std::string_view meaning_of(NumberFault fault);

// Without the spaces and tabs around it.
std::string_view trimmed(std::string_view text);
// Replaces `fields` by what stands between spaces and tabs.
void split_at_blanks(std::string_view line, std::vector<std::string_view>& fields);
// An excerpt of the file in quotes.
std::string quoted(std::string_view text);

// Errors of one file: the first hundred as findings, the rest as a count, so that a wrong file of any size is told of
// in a page. One excerpt a finding.
class CloudErrors {
 public:
  CloudErrors(std::string file, Findings& findings) : file_(std::move(file)), findings_(findings) {}

  Place at(std::uint32_t line, std::size_t column = 1) const {
    return {file_, static_cast<int>(line), static_cast<int>(column)};
  }
  void add(Place place, std::string what, std::string hint = {});
  bool none() const { return count_ == 0; }
  void finish();  // adds the count of those that were not told

 private:
  static constexpr std::size_t most = 100;
  std::string file_;
  Findings& findings_;
  std::size_t count_ = 0;
};

// Points of one kind that a note tells of: how many there are, and in which line the first one is.
struct Tally {
  std::size_t count = 0;
  std::uint32_t first_line = 0;

  void add(std::uint32_t line) {
    if (count++ == 0) first_line = line;
  }
  // "3 lines WHAT, the first one here: BECAME", where there are any.
  void tell(const CloudErrors& errors, Findings& findings, std::string_view what, std::string_view became) const;
};

}  // namespace sagitta::prescription
