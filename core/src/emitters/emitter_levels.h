// SPDX-License-Identifier: MIT
//
// Emissive meshes at several levels of detail. A surface of even radiance, seen from outside, is determined by its
// outline, and a coarse mesh has the outline of a fine one within its error.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "shlight/parallel.h"
#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// An edge with its faces: `left` passes it from `from` to `to`, `right` the other way; kNone at a border. Where more
/// than two faces meet there is an edge for each pair.
struct EmitterEdge {
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

    std::uint32_t from, to;
    std::uint32_t left, right;
};

/// A face's plane; a point is in front of it if dot(normal, point) > height.
struct EmitterPlane {
    Vec3d normal;
    double height;
};

/// A block of neighbouring edges, with bounds of their faces' planes: if a point is in front of all of these, or behind
/// all, no edge of the block is part of its outline.
struct EdgeBlock {
    std::size_t first, last;               ///< edges first … last - 1
    std::size_t first_plane, plane_count;  ///< in EmitterLevel::block_planes, each face once
    Vec3d center;
    Vec3d axis;           ///< unit, in the middle of the faces' normals
    double cosine, sine;  ///< of the largest angle between the axis and a normal
    double low, high;     ///< of the planes' heights over the center; infinite if no point is in front of all
};

/// An EmitterEdge of a closed surface, with the numbers of its faces' planes in its block.
struct BlockEdge {
    std::uint32_t from, to;
    std::uint8_t left, right;
};

/// Edges of a block: of smaller ones there are more to look at, of larger ones more that lie on both sides of a point.
inline constexpr std::size_t kBlockEdges = 16;

/// A convex surface.
struct EmitterLevel {
    std::vector<Vec3d> vertices;
    std::vector<BlockEdge> edges;
    std::vector<EdgeBlock> blocks;           ///< of all edges, in their order
    std::vector<EmitterPlane> block_planes;  ///< of their faces
    std::vector<EmitterPlane> planes;        ///< one for each face; of any length of the normal
    std::vector<Triangle> faces;
    double error;  ///< distance between this surface and the finest, about [m]
};

/// A surface that emits to both sides, or to that of its normals, in the world frame.
struct EmitterLevels {
    std::vector<EmitterLevel> levels;  ///< from fine to coarse; none of a surface that is not convex
    bool one_sided;
    bool turned;    ///< the given mesh is wound the other way
    bool closed;    ///< encloses a volume, and is wound so that its normals point out of it
    bool convex;    ///< and every point before some face lies outside
    Vec3d center;   ///< of the bounding box
    double radius;  ///< largest distance of a vertex from it
    double area;
};

/// Net share of the strip between two outlines that is on one side: for levels of equal area, at most a seventh was
/// found on spheres.
inline constexpr double kOneSided = 0.15;

/// Approximate radiance of a white surface that faces the centre from this distance ÷ the emitter's radiance.
double shown_share(const EmitterLevels& emitter, double distance);

/// The coarsest level whose outline has an error, as radiance of a white surface at this distance from the centre, of
/// about the tolerance at most; the finest if none does.
const EmitterLevel& level_for(const EmitterLevels& emitter, double distance, double tolerance);

/// A surface without its levels, of which it is not known whether it is convex. Throws as make_emitter_levels does.
EmitterLevels measure_emitter(std::span<const Vec3d> vertices, std::span<const Triangle> triangles,
                              const Stopped& stopped, bool one_sided);

/// Equal vertices are joined, and triangles without area left out. The finest level has at most some 5000 faces, each
/// one after it about a quarter of those of the one before, down to `least_faces`; all are scaled to the area of the
/// given mesh: a closed surface shows a quarter of its area on average (Cauchy), so that no level is brighter.
/// A closed surface that is not one-sided may be wound either way. The area is 0 if no triangle has one. Throws
/// RenderCancelled once it is to end.
EmitterLevels make_emitter_levels(std::span<const Vec3d> vertices, std::span<const Triangle> triangles,
                                  std::size_t least_faces, const Stopped& stopped = {}, bool one_sided = false);

}  // namespace shlight
