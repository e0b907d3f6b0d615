// SPDX-License-Identifier: MIT
#include "shlight/ray_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

#include "tracing/embree_compat.h"

namespace shlight {
namespace {

struct DeviceDeleter {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct GeometryDeleter {
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using Device = std::unique_ptr<RTCDeviceTy, DeviceDeleter>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, SceneDeleter>;
using Geometry = std::unique_ptr<RTCGeometryTy, GeometryDeleter>;

void throw_on_error(RTCDevice device) {
    switch (rtcGetDeviceError(device)) {
        case RTC_ERROR_NONE:
            return;
        case RTC_ERROR_OUT_OF_MEMORY:
            throw std::bad_alloc();
        case RTC_ERROR_CANCELLED:
            throw RenderCancelled();
        default:
            throw std::runtime_error("Embree failed to build the scene");
    }
}

template <class T>
T* new_buffer(RTCDevice device, RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t count) {
    void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), count);
    if (buffer == nullptr) {
        throw_on_error(device);
        throw std::bad_alloc();
    }
    return static_cast<T*>(buffer);
}

Geometry triangle_geometry(RTCDevice device, const TracedGeometry& source) {
    Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
    auto* vertices =
        new_buffer<Vec3f>(device, geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, source.vertices.size());
    std::copy(source.vertices.begin(), source.vertices.end(), vertices);
    auto* triangles =
        new_buffer<Triangle>(device, geometry.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, source.triangles.size());
    std::copy(source.triangles.begin(), source.triangles.end(), triangles);
    rtcCommitGeometry(geometry.get());
    return geometry;
}

Geometry instance_geometry(RTCDevice device, RTCScene instanced, const glm::dmat4& to_world) {
    Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE));
    rtcSetGeometryInstancedScene(geometry.get(), instanced);
    std::array<float, 12> columns{};
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 3; ++row) {
            columns[static_cast<std::size_t>(3 * column + row)] = static_cast<float>(to_world[column][row]);
        }
    }
    rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
    rtcCommitGeometry(geometry.get());
    return geometry;
}

/// Robust mode is watertight along shared edges, so that no light leaks through a closed mesh.
EmbreeScene new_scene(RTCDevice device) {
    EmbreeScene scene(rtcNewScene(device));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    return scene;
}

void build(RTCDevice device, RTCScene scene, const Stopped& stopped) {
    const auto goes_on = [](void* asked, double) { return !(*static_cast<const Stopped*>(asked))(); };
    if (stopped) {
        Stopped asked = stopped;
        rtcSetSceneProgressMonitorFunction(scene, goes_on, &asked);
        rtcJoinCommitScene(scene);
        rtcSetSceneProgressMonitorFunction(scene, nullptr, nullptr);
    } else {
        rtcJoinCommitScene(scene);
    }
    throw_on_error(device);
}

/// Rays are not flagged as coherent: those of a hit to a light or the sky diverge too much for Embree to gain.
template <class Packet, std::size_t kWidth>
void trace_packets(RTCScene scene, std::span<const Ray> rays, std::span<std::uint8_t> blocked) {
    for (std::size_t first = 0; first < rays.size(); first += kWidth) {
        const std::size_t count = std::min(kWidth, rays.size() - first);
        alignas(64) std::array<int, kWidth> valid{};
        Packet packet{};
        for (std::size_t i = 0; i < count; ++i) {
            const Ray& ray = rays[first + i];
            valid[i] = -1;
            packet.org_x[i] = ray.origin.x;
            packet.org_y[i] = ray.origin.y;
            packet.org_z[i] = ray.origin.z;
            packet.tnear[i] = ray.t_min;
            packet.dir_x[i] = ray.direction.x;
            packet.dir_y[i] = ray.direction.y;
            packet.dir_z[i] = ray.direction.z;
            packet.tfar[i] = ray.t_max;
            packet.mask[i] = 0xFFFFFFFFU;
        }
        embree::occluded(valid.data(), scene, &packet);
        // Embree marks a blocked ray by tfar = -∞.
        for (std::size_t i = 0; i < count; ++i) {
            blocked[first + i] = packet.tfar[i] < 0 ? 1 : 0;
        }
    }
}

}  // namespace

class RayTracer::Impl {
  public:
    Impl(std::span<const TracedGeometry> geometries, std::span<const TracedInstance> instances, const Stopped& stopped)
        : device_(rtcNewDevice(nullptr)) {
        if (!device_) {
            throw std::runtime_error("Embree cannot be started: error " +
                                     std::to_string(static_cast<int>(rtcGetDeviceError(nullptr))));
        }
        scene_ = new_scene(device_.get());
        std::vector<EmbreeScene> shared(geometries.size());
        for (std::size_t i = 0; i < instances.size(); ++i) {
            end_if(stopped);
            const TracedInstance& instance = instances[i];
            const TracedGeometry& source = geometries[instance.geometry];
            Geometry geometry;
            if (instance.identity) {
                geometry = triangle_geometry(device_.get(), source);
            } else {
                EmbreeScene& instanced = shared[instance.geometry];
                if (!instanced) {
                    instanced = new_scene(device_.get());
                    rtcAttachGeometry(instanced.get(), triangle_geometry(device_.get(), source).get());
                    build(device_.get(), instanced.get(), stopped);
                }
                geometry = instance_geometry(device_.get(), instanced.get(), instance.to_world);
            }
            rtcAttachGeometryByID(scene_.get(), geometry.get(), static_cast<unsigned>(i));
        }
        build(device_.get(), scene_.get(), stopped);
        has_wide_packets_ = rtcGetDeviceProperty(device_.get(), RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0;
    }

    RTCScene scene() const { return scene_.get(); }
    bool has_wide_packets() const { return has_wide_packets_; }

  private:
    Device device_;
    EmbreeScene scene_;
    bool has_wide_packets_ = false;  // of 16 rays
};

RayTracer::RayTracer(std::span<const TracedGeometry> geometries, std::span<const TracedInstance> instances,
                     const Stopped& stopped)
    : impl_(std::make_unique<const Impl>(geometries, instances, stopped)) {}

RayTracer::~RayTracer() = default;

void RayTracer::intersect(std::span<const Ray> rays, std::span<RayHit> hits) const {
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray& ray = rays[i];
        RTCRayHit query{};
        query.ray = {ray.origin.x,
                     ray.origin.y,
                     ray.origin.z,
                     ray.t_min,
                     ray.direction.x,
                     ray.direction.y,
                     ray.direction.z,
                     0.0F,
                     ray.t_max,
                     0xFFFFFFFFU,
                     0U,
                     0U};
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        embree::intersect1(impl_->scene(), &query);
        RayHit hit;
        if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
            const bool instanced = query.hit.instID[0] != RTC_INVALID_GEOMETRY_ID;
            hit = {instanced ? query.hit.instID[0] : query.hit.geomID, query.hit.primID, query.hit.u, query.hit.v,
                   query.ray.tfar};
        }
        hits[i] = hit;
    }
}

void RayTracer::occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const {
    if (impl_->has_wide_packets()) {
        trace_packets<RTCRay16, 16>(impl_->scene(), rays, blocked);
    } else {
        trace_packets<RTCRay8, 8>(impl_->scene(), rays, blocked);
    }
}

}  // namespace shlight
