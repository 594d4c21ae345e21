// SPDX-License-Identifier: Apache-2.0
// What the tests of the point-cloud readers share: a cloud from the bytes of its file.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "lib/prescription/cloud_reader.h"
#include "tests/prescription/support.h"

namespace sagitta::prescription::test {

struct CloudRead {
  std::shared_ptr<const PointCloud> cloud;
  std::string told;  // all findings, the folder taken off
};

inline CloudRead read_points(const std::string& bytes, const std::string& format, bool osa_axes = false) {
  const TemporaryFolder folder;
  Findings findings;
  CloudRead result{read_cloud({folder.write("points", bytes), format, osa_axes}, findings), text_of(findings)};
  for (std::size_t at; (at = result.told.find(folder.path() + "/")) != std::string::npos;) {
    result.told.erase(at, folder.path().size() + 1);
  }
  EXPECT_EQ(result.cloud == nullptr, findings.has_errors()) << result.told;
  return result;
}

}  // namespace sagitta::prescription::test
