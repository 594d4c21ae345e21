// SPDX-License-Identifier: Apache-2.0
// Format ply: the vertices of a PLY file, x, y, z in mm in the surface's local frame, as text or binary. The compact form
// of large clouds (output/ply.h writes it): three doubles a vertex and nothing else is read at the speed of the disk.
//
// Other properties of the vertices, elements behind them, and elements without lists before them are passed over. z NaN: a hole at (x, y); x or y NaN: no place,
// the vertex is left out and counted in a note. The size of the file is checked before memory is taken for what the
// header announces.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "lib/prescription/ply_header_internal.h"

namespace sagitta::prescription {
namespace {

using Point = numerics::Vec3<double>;
static_assert(sizeof(Point) == 3 * sizeof(double));

constexpr std::size_t block_bytes = std::size_t{1} << 18;  // stays in the cache between the file and the points

template <class T>
double number_at(const char* bytes, bool is_swapped) {
  std::array<char, sizeof(T)> copy;
  std::memcpy(copy.data(), bytes, copy.size());
  if (is_swapped) std::reverse(copy.begin(), copy.end());
  return static_cast<double>(std::bit_cast<T>(copy));
}

bool all_finite(const std::vector<Point>& points) {
  bool finite = true;
  for (const Point& p : points) finite &= (p.x - p.x == 0) & (p.y - p.y == 0) & (p.z - p.z == 0);
  return finite;
}

class PlyReader {
 public:
  PlyReader(const CloudRequest& request, Findings& findings)
      : request_(request), findings_(findings), errors_(request.file, findings), lines_(request.file) {}

  std::shared_ptr<const PointCloud> read() {
    auto cloud = std::make_shared<PointCloud>();
    cloud->file = request_.file;
    cloud_ = cloud.get();
    if (const auto header = read_ply_header(lines_, errors_)) {
      header_ = *header;
      cloud->has_lines = header_.is_text;
      header_.is_text ? read_text() : read_binary();
      if (errors_.none() && cloud->points.empty()) errors_.add(errors_.at(0), "not one vertex has a place");
    }
    errors_.finish();
    tell_what_was_left_out();
    return errors_.none() ? cloud : nullptr;
  }

 private:
  void read_text() {
    for (std::uint64_t passed = 0; passed < header_.lines_before; ++passed)
      if (!lines_.next()) return tell_the_end(0);
    std::vector<std::string_view> fields;
    for (std::uint64_t vertex = 1; vertex <= header_.vertex_count; ++vertex) {
      if (!lines_.next()) return tell_the_end(vertex - 1);
      split_at_blanks(lines_.line(), fields);
      const Place place = errors_.at(lines_.number());
      if (fields.size() != header_.properties.size()) {
        errors_.add(place, fmt::format("{} numbers where a vertex has {}: {}", fields.size(), header_.properties.size(), quoted(lines_.line())));
        continue;
      }
      std::array<double, 3> value{};
      bool is_good = true;
      for (std::size_t axis = 0; axis < 3 && is_good; ++axis) {
        const std::string_view field = fields[header_.coordinate[axis]];
        const CloudNumber number = parse_cloud_number(field, false);
        is_good = number.fault == NumberFault::none;
        value[axis] = number.value;
        if (!is_good) errors_.add(errors_.at(lines_.number(), static_cast<std::size_t>(field.data() - lines_.line().data()) + 1),
                                  fmt::format("{} is {}: {}", "xyz"[axis], meaning_of(number.fault), quoted(field)));
      }
      if (is_good) take({value[0], value[1], value[2]}, lines_.number());
    }
  }

  void read_binary() {
    std::error_code fault;
    const std::uint64_t file_size = std::filesystem::file_size(request_.file, fault);
    if (fault) return errors_.add(errors_.at(0), "cannot be read: " + fault.message());
    const std::uint64_t begin = lines_.offset() + header_.bytes_before, vertex_size = header_.vertex_size();
    const std::uint64_t held = file_size > begin ? (file_size - begin) / vertex_size : 0;
    if (held < header_.vertex_count) return tell_the_end(held);
    if (const std::uint64_t rest = file_size - begin - header_.vertex_count * vertex_size; rest > 0 && !header_.has_elements_after)
      return errors_.add(errors_.at(0), fmt::format("the file goes on for {} bytes behind the last vertex, and the header has no element there", rest),
                         "its header is wrong: the count of the vertices, or their properties");
    const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(request_.file.c_str(), "rb"));
    if (!file || ::fseeko(file.get(), static_cast<off_t>(begin), SEEK_SET) != 0)
      return errors_.add(errors_.at(0), "cannot be read: " + std::generic_category().message(errno));
    std::setvbuf(file.get(), nullptr, _IONBF, 0);

