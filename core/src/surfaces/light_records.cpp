// SPDX-License-Identifier: MIT
#include "surfaces/light_records.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

#include <glm/geometric.hpp>

#include "shlight/basis.h"

namespace shlight {
namespace {

/// A record counts as so many times as far away as it is above or below a surface.
constexpr float kAcross = 10;
/// Cosine of the turn of the surface beyond which a record does not count.
constexpr float kLeastCosine = 0.7F;
/// Memory of a record beside itself: of the cells that it is in.
constexpr std::size_t kIndexBytes = 256;
/// Memory of a cell that is spared beside itself.
constexpr std::size_t kSparedBytes = 24;
/// Cosine of the angle of normals that count as the same.
constexpr double kEqualNormals = 1 - 1e-9;

std::uint64_t key_of(const glm::i64vec3& cell) {
    constexpr std::uint64_t kMask = (1U << 21) - 1;
    const auto part = [](std::int64_t i) { return static_cast<std::uint64_t>(i) & kMask; };
    return part(cell.x) | part(cell.y) << 21 | part(cell.z) << 42;
}

glm::i64vec3 cell_of(const Vec3d& position, double cell) {
    return glm::i64vec3(glm::floor(position / cell));
}

}  // namespace

RecordBasis reflected_basis(const Vec3d& normal) {
    // The coefficients of cosθ / π by bands are known (Ramamoorthi & Hanrahan 2001).
    constexpr std::array<float, kRecordOrder> kShares = {1, 2.0F / 3, 1.0F / 4, 0, -1.0F / 24};
    RecordBasis basis;
    const Vec3f direction(normal);
    sh_basis(std::span<const Vec3f>(&direction, 1), kRecordOrder, std::span<float>(basis));
    std::size_t i = 0;
    for (int l = 0; l < kRecordOrder; ++l) {
        for (int m = 0; m < 2 * l + 1; ++m) {
            basis[i++] *= kShares[static_cast<std::size_t>(l)];
        }
    }
    return basis;
}

Rgb sum_of(const RecordHarmonics& light, const RecordBasis& basis) {
    glm::vec4 sum(0);
    for (std::size_t i = 0; i < kRecordTerms; ++i) {
        sum += light[i] * basis[i];
    }
    return {sum.x, sum.y, sum.z};
}

/// Records that reach less far are nearer to each other, and count the more.
float density(const LightRecord& record) {
    return static_cast<float>(1 / (record.radius * record.radius));
}

/// A white diffuse surface, or a lobe: what it reflects of a record's light.
class LightRecords::Diffuse {
  public:
    Diffuse(const Vec3d& position, const Vec3d& normal, const std::optional<RecordBasis>& lobe = std::nullopt)
        : position_(position), normal_(normal), is_lobe_(lobe.has_value()), basis_(lobe) {}

    Rgb reflected(const LightRecord& record, std::size_t number) {
        const Vec3f way(position_ - record.position);
        const auto& [x, y, z] = record.gradient[number];
        const Rgb change = way.x * x + way.y * y + way.z * z;
        if (!is_lobe_ && glm::dot(record.normal, normal_) > kEqualNormals) {
            return glm::max(record.reflected[number] + change, Rgb(0));
        }
        if (!basis_) {
            basis_ = reflected_basis(normal_);
        }
        return glm::max(sum_of(record.light[number], *basis_) + change, Rgb(0));
    }

