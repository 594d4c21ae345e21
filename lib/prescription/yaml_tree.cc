// SPDX-License-Identifier: Apache-2.0
// yaml-cpp's parser hands over one event a node, and the tree is built here, so that every rule of the header is held
// while the file is being read: an exception out of an event ends the parse. YAML::Load is not used: it keeps the first
// of repeated keys in silence.
//
// Why the text is small: yaml-cpp keeps every token of an open flow collection, with up to 240 bytes for one byte of
// the file ("[") and 170 for others ("[:"), before it hands over the first event.
#include "lib/prescription/yaml_tree.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <limits>
#include <optional>
#include <sstream>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "lib/prescription/text_file.h"
#include "lib/prescription/utf8.h"

namespace sagitta::prescription {
namespace {

constexpr std::size_t most_bytes = std::size_t{1} << 20;
constexpr std::size_t most_nodes = 200'000;
constexpr std::size_t most_depth = 100;
const std::string too_much_text = "more than " + std::to_string(most_bytes >> 20) + " MiB of text, with every alias expanded";
const std::string too_many_values = "more than " + std::to_string(most_nodes) + " values, with every alias expanded";

// Ends the parse with one finding.
struct Stop {
  Place place;
  std::string what, hint;
};

class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(std::string file, std::string_view source) : file_(std::move(file)), source_(source) {}

  YamlNode::Pointer root;
  std::vector<Stop> repeated_keys;

  Place place(const YAML::Mark& mark) const { return {file_, mark.line + 1, mark.column + 1}; }

 private:
  struct Subtree {
    YamlNode::Pointer node;
    std::size_t size = 1, height = 1, bytes = 0;  // in nodes, and of text, every alias expanded
  };
  struct Open {  // a list or mapping that has not ended yet
    std::shared_ptr<YamlNode> node;
    YAML::anchor_t anchor;
    std::size_t size = 1, height = 1, bytes = 0;
    std::optional<std::pair<std::string, Place>> key = std::nullopt;  // of a mapping, while its value is awaited
    std::unordered_map<std::string, int> key_lines = {};
  };

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (root) throw Stop{place(mark), "not YAML: a second document, or text outside the first one, begins here", ""};
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { leaf(mark, anchor, YamlNode::Kind::null); }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    const bool quoted = tag == "!" || tag == "tag:yaml.org,2002:str";
    if (!quoted) refuse_tag(mark, tag);
    for (std::string_view rest = text; !rest.empty(); rest.remove_prefix(1))
      if (starts_with_control(rest) && rest[0] != '\n' && rest[0] != '\t')
        throw Stop{place(mark), "a control character in '" + excerpt(text) + "'",
                   "leave out the escape sequence that makes it"};
    leaf(mark, anchor, YamlNode::Kind::scalar, text, quoted);
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchored_.find(anchor);
    if (found == anchored_.end()) throw Stop{place(mark), "not YAML: an alias inside the node that it names", ""};
    count(mark, found->second);
    add(found->second, place(mark));
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlNode::Kind::sequence);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlNode::Kind::mapping);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapEnd() override { close(); }

  void refuse_tag(const YAML::Mark& mark, const std::string& tag) const {
    if (tag != "?" && tag != "!")
      throw Stop{place(mark), "the tag '" + excerpt(tag) + "' is not read here", "leave it out"};
  }

  void count(const YAML::Mark& mark, const Subtree& subtree) {
    node_count_ += subtree.size;
    byte_count_ += subtree.bytes;
    if (node_count_ > most_nodes) throw Stop{place(mark), too_many_values, ""};
    if (byte_count_ > most_bytes) throw Stop{place(mark), too_much_text, ""};
    if (open_.size() + subtree.height > most_depth)
      throw Stop{place(mark), "nested more than " + std::to_string(most_depth) + " deep", ""};
  }

  void leaf(const YAML::Mark& mark, YAML::anchor_t anchor, YamlNode::Kind kind, const std::string& text = {},
            bool quoted = false) {
    auto node = std::make_shared<YamlNode>();
    node->kind = kind;
    // An empty value stands nowhere; yaml-cpp gives the place of whatever comes next.
    node->place =
        kind == YamlNode::Kind::null && !open_.empty() && open_.back().key ? open_.back().key->second : place(mark);
    node->text = text;
    node->quoted = quoted;
    if (text.starts_with('=') && text.find('\n') == std::string::npos) node->text_column = column_of_text(mark, text);
    const Subtree subtree{node, 1, 1, text.size()};
    count(mark, subtree);
    add(subtree, node->place);
    if (anchor) anchored_[anchor] = subtree;
  }

  void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YamlNode::Kind kind) {
    refuse_tag(mark, tag);
    count(mark, Subtree{});
    if (!open_.empty() && open_.back().node->kind == YamlNode::Kind::mapping && !open_.back().key)
      throw Stop{place(mark), "a key must be a plain text, not a list or a mapping", ""};
    open_.push_back({std::make_shared<YamlNode>(), anchor});
    open_.back().node->kind = kind;
    open_.back().node->place = place(mark);
  }

  void close() {
    Open ended = std::move(open_.back());
    open_.pop_back();
    const Subtree subtree{ended.node, ended.size, ended.height, ended.bytes};
    if (ended.anchor) anchored_[ended.anchor] = subtree;
    add(subtree, ended.node->place);
  }

  // Puts a finished node where it belongs: the root, the next item of a list, or the next key or value of a mapping.
  void add(const Subtree& child, const Place& where) {
    if (open_.empty()) {
      root = child.node;
      return;
    }
    Open& parent = open_.back();
    parent.size += child.size;
    parent.bytes += child.bytes;
    parent.height = std::max(parent.height, child.height + 1);
    if (parent.node->kind == YamlNode::Kind::sequence) {
      parent.node->items.push_back(child.node);
    } else if (!parent.key) {
      if (child.node->kind != YamlNode::Kind::scalar) throw Stop{where, "a key must be a plain text", ""};
      parent.key.emplace(child.node->text, where);
    } else {
      auto [key, key_place] = *std::exchange(parent.key, std::nullopt);
      const auto [first, is_new] = parent.key_lines.emplace(key, key_place.line);
      if (is_new)
        parent.node->entries.push_back({std::move(key), std::move(key_place), child.node});
      else
        repeated_keys.push_back({key_place, "the key '" + excerpt(key) + "' is repeated",
                                 "it stands on line " + std::to_string(first->second) + " already"});
    }
  }

  // Behind the quote, of a quoted one.
  int column_of_text(const YAML::Mark& mark, const std::string& text) const {
    for (int quote = 0; quote <= 1; ++quote)
      if (const auto from = static_cast<std::size_t>(mark.pos + quote); from <= source_.size() && source_.substr(from, text.size()) == text)
        return mark.column + 1 + quote;
    return 0;
  }

  std::string file_;
  std::string_view source_;
  std::vector<Open> open_;
  std::unordered_map<YAML::anchor_t, Subtree> anchored_;
  std::size_t node_count_ = 0, byte_count_ = 0;
};

