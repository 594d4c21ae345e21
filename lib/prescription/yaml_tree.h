// SPDX-License-Identifier: Apache-2.0
// A YAML document as a plain tree with the place of every node, read strictly: bounded size, bounded depth, repeated
// keys found, aliases bounded. Everything that yaml-cpp would accept in silence or choke on is stopped here, so the
// readers above see only trees they can walk.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/prescription/diagnostics.h"

namespace sagitta::prescription {

struct YamlNode {
  enum class Kind { null, scalar, sequence, mapping };
  using Pointer = std::shared_ptr<const YamlNode>;
  struct Entry {
    std::string key;
    Place key_place;
    Pointer value;  // never null; an empty value is a node of Kind::null
  };

  Kind kind = Kind::null;
  Place place;
  std::string text;            // of a scalar
  bool quoted = false;         // a quoted scalar is a text even where it looks like a number
  int text_column = 0;         // of the first byte of a text that begins with '=' and stands in one line of the file as it is; else 0
  // Of such a text, where with_arithmetic() has been at work: what it comes to, or why it does not.
  struct Arithmetic {
    double value = 0;
    std::optional<Finding> fault;
  };
  std::shared_ptr<const Arithmetic> arithmetic;
  std::vector<Pointer> items;  // of a sequence
  std::vector<Entry> entries;  // of a mapping, in the order of the file; repeated keys are reported and kept once

  // The value of a key of a mapping; null pointer where there is none.
  Pointer find(std::string_view key) const;
};

// Limits: 1 MiB of text and 200,000 nodes, both with every alias expanded, nesting of 100. Beyond them, or for text that is not
// YAML (UTF-8, without tags), an error is added and the result is null. A missing, unreadable or empty file is an error
// too.
YamlNode::Pointer read_yaml(const std::string& file, Findings& findings);

// A number by std::from_chars: 1.5, -3e-4, +2, .5, .inf, -.inf, .nan; independent of the locale; the whole text must
// be used. False: not a number.
struct ParsedNumber {
  bool ok = false;
  double value = 0;
};
ParsedNumber parse_number(std::string_view text);

// What rays start from or meet is at most so large: rays multiply it, and products of three such numbers are numbers still.
inline constexpr double largest_number = 1e100;
// And, unless it is 0, at least so large: the square of its length, by which a direction is divided, is not 0.
inline constexpr double smallest_number = 1e-100;

}  // namespace sagitta::prescription
