// SPDX-License-Identifier: Apache-2.0
#include "tools/write.h"

#include <fmt/core.h>

#include "lib/numerics/parallel.h"
#include "lib/output/atomic_file.h"
#include "tools/pictures.h"

namespace sagitta::tools {

bool make_folder(const char* command, const std::filesystem::path& folder) {
  if (folder.empty()) return true;
  std::error_code fault;
  std::filesystem::create_directories(folder, fault);
  if (std::filesystem::is_directory(folder)) return true;
  fmt::print(stderr, "sagitta {}: {}: the output folder cannot be made: {}\n", command, folder.string(), fault.message());
  return false;
}

bool overwrites(const char* command, const std::string& option, const std::filesystem::path& input, const std::vector<std::filesystem::path>& outputs,
                const char* what) {
  for (const std::filesystem::path& output : outputs) {
    std::error_code fault;  // of names that are not there: nothing is overwritten
    if (!std::filesystem::equivalent(input, output, fault)) continue;
    fmt::print(stderr, "sagitta {}: {}: {} is {}, which would be overwritten\n  hint: give another name\n", command, option, output.string(), what);
    return true;
  }
  return false;
}

bool written(const char* command, const output::WriteResult& result) {
  if (!result.ok()) fmt::print(stderr, "sagitta {}: {}\n", command, result.error);
  return result.ok();
}

bool write_image(const char* command, const std::filesystem::path& base, std::vector<output::ExrPart> parts, const output::Figure& figure,
                 int thread_count) {
  const Pictures* made = pictures(command);
  if (!made) return false;
  const output::Raster picture = made->render(figure);
  parts.insert(parts.begin(), made->preview_part(picture));
  output::WriteResult exr, png;
  numerics::do_both(
      thread_count, [&] { exr = made->write_exr(base.string() + ".exr", parts, thread_count); }, [&] { png = made->write_png(base.string() + ".png", picture); });
  const bool exr_is_written = written(command, exr);
  return written(command, png) && exr_is_written;
}

bool write_chart(const char* command, const std::filesystem::path& base, const output::Chart& chart) {
  const Pictures* made = pictures(command);
  if (!made) return false;
  const bool svg_is_written = written(command, output::write_file(base.string() + ".svg", made->chart_svg(chart)));
  return written(command, made->write_png(base.string() + ".png", made->render_chart(chart))) && svg_is_written;
}

bool names_chart(const char* command, const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  const bool is_good = file.empty() || ending == ".png" || ending == ".svg";
  if (!is_good) fmt::print(stderr, "sagitta {}: -o: the picture's name must end in .png or .svg\n", command);
  return is_good;
}

bool write_chart_file(const char* command, const std::filesystem::path& file, const output::Chart& chart) {
  const Pictures* made = pictures(command);
  if (!made || !make_folder(command, file.parent_path())) return false;
  return written(command, file.extension() == ".svg" ? output::write_file(file.string(), made->chart_svg(chart)) : made->write_png(file.string(), made->render_chart(chart)));
}

bool write_picture(const char* command, const std::filesystem::path& file, const output::Figure& figure) {
  const Pictures* made = pictures(command);
  return made && written(command, made->write_png(file.string(), made->render(figure)));
}

}  // namespace sagitta::tools
