// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>
#include <string>

namespace shlight::testing {

/// What a call rejects its arguments with; empty if it does not.
template <class Call>
std::string error_message(const Call& call) {
    try {
        call();
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

}  // namespace shlight::testing
