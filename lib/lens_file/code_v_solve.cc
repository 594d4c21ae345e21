// SPDX-License-Identifier: Apache-2.0
#include "lib/lens_file/code_v_solve_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "lib/lens_file/code_v_text_internal.h"
#include "lib/lens_file/lens_reader.h"

namespace sagitta::lens_file {
namespace {

// Heights, angles and angles of incidence (H, U, I) of the marginal and the chief ray (M, C).
constexpr std::array<std::string_view, 12> solves{"HMY", "HMX", "HCY", "HCX", "UMY", "UMX", "UCY", "UCX", "IMY", "IMX", "ICY", "ICX"};

constexpr Real told_difference = 1e-6L;  // of what is picked up; as of PIM

struct Item {
  std::string_view name;
  Real (*value)(const CodeVSurface&);
};
constexpr std::array items{Item{"THI", [](const CodeVSurface& s) { return s.thickness; }}, Item{"CUY", [](const CodeVSurface& s) { return s.curvature; }},
                           Item{"RDY", [](const CodeVSurface& s) { return s.curvature == 0 ? 0 : 1 / s.curvature; }}, Item{"K", [](const CodeVSurface& s) { return s.conic; }},
                           Item{"XDE", [](const CodeVSurface& s) { return s.shift.x; }}, Item{"YDE", [](const CodeVSurface& s) { return s.shift.y; }},
                           Item{"ZDE", [](const CodeVSurface& s) { return s.shift.z; }}, Item{"ADE", [](const CodeVSurface& s) { return s.tilt.x; }},
                           Item{"BDE", [](const CodeVSurface& s) { return s.tilt.y; }}, Item{"CDE", [](const CodeVSurface& s) { return s.tilt.z; }}};

std::optional<Real> value_of(const CodeVSurface& surface, const std::string& item) {
  const auto found = std::find_if(items.begin(), items.end(), [&](const Item& one) { return one.name == item; });
  return found == items.end() ? std::nullopt : std::optional(found->value(surface));
}

// Goes along the words of a pickup.
class Pickup {
 public:
  Pickup(const Statement& statement, const std::vector<CodeVSurface>& surfaces, bool has_image) : statement_(statement), surfaces_(surfaces), has_image_(has_image) {}

  struct Quantity {
    std::string name;
    Real value = 0;
  };
  // The next item, or the one before, of the surface behind it. None: it is not known.
  std::optional<Quantity> quantity() {
    if (!names_surface(word())) item_ = command_name(word()), ++i_;
    const std::string surface = word();
    const std::optional<std::size_t> number = names_surface(surface) ? surface_named(surface, surfaces_, has_image_) : std::nullopt;
    if (!number || *number >= surfaces_.size()) return std::nullopt;
    ++i_;
    if (word().starts_with("Z")) ++i_;
    const std::optional<Real> value = value_of(surfaces_[*number], item_);
    return value ? std::optional(Quantity{prescription::excerpt(item_ + " " + surface), *value}) : std::nullopt;
  }
  std::optional<Real> number(Real missing) {
    if (is_at_end()) return missing;
    return parse_real(statement_.words[i_++].text);
  }
  bool is_at_end() const { return i_ >= statement_.words.size(); }

 private:
  std::string word() const { return is_at_end() ? std::string() : upper(statement_.words[i_].text); }

  const Statement& statement_;
  const std::vector<CodeVSurface>& surfaces_;
  bool has_image_;
  std::size_t i_ = 1;
  std::string item_;
};

bool is_label(const std::string& word) { return word.starts_with("S'") || word.starts_with("S\""); }

}  // namespace

bool names_surface(const std::string& word) { return is_label(word) || is_surface_name(word); }

std::optional<std::size_t> surface_named(const std::string& word, const std::vector<CodeVSurface>& surfaces, bool has_image) {
  if (is_label(word)) {  // the surface whose label (SLB) is that, in whatever letters
    const std::string label = word.substr(2, word.find(word[1], 2) - 2);
    const auto found = std::find_if(surfaces.begin(), surfaces.end(), [&](const CodeVSurface& one) { return !label.empty() && upper(one.name) == label; });
    return found == surfaces.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - surfaces.begin()));
  }
  if (word == "SO" || word == "S0") return 0;
  if (word == "SI") return has_image ? std::optional(surfaces.size() - 1) : std::nullopt;
  const std::optional<Real> number = parse_real(std::string_view(word).substr(1));
  if (!number || !(*number >= 1 && *number <= most_surfaces) || *number != std::trunc(*number)) return std::nullopt;
  return static_cast<std::size_t>(*number);
}

bool is_solve(const Statement& statement) {
  const std::string& name = statement.name();
  if ((name != "THI" && name != "CUY" && name != "RDY") || statement.words.size() < 2 || statement.words[1].quoted) return false;
  const std::string word = upper(statement.words[1].text);
  return word.size() == 3 && std::all_of(word.begin(), word.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
}

void take_solve(const Statement& statement, const CodeVSurface& surface, const Numbers& numbers, Report& report) {
  const bool is_thickness = statement.name() == "THI";
  const Place at = numbers.place(statement);
  const std::string word = upper(statement.words[1].text), what = fmt::format("{} {}", statement.name(), word);
  if ((is_thickness ? surface.thickness : surface.curvature) == 0)
    return report.left_out(at, what + ": a solve, and the surface has no number that it was solved to", "a lens that CODE V saves has it behind S");
  const int line = (is_thickness ? surface.thickness_place : surface.curvature_place).line;
  if (std::find(solves.begin(), solves.end(), word) == solves.end()) return report.left_out(at, fmt::format("{} is not known; the number in line {} stands for it", what, line));
  report.note(at, fmt::format("{}: the solve is not kept; the number in line {} is", what, line));
}

void check_pickup(const Statement& statement, const std::vector<CodeVSurface>& surfaces, bool has_image, const Numbers& numbers, Report& report) {
  const Place at = numbers.place(statement);
  Pickup pickup(statement, surfaces, has_image);
  const auto to = pickup.quantity(), from = to ? pickup.quantity() : std::nullopt;
  const std::optional<Real> scale = pickup.number(1), offset = pickup.number(0);
  if (!from || !scale || !offset || !pickup.is_at_end())
    return report.note(at, fmt::format("PIK {}: the pickup is neither kept nor checked; the number in the file is kept", prescription::excerpt(statement.rest)));
  const Real picked_up = *scale * from->value + *offset;
  if (std::abs(picked_up - to->value) <= told_difference * std::max(std::abs(picked_up), std::abs(to->value))) return;
  report.left_out(at, fmt::format("PIK: {} is {:.9g} in the file, where the pickup from {} makes it {:.9g}", to->name, static_cast<double>(to->value), from->name, static_cast<double>(picked_up)),
                  "a lens that CODE V saves has the number that was picked up");
}

}  // namespace sagitta::lens_file
