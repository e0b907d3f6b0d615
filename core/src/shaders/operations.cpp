// SPDX-License-Identifier: MIT
#include "shaders/operations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "shaders/gabor_kernel.h"
#include "shaders/gradient_noise.h"
#include "shaders/hash_kernel.h"
#include "shaders/image_texture.h"
#include "shaders/script_kernel.h"
#include "shaders/thin_film.h"
#include "shaders/voronoi_kernel.h"

namespace shlight {
namespace {

using Parameter = ShaderOperation::Parameter;

/// Applies a function of floats to each lane.
template <auto kFunction, std::size_t... kArgument>
void apply(const OperationLanes& lanes, std::index_sequence<kArgument...>) {
    float* out = lanes.results[0];
    for (std::size_t i = 0; i < lanes.count; ++i) {
        out[i] = kFunction(lanes.arguments[kArgument][i]...);
    }
}

template <auto kFunction, std::size_t kArguments>
void each(const OperationLanes& lanes) {
    apply<kFunction>(lanes, std::make_index_sequence<kArguments>());
}

float arctangent2(float y, float x) {
    return x == 0 && y == 0 ? 0.0F : std::atan2(y, x);
}

/// base^exponent, or 0 where that is not real.
float power(float base, float exponent) {
    return base < 0 && exponent != std::trunc(exponent) ? 0.0F : std::pow(base, exponent);
}

/// Maximum and minimum in which a number wins over NaN, as opposed to std::max. Inlined, so that loops vectorise.
float larger(float a, float b) {
    return a > b || std::isnan(b) ? a : b;
}
float smaller(float a, float b) {
    return a < b || std::isnan(b) ? a : b;
}

/// A number 0 … 1 of a brick by a polynomial of its row and its place in it, as integers that wrap around.
float brick_noise(float row, float brick) {
    const auto integer = [](float x) {
        return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::clamp(larger(x, -2e9F), -2e9F, 2e9F)));
    };
    std::uint32_t n = (integer(row) << 16U) + (integer(brick) & 0xFFFFU);
    n = (n + 1013) & 0x7FFFFFFFU;
    n ^= n >> 13U;
    const std::uint32_t mixed = n * (n * n * 60493 + 19990303) + 1376312589;
    return static_cast<float>(mixed & 0x7FFFFFFFU) * 0x1p-31F;
}

/// The table entries around a coordinate 0 … 1, and the weight of the second.
struct Interval {
    std::size_t low, high;
    float share;

    Interval(float coordinate, std::uint32_t size) {
        // A NaN is clamped to 0.
        const float place = std::min(std::max(0.0F, coordinate), 1.0F) * static_cast<float>(size - 1);
        low = static_cast<std::size_t>(place);
        high = std::min(low + 1, std::size_t{size} - 1);
        share = place - static_cast<float>(low);
    }
    float between(float a, float b) const { return share == 0 ? a : (1 - share) * a + share * b; }
};

float read_table(const ShaderTable& table, const std::array<float, 3>& place, std::size_t dimension,
                 std::size_t offset) {
    const Interval interval(place[dimension], table.sizes[dimension]);
    if (dimension == 0) {
        return interval.between(table.values[offset + interval.low], table.values[offset + interval.high]);
    }
    std::size_t stride = 1;
    for (std::size_t i = 0; i < dimension; ++i) {
        stride *= table.sizes[i];
    }
    return interval.between(read_table(table, place, dimension - 1, offset + interval.low * stride),
                            read_table(table, place, dimension - 1, offset + interval.high * stride));
}

template <std::size_t kDimensions>
void look_up(const OperationLanes& lanes) {
    for (std::size_t i = 0; i < lanes.count; ++i) {
        std::array<float, 3> place{};
        for (std::size_t k = 0; k < kDimensions; ++k) {
            place[k] = lanes.arguments[k][i];
        }
        lanes.results[0][i] = read_table(*lanes.table, place, kDimensions - 1, 0);
    }
}

void sample_image(const OperationLanes& lanes) {
    const float* const* a = lanes.arguments;
    // Look-ups are prepared 16 lanes ahead, so that their texels arrive from memory while others are read.
    std::array<ImageTexture::Lookup, 16> lookups{};
    for (std::size_t i = 0; i < lanes.count + lookups.size(); ++i) {
        ImageTexture::Lookup& lookup = lookups[i % lookups.size()];
        if (i >= lookups.size()) {
            const glm::vec4 color = lanes.image->read(lookup);
            for (int channel = 0; channel < 4; ++channel) {
                lanes.results[channel][i - lookups.size()] = color[channel];
            }
        }
        if (i < lanes.count) {
            lookup = lanes.image->look({a[0][i], a[1][i]}, {{a[2][i], a[3][i]}, {a[4][i], a[5][i]}});
        }
    }
}

struct Operation {
    ShaderOperation about;
    OperationLoop loop;
};

template <std::size_t kArguments, auto kFunction>
constexpr Operation elementwise(std::string_view name) {
    return {{name, kArguments, 1, Parameter::none}, &each<kFunction, kArguments>};
}

