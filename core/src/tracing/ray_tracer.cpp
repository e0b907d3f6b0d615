// SPDX-License-Identifier: MIT
#include "shlight/ray_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include <tbb/task_arena.h>

#include "tracing/embree_compat.h"

namespace shlight {
namespace {

struct SceneDeleter {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct GeometryDeleter {
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using Device = std::shared_ptr<RTCDeviceTy>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, SceneDeleter>;
using Geometry = std::unique_ptr<RTCGeometryTy, GeometryDeleter>;

/// One for the process, as long as anything is built with it: Embree refuses to join what different devices have built.
Device shared_device() {
    static std::mutex mutex;
    static std::weak_ptr<RTCDeviceTy> recent;
    const std::scoped_lock lock(mutex);
    Device device = recent.lock();
    if (!device) {
        RTCDevice made = rtcNewDevice(nullptr);
        if (made == nullptr) {
            const RTCError error = rtcGetDeviceError(nullptr);
            if (error == RTC_ERROR_OUT_OF_MEMORY) {
                throw std::bad_alloc();
            }
            throw std::runtime_error("Embree cannot be started: error " + std::to_string(static_cast<int>(error)));
        }
        device = Device(made, rtcReleaseDevice);
        recent = device;
    }
    return device;
}

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

/// A geometry that rays of all kinds meet: by default Embree 4 has it met by those of the first kind alone.
Geometry new_geometry(RTCDevice device, RTCGeometryType type) {
    Geometry geometry(rtcNewGeometry(device, type));
    rtcSetGeometryMask(geometry.get(), ~0U);
    return geometry;
}

Geometry triangle_geometry(RTCDevice device, std::span<const Vec3f> vertices, std::span<const Triangle> triangles) {
    Geometry geometry = new_geometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    std::ranges::copy(vertices, new_buffer<Vec3f>(device, geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3,
                                                  vertices.size()));
    std::ranges::copy(triangles, new_buffer<Triangle>(device, geometry.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3,
                                                      triangles.size()));
    rtcCommitGeometry(geometry.get());
    return geometry;
}

/// Leaves out hits from within.
void meet_from_outside(const RTCFilterFunctionNArguments* given) {
    for (unsigned i = 0; i < given->N; ++i) {
        const Vec3f direction(RTCRayN_dir_x(given->ray, given->N, i), RTCRayN_dir_y(given->ray, given->N, i),
                              RTCRayN_dir_z(given->ray, given->N, i));
        const Vec3f normal(RTCHitN_Ng_x(given->hit, given->N, i), RTCHitN_Ng_y(given->hit, given->N, i),
                           RTCHitN_Ng_z(given->hit, given->N, i));
        given->valid[i] = glm::dot(direction, normal) > 0 ? 0 : given->valid[i];
    }
}

Geometry round_geometry(RTCDevice device, const RoundParts& parts) {
    Geometry geometry =
        new_geometry(device, parts.form == SurfaceForm::ribbons ? RTC_GEOMETRY_TYPE_FLAT_CATMULL_ROM_CURVE
                             : parts.form == SurfaceForm::tubes ? RTC_GEOMETRY_TYPE_ROUND_CATMULL_ROM_CURVE
                                                                : RTC_GEOMETRY_TYPE_SPHERE_POINT);
    std::ranges::copy(parts.points, new_buffer<glm::vec4>(device, geometry.get(), RTC_BUFFER_TYPE_VERTEX,
                                                          RTC_FORMAT_FLOAT4, parts.points.size()));
    if (parts.form != SurfaceForm::spheres) {
        std::ranges::copy(parts.segments, new_buffer<std::uint32_t>(device, geometry.get(), RTC_BUFFER_TYPE_INDEX,
                                                                    RTC_FORMAT_UINT, parts.segments.size()));
        rtcSetGeometryTessellationRate(geometry.get(), static_cast<float>(parts.subdivisions));
    }
    if (parts.form != SurfaceForm::ribbons) {
        rtcSetGeometryIntersectFilterFunction(geometry.get(), meet_from_outside);
        rtcSetGeometryOccludedFilterFunction(geometry.get(), meet_from_outside);
    }
    rtcCommitGeometry(geometry.get());
    return geometry;
}

Geometry instance_geometry(RTCDevice device, RTCScene instanced, const TracedInstance& instance) {
    Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE));
    rtcSetGeometryInstancedScene(geometry.get(), instanced);
    std::array<float, 12> columns{};
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 3; ++row) {
            columns[static_cast<std::size_t>(3 * column + row)] = static_cast<float>(instance.to_world[column][row]);
        }
    }
    rtcSetGeometryMask(geometry.get(), instance.seen_by);
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
    Stopped asked = stopped;
    if (asked) {
        const auto goes_on = [](void* question, double) { return !(*static_cast<const Stopped*>(question))(); };
        rtcSetSceneProgressMonitorFunction(scene, goes_on, &asked);
    }
    // Isolated: a thread that waits here must not begin another tree, nor work that expects denormal numbers, which
    // Embree turns off meanwhile.
    tbb::this_task_arena::isolate([&] { rtcJoinCommitScene(scene); });
    rtcSetSceneProgressMonitorFunction(scene, nullptr, nullptr);
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
            packet.mask[i] = ray.kinds;
        }
        embree::occluded(valid.data(), scene, &packet);
        // Embree marks a blocked ray by tfar = -∞.
        for (std::size_t i = 0; i < count; ++i) {
            blocked[first + i] = packet.tfar[i] < 0 ? 1 : 0;
        }
    }
}

}  // namespace

