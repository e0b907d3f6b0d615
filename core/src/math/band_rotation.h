// SPDX-License-Identifier: MIT
//
// Rotation of expansions in spherical harmonics, band by band.
//
// A rotation is a turn about z by c, about y by b, and about z by a. Turns about z mix only pairs of degrees, and the
// turn about y is one about z between two quarter turns about x. The quarter turn's matrices are fixed. It takes y to z
// and keeps x, so that an element is 0 unless both harmonics have matching symmetries: a band costs (2l + 1)² / 2
// products.
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

    /// The matrix from degrees with one symmetry to degrees with another. Degree m has the number l + m.
    struct Block {
        std::vector<int> from, to;
        std::vector<float> columns;  ///< to.size() numbers for each degree of `from`
        std::vector<float> rows;     ///< the same, transposed
    };
    const std::array<Block, 4>& blocks(int l) const { return bands_[static_cast<std::size_t>(l)]; }

  private:
    QuarterTurn();

    std::vector<std::array<Block, 4>> bands_;
};

/// Rotates expansions by one rotation.
class BandRotation {
  public:
    /// rotation: orthogonal with determinant 1; takes vectors of f's frame to those of the result's.
    explicit BandRotation(const glm::dmat3& rotation);

    /// A turn about z by φ: cos mφ and sin mφ.
    struct Turn {
        std::array<float, kMaxOrder> cosines, sines;
        void set(double cosine, double sine);
    };
    /// The turns about z, y and z, in the order in which they apply.
    const std::array<Turn, 3>& turns() const { return turns_; }

  private:
    std::array<Turn, 3> turns_;
};

}  // namespace shlight
