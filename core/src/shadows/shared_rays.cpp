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

void SharedRays::keep_apart(const Asked& asked, const Share& share, const ShadingPoints& points,
                            const KeptApart& unblocked, Hits& hits) {
    const std::size_t count = hits.apart.parts().count - kLightKinds;
    for (std::vector<Rgb>* sums : {&seen_, &asked_of_, &all_}) {
        sums->assign(count, Rgb(0));
    }
    for (const Question& question : std::span(questions_).subspan(asked.begin, asked.end - asked.begin)) {
        seen_[question.group] += question.value * visible(question);
        asked_of_[question.group] += question.value;
    }
    const std::size_t first = points.pixel_begin[asked.pixel];
    const std::size_t last = points.pixel_begin[asked.pixel + 1];
    Rgb sum(0);
    for (std::size_t point = first; point < last; ++point) {
        const std::span<const Rgb> own = unblocked.of(point).subspan(kLightKinds);
        for (std::size_t group = 0; group < count; ++group) {
            all_[group] += static_cast<float>(points.hit_count(point)) * own[group];
        }
    }
    for (std::size_t group = 0; group < count; ++group) {
        const auto asks = glm::greaterThan(asked_of_[group], Rgb(0));
        seen_[group] = all_[group] * glm::mix(share.seen, Rgb(quotient(seen_[group], asked_of_[group])), Rgb(asks));
        sum += share.seen * all_[group];
    }
    complete(seen_, sum, 0);
    for (std::size_t group = 0; group < count; ++group) {
        for (int channel = 0; channel < 3; ++channel) {
            const float all = all_[group][channel];
            seen_[group][channel] = all != 0 ? seen_[group][channel] / all : 0.0F;
        }
    }
    for (std::size_t hit = hits.pixel_begin[asked.pixel]; hit < hits.pixel_begin[asked.pixel + 1]; ++hit) {
        const std::span<const Rgb> own = unblocked.of(points.of_hit[hit]);
        const std::span<Rgb> apart = hits.apart.of(hit);
        for (std::size_t part = 0; part < apart.size(); ++part) {
            apart[part] += own[part] * (part < kLightKinds ? share.seen : seen_[part - kLightKinds]);
        }
    }
}

}  // namespace shlight
