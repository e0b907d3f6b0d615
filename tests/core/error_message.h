// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>
#include <string>

namespace shlight::testing {

/// The message of the exception by which a call rejects its arguments; empty if it does not.
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
