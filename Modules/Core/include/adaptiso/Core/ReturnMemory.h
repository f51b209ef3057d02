#pragma once

namespace adaptiso {

/// Gives memory that was freed back to the system, where the C library (glibc) keeps it for later:
/// after large lists of one step it would lie beside those of the next. Takes about a millisecond
/// for 10 MB; so it is for between the steps of long work. Does nothing with other C libraries.
void returnFreedMemory();

}  // namespace adaptiso
