// SPDX-License-Identifier: MIT
#include "shadows/shared_rays.h"

#include "shadows/ray_sums.h"

namespace shlight {

void SharedRays::start() {
    questions_.clear();
    rays_.clear();
}

void SharedRays::ask(const Rgb& value, const Ray& ray) {
    questions_.push_back({value, static_cast<std::uint32_t>(rays_.size())});
    rays_.push_back(ray);
}

void SharedRays::trace() {
    visible_.resize(rays_.size());
    tracer_->visibility(rays_, visible_);
    rays_traced_ += rays_.size();
}

SharedRays::Share SharedRays::share(std::size_t begin, std::size_t end) const {
    const auto own = std::span(questions_).subspan(begin, end - begin);
    Share share;
    Vec3d all(0);
    Vec3d seen(0);
    for (const Question& question : own) {
        all += question.value;
        seen += question.value * visible(question);
        share.obstructed = share.obstructed || visible(question) != Rgb(1);
    }
    share.seen = Rgb(quotient(seen, all));
    for (const Question& question : share.obstructed ? own : own.first(0)) {
        const Vec3d off = quotient(Vec3d((visible(question) - share.seen) * question.value), all);
        share.variance += Rgb(off * off);
    }
    return share;
}

}  // namespace shlight
