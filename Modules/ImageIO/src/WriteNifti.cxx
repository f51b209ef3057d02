#include "adaptiso/ImageIO/WriteNifti.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>
#include <memory>
#include <string>

#include "FileFault.h"
#include "NiftiTypes.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

constexpr std::int16_t kScannerCode = 1;
constexpr std::uint8_t kMillimetres = 2;

/// Rows of the affine, RAS mm.
using Rows = std::array<std::array<double, 4>, 3>;
Rows rasRows(const ImageGeometry& geometry) {
    Rows rows{};
    for (int row = 0; row < 3; ++row) {
        const double sign = row < 2 ? -1 : 1;
        for (int axis = 0; axis < 3; ++axis) {
            rows[row][axis] = sign * geometry.indexToPhysical.column[axis][row];
        }
        rows[row][3] = sign * geometry.originMm[row];
    }
    return rows;
}

bool fitsVersion1(const ImageGeometry& geometry, const Rows& rows) {
    const auto isShort = [](std::int64_t size) {
        return size <= std::numeric_limits<std::int16_t>::max();
    };
    const auto isFloat = [](double value) {
        return static_cast<double>(static_cast<float>(value)) == value;
    };
    return std::ranges::all_of(geometry.size, isShort) &&
           std::ranges::all_of(rows,
                               [&](const auto& row) { return std::ranges::all_of(row, isFloat); });
}

/// The header's bytes, in this machine's order, up to where the samples begin.
class Header {
public:
    explicit Header(std::size_t bytes) : bytes_(bytes, '\0') {}
    template <class T>
    void put(std::size_t at, T value) {
        std::memcpy(bytes_.data() + at, &value, sizeof(T));
    }
    void magic(std::size_t at, std::string_view text) {
        text.copy(bytes_.data() + at, text.size());
    }
    const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
};

template <class Size, class Real>
void putGeometry(Header& header, const ImageGeometry& geometry, const Rows& rows, std::size_t dimAt,
                 std::size_t pixdimAt, std::size_t sformAt) {
    const Vec3 spacing = geometry.spacingMm();
    header.put(dimAt, Size{3});
    header.put(pixdimAt, Real{1});
    for (std::size_t axis = 0; axis < 7; ++axis) {
        header.put(dimAt + sizeof(Size) * (axis + 1),
                   axis < 3 ? static_cast<Size>(geometry.size[axis]) : Size{1});
        header.put(pixdimAt + sizeof(Real) * (axis + 1),
                   axis < 3 ? static_cast<Real>(spacing[static_cast<int>(axis)]) : Real{1});
    }
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t n = 0; n < 4; ++n) {
            header.put(sformAt + sizeof(Real) * (4 * row + n), static_cast<Real>(rows[row][n]));
        }
    }
}

std::string headerOf(const VolumeView& volume) {
    const ImageGeometry& geometry = volume.geometry();
    const Rows rows = rasRows(geometry);
    const auto code = static_cast<std::int16_t>(
        std::ranges::find(detail::kNiftiTypes, volume.pixelType(), &detail::NiftiType::type)->code);
    const auto bits = static_cast<std::int16_t>(8 * bytesPerPixel(volume.pixelType()));
    if (fitsVersion1(geometry, rows)) {
        constexpr std::size_t kBegin = 352;
        Header header(kBegin);
        header.put(0, std::int32_t{348});
        putGeometry<std::int16_t, float>(header, geometry, rows, 40, 76, 280);
        header.put(70, code);
        header.put(72, bits);
        header.put(108, static_cast<float>(kBegin));
        header.put(112, 1.0F);  // scl_slope
        header.put(123, kMillimetres);
        header.put(254, kScannerCode);
        header.magic(344, "n+1");
        return header.bytes();
    }
    constexpr std::size_t kBegin = 544;
    Header header(kBegin);
    header.put(0, std::int32_t{540});
    header.magic(4, std::string_view("n+2\0\r\n\x1a\n", 8));
    header.put(12, code);
    header.put(14, bits);
    putGeometry<std::int64_t, double>(header, geometry, rows, 16, 104, 400);
    header.put(168, std::int64_t{kBegin});
    header.put(176, 1.0);  // scl_slope
    header.put(348, std::int32_t{kScannerCode});
    header.put(500, std::int32_t{kMillimetres});
    return header.bytes();
}

}  // namespace

void writeNifti(const VolumeView& volume, const fs::path& file) {
    const auto fail = [&] {
        const std::string why = errno != 0 ? std::strerror(errno) : "zlib fails";
        throw FileError(detail::displayName(file) + ": can't be written: " + why);
    };
    errno = 0;
    gzFile_s* const stream = gzopen(file.c_str(), "wb6");
    if (stream == nullptr) fail();
    std::unique_ptr<gzFile_s, int (*)(gzFile)> owner(stream, gzclose);
    const auto write = [&](const char* bytes, std::size_t count) {
        constexpr std::size_t kPiece = std::size_t{1} << 26;  // zlib counts in 32 bits
        for (std::size_t done = 0; done < count;) {
            const std::size_t piece = std::min(kPiece, count - done);
            if (gzwrite(stream, bytes + done, static_cast<unsigned>(piece)) <= 0) fail();
            done += piece;
        }
    };
    const std::string header = headerOf(volume);
    write(header.data(), header.size());
    write(static_cast<const char*>(volume.samples()), volume.byteCount());
    if (gzclose(owner.release()) != Z_OK) fail();
}

}  // namespace adaptiso
