// SPDX-License-Identifier: MIT
#include "surfaces/light_cells.h"

#include <algorithm>
#include <utility>

namespace shlight {
namespace {

/// Edge of a cell ÷ the length of the rays that end there: at most this, at least half.
constexpr double kCellWidth = 0.177;

/// Memory of a cell beside itself.
constexpr std::size_t kNodeBytes = 32;

std::uint32_t signs(const Vec3f& direction) {
    return (direction.x < 0 ? 1U : 0U) | (direction.y < 0 ? 2U : 0U) | (direction.z < 0 ? 4U : 0U);
}

int level(const SurfacePoint& end, double length) {
    return WorldLattice::level(kCellWidth * std::max(length, end.error));
}

bool lets_through(const SurfaceShader* shader) {
    return shader != nullptr && (shader->transparency || !shader->refractions.empty());
}

/// Whether lobes that are at least so wide show a sharper picture than a cell has.
bool shows_sharply(std::span<const Lobe> lobes, double least_width) {
    return std::any_of(lobes.begin(), lobes.end(), [&](const Lobe& lobe) {
        const float width = widened(lobe.shape, lobe_form(lobe.shape), least_width).width;
        return is_glossy(lobe.shape) && double{width} < LightCells::kLeastWidth;
    });
}

}  // namespace

bool has_narrower(std::span<const Lobe> lobes, double width) {
    return std::any_of(lobes.begin(), lobes.end(), [&](const Lobe& lobe) {
        const LobeForm own = lobe_form(lobe.shape);
        return lobe.varying_width == 0 && own.width < widened(lobe.shape, own, width).width;
    });
}

LightCells::LightCells(const CompiledScene& scene, std::span<const MaterialLobes> materials, double filtered_width,
                       std::size_t parts)
    : lattice_(scene), parts_(parts) {
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const std::span<const Lobe> lobes = materials[i].lobes();
        const bool is_diffuse =
            std::none_of(lobes.begin(), lobes.end(), [](const Lobe& lobe) { return is_glossy(lobe.shape); });
        const bool is_sharp = lets_through(scene.materials()[i].shader.get()) || shows_sharply(lobes, filtered_width);
        looks_.push_back(is_sharp ? Look::sharp : is_diffuse ? Look::everywhere_alike : Look::by_view);
        is_filtered_.push_back(has_narrower(lobes, filtered_width) ? 1 : 0);
    }
}

bool LightCells::find(const SurfacePoint& end, const Vec3f& direction, double length, WorldCell& key) const {
    const Look look = looks_[end.material];
    const std::uint32_t view = look == Look::by_view ? 1 + signs(direction) : 0;
    key = lattice_.cell(end, level(end, length), view);
    return look != Look::sharp;
}

void LightCells::add(const WorldCell& key, std::span<const Rgb> light, const Known& further) {
    const auto [found, is_first] = cells_.try_emplace(key, Cell{light_.size(), {}});
    Cell& cell = found->second;
    if (is_first) {
        light_.resize(light_.size() + parts_, Rgb(0));
    }
    cell.known.samples += further.samples;
    cell.known.rays += further.rays;
    const float share = static_cast<float>(further.samples) / static_cast<float>(cell.known.samples);
    for (std::size_t i = 0; i < parts_; ++i) {
        Rgb& mean = light_[cell.first + i];
        mean += share * (light[i] - mean);
    }
}

LightCells::Known LightCells::known(const WorldCell& key) const {
    const auto found = cells_.find(key);
    return found == cells_.end() ? Known() : found->second.known;
}

std::size_t LightCells::bytes() const {
    return light_.size() * sizeof(Rgb) + cells_.size() * (sizeof(std::pair<WorldCell, Cell>) + kNodeBytes);
}

void LightCells::clear() {
    cells_.clear();
    light_ = {};
}

std::span<const Rgb> LightCells::look_up(const WorldCell& key) const {
    const auto found = cells_.find(key);
    return found == cells_.end() ? std::span<const Rgb>() : std::span(light_).subspan(found->second.first, parts_);
}

}  // namespace shlight
