#pragma once

#include <stdexcept>
#include <string>

namespace adaptiso {

/// Base of everything this library throws on purpose. The message is one line that names the
/// file or function, the value and the rule it breaks; programs print it as it is.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The caller's data or arguments break a documented rule (programs: exit code 3).
class InvalidInput : public Error {
public:
    using Error::Error;
};

/// A file can't be read, written or understood (programs: exit code 3).
class FileError : public Error {
public:
    using Error::Error;
};

/// A promise of the library would be broken: a bug, never the user's fault (programs: exit code 4).
class InternalError : public Error {
public:
    using Error::Error;
};

}  // namespace adaptiso
