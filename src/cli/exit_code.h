// Exit codes of the command: the contract that scripts rely on. The command never ends by a signal
// of its own making.
#pragma once

#include <tessera/error.h>

namespace tessera::cli {

enum ExitCode : int {
    kFine = 0,
    kInternalFault = 1,
    kUsageError = 2,
    kComparisonFailed = 3,
    kInputError = 4,
    kOutputError = 5,
    kLimitReached = 6,  // a limit, the memory or the time
};

constexpr ExitCode exit_code(ErrorCode code) {
    switch (code) {
        case ErrorCode::kInternal:
            return kInternalFault;
        case ErrorCode::kUsage:
            return kUsageError;
        case ErrorCode::kInput:
            return kInputError;
        case ErrorCode::kOutput:
            return kOutputError;
        case ErrorCode::kLimit:
            return kLimitReached;
        case ErrorCode::kCancelled:
            return kLimitReached;
    }
    return kInternalFault;
}

}  // namespace tessera::cli
