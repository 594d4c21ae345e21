// SPDX-License-Identifier: Apache-2.0
// sagitta import LENS.zmx -o LENS.yaml: a lens file of another program, as a prescription.
#include <fmt/core.h>

#include <filesystem>

#include "lib/lens_file/import.h"
#include "lib/lens_file/lens_reader.h"
#include "lib/output/atomic_file.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/write.h"

namespace sagitta::tools {

int import_command(const ImportOptions& options) {
  if (!lens_file::is_lens_file(options.lens)) {
    fmt::print(stderr, "sagitta import: {}: expected {}\n", options.lens, lens_file::lens_file_formats());
    return 2;
  }
  const auto ending = std::filesystem::path(options.file).extension();
  if (ending != ".yaml" && ending != ".yml") {
    fmt::print(stderr, "sagitta import: -o {}: expected LENS.yaml\n", options.file);
    return 2;
  }
  if (overwrites("import", "-o " + options.file, options.lens, {options.file}, "the lens file")) return 2;
  const lens_file::Imported imported = lens_file::import({options.lens, options.file, options.catalogs, options.takes_parts});
  if (!report(imported.findings) || !imported.prescription) {
    fmt::print(stderr, "sagitta import: {} is not written{}\n", options.file, imported.could_be_left_out ? "; --partial leaves out what is only not understood" : "");
    return 1;
  }
  for (const auto& [path, text] : imported.files)
    if (overwrites("import", "-o " + options.file, options.lens, {path}, "the lens file") || !written("import", output::write_file(path, text))) return 1;
  if (!written("import", output::write_file(options.file, *imported.prescription))) return 1;
  fmt::print("{}: {} surfaces", options.file, imported.surface_count);
  for (const auto& file : imported.files) fmt::print(", heights in {}", file.path);
  if (imported.left_out_count > 0) fmt::print(", {} left out: its head comment lists them", imported.left_out_count == 1 ? "1 thing" : fmt::format("{} things", imported.left_out_count));
  fmt::print("\n");
  return 0;
}

}  // namespace sagitta::tools
