// SPDX-License-Identifier: MIT
#include "lighting/shading_points.h"

#include <algorithm>
#include <cmath>

#include "lights/local_light.h"

namespace shlight {
namespace {

/// For materials without a narrow lobe: of cosθ and the horizon.
constexpr double kWidestSpread = 1.3;
/// Error of the difference of two unit vectors in float.
constexpr double kNormalRounding = 1e-6;

Vec3d towards_viewer(const Hits& hits, std::size_t hit) {
    const double cosine = hits.cos_theta_o[hit];
    return std::sqrt(1 - cosine * cosine) * hits.frame[hit].x + cosine * hits.frame[hit].z;
}

/// Compares widths; forms of another shape or azimuth differ by 1.
double relative_difference(std::span<const LobeForm> a, std::span<const LobeForm> b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        largest = std::max(largest, std::abs(double{a[i].width} - b[i].width) / std::max(a[i].width, b[i].width));
        largest = a[i].across == b[i].across && a[i].azimuth == b[i].azimuth ? largest : 1.0;
    }
    return largest;
}

double nearest(std::span<const Light> lights, const DeltaLights& deltas, const Vec3d& position) {
    double distance = deltas.changing_distance(position);
    for (const Light& light : lights) {
        distance = std::min(distance, changing_distance(light, position));
    }
    return distance;
}

}  // namespace

void ShadingPoints::clear() {
    frame.clear();
    cos_theta_o.clear();
    error.clear();
    material.clear();
    path.clear();
    lobe_weight.clear();
    lobe_forms.clear();
    of_hit.clear();
    pixel_begin.assign(1, 0);
    members_.clear();
    for (std::vector<float>* array : {&first_x_, &first_y_, &first_z_, &nearness_}) {
        array->clear();
    }
}

/// The next point near a hit, compared several at a time, because a hit that shares no point is compared with all.
std::size_t ShadingPoints::next_near(const Vec3f& normal, std::size_t point) const {
    constexpr std::size_t kAtOnce = 8;
    const auto is_near = [&](std::size_t i) {
        const float x = first_x_[i] - normal.x;
        const float y = first_y_[i] - normal.y;
        const float z = first_z_[i] - normal.z;
        return x * x + y * y + z * z <= nearness_[i] ? 1 : 0;
    };
    for (; point + kAtOnce <= size(); point += kAtOnce) {
        int any = 0;
        for (std::size_t i = point; i < point + kAtOnce; ++i) {
            any |= is_near(i);
        }
        if (any != 0) {
            break;
        }
    }
    while (point < size() && is_near(point) == 0) {
        ++point;
    }
    return point;
}

bool ShadingPoints::joins(const Hits& hits, std::size_t hit, std::size_t point, std::span<const Light> lights,
                          const DeltaLights& deltas) {
    if (material[point] != hits.material[hit] || path[point] != hits.path[hit]) {
        return false;
    }
    // The point's frame is that of its first hit until all are known.
    Members& members = members_[point];
    if (!members.knows_nearest) {
        members.nearest_light = nearest(lights, deltas, frame[point].origin);
        members.knows_nearest = true;
    }
    const double difference = glm::length(hits.frame[hit].z - frame[point].z) +
                              glm::length(towards_viewer(hits, hit) - members.first_towards_viewer) +
                              glm::length(hits.frame[hit].origin - frame[point].origin) / members.nearest_light;
    return difference + members.narrowest * relative_difference(hits.forms(hit), members.first_forms) <= members.spread;
}

void ShadingPoints::start(const Hits& hits, std::size_t hit, const MaterialLobes& lobes, double tolerance) {
    frame.push_back(hits.frame[hit]);
    cos_theta_o.push_back(hits.cos_theta_o[hit]);
    error.push_back(hits.error[hit]);
    material.push_back(hits.material[hit]);
    path.push_back(hits.path[hit]);
    lobe_weight.resize(lobe_weight.size() + lobe_stride_, Rgb(0));
    lobe_forms.resize(lobe_forms.size() + lobe_stride_, {0, 0, 0});
    const double narrowest = lobes.narrowest(hits.cos_theta_o[hit], hits.forms(hit));
    // The mean of azimuths says nothing about that of lobes: a frame turns fast where it is seen along its normal.
    const double spread = lobes.is_anisotropic() ? 0 : std::sqrt(3 * tolerance) * std::min(kWidestSpread, narrowest);
    const Vec3f normal(hits.frame[hit].z);
    first_x_.push_back(normal.x);
    first_y_.push_back(normal.y);
    first_z_.push_back(normal.z);
    nearness_.push_back(static_cast<float>((spread + kNormalRounding) * (spread + kNormalRounding)));
    members_.push_back(
        {towards_viewer(hits, hit), hits.forms(hit), narrowest, spread, 0, false, Vec3d(0), Vec3d(0), Vec3d(0), 0});
}

void ShadingPoints::add_member(const Hits& hits, std::size_t hit, std::size_t point) {
    Members& members = members_[point];
    members.position += hits.frame[hit].origin;
    members.normal += hits.frame[hit].z;
    members.towards_viewer += towards_viewer(hits, hit);
    for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
        lobe_weight[point * lobe_stride_ + lobe] += hits.weight(hit, lobe);
        LobeForm& form = lobe_forms[point * lobe_stride_ + lobe];
        const LobeForm& own = hits.forms(hit)[lobe];
        form = {form.width + own.width, own.across, own.azimuth};
    }
    ++members.count;
    of_hit.push_back(static_cast<std::uint32_t>(point));
}

void ShadingPoints::finish(std::size_t point) {
    const Members& members = members_[point];
    if (members.count > 1) {
        const Vec3d viewer = glm::normalize(members.towards_viewer);
        frame[point] = shading_frame(members.position / static_cast<double>(members.count),
                                     glm::normalize(members.normal), viewer);
        cos_theta_o[point] = view_cosine(frame[point].z, viewer);
        for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
            lobe_weight[point * lobe_stride_ + lobe] /= static_cast<float>(members.count);
            lobe_forms[point * lobe_stride_ + lobe].width /= static_cast<float>(members.count);
        }
    }
}

void ShadingPoints::assign(const Hits& hits, std::span<const MaterialLobes> materials, std::span<const Light> lights,
                           const DeltaLights& deltas, double tolerance) {
    clear();
    lobe_stride_ = hits.lobe_stride;
    for (std::size_t pixel = 0; pixel < hits.pixel_count(); ++pixel) {
        const std::size_t first_point = size();
        for (std::size_t hit = hits.pixel_begin[pixel]; hit < hits.pixel_begin[pixel + 1]; ++hit) {
            const Vec3f normal(hits.frame[hit].z);
            std::size_t point = next_near(normal, first_point);
            while (point < size() && !joins(hits, hit, point, lights, deltas)) {
                point = next_near(normal, point + 1);
            }
            if (point == size()) {
                start(hits, hit, materials[hits.material[hit]], tolerance);
            }
            add_member(hits, hit, point);
        }
        for (std::size_t point = first_point; point < size(); ++point) {
            finish(point);
        }
        pixel_begin.push_back(size());
    }
    sort_hits();
}

void ShadingPoints::sort_hits() {
    first_hit_.assign(1, 0);
    for (Members& members : members_) {
        first_hit_.push_back(first_hit_.back() + members.count);
        members.count = 0;
    }
    hits_by_point_.resize(of_hit.size());
    for (std::size_t hit = 0; hit < of_hit.size(); ++hit) {
        const std::uint32_t point = of_hit[hit];
        hits_by_point_[first_hit_[point] + members_[point].count++] = hit;
    }
}

}  // namespace shlight
