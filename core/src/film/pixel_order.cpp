// SPDX-License-Identifier: MIT
#include "film/pixel_order.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

namespace shlight {
namespace {

/// Edge of the tiles of the first pass.
constexpr int kLargestTile = 32;

/// Edge of the blocks of pixels of later passes.
constexpr int kBlock = 16;

/// A round takes the blocks that gain most for their rays: those of this share of all that there is to gain, but no
/// fewer than so many rays, or this share of those wanted.
constexpr double kUrgentGain = 0.75;
constexpr double kLeastRays = 1 << 17;
constexpr double kUrgentRays = 0.999;

/// Pixels of a group that lie together.
struct Block {
    std::size_t group = 0;
    double gain = 0;
    double rays = 0;
    std::vector<Pixel> pixels;
};

/// Adds the blocks of a group, whose pixels are sorted by rows.
void add_blocks(const RefinementGroup& group, std::size_t number, std::vector<Block>& blocks) {
    std::map<std::pair<int, int>, std::size_t> places;
    std::pair<int, int> last = {-1, -1};
    Block* block = nullptr;
    for (std::size_t i = 0; i < group.pixels.size(); ++i) {
        const Pixel& pixel = group.pixels[i];
        const std::pair place(pixel.row / kBlock, pixel.column / kBlock);
        if (place != last) {
            const auto [known, is_missing] = places.try_emplace(place, blocks.size());
            if (is_missing) {
                blocks.push_back({number, 0, 0, {}});
            }
            block = &blocks[known->second];
            last = place;
        }
        block->gain += group.gains[i];
        block->rays += group.rays;
        block->pixels.push_back(pixel);
    }
}

int tile_edge(std::uint32_t pixel_samples, std::uint32_t batch_samples) {
    int edge = kLargestTile;
    while (edge > 1 && std::int64_t{edge} * edge * pixel_samples > batch_samples) {
        edge /= 2;
    }
    return edge;
}

}  // namespace

std::vector<Tile> tiles_of(int width, int height, const Grid& grid, std::uint32_t pixel_samples,
                           std::uint32_t batch_samples) {
    const int edge = grid.step * tile_edge(pixel_samples, batch_samples);
    std::vector<Tile> tiles;
    for (int top = 0; top < height; top += edge) {
        for (int left = 0; left < width; left += edge) {
            tiles.push_back({left, top, std::min(left + edge, width), std::min(top + edge, height)});
        }
    }
    return tiles;
}

std::vector<Pixel> pixels_of(const Tile& tile, const Grid& grid) {
    std::vector<Pixel> pixels;
    for (int row = tile.top; row < tile.bottom; row += grid.step) {
        for (int column = tile.left; column < tile.right; column += grid.step) {
            if (grid.wider == 0 || (row | column) % grid.wider != 0) {
                pixels.push_back({column, row});
            }
        }
    }
    return pixels;
}

std::vector<RefinementGroup> most_urgent(std::span<const RefinementGroup> groups) {
    std::vector<Block> all;
    for (std::size_t group = 0; group < groups.size(); ++group) {
        add_blocks(groups[group], group, all);
    }
    std::vector<const Block*> blocks;
    double gain = 0;
    double rays = 0;
    for (const Block& block : all) {
        blocks.push_back(&block);
        gain += block.gain;
        rays += block.rays;
    }
    std::stable_sort(blocks.begin(), blocks.end(),
                     [](const Block* a, const Block* b) { return a->gain * b->rays > b->gain * a->rays; });
    std::vector<RefinementGroup> urgent;
    for (const RefinementGroup& group : groups) {
        urgent.push_back({group.from, group.to, group.rays, {}, {}});
    }
    double gained = 0;
    double taken = 0;
    for (const Block* block : blocks) {
        if (gained > kUrgentGain * gain && taken > std::min(kLeastRays, kUrgentRays * rays)) break;
        std::vector<Pixel>& pixels = urgent[block->group].pixels;
        pixels.insert(pixels.end(), block->pixels.begin(), block->pixels.end());
        gained += block->gain;
        taken += block->rays;
    }
    std::erase_if(urgent, [](const RefinementGroup& group) { return group.pixels.empty(); });
    return urgent;
}

GridPlace::GridPlace(const Pixel& pixel, int step, int width, int height) {
    const auto index = [width](int column, int row) {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
    };
    const auto on_grid = [step](int i, int size) { return std::min(i, (size - 1) / step * step); };
    const int left = pixel.column / step * step;
    const int top = pixel.row / step * step;
    const int right = on_grid(left + step, width);
    const int bottom = on_grid(top + step, height);
    pixel_ = index(pixel.column, pixel.row);
    corners_ = {index(left, top), index(right, top), index(left, bottom), index(right, bottom)};
    across_ = static_cast<float>(pixel.column - left) / static_cast<float>(step);
    down_ = static_cast<float>(pixel.row - top) / static_cast<float>(step);
}

void GridPlace::fill(std::size_t channels, std::size_t first, std::size_t count, std::span<float> image) const {
    for (std::size_t i = first; i < first + count; ++i) {
        image[pixel_ * channels + i] = between([&](std::size_t corner) { return image[corner * channels + i]; });
    }
}

void fill_between(int step, int width, int height, int threads, std::span<const float> base, std::span<float> image) {
    const auto at = [](std::span<const float> pixels, std::size_t i) { return pixels.empty() ? 0.0F : pixels[i]; };
    parallel_for(static_cast<std::size_t>(height), threads, [&](std::size_t row) {
        for (int column = 0; column < width; ++column) {
            const GridPlace place({column, static_cast<int>(row)}, step, width, height);
            for (std::size_t i = 0; i < 4 && !place.is_on_grid(); ++i) {
                const float beyond =
                    place.between([&](std::size_t corner) { return image[4 * corner + i] - at(base, 4 * corner + i); });
                const std::size_t own = 4 * place.pixel() + i;
                image[own] = std::max(at(base, own) + beyond, 0.0F);
            }
        }
    });
}

}  // namespace shlight
