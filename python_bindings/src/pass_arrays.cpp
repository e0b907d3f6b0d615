// SPDX-License-Identifier: MIT
#include "pass_arrays.h"

#include <algorithm>
#include <array>
#include <set>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "arguments.h"

namespace shlight::python {

namespace {

constexpr std::array kNames = {
    std::pair("depth", Pass::depth),
    std::pair("position", Pass::position),
    std::pair("normal", Pass::normal),
    std::pair("uv", Pass::uv),
    std::pair("object_index", Pass::object_index),
    std::pair("material_index", Pass::material_index),
    std::pair("mist", Pass::mist),
    std::pair("emission", Pass::emission),
    std::pair("environment", Pass::environment),
    std::pair("diffuse_direct", Pass::diffuse_direct),
    std::pair("diffuse_indirect", Pass::diffuse_indirect),
    std::pair("diffuse_color", Pass::diffuse_color),
    std::pair("glossy_direct", Pass::glossy_direct),
    std::pair("glossy_indirect", Pass::glossy_indirect),
    std::pair("glossy_color", Pass::glossy_color),
    std::pair("transmission_direct", Pass::transmission_direct),
    std::pair("transmission_indirect", Pass::transmission_indirect),
    std::pair("transmission_color", Pass::transmission_color),
    std::pair("denoising_normal", Pass::denoising_normal),
    std::pair("denoising_albedo", Pass::denoising_albedo),
    std::pair("denoising_depth", Pass::denoising_depth),
    std::pair("cryptomatte_object", Pass::cryptomatte_object),
    std::pair("cryptomatte_material", Pass::cryptomatte_material),
    std::pair("cryptomatte_asset", Pass::cryptomatte_asset),
};

Pass pass_from(const py::handle& item) {
    if (!py::isinstance<py::str>(item)) {
        throw std::invalid_argument("passes must be a sequence of strings");
    }
    const auto name = item.cast<std::string>();
    const auto* known = std::find_if(kNames.begin(), kNames.end(), [&](const auto& own) { return own.first == name; });
    if (known == kNames.end()) {
        std::string all;
        for (const auto& own : kNames) {
            all += std::string(all.empty() ? "" : ", ") + own.first;
        }
        throw std::invalid_argument("passes: '" + name + "' is none of " + all);
    }
    return known->second;
}

std::string name_of(const RenderPass& pass, const SceneObject& scene) {
    if (pass.kind == Pass::light_group) {
        return "combined_" + (pass.number == 0 ? std::string() : scene.groups[pass.number - 1]);
    }
    if (pass.kind == Pass::aov_value || pass.kind == Pass::aov_color) {
        return "aov_" + scene.aovs[pass.number].first;
    }
    const auto* known =
        std::find_if(kNames.begin(), kNames.end(), [&](const auto& own) { return own.second == pass.kind; });
    return known->first;
}

/// Whether a pass grows with the light of the scene.
bool is_light(Pass kind) {
    constexpr std::array kLight = {
        Pass::emission,      Pass::environment,     Pass::diffuse_direct,      Pass::diffuse_indirect,
        Pass::glossy_direct, Pass::glossy_indirect, Pass::transmission_direct, Pass::transmission_indirect,
        Pass::light_group};
    return std::ranges::find(kLight, kind) != kLight.end();
}

}  // namespace

PassSettings pass_settings_from(const PassArguments& arguments) {
    PassSettings settings;
    if (py::isinstance<py::str>(arguments.passes) || !py::isinstance<py::iterable>(arguments.passes)) {
        throw std::invalid_argument("passes must be a sequence of strings");
    }
    for (const py::handle item : py::list(arguments.passes)) {
        settings.passes.push_back({pass_from(item)});
    }
    settings.alpha_threshold = real_from("alpha_threshold", arguments.alpha_threshold);
    settings.cryptomatte_levels = int_from("cryptomatte_levels", arguments.cryptomatte_levels);
    const AnyArray<double> mist = array_from<double>("mist", arguments.mist);
    if (mist.ndim() != 1 || mist.size() != 3) {
        throw std::invalid_argument("mist must be start, depth and falloff");
    }
    settings.mist = {mist.data()[0], mist.data()[1], mist.data()[2]};
    return settings;
}

void add_named_passes(const PassArguments& arguments, const SceneObject& scene, const CompiledScene& compiled,
                      PassSettings& settings) {
    if (flag_from("groups", arguments.groups)) {
        for (const std::uint32_t group : compiled.light_groups()) {
            settings.passes.push_back({Pass::light_group, group});
        }
    }
    if (flag_from("aovs", arguments.aovs)) {
        std::set<std::uint32_t> known;
        for (const Material& material : compiled.materials()) {
            known.insert(material.aovs.begin(), material.aovs.end());
        }
        for (const std::uint32_t number : known) {
            settings.passes.push_back({scene.aovs[number].second ? Pass::aov_color : Pass::aov_value, number});
        }
    }
}

void expose(py::array_t<float>& pixels, std::size_t first, std::size_t count, float factor) {
    if (factor == 1) {
        return;
    }
    const auto stride = static_cast<std::size_t>(pixels.shape(2));
    const std::span<float> all(pixels.mutable_data(), static_cast<std::size_t>(pixels.size()));
    for (std::size_t pixel = first; pixel < all.size(); pixel += stride) {
        for (float& value : all.subspan(pixel, count)) {
            value *= factor;
        }
    }
}

void expose_light(const PassSettings& settings, py::array_t<float>& values, float factor) {
    const PassLayout layout(settings);
    for (const PassLayout::Place& place : layout.places()) {
        if (is_light(place.pass.kind)) {
            expose(values, place.first, place.size, factor);
        }
    }
}

py::dict pass_dict(const PassSettings& settings, const SceneObject& scene, const py::array& image,
                   const py::array& values) {
    py::dict result;
    result["combined"] = image;
    const PassLayout layout(settings);
    for (const RenderPass& pass : settings.passes) {
        const PassLayout::Place& place = *layout.find(pass);
        const py::slice channels(static_cast<py::ssize_t>(place.first),
                                 static_cast<py::ssize_t>(place.first + place.size), 1);
        result[py::str(name_of(pass, scene))] = values[py::make_tuple(py::ellipsis(), channels)];
    }
    return result;
}

}  // namespace shlight::python
