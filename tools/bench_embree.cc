// SPDX-License-Identifier: Apache-2.0
// The only user of Embree.
#include "tools/bench_embree.h"

#include <fmt/core.h>

#if SAGITTA_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cstring>
#include <limits>
#include <stdexcept>

namespace sagitta::bench {
namespace {

// What the two versions say differently: the hint that rays are coherent, and the order of arguments.
class Call {
 public:
#if SAGITTA_EMBREE == 4
  explicit Call(bool coherent) {
    rtcInitIntersectArguments(&arguments_);
    if (coherent) arguments_.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  }
  void operator()(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &ray, &arguments_); }
  void operator()(RTCScene scene, RTCRayHit4& rays) { rtcIntersect4(all_, scene, &rays, &arguments_); }
  void operator()(RTCScene scene, RTCRayHit8& rays) { rtcIntersect8(all_, scene, &rays, &arguments_); }
  void operator()(RTCScene scene, RTCRayHit16& rays) { rtcIntersect16(all_, scene, &rays, &arguments_); }

 private:
  RTCIntersectArguments arguments_;
#else
  explicit Call(bool coherent) {
    rtcInitIntersectContext(&context_);
    if (coherent) context_.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  }
  void operator()(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &context_, &ray); }
  void operator()(RTCScene scene, RTCRayHit4& rays) { rtcIntersect4(all_, scene, &context_, &rays); }
  void operator()(RTCScene scene, RTCRayHit8& rays) { rtcIntersect8(all_, scene, &context_, &rays); }
  void operator()(RTCScene scene, RTCRayHit16& rays) { rtcIntersect16(all_, scene, &context_, &rays); }
  void stream(RTCScene scene, RTCRayHit* rays, unsigned count) { rtcIntersect1M(scene, &context_, rays, count, sizeof *rays); }
  void stream(RTCScene scene, RTCRayHit16* packets, unsigned count) {
    rtcIntersectNM(scene, &context_, reinterpret_cast<RTCRayHitN*>(packets), 16, count, sizeof *packets);
  }

 private:
  RTCIntersectContext context_;
#endif
  alignas(64) static constexpr int all_[16] = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
};

constexpr unsigned streamed = 256;  // rays

struct Device {
  RTCDevice device = rtcNewDevice("threads=1");
  RTCScene scene = rtcNewScene(device);

  explicit Device(const surface::Mesh& mesh) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertex_count));
    auto* corner = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.facet_count));
    if (!vertex || !corner) throw std::runtime_error("Embree gives no memory");
    for (std::uint32_t v = 0; v < mesh.vertex_count; ++v)
      for (const double coordinate : {mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z}) *vertex++ = static_cast<float>(coordinate);
    for (std::uint32_t f = 0; f < mesh.facet_count; ++f)
      for (const std::uint32_t v : mesh.corners[f]) *corner++ = v;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    rtcCommitScene(scene);
  }
  ~Device() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
};

// Rays in Embree's layout: one after the other, or as columns of a few at a time.
template <class Packet, unsigned width, bool is_stream>
class Rays : public EmbreeRays {
 public:
  Rays(const surface::Mesh& mesh, const trace::RayBatch& rays, bool coherent) : device_(mesh), call_(coherent), packets_(rays.size() / width) {
    if (rays.size() % streamed != 0) throw std::invalid_argument("rays come in blocks of 256");
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto d = rays.direction(i), start = rays.position(i) - d;
      auto& ray = packets_[i / width].ray;
      const auto set = [lane = i % width](auto& column, double value) { at(column, lane) = static_cast<float>(value); };
      set(ray.org_x, start.x), set(ray.org_y, start.y), set(ray.org_z, start.z);
      set(ray.dir_x, d.x), set(ray.dir_y, d.y), set(ray.dir_z, d.z);
      set(ray.tnear, 0), set(ray.time, 0);
      at(ray.mask, i % width) = 0xFFFFFFFFu;
      at(ray.id, i % width) = static_cast<unsigned>(i);
      at(ray.flags, i % width) = 0;
    }
    Rays::forget_hits();
  }
  void forget_hits() override {
    for (Packet& packet : packets_)
      for (unsigned lane = 0; lane < width; ++lane) {
        at(packet.ray.tfar, lane) = std::numeric_limits<float>::infinity();
        at(packet.hit.geomID, lane) = RTC_INVALID_GEOMETRY_ID;
        at(packet.hit.instID[0], lane) = RTC_INVALID_GEOMETRY_ID;
      }
  }
  void run() override {
    if constexpr (is_stream) {
      constexpr unsigned count = streamed / width;
      for (std::size_t i = 0; i < packets_.size(); i += count) call_.stream(device_.scene, &packets_[i], count);
    } else {
      for (Packet& packet : packets_) call_(device_.scene, packet);
    }
  }
  std::int64_t hits() const override {
    std::int64_t count = 0;
    for (const Packet& packet : packets_)
      for (unsigned lane = 0; lane < width; ++lane) count += at(packet.hit.geomID, lane) != RTC_INVALID_GEOMETRY_ID;
    return count;
  }

 private:
  template <class Column>
  static auto& at(Column& column, std::size_t lane) {
    if constexpr (width == 1) return column;
    else return column[lane];
  }

  Device device_;
  Call call_;
  std::vector<Packet> packets_;
};

struct Kind {
  const char* call;
  std::unique_ptr<EmbreeRays> (*make)(const surface::Mesh&, const trace::RayBatch&);
};
template <class Packet, unsigned width, bool is_stream, bool coherent>
std::unique_ptr<EmbreeRays> make(const surface::Mesh& mesh, const trace::RayBatch& rays) {
  return std::make_unique<Rays<Packet, width, is_stream>>(mesh, rays, coherent);
}
constexpr Kind kinds[]{{"rtcIntersect1", make<RTCRayHit, 1, false, false>},
                       {"rtcIntersect4", make<RTCRayHit4, 4, false, true>},
                       {"rtcIntersect8", make<RTCRayHit8, 8, false, true>},
                       {"rtcIntersect16", make<RTCRayHit16, 16, false, true>},
#if SAGITTA_EMBREE == 3
                       {"rtcIntersect1M", make<RTCRayHit, 1, true, true>},
                       {"rtcIntersectNM", make<RTCRayHit16, 16, true, true>},
#endif
};

}  // namespace

std::string embree_version() { return fmt::format("Embree {}", RTC_VERSION_STRING); }

std::vector<std::string> embree_calls() {
  std::vector<std::string> calls;
  for (const Kind& kind : kinds) calls.push_back(kind.call);
  return calls;
}

std::unique_ptr<EmbreeRays> embree_rays(const surface::Mesh& mesh, const trace::RayBatch& rays, const std::string& call) {
  for (const Kind& kind : kinds)
    if (call == kind.call) return kind.make(mesh, rays);
  throw std::invalid_argument("Embree has no " + call);
}

}  // namespace sagitta::bench
