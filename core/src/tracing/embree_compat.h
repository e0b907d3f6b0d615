// SPDX-License-Identifier: MIT
//
// The few calls in which Embree 3 and 4 differ. SHLIGHT_EMBREE_MAJOR comes from the build.
#pragma once

#if SHLIGHT_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace shlight::embree {

#if SHLIGHT_EMBREE_MAJOR >= 4

inline void intersect1(RTCScene scene, RTCRayHit* ray_hit) {
    rtcIntersect1(scene, ray_hit, nullptr);
}

inline void occluded(const int* valid, RTCScene scene, RTCRay8* rays) {
    rtcOccluded8(valid, scene, rays, nullptr);
}

inline void occluded(const int* valid, RTCScene scene, RTCRay16* rays) {
    rtcOccluded16(valid, scene, rays, nullptr);
}

#else

inline void intersect1(RTCScene scene, RTCRayHit* ray_hit) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, ray_hit);
}

inline void occluded(const int* valid, RTCScene scene, RTCRay8* rays) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded8(valid, scene, &context, rays);
}

inline void occluded(const int* valid, RTCScene scene, RTCRay16* rays) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded16(valid, scene, &context, rays);
}

#endif

}  // namespace shlight::embree
