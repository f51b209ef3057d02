#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "ByteSource.h"
#include "Samples.h"
#include "adaptiso/Core/Warning.h"

/// Files that hold more than their header says: another image behind the first, more slices than
/// the header's size, samples of a wider type than it names.
namespace adaptiso::detail {

/// Bytes of an image as its header has it.
struct ImageExtent {
    std::uint64_t piece = 0;  ///< what a wrong size would be off by a multiple of: a slice, a row
    std::uint64_t whole = 0;  ///< one volume, one image

    /// Slices and volumes of `layout`.
    static ImageExtent of(const SampleLayout& layout, const Index3& size);
};

/// Whether so many bytes too many are whole pieces, or half of an image and more: more of the image
/// than its header tells of. Less than that is something else, which harms nothing.
bool isMoreImage(std::uint64_t extraBytes, const ImageExtent& extent);

/// Compares what follows the samples with what the header says follows: nothing.
///
/// \param isChosenPart  the header itself points to the samples inside a larger file: then it is
///                      only said that more follows
/// \throws FileError  another image or more of this one follows, compressed or not
/// A warning is added for anything else but padding with zeros behind compressed data.
void checkTail(const std::filesystem::path& file, const ByteTail& tail, const ImageExtent& extent,
               bool isChosenPart, std::vector<Warning>& warnings);

/// The same for samples that a header says are a file's last bytes, whatever is before them.
/// \throws FileError  so much is before them that it is another image
void checkBytesBefore(const std::filesystem::path& file, std::uint64_t byteCount,
                      const ImageExtent& extent);

}  // namespace adaptiso::detail
