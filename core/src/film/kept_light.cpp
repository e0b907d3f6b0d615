// SPDX-License-Identifier: MIT
#include "shlight/kept_light.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "film/light_loan.h"

namespace shlight {
namespace {

/// Light may be wrong by so many times what a picture asks for: the error of what is shaded is some five times smaller
/// than its bound, and a record is the mean over hundreds of rays.
constexpr double kMostErrors = 4;

/// Records that are left of too many take this share of the memory that there is: so some pictures add theirs before
/// the next cut.
constexpr double kShareOfLeft = 0.75;

/// All settings that light depends on. The camera is none of them: light is kept by cells of the world.
auto settings_of(const Picture& picture) {
    const RenderSettings& own = picture.settings;
    return std::tuple(own.order, own.tolerance, own.sampling.noise_threshold, own.shadow_rays > 0, own.seed,
                      own.transparent_bounces, own.max_bounces, own.glossy_bounces, own.transmission_bounces,
                      own.filter_glossy, own.clamp_indirect, own.darken_doubled, picture.stored_parts());
}

StoredLight no_light(const Picture& picture) {
    const auto bounces = static_cast<std::size_t>(picture.settings.max_bounces);
    const std::size_t parts = picture.stored_parts();
    return {
        parts, {}, LightCells(*picture.scene, picture.lighting.materials, picture.filtered_width(), bounces * parts)};
}

}  // namespace

struct KeptLight::Content {
    std::weak_ptr<const CompiledScene> scene;
    decltype(settings_of(std::declval<Picture>())) settings;
    double light_error;  // as of LightingScene; the largest of all light here
    StoredLight stored;

    bool serves(const Picture& picture) const {
        return scene.lock().get() == picture.scene && settings == settings_of(picture) &&
               light_error <= kMostErrors * picture.lighting.light_error;
    }
    std::size_t bytes() const { return stored.records.bytes() + stored.cells.bytes(); }
};

KeptLight::KeptLight() = default;

KeptLight::~KeptLight() = default;

std::unique_ptr<KeptLight::Content> KeptLight::exchange(std::unique_ptr<Content> content) {
    const std::lock_guard lock(mutex_);
    std::swap(content_, content);
    shorten();
    return content;
}

/// Cells go before records: what they hold is shaded again where rays end in them.
void KeptLight::shorten() {
    if (content_ && content_->bytes() > most_bytes_) {
        content_->stored.cells.clear();
        content_->stored.records.keep_latest(static_cast<std::size_t>(kShareOfLeft * static_cast<double>(most_bytes_)));
    }
}

std::size_t KeptLight::most_bytes() const {
    const std::lock_guard lock(mutex_);
    return most_bytes_;
}

void KeptLight::set_most_bytes(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    most_bytes_ = bytes;
    shorten();
}

std::size_t KeptLight::record_count() const {
    const std::lock_guard lock(mutex_);
    return content_ ? content_->stored.records.all().size() : 0;
}

std::size_t KeptLight::bytes() const {
    const std::lock_guard lock(mutex_);
    return content_ ? content_->bytes() : 0;
}

void KeptLight::clear() {
    exchange(nullptr);
}

LightLoan::LightLoan(KeptLight* keeper, const Picture& picture)
    : keeper_(picture.settings.max_bounces > 0 ? keeper : nullptr) {
    if (keeper_ != nullptr) {
        content_ = keeper_->exchange(nullptr);
    }
    const double light_error = picture.lighting.light_error;
    if (content_ && content_->serves(picture)) {
        content_->light_error = std::max(content_->light_error, light_error);
        content_->stored.records.index_all();
    } else {
        content_ = std::make_unique<KeptLight::Content>(
            KeptLight::Content{picture.scene->weak_from_this(), settings_of(picture), light_error, no_light(picture)});
    }
}

LightLoan::~LightLoan() {
    if (keeper_ != nullptr) {
        keeper_->exchange(std::move(content_));
    }
}

StoredLight& LightLoan::light() {
    return content_->stored;
}

}  // namespace shlight
