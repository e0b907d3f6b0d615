// SPDX-License-Identifier: MIT
#include "emitters/emitter_levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include <meshoptimizer.h>

#include "emitters/indexed_mesh.h"

namespace shlight {
namespace {

/// Sine of the angle at an edge below which the edge counts as flat.
constexpr double kFlat = 1e-7;
/// Distance of vertices that are one ÷ the extent: poles and seams that were computed twice.
constexpr double kWelded = 1e-6;
/// Number of a level's faces ÷ that of the one before. Errors grow as fast as the number falls, so that their sum is
/// little more than the last one.
constexpr std::size_t kReduction = 4;
/// Largest number of faces of the finest level: with more, edges are so short that outlines zigzag. A sphere with this
/// many has an error of 0.05 % of its solid angle.
constexpr std::size_t kMostFaces = 5120;
/// Largest error as a share of the extent: with more, a coarse mesh is nothing like the fine one.
constexpr float kLargestError = 0.05F;

double area(const IndexedMesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.faces) {
        sum += glm::length(scaled_normal(mesh, t)) / 2;
    }
    return sum;
}

/// The lowest and the highest corner.
std::pair<Vec3d, Vec3d> bounding_box(const IndexedMesh& mesh) {
    Vec3d low = mesh.vertices.front();
    Vec3d high = low;
    for (const Vec3d& v : mesh.vertices) {
        low = glm::min(low, v);
        high = glm::max(high, v);
    }
    return {low, high};
}

/// Each face's half edges, paired with those that run the other way.
std::vector<EmitterEdge> edges_of(const IndexedMesh& mesh) {
    struct Half {
        std::uint32_t low, high, face;
        bool forward;
    };
    std::vector<Half> halves;
    for (std::uint32_t face = 0; face < mesh.faces.size(); ++face) {
        for (int corner = 0; corner < 3; ++corner) {
            const std::uint32_t from = mesh.faces[face][corner];
            const std::uint32_t to = mesh.faces[face][(corner + 1) % 3];
            halves.push_back({std::min(from, to), std::max(from, to), face, from < to});
        }
    }
    std::sort(halves.begin(), halves.end(), [](const Half& a, const Half& b) {
        return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
    });
    std::vector<EmitterEdge> edges;
    for (std::size_t first = 0; first < halves.size();) {
        std::size_t last = first;
        std::array<std::vector<std::uint32_t>, 2> sides;
        while (last < halves.size() && halves[last].low == halves[first].low &&
               halves[last].high == halves[first].high) {
            sides[halves[last].forward ? 0 : 1].push_back(halves[last].face);
            ++last;
        }
        for (std::size_t i = 0; i < std::max(sides[0].size(), sides[1].size()); ++i) {
            const auto side = [&](std::size_t k) { return i < sides[k].size() ? sides[k][i] : EmitterEdge::kNone; };
            edges.push_back({halves[first].low, halves[first].high, side(0), side(1)});
        }
        first = last;
    }
    return edges;
}

bool has_border(std::span<const EmitterEdge> edges) {
    return std::any_of(edges.begin(), edges.end(), [](const EmitterEdge& edge) {
        return edge.left == EmitterEdge::kNone || edge.right == EmitterEdge::kNone;
    });
}

/// Six times the volume that the faces enclose.
double volume(const IndexedMesh& mesh) {
    double sum = 0;
    const Vec3d& origin = mesh.vertices.front();
    for (const Triangle& t : mesh.faces) {
        sum += glm::dot(scaled_normal(mesh, t), mesh.vertices[t.x] - origin);
    }
    return sum;
}

/// The corner of a face that is not on an edge.
const Vec3d& opposite(const IndexedMesh& mesh, std::uint32_t face, const EmitterEdge& edge) {
    const Triangle& t = mesh.faces[face];
    return mesh.vertices[t.x ^ t.y ^ t.z ^ edge.from ^ edge.to];
}

/// Whether a closed surface is in one piece and has no edge that is bent inwards.
bool is_convex(const IndexedMesh& mesh) {
    std::vector<std::uint32_t> piece(mesh.faces.size());
    std::iota(piece.begin(), piece.end(), 0U);
    const auto root_of = [&](std::uint32_t face) {
        while (piece[face] != face) {
            face = piece[face] = piece[piece[face]];
        }
        return face;
    };
    std::size_t pieces = mesh.faces.size();
    for (const EmitterEdge& edge : edges_of(mesh)) {
        const Vec3d normal = scaled_normal(mesh, mesh.faces[edge.left]);
        const Vec3d across = opposite(mesh, edge.right, edge) - mesh.vertices[edge.from];
        if (glm::dot(normal, across) > kFlat * glm::length(normal) * glm::length(across)) {
            return false;
        }
        const std::uint32_t a = root_of(edge.left);
        const std::uint32_t b = root_of(edge.right);
        pieces -= a != b ? 1 : 0;
        piece[a] = b;
    }
    return pieces == 1;
}

/// Removes faces until about that many are left, and adds to the error; returns false with the mesh unchanged if that
/// would tear or deform it.
bool simplify(IndexedMesh& mesh, std::size_t faces, double& error) {
    std::vector<float> positions;
    for (const Vec3d& v : mesh.vertices) {
        // Relative to the first vertex, because float has few digits for the shape far from the world's origin.
        const Vec3d local = v - mesh.vertices.front();
        for (int k = 0; k < 3; ++k) {
            positions.push_back(static_cast<float>(local[k]));
        }
    }
    std::vector<unsigned int> indices;
    for (const Triangle& t : mesh.faces) {
        indices.insert(indices.end(), {t.x, t.y, t.z});
    }
    std::vector<unsigned int> kept(indices.size());
    float relative = 0;
    constexpr std::size_t kStride = 3 * sizeof(float);
    kept.resize(meshopt_simplify(kept.data(), indices.data(), indices.size(), positions.data(), mesh.vertices.size(),
                                 kStride, 3 * faces, kLargestError, 0, &relative));
    std::vector<Triangle> triangles;
    for (std::size_t i = 0; i + 2 < kept.size(); i += 3) {
        triangles.emplace_back(kept[i], kept[i + 1], kept[i + 2]);
    }
    IndexedMesh simple = welded(mesh.vertices, triangles, kWelded);
    if (2 * simple.faces.size() > mesh.faces.size() || simple.faces.empty() || has_border(edges_of(simple))) {
        return false;
    }
    error += static_cast<double>(relative) *
             static_cast<double>(meshopt_simplifyScale(positions.data(), mesh.vertices.size(), kStride));
    mesh = std::move(simple);
    return true;
}

void scale(IndexedMesh& mesh, const Vec3d& center, double factor) {
    for (Vec3d& v : mesh.vertices) {
        v = center + factor * (v - center);
    }
}

/// Spreads 21 bits to every third bit.
std::uint64_t spread_bits(std::uint64_t x) {
    x = (x | x << 32U) & 0x1F00000000FFFFU;
    x = (x | x << 16U) & 0x1F0000FF0000FFU;
    x = (x | x << 8U) & 0x100F00F00F00F00FU;
    x = (x | x << 4U) & 0x10C30C30C30C30C3U;
    return (x | x << 2U) & 0x1249249249249249U;
}

/// Faces in the order of a space-filling curve (Morton 1966) through their middles, so that neighbours are close.
void sort_along_curve(const IndexedMesh& mesh, std::vector<EmitterEdge>& edges) {
    const std::pair<Vec3d, Vec3d> box = bounding_box(mesh);
    const Vec3d extent = box.second - box.first;
    const double scale = 0x1FFFFF / std::max({extent.x, extent.y, extent.z});
    const auto key = [&](const EmitterEdge& edge) {
        const Vec3d middle = (0.5 * (mesh.vertices[edge.from] + mesh.vertices[edge.to]) - box.first) * scale;
        return spread_bits(static_cast<std::uint64_t>(middle.x)) |
               spread_bits(static_cast<std::uint64_t>(middle.y)) << 1U |
               spread_bits(static_cast<std::uint64_t>(middle.z)) << 2U;
    };
    std::stable_sort(edges.begin(), edges.end(),
                     [&](const EmitterEdge& a, const EmitterEdge& b) { return key(a) < key(b); });
}

/// Numbers of the faces along some edges of a closed surface, each once.
std::vector<std::uint32_t> faces_along(std::span<const EmitterEdge> edges) {
    std::vector<std::uint32_t> faces;
    for (const EmitterEdge& edge : edges) {
        faces.insert(faces.end(), {edge.left, edge.right});
    }
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    return faces;
}

/// The bounds of faces' planes, without the planes' positions.
EdgeBlock bounds_of(const IndexedMesh& mesh, std::span<const EmitterEdge> edges, std::span<const std::uint32_t> faces) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    EdgeBlock block{0, 0, 0, 0, Vec3d(0), Vec3d(0), 1, 0, kInfinity, -kInfinity};
    for (const EmitterEdge& edge : edges) {
        block.center += 0.5 * (mesh.vertices[edge.from] + mesh.vertices[edge.to]);
    }
    block.center /= static_cast<double>(edges.size());
    for (const std::uint32_t face : faces) {
        block.axis += glm::normalize(scaled_normal(mesh, mesh.faces[face]));
    }
    const double length = glm::length(block.axis);
    block.axis = length > 0 ? block.axis / length : Vec3d(0, 0, 1);
    for (const std::uint32_t face : faces) {
        const Vec3d normal = glm::normalize(scaled_normal(mesh, mesh.faces[face]));
        const double height = glm::dot(normal, mesh.vertices[mesh.faces[face].x] - block.center);
        block.cosine = std::min(block.cosine, glm::dot(normal, block.axis));
        block.low = std::min(block.low, height);
        block.high = std::max(block.high, height);
    }
    // The angles of the planes with each other must be less than half a turn for them to be seen from one side.
    if (block.cosine <= 0) {
        block.low = -kInfinity;
        block.high = kInfinity;
    }
    block.cosine = std::max(block.cosine, 0.0);
    block.sine = std::sqrt((1 - block.cosine) * (1 + block.cosine));
    return block;
}

