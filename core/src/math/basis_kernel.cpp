// SPDX-License-Identifier: MIT
#include "math/basis_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "math/basis_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>

#include "math/legendre-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

template <class T>
struct Directions {
    V<Lanes<T>> x, y, z, sine_squared;
};

/// Loads directions, stored as rows of three, and normalises them; false if one is not finite or zero.
template <class T>
HWY_INLINE bool load(const T* rows, Directions<T>& u) {
    const Lanes<T> d;
    hn::LoadInterleaved3(d, rows, u.x, u.y, u.z);
    const auto largest = hn::Max(hn::Max(hn::Abs(u.x), hn::Abs(u.y)), hn::Abs(u.z));
    // A maximum may drop a NaN, a sum does not.
    const auto sum = hn::Add(hn::Add(u.x, u.y), u.z);
    const auto finite = hn::And(hn::IsFinite(largest), hn::IsFinite(hn::Mul(sum, all(d, 0.125))));
    if (!hn::AllTrue(d, hn::And(finite, hn::Gt(largest, hn::Zero(d))))) {
        return false;
    }
    for (auto* component : {&u.x, &u.y, &u.z}) {
        *component = hn::Div(*component, largest);
    }
    const auto across = hn::MulAdd(u.x, u.x, hn::Mul(u.y, u.y));
    const auto inverse = hn::Div(all(d, 1), hn::Sqrt(hn::MulAdd(u.z, u.z, across)));
    u.x = hn::Mul(u.x, inverse);
    u.y = hn::Mul(u.y, inverse);
    u.z = hn::Mul(u.z, inverse);
    u.sine_squared = hn::MulAdd(u.x, u.x, hn::Mul(u.y, u.y));
    return true;
}

template <class T, bool kAtPole>
HWY_NOINLINE void write(const Directions<T>& u, std::size_t order, const RowPointers<T>& rows, Output output) {
    const Lanes<T> d;
    constexpr std::size_t kLanes = kLaneCount<Lanes<T>>;
    alignas(64) std::array<T, kMaxOrder * kLanes> cosine;
    alignas(64) std::array<T, kMaxOrder * kLanes> sine;
    complex_powers_in_lanes(d, u.x, u.y, std::numbers::sqrt2, order, cosine.data(), sine.data());
    LegendreLanes<T, kAtPole> legendre(u.z, u.sine_squared);
    RowWriter<T> writer(rows, order, output);
    for (std::size_t l = 0; l < order; ++l) {
        T* middle = writer.take(2 * l + 1) + l * kLanes;
        hn::Store(legendre[0], d, middle);
        for (std::size_t m = 1; m <= l; ++m) {
            const auto value = legendre[m];
            hn::Store(hn::Mul(value, hn::Load(d, cosine.data() + m * kLanes)), d, middle + m * kLanes);
            hn::Store(hn::Mul(value, hn::Load(d, sine.data() + m * kLanes)), d, middle - m * kLanes);
        }
        if (l + 1 < order) {
            legendre.advance();
        }
    }
    writer.finish();
}

/// Collects directions near a pole until they fill a vector.
template <class T>
class PolarQueue {
  public:
    PolarQueue(const Vec3<T>* directions, std::size_t order, T* rows)
        : directions_(directions), order_(order), rows_(rows) {}

    void add(std::size_t i) {
        waiting_[count_++] = i;
        if (count_ == kLanes) {
            flush();
        }
    }

    void flush() {
        if (count_ == 0) {
            return;
        }
        std::fill(waiting_.begin() + count_, waiting_.end(), waiting_[count_ - 1]);
        std::array<Vec3<T>, kLanes> gathered;
        RowPointers<T> rows;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            gathered[lane] = directions_[waiting_[lane]];
            rows[lane] = rows_ + waiting_[lane] * order_ * order_;
        }
        Directions<T> u;
        if (load(&gathered[0].x, u)) {
            write<T, true>(u, order_, rows, Output::cached);
        }
        count_ = 0;
    }

  private:
    static constexpr std::size_t kLanes = kLaneCount<Lanes<T>>;

    const Vec3<T>* directions_;
    std::size_t order_;
    T* rows_;
    std::size_t count_ = 0;
    std::array<std::size_t, kLanes> waiting_;
};

template <class T>
bool basis_rows_of(const Vec3<T>* directions, std::size_t count, std::size_t order, T* out, Output output) {
    const Lanes<T> d;
    constexpr std::size_t kLanes = kLaneCount<Lanes<T>>;
    PolarQueue<T> polar(directions, order, out);
    for (std::size_t first = 0; first < count; first += kLanes) {
        const std::size_t lanes = std::min(kLanes, count - first);
        std::array<Vec3<T>, kLanes> padded;
        const Vec3<T>* source = directions + first;
        if (lanes < kLanes) {
            std::fill(std::copy_n(source, lanes, padded.begin()), padded.end(), source[lanes - 1]);
            source = padded.data();
        }
        Directions<T> u;
        if (!load(&source->x, u)) {
            return false;
        }
        RowPointers<T> rows;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            rows[lane] = out + (first + std::min(lane, lanes - 1)) * order * order;
        }
        write<T, false>(u, order, rows, output);
        const auto at_pole = hn::Lt(u.sine_squared, all(d, kNearPole));
        if (!hn::AllFalse(d, at_pole)) {
            alignas(64) std::array<T, kLanes> sine_squared;
            hn::Store(u.sine_squared, d, sine_squared.data());
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                if (sine_squared[lane] < static_cast<T>(kNearPole)) {
                    polar.add(first + lane);
                }
            }
        }
    }
    polar.flush();
    if (output == Output::streamed) {
        hwy::FlushStream();
    }
    return true;
}

bool basis_rows_float(const Vec3<float>* directions, std::size_t count, std::size_t order, float* rows, Output output) {
    return basis_rows_of(directions, count, order, rows, output);
}

bool basis_rows_double(const Vec3<double>* directions, std::size_t count, std::size_t order, double* rows,
                       Output output) {
    return basis_rows_of(directions, count, order, rows, output);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(basis_rows_float);
HWY_EXPORT(basis_rows_double);

bool basis_rows(const Vec3<float>* directions, std::size_t count, int order, float* rows, Output output) {
    return HWY_DYNAMIC_DISPATCH(basis_rows_float)(directions, count, static_cast<std::size_t>(order), rows, output);
}

bool basis_rows(const Vec3<double>* directions, std::size_t count, int order, double* rows, Output output) {
    return HWY_DYNAMIC_DISPATCH(basis_rows_double)(directions, count, static_cast<std::size_t>(order), rows, output);
}

}  // namespace shlight
#endif
