// SPDX-License-Identifier: MIT
#include "simd/targets.h"

#include <hwy/highway.h>

#include <cstdlib>
#include <stdexcept>

#include "base/checks.h"

namespace shlight {
namespace {

/// Highway's bits of the instruction sets that can run here, best first: a better set has a lower bit.
std::vector<std::int64_t> supported() {
    static const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
    if (targets.empty()) {
        throw std::runtime_error("shlight needs a processor with SSE4.2, AES and PCLMUL instructions");
    }
    return targets;
}

/// Highway stores the set of permitted targets and runs the best of them.
std::int64_t& forced() {
    static std::int64_t target = supported().front();
    return target;
}

void use(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    forced() = target;
}

/// The bit of the target with this name. argument: where the name came from, for the error message.
std::int64_t target_of_name(const std::string& argument, const std::string& name) {
    std::string known;
    for (const std::int64_t target : supported()) {
        if (name == hwy::TargetName(target)) {
            return target;
        }
        known += (known.empty() ? "" : ", ") + std::string(hwy::TargetName(target));
    }
    reject(argument + ": this build has " + known + " for this machine, not " + name);
}

}  // namespace

std::vector<std::string> kernel_targets() {
    std::vector<std::string> names;
    for (const std::int64_t target : supported()) {
        names.emplace_back(hwy::TargetName(target));
    }
    return names;
}

std::string kernel_target() {
    return hwy::TargetName(forced());
}

void force_kernel_target(const std::string& target) {
    use(target_of_name("target", target));
}

ForcedKernelTarget::ForcedKernelTarget(const std::string& target) : before_(forced()) {
    force_kernel_target(target);
}

ForcedKernelTarget::~ForcedKernelTarget() {
    use(before_);
}

void choose_kernel_target() {
    constexpr const char* kVariable = "SHLIGHT_KERNEL_TARGET";
    const char* name = std::getenv(kVariable);
    use(name == nullptr ? supported().front() : target_of_name(kVariable, name));
}

}  // namespace shlight