class SurfaceTree::Impl {
  public:
    /// make: the geometry with a device.
    template <class Make>
    Impl(const Make& make, std::vector<std::uint32_t> wanted, const Stopped& stopped)
        : device(shared_device()), scene(new_scene(device.get())), numbers(std::move(wanted)) {
        rtcAttachGeometry(scene.get(), make(device.get()).get());
        build(device.get(), scene.get(), stopped);
    }

    Device device;
    EmbreeScene scene;
    std::vector<std::uint32_t> numbers;
};

SurfaceTree::SurfaceTree(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                         std::vector<std::uint32_t> numbers, const Stopped& stopped)
    : impl_(
          std::make_unique<const Impl>([&](RTCDevice device) { return triangle_geometry(device, vertices, triangles); },
                                       std::move(numbers), stopped)) {}

SurfaceTree::SurfaceTree(RoundParts parts, const Stopped& stopped)
    : impl_(std::make_unique<const Impl>([&](RTCDevice device) { return round_geometry(device, parts); },
                                         std::move(parts.numbers), stopped)) {}

SurfaceTree::~SurfaceTree() = default;

class RayTracer::Impl {
  public:
    Impl(std::vector<TracedInstance> placed, const Stopped& stopped)
        : device(shared_device()),
          instances(std::move(placed)),
          scene(new_scene(device.get())),
          has_wide_packets(rtcGetDeviceProperty(device.get(), RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0) {
        for (std::size_t i = 0; i < instances.size(); ++i) {
            if (instances[i].tree != nullptr) {
                const Geometry instance =
                    instance_geometry(device.get(), instances[i].tree->impl_->scene.get(), instances[i]);
                rtcAttachGeometryByID(scene.get(), instance.get(), static_cast<unsigned>(i));
            }
        }
        build(device.get(), scene.get(), stopped);
    }

    Device device;
    std::vector<TracedInstance> instances;
    EmbreeScene scene;
    bool has_wide_packets;  // of 16 rays
};

RayTracer::RayTracer(std::vector<TracedInstance> instances, const Stopped& stopped)
    : impl_(std::make_unique<const Impl>(std::move(instances), stopped)) {}

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
                     ray.kinds,
                     0U,
                     0U};
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        embree::intersect1(impl_->scene.get(), &query);
        hits[i] = RayHit();
        if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
            const std::uint32_t instance = query.hit.instID[0];
            const std::vector<std::uint32_t>& numbers = impl_->instances[instance].tree->impl_->numbers;
            hits[i] = {instance,       numbers.empty() ? query.hit.primID : numbers[query.hit.primID],
                       query.hit.u,    query.hit.v,
                       query.ray.tfar, {query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z}};
        }
    }
}

void RayTracer::occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const {
    if (impl_->has_wide_packets) {
        trace_packets<RTCRay16, 16>(impl_->scene.get(), rays, blocked);
    } else {
        trace_packets<RTCRay8, 8>(impl_->scene.get(), rays, blocked);
    }
}

void RayTracer::near(const Vec3f& point, float radius, std::vector<RayHit>& found) const {
    struct Search {
        const std::vector<TracedInstance>& instances;
        std::vector<RayHit>& hits;
    } search{impl_->instances, found};
    const auto note = [](RTCPointQueryFunctionArguments* given) {
        const auto& [instances, hits] = *static_cast<const Search*>(given->userPtr);
        const std::uint32_t instance = given->context->instID[0];
        if ((instances[instance].seen_by & kShadowRay) != 0) {
            const std::vector<std::uint32_t>& numbers = instances[instance].tree->impl_->numbers;
            hits.push_back({instance, numbers.empty() ? given->primID : numbers[given->primID]});
        }
        return false;  // the radius stays
    };
    RTCPointQuery query{point.x, point.y, point.z, 0, radius};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(impl_->scene.get(), &query, &context, note, &search);
}

}  // namespace shlight