  private:
    Vec3d position_, normal_;
    bool is_lobe_;
    std::optional<RecordBasis> basis_;
};

void LightRecord::limit_radius(double wanted, double least, double most) {
    radius = std::clamp(wanted, std::min(least, most), most);
    for (std::size_t k = 0; k < gradient.size(); ++k) {
        for (int c = 0; c < 3; ++c) {
            const glm::vec3 own(gradient[k][0][c], gradient[k][1][c], gradient[k][2][c]);
            const float change = glm::length(own) * static_cast<float>(radius);
            const float bound = std::max(reflected[k][c], 0.0F);  // the last bands may make it less than none
            const float factor = change > bound ? bound / change : 1.0F;
            for (Rgb& axis : gradient[k]) {
                axis[c] *= factor;
            }
        }
    }
}

std::size_t LightRecord::sector(const Vec3d& way) const {
    const double a = glm::dot(way, along);
    const double b = glm::dot(way, across);
    return (a < 0 ? 1U : 0U) + (b < 0 ? 2U : 0U) + (std::abs(a) < std::abs(b) ? 4U : 0U);
}

bool LightRecords::is_free(const LightRecord& record, const Vec3d& position) {
    const Vec3d way = position - record.position;
    const auto free = double{record.free[record.sector(way)]};
    return glm::dot(way, way) <= free * free;
}

std::span<const LightRecords::Sphere> LightRecords::Grid::at(const Vec3d& position) const {
    const auto found = std::ranges::lower_bound(keys, key_of(cell_of(position, cell)));
    if (found == keys.end() || *found != key_of(cell_of(position, cell))) {
        return {};
    }
    const auto i = static_cast<std::size_t>(found - keys.begin());
    return std::span(spheres).subspan(begin[i], begin[i + 1] - begin[i]);
}

void LightRecords::add(LightRecord record) {
    record.used = picture_;
    record.whole_radius = record.radius;
    cells_[record.cell] = records_.size();
    records_.push_back(std::move(record));
}

bool LightRecords::has(const WorldCell& cell) const {
    const auto found = cells_.find(cell);
    return found != cells_.end() && records_[found->second].used == picture_;
}

bool LightRecords::use(const WorldCell& cell) {
    const auto found = cells_.find(cell);
    if (found != cells_.end()) {
        LightRecord& record = records_[found->second];
        record.used = picture_;
        record.radius = record.whole_radius;
    }
    return found != cells_.end();
}

void LightRecords::begin_picture() {
    ++picture_;
    grids_.clear();
}

std::size_t LightRecords::bytes() const {
    const std::size_t count = records_.empty() ? 0 : records_.front().light.size();
    return records_.size() * (sizeof(LightRecord) + count * (sizeof(RecordHarmonics) + 4 * sizeof(Rgb)) + kIndexBytes) +
           spared_.size() * (sizeof(WorldCell) + kSparedBytes);
}

void LightRecords::keep_latest(std::size_t most_bytes) {
    spared_.clear();
    const std::size_t all = records_.size();
    const std::size_t most = all == 0 ? 0 : most_bytes / (bytes() / all);
    if (all <= most) {
        return;
    }
    std::ranges::sort(records_, std::greater<>(),
                      [](const LightRecord& record) { return std::tuple(record.used, record.radius); });
    for (std::size_t i = 0; i < all; ++i) {
        const auto cell = cells_.find(records_[i].cell);
        if (i < most) {
            cell->second = i;
        } else {
            cells_.erase(cell);
        }
    }
    records_.resize(most);
    grids_.clear();
}

void LightRecords::index(std::uint32_t oldest) {
    std::map<int, std::vector<std::pair<std::uint64_t, std::uint32_t>>> places;  // by the exponent of the cell
    for (std::size_t number = 0; number < records_.size(); ++number) {
        const LightRecord& record = records_[number];
        if (record.used < oldest) {
            continue;
        }
        const int exponent = std::ilogb(2 * record.radius) + 1;
        const double cell = std::ldexp(1.0, exponent);
        const glm::i64vec3 first = cell_of(record.position - record.radius, cell);
        const glm::i64vec3 last = cell_of(record.position + record.radius, cell);
        for (std::int64_t x = first.x; x <= last.x; ++x) {
            for (std::int64_t y = first.y; y <= last.y; ++y) {
                for (std::int64_t z = first.z; z <= last.z; ++z) {
                    places[exponent].emplace_back(key_of({x, y, z}), static_cast<std::uint32_t>(number));
                }
            }
        }
    }
    grids_.clear();
    for (auto& [exponent, own] : places) {
        std::ranges::sort(own);
        Grid& grid = grids_.emplace_back(Grid{std::ldexp(1.0, exponent), {}, {}, {}});
        for (const auto& [key, number] : own) {
            if (grid.keys.empty() || grid.keys.back() != key) {
                grid.keys.push_back(key);
                grid.begin.push_back(static_cast<std::uint32_t>(grid.spheres.size()));
            }
            const LightRecord& record = records_[number];
            grid.spheres.push_back(
                {Vec3f(record.position), Vec3f(record.normal), static_cast<float>(record.radius), number});
        }
        grid.begin.push_back(static_cast<std::uint32_t>(grid.spheres.size()));
    }
}

float LightRecords::Sphere::weight(const Vec3f& position, const Vec3f& normal_there) const {
    const Vec3f way = position - center;
    const float square = glm::dot(way, way);
    const float turn = glm::dot(normal, normal_there);
    if (square >= radius * radius || turn <= kLeastCosine) {
        return 0;
    }
    const float across = kAcross / 2 * glm::dot(way, normal + normal_there);
    const float near = std::max(1 - std::sqrt(square + across * across) / radius, 0.0F);
    return near * near * (turn - kLeastCosine) / (1 - kLeastCosine);
}

bool LightRecords::reflect(const SurfacePoint& point, const Vec3d& normal, const std::optional<RecordBasis>& lobe,
                           std::size_t first, std::span<Rgb> reflected_light) const {
    Diffuse surface(point.position, normal, lobe);
    float weights = 0;
    for_each_near(point, [&](std::size_t, const LightRecord& record, float nearness) {
        const float weight = nearness * density(record);
        weights += weight;
        for (std::size_t i = 0; i < reflected_light.size(); ++i) {
            reflected_light[i] += weight * surface.reflected(record, first + i);
        }
    });
    for (Rgb& light : reflected_light) {
        light = weights > 0 ? light / weights : Rgb(0);
    }
    return weights > 0;
}

RecordedLight LightRecords::look_up(const SurfacePoint& point, std::size_t number) const {
    Diffuse surface(point.position, point.shading_normal);
    RecordedLight found;
    Vec3d sum(0);
    Vec3d square(0);
    Vec3d own_noise(0);
    double weights = 0;
    for_each_near(point, [&](std::size_t, const LightRecord& record, float nearness) {
        const double weight = double{nearness} * density(record);
        const Vec3d light(surface.reflected(record, number));
        const Vec3d noise(record.noise);
        found.weight += nearness;
        weights += weight;
        sum += weight * light;
        square += weight * light * light;
        own_noise += weight * noise * noise;
        found.noise += weight * weight * noise * noise;
    });
    if (found.weight > 0) {
        const Vec3d mean = sum / weights;
        found.mean = Rgb(mean);
        found.noise /= weights * weights;
        found.variance = glm::max((square - own_noise) / weights - mean * mean, Vec3d(0));
    }
    return found;
}

}  // namespace shlight
