// SPDX-License-Identifier: MIT
#include "shaders/hash_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shaders/hash_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <cstddef>

#include "shaders/cell_hash-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

template <std::size_t n>
void hash_in_lanes(const OperationLanes& lanes) {
    const Floats d;
    for (std::size_t i = 0; i < lanes.count; i += kLaneCount<Floats>) {
        Row<n> key;
        for (std::size_t k = 0; k < n; ++k) {
            key[k] = hn::LoadU(d, lanes.arguments[k] + i);
        }
        hn::StoreU(jenkins(key), d, lanes.results[0] + i);
    }
}

void hash1(const OperationLanes& lanes) {
    hash_in_lanes<1>(lanes);
}
void hash2(const OperationLanes& lanes) {
    hash_in_lanes<2>(lanes);
}
void hash3(const OperationLanes& lanes) {
    hash_in_lanes<3>(lanes);
}
void hash4(const OperationLanes& lanes) {
    hash_in_lanes<4>(lanes);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(hash1);
HWY_EXPORT(hash2);
HWY_EXPORT(hash3);
HWY_EXPORT(hash4);

template <>
void hash<1>(const OperationLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(hash1)(lanes);
}
template <>
void hash<2>(const OperationLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(hash2)(lanes);
}
template <>
void hash<3>(const OperationLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(hash3)(lanes);
}
template <>
void hash<4>(const OperationLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(hash4)(lanes);
}

}  // namespace shlight
#endif
