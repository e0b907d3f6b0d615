// SPDX-License-Identifier: MIT
//
// Turning expansions in spherical harmonics, band by band.
//
// A turn is about z by c, about y by b, about z by a; turns about z mix pairs of degrees only, and the one about y is
// one about z between two quarter turns about x. Their matrices are fixed, and of their elements only those are not 0
// whose harmonics have the right symmetries: under a quarter turn y takes the place of z, x stays. So a band costs (2l
// + 1)² / 2 products.
#pragma once

#include <array>
#include <vector>

#include <glm/mat3x3.hpp>

#include "shlight/types.h"

namespace shlight {

/// Matrices of the quarter turn about x that takes y to z, for all bands; immutable.
class QuarterTurn {
  public:
    static const QuarterTurn& get();

    /// out: of g(ω) = f(turn⁻¹ ω), from the coefficients of band l of f; degrees -l … l.
    void apply(int l, const float* in, float* out) const;
    /// The opposite turn.
    void apply_inverse(int l, const float* in, float* out) const;

    /// Degrees of one symmetry that go to degrees of another, and the matrix between them. Degree m is number l + m.
    struct Block {
        std::vector<int> from, to;
        std::vector<float> columns;  ///< of each degree of `from`, to.size() numbers
        std::vector<float> rows;     ///< the same, transposed
    };
    const std::array<Block, 4>& blocks(int l) const { return bands_[static_cast<std::size_t>(l)]; }

  private:
    QuarterTurn();

    std::vector<std::array<Block, 4>> bands_;
};

/// Expansions turned by one rotation.
class BandRotation {
  public:
    /// Orthogonal, of determinant 1: takes the vectors of f's frame to those of the result's.
    explicit BandRotation(const glm::dmat3& rotation);

    /// coefficients: order² of f, replaced by those of g(ω) = f(rotation⁻¹ ω).
    void apply(int order, float* coefficients) const;

    /// cos mφ, sin mφ.
    struct Turn {
        std::array<float, kMaxOrder> cosines, sines;
        void set(double cosine, double sine);
        void apply(int l, float* band) const;
    };
    /// About z, about y, about z.
    const std::array<Turn, 3>& turns() const { return turns_; }

  private:
    std::array<Turn, 3> turns_;
};

}  // namespace shlight
