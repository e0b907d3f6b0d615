// SPDX-License-Identifier: MIT
#include "environment/bright_spots.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "environment/bright_spots.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <cmath>

#include "lobes/lobe_lanes-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

/// In float: no lobe is so narrow that a spot has an extent beside it.
Rgb reflect(const BrightSpots::Arrays& spots, const LobeShape& shape, const Vec3f& view, const glm::mat3& to_map) {
    Rgb reflected(0);
    with_lobe_lanes(shape, [&](const auto& lobe) HWY_ATTR {
        const Floats d;
        const auto view_lanes = lobe.view(d, hn::Set(d, view.z), all(d, lobe_width(shape)));
        const auto along = [&](int axis, V<Floats> x, V<Floats> y, V<Floats> z) HWY_ATTR {
            const Vec3f& to = to_map[axis];
            return hn::MulAdd(hn::Set(d, to.x), x, hn::MulAdd(hn::Set(d, to.y), y, hn::Mul(hn::Set(d, to.z), z)));
        };
        auto red = hn::Zero(d), green = hn::Zero(d), blue = hn::Zero(d);
        for (std::size_t i = 0; i < spots.count; i += kLaneCount<Floats>) {
            const auto x = hn::LoadU(d, spots.x + i);
            const auto y = hn::LoadU(d, spots.y + i);
            const auto z = hn::LoadU(d, spots.z + i);
            const auto cosine = along(2, x, y, z);
            const HalfSum sum = {hn::Add(along(0, x, y, z), hn::Set(d, view.x)), along(1, x, y, z),
                                 hn::Add(cosine, hn::Set(d, view.z))};
            const auto above = hn::Gt(cosine, hn::Zero(d));
            const auto value = hn::IfThenElseZero(above, lobe.value(sum, cosine, view_lanes));
            red = hn::MulAdd(value, hn::LoadU(d, spots.r + i), red);
            green = hn::MulAdd(value, hn::LoadU(d, spots.g + i), green);
            blue = hn::MulAdd(value, hn::LoadU(d, spots.b + i), blue);
        }
        const auto total = [&](V<Floats> lanes) HWY_ATTR { return hn::GetLane(hn::SumOfLanes(d, lanes)); };
        reflected = Rgb(total(red), total(green), total(blue));
    });
    return reflected;
}

std::size_t lane_count() {
    return kLaneCount<Floats>;
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(reflect);
HWY_EXPORT(lane_count);

BrightSpots::BrightSpots(std::span<const BrightSpot> spots) {
    const std::size_t lanes = HWY_DYNAMIC_DISPATCH(lane_count)();
    const std::size_t size = (spots.size() + lanes - 1) / lanes * lanes;
    for (std::vector<float>* array : {&x_, &y_, &z_, &r_, &g_, &b_}) {
        array->resize(size);
    }
    for (std::size_t i = 0; i < spots.size(); ++i) {
        x_[i] = static_cast<float>(spots[i].direction.x);
        y_[i] = static_cast<float>(spots[i].direction.y);
        z_[i] = static_cast<float>(spots[i].direction.z);
        r_[i] = spots[i].irradiance.x;
        g_[i] = spots[i].irradiance.y;
        b_[i] = spots[i].irradiance.z;
    }
}

Rgb BrightSpots::reflected(const LobeShape& shape, double cos_theta_o, const glm::dmat3& to_map) const {
    const Vec3f view(std::sqrt(1 - cos_theta_o * cos_theta_o), 0, cos_theta_o);
    const Arrays arrays = {x_.data(), y_.data(), z_.data(), r_.data(), g_.data(), b_.data(), x_.size()};
    return HWY_DYNAMIC_DISPATCH(reflect)(arrays, shape, view, glm::mat3(to_map));
}

}  // namespace shlight
#endif
