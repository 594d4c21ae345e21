// SPDX-License-Identifier: Apache-2.0
// A comparison as EXR parts and as sheets.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/output/comparison.h"
#include "lib/output/report_internal.h"

namespace sagitta::output {
namespace {

constexpr double shown_rms_radii = 3;  // to each side of a spot's middle, of the largest spot of a sheet

ExrPart difference_part(const Comparison& comparison, const ComparedSystem& system, std::size_t i) {
  const ComparedSystem& first = comparison.systems.front();
  const analysis::JobResult& result = system.report.results[i];
  const analysis::WavefrontDifference& difference = *system.differences[i].wavefront;
  ExrPart part{fmt::format("{}-minus-{}.{}", system.slug, first.slug, part_name(system.report, result, "wavefront")),
               difference.size, difference.size,
               {{"Y", floats(difference.opd_waves)}, {"difference.mask", difference.mask}},
               common_attributes(system.report, result, result.wavefront->rays)};
  part.attributes.push_back({"first_system", first.report.system});
  part.attributes.push_back({"quantity", "difference of the optical path differences over the entrance pupil"});
  part.attributes.push_back({"sign", "OPD(system) - OPD(first_system), each OPD to its own reference sphere"});
  part.attributes.push_back({"mask", "0 in both, 1 only in the first, 2 only in the other, 3 in neither, 255 outside the pupil"});
  for (ExrAttribute& attribute : pupil_map_attributes(system.report, difference.size)) part.attributes.push_back(std::move(attribute));
  part.attributes.push_back({"mean_waves", difference.mean_waves});
  part.attributes.push_back({"rms_waves", difference.rms_waves});
  part.attributes.push_back({"rms_without_tilt_waves", difference.rms_without_tilt_waves});
  part.attributes.push_back({"peak_to_valley_waves", difference.peak_to_valley_waves});
  return part;
}

// The range +-v of all finite values of the panels; none where they are all 0.
std::optional<Range> common_range(const std::vector<const Panel*>& panels) {
  double largest = 0;
  for (const Panel* panel : panels)
    for (const float value : panel->map.values)
      if (std::isfinite(value)) largest = std::max(largest, std::abs(double{value}));
  return largest > 0 ? std::optional(Range{-largest, largest}) : std::nullopt;
}

// The middle of a spot's picture, `half_width` mm to each side, so that a few stray rays do not make all spots small.
void crop(Panel& panel, double half_width) {
  const int size = panel.map.width;
  const int kept = std::min(size, 2 * std::max(4, static_cast<int>(std::ceil(half_width / panel.axes.pixel_width))));
  const int first = (size - kept) / 2;
  double all = 0, shown = 0;
  std::vector<float> middle;
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      const float value = panel.map.values[static_cast<std::size_t>(row) * static_cast<std::size_t>(size) + static_cast<std::size_t>(column)];
      all += value;
      if (row < first || row >= first + kept || column < first || column >= first + kept) continue;
      shown += value;
      middle.push_back(value);
    }
  panel.map = {kept, kept, std::move(middle)};
  if (shown < all) panel.subtitle.back() += fmt::format(", {} beyond the picture", all - shown);
}

Panel difference_panel(const Comparison& comparison, const ComparedSystem& system, std::size_t i) {
  const std::string& first = comparison.systems.front().report.system;
  if (&system == &comparison.systems.front()) {
    Panel panel = pupil_panel(system.report, 0, {}, "the first system: differences are from this one");
    panel.title = "difference";
    return panel;
  }
  const auto& difference = system.differences[i].wavefront;
  Panel panel = difference ? pupil_panel(system.report, difference->size, difference->without_tilt_waves, "no sample in both")
                           : pupil_panel(system.report, 0, {}, "one of the two has no wavefront");
  panel.title = fmt::format("{} − {}", system.report.system, first);
  panel.quantity = "OPD difference − tilt";
  if (difference) {
    panel.subtitle = {fmt::format("RMS without piston and tilt {:.4g} waves", difference->rms_without_tilt_waves),
                      fmt::format("with tilt: RMS {:.4g}, P-V {:.4g} waves", difference->rms_waves, difference->peak_to_valley_waves)};
    if (const auto lost = difference->only_in_first + difference->only_in_other; lost > 0)
      panel.subtitle.push_back(fmt::format("{} samples in both, {} in one only", difference->in_both, lost));
  }
  return panel;
}

Figure sheet(const Comparison& comparison, std::size_t field) {
  const Report& first = comparison.systems.front().report;
  const std::size_t i = field * first.wavelengths_nm.size() + comparison.primary;
  Figure figure{fmt::format("{}: {}", comparison.title, panel_title(first, first.results[i])),
                fmt::format("A row for each system, by the rays of the first. Spots at one scale, circle: RMS radius about the centroid. "
                            "OPD = OPL(chief) − OPL(ray), each to its own reference sphere; one colour scale for the wavefronts, "
                            "one for the differences, drawn without piston and tilt; {}", pictures_footer(eyes_of(comparison), first.version)),
                {}, 3};
  double largest_rms = 0;
  for (const ComparedSystem& system : comparison.systems)
    largest_rms = std::max(largest_rms, system.report.results[i].spot->rms_radius);
  for (const ComparedSystem& system : comparison.systems) {
    const analysis::JobResult& result = system.report.results[i];
    figure.panels.push_back(spot_panel(system.report, result));
    crop(figure.panels.back(), shown_rms_radii * largest_rms);
    figure.panels.push_back(wavefront_panel(system.report, result));
    for (std::size_t k = figure.panels.size() - 2; k < figure.panels.size(); ++k)
      figure.panels[k].title = fmt::format("{}: {}", system.report.system, k % 3 == 0 ? "spot" : "wavefront");
    figure.panels.push_back(difference_panel(comparison, system, i));
  }
  std::vector<const Panel*> wavefronts, trusted, differences;
  for (std::size_t row = 0; row < comparison.systems.size(); ++row) {
    wavefronts.push_back(&figure.panels[3 * row + 1]);
    differences.push_back(&figure.panels[3 * row + 2]);
    if (comparison.systems[row].report.surfaces_of_flat_facets.empty()) trusted.push_back(differences.back());
  }
  const auto range = common_range(wavefronts), trusted_range = common_range(trusted);
  const auto difference_range = trusted_range ? trusted_range : common_range(differences);
  for (std::size_t row = 0; row < comparison.systems.size(); ++row) {
    figure.panels[3 * row + 1].range = range;
    figure.panels[3 * row + 2].range = difference_range;
  }
  return figure;
}

}  // namespace

std::vector<ExrPart> parts(const Comparison& comparison) {
  std::vector<ExrPart> result;
  for (const ComparedSystem& system : comparison.systems) {
    for (auto* make : {spot_parts, wavefront_parts})
      for (ExrPart& part : make(system.report)) {
        part.name = system.slug + "." + part.name;
        result.push_back(std::move(part));
      }
    if (&system == &comparison.systems.front()) continue;
    for (std::size_t i = 0; i < system.differences.size(); ++i)
      if (system.differences[i].wavefront) result.push_back(difference_part(comparison, system, i));
  }
  return result;
}

std::vector<Figure> sheets(const Comparison& comparison) {
  std::vector<Figure> result;
  for (std::size_t field = 0; field < comparison.systems.front().report.fields.size(); ++field)
    result.push_back(sheet(comparison, field));
  return result;
}

}  // namespace sagitta::output
