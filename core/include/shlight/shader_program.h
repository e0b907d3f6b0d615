// SPDX-License-Identifier: MIT
//
// Shader programs: numbers that vary over a surface, as a list of float operations that run over many hits at once.
//
// A program is straight-line code over values. Each step reads values of earlier steps and makes one or more new ones;
// vectors and colours are three values. A value may be known at three places: at the hit, and where the camera rays of
// the neighbouring pixels, to the right and below, would meet the plane of the surface. Differences of these are what
// textures are filtered by, and what a bump map takes for a slope. Only what a difference is taken of is found three
// times.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace shlight {

class ImageTexture;

/// What a program can read at a hit. Vectors are in world coordinates and turned to the viewer where they are normals.
enum class ShaderSource : std::uint8_t {
    position,          ///< 3 components
    normal,            ///< 3: the smooth normal
    geometric_normal,  ///< 3
    towards_viewer,    ///< 3: unit
    attribute,  ///< 4: the mesh attribute that the material binds to `index` as RGBA, and the mean of RGB; black if
                ///< there is none
    object_to_world,   ///< 12: the first three rows of the instance's matrix
    world_to_object,   ///< 12
    object_value,      ///< 1: number `index` of the instance; 0 if there is none
    barycentric,       ///< 2: u and v of RayHit
    backfacing,        ///< 1: 1 where the triangle's corners run clockwise, else 0
    ray_length,        ///< 1: from where the ray begins, of a camera ray its near plane
    transparent_depth  ///< 1: surfaces that the ray has passed through
};
inline constexpr int kShaderSources = 12;
/// Component of an attribute: the mean of its RGB, and of one number that number.
inline constexpr std::uint32_t kAttributeMean = 4;

struct ShaderInput {
    ShaderSource source;
    std::uint32_t index = 0, component = 0;

    bool operator==(const ShaderInput&) const = default;
};

/// An operation on floats. Those that are undefined at some arguments say what they make of them.
struct ShaderOperation {
    std::string_view name;
    std::size_t argument_count = 0, result_count = 0;
    /// Whether the step's `parameter` numbers a table, or an image; otherwise it must be 0.
    enum class Parameter : std::uint8_t { none, table, image } parameter{};
};

/// All operations but constants and inputs, which have no arguments. A step refers to its operation by number.
std::span<const ShaderOperation> shader_operations();

/// Reads tables by linear interpolation between even steps of 0 … 1, clamped.
struct ShaderTable {
    std::vector<float> values;         ///< the first coordinate runs fastest
    std::vector<std::uint32_t> sizes;  ///< of each of 1 … 3 coordinates, ≥ 1
};

struct ShaderStep {
    enum class Kind : std::uint8_t { constant, input, operation } kind;
    float constant = 0;
    ShaderInput input{};
    std::uint32_t operation = 0, parameter = 0;
    std::vector<std::uint32_t> arguments;  ///< values of earlier steps
};

/// Where a program's inputs come from.
class ShaderReader {
  public:
    ShaderReader() = default;
    ShaderReader(const ShaderReader&) = delete;
    ShaderReader& operator=(const ShaderReader&) = delete;
    virtual ~ShaderReader() = default;
    /// Of lanes first … first + out.size() - 1. place: 0 at the hit, 1 at the neighbour to the right, 2 at that below.
    virtual void read(const ShaderInput& input, int place, std::size_t first, std::span<float> out) const = 0;
};

/// Immutable; any number of threads may run it.
class ShaderProgram {
  public:
    /// results: values that evaluate() returns. Throws std::invalid_argument for steps that do not fit each other.
    ShaderProgram(std::vector<ShaderStep> steps, std::vector<ShaderTable> tables,
                  std::vector<std::shared_ptr<const ImageTexture>> images, const std::vector<std::uint32_t>& results);

    std::size_t result_count() const { return results_.size(); }
    /// How many operations a hit takes.
    std::size_t operation_count() const { return operations_; }
    /// Whether it takes differences between neighbours.
    bool takes_differences() const { return takes_differences_; }

    /// Memory of evaluate(), kept from call to call.
    using Registers = std::vector<float>;
    /// results[r · count + lane]. neighbours: or else all differences are 0.
    void evaluate(const ShaderReader& reader, std::size_t count, bool neighbours, Registers& registers,
                  std::span<float> results) const;

  private:
    struct Value {
        std::uint32_t slot = 0;
        bool everywhere = false;  // at all three places
    };

    void check(const std::vector<std::uint32_t>& results);
    void find_places();
    void assign_slots(const std::vector<std::uint32_t>& results);
    void run(const ShaderStep& step, std::uint32_t first_value, const ShaderReader& reader, std::size_t first,
             std::size_t count, bool neighbours, float* registers) const;

    std::vector<ShaderStep> steps_;
    std::vector<ShaderTable> tables_;
    std::vector<std::shared_ptr<const ImageTexture>> images_;
    std::vector<std::uint32_t> first_value_;  // of each step
    std::vector<Value> values_;
    std::vector<std::uint32_t> results_;
    std::size_t slots_ = 0, operations_ = 0;
    bool takes_differences_ = false;
};

}  // namespace shlight
