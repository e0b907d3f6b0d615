// SPDX-License-Identifier: MIT
//
// Parts of the light that are stored in addition to the picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shlight/types.h"

namespace shlight {

/// Light of a camera ray belongs to one kind and one group.
enum class LightKind : std::uint8_t {
    diffuse,
    glossy,
    transmission,
    diffuse_indirect,
    glossy_indirect,
    transmission_indirect,
    emission,
    environment
};
inline constexpr std::size_t kLightKinds = 8;

/// Tells what a camera ray's path goes on by first: a lobe, or an interface that it goes through.
enum class PathKind : std::uint8_t { direct, diffuse, glossy, transmission };

/// The kind of light that a path brings whose first bounce is the only one: a path that is direct has none.
constexpr LightKind direct_kind(PathKind path) {
    return path == PathKind::diffuse  ? LightKind::diffuse
           : path == PathKind::glossy ? LightKind::glossy
                                      : LightKind::transmission;
}
/// The same of light that has bounced before.
constexpr LightKind indirect_kind(PathKind path) {
    return path == PathKind::diffuse  ? LightKind::diffuse_indirect
           : path == PathKind::glossy ? LightKind::glossy_indirect
                                      : LightKind::transmission_indirect;
}

struct LightParts {
    /// Number of parts: one for each kind, then one for each group; 0: parts are not stored.
    std::size_t count = 0;
    std::size_t lobe_stride = 1;
    std::vector<LightKind> of_lobe;  ///< of lobe i of material m at m · lobe_stride + i

    bool empty() const { return count == 0; }
    static std::size_t of_kind(LightKind kind) { return static_cast<std::size_t>(kind); }
    /// See LightTraits::group.
    static std::size_t of_group(std::uint32_t group) { return kLightKinds + group; }
    /// The kind of light that a lobe reflects at the end of a path.
    LightKind kind(std::size_t material, std::size_t lobe, PathKind path) const {
        return path == PathKind::direct ? of_lobe[material * lobe_stride + lobe] : indirect_kind(path);
    }
};

/// No parts.
inline const LightParts kWholeLight;

/// The parts of the light of pixels, or of other sums of light.
class LightGroupBuffer {
  public:
    /// parts: outlive this.
    explicit LightGroupBuffer(const LightParts& parts) : parts_(&parts) {}

    const LightParts& parts() const { return *parts_; }
    bool empty() const { return parts_->empty(); }
    /// Forgets all light; sums: how many.
    void reset(std::size_t sums) { light_.assign(sums * parts_->count, Rgb(0)); }
    /// Light of no group. Precondition, also of the next: not empty().
    void add(std::size_t number, LightKind kind, const Rgb& light) { of(number)[LightParts::of_kind(kind)] += light; }
    void add(std::size_t number, LightKind kind, std::uint32_t group, const Rgb& light) {
        const std::span<Rgb> own = of(number);
        own[LightParts::of_kind(kind)] += light;
        own[LightParts::of_group(group)] += light;
    }
    /// The parts of one, by kind and group.
    std::span<Rgb> of(std::size_t number) { return std::span(light_).subspan(number * parts_->count, parts_->count); }
    std::span<const Rgb> of(std::size_t number) const {
        return std::span(light_).subspan(number * parts_->count, parts_->count);
    }

  private:
    const LightParts* parts_;
    std::vector<Rgb> light_;
};

/// Scales parts to a sum by adding the difference in proportion to their magnitudes; if all are 0, to part `otherwise`.
void complete(std::span<Rgb> parts, const Rgb& sum, std::size_t otherwise);

}  // namespace shlight
