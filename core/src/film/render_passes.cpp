// SPDX-License-Identifier: MIT
#include "shlight/render_passes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "base/checks.h"

namespace shlight {
namespace {

std::size_t channels(Pass kind, int levels) {
    switch (kind) {
        case Pass::depth:
        case Pass::object_index:
        case Pass::material_index:
        case Pass::mist:
        case Pass::denoising_depth:
        case Pass::aov_value:
            return 1;
        case Pass::aov_color:
            return 4;
        case Pass::cryptomatte_object:
        case Pass::cryptomatte_material:
        case Pass::cryptomatte_asset:
            return 4 * static_cast<std::size_t>((levels + 1) / 2);
        default:
            return 3;
    }
}

}  // namespace

/// MurmurHash3 by Austin Appleby, public domain.
std::uint32_t cryptomatte_hash(std::string_view name) {
    std::uint32_t hash = 0;
    std::uint32_t block = 0;
    const auto mix = [&] { hash ^= std::rotl(block * 0xCC9E2D51U, 15) * 0x1B873593U; };
    for (std::size_t i = 0; i < name.size(); ++i) {
        block |= std::uint32_t{static_cast<unsigned char>(name[i])} << (8 * (i % 4));
        if (i % 4 == 3) {
            mix();
            hash = std::rotl(hash, 13) * 5 + 0xE6546B64U;
            block = 0;
        }
    }
    mix();
    hash ^= static_cast<std::uint32_t>(name.size());
    hash = (hash ^ (hash >> 16U)) * 0x85EBCA6BU;
    hash = (hash ^ (hash >> 13U)) * 0xC2B2AE35U;
    return hash ^ (hash >> 16U);
}

float cryptomatte_id(std::string_view name) {
    const std::uint32_t hash = cryptomatte_hash(name);
    // Subnormal numbers, infinities and NaN are avoided, because programs may not preserve them.
    const std::uint32_t exponent = (hash >> 23U) & 0xFFU;
    return std::bit_cast<float>(exponent == 0 || exponent == 0xFFU ? hash ^ (1U << 23U) : hash);
}

PassLayout::PassLayout(const PassSettings& settings) {
    const int levels = settings.cryptomatte_levels;
    if (levels < 2 || levels > 16) {
        reject("cryptomatte_levels must be 2 … 16, got " + std::to_string(levels));
    }
    if (!(settings.alpha_threshold >= 0 && settings.alpha_threshold <= 1)) {
        reject("alpha_threshold must be 0 … 1");
    }
    const MistRange& mist = settings.mist;
    if (!(std::isfinite(mist.start) && std::isfinite(mist.depth) && mist.depth >= 0)) {
        reject("mist must start and end at finite distances, the end not before the start");
    }
    if (!(std::isfinite(mist.falloff) && mist.falloff >= 0)) {
        reject("mist must have a falloff that is finite and not negative");
    }
    for (const RenderPass& pass : settings.passes) {
        if (find(pass) != nullptr) {
            reject("passes must differ from each other");
        }
        add(pass, levels);
    }
    const auto add_divisor = [&](Pass divided, Pass divisor) {
        if (find(divided) != nullptr && find(divisor) == nullptr) {
            add({divisor}, levels);
        }
    };
    for (const Pass divided : {Pass::diffuse_direct, Pass::diffuse_indirect}) {
        add_divisor(divided, Pass::diffuse_color);
    }
    for (const Pass divided : {Pass::glossy_direct, Pass::glossy_indirect}) {
        add_divisor(divided, Pass::glossy_color);
    }
    for (const Pass divided : {Pass::transmission_direct, Pass::transmission_indirect}) {
        add_divisor(divided, Pass::transmission_color);
    }
}

void PassLayout::add(const RenderPass& pass, int levels) {
    const std::size_t size = channels(pass.kind, levels);
    places_.push_back({pass, stride_, size});
    stride_ += size;
}

const PassLayout::Place* PassLayout::find(const RenderPass& pass) const {
    const auto known =
        std::find_if(places_.begin(), places_.end(), [&](const Place& place) { return place.pass == pass; });
    return known != places_.end() ? &*known : nullptr;
}

}  // namespace shlight
