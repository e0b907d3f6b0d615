// SPDX-License-Identifier: MIT
#include "tracing/light_parts.h"

namespace shlight {

void complete(std::span<Rgb> parts, const Rgb& sum, std::size_t otherwise) {
    Vec3d all(0);
    Vec3d magnitude(0);
    for (const Rgb& part : parts) {
        all += Vec3d(part);
        magnitude += Vec3d(glm::abs(part));
    }
    const Vec3d missing = Vec3d(sum) - all;
    for (int channel = 0; channel < 3; ++channel) {
        if (!(magnitude[channel] > 0)) {
            parts[otherwise][channel] += static_cast<float>(missing[channel]);
            continue;
        }
        const double share = missing[channel] / magnitude[channel];
        for (Rgb& part : parts) {
            part[channel] += static_cast<float>(share * std::abs(double{part[channel]}));
        }
    }
}

}  // namespace shlight
