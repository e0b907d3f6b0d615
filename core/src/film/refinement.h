// SPDX-License-Identifier: MIT
//
// Which pixels take more camera rays: where those that they have taken, their shadow rays or those of a neighbour
// disagree so much that the mean may be wrong.
//
// The mean of n rays spread evenly over a pixel of variance v is wrong by about √v n^-3/4: an edge crosses some √n of
// n cells, and errs in each by a random part of it. The same holds of the edge of a shadow on a light, and all shadow
// rays of a pixel. Where rays differ by their point of the aperture too, √v n^-5/8: of the cells of four dimensions an
// edge crosses some n^3/4. What counts is this error relative to √(r² + 0.01 r̄²), as in relMSE, r the pixel's own value
// and r̄ the picture's mean; and that of alpha. A pixel whose rays agree may still hold something thin or bright that a
// neighbour has seen.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "film/pixel_batch.h"

namespace shlight {

/// Pixels that go from one level to a higher one; one of level -1 has no rays, one of level 0 first_samples, and one of
/// level l > 0 first_samples · 2^(l+1).
struct RefinementGroup {
    int from, to;
    double rays;  // of each
    std::vector<Pixel> pixels;
    std::vector<double> gains;  // of each: what more rays may take from its squared error
};

class Refinement {
  public:
    /// depth_of_field: of the camera.
    Refinement(int width, int height, const PixelSampling& sampling, bool depth_of_field);

    /// Merges the rays that take a pixel to a level into its mean, alpha and variance. Other pixels may be merged at
    /// the same time.
    void merge(const Pixel& pixel, int level, const PixelSums& sums, std::span<float> image);
    /// Judges errors beside the mean of a picture, until next_round() has another.
    void set_mean(std::span<const float> image);
    /// Pixels that need more rays, those with the fewest first; empty if none does. threads: see RenderSettings. Throws
    /// RenderCancelled once stopped.
    std::vector<RefinementGroup> next_round(std::span<const float> image, int threads, const Stopped& stopped);
    /// Noise of the picture when next_round() was called, see RenderReport::noise.
    double noise() const { return noise_; }
    /// Likewise: camera rays that are left until every pixel has enough, as far as that is known.
    double rays_left() const { return rays_left_; }
    /// Pixels have a Pixel::most_by_path from now on.
    void limit_paths() { limits_paths_ = true; }
    /// Forgets that pixels have rays, but how light falls on them.
    void begin_again();
    std::uint32_t samples(int level) const { return level < 0 ? 0 : first_samples_ << (level + (level > 0 ? 1 : 0)); }
    /// Whether the first level is one ray through the middle, in whose place later ones come: of sets of four and more
    /// that are spread evenly none has a point in the middle, where one alone must be.
    bool has_preview() const { return first_samples_ == 1 && most_level_ > 0; }
    /// The first pass takes every so many-th pixel of every so many-th row: rays that others replace are worth their
    /// time only where they tell of pixels around them.
    int first_step() const { return has_preview() && least_level_ > 0 ? 2 : 1; }
    /// Pixels without any ray, for the first level.
    RefinementGroup unrendered() const;
    /// samples() without rays that later levels replace.
    std::uint32_t kept_samples(int level) const { return level == 0 && has_preview() ? 0 : samples(level); }
    int most_level() const { return most_level_; }

  private:
    /// Squared relative errors of a pixel's mean; or sums of them. Scaled to one camera ray, or by shadow rays to what
    /// they would be at level 0, so that those of pixels at any level add up.
    struct Noise {
        float seen = 0;         // by shadow rays, as the pixel's rays show them
        float independent = 0;  // as they would be if each ray were drawn by itself
        float shared = 0;       // the part that its camera rays have in common, which adds to the first
        float pixels = 0;       // with rays that count
        float variance = 0;     // of one camera ray
        float fine = 0;         // that as the rays show it, beyond what edges explain
        float fine_pixels = 0;  // in which the rays show anything beyond that

        Noise& operator+=(const Noise& other) {
            seen += other.seen;
            independent += other.independent;
            shared += other.shared;
            pixels += other.pixels;
            variance += other.variance;
            fine += other.fine;
            fine_pixels += other.fine_pixels;
            return *this;
        }
    };
    /// Causes of a pixel's squared relative error.
    struct Causes {
        double edges = 0;    // variance of one camera ray; those that are spread evenly have less of it
        double fine = 0;     // likewise, in what is finer than the rays are dense, where spreading gains nothing
        double shadows = 0;  // squared error by shadow rays, as it would be at level 0
    };
    struct State {
        Rgb variance{0};  // of one ray, without the noise of its shadow rays
        float error = 0;  // squared; as it was when a round looked at it
        std::int16_t level = -1;
        std::uint16_t merged = 0;  // the number of the round
        LightBits visibility;
        bool has_enough = false;  // when a round looked at it
    };
    /// The level that is known to do, and the next one, which may be higher for what is only supposed.
    struct Wanted {
        int enough, next;
        double error;  // squared
        double supposed_error;
    };

    std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column);
    }
    /// A row's contribution to the next round.
    struct Row {
        std::vector<RefinementGroup> groups;
        double errors = 0, rays_left = 0;
    };

    template <class Function>
    void for_each_around(int column, int row, int reach, const Function& f) const;
    Row next_of(int row, std::span<const float> image);
    /// Whether rays of the pixel or of those around it were merged since the last round.
    bool is_touched(int column, int row) const;
    /// Returns the pixel's noise with these rays. old, radiance: its colour before and with them; variance: with them.
    Noise merged_noise(std::size_t pixel, int level, const PixelSums& sums, const Vec3d& old, const Vec3d& radiance,
                       const Vec3d& variance) const;
    double noise_share(int level) const { return noise_shares_[static_cast<std::size_t>(level)]; }
    Wanted wanted(int column, int row, std::span<const float> image) const;
    double evenness(int level) const;
    double squared_error(const Causes& causes, int level) const;
    int sufficient_level(const Causes& causes) const;
    /// Lights, as in LightBits, that shadow rays from the pixel and those around it disagree about; one that has no
    /// rays of its own, or only a replaced one, looks farther.
    std::uint32_t penumbrae(int column, int row) const;
    /// Squared, of what is shown of a pixel that has no rays, if it is as one beside it.
    double error_between(int column, int row, std::span<const float> image) const;
    /// The noise of the pixel and of those around it tells the causes. variance: of one camera ray.
    Causes causes(int column, int row, double variance) const;
    /// So much that a ray brings its pixel, at this level, no more light than there is around it already, or a tenth of
    /// the picture's mean: where paths bring all light, nothing is there before.
    float most_by_path(int column, int row, int level, std::span<const float> image) const;
    double neighbours_variance(int column, int row, const Vec3d& scale, std::span<const float> image) const;

    int width_, height_;
    std::uint32_t first_samples_;
    int least_level_ = 0, most_level_ = 0;
    double good_enough_;  // squared
    bool depth_of_field_;
    bool limits_paths_ = false;
    double least_square_ = 0;  // 0.01 r̄²
    double noise_ = 0, rays_left_ = 0;
    std::uint16_t round_ = 0;           // which merges since the last call of next_round() belong to
    std::vector<double> noise_shares_;  // what each level leaves of shadow rays' squared error at level 0
    std::vector<State> states_;
    std::vector<Noise> noises_;  // of each pixel; apart, as most reads are of these alone
};

}  // namespace shlight
