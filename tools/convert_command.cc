// SPDX-License-Identifier: Apache-2.0
// sagitta convert POINTS -o FILE.ply: any point cloud that can be read, in the compact form.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "lib/output/ply.h"
#include "lib/prescription/cloud_reader.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/version.h"
#include "tools/write.h"

namespace sagitta::tools {

int convert_command(const ConvertOptions& options) {
  const bool osa_axes = options.axes == "osa";
  if (osa_axes && !prescription::has_given_axes(options.format)) {
    fmt::print(stderr, "sagitta convert: --axes osa: the format {} itself tells its axes\n", options.format);
    return 2;
  }
  if (overwrites("convert", "-o " + options.file, options.points, {options.file})) return 2;
  prescription::Findings findings;
  const auto cloud = prescription::read_cloud({options.points, options.format, osa_axes}, findings);
  if (!report(findings) || !cloud) return 1;
  const std::string comment = fmt::format("{} by sagitta {}; mm, in the frame of the surface",
                                          std::filesystem::path(options.points).filename().string(), version());
  const output::WriteResult written = output::write_ply(options.file, cloud->points, comment);
  if (!written.ok()) {
    fmt::print(stderr, "sagitta convert: {}\n", written.error);
    return 1;
  }
  const auto holes = std::count_if(cloud->points.begin(), cloud->points.end(), [](const auto& p) { return std::isnan(p.z); });
  fmt::print("{}: {} points, {} of them holes\n", options.file, cloud->points.size(), holes);
  return 0;
}

}  // namespace sagitta::tools
