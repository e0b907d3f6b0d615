// SPDX-License-Identifier: MIT
#include "lobes/sh_projection.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <mutex>
#include <numbers>
#include <utility>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "lobes/lobe_moments.h"
#include "lobes/view_grid.h"
#include "math/legendre.h"

namespace shlight {
namespace {

/// Lobes kept, some 1 MB each.
constexpr std::size_t kRecentLobes = 32;

/// ∫ z/π Y_l0 over the upper hemisphere: bands 0 and 1 and the even ones (Ramamoorthi & Hanrahan 2001, Eq. 19).
std::vector<double> lambert_terms() {
    std::vector<double> terms(kCosineMax, 0.0);
    terms[at(0, 0)] = std::sqrt(1 / (4 * std::numbers::pi));
    terms[at(1, 0)] = 2.0 / 3 * std::sqrt(3 / (4 * std::numbers::pi));
    double binomial = 0.5;  // l! / (2^l (l/2)!²)
    for (int l = 2; l < kMaxOrder; l += 2) {
        const double sign = l % 4 == 2 ? 2.0 : -2.0;
        terms[at(l, 0)] = sign * binomial / ((l + 2) * (l - 1)) * std::sqrt((2 * l + 1) / (4 * std::numbers::pi));
        binomial *= (l + 1.0) / (l + 2.0);
    }
    return terms;
}

}  // namespace

ShProjection::ShProjection(const LobeShape& shape) {
    if (std::holds_alternative<LambertShape>(shape)) {
        add_node(lambert_terms().data(), 2 / (3 * std::numbers::pi));
        return;
    }
    std::vector<LobeMoments> nodes(kViewNodes);
    // Isolated: a thread that waits here must not pick up unrelated work that may ask for this very lobe.
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(0, kViewNodes, [&](int node) {
            // At exactly grazing view a lobe is a limit; a view a microradian above it is the same to float.
            nodes[static_cast<std::size_t>(node)] =
                lobe_moments(shape, std::min(view_angle(node), std::numbers::pi / 2 - 1e-6));
        });
    });
    for (const LobeMoments& node : nodes) {
        add_node(node.moments.data(), node.norm_squared);
    }
}

void ShProjection::add_node(const double* cosine_terms, double norm_squared) {
    std::transform(cosine_terms, cosine_terms + kCosineMax, std::back_inserter(terms_),
                   [](double term) { return static_cast<float>(term); });
    double left = norm_squared;
    for (int l = 0; l < kMaxOrder; ++l) {
        double power = 0;
        for (int m = 0; m <= l; ++m) {
            power += cosine_terms[at(l, m)] * cosine_terms[at(l, m)];
        }
        powers_.push_back(static_cast<float>(power));
        left -= power;
    }
    tails_.push_back(static_cast<float>(std::max(left, 0.0)));
}

void ShProjection::coefficients(float cos_theta_o, int order, float* cosine_terms) const {
    const auto count = static_cast<std::size_t>(cosine_count(order));
    if (is_zonal()) {
        std::copy_n(terms_.begin(), count, cosine_terms);
        return;
    }
    const ViewStencil s(cos_theta_o);
    const float* a = &terms_[s.nodes[0] * kCosineMax];
    const float* b = &terms_[s.nodes[1] * kCosineMax];
    const float* c = &terms_[s.nodes[2] * kCosineMax];
    const float* d = &terms_[s.nodes[3] * kCosineMax];
    std::size_t i = 0;
    for (int l = 0; l < order; ++l) {
        for (int m = 0; m <= l; ++m, ++i) {
            const auto& w = m % 2 == 0 ? s.even : s.odd;
            cosine_terms[i] = w[0] * a[i] + w[1] * b[i] + w[2] * c[i] + w[3] * d[i];
        }
    }
}

std::shared_ptr<const ShProjection> sh_projection(const LobeShape& shape) {
    static std::mutex mutex;
    static std::deque<std::pair<LobeShape, std::shared_ptr<const ShProjection>>> recent;  // the last one in front
    const std::scoped_lock lock(mutex);
    const auto known =
        std::find_if(recent.begin(), recent.end(), [&](const auto& entry) { return entry.first == shape; });
    auto lobe = known != recent.end() ? known->second : std::make_shared<const ShProjection>(shape);
    if (known != recent.end()) {
        recent.erase(known);
    }
    recent.emplace_front(shape, lobe);
    if (recent.size() > kRecentLobes) {
        recent.pop_back();
    }
    return lobe;
}

}  // namespace shlight