void add_block(const IndexedMesh& mesh, std::span<const EmitterEdge> edges, EmitterLevel& level) {
    const std::vector<std::uint32_t> faces = faces_along(edges);
    EdgeBlock block = bounds_of(mesh, edges, faces);
    block.first = level.edges.size();
    block.last = block.first + edges.size();
    block.first_plane = level.block_planes.size();
    block.plane_count = faces.size();
    for (const std::uint32_t face : faces) {
        level.block_planes.push_back(level.planes[face]);
    }
    const auto place = [&](std::uint32_t face) {
        return static_cast<std::uint8_t>(std::lower_bound(faces.begin(), faces.end(), face) - faces.begin());
    };
    for (const EmitterEdge& edge : edges) {
        level.edges.push_back({edge.from, edge.to, place(edge.left), place(edge.right)});
    }
    level.blocks.push_back(block);
}

EmitterLevel level_of(IndexedMesh mesh, double error) {
    EmitterLevel level;
    for (const Triangle& t : mesh.faces) {
        const Vec3d normal = scaled_normal(mesh, t);
        level.planes.push_back({normal, glm::dot(normal, mesh.vertices[t.x])});
    }
    std::vector<EmitterEdge> edges = edges_of(mesh);
    sort_along_curve(mesh, edges);
    for (std::size_t first = 0; first < edges.size(); first += kBlockEdges) {
        add_block(mesh, std::span(edges).subspan(first, std::min(kBlockEdges, edges.size() - first)), level);
    }
    level.vertices = std::move(mesh.vertices);
    level.faces = std::move(mesh.faces);
    level.error = error;
    return level;
}

