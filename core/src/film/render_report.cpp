// SPDX-License-Identifier: MIT
#include "shlight/render_report.h"

#include <algorithm>
#include <functional>

namespace shlight {

RenderReport& RenderReport::operator+=(const RenderReport& part) {
    std::ranges::transform(order_counts, part.order_counts, order_counts.begin(), std::plus<>());
    cubature_count += part.cubature_count;
    mirror_count += part.mirror_count;
    hits += part.hits;
    over_tolerance += part.over_tolerance;
    shadow_rays += part.shadow_rays;
    records += part.records;
    std::ranges::transform(stage_seconds, part.stage_seconds, stage_seconds.begin(), std::plus<>());
    return *this;
}

}  // namespace shlight
