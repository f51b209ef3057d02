#pragma once

namespace adaptiso {

/// What a program of this project returns to the shell.
enum ExitCode : int {
    kExitOk = 0,
    kExitCheckFailed = 1,   ///< the program worked; a check that it was asked for did not pass
    kExitUsage = 2,         ///< options that make no sense
    kExitBadInput = 3,      ///< a file or value that can't be used, or too little memory or disk
    kExitInternalError = 4  ///< a bug
};

}  // namespace adaptiso
