#pragma once

namespace adaptiso {

/// Gives memory that was freed back to the system, where the C library (glibc) keeps it for later:
/// after large lists of one step it would lie beside those of the next. Takes about a millisecond
/// for 10 MB; so it is for between the steps of long work. Does nothing with other C libraries.
void returnFreedMemory();

/// For the start of a program whose work is lists that come and go: freed memory of lists up to
/// 32 MB, 128 MB in all, stays with the process until returnFreedMemory(), so that the next list
/// need not have it from the system again, page by page (a tenth of the time of simplification
/// where page faults are dear). It is for the whole process, so no library may ask for it. Does
/// nothing with other C libraries.
void keepFreedMemory();

}  // namespace adaptiso
