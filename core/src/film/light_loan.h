// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "film/pixel_batch.h"
#include "shlight/kept_light.h"
#include "surfaces/stored_light.h"

namespace shlight {

/// Stored light in a render's hands, which goes back to its keeper at the end, whatever ends the render.
class LightLoan {
  public:
    /// The keeper's light if the picture may take it, else none is known. keeper: null: there is none; outlives this.
    LightLoan(KeptLight* keeper, const Picture& picture);
    LightLoan(const LightLoan&) = delete;
    LightLoan& operator=(const LightLoan&) = delete;
    ~LightLoan();

    StoredLight& light();

  private:
    KeptLight* keeper_;
    std::unique_ptr<KeptLight::Content> content_;
};

}  // namespace shlight
