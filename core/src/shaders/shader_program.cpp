// SPDX-License-Identifier: MIT
#include "shlight/shader_program.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>

#include "base/checks.h"
#include "shaders/operations.h"
#include "shaders/script_kernel.h"

namespace shlight {
namespace {

using Kind = ShaderStep::Kind;
using Parameter = ShaderOperation::Parameter;

/// Number of lanes evaluated at a time; the values of a long program then stay in the cache.
constexpr std::size_t kLanes = 128;
static_assert(kLanes % 16 == 0);
constexpr int kPlaces = 5;
constexpr std::size_t kMostArguments = 128, kMostResults = 32;

const ShaderOperation& operation_of(const ShaderStep& step) {
    return shader_operations()[step.operation];
}

/// The place whose difference to the hit a step takes; 0: it is another step.
int other_place(const ShaderStep& step) {
    return step.kind == Kind::operation && step.operation < kDifferences ? static_cast<int>(step.operation) + 1 : 0;
}

void check_table(const ShaderTable& table) {
    std::size_t size = 1;
    for (const std::uint32_t side : table.sizes) {
        size *= side;
    }
    if (table.sizes.empty() || table.sizes.size() > 3 || size == 0 || size != table.values.size()) {
        reject("tables: the sizes do not fit the number of values");
    }
}

}  // namespace

ShaderProgram::ShaderProgram(std::vector<ShaderStep> steps, std::vector<ShaderTable> tables,
                             std::vector<std::shared_ptr<const ImageTexture>> images, std::vector<ShaderScript> scripts,
                             const std::vector<std::uint32_t>& results)
    : steps_(std::move(steps)),
      tables_(std::move(tables)),
      images_(std::move(images)),
      scripts_(std::move(scripts)),
      results_(results) {
    check(results);
    find_places();
    assign_slots(results);
}

void ShaderProgram::check(const std::vector<std::uint32_t>& results) {
    std::for_each(tables_.begin(), tables_.end(), check_table);
    for (const ShaderScript& script : scripts_) {
        check_script(script);
        if (script.argument_count > kMostArguments || script.results.size() > kMostResults) {
            reject("scripts: one has too many arguments or results");
        }
    }
    std::uint32_t values = 0;
    for (const ShaderStep& step : steps_) {
        if (step.kind == Kind::operation) {
            check_operation(step, values);
            ++operations_;
        }
        first_value_.push_back(values);
        values += static_cast<std::uint32_t>(result_count(step));
    }
    values_.resize(values);
    for (const std::uint32_t result : results) {
        if (result >= values) {
            reject("results: " + std::to_string(result) + " is no value of a step");
        }
    }
}

void ShaderProgram::check_operation(const ShaderStep& step, std::uint32_t values) const {
    if (step.operation >= shader_operations().size()) {
        reject("steps: there is no operation " + std::to_string(step.operation));
    }
    const ShaderOperation& operation = operation_of(step);
    const std::string name(operation.name);
    if (operation.parameter == Parameter::script && step.parameter >= scripts_.size()) {
        reject("steps: there is no script " + std::to_string(step.parameter));
    }
    if (step.arguments.size() != argument_count(step)) {
        reject("steps: " + name + " takes " + std::to_string(argument_count(step)) + " arguments, got " +
               std::to_string(step.arguments.size()));
    }
    for (const std::uint32_t argument : step.arguments) {
        if (argument >= values) {
            reject("steps: an argument of " + name + " is no value of an earlier step");
        }
    }
    if (operation.parameter == Parameter::image && step.parameter >= images_.size()) {
        reject("steps: there is no image " + std::to_string(step.parameter));
    }
    if (operation.parameter == Parameter::mode && step.parameter >= operation.mode_count) {
        reject("steps: " + name + " has no mode " + std::to_string(step.parameter));
    }
    if (operation.parameter == Parameter::rows &&
        (step.parameter >= tables_.size() || tables_[step.parameter].sizes.size() != 2 ||
         tables_[step.parameter].sizes[1] != operation.mode_count)) {
        reject("steps: " + name + " has no table of " + std::to_string(operation.mode_count) + " rows");
    }
    if (operation.parameter == Parameter::table &&
        (step.parameter >= tables_.size() || tables_[step.parameter].sizes.size() != operation.argument_count)) {
        reject("steps: " + name + " has no table with as many coordinates");
    }
}

std::size_t ShaderProgram::argument_count(const ShaderStep& step) const {
    const ShaderOperation& operation = operation_of(step);
    return operation.parameter == Parameter::script ? scripts_[step.parameter].argument_count
                                                    : operation.argument_count;
}

std::size_t ShaderProgram::result_count(const ShaderStep& step) const {
    if (step.kind != Kind::operation) {
        return 1;
    }
    const ShaderOperation& operation = operation_of(step);
    return operation.parameter == Parameter::script ? scripts_[step.parameter].results.size() : operation.result_count;
}

/// Marks the values that are needed at other places, because a difference of a dependent value is taken.
void ShaderProgram::find_places() {
    for (std::size_t s = steps_.size(); s-- > 0;) {
        const ShaderStep& step = steps_[s];
        const auto outputs = std::span(values_).subspan(first_value_[s], result_count(step));
        const int other = other_place(step);
        const bool one_place = other > 0 || step.kind == Kind::constant;
        const bool beside = !one_place && std::ranges::any_of(outputs, &Value::beside);
        const bool near = !one_place && std::ranges::any_of(outputs, &Value::near);
        for (Value& value : outputs) {
            value.beside = beside;
            value.near = near;
        }
        for (const std::uint32_t argument : step.arguments) {
            values_[argument].beside |= beside || (0 < other && other < kFirstNear);
            values_[argument].near |= near || other >= kFirstNear;
        }
        takes_differences_ |= other > 0;
        if (other >= kFirstNear) {
            slope_width_ = std::max(slope_width_, step.constant);
        }
    }
}

/// Assigns memory slots; a value may reuse the slot of one whose last use came before.
void ShaderProgram::assign_slots(const std::vector<std::uint32_t>& results) {
    std::vector<std::size_t> last_use(values_.size(), 0);
    for (std::size_t s = 0; s < steps_.size(); ++s) {
        for (const std::uint32_t argument : steps_[s].arguments) {
            last_use[argument] = s;
        }
        for (std::size_t k = 0; k < result_count(steps_[s]); ++k) {
            last_use[first_value_[s] + k] = s;
        }
    }
    for (const std::uint32_t result : results) {
        last_use[result] = steps_.size();
    }
    std::vector<std::vector<std::uint32_t>> ending(steps_.size() + 1);
    for (std::uint32_t value = 0; value < values_.size(); ++value) {
        ending[last_use[value]].push_back(value);
    }
    std::vector<std::uint32_t> free;
    for (std::size_t s = 0; s < steps_.size(); ++s) {
        for (std::size_t k = 0; k < result_count(steps_[s]); ++k) {
            if (free.empty()) {
                free.push_back(static_cast<std::uint32_t>(slots_++));
            }
            values_[first_value_[s] + k].slot = free.back();
            free.pop_back();
        }
        for (const std::uint32_t value : ending[s]) {
            free.push_back(values_[value].slot);
        }
    }
}

void ShaderProgram::evaluate(const ShaderReader& reader, std::size_t count, bool differs, Registers& registers,
                             std::span<float> results) const {
    registers.resize(slots_ * kPlaces * kLanes);
    for (std::size_t first = 0; first < count; first += kLanes) {
        const std::size_t lanes = std::min(kLanes, count - first);
        for (std::size_t s = 0; s < steps_.size(); ++s) {
            run(steps_[s], first_value_[s], reader, first, lanes, differs, registers.data());
        }
        for (std::size_t r = 0; r < results_.size(); ++r) {
            const float* from = registers.data() + values_[results_[r]].slot * kPlaces * kLanes;
            std::copy_n(from, lanes, results.begin() + static_cast<std::ptrdiff_t>(r * count + first));
        }
    }
}

void ShaderProgram::run(const ShaderStep& step, std::uint32_t first_value, const ShaderReader& reader,
                        std::size_t first, std::size_t count, bool differs, float* registers) const {
    // Values that are computed at one place only are the same at the others.
    const auto at = [&](std::uint32_t value, int place) {
        const std::size_t row =
            values_[value].slot * kPlaces + (values_[value].at(place) ? static_cast<std::size_t>(place) : 0);
        return registers + row * kLanes;
    };
    if (const int other = other_place(step)) {
        const float* here = at(step.arguments[0], 0);
        const float* there = at(step.arguments[0], differs ? other : 0);
        const float scale = other >= kFirstNear ? step.constant / slope_width_ : 1;
        std::transform(there, there + count, here, at(first_value, 0),
                       [scale](float a, float b) { return scale * (a - b); });
        return;
    }
    for (int place = 0; place < (differs ? kPlaces : 1); ++place) {
        if (!values_[first_value].at(place)) {
            continue;
        }
        if (step.kind == Kind::constant) {
            std::fill_n(at(first_value, place), count, step.constant);
        } else if (step.kind == Kind::input) {
            reader.read(step.input, place, first, {at(first_value, place), count});
        } else {
            const ShaderOperation& operation = operation_of(step);
            // Without values, which would cost a step of a cheap operation a tenth of its time.
            std::array<const float*, kMostArguments> arguments;
            std::array<float*, kMostResults> results;
            for (std::size_t i = 0; i < step.arguments.size(); ++i) {
                arguments[i] = at(step.arguments[i], place);
            }
            for (std::uint32_t i = 0; i < result_count(step); ++i) {
                results[i] = at(first_value + i, place);
            }
            const bool has_table = operation.parameter == Parameter::table || operation.parameter == Parameter::rows;
            const bool has_image = operation.parameter == Parameter::image;
            const bool has_script = operation.parameter == Parameter::script;
            operation_loops()[step.operation]({arguments.data(), results.data(), count,
                                               has_table ? &tables_[step.parameter] : nullptr,
                                               has_image ? images_[step.parameter].get() : nullptr, step.parameter,
                                               has_script ? &scripts_[step.parameter] : nullptr});
        }
    }
}

}  // namespace shlight
