// SPDX-License-Identifier: MIT
//
// Shader programs: numbers that vary over a surface, computed by a list of float operations for many hits at once.
//
// A program is straight-line code. Each step reads values of earlier steps and makes one or more values; vectors and
// colours are three values. A value may be needed at other places than the hit: where camera rays to the right and
// below would meet the plane of the surface, which filters textures, and at two places near the hit in that plane, at
// right angles, which give bump maps their slope. Only values of which such a difference is taken are computed there.
// A step may run a script, which has loops.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace shlight {

class ImageTexture;

/// The inputs of a program at a hit. Vectors are in world coordinates, and normals are turned to the viewer.
enum class ShaderSource : std::uint8_t {
    position,          ///< 3 components
    normal,            ///< 3: the interpolated normal
    geometric_normal,  ///< 3
    towards_viewer,    ///< 3: unit
    attribute,  ///< 4: the mesh attribute that the material binds to `index` as RGBA, and the mean of RGB; black if
                ///< there is none
    object_to_world,    ///< 12: the first three rows of the instance's matrix
    world_to_object,    ///< 12
    object_value,       ///< 1: number `index` of the instance; 0 if there is none
    barycentric,        ///< 2: u and v of RayHit
    backfacing,         ///< 1: 1 where the triangle's corners run clockwise, else 0
    ray_length,         ///< 1: length of the ray; camera rays start at the near plane
    transparent_depth,  ///< 1: surfaces that the ray has passed through
    height,             ///< 3: of the triangle's corners above the edges opposite to them; 0 of what has none
    mesh_normal         ///< 3: what is interpolated between the corners' normals in the frame of the mesh, shorter than
                        ///< these where they differ; of a flat triangle its normal, of length 1
};
inline constexpr int kShaderSources = 14;
/// Component of an attribute that is the mean of its RGB, or the value itself if it has one component.
inline constexpr std::uint32_t kAttributeMean = 4;

struct ShaderInput {
    ShaderSource source;
    std::uint32_t index = 0, component = 0;

    bool operator==(const ShaderInput&) const = default;
};

/// An operation on floats, defined for all arguments; division by 0, for example, gives 0.
struct ShaderOperation {
    std::string_view name;
    std::size_t argument_count = 0, result_count = 0;
    /// Whether the step's `parameter` is the index of a table, an image or a script, which has its own numbers of
    /// arguments and results, or a number below mode_count, which chooses what the operation does; otherwise it must be
    /// 0. A table has as many coordinates as the operation has arguments, or, for `rows`, two, of which the second has
    /// mode_count entries.
    enum class Parameter : std::uint8_t { none, table, rows, image, mode, script } parameter{};
    std::uint32_t mode_count = 0;
};

/// All operations except constants and inputs. A step refers to its operation by index.
std::span<const ShaderOperation> shader_operations();

/// A table, read by linear interpolation between even steps of coordinates 0 … 1, which are clamped.
struct ShaderTable {
    std::vector<float> values;         ///< the first coordinate runs fastest
    std::vector<std::uint32_t> sizes;  ///< number of entries along each of 1 … 3 coordinates, ≥ 1
};

/// Instructions that are run hit by hit, and may jump, over registers of 32 bits that hold a float or an integer.
struct ShaderScript {
    /// Five words of each instruction: its number among script_instructions(), the register that it writes, and those
    /// that it reads. Of jumps the second word is the instruction that they lead to; of `load` and `store` the last one
    /// is the length of the array.
    std::vector<std::uint32_t> code;
    std::vector<std::uint32_t> registers;  ///< what they hold at first
    std::uint32_t argument_count = 0;      ///< the arguments are written to the first registers
    std::vector<std::uint32_t> results;    ///< registers
};

struct ShaderStep {
    enum class Kind : std::uint8_t { constant, input, operation } kind;
    float constant = 0;  ///< or, of a difference that gives a slope, the distance it is taken over, in pixels
    ShaderInput input{};
    std::uint32_t operation = 0, parameter = 0;
    std::vector<std::uint32_t> arguments;  ///< values of earlier steps
};

/// Supplies the inputs of a program.
class ShaderReader {
  public:
    ShaderReader() = default;
    ShaderReader(const ShaderReader&) = delete;
    ShaderReader& operator=(const ShaderReader&) = delete;
    virtual ~ShaderReader() = default;
    /// Reads lanes first … first + out.size() - 1. place: 0 at the hit, 1 at the right neighbour, 2 at the lower one, 3
    /// and 4 near by.
    virtual void read(const ShaderInput& input, int place, std::size_t first, std::span<float> out) const = 0;
};

/// Immutable; any number of threads may run it.
class ShaderProgram {
  public:
    /// results: indices of the values that evaluate() returns. Throws std::invalid_argument for inconsistent steps.
    ShaderProgram(std::vector<ShaderStep> steps, std::vector<ShaderTable> tables,
                  std::vector<std::shared_ptr<const ImageTexture>> images, std::vector<ShaderScript> scripts,
                  const std::vector<std::uint32_t>& results);

    std::size_t result_count() const { return results_.size(); }
    /// Number of operations per hit.
    std::size_t operation_count() const { return operations_; }
    /// Whether it takes differences between neighbours, or between places near by.
    bool takes_differences() const { return takes_differences_; }
    /// How far those places are from the hit, in pixels: the greatest of its slopes' distances; 0: it has none.
    float slope_width() const { return slope_width_; }

    /// Working memory of evaluate(), which callers reuse.
    using Registers = std::vector<float>;
    /// Writes results[r · count + lane]. differs: whether other places are known; otherwise all differences are 0.
    void evaluate(const ShaderReader& reader, std::size_t count, bool differs, Registers& registers,
                  std::span<float> results) const;

  private:
    struct Value {
        std::uint32_t slot = 0;
        bool beside = false, near = false;  // computed at neighbours, and near the hit

        bool at(int place) const { return place == 0 || (place < kFirstNear ? beside : near); }
    };
    static constexpr int kFirstNear = 3;

    void check(const std::vector<std::uint32_t>& results);
    void check_operation(const ShaderStep& step, std::uint32_t values) const;
    std::size_t argument_count(const ShaderStep& step) const;
    std::size_t result_count(const ShaderStep& step) const;
    void find_places();
    void assign_slots(const std::vector<std::uint32_t>& results);
    void run(const ShaderStep& step, std::uint32_t first_value, const ShaderReader& reader, std::size_t first,
             std::size_t count, bool differs, float* registers) const;

    std::vector<ShaderStep> steps_;
    std::vector<ShaderTable> tables_;
    std::vector<std::shared_ptr<const ImageTexture>> images_;
    std::vector<ShaderScript> scripts_;
    std::vector<std::uint32_t> first_value_;  // index of each step's first value
    std::vector<Value> values_;
    std::vector<std::uint32_t> results_;
    std::size_t slots_ = 0, operations_ = 0;
    bool takes_differences_ = false;
    float slope_width_ = 0;
};

}  // namespace shlight
