// SPDX-License-Identifier: Apache-2.0
// Format cso: the elevation export of a CSO Placido topographer, as the device writes it.
//
// A header in Italian (Latin-1 or UTF-8, CRLF) with the lines
//   Dato misurato : Elevazioni      N° Anelli : 24 (rings)      N° Semimeridiani : 256 (meridians)
// and a line of dashes; then one number a line with a decimal comma: rings x meridians radii in mm, then as many
// elevations in mm, ring by ring, meridian i at i x 360/meridians degrees.
//
// Missing samples have radius and elevation -1 or -1000; what becomes of them, and of the file's frame, is told in
// ring_places_internal.h.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "lib/prescription/cloud_formats_internal.h"
#include "lib/prescription/ring_places_internal.h"

namespace sagitta::prescription {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr int most_rings = 10000, most_meridians = 100000;

class CsoReader {
 public:
  CsoReader(const CloudRequest& request, Findings& findings)
      : request_(request), findings_(findings), errors_(request.file, findings), lines_(request.file) {}

  std::shared_ptr<const PointCloud> read() {
    std::shared_ptr<const PointCloud> cloud;
    if (read_header() && read_samples() && errors_.none()) cloud = points();
    errors_.finish();
    return cloud;
  }

 private:
  // Up to the dashes below the counts. False: no numbers can be read.
  bool read_header() {
    bool elevations = false;
    std::optional<int> rings, meridians;
    while (!(rings && meridians && lines_.line().starts_with("---"))) {
      if (!lines_.next()) break;
      const std::size_t colon = lines_.line().find(':');
      if (colon == std::string_view::npos) continue;
      const std::string_view key = lines_.line().substr(0, colon);
      const auto names = [&](std::string_view word) { return key.find(word) != std::string_view::npos; };
      if (names("Dato misurato")) {
        elevations = true;
        const std::string_view quantity = trimmed(lines_.line().substr(colon + 1));
        if (quantity != "Elevazioni") {
          errors_.add(errors_.at(lines_.number()), fmt::format("the file holds {}, not elevations", quoted(quantity)),
                      "export the elevations (Dato misurato : Elevazioni)");
        }
      } else if (names("Semimeridiani")) {
        meridians = read_count(colon, most_meridians);
      } else if (names("Anelli")) {
        rings = read_count(colon, most_rings);
      }
    }
    if (told_a_fault()) return false;
    const auto need = [&](bool is_there, const char* line) {
      if (!is_there) errors_.add(errors_.at(0), fmt::format("no line \"{}\" in the header", line), "is this a CSO export?");
    };
    need(elevations, "Dato misurato : Elevazioni");
    need(rings.has_value(), "N\xC2\xB0 Anelli : COUNT");
    need(meridians.has_value(), "N\xC2\xB0 Semimeridiani : COUNT");
    if (!errors_.none()) return false;
    ring_count_ = static_cast<std::size_t>(*rings);
    meridian_count_ = static_cast<std::size_t>(*meridians);
    return true;
  }

  int read_count(std::size_t colon, int most) {
    const std::string_view text = trimmed(lines_.line().substr(colon + 1));
    int count = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (status != std::errc{} || end != text.data() + text.size() || count < 1 || count > most) {
      errors_.add(errors_.at(lines_.number(), static_cast<std::size_t>(text.data() - lines_.line().data()) + 1),
                  fmt::format("{} is no count from 1 to {}", quoted(text), most));
    }
    return count;
  }

  bool read_samples() {
    const std::size_t sample_count = ring_count_ * meridian_count_;
    first_line_ = lines_.number() + 1;
    while (lines_.next()) {
      const std::string_view text = trimmed(lines_.line());
      const std::size_t read = samples_.size() + elevation_.size();
      if (text.empty()) {
        blank_line_ = blank_line_ ? blank_line_ : lines_.number();
        continue;
      }
      if (blank_line_) {
        errors_.add(errors_.at(blank_line_), "an empty line among the numbers");
        return false;
      }
      if (read == 2 * sample_count) {
        errors_.add(errors_.at(lines_.number()), fmt::format("more numbers than the header announces: {}", announced()),
                    "radii, then elevations, one a line");
        return false;
      }
      read < sample_count ? read_radius(text) : read_elevation(text);
    }
    if (told_a_fault()) return false;
    if (const std::size_t read = samples_.size() + elevation_.size(); read < 2 * sample_count) {
      errors_.add(errors_.at(lines_.number()),
                  fmt::format("the file ends after {} numbers of {}", read, announced()));
    }
    return errors_.none();
  }

  std::string announced() const {
    return fmt::format("2 x {} rings x {} meridians = {}", ring_count_, meridian_count_, 2 * ring_count_ * meridian_count_);
  }

  void read_radius(std::string_view text) {
    const double r = is_missing_marker(text) ? missing : number(text, "radius");
    if (r < 0) {
      errors_.add(errors_.at(lines_.number()), fmt::format("the radius is negative: {}", quoted(text)),
                  "a missing sample is -1 or -1000");
    }
    const std::size_t ring = samples_.size() / meridian_count_, i = samples_.size() % meridian_count_;
    samples_.push_back({static_cast<double>(ring), static_cast<double>(i) * 360 / static_cast<double>(meridian_count_), r});
  }

  void read_elevation(std::string_view text) {
    const bool has_place = !std::isnan(samples_[elevation_.size()].radius);
    const double z = is_missing_marker(text) ? missing : number(text, "elevation");
    elevation_.push_back(has_place ? z : missing);
  }

  double number(std::string_view text, const char* quantity) {
    const CloudNumber number = parse_cloud_number(text, true);
    if (number.fault == NumberFault::none && !std::isnan(number.value)) return number.value;
    const NumberFault fault = number.fault == NumberFault::none ? NumberFault::garbage : number.fault;
    errors_.add(errors_.at(lines_.number()), fmt::format("the {} is {}: {}", quantity, meaning_of(fault), quoted(text)));
    return 0;
  }

  std::shared_ptr<const PointCloud> points() {
    auto cloud = std::make_shared<PointCloud>();
    cloud->file = request_.file;
    std::size_t missing_count = 0;
    const std::vector<double> radius = places_of(samples_);
    for (std::size_t k = 0; k < radius.size(); ++k) {
      if (std::isnan(elevation_[k])) ++missing_count;
      if (std::isnan(radius[k])) continue;
      cloud->points.push_back(in_eye_frame(radius[k], samples_[k].meridian_deg, elevation_[k]));
      cloud->lines.push_back(first_line_ + static_cast<std::uint32_t>(samples_.size() + k));
    }
    if (missing_count == samples_.size()) {
      errors_.add(errors_.at(0), "every sample is missing");
      return nullptr;
    }
    if (missing_count > 0) {
      findings_.note(errors_.at(0), fmt::format("{} of {} samples are missing: holes", missing_count, samples_.size()));
    }
    return cloud;
  }

  bool told_a_fault() {
    if (!lines_.fault().empty()) errors_.add(errors_.at(lines_.number()), lines_.fault());
    return !lines_.fault().empty();
  }

  const CloudRequest& request_;
  Findings& findings_;
  CloudErrors errors_;
  LineReader lines_;

  std::size_t ring_count_ = 0, meridian_count_ = 0;
  std::uint32_t first_line_ = 0, blank_line_ = 0;
  std::vector<RingSample> samples_;
  std::vector<double> elevation_;  // NaN: missing
};

}  // namespace

std::shared_ptr<const PointCloud> read_cso(const CloudRequest& request, Findings& findings) {
  return CsoReader(request, findings).read();
}

}  // namespace sagitta::prescription
