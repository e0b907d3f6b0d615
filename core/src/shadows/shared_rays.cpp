// SPDX-License-Identifier: MIT
#include "shadows/shared_rays.h"

#include "shadows/ray_sums.h"

namespace shlight {

void SharedRays::start() {
    questions_.clear();
    rays_.clear();
}

void SharedRays::ask(const Rgb& value, std::uint32_t group, const Ray& ray) {
    questions_.push_back({value, group, static_cast<std::uint32_t>(rays_.size())});
    rays_.push_back(ray);
}

void SharedRays::trace() {
    visible_.resize(rays_.size());
    tracer_->visibility(rays_, visible_);
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

void SharedRays::keep_apart(const Asked& asked, const Share& share, std::span<const Rgb> unblocked, KeptApart& apart) {
    const std::span<const Rgb> all = unblocked.subspan(kLightKinds);
    seen_.assign(all.size(), Rgb(0));
    asked_of_.assign(all.size(), Rgb(0));
    for (const Question& question : std::span(questions_).subspan(asked.begin, asked.end - asked.begin)) {
        seen_[question.group] += question.value * visible(question);
        asked_of_[question.group] += question.value;
    }
    Rgb sum(0);
    for (std::size_t group = 0; group < all.size(); ++group) {
        const Rgb known(glm::greaterThan(asked_of_[group], Rgb(0)));
        seen_[group] = all[group] * glm::mix(share.seen, Rgb(quotient(seen_[group], asked_of_[group])), known);
        sum += share.seen * all[group];
    }
    complete(seen_, sum, 0);
    const std::span<Rgb> own = apart.of(asked.pixel);
    for (std::size_t part = 0; part < own.size(); ++part) {
        own[part] += part < kLightKinds ? share.seen * unblocked[part] : seen_[part - kLightKinds];
    }
}

}  // namespace shlight
