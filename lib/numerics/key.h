// SPDX-License-Identifier: Apache-2.0
// One key of a table: its name, what kind of value it takes, the legal range, and what it means. Readers check input
// against such tables, so that a key is described once, beside the code that uses its value.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace sagitta::numerics {

enum class ValueKind {
  number,    // 7.72; .inf where the range allows it
  flag,      // true | false
  text,      // one of `choices` where those are given, else any text
  file,      // the name of a file
  vector3,   // [x, y, z]
  indexed,   // {index: value, ...} or a list that counts from the first index
  medium,    // a name or {index: ...} or {nd: ..., vd: ...} or {grin: ...} or mirror
  homogeneous_medium,  // of these neither a gradient nor a mirror
  mapping,   // has a table of keys of its own
  list       // a list with a checker of its own
};

// The legal values of a number. Checks are written so that NaN fails.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool open = false;       // the ends low and high are themselves illegal
  bool zero = true;        // zero is legal
  bool infinite = false;   // +-infinity is legal (where low and high allow it)
  bool whole = false;      // only whole numbers are legal
  std::string_view reason = {};  // why the ends are where they are, for those who come to them

  bool contains(double v) const {
    const bool inside = open ? (v > low && v < high) : (v >= low && v <= high);
    const bool is_infinite = v == std::numeric_limits<double>::infinity() || v == -std::numeric_limits<double>::infinity();
    if (is_infinite) return infinite && v >= low && v <= high;
    return inside && (zero || v != 0) && (!whole || v == std::trunc(v));
  }
};
inline constexpr Range any_number{};
inline constexpr Range positive{0, std::numeric_limits<double>::infinity(), true};
inline constexpr Range not_negative{0};
inline constexpr Range nonzero_or_infinite{.zero = false, .infinite = true};

// The legal indices of an `indexed` value; a list counts from the first, where it can be meant.
struct IndexRange {
  int first = 0, last = 100'000, step = 1;
  bool is_list = true;

  bool contains(int index) const { return index >= first && index <= last && (index - first) % step == 0; }
};

struct Key {
  std::string_view name;
  ValueKind kind = ValueKind::number;
  std::string_view meaning;          // one line for the user, without a full stop
  bool required = false;
  Range range = any_number;          // of a number, and of each element of a vector
  double fallback = 0;               // of a number that is not given
  std::string_view choices = {};     // of a text: "osa|noll|fringe"; the first is the default unless required
  // Of an `indexed` value: the rule of its indices, and the key of the choice, earlier in the table, that they depend on, if any.
  std::string_view indexed_by = {};
  IndexRange (*indices)(std::string_view choice) = nullptr;  // none: IndexRange{}
  // Of a key that only some choices have a use for: the key of the choice, earlier in the table, and those choices.
  std::string_view only_with = {}, only_choices = {};
};

// The words of `choices`, "osa|noll|fringe".
inline std::vector<std::string> words_of(std::string_view choices) {
  std::vector<std::string> words;
  for (; !choices.empty(); choices.remove_prefix(std::min(choices.size(), words.back().size() + 1)))
    words.emplace_back(choices.substr(0, choices.find('|')));
  return words;
}

}  // namespace sagitta::numerics
