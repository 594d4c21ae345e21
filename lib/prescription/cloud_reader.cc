// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/cloud_reader.h"

#include <fmt/format.h>

#include <array>

#include "lib/prescription/cloud_formats_internal.h"

namespace sagitta::prescription {
namespace {

struct Format {
  std::string_view name;
  std::shared_ptr<const PointCloud> (*read)(const CloudRequest&, Findings&);
};

// The closed list of formats; the first is the default.
constexpr std::array formats{Format{"xyz", read_xyz}, Format{"cso", read_cso}};

}  // namespace

std::string_view cloud_formats() {
  static const std::string names = [] {
    std::string joined;
    for (const Format& format : formats) joined += fmt::format("{}{}", joined.empty() ? "" : "|", format.name);
    return joined;
  }();
  return names;
}

std::shared_ptr<const PointCloud> read_cloud(const CloudRequest& request, Findings& findings) {
  for (const Format& format : formats) {
    if (format.name == request.format) return format.read(request, findings);
  }
  findings.error({request.file}, fmt::format("{} is no format of point clouds", quoted(request.format)),
                 fmt::format("one of {}", cloud_formats()));
  return nullptr;
}

}  // namespace sagitta::prescription
