// SPDX-License-Identifier: MIT
//
// Parts of the light that are kept apart beside the picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shlight/types.h"

namespace shlight {

/// Each light that a camera ray brings counts towards a kind and towards a group.
enum class LightKind : std::uint8_t { diffuse, glossy, emission, environment };
inline constexpr std::size_t kLightKinds = 4;

struct LightParts {
    /// 0: light is not kept apart; otherwise one for each kind, then one for each group.
    std::size_t count = 0;
    std::size_t lobe_stride = 1;
    std::vector<LightKind> of_lobe;  ///< of lobe i of material m at m · lobe_stride + i

    bool empty() const { return count == 0; }
    static std::size_t of_kind(LightKind kind) { return static_cast<std::size_t>(kind); }
    /// See LightTraits::group.
    static std::size_t of_group(std::uint32_t group) { return kLightKinds + group; }
    LightKind kind(std::size_t material, std::size_t lobe) const { return of_lobe[material * lobe_stride + lobe]; }
};

/// Light that is not kept apart.
inline const LightParts kWholeLight;

/// What is kept apart of hits, camera rays or shading points.
class KeptApart {
  public:
    explicit KeptApart(const LightParts& parts = kWholeLight) : parts_(&parts) {}

    const LightParts& parts() const { return *parts_; }
    bool empty() const { return parts_->empty(); }
    /// parts: outlive this.
    void reset(const LightParts& parts, std::size_t size) {
        parts_ = &parts;
        light_.assign(size * parts.count, Rgb(0));
    }
    void clear() { light_.clear(); }
    void push_back() { light_.resize(light_.size() + parts_->count, Rgb(0)); }
    /// Precondition: not empty().
    void add(std::size_t index, LightKind kind, std::uint32_t group, const Rgb& light) {
        const std::span<Rgb> own = of(index);
        own[LightParts::of_kind(kind)] += light;
        own[LightParts::of_group(group)] += light;
    }
    /// By kind and group.
    std::span<Rgb> of(std::size_t index) { return std::span(light_).subspan(index * parts_->count, parts_->count); }
    std::span<const Rgb> of(std::size_t index) const {
        return std::span(light_).subspan(index * parts_->count, parts_->count);
    }
    std::span<Rgb> kinds(std::size_t index) { return of(index).first(kLightKinds); }
    std::span<Rgb> groups(std::size_t index) { return of(index).subspan(kLightKinds); }

  private:
    const LightParts* parts_;
    std::vector<Rgb> light_;
};

/// Adds to parts what they lack of a sum, in proportion to their magnitudes; where all are 0, to the one numbered
/// `otherwise`.
void complete(std::span<Rgb> parts, const Rgb& sum, std::size_t otherwise);

}  // namespace shlight
