#pragma once

#include <cerrno>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {

/// Memory, disk or processes are short: the same run may pass at another time or on a larger
/// machine (programs: exit code 3, and `shortage` in the failure report).
class Shortage : public FileError {
public:
    using FileError::FileError;
};

/// Whether a value of errno says so.
inline bool isShortage(int error) {
    return error == ENOSPC || error == EDQUOT || error == ENOMEM || error == EIO ||
           error == ESTALE || error == EMFILE || error == ENFILE;
}

}  // namespace adaptiso
