// SPDX-License-Identifier: MIT
//
// A picture that is lit again and again: what its camera rays meet is kept, and what each light brings to each pixel,
// so that a change of one light costs that light alone.
#pragma once

#include <memory>
#include <span>

#include "shlight/camera.h"
#include "shlight/parallel.h"
#include "shlight/render.h"
#include "shlight/render_report.h"
#include "shlight/scene.h"

namespace shlight {

/// Not for several threads at a time.
class FixedView {
  public:
    /// settings: of direct light. Each pixel has sampling.max_samples camera rays and no others; shadow_rays is of each
    /// of them and light in one pass, at most. passes, bounces, the noise threshold and the time limit do not matter.
    /// Throws as check_render does.
    FixedView(const Camera& camera, int width, int height, const RenderSettings& settings);
    FixedView(const FixedView&) = delete;
    FixedView& operator=(const FixedView&) = delete;
    ~FixedView();

    int width() const;
    int height() const;

    /// The picture of the scene as render() makes it with the same settings. What is kept serves as far as the scene is
    /// the one before: lights that differ are found anew, by one pass of shadow rays, and one whose strength alone
    /// differs is scaled, unless it has become much brighter. Camera rays are traced anew where meshes or the
    /// environment differ, or lamps that camera rays see. Where there are many lights, some of them are kept together.
    /// noise_threshold: further passes go on over parts of the picture, each with as many shadow rays as those before
    /// together, until RenderReport::noise is below it or they have taken 2^14 for each camera ray and light; ≥ 1:
    /// none.
    /// The report is of this call, but for the noise, which is that of the picture by shadow rays. image: as of
    /// render(). The picture depends on the calls before only as far as its noise and tolerance allow, and not on the
    /// number of threads. Throws std::invalid_argument for a noise_threshold that is not positive, and for an image of
    /// another size; RenderCancelled when progress returns false, and what it throws: everything is then found anew by
    /// the next call.
    RenderReport relight(const std::shared_ptr<const CompiledScene>& scene, double noise_threshold,
                         std::span<float> image, const Progress& progress = {});

  private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace shlight
