// SPDX-License-Identifier: MIT
//
// Light that has bounced, stored at few points: Eq. 5 of the paper with the harmonics of a record in place of a lamp's.
//
// A record holds incident radiance of the half space above its surface, by the number of bounces. Between records
// their light is interpolated (Křivánek et al. 2005, "Radiance Caching for Efficient Global Illumination
// Computation"). A record reaches as far as its radius, along its surface rather than away from it, and where the
// surface has turned little.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <glm/vec4.hpp>

#include "shlight/surface_point.h"
#include "shlight/types.h"
#include "surfaces/world_lattice.h"

namespace shlight {

/// Bands of a record: a cosine lobe has no band 3, and those from 6 on change what it reflects by less than 1 %.
inline constexpr int kRecordOrder = 5;
inline constexpr std::size_t kRecordTerms = std::size_t{kRecordOrder} * kRecordOrder;

/// Radiance in harmonics, in the world frame. The fourth number is for lanes.
using RecordHarmonics = std::array<glm::vec4, kRecordTerms>;
using RecordBasis = std::array<float, kRecordTerms>;

struct LightRecord {
    /// Sectors of directions along the surface.
    static constexpr std::size_t kSectors = 8;

    WorldCell cell;          ///< that it stands for
    std::uint32_t used = 0;  ///< number of the last picture that has asked for it
    Vec3d position;
    Vec3d normal;         ///< unit
    Vec3d along, across;  ///< unit, at right angles to the normal and each other
    /// How far the surface is free of others that stand on it, by sector [m].
    std::array<float, kSectors> free;
    double radius = 0;
    double whole_radius = 0;  ///< before any other record was found to differ
    /// Parts (StoredLight) of what has bounced at most once, twice ….
    std::vector<RecordHarmonics> light;
    /// Radiance that a white diffuse surface with the record's normal reflects of it, and its change along each axis
    /// of the world [1/m].
    std::vector<Rgb> reflected;
    std::vector<std::array<Rgb, 3>> gradient;
    /// Standard deviation of what a white diffuse surface reflects of all that light.
    Rgb noise{0};

    /// Sets the radius, within bounds that count in this order, and makes gradients no larger than they can be: light
    /// is nowhere negative.
    void limit_radius(double wanted, double least, double most);
    /// The sector of a way along the surface.
    std::size_t sector(const Vec3d& way) const;
};

/// Light of the records near a place.
struct RecordedLight {
    float weight = 0;  ///< sum of the records' weights; 0: none is near
    Rgb mean{0};       ///< weighted, of what a white diffuse surface reflects
    /// Its variance between records, and that of the mean by the records' noise. Floats would not hold the squares of
    /// the weights of records that hardly reach here.
    Vec3d variance{0}, noise{0};
};

/// Any number of threads may read it.
class LightRecords {
  public:
    std::span<const LightRecord> all() const { return records_; }
    void add(LightRecord record);
    /// Whether there is the record of a cell, of whichever picture.
    bool knows(const WorldCell& cell) const { return cells_.contains(cell); }
    /// Whether the picture uses it.
    bool has(const WorldCell& cell) const;
    /// Whether there is the record of a cell, which the picture then uses as if it were added now.
    bool use(const WorldCell& cell);
    std::size_t number_of(const WorldCell& cell) const { return cells_.at(cell); }
    /// Notes for this picture and later ones that the records around suffice for a cell.
    void spare(const WorldCell& cell) { spared_.insert(cell); }
    bool spares(const WorldCell& cell) const { return spared_.contains(cell); }
    /// Indexes all records, of whichever picture.
    void index_all() { index(0); }
    /// Leaves all records to earlier pictures: the one that begins uses none of them yet.
    void begin_picture();
    /// Memory of all, about.
    std::size_t bytes() const;
    /// Keeps so many bytes of records, and no cells that were spared: the records that were used last, and of these the
    /// ones that reach farthest.
    void keep_latest(std::size_t most_bytes);
    /// Lets a record reach less far.
    void shrink(std::size_t record, double radius) { records_[record].radius = radius; }
    /// To be called once records were used, added or shrunk, before any of the functions below, which know those that
    /// the picture uses.
    void index() { index(picture_); }

    /// reflected[i]: what a white diffuse surface with this normal reflects of the records' light number first + i.
    /// lobe: f·cos of the lobe that the surface has instead. Returns false if no record is near.
    bool reflect(const SurfacePoint& point, const Vec3d& normal, const std::optional<RecordBasis>& lobe,
                 std::size_t first, std::span<Rgb> reflected) const;
    /// The same for one, with its errors.
    RecordedLight look_up(const SurfacePoint& point, std::size_t number) const;
    /// Calls f(number, record, weight) for each record near a point.
    template <class Function>
    void for_each_near(const SurfacePoint& point, const Function& f) const {
        const Vec3f position(point.position);
        const Vec3f normal(point.shading_normal);
        for (const Grid& grid : grids_) {
            for (const Sphere& sphere : grid.at(point.position)) {
                const float weight = sphere.weight(position, normal);
                const LightRecord& record = records_[sphere.number];
                if (weight > 0 && is_free(record, point.position)) {
                    f(sphere.number, record, weight);
                }
            }
        }
    }

  private:
    /// The part of a record that its weight depends on.
    struct Sphere {
        Vec3f center, normal;
        float radius;
        std::uint32_t number;  // of the record

        float weight(const Vec3f& position, const Vec3f& normal_there) const;
    };
    /// Records whose spheres are at most as wide as a cell; each is in all cells that its sphere meets.
    struct Grid {
        double cell;
        std::vector<std::uint64_t> keys;  // ascending; of each distinct cell
        std::vector<std::uint32_t> begin;
        std::vector<Sphere> spheres;

        std::span<const Sphere> at(const Vec3d& position) const;
    };
    static bool is_free(const LightRecord& record, const Vec3d& position);
    /// Makes the table of spheres of the records that pictures from the oldest one on have used.
    void index(std::uint32_t oldest);
    class Diffuse;

    std::vector<LightRecord> records_;
    std::unordered_map<WorldCell, std::size_t, WorldCellHash> cells_;  // the number of each one's record
    std::unordered_set<WorldCell, WorldCellHash> spared_;
    std::uint32_t picture_ = 0;
    std::vector<Grid> grids_;
};

/// Y_lm(normal) times the share of band l that a white diffuse surface reflects.
RecordBasis reflected_basis(const Vec3d& normal);
Rgb sum_of(const RecordHarmonics& light, const RecordBasis& basis);

}  // namespace shlight
