#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/ImageIO/ReadVolume.h"

/// Files made byte by byte, so that the truth does not come from the libraries under test.
namespace adaptiso::testing {

/// A folder of this test alone, removed with everything in it at the end.
class TempFolder {
public:
    TempFolder();
    ~TempFolder();
    TempFolder(const TempFolder&) = delete;
    TempFolder& operator=(const TempFolder&) = delete;

    std::filesystem::path operator/(std::string_view name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

std::filesystem::path writeFile(const std::filesystem::path& file, std::string_view bytes);
std::string gzipped(std::string_view bytes);
std::string zlibbed(std::string_view bytes);
/// Without a frame (RFC 1951), as DICOM deflates.
std::string rawDeflated(std::string_view bytes);

/// `value`'s bytes in the given order.
template <class T>
std::string bytesOf(T value, std::endian order = std::endian::little) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    if (order != std::endian::native) bytes = std::string(bytes.rbegin(), bytes.rend());
    return bytes;
}

template <class T>
void put(std::string& bytes, std::size_t offset, T value, std::endian order = std::endian::little) {
    bytes.replace(offset, sizeof(T), bytesOf(value, order));
}

template <class T>
std::string samplesOf(const std::vector<T>& samples, std::endian order = std::endian::little) {
    std::string bytes;
    for (const T sample : samples) bytes += bytesOf(sample, order);
    return bytes;
}

/// 0, 1, 2, ... as type T, and at the end T's smallest and largest value.
template <class T>
std::vector<T> countingSamples(std::int64_t count) {
    std::vector<T> samples(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<T>(i % 100);
    samples[samples.size() - 2] = std::numeric_limits<T>::lowest();
    samples.back() = std::numeric_limits<T>::max();
    return samples;
}

/// The samples of most test files: int16, 4 x 3 x 2 voxels.
inline const std::string kSamples = samplesOf(countingSamples<std::int16_t>(24));

template <class T>
std::vector<T> samplesIn(const VolumeView& volume) {
    const TypedVolumeView<T> view = volume.as<T>();
    return {view.samples, view.samples + volume.geometry().voxelCount()};
}

/// readVolume()'s FileError for `input`; fails the test when it reads.
std::string refusalOf(const std::filesystem::path& input, const ReadOptions& options = {});

/// Expects a refusal of one line that begins with the input's path and holds `fault`.
void expectRefusal(const std::filesystem::path& input, std::string_view fault,
                   const ReadOptions& options = {});

void expectNear(const Vec3& actual, const Vec3& expected, double toleranceMm);

/// A NIfTI-1 header (348 bytes and 4 of extension flags), little endian unless said otherwise:
/// 4 x 3 x 2 int16, spacing 1, sform and qform codes 0, data at 352.
struct NiftiFile {
    std::endian order = std::endian::little;
    std::array<std::int16_t, 8> dim{3, 4, 3, 2, 1, 1, 1, 1};
    std::int16_t datatype = 4, bitpix = 16;
    std::array<float, 8> pixdim{1, 1, 1, 1, 0, 0, 0, 0};
    float dataOffset = 352, slope = 0, intercept = 0;
    std::uint8_t units = 2;
    std::int16_t qformCode = 0, sformCode = 0;
    std::array<float, 3> quaternion{0, 0, 0}, qoffset{0, 0, 0};
    std::array<float, 12> sform{};
    std::string magic = std::string("n+1\0", 4);
    std::string data = samplesOf(countingSamples<std::int16_t>(24));

    std::string header() const;
    std::string bytes() const { return header() + data; }
};

/// One slice of 3 x 2 (columns x rows) uint16 voxels as an explicit little endian CT image.
struct DicomSlice {
    std::string sopClass = "1.2.840.10008.5.1.4.1.1.2";  // CT image
    std::string seriesUid = "1.2.3.4";
    std::string position = "10\\20\\30";
    std::string orientation = "1\\0\\0\\0\\1\\0";
    std::string pixelSpacing = "0.5\\0.25";  ///< between rows, between columns
    std::string photometric = "MONOCHROME2";
    std::string rescaleSlope, rescaleIntercept, numberOfFrames;
    std::string imageType = "ORIGINAL\\PRIMARY\\AXIAL";
    std::uint16_t rows = 2, columns = 3, bitsAllocated = 16, bitsStored = 12;
    std::uint16_t pixelRepresentation = 0;
    std::string pixels = samplesOf<std::uint16_t>({1, 2, 3, 4, 5, 6});
    bool hasPixelData = true;

    std::string bytes() const;
};

/// Slice number `k` of a stack: 2 mm apart along z, samples 100 * k + 0 ... 5.
DicomSlice stackedSlice(int k);

}  // namespace adaptiso::testing
