// SPDX-License-Identifier: MIT
//
// The emissive faces of meshes as lights. Those of a scene with many of them are lights together.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "shlight/light.h"
#include "shlight/parallel.h"
#include "surfaces/compiled_mesh.h"

namespace shlight {

/// The faces of an instance of a mesh that shine to one side, or to both, in the scene's frame.
struct EmissiveFaces {
    std::vector<Vec3d> vertices;
    std::vector<Triangle> triangles;  ///< that show the side from which they run counter-clockwise, if it is one
    std::vector<Rgb> radiance;        ///< one for each of them
    EmissiveMesh mesh;
    LightTraits traits;
};

/// Calls visit with the emissive faces of each instance of a mesh. EmissiveMesh::instance counts these from `first`.
void visit_emissive_faces(const CompiledMesh& compiled, std::uint32_t first,
                          const std::function<void(EmissiveFaces&&)>& visit);

/// Adds the flat parts of the faces as lights, or all as one, if they have too many corners. Throws RenderCancelled
/// once stopped.
void add_lights(const EmissiveFaces& faces, const Stopped& stopped, std::vector<Light>& lights);

/// A mesh that shines in a scene.
struct PlacedEmitter {
    std::shared_ptr<const CompiledMesh> mesh;
    std::uint32_t first_instance;

    bool operator==(const PlacedEmitter&) const = default;
};

/// The lights of many meshes, of which those with the same traits are one: its faces are found by a tree, while each of
/// many lights is looked at from every hit.
struct JoinedLights {
    std::vector<PlacedEmitter> emitters;
    std::vector<Light> lights;
};

/// Throws RenderCancelled once stopped.
JoinedLights joined_lights(std::vector<PlacedEmitter> emitters, const Stopped& stopped);

}  // namespace shlight
