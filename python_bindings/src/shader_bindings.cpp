// SPDX-License-Identifier: MIT
#include "shader_bindings.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>

#include "arguments.h"
#include "bindings.h"
#include "chunks.h"
#include "gil.h"
#include "shaders/image_texture.h"
#include "shaders/operations.h"
#include "shaders/script_kernel.h"
#include "whole_objects.h"

using namespace pybind11::literals;

namespace shlight::python {
namespace {

using ImagePointer = std::shared_ptr<const ImageTexture>;
using StepTuple = std::tuple<int, double, std::uint32_t, std::uint32_t, std::vector<std::uint32_t>>;
using TableTuple = std::tuple<AnyArray<float>, std::vector<std::uint32_t>>;
/// code, registers, number of arguments, and results
using ScriptTuple =
    std::tuple<AnyArray<std::uint32_t>, AnyArray<std::uint32_t>, std::uint32_t, std::vector<std::uint32_t>>;
using RefractionTuple =
    std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::optional<std::uint32_t>, bool, bool>;
/// Kind of lobe, or a Bsdf of one lobe, which brings its shape and ViewWeight; ior, result indices of weight, alpha and
/// normal, ShadedLobe::several_bounces, and ShadedSubsurface.
using LobeTuple = std::tuple<std::variant<std::string, Bsdf>, double, std::uint32_t, std::optional<std::uint32_t>,
                             std::optional<std::uint32_t>, bool, std::optional<std::pair<std::uint32_t, int>>,
                             std::optional<std::uint32_t>>;
/// name, number of the result, whether it is a colour
using AovTuple = std::tuple<std::string, std::uint32_t, bool>;

/// kind (0: constant, 1: input, 2: operation), constant, source or operation, index or parameter, and arguments; of an
/// input the component is the only argument.
ShaderStep step_from(const StepTuple& tuple) {
    const auto& [kind, constant, number, parameter, arguments] = tuple;
    ShaderStep step{};
    if (kind == 0) {
        step.kind = ShaderStep::Kind::constant;
        step.constant = static_cast<float>(constant);
    } else if (kind == 1) {
        if (number >= kShaderSources || arguments.size() != 1) {
            throw std::invalid_argument("steps: there is no input " + std::to_string(number));
        }
        step.kind = ShaderStep::Kind::input;
        step.input = {static_cast<ShaderSource>(number), parameter, arguments[0]};
    } else {
        step.kind = ShaderStep::Kind::operation;
        step.constant = static_cast<float>(constant);
        step.operation = number;
        step.parameter = parameter;
        step.arguments = arguments;
    }
    return step;
}

ShaderProgram program_from(const std::vector<StepTuple>& steps, const std::vector<TableTuple>& tables,
                           std::vector<ImagePointer> images, const std::vector<ScriptTuple>& scripts,
                           const std::vector<std::uint32_t>& results) {
    std::vector<ShaderStep> own_steps(steps.size());
    std::transform(steps.begin(), steps.end(), own_steps.begin(), step_from);
    std::vector<ShaderTable> own_tables;
    own_tables.reserve(tables.size());
    for (const auto& [numbers, sizes] : tables) {
        const auto all = values(numbers);
        own_tables.push_back({{all.begin(), all.end()}, sizes});
    }
    std::vector<ShaderScript> own_scripts;
    own_scripts.reserve(scripts.size());
    for (const auto& [code, registers, arguments, own_results] : scripts) {
        const auto words = values(code), at_first = values(registers);
        own_scripts.push_back(
            {{words.begin(), words.end()}, {at_first.begin(), at_first.end()}, arguments, own_results});
    }
    return {std::move(own_steps), std::move(own_tables), std::move(images), std::move(own_scripts), results};
}

/// Reads inputs from arrays (places, lanes), so that a program can be run without a scene.
class ArrayReader : public ShaderReader {
  public:
    using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;

    /// The program's first lane is lane `begin` of the arrays, which have `count`. Places near by are the neighbours.
    ArrayReader(const std::vector<std::pair<Key, AnyArray<float>>>& inputs, std::size_t count, std::size_t begin)
        : inputs_(&inputs), count_(count), begin_(begin) {}

