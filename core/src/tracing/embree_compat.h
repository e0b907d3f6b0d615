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

inline void occluded8(const int* valid, RTCScene scene, RTCRay8* rays) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcOccluded8(valid, scene, rays, &arguments);
}

#else

inline void intersect1(RTCScene scene, RTCRayHit* ray_hit) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, ray_hit);
}

inline void occluded8(const int* valid, RTCScene scene, RTCRay8* rays) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcOccluded8(valid, scene, &context, rays);
}

#endif

}  // namespace shlight::embree
