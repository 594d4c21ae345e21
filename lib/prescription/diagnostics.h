// SPDX-License-Identifier: Apache-2.0
// What a reader has to say about a file: findings with a place, all of them in one run. Input errors are values, never
// exceptions, and no reader prints.
#pragma once

#include <string>
#include <vector>

namespace sagitta::prescription {

// Lines and columns count from 1; line 0 means the file as a whole (printed as 1:1). Columns count bytes. Line -1: `file` is no
// file but an option of the command line, and is printed alone.
struct Place {
  std::string file;
  int line = 0;
  int column = 0;
};

inline bool is_of_command_line(const Place& place) { return place.line == -1; }

enum class Severity { error, warning, note };

struct Finding {
  Place place;
  Severity severity = Severity::error;
  std::string what;  // what is wrong, with the value and the legal range
  std::string hint;  // what to do; empty where there is nothing to add
};

inline constexpr int most_told_errors = 100;  // that are told of one file and what it extends

class Findings {
 public:
  void add(Finding finding);
  void error(Place place, std::string what, std::string hint = {});
  void warning(Place place, std::string what, std::string hint = {});
  void note(Place place, std::string what, std::string hint = {});

  // What is added from here on is counted, and no longer told: readers need not look for hints.
  bool is_full() const { return error_count_ >= most_told_errors; }
  bool has_errors() const { return error_count_ > 0; }
  int error_count() const { return error_count_; }
  const std::vector<Finding>& all() const { return findings_; }

 private:
  std::vector<Finding> findings_;
  int error_count_ = 0;
};

// "file:line:column: error: what", or "--option: error: what", and, where there is a hint, a second line "  hint: ...".
std::string format(const Finding& finding);

// The candidate nearest to `given` by edit distance, of the first 1000, or "" where none is near: for "did you mean ...".
std::string nearest_name(const std::string& given, const std::vector<std::string>& candidates);

// "a, b, c and 7 more": the first 12 names, an excerpt of each.
std::string listed(const std::vector<std::string>& names);

// At most 40 bytes of somebody's text, control characters and broken UTF-8 made harmless, "..." where it was cut.
std::string excerpt(const std::string& text);

}  // namespace sagitta::prescription
