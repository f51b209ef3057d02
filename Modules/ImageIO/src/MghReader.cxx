#include <fmt/core.h>

#include <array>
#include <bit>

#include "DataPlace.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "Readers.h"
#include "Samples.h"
#include "adaptiso/Core/MghFooter.h"

// ITK 5.2 as packaged has no MGH reader. Layout: FreeSurfer's utils/mriio.cpp (mghRead),
// big-endian.
namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kHeaderBytes = 284;

PixelType pixelTypeOfCode(const fs::path& file, std::int32_t code) {
    constexpr std::pair<int, PixelType> kTypes[] = {{0, PixelType::UInt8},
                                                    {1, PixelType::Int32},
                                                    {3, PixelType::Float32},
                                                    {4, PixelType::Int16},
                                                    {10, PixelType::UInt16}};
    for (const auto& [number, type] : kTypes) {
        if (number == code) return type;
    }
    refuse(file, fmt::format("unsupported MGH data type {}", code), "convert it with mri_convert");
}

/// vox2ras: Mdc times spacing; c_ras is the centre, voxel size / 2 (mghRead).
ImageGeometry geometryOf(const HeaderBytes& bytes, const Index3& size,
                         std::vector<Warning>& warnings) {
    Mat3 ras{{{{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}}}};  // FreeSurfer's default: coronal, 1 mm
    Vec3 centre;
    if (bytes.at<std::int16_t>(28) > 0) {
        for (int axis = 0; axis < 3; ++axis) {
            const double spacing = bytes.at<float>(30 + 4 * axis);
            for (int row = 0; row < 3; ++row) {
                ras.column[axis][row] = spacing * bytes.at<float>(42 + 12 * axis + 4 * row);
            }
            centre[axis] = bytes.at<float>(78 + 4 * axis);
        }
    } else {
        warnings.push_back({"guessed-orientation",
                            "the file says that its orientation is not known; FreeSurfer's "
                            "default (coronal, 1 mm) was taken"});
    }
    const Vec3 half{static_cast<double>(size[0]) / 2, static_cast<double>(size[1]) / 2,
                    static_cast<double>(size[2]) / 2};
    const Mat3 toLps = Mat3::diagonal(-1, -1, 1);
    return {size, toLps * (centre - ras * half), toLps * ras};
}

/// Behind a footer of unknown length a second file begins anywhere.
void requireNoSecondImage(const fs::path& file, std::string_view tail) {
    for (; tail.size() >= kHeaderBytes; tail.remove_prefix(1)) {
        if (!mghSamplesAt(tail)) continue;
        refuse(file,
               "holds an MGH file behind the image that its header describes: two files joined?",
               "split them, and give one");
    }
}

}  // namespace

std::optional<std::uint64_t> mghSamplesAt(std::string_view head) {
    if (head.size() < kHeaderBytes) return std::nullopt;
    const HeaderBytes bytes(head, std::endian::big);
    const auto isSpacing = [](float mm) { return mm > 1e-3F && mm < 100; };
    const auto code = bytes.at<std::int32_t>(20);
    bool isMgh = bytes.at<std::int32_t>(0) == 1 && bytes.at<std::int16_t>(28) == 1 &&
                 (code == 0 || code == 1 || code == 3 || code == 4 || code == 10);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        isMgh = isMgh && bytes.at<std::int32_t>(4 + 4 * axis) > 0 &&
                isSpacing(bytes.at<float>(30 + 4 * axis));
    }
    return isMgh ? std::optional<std::uint64_t>(kHeaderBytes) : std::nullopt;
}

ReadVolume readMgh(const fs::path& file, const ReadOptions& options) {
    std::array<char, kHeaderBytes> buffer{};
    ByteSource source = ByteSource::openPlainOrGzip(file);
    if (source.readSome(buffer.data(), kHeaderBytes) < kHeaderBytes) {
        refuse(file, "truncated: too short for an MGH header (284 bytes)", "get the whole file");
    }
    const HeaderBytes bytes({buffer.data(), buffer.size()}, std::endian::big);
    if (bytes.at<std::int32_t>(0) != 1) {
        refuse(file, "not an MGH file: its version is not 1", "check what it is");
    }
    const Index3 size{bytes.at<std::int32_t>(4), bytes.at<std::int32_t>(8),
                      bytes.at<std::int32_t>(12)};
    const auto frames = bytes.at<std::int32_t>(16);
    if (frames < 1) {
        refuse(
            file,
            fmt::format("its header is damaged: {} volumes (nframes), must be at least 1", frames),
            "repair the header");
    }
    SampleLayout layout{pixelTypeOfCode(file, bytes.at<std::int32_t>(20)), std::endian::big};
    layout.volumeCount = frames;
    requireImageBytes(file, size, layout.stored);
    layout.volume = chooseVolume(file, frames, options);
    std::vector<Warning> warnings;
    const ImageGeometry geometry = geometryOf(bytes, size, warnings);
    DataPlace place{file, file, ByteSource::encodingOf(file)};
    place.bytes = kHeaderBytes;
    PlacedVolume read = readPlaced(place, layout, geometry);
    const ImageExtent extent = ImageExtent::of(layout, size);
    const MghFooter footer = mghFooterOf(read.tail.head, read.tail.byteCount);
    const bool mayBeImage = footer != MghFooter::Whole && isMoreImage(read.tail.byteCount, extent);
    if (footer != MghFooter::Whole) requireNoSecondImage(file, read.tail.head);
    if (footer == MghFooter::None || mayBeImage) {
        constexpr std::uint64_t kNumbers = 20;  // of a footer, 0 as the border before them
        const bool isBorder = read.tail.isZeros && read.tail.byteCount > kNumbers &&
                              isMoreBorder(read.tail.byteCount - kNumbers, kHeaderBytes, extent);
        if (isBorder) read.tail.byteCount -= kNumbers;
        checkTail(place, read.tail, layout, size, warnings);
    } else if (read.tail.byteCount > 0 && place.encoding == ByteSource::Encoding::Raw) {
        requireBinaryTransfer(place, layout, size);
    }
    if (footer == MghFooter::CutOff && !mayBeImage) {
        warnings.push_back(
            {"footer-cut-off", "the notes that follow its image (MGH footer) are cut off"});
    }
    return {std::move(read.volume), "MGH", std::move(warnings)};
}

}  // namespace adaptiso::detail
