// SPDX-License-Identifier: MIT
#include "textures.h"

#include "invariants.h"

namespace shlight::fuzzing {
namespace {

/// A coordinate in the picture, next to it, or anywhere.
float coordinate(Input& input) {
    if (input.rarely()) {
        return static_cast<float>(input.broken());
    }
    return input.chance() ? static_cast<float>(input.uniform(-1, 2)) : input.number<float>();
}

/// The least and the largest number of a picture and of what lies beyond it.
std::pair<float, float> range(const Texels& texels) {
    std::pair<float, float> found(0, 1);
    for (std::int64_t i = 0; i < texels.width * texels.height; ++i) {
        const glm::vec4 texel = texels(i % texels.width, i / texels.width);
        found.first = std::min({found.first, texel.x, texel.y, texel.z, texel.w});
        found.second = std::max({found.second, texel.x, texel.y, texel.z, texel.w});
    }
    return found;
}

/// Means of texels lie between them; levels of bytes are stored as halves.
void check_between(const glm::vec4& color, const std::pair<float, float>& range) {
    const auto [least, largest] = range;
    const double slack = 1e-3 * static_cast<double>(std::max(largest, -least));
    for (int i = 0; i < 4; ++i) {
        const auto number = static_cast<double>(color[i]);
        check_most("a texture's number is larger than all texels", number, static_cast<double>(largest) + slack);
        check_most("a texture's number is smaller than all texels", -number, slack - static_cast<double>(least));
    }
}

}  // namespace
}  // namespace shlight::fuzzing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace shlight::fuzzing;
    Input input(data, size);
    const bool unassociate = input.chance();
    const shlight::ImageTexture texture = draw_texture(input, unassociate);
    const auto numbers = range(texture.pixels().linear(0));
    for (int i = 0; i < 4; ++i) {
        const glm::vec2 place(coordinate(input), coordinate(input));
        shlight::TextureFootprint footprint;
        if (input.chance()) {
            footprint = {{coordinate(input), coordinate(input)}, {coordinate(input), coordinate(input)}};
        }
        const auto lookup = texture.look(place, footprint);
        const glm::vec4 color = texture.read(lookup);
        // Colours divided by alpha may be anything.
        if (!unassociate && (lookup.pixels == nullptr || lookup.pixels == &texture.pixels())) {
            check_between(color, numbers);
        }
    }
    return 0;
}
