// SPDX-License-Identifier: Apache-2.0
#include "tools/load.h"

#include <fmt/core.h>

#include "lib/prescription/reader.h"

namespace sagitta::tools {

bool report(const prescription::Findings& findings) {
  for (const auto& finding : findings.all()) fmt::print(stderr, "{}\n", prescription::format(finding));
  return !findings.has_errors();
}

std::optional<prescription::Model> load_model(const std::string& file) {
  prescription::ReadResult read = prescription::read_prescription(file);
  if (!report(read.findings)) return std::nullopt;
  return std::move(read.model);
}

std::optional<scene::CompileResult> load_scene(const prescription::Model& model) {
  scene::CompileResult compiled = scene::compile(model);
  if (!report(prescription::in_order(compiled.findings, model.documents))) return std::nullopt;
  return compiled;
}

}  // namespace sagitta::tools
