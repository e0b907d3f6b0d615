// SPDX-License-Identifier: MIT
#include "simd/targets.h"

#include <hwy/highway.h>

#include <algorithm>
#include <cstdlib>

#include "base/checks.h"

namespace shlight {
namespace {

/// As Highway's bits, best first: the better an instruction set, the lower its bit.
std::vector<std::int64_t> supported() {
    static const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
    return targets;
}

/// Highway remembers the set of permitted targets; the best of them is what runs.
std::int64_t& forced() {
    static std::int64_t target = supported().front();
    return target;
}

void use(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    forced() = target;
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
    const auto targets = supported();
    const auto found =
        std::find_if(targets.begin(), targets.end(), [&](std::int64_t bit) { return target == hwy::TargetName(bit); });
    if (found == targets.end()) {
        std::string known;
        for (const std::string& name : kernel_targets()) {
            known += (known.empty() ? "" : ", ") + name;
        }
        reject("target: this machine has " + known + ", not " + target);
    }
    use(*found);
}

ForcedKernelTarget::ForcedKernelTarget(const std::string& target) : before_(forced()) {
    force_kernel_target(target);
}

ForcedKernelTarget::~ForcedKernelTarget() {
    use(before_);
}

void force_kernel_target_of_environment() {
    if (const char* target = std::getenv("SHLIGHT_KERNEL_TARGET")) {
        force_kernel_target(target);
    }
}

}  // namespace shlight