void find_extent(const IndexedMesh& mesh, EmitterLevels& emitter) {
    const auto [low, high] = bounding_box(mesh);
    emitter.center = 0.5 * (low + high);
    emitter.radius = 0;
    for (const Vec3d& v : mesh.vertices) {
        emitter.radius = std::max(emitter.radius, glm::length(v - emitter.center));
    }
}

/// Finds all but whether it is convex, and turns the mesh outwards.
EmitterLevels measure(IndexedMesh& mesh, const Stopped& stopped, bool one_sided) {
    EmitterLevels emitter{{}, one_sided, false, false, false, Vec3d(0), 0, 0};
    end_if(stopped);
    if (mesh.faces.empty()) {
        return emitter;
    }
    find_extent(mesh, emitter);
    const bool whole = !has_border(edges_of(mesh));
    const bool is_inverted = whole && volume(mesh) < 0;
    emitter.turned = is_inverted && !one_sided;
    for (Triangle& t : emitter.turned ? std::span(mesh.faces) : std::span<Triangle>()) {
        std::swap(t.y, t.z);
    }
    emitter.closed = whole && is_inverted == emitter.turned;
    emitter.area = area(mesh);
    end_if(stopped);
    return emitter;
}

}  // namespace

double shown_share(const EmitterLevels& emitter, double distance) {
    // A surface shows a quarter of its area on average (Cauchy), which is a share of the hemisphere.
    return std::min(1.0, emitter.area / 4 / (std::numbers::pi * distance * distance));
}

const EmitterLevel& level_for(const EmitterLevels& emitter, double distance, double tolerance) {
    const double share = shown_share(emitter, distance);
    for (std::size_t i = emitter.levels.size() - 1; i > 0; --i) {
        const double strip = 2 * std::numbers::pi * emitter.radius * emitter.levels[i].error;
        if (kOneSided * strip / (emitter.area / 4) * share <= tolerance) {
            return emitter.levels[i];
        }
    }
    return emitter.levels.front();
}

EmitterLevels measure_emitter(std::span<const Vec3d> vertices, std::span<const Triangle> triangles,
                              const Stopped& stopped, bool one_sided) {
    end_if(stopped);
    IndexedMesh mesh = welded(vertices, triangles, kWelded);
    return measure(mesh, stopped, one_sided);
}

EmitterLevels make_emitter_levels(std::span<const Vec3d> vertices, std::span<const Triangle> triangles,
                                  std::size_t least_faces, const Stopped& stopped, bool one_sided) {
    end_if(stopped);
    IndexedMesh mesh = welded(vertices, triangles, kWelded);
    EmitterLevels emitter = measure(mesh, stopped, one_sided);
    emitter.convex = emitter.closed && is_convex(mesh);
    end_if(stopped);
    if (!emitter.convex) {
        return emitter;
    }
    double error = 0;
    if (mesh.faces.size() > kMostFaces) {
        simplify(mesh, kMostFaces, error);
    }
    do {
        end_if(stopped);
        IndexedMesh level = mesh;
        scale(level, emitter.center, std::sqrt(emitter.area / area(level)));
        emitter.levels.push_back(level_of(std::move(level), error));
    } while (mesh.faces.size() / kReduction >= least_faces && simplify(mesh, mesh.faces.size() / kReduction, error));
    return emitter;
}

}  // namespace shlight
