#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "ByteSource.h"
#include "Samples.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso::detail {

/// The file that a header names as its data: in the header's folder or below it.
///
/// \throws FileError when the name is absolute, leaves the folder, is a pattern or a list, is the
///         header itself, no regular file, or a link that requireOwnFolder() refuses
std::filesystem::path requireDataFile(const std::filesystem::path& headerFile,
                                      std::string_view name);

/// A header must not open a file that the user did not mean to give: a data file beside it is where
/// it seems to be, or a link that liesBeside() accepts. The input itself may be any link.
///
/// \throws FileError when `dataFile` lies elsewhere
void requireOwnFolder(const std::filesystem::path& headerFile,
                      const std::filesystem::path& dataFile);

/// Where a header puts its samples, and whether the file holds them there: another format's header
/// may lie in their place, another image behind them, or a transfer may have changed them.

/// Bytes of an image as its header has it.
struct ImageExtent {
    std::uint64_t piece = 0;   ///< a slice
    std::uint64_t whole = 0;   ///< one volume, one image
    std::uint64_t row = 0;     ///< a row of every slice of all volumes: one more in a larger image
    std::uint64_t column = 0;  ///< a column of every slice

    /// Slices and volumes of `layout`.
    static ImageExtent of(const SampleLayout& layout, const Index3& size);
};

/// The file holds more of the image than its header describes: as much as a header that is one
/// slice, row or column short leaves over.
bool isMoreImage(std::uint64_t extraBytes, const ImageExtent& extent);

/// The same of bytes that are all 0, which are padding elsewhere: whole rows or columns of every
/// slice, as of a larger image's border, that no block of 512 bytes explains.
/// \param end  of the file or of the stream, behind those bytes
bool isMoreBorder(std::uint64_t zeroBytes, std::uint64_t end, const ImageExtent& extent);

/// A header's word of where its samples lie.
struct DataPlace {
    std::filesystem::path header;
    std::filesystem::path file;  ///< holds the samples; the header itself where they are attached
    ByteSource::Encoding encoding = ByteSource::Encoding::Raw;
    std::uint64_t begin = 0;     ///< of the file: behind an attached text header
    std::uint64_t lines = 0;     ///< lines of the file to skip
    std::uint64_t bytes = 0;     ///< then bytes to skip, inflated
    bool countsFromEnd = false;  ///< instead of `bytes`: the samples are the last bytes
    /// The header's words for `bytes` and for compressed data; both empty in formats that keep
    /// header and samples in one file.
    std::string_view skipName{}, gzipField{};

    bool isDetached() const { return file != header; }
};

/// The samples of `place`, `byteCount` in all volumes.
///
/// A data file that is an image file itself must be entered where its own samples begin, or whole
/// slices behind: elsewhere its header would be read as voxels.
/// \throws FileError  the samples begin elsewhere; fewer than `byteCount` bytes are there; bytes
///                    before them are part of the image; of an attached header, any bytes before
///                    them
ByteSource openData(const DataPlace& place, std::uint64_t byteCount, const ImageExtent& extent);

/// A volume, and what is behind it in its file.
struct PlacedVolume {
    Volume volume;
    ByteTail tail;
};

/// openData() and readSamples(), whose errors this throws.
PlacedVolume readPlaced(const DataPlace& place, const SampleLayout& layout,
                        const ImageGeometry& geometry);

/// Checks that nothing follows the samples, as the header promises.
///
/// A warning is added for anything but padding with zeros behind compressed data.
/// \throws FileError  the data file is of another kind (a picture, an archive); the samples were
///                    changed by a transfer in text mode; another image, whatever its size, or more
///                    of this one follows, unless the header points into a larger file
void checkTail(const DataPlace& place, const ByteTail& tail, const SampleLayout& layout,
               const Index3& size, std::vector<Warning>& warnings);

/// \throws FileError  all line ends among the samples are of Windows, or all bytes above 127 are
///                    UTF-8, as a transfer in text mode leaves them, which moves what follows
/// \pre the file holds more bytes than its header describes
void requireBinaryTransfer(const DataPlace& place, const SampleLayout& layout, const Index3& size);

/// \throws FileError  the data file is of another kind: a pointer, a page, an archive, a picture
void refuseForeignData(const DataPlace& place);

/// Calls `read`. Where it fails and the data file is of another kind, that is the fault reported.
template <class Read>
auto readingData(const DataPlace& place, Read&& read) {
    try {
        return read();
    } catch (const FileError&) {
        refuseForeignData(place);
        throw;
    }
}

}  // namespace adaptiso::detail
