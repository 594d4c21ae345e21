// SPDX-License-Identifier: Apache-2.0
#include "lib/output/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace sagitta::output {

WriteResult write_ply(const std::string& path, std::span<const numerics::Vec3<double>> points, const std::string& comment) {
  static_assert(sizeof(points[0]) == 3 * sizeof(double));
  std::string printable = comment.substr(0, 1000);
  std::replace_if(printable.begin(), printable.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  std::string bytes = fmt::format(
      "ply\nformat binary_{}_endian 1.0\ncomment {}\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\nend_header\n",
      std::endian::native == std::endian::little ? "little" : "big", printable, points.size());
  const std::size_t header_size = bytes.size();
  bytes.resize(header_size + points.size_bytes());
  if (!points.empty()) std::memcpy(bytes.data() + header_size, points.data(), points.size_bytes());
  return write_file(path, bytes);
}

}  // namespace sagitta::output
