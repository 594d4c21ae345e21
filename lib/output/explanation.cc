// SPDX-License-Identifier: Apache-2.0
// The plan of a job as JSON and as tables.
#include <fmt/format.h>

#include <algorithm>

#include "lib/output/summary_internal.h"
#include "lib/output/text.h"

namespace sagitta::output {
namespace {

using nlohmann::ordered_json;
using numerics::Operations;

ordered_json operations_json(const std::optional<Operations>& operations) {
  if (!operations) return nullptr;
  return {{"additions_and_multiplications", operations->sums_and_products},
          {"divisions", operations->divisions},
          {"roots", operations->roots},
          {"logarithms", operations->logarithms}};
}

}  // namespace

ordered_json plan_json(const Report& report) {
  ordered_json json{{"operations_include_opl", report.plan->has_opl}, {"surfaces", ordered_json::array()}, {"left_out", ordered_json::array()}};
  for (const analysis::SurfacePlan& one : report.plan->surfaces) {
    json["surfaces"].push_back({{"surface", one.surface},
                                {"name", report.surface_names[static_cast<std::size_t>(one.surface - 1)]},
                                {"kernel", one.kernel},
                                {"operations_per_ray", operations_json(one.operations)},
                                {"bytes_per_ray", one.bytes_per_ray},
                                {"data_bytes", one.data_bytes}});
    if (one.gradient_steps) json["surfaces"].back()["gradient_steps"] = *one.gradient_steps;
  }
  if (const auto& aim = report.plan->aim)
    json["aiming"] = {{"stop", aim->stop}, {"passes_to_stop_per_ray", aim->passes_per_ray}, {"passes_before_per_field_and_wavelength", aim->passes_before}};
  for (const analysis::Omission& one : report.plan->left_out)
    json["left_out"].push_back({{"what", one.what}, {"why", one.why}, {"saves", one.saves}});
  return json;
}

std::string explanation_json(const Report& report) {
  return text_of({{"system", report.system}, {"version", report.version}, {"plan", plan_json(report)}});
}

std::string explanation_text(const Report& report) {
  const analysis::Plan& plan = *report.plan;
  const bool has_logarithms = std::any_of(plan.surfaces.begin(), plan.surfaces.end(),
                                          [](const auto& one) { return one.operations && one.operations->logarithms > 0; });
  Table table{{{"surface", ""}, {"name", "", true}, {"kernel", "", true}, {"+ - *", ""}, {"/", ""}, {"root", ""}, {"bytes a ray", ""}, {"own bytes", ""}}, {}};
  if (has_logarithms) table.columns.insert(table.columns.begin() + 6, {"log", ""});
  const auto row = [&](std::string number, const std::string& name, const std::string& kernel, const std::optional<Operations>& operations,
                       std::size_t bytes_per_ray, std::size_t data_bytes) {
    std::vector<std::string> cells{std::move(number), name, kernel};
    const Operations counts = operations.value_or(Operations{});
    std::vector<int> numbers{counts.sums_and_products, counts.divisions, counts.roots};
    if (has_logarithms) numbers.push_back(counts.logarithms);
    for (const int count : numbers) cells.push_back(operations ? std::to_string(count) : "-");
    cells.push_back(std::to_string(bytes_per_ray));
    cells.push_back(std::to_string(data_bytes));
    table.rows.push_back(std::move(cells));
  };
  std::optional<Operations> sum = Operations{};
  std::size_t bytes_per_ray = 0, data_bytes = 0;
  for (const analysis::SurfacePlan& one : plan.surfaces) {
    row(std::to_string(one.surface), report.surface_names[static_cast<std::size_t>(one.surface - 1)], one.kernel, one.operations, one.bytes_per_ray, one.data_bytes);
    sum = sum && one.operations ? std::optional(*sum + *one.operations) : std::nullopt;
    bytes_per_ray += one.bytes_per_ray;
    data_bytes += one.data_bytes;
  }
  row("all", "", "", sum, bytes_per_ray, data_bytes);

  Table left_out{{{"left out", "", true}, {"why", "", true}, {"saves", "", true}}, {}};
  for (const analysis::Omission& one : plan.left_out) left_out.rows.push_back({one.what, one.why, one.saves});
  std::string aiming;
  if (plan.aim)
    aiming = fmt::format("\nbefore it is launched each ray is traced to the stop, surface {}, {:.1f} times to aim it, and {:.0f} rays of each field and wavelength before all\n", plan.aim->stop,
                         plan.aim->passes_per_ray, plan.aim->passes_before);
  return fmt::format("{}\noperations of one ray, {} optical path length\n\n{}{}\n{}", printable(report.system, 200), plan.has_opl ? "with its" : "without", to_text(table), aiming,
                     to_text(left_out));
}

}  // namespace sagitta::output