// What yaml-cpp says. Some of its messages end with text of the file, of any length.
std::string message_of(const YAML::Exception& fault) {
  namespace messages = YAML::ErrorMsg;
  for (const std::string known : {messages::YAML_VERSION, messages::INVALID_ESCAPE})
    if (fault.msg.starts_with(known)) return known + "'" + excerpt(fault.msg.substr(known.size())) + "'";
  return fault.msg;
}

std::string hint_of(const YAML::Exception& fault) {
  namespace messages = YAML::ErrorMsg;
  for (const std::string known : {messages::MAP_KEY, messages::MAP_VALUE, messages::BLOCK_ENTRY})
    if (fault.msg == known) return "a text that holds ': ' needs quotes, and lines are indented with blanks, not tabs";
  return {};
}

// YAML admits no control characters but tab and the line ends; yaml-cpp would stop at some of them in silence.
bool is_plain_text(const std::string& file, const std::string& text, Findings& findings) {
  if (has_utf_16_mark(text) || is_utf_16_without_mark(text)) {
    findings.error({file}, "UTF-16, which is not read here", "save the file as UTF-8");
    return false;
  }
  int line = 1;
  std::size_t line_start = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::string_view rest = std::string_view(text).substr(i);
    const std::size_t length = utf8_length(rest);
    const bool is_blank = rest[0] == '\t' || rest[0] == '\n' || rest[0] == '\r';
    if (length == 0 || (starts_with_control(rest) && !is_blank)) {
      char code[8];
      std::snprintf(code, sizeof code, "0x%02X", static_cast<unsigned>(static_cast<unsigned char>(rest[0])));
      findings.error({file, line, static_cast<int>(i - line_start) + 1},
                     std::string("not YAML: the byte ") + code + " is no text",
                     "save the file as UTF-8, without control characters");
      return false;
    }
    i += length;
    if (rest[0] == '\n') ++line, line_start = i;
  }
  return true;
}

}  // namespace

YamlNode::Pointer YamlNode::find(std::string_view key) const {
  for (const Entry& entry : entries)
    if (entry.key == key) return entry.value;
  return nullptr;
}

YamlNode::Pointer read_yaml(const std::string& file, Findings& findings) {
  std::optional<std::string> text = read_file(file, most_bytes, "points belong into a file of their own", findings);
  if (!text || !is_plain_text(file, *text, findings)) return nullptr;
  const auto opens_node = [](char c) { return c == '[' || c == '{'; };
  if (static_cast<std::size_t>(std::count_if(text->begin(), text->end(), opens_node)) > most_nodes) {
    findings.error({file}, too_many_values);
    return nullptr;
  }
  std::istringstream stream(*std::move(text));
  TreeBuilder builder(file, stream.view());
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const Stop& stop) {
    findings.error(stop.place, stop.what, stop.hint);
    return nullptr;
  } catch (const YAML::Exception& fault) {
    findings.error(builder.place(fault.mark), "not YAML: " + message_of(fault), hint_of(fault));
    return nullptr;
  } catch (const std::exception& fault) {
    findings.error({file}, std::string("not YAML: ") + fault.what());
    return nullptr;
  }
  if (!builder.root || builder.root->kind == YamlNode::Kind::null) {
    findings.error({file}, "the file is empty, or holds nothing but comments");
    return nullptr;
  }
  for (const Stop& repeated : builder.repeated_keys) findings.error(repeated.place, repeated.what, repeated.hint);
  return builder.root;
}

ParsedNumber parse_number(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  if (text == ".inf" || text == ".Inf" || text == ".INF") {
    value = std::numeric_limits<double>::infinity();
  } else if (text == ".nan" || text == ".NaN" || text == ".NAN") {
    value = std::numeric_limits<double>::quiet_NaN();
  } else {
    // from_chars would take "inf" and "nan", which YAML reads as texts, and a second sign.
    if (text.empty() || !(text[0] == '.' || (text[0] >= '0' && text[0] <= '9'))) return {};
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc{} || end != text.data() + text.size()) return {};
  }
  return {true, negative ? -value : value};
}

}  // namespace sagitta::prescription
