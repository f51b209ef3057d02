#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "DicomBytes.h"
#include "DicomCodecs.h"
#include "DicomFile.h"
#include "DicomStack.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso::detail {

/// \throws FileError unless the file holds scalar grey pixels of 1, 8, 16 or 32 bits
DicomPixelFormat dicomPixelFormat(const DicomFile& dicom);

/// The stored samples of one file (before rescale), frame by frame.
///
/// Native and RLE pixels are read here; JPEG, JPEG-LS and JPEG 2000 are decoded by GDCM, which is
/// given one frame's codestream at a time, after a look at the codestream's own header.
class DicomFrames {
public:
    /// \throws FileError for an unknown transfer syntax, too few pixel data, as many too many as
    ///         rows or frames more would have, or frames that can't be told apart
    DicomFrames(const DicomFile& dicom, const DicomPixelFormat& format);

    /// Fills `samples` with frameBytes() bytes in this machine's byte order, without what lies
    /// above HighBit (an overlay) and below BitsStored.
    /// \throws FileError when the frame can't be decoded
    void read(std::int64_t frame, std::vector<std::byte>& samples);

    /// A frame read so far had bits above HighBit that are neither the sign nor an overlay.
    bool hasStrayBits() const { return hasStrayBits_; }

    /// Its pixel data are longer than its frames, by less than an image would be; not by the one
    /// byte that makes lengths even.
    bool hasPadding() const { return hasPadding_; }

private:
    void openNative();
    bool isZeros(std::uint64_t position, std::uint64_t byteCount);
    void inflateOnce();
    void openEncapsulated();
    void requireRoomInRuns() const;
    std::vector<std::size_t> firstFragments();
    bool beginsCodestream(const DicomPixelData::Fragment& fragment);
    bool beginsRle(const DicomPixelData::Fragment& fragment);
    void requireOneFrame();
    void readPacked(std::int64_t frame, std::vector<std::byte>& samples);
    std::string codestreamOf(std::int64_t frame);

    const DicomFile& dicom_;
    DicomPixelFormat format_;
    DicomCodec codec_ = DicomCodec::None;
    DicomBytes bytes_;
    bool isInflated_ = false, hasStrayBits_ = false, hasPadding_ = false;
    std::vector<std::size_t> frameBegins_;  ///< each frame's first fragment, and one past the last
};

/// Decodes and rescales (PS3.3, C.11.1) the planes of a stack, each file once, and blends them
/// where the stack says so.
///
/// Samples keep their stored type where nothing is rescaled; slope 1 and whole intercepts give the
/// smallest integer type that holds all values; all else, and blending, gives a float type.
/// \throws FileError when a file can't be decoded or memory is short
Volume decodeDicomStack(const std::filesystem::path& input, const std::vector<DicomFile>& files,
                        const DicomStack& stack, std::vector<Warning>& warnings);

}  // namespace adaptiso::detail
