// SPDX-License-Identifier: Apache-2.0
// Single values and mappings of a YAML tree, checked against keys. Every error reads "LABEL must be WHAT IS LEGAL, not
// WHAT STANDS THERE" at the place of the value; nothing is returned then.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/numerics/key.h"
#include "lib/prescription/diagnostics.h"
#include "lib/prescription/keys.h"
#include "lib/prescription/yaml_tree.h"

namespace sagitta::prescription {

// "LABEL must be LEGAL, not ..." at the node.
void refuse(const YamlNode& node, const std::string& label, const std::string& legal, Findings& findings);

std::optional<double> read_number(const YamlNode& node, const std::string& label, const numerics::Range& range,
                                  Findings& findings);
std::optional<bool> read_flag(const YamlNode& node, const std::string& label, Findings& findings);

// A text in one line: line ends become blanks. Only those of `choices` ("osa|noll") where it is not empty.
std::optional<std::string> read_text(const YamlNode& node, const std::string& label, std::string_view choices,
                                     Findings& findings);

// A list of exactly `components.size()` numbers, such as [x, y, z]; `components` names them, one letter each.
std::optional<std::vector<double>> read_tuple(const YamlNode& node, const std::string& label,
                                              std::string_view components, const numerics::Range& range,
                                              Findings& findings);

// {index: value, ...} or a list from the first index, by rising index.
std::optional<std::vector<std::pair<int, double>>> read_indexed(const YamlNode& node, const std::string& label,
                                                                const numerics::Range& range,
                                                                numerics::IndexRange indices, Findings& findings);

// A mapping with a table of keys. What does not fit the table is reported by the constructor; the readers then give the
// values of the keys that are there and legal.
class Section {
 public:
  Section(const YamlNode& node, std::string owner, KeyTable keys, Findings& findings);

  const YamlNode* find(std::string_view key) const { return node_.find(key).get(); }
  const Place& place() const { return node_.place; }
  const std::string& owner() const { return owner_; }
  Findings& findings() const { return findings_; }

  std::optional<double> number(std::string_view key) const;
  std::optional<bool> flag(std::string_view key) const;
  std::optional<std::string> text(std::string_view key) const;

  // The one entry whose key is in `alternatives`. Two are an error; none too, where one is required.
  const YamlNode::Entry* one_of(KeyTable alternatives, bool required) const;

 private:
  const numerics::Key& described(std::string_view key) const;

  const YamlNode& node_;
  std::string owner_;
  KeyTable keys_;
  Findings& findings_;
};

}  // namespace sagitta::prescription