constexpr std::array kOperations = {
    Operation{{"right", 1, 1, Parameter::none}, nullptr},
    Operation{{"below", 1, 1, Parameter::none}, nullptr},
    Operation{{"near_x", 1, 1, Parameter::none}, nullptr},
    Operation{{"near_y", 1, 1, Parameter::none}, nullptr},
    elementwise<2, [](float a, float b) { return a + b; }>("add"),
    elementwise<2, [](float a, float b) { return a - b; }>("subtract"),
    elementwise<2, [](float a, float b) { return a * b; }>("multiply"),
    elementwise<2, [](float a, float b) { return b != 0 ? a / b : 0.0F; }>("divide"),
    elementwise<2, power>("power"),
    elementwise<1, [](float a) { return 0 < a ? std::log(a) : 0.0F; }>("log"),
    elementwise<1, [](float a) { return std::exp(a); }>("exp"),
    elementwise<1, [](float a) { return std::sqrt(larger(a, 0.0F)); }>("sqrt"),
    elementwise<1, [](float a) { return std::abs(a); }>("absolute"),
    elementwise<2, smaller>("minimum"),
    elementwise<2, larger>("maximum"),
    elementwise<2, [](float a, float b) { return a < b ? 1.0F : 0.0F; }>("less"),
    elementwise<2, [](float a, float b) { return a == b ? 1.0F : 0.0F; }>("equal"),
    elementwise<3, [](float a, float b, float c) { return a != 0 ? b : c; }>("select"),
    elementwise<1, [](float a) { return std::floor(a); }>("floor"),
    elementwise<2, [](float a, float b) { return b != 0 ? std::fmod(a, b) : 0.0F; }>("modulo"),
    elementwise<1, [](float a) { return std::sin(a); }>("sine"),
    elementwise<1, [](float a) { return std::cos(a); }>("cosine"),
    elementwise<1, [](float a) { return std::tan(a); }>("tangent"),
    elementwise<1, [](float a) { return std::asin(std::clamp(a, -1.0F, 1.0F)); }>("arcsine"),
    elementwise<1, [](float a) { return std::acos(std::clamp(a, -1.0F, 1.0F)); }>("arccosine"),
    elementwise<1, [](float a) { return std::atan(a); }>("arctangent"),
    elementwise<2, arctangent2>("arctangent2"),
    elementwise<1, [](float a) { return std::sinh(a); }>("sinh"),
    elementwise<1, [](float a) { return std::cosh(a); }>("cosh"),
    elementwise<1, [](float a) { return std::tanh(a); }>("tanh"),
    Operation{{"hash1", 1, 1, Parameter::none}, &hash<1>},
    Operation{{"hash2", 2, 1, Parameter::none}, &hash<2>},
    Operation{{"hash3", 3, 1, Parameter::none}, &hash<3>},
    Operation{{"hash4", 4, 1, Parameter::none}, &hash<4>},
    elementwise<2, brick_noise>("brick_noise"),
    Operation{{"table1", 1, 1, Parameter::table}, &look_up<1>},
    Operation{{"table2", 2, 1, Parameter::table}, &look_up<2>},
    Operation{{"table3", 3, 1, Parameter::table}, &look_up<3>},
    Operation{{"image", 6, 4, Parameter::image}, &sample_image},
    Operation{{"gabor2", 5, 2, Parameter::none}, &gabor<2>},
    Operation{{"gabor3", 7, 2, Parameter::none}, &gabor<3>},
    Operation{{"voronoi1", 7, 5, Parameter::mode, kVoronoiModes}, &voronoi<1>},
    Operation{{"voronoi2", 8, 6, Parameter::mode, kVoronoiModes}, &voronoi<2>},
    Operation{{"voronoi3", 9, 7, Parameter::mode, kVoronoiModes}, &voronoi<3>},
    Operation{{"voronoi4", 10, 8, Parameter::mode, kVoronoiModes}, &voronoi<4>},
    Operation{{"noise1", 10, 1, Parameter::mode, kFractals}, &noise<1>},
    Operation{{"noise2", 12, 1, Parameter::mode, kFractals}, &noise<2>},
    Operation{{"noise3", 14, 1, Parameter::mode, kFractals}, &noise<3>},
    Operation{{"noise4", 16, 1, Parameter::mode, kFractals}, &noise<4>},
    Operation{{"footprint1", 2, 3, Parameter::none}, &footprint<1>},
    Operation{{"footprint2", 4, 4, Parameter::none}, &footprint<2>},
    Operation{{"footprint3", 6, 5, Parameter::none}, &footprint<3>},
    Operation{{"footprint4", 8, 6, Parameter::none}, &footprint<4>},
    Operation{{"thin_film", kFilmArguments, kFilmResults, Parameter::rows, kFilmRows}, &thin_film},
    Operation{{"script", 0, 0, Parameter::script}, &run_script},
};

}  // namespace

std::span<const ShaderOperation> shader_operations() {
    static const auto all = [] {
        std::array<ShaderOperation, kOperations.size()> list{};
        std::transform(kOperations.begin(), kOperations.end(), list.begin(),
                       [](const Operation& o) { return o.about; });
        return list;
    }();
    return all;
}

std::span<const OperationLoop> operation_loops() {
    static const auto all = [] {
        std::array<OperationLoop, kOperations.size()> list{};
        std::transform(kOperations.begin(), kOperations.end(), list.begin(), [](const Operation& o) { return o.loop; });
        return list;
    }();
    return all;
}

}  // namespace shlight
