// SPDX-License-Identifier: Apache-2.0
// sagitta rays SYSTEM.yaml: real rays, surface by surface, as CSV.
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <optional>
#include <span>
#include <system_error>

#include "lib/trace/beam.h"
#include "lib/trace/pattern.h"
#include "lib/trace/trace.h"
#include "tools/commands.h"
#include "tools/given_rays.h"
#include "tools/load.h"

namespace sagitta::tools {
namespace {

using numerics::Vec3;
using trace::LaunchedRays;
using trace::PupilPoint;
using trace::RayBatch;

// "0.5,-1" as a point of the unit disc.
std::optional<PupilPoint> parse_pupil_point(const std::string& text) {
  PupilPoint point;
  const char* const end = text.data() + text.size();
  const auto [comma, fault] = std::from_chars(text.data(), end, point.x);
  if (fault != std::errc{} || comma == end || *comma != ',') return std::nullopt;
  const auto [rest, second_fault] = std::from_chars(comma + 1, end, point.y);
  if (second_fault != std::errc{} || rest != end) return std::nullopt;
  if (!(std::abs(point.x) <= 1) || !(std::abs(point.y) <= 1)) return std::nullopt;
  return point;
}

struct PupilRequest {
  std::vector<PupilPoint> points;
  std::string fault;
};

PupilRequest requested_pupil(const RaysOptions& options) {
  PupilRequest result;
  if (!options.fan.empty()) {
    int count = 0;
    const std::string_view text = options.fan;
    const bool along = text.starts_with("x:") || text.starts_with("y:");
    const auto [end, fault] = std::from_chars(text.data() + std::min<std::size_t>(2, text.size()), text.data() + text.size(), count);
    if (!along || fault != std::errc{} || end != text.data() + text.size() || !(count >= 1 && count <= 1000000))
      result.fault = fmt::format("--fan {}: expected x:COUNT or y:COUNT with COUNT from 1 to 1000000, such as y:21", options.fan);
    else
      result.points = trace::pupil_points({text[0] == 'x' ? trace::PatternKind::fan_x : trace::PatternKind::fan_y}, count);
    return result;
  }
  for (const std::string& text : options.pupil) {
    const auto point = parse_pupil_point(text);
    if (!point) {
      result.fault = fmt::format("--pupil {}: expected PX,PY with each from -1 to 1, such as 0,1", text);
      return result;
    }
    result.points.push_back(*point);
  }
  if (result.points.empty()) result.points.push_back({0, 0});
  return result;
}

std::string quoted(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string result = "\"";
  for (const char c : name) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

// Rays that are traced and held at a time.
constexpr std::size_t most_at_once = 1024;

class Listing {
 public:
  Listing(const prescription::Model& model, const scene::Scene& scene) : scene_(scene), wavelengths_nm_(model.wavelengths_nm) {
    for (const auto& surface : model.surfaces) names_.push_back(quoted(surface.name));
    fmt::print("ray,field,wavelength_nm,surface,name,x_mm,y_mm,z_mm,l,m,n,opl_mm,status\n");
  }

  // Traces the rays and prints a row for each ray and surface.
  void print(const LaunchedRays& launched) {
    trace::SurfaceBySurface tracing(scene_, scene_.wavelengths[launched.wavelength], launched.rays);
    std::vector<std::string> rows(launched.rays.size());
    std::vector<bool> travels(rows.size(), true);
    for (int surface = 1; surface <= scene_.surface_count(); ++surface) {
      const RayBatch& rays = tracing.next();
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (!travels[i] || launched.rays.ended_at(i) > surface) continue;  // one that could not be aimed has a row at the stop
        travels[i] = rays.ended[i] == 0;
        const Vec3<double> p = global_position(scene_, surface, rays, i), d = global_direction(scene_, surface, rays, i);
        fmt::format_to(std::back_inserter(rows[i]),
                       "{},{},{:.17g},{},{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{}\n", printed_ + i + 1, launched.field,
                       wavelengths_nm_[launched.wavelength], surface, names_[static_cast<std::size_t>(surface - 1)], p.x, p.y, p.z, d.x, d.y, d.z,
                       rays.optical_path_length(i), surface::status_names[static_cast<std::size_t>(rays.status(i))]);
      }
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (std::fputs(rows[i].c_str(), stdout) < 0) throw std::system_error(errno, std::generic_category());
      any_arrived_ = any_arrived_ || travels[i];
    }
    printed_ += rows.size();
  }
  bool any_arrived() const { return any_arrived_; }

 private:
  const scene::Scene& scene_;
  const std::vector<double>& wavelengths_nm_;
  std::vector<std::string> names_;
  std::size_t printed_ = 0;
  bool any_arrived_ = false;
};

trace::StatusCounts endings_of(const trace::RaySource& source, const scene::Scene& scene) {
  trace::StatusCounts counts;
  source(scene, [&](const LaunchedRays& launched) {
    RayBatch rays = launched.rays;
    trace::trace(scene, scene.wavelengths[launched.wavelength], rays);
    for (const std::int32_t ended : rays.ended) counts.add(ended);
  });
  return counts;
}

int print_rays(const prescription::Model& model, const trace::RaySource& source) {
  std::optional<scene::CompileResult> compiled;
  for (const scene::Beam& beam : {trace::beam_of(source), scene::Beam{}}) {
    compiled = load_scene(model, beam);
    if (!compiled) return 1;
    if (compiled->parts.empty() || !leaves_a_part(compiled->parts, endings_of(source, *compiled->scene))) break;
  }
  Listing listing(model, *compiled->scene);
  source(*compiled->scene, [&](const LaunchedRays& launched) { listing.print(launched); });
  return listing.any_arrived() ? 0 : 1;
}

int print_launched(const RaysOptions& options, prescription::Model model, std::span<const PupilPoint> pupil) {
  if (options.wavelength_nm && !set_wavelengths(model, {*options.wavelength_nm}, "rays: --wavelength")) return 1;
  if (const std::size_t count = model.fields.points.size(); options.field && !(*options.field >= 0 && static_cast<std::size_t>(*options.field) < count)) {
    fmt::print(stderr, "sagitta rays: --field {}: the system has the fields 0 to {}\n", *options.field, count - 1);
    return 2;
  }
  return print_rays(model, [&](const scene::Scene& scene, const auto& take) {
    for (std::size_t field = 0; field < scene.fields.size(); ++field) {
      if (options.field && field != static_cast<std::size_t>(*options.field)) continue;
      for (std::size_t w = 0; w < scene.wavelengths.size(); ++w) {
        const trace::Launcher launcher(scene, scene.fields[field], scene.wavelengths[w]);
        for (std::size_t from = 0; from < pupil.size(); from += most_at_once)
          take({launcher(pupil.subspan(from, std::min(most_at_once, pupil.size() - from))), field, w});
      }
    }
  });
}

// Runs of rays of one wavelength go together, so the listing keeps the order of the file.
int print_given(const RaysOptions& options, prescription::Model model) {
  const double wavelength_nm = options.wavelength_nm.value_or(model.primary_wavelength_nm());
  prescription::Findings findings;
  const std::vector<GivenRay> given = read_given_rays(options.from, wavelength_nm, findings);
  if (!report(findings)) return 1;
  std::vector<double> wavelengths;
  for (const GivenRay& ray : given)
    if (std::find(wavelengths.begin(), wavelengths.end(), ray.wavelength_nm) == wavelengths.end())
      wavelengths.push_back(ray.wavelength_nm);
  if (!set_wavelengths(model, wavelengths, "rays: " + options.from)) return 1;
  return print_rays(model, [&](const scene::Scene&, const auto& take) {
    for (std::size_t from = 0, to = 0; from < given.size(); from = to) {
      const double nm = given[from].wavelength_nm;
      while (to < given.size() && to - from < most_at_once && given[to].wavelength_nm == nm) ++to;
      LaunchedRays launched{RayBatch(to - from)};
      launched.wavelength = static_cast<std::size_t>(std::find(wavelengths.begin(), wavelengths.end(), nm) - wavelengths.begin());
      for (std::size_t i = from; i < to; ++i) launched.rays.set(i - from, given[i].position, given[i].direction, 0);
      take(launched);
    }
  });
}

}  // namespace

int rays_command(const RaysOptions& options) {
  const PupilRequest pupil = requested_pupil(options);
  if (!pupil.fault.empty()) {
    fmt::print(stderr, "sagitta rays: {}\n", pupil.fault);
    return 2;
  }
  auto model = load_model(options.system, options.settings);
  if (!model) return model.status;
  return options.from.empty() ? print_launched(options, std::move(*model), pupil.points) : print_given(options, std::move(*model));
}

}  // namespace sagitta::tools
