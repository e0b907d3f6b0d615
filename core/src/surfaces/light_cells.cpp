// SPDX-License-Identifier: MIT
#include "surfaces/light_cells.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

namespace shlight {
namespace {

/// Edge of a cell ÷ the length of the rays that end there: at most this, at least half.
constexpr double kCellWidth = 0.177;

/// Bits of a number with two zeros between each and the next.
std::uint64_t spread_bits(std::int64_t number) {
    std::uint64_t bits = static_cast<std::uint64_t>(number) & 0x7FFFF;
    bits = (bits | bits << 32) & 0x1F00000000FFFF;
    bits = (bits | bits << 16) & 0x1F0000FF0000FF;
    bits = (bits | bits << 8) & 0x100F00F00F00F00F;
    bits = (bits | bits << 4) & 0x10C30C30C30C30C3;
    return (bits | bits << 2) & 0x1249249249249249;
}

std::uint32_t signs(const Vec3f& direction) {
    return (direction.x < 0 ? 1U : 0U) | (direction.y < 0 ? 2U : 0U) | (direction.z < 0 ? 4U : 0U);
}

/// The axis of the world that a direction is close to.
std::uint32_t face(const Vec3d& direction) {
    const Vec3d size = glm::abs(direction);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    return static_cast<std::uint32_t>(2 * axis + (direction[axis] < 0 ? 1 : 0));
}

bool is_sharp(const SurfaceShader* shader, std::span<const Lobe> lobes) {
    return (shader != nullptr && (shader->transparency || !shader->refractions.empty())) ||
           std::any_of(lobes.begin(), lobes.end(), [](const Lobe& lobe) {
               return is_glossy(lobe.shape) && lobe_width(lobe.shape) < LightCells::kLeastWidth;
           });
}

}  // namespace

LightCells::LightCells(const CompiledScene& scene, std::span<const MaterialLobes> materials, std::size_t parts)
    : parts_(parts) {
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const std::span<const Lobe> lobes = materials[i].lobes();
        const bool is_diffuse =
            std::none_of(lobes.begin(), lobes.end(), [](const Lobe& lobe) { return is_glossy(lobe.shape); });
        looks_.push_back(is_sharp(scene.materials()[i].shader.get(), lobes) ? Look::sharp
                         : is_diffuse                                       ? Look::everywhere_alike
                                                                            : Look::by_view);
    }
}

bool LightCells::find(const SurfacePoint& end, const Vec3f& direction, double length, Key& key) const {
    const int level = std::ilogb(kCellWidth * std::max(length, end.error));
    const glm::i64vec3 cell(glm::floor(end.position * std::ldexp(1.0, -level)));
    const Look look = looks_[end.material];
    const std::uint32_t view = look == Look::by_view ? 1 + signs(direction) : 0;
    key.place = static_cast<std::uint64_t>(level) << 57 | spread_bits(cell.x) | spread_bits(cell.y) << 1 |
                spread_bits(cell.z) << 2;
    key.kind = (face(end.geometric_normal) << 4 | view) << 24 | (end.material & 0xFFFFFF);
    return look != Look::sharp;
}

std::size_t LightCells::Hash::operator()(const Key& key) const {
    // The finalizer of SplitMix64.
    std::uint64_t x = key.place + key.kind * 0x9E3779B97F4A7C15U;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
    return x ^ (x >> 31);
}

void LightCells::add(const Key& key, std::span<const Rgb> light, float weight) {
    const auto [found, is_first] = cells_.try_emplace(key, Cell{light_.size(), 0});
    Cell& cell = found->second;
    if (is_first) {
        light_.resize(light_.size() + parts_, Rgb(0));
    }
    cell.weight += weight;
    for (std::size_t i = 0; i < parts_; ++i) {
        Rgb& mean = light_[cell.first + i];
        mean += (weight / cell.weight) * (light[i] - mean);
    }
}

float LightCells::weight(const Key& key) const {
    const auto found = cells_.find(key);
    return found == cells_.end() ? 0 : found->second.weight;
}

std::span<const Rgb> LightCells::look_up(const Key& key) const {
    const auto found = cells_.find(key);
    return found == cells_.end() ? std::span<const Rgb>() : std::span(light_).subspan(found->second.first, parts_);
}

}  // namespace shlight
