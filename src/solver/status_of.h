// Argument failures, and the public status and message of a call for exceptions.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <new>
#include <string>
#include <type_traits>
#include <utility>

#include "integrate/integration_options.h"
#include "problem/failure.h"

namespace sfdae::core {

[[noreturn]] inline void refuse_argument(std::string message) {
  throw Failure(SFDAE_ILLEGAL_ARGUMENT, std::move(message));
}

inline constexpr const char* out_of_memory = "out of memory.";

// Passes the result of the body, SFDAE_OK if it is void, or that of its exception, to say(status, text), which returns
// the status.
template <class Body, class Say>
int status_of(Body body, Say say) noexcept {
  try {
    CallResult result;
    if constexpr (std::is_void_v<decltype(body())>) body();
    else result = body();
    return say(result.status, result.message.c_str());
  } catch (const Failure& failure) {
    return say(failure.status(), failure.what());
  } catch (const std::bad_alloc&) {
    return say(SFDAE_OUT_OF_MEMORY, out_of_memory);
  } catch (const std::exception& unexpected) {
    return say(SFDAE_INTERNAL, unexpected.what());
  } catch (...) {
    return say(SFDAE_INTERNAL, "an exception came out of a callback.");
  }
}

}  // namespace sfdae::core
