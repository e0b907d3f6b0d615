// SPDX-License-Identifier: MIT
#include "shlight/surface_shader.h"

#include <cmath>

#include "base/checks.h"

namespace shlight {

std::vector<Lobe> lobes_of(const SurfaceShader& shader) {
    std::vector<Lobe> lobes;
    for (const ShadedLobe& shaded : shader.lobes) {
        if (shaded.alpha) {
            lobes.push_back({shaded.shape, nullptr, Rgb(1), nullptr, *shaded.alpha + 1});
        } else {
            lobes.push_back(Bsdf::lobe(shaded.shape, Rgb(1), nullptr, shaded.only_order).lobes().front());
        }
    }
    return lobes;
}

void check_surface_shader(const SurfaceShader& shader) {
    const std::size_t count = shader.program.result_count();
    const auto check = [&](const char* name, std::optional<std::uint32_t> result, std::size_t width) {
        if (result && *result + width > count) {
            reject(std::string(name) + ": the program has only " + std::to_string(count) + " results");
        }
    };
    for (const ShadedLobe& lobe : shader.lobes) {
        check("weight", lobe.weight, 3);
        check("alpha", lobe.alpha, is_stretched(lobe.shape) ? 5 : has_two_widths(lobe.shape) ? 2 : 1);
        check("normal", lobe.normal, 3);
        check("leans_from", lobe.leans_from, 3);
        if (lobe.subsurface) {
            check("subsurface", lobe.subsurface->numbers, kSubsurfaceNumbers);
        }
    }
    for (const ShadedRefraction& refraction : shader.refractions) {
        check("weight", refraction.weight, 3);
        check("alpha", refraction.alpha, 1);
        check("ior", refraction.ior, 1);
        check("normal", refraction.normal, 3);
    }
    for (const ShadedAov& aov : shader.aovs) {
        check("aov", aov.value, aov.is_color ? 3 : 1);
    }
    for (int channel = 0; channel < 3; ++channel) {
        if (!(shader.absorption[channel] >= 0 && std::isfinite(shader.absorption[channel]))) {
            reject("absorption must be finite and not negative");
        }
    }
    check("emission", shader.emission, 3);
    check("transparency", shader.transparency, 3);
    if (shader.transparency && shader.shadow_program.result_count() != 3) {
        reject("shadow_program must have three results");
    }
}

}  // namespace shlight
