// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/cloud_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "lib/prescription/cloud_formats_internal.h"

namespace sagitta::prescription {
namespace {

struct Format {
  std::string_view name;
  std::shared_ptr<const PointCloud> (*read)(const CloudRequest&, Findings&);
  bool has_given_axes = false;
};

// The closed list of formats; the first is the default.
constexpr std::array formats{Format{"xyz", read_xyz, true}, Format{"cso", read_cso}, Format{"polar", read_polar},
                             Format{"ply", read_ply, true}};

const Format* format_of(std::string_view name) {
  const auto found = std::find_if(formats.begin(), formats.end(), [&](const Format& format) { return format.name == name; });
  return found == formats.end() ? nullptr : &*found;
}

}  // namespace

std::string_view cloud_formats() {
  static const std::string names = [] {
    std::string joined;
    for (const Format& format : formats) joined += fmt::format("{}{}", joined.empty() ? "" : "|", format.name);
    return joined;
  }();
  return names;
}

bool has_given_axes(std::string_view name) {
  const Format* format = format_of(name);
  return format && format->has_given_axes;
}

std::shared_ptr<const PointCloud> read_cloud(const CloudRequest& request, Findings& findings) {
  if (const Format* format = format_of(request.format)) return format->read(request, findings);
  findings.error({request.file}, fmt::format("{} is no format of point clouds", quoted(request.format)),
                 fmt::format("one of {}", cloud_formats()));
  return nullptr;
}

}  // namespace sagitta::prescription
