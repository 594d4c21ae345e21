// SPDX-License-Identifier: Apache-2.0
// Reads point clouds. One function a format; the closed list of formats is in cloud_reader.cc.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/point_cloud.h"

namespace sagitta::prescription {

struct CloudRequest {
  std::string file;        // found already
  std::string format;      // one of cloud_formats()
  bool osa_axes = false;   // `axes: osa`, where has_given_axes(format): x to the examiner's right, so x is negated
};

// "xyz|cso|...": the choices of the key `format`.
std::string_view cloud_formats();

// Whether the user says in which frame such points are; the other formats have a frame of their own, which is converted.
bool has_given_axes(std::string_view format);

// Null, and errors at places in the cloud's file, where it cannot be read. Notes tell what was left out (lines without
// a place, missing points).
std::shared_ptr<const PointCloud> read_cloud(const CloudRequest& request, Findings& findings);

}  // namespace sagitta::prescription
