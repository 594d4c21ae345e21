// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>
#include <utility>

#include "lib/prescription/ply_header_internal.h"

namespace sagitta::prescription {
namespace {

constexpr std::uint32_t most_header_lines = 10000;
constexpr std::size_t most_properties = 1000;  // of one element
constexpr std::uint64_t most_vertices = 0x7FFFFFFF;

constexpr std::array<std::pair<std::string_view, PlyType>, 16> type_names{{
    {"char", PlyType::integer8}, {"uchar", PlyType::integer8}, {"int8", PlyType::integer8}, {"uint8", PlyType::integer8},
    {"short", PlyType::integer16}, {"ushort", PlyType::integer16}, {"int16", PlyType::integer16}, {"uint16", PlyType::integer16},
    {"int", PlyType::integer32}, {"uint", PlyType::integer32}, {"int32", PlyType::integer32}, {"uint32", PlyType::integer32},
    {"float", PlyType::float32}, {"float32", PlyType::float32}, {"double", PlyType::float64}, {"float64", PlyType::float64}}};

class HeaderReader {
 public:
  HeaderReader(LineReader& lines, CloudErrors& errors) : lines_(lines), errors_(errors) {}

  std::optional<PlyHeader> read() {
    if (!lines_.next() || lines_.line() != "ply") {
      if (lines_.fault().empty()) refuse("the file does not begin with the line \"ply\"", "is this a PLY file?");
      else refuse(lines_.fault());
      return std::nullopt;
    }
    while (errors_.none() && !at_end_) read_line();
    if (!errors_.none() || !is_complete()) return std::nullopt;
    return header_;
  }

 private:
  enum class Part { before, vertex, after };  // where the element stands whose properties are read

  void refuse(std::string what, std::string hint = {}) { errors_.add(errors_.at(lines_.number()), std::move(what), std::move(hint)); }

  void read_line() {
    if (!lines_.next() || lines_.number() > most_header_lines) {
      if (!lines_.fault().empty()) return refuse(lines_.fault());
      return refuse("the header has no line \"end_header\"", "is this a PLY file?");
    }
    split_at_blanks(lines_.line(), words_);
    const std::string_view key = words_.empty() ? "comment" : words_[0];
    if (key == "comment" || key == "obj_info") return;
    if (key == "end_header") at_end_ = true;
    else if (key == "format") read_format();
    else if (key == "element") read_element();
    else if (key == "property") read_property();
    else refuse(fmt::format("{} is no line of a PLY header", quoted(lines_.line())), "format, comment, element, property or end_header");
  }

  void read_format() {
    const std::string_view name = words_.size() == 3 && words_[2] == "1.0" ? words_[1] : "";
    header_.is_text = name == "ascii";
    header_.order = name == "binary_big_endian" ? std::endian::big : std::endian::little;
    if (!header_.is_text && name != "binary_little_endian" && name != "binary_big_endian")
      return refuse(fmt::format("{} is no format of PLY", quoted(lines_.line())), "ascii, binary_little_endian or binary_big_endian, 1.0");
    has_format_ = true;
  }

  void read_element() {
    std::uint64_t count = 0;
    const std::string_view text = words_.size() == 3 ? words_[2] : "";
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (text.empty() || status != std::errc{} || end != text.data() + text.size())
      return refuse(fmt::format("{} is no element with a count", quoted(lines_.line())), "element vertex 1000");
    close_element();
    element_count_ = count;
    header_.has_elements_after = part_ == Part::after;
    if (words_[1] != "vertex") return;
    if (part_ != Part::before) return refuse("a second element vertex");
    part_ = Part::vertex;
    header_.vertex_count = count;
    if (count == 0 || count > most_vertices) refuse(fmt::format("{} vertices: from 1 to {} can be read", count, most_vertices));
  }

  // What stands between the header and the vertices is passed over unread.
  void close_element() {
    if (part_ == Part::vertex) part_ = Part::after;
    if (part_ != Part::before) return;
    constexpr std::uint64_t most = std::numeric_limits<std::int64_t>::max();
    const std::uint64_t size = std::max<std::uint64_t>(element_size_, 1);
    if (element_count_ > (most - header_.bytes_before) / size)
      return refuse(fmt::format("an element of {} parts before the vertices", element_count_));
    header_.bytes_before += element_count_ * element_size_;
    header_.lines_before += element_count_;
    element_size_ = property_count_ = 0;
  }

  void read_property() {
    if (part_ == Part::after) return;
    const bool is_list = words_.size() == 5 && words_[1] == "list";
    const auto type = std::find_if(type_names.begin(), type_names.end(), [&](const auto& one) { return words_.size() == 3 && one.first == words_[1]; });
    if (!is_list && type == type_names.end())
      return refuse(fmt::format("{} is no property", quoted(lines_.line())), "property double x");
    if (++property_count_ > most_properties) return refuse(fmt::format("more than {} properties", most_properties));
    if (is_list) {
      if (part_ == Part::before && header_.is_text) return;  // one line a part, whatever it holds
      return refuse(fmt::format("a list {}: every vertex would have another length", part_ == Part::vertex ? "in the element vertex" : "before the vertices"),
                    "write the points without it, or as xyz");
    }
    if (part_ == Part::before) {
      element_size_ += size_of(type->second);
      return;
    }
    header_.properties.push_back(type->second);
    const std::size_t axis = words_[2].size() == 1 ? std::string_view("xyz").find(words_[2][0]) : std::string_view::npos;
    if (axis == std::string_view::npos) return;
    if (type->second != PlyType::float32 && type->second != PlyType::float64)
      return refuse(fmt::format("{} is {}, not float or double", words_[2], quoted(words_[1])), "coordinates are in mm");
    if (found_[axis]) return refuse(fmt::format("a second property {}", words_[2]));
    found_[axis] = true;
    header_.coordinate[axis] = header_.properties.size() - 1;
  }

  bool is_complete() {
    if (!has_format_) refuse("the header has no line \"format\"", "format binary_little_endian 1.0");
    if (part_ == Part::before) refuse("the header has no element vertex", "its vertices are the points");
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (part_ != Part::before && !found_[axis]) refuse(fmt::format("the element vertex has no property {}", "xyz"[axis]), "float or double properties x, y and z");
    return errors_.none();
  }

  LineReader& lines_;
  CloudErrors& errors_;
  PlyHeader header_;
  std::vector<std::string_view> words_;
  Part part_ = Part::before;
  std::uint64_t element_count_ = 0, element_size_ = 0;  // of the element before the vertices that is being read
  std::size_t property_count_ = 0;
  bool has_format_ = false, at_end_ = false;
  std::array<bool, 3> found_{};
};

}  // namespace

std::size_t size_of(PlyType type) {
  constexpr std::array<std::size_t, 5> sizes{1, 2, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

std::optional<PlyHeader> read_ply_header(LineReader& lines, CloudErrors& errors) { return HeaderReader(lines, errors).read(); }

}  // namespace sagitta::prescription
