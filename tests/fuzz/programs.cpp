// SPDX-License-Identifier: MIT
#include <cstring>
#include <vector>

#include "invariants.h"
#include "shaders/script_kernel.h"
#include "shlight/shader_program.h"
#include "textures.h"

namespace shlight::fuzzing {
namespace {

using Parameter = ShaderOperation::Parameter;

/// The same numbers for a lane whatever it is asked with.
class Lanes : public ShaderReader {
  public:
    explicit Lanes(Input& input) {
        for (float& number : numbers_) {
            number = input.rarely() ? static_cast<float>(input.broken()) : input.number<float>();
        }
    }
    void read(const ShaderInput& input, int place, std::size_t first, std::span<float> out) const override {
        for (std::size_t i = 0; i < out.size(); ++i) {
            out[i] = numbers_[(first_ + first + i + 3 * static_cast<std::size_t>(place) + input.component) % kNumbers];
        }
    }
    void start_at(std::size_t lane) { first_ = lane; }

  private:
    static constexpr std::size_t kNumbers = 16;
    std::array<float, kNumbers> numbers_;
    std::size_t first_ = 0;
};

/// Instructions over a few registers; the last jumps of an endless loop take long, so that those back are rare.
ShaderScript draw_script(Input& input) {
    ShaderScript script;
    const int registers = input.integer(4, 12), length = input.integer(0, 8);
    const int names = static_cast<int>(script_instructions().size());
    for (int i = 0; i < registers; ++i) {
        script.registers.push_back(std::bit_cast<std::uint32_t>(input.number<float>()));
    }
    for (int i = 0; i < length; ++i) {
        const int number = input.integer(0, names);
        const bool jumps =
            number < names && script_instructions()[static_cast<std::size_t>(number)].starts_with("jump");
        const int to = jumps ? input.integer(input.rarely() ? 0 : i + 1, length) : input.integer(0, registers);
        script.code.insert(script.code.end(), {static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(to)});
        for (int k = 0; k < 3; ++k) {
            script.code.push_back(static_cast<std::uint32_t>(input.integer(0, registers - 1)));
        }
    }
    script.argument_count = static_cast<std::uint32_t>(input.integer(0, registers));
    for (int i = input.integer(1, 3); i > 0; --i) {
        script.results.push_back(static_cast<std::uint32_t>(input.integer(0, registers - 1)));
    }
    return script;
}

struct Parts {
    std::vector<ShaderStep> steps;
    std::vector<ShaderTable> tables;
    std::vector<std::shared_ptr<const ImageTexture>> images;
    std::vector<ShaderScript> scripts;
    std::uint32_t values = 0;
};

/// A step of values before it, for the most part a sound one.
void add_step(Parts& parts, Input& input) {
    const auto below = [&](std::size_t count) {
        return static_cast<std::uint32_t>(input.integer(0, static_cast<int>(count) - 1));
    };
    ShaderStep step{};
    step.kind = input.integer(0, 7) == 0 ? ShaderStep::Kind::constant : ShaderStep::Kind::input;
    step.constant = input.number<float>();
    step.input = {static_cast<ShaderSource>(below(kShaderSources)), below(3), below(5)};
    std::size_t arguments = 0, results = 1;
    if (parts.values > 0 && input.integer(0, 3) > 0) {
        step.kind = ShaderStep::Kind::operation;
        step.operation = below(shader_operations().size());
        const ShaderOperation& operation = shader_operations()[step.operation];
        const bool is_script = operation.parameter == Parameter::script;
        step.parameter = is_script || operation.parameter == Parameter::image ? 0
                         : operation.parameter == Parameter::mode             ? below(operation.mode_count)
                         : operation.parameter == Parameter::table
                             ? static_cast<std::uint32_t>(operation.argument_count - 1)
                             : 0;
        arguments = is_script ? parts.scripts[0].argument_count : operation.argument_count;
        results = is_script ? parts.scripts[0].results.size() : operation.result_count;
    }
    for (std::size_t i = 0; i < arguments; ++i) {
        step.arguments.push_back(input.rarely() ? below(parts.values + 1) : below(parts.values));
    }
    parts.values += static_cast<std::uint32_t>(results);
    parts.steps.push_back(std::move(step));
}

Parts draw_parts(Input& input) {
    Parts parts;
    parts.scripts.push_back(draw_script(input));
    parts.images.push_back(std::make_shared<const ImageTexture>(draw_texture(input, input.chance())));
    for (std::size_t axes = 1; axes <= 3; ++axes) {
        ShaderTable table{{}, std::vector<std::uint32_t>(axes, static_cast<std::uint32_t>(input.integer(1, 3)))};
        table.values.resize(static_cast<std::size_t>(std::pow(table.sizes[0], axes)), input.number<float>());
        parts.tables.push_back(std::move(table));
    }
    for (int i = input.integer(1, 12); i > 0; --i) {
        add_step(parts, input);
    }
    return parts;
}

/// A lane's bits do not depend on those beside it; all NaN are alike.
void check_lanes(const ShaderProgram& program, Lanes& lanes, bool differs) {
    constexpr std::size_t kCount = 5;
    std::vector<float> all(program.result_count() * kCount), one(program.result_count());
    ShaderProgram::Registers registers;
    program.evaluate(lanes, kCount, differs, registers, all);
    for (std::size_t lane = 0; lane < kCount; ++lane) {
        lanes.start_at(lane);
        program.evaluate(lanes, 1, differs, registers, one);
        for (std::size_t r = 0; r < one.size(); ++r) {
            const float beside = all[r * kCount + lane];
            const bool alike = one[r] == beside || (std::isnan(one[r]) && std::isnan(beside));
            check_most("a lane is another among others", alike ? 0 : 1, 0);
        }
    }
}

}  // namespace
}  // namespace shlight::fuzzing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace shlight::fuzzing;
    Input input(data, size);
    Lanes lanes(input);
    const bool differs = input.chance();
    Parts parts = draw_parts(input);
    const std::vector<std::uint32_t> results = {parts.values - 1, parts.values / 2, input.rarely() ? parts.values : 0};
    std::optional<shlight::ShaderProgram> program;
    if (answers([&] { program.emplace(parts.steps, parts.tables, parts.images, parts.scripts, results); })) {
        check_lanes(*program, lanes, differs);
    }
    return 0;
}
