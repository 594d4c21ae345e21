// SPDX-License-Identifier: Apache-2.0
// Points as binary PLY: the compact form of a cloud that `format: ply` reads at the speed of the disk.
//
// A header, then x, y, z of every vertex as doubles in the machine's byte order, which the header names. A hole has NaN
// for its z. What is read back has the same bits.
#pragma once

#include <span>
#include <string>

#include "lib/numerics/vec3.h"
#include "lib/output/atomic_file.h"

namespace sagitta::output {

// `comment`: one line for the header; what is no printable ASCII becomes '?'.
WriteResult write_ply(const std::string& path, std::span<const numerics::Vec3<double>> points, const std::string& comment);

}  // namespace sagitta::output
