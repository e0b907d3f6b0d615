// SPDX-License-Identifier: MIT
//
// Light that bounces, kept from one picture to the next: where the camera moves, only what it sees anew is gathered.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>

namespace shlight {

/// Light of one compiled scene, as renders with the same settings have gathered it: a render that is given it takes
/// that as it is, adds to it, and leaves it here at the end, also if it is cancelled. Light of another compiled scene,
/// or of other settings that it depends on, is dropped. Any number of threads may use it; of renders at the same time,
/// one has the light that is there, and what the last one leaves stays.
class KeptLight {
  public:
    KeptLight();
    KeptLight(const KeptLight&) = delete;
    KeptLight& operator=(const KeptLight&) = delete;
    ~KeptLight();

    /// Memory that light may take here between renders, about; what no picture has used for longest goes first.
    /// A render adds what it gathers, and this is cut at its end.
    std::size_t most_bytes() const;
    void set_most_bytes(std::size_t bytes);
    /// How many records (RenderReport::records) are here; 0 while a render uses them.
    std::size_t record_count() const;
    /// Memory that light takes here, about; 0 while a render uses it.
    std::size_t bytes() const;
    void clear();

  private:
    friend class LightLoan;
    struct Content;

    std::unique_ptr<Content> exchange(std::unique_ptr<Content> content);
    void shorten();

    mutable std::mutex mutex_;  // guards all below
    std::size_t most_bytes_ = std::size_t{1} << 28;
    std::unique_ptr<Content> content_;  // null: none is known, or a render uses it
};

}  // namespace shlight