    void read(const ShaderInput& input, int place, std::size_t first, std::span<float> out) const override {
        const Key key = {static_cast<std::uint32_t>(input.source), input.index, input.component};
        const auto found =
            std::find_if(inputs_->begin(), inputs_->end(), [&](const auto& own) { return own.first == key; });
        const float* from = found == inputs_->end() ? nullptr : found->second.data();
        for (std::size_t i = 0; i < out.size(); ++i) {
            const auto row = static_cast<std::size_t>(place < 3 ? place : place - 2);
            out[i] = from == nullptr ? 0.0F : from[row * count_ + begin_ + first + i];
        }
    }

  private:
    const std::vector<std::pair<Key, AnyArray<float>>>* inputs_;
    std::size_t count_, begin_;
};

Array<float> evaluate(const ShaderProgram& program,
                      const std::vector<std::pair<ArrayReader::Key, AnyArray<float>>>& inputs, std::size_t count) {
    for (const auto& [key, array] : inputs) {
        if (static_cast<std::size_t>(array.size()) != 3 * count) {
            throw std::invalid_argument("inputs must have shape (3, count)");
        }
    }
    Array<float> out({static_cast<py::ssize_t>(program.result_count()), static_cast<py::ssize_t>(count)});
    const std::span<float> results(out.mutable_data(), static_cast<std::size_t>(out.size()));
    const GilReleased release;
    const std::size_t chunk = chunk_of(count);
    parallel_for((count + chunk - 1) / chunk, 0, [&](std::size_t number) {
        const std::size_t begin = number * chunk, lanes = std::min(chunk, count - begin);
        ShaderProgram::Registers registers;
        std::vector<float> own(program.result_count() * lanes);
        program.evaluate(ArrayReader(inputs, count, begin), lanes, true, registers, own);
        for (std::size_t r = 0; r < program.result_count(); ++r) {
            std::copy_n(own.data() + r * lanes, lanes, results.data() + r * count + begin);
        }
    });
    return out;
}

/// The microfacets of a kind, as "beckmann_schlick"; those without a Fresnel factor have the distribution's name alone.
/// "stretched_" before it: those of two widths.
std::optional<GgxShape> microfacets_of(std::string_view kind, double ior) {
    constexpr std::string_view kStretched = "stretched_";
    const double across = kind.starts_with(kStretched) ? 1 : 0;
    kind.remove_prefix(across != 0 ? kStretched.size() : 0);
    constexpr std::array<std::pair<std::string_view, Microfacets>, 3> kDistributions = {
        {{"ggx", Microfacets::ggx},
         {"beckmann", Microfacets::beckmann},
         {"ashikhmin_shirley", Microfacets::ashikhmin_shirley}}};
    constexpr std::array<std::pair<std::string_view, Fresnel>, 8> kFactors = {{{"", Fresnel::one},
                                                                               {"_schlick", Fresnel::schlick},
                                                                               {"_dielectric", Fresnel::dielectric},
                                                                               {"_dip", Fresnel::dip},
                                                                               {"_wide_dip", Fresnel::wide_dip},
                                                                               {"_narrow_dip", Fresnel::narrow_dip},
                                                                               {"_broad_dip", Fresnel::broad_dip},
                                                                               {"_linear", Fresnel::linear}}};
    for (const auto& [name, distribution] : kDistributions) {
        if (kind.starts_with(name)) {
            for (const auto& [factor, fresnel] : kFactors) {
                if (kind.substr(name.size()) == factor) {
                    return GgxShape{1, fresnel, ior, distribution, across};
                }
            }
        }
    }
    return std::nullopt;
}

LobeShape shape_of(const std::string& kind, double ior) {
    if (kind == "lambert" || kind == "translucent") {
        return LambertShape{};
    }
    static const std::array<std::pair<std::string_view, LobeShape>, 9> kDiffuse = {
        {{"oren_nayar", DiffuseShape{Diffuse::oren_nayar}},
         {"oren_nayar_loss", DiffuseShape{Diffuse::oren_nayar_loss}},
         {"bumped_lambert_ggx", DiffuseShape{Diffuse::bumped_ggx}},
         {"bumped_lambert_cubic", DiffuseShape{Diffuse::bumped_cubic}},
         {"disney", kDisneyDiffuse},
         {"disney_retro", kDisneyRetro},
         {"disney_retro_square", kDisneyRetroSquare},
         {"disney_entry", kDisneyEntry},
         {"disney_sheen", kDisneySheen}}};
    for (const auto& [name, shape] : kDiffuse) {
        if (kind == name) {
            return shape;
        }
    }
    if (kind == "toon" || kind == "glossy_toon") {
        return ToonShape{kind != "toon"};
    }
    if (const auto microfacets = microfacets_of(kind, ior)) {
        return *microfacets;
    }
    throw std::invalid_argument("lobes: there is no kind '" + kind + "'");
}

ShaderObject shader_from(const ShaderProgram& program, const std::vector<LobeTuple>& lobes,
                         std::optional<std::uint32_t> emission, std::optional<std::uint32_t> transparency,
                         const ShaderProgram& shadow_program, std::vector<std::string> attribute_names,
                         const std::vector<AovTuple>& aovs, const std::vector<RefractionTuple>& refractions,
                         bool blocks_shadow_rays, const std::array<float, 3>& absorption) {
    auto shader = std::make_shared<SurfaceShader>(SurfaceShader{program,
                                                                {},
                                                                emission,
                                                                transparency,
                                                                shadow_program,
                                                                {},
                                                                {},
                                                                blocks_shadow_rays,
                                                                Rgb(absorption[0], absorption[1], absorption[2])});
    for (const auto& [kind, ior, weight, alpha, normal, several_bounces, numbers, leans_from] : lobes) {
        std::optional<ShadedSubsurface> below;
        if (numbers) {
            below = {numbers->first, static_cast<SubsurfaceEntry>(numbers->second)};
        }
        if (const auto* bsdf = std::get_if<Bsdf>(&kind)) {
            const Lobe& own = bsdf->lobes().at(0);
            shader->lobes.push_back(
                {own.shape, weight, {}, normal, false, false, own.weight, own.only_order, {}, below});
        } else {
            const auto& name = std::get<std::string>(kind);
            shader->lobes.push_back({shape_of(name, ior), weight, alpha, normal, several_bounces, name == "translucent",
                                     nullptr, 0, leans_from, below});
        }
    }
    std::vector<std::string> aov_names;
    for (const auto& [name, value, is_color] : aovs) {
        shader->aovs.push_back({value, is_color});
        aov_names.push_back(name);
    }
    for (const auto& [weight, alpha, ior, normal, reflects, is_beckmann] : refractions) {
        shader->refractions.push_back(
            {weight, alpha, ior, normal, reflects, is_beckmann ? Microfacets::beckmann : Microfacets::ggx});
    }
    check_surface_shader(*shader);
    return {std::move(shader), std::move(attribute_names), std::move(aov_names)};
}

/// uint8 or float; (height, width, channels), row 0 at v = 0.
/// Precondition: a contiguous array of this type.
template <class Number>
std::vector<Number> numbers_of(const py::array& pixels) {
    const auto* first = static_cast<const Number*>(pixels.data());
    return {first, first + pixels.size()};
}

std::shared_ptr<TexturePixels> pixels_from(const py::array& pixels, int encoding, int interpolation, int extension) {
    if (pixels.ndim() != 3 || pixels.size() == 0 ||
        (pixels.shape(2) != 1 && pixels.shape(2) != 3 && pixels.shape(2) != 4)) {
        throw std::invalid_argument("pixels must have shape (height, width, channels) with 1, 3 or 4 channels");
    }
    const auto height = static_cast<std::uint32_t>(pixels.shape(0));
    const auto width = static_cast<std::uint32_t>(pixels.shape(1));
    const auto channels = static_cast<int>(pixels.shape(2));
    TexelNumbers values;
    const char kind = pixels.dtype().kind();
    const py::ssize_t width_of_number = pixels.itemsize();
    if (kind == 'u' && width_of_number == 1) {
        values = numbers_of<std::uint8_t>(pixels);
    } else if (kind == 'u' && width_of_number == 2) {
        values = numbers_of<std::uint16_t>(pixels);
    } else if (kind == 'f' && width_of_number == 2) {
        values = numbers_of<Half>(pixels);
    } else {
        const AnyArray<float> floats = array_from<float>("pixels", pixels);
        values = std::vector<float>(floats.data(), floats.data() + floats.size());
    }
    const GilReleased release;
    return std::make_shared<TexturePixels>(
        std::move(values), width, height, channels, static_cast<TexelEncoding>(encoding),
        static_cast<TextureInterpolation>(interpolation), static_cast<TextureExtension>(extension));
}

/// tiles: a list of (u, v, pixels).
std::shared_ptr<ImageTexture> image_from(
    const std::vector<std::tuple<std::int64_t, std::int64_t, std::shared_ptr<TexturePixels>>>& tiles, int interpolation,
    int extension, bool unassociate, bool tiled) {
    std::vector<ImageTexture::Tile> own;
    own.reserve(tiles.size());
    for (const auto& [u, v, pixels] : tiles) {
        own.push_back({u, v, pixels});
    }
    if (own.empty()) {
        throw std::invalid_argument("tiles must hold a picture");
    }
    return std::make_shared<ImageTexture>(std::move(own), static_cast<TextureInterpolation>(interpolation),
                                          static_cast<TextureExtension>(extension), unassociate, tiled);
}

}  // namespace

void bind_shader(py::module_& m) {
    m.def("shader_operations", [] {
        std::vector<std::tuple<std::string, std::size_t, std::size_t>> list;
        for (const ShaderOperation& operation : shader_operations()) {
            list.emplace_back(operation.name, operation.argument_count, operation.result_count);
        }
        return list;
    });
    m.def("script_instructions", [] {
        const auto names = script_instructions();
        return std::vector<std::string>(names.begin(), names.end());
    });
    py::class_<ImageTexture, std::shared_ptr<ImageTexture>>(m, "ImageTexture", without_constructor())
        .def_property_readonly(
            "size", [](const ImageTexture& self) { return std::pair(self.pixels().width(), self.pixels().height()); },
            "Width and height in texels.")
        .def("sample", [](const ImageTexture& self, float u, float v, std::array<float, 4> footprint) {
            const glm::vec4 color = self.sample({u, v}, {{footprint[0], footprint[1]}, {footprint[2], footprint[3]}});
            return std::array{color.x, color.y, color.z, color.w};
        });
    py::class_<TexturePixels, std::shared_ptr<TexturePixels>>(m, "TexturePixels", without_constructor())
        .def_property_readonly("size_in_bytes", &TexturePixels::size_in_bytes);
    m.def("texture_pixels", &pixels_from, "pixels"_a, "encoding"_a, "interpolation"_a, "extension"_a);
    m.def("image_texture", &image_from, "tiles"_a, "interpolation"_a, "extension"_a, "unassociate"_a, "tiled"_a);
    py::class_<ShaderProgram>(m, "ShaderProgram", without_constructor())
        .def("evaluate", &evaluate, "inputs"_a, "count"_a)
        .def_property_readonly("operation_count", &ShaderProgram::operation_count);
    m.def(
        "shader_program",
        [](const std::vector<StepTuple>& steps, const std::vector<TableTuple>& tables,
           const std::vector<std::shared_ptr<ImageTexture>>& images, const std::vector<ScriptTuple>& scripts,
           const std::vector<std::uint32_t>& results) {
            return program_from(steps, tables, {images.begin(), images.end()}, scripts, results);
        },
        "steps"_a, "tables"_a, "images"_a, "scripts"_a, "results"_a);
    const py::class_<ShaderObject> shader(m, "SurfaceShader", without_constructor());
    m.def("surface_shader", &shader_from, "program"_a, "lobes"_a, "emission"_a, "transparency"_a, "shadow_program"_a,
          "attribute_names"_a, "aovs"_a, "refractions"_a, "blocks_shadow_rays"_a, "absorption"_a);
}

}  // namespace shlight::python
