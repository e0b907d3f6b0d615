// SPDX-License-Identifier: MIT
#include "shlight/types.h"

#include <stdexcept>
#include <string>

namespace shlight {

void check_order(int order) {
    if (order < 1 || order > kMaxOrder) {
        throw std::invalid_argument("order must be 1 … " + std::to_string(kMaxOrder) + ", got " +
                                    std::to_string(order));
    }
}

}  // namespace shlight