    cloud_->points.reserve(header_.vertex_count);
    const std::uint64_t per_block = std::max<std::uint64_t>(block_bytes / vertex_size, 1);
    std::vector<Point> block;
    std::vector<char> bytes;
    for (std::uint64_t done = 0; done < header_.vertex_count;) {
      const std::size_t count = std::min(per_block, header_.vertex_count - done);
      block.resize(count);
      const bool is_plain = header_.order == std::endian::native && is_three_doubles();
      if (!is_plain) bytes.resize(count * vertex_size);
      if (std::fread(is_plain ? static_cast<void*>(block.data()) : bytes.data(), vertex_size, count, file.get()) != count)
        return tell_the_end(done);
      if (!is_plain) unpack(bytes, block);
      if (!request_.osa_axes && without_place_.count == 0 && all_finite(block)) {
        cloud_->points.insert(cloud_->points.end(), block.begin(), block.end());
      } else {
        for (std::size_t i = 0; i < count; ++i) take(block[i], static_cast<std::uint32_t>(done + i + 1));
      }
      done += count;
    }
  }

  bool is_three_doubles() const {
    return header_.properties.size() == 3 && header_.vertex_size() == sizeof(Point) && header_.coordinate == std::array<std::size_t, 3>{0, 1, 2};
  }

  void unpack(const std::vector<char>& bytes, std::vector<Point>& points) const {
    const std::size_t vertex_size = header_.vertex_size();
    const bool is_swapped = header_.order != std::endian::native;
    const std::array<double Point::*, 3> axes{&Point::x, &Point::y, &Point::z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const char* from = bytes.data() + header_.offset(header_.coordinate[axis]);
      const auto convert = [&]<class T>(T) {
        for (std::size_t i = 0; i < points.size(); ++i) points[i].*axes[axis] = number_at<T>(from + i * vertex_size, is_swapped);
      };
      header_.properties[header_.coordinate[axis]] == PlyType::float64 ? convert(double{}) : convert(float{});
    }
  }

  // `number`: of the line, or of the vertex where there are no lines.
  void take(Point p, std::uint32_t number) {
    const std::array<double, 3> value{p.x, p.y, p.z};
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (std::isinf(value[axis]))
        return errors_.add(errors_.at(0), fmt::format("vertex {}: {} is infinite", number, "xyz"[axis]));
    if (std::isnan(p.x) || std::isnan(p.y)) {
      if (!header_.is_text && without_place_.count == 0)  // from here on a point's number is not its place in the list
        for (std::uint32_t i = 1; i <= cloud_->points.size(); ++i) cloud_->lines.push_back(i);
      return without_place_.add(number);
    }
    if (std::isnan(p.z)) holes_.add(number);
    if (request_.osa_axes) p.x = -p.x;
    cloud_->points.push_back(p);
    if (header_.is_text || without_place_.count > 0) cloud_->lines.push_back(number);
  }

  void tell_the_end(std::uint64_t held) {
    if (!lines_.fault().empty()) return errors_.add(errors_.at(lines_.number()), lines_.fault());
    errors_.add(errors_.at(header_.is_text ? lines_.number() : 0),
                fmt::format("the file ends after {} vertices of {}", held, header_.vertex_count), "it was cut off, or its header is wrong");
  }

  void tell_what_was_left_out() {
    const auto tell = [&](const Tally& tally, std::string_view what, std::string_view became) {
      if (header_.is_text) return tally.tell(errors_, findings_, what, became);
      if (tally.count == 0) return;
      findings_.note(errors_.at(0), fmt::format("{} {} {}, the first one is {}: {}", tally.count, tally.count == 1 ? "vertex" : "vertices", what, tally.first_line, became));
    };
    tell(without_place_, "without a place (x or y is nan)", "left out");
    tell(holes_, "without z (nan)", "holes");
  }

  const CloudRequest& request_;
  Findings& findings_;
  CloudErrors errors_;
  LineReader lines_;
  PlyHeader header_;
  PointCloud* cloud_ = nullptr;
  Tally without_place_, holes_;
};

}  // namespace

std::shared_ptr<const PointCloud> read_ply(const CloudRequest& request, Findings& findings) {
  return PlyReader(request, findings).read();
}

}  // namespace sagitta::prescription
