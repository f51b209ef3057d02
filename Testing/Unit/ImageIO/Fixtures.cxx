#include "Fixtures.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <atomic>
#include <fstream>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace fs = std::filesystem;

namespace {

std::string deflated(std::string_view bytes, int windowBits) {
    z_stream stream{};
    EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, windowBits, 8, Z_DEFAULT_STRATEGY), Z_OK);
    std::string out(deflateBound(&stream, bytes.size()) + 64, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

std::string element(std::uint16_t group, std::uint16_t number, std::string_view vr,
                    std::string value) {
    if (value.size() % 2) value += vr == "UI" ? '\0' : ' ';
    std::string bytes = bytesOf(group) + bytesOf(number) + std::string(vr);
    if (vr == "OW" || vr == "OB" || vr == "SQ") {
        bytes += std::string(2, '\0') + bytesOf(static_cast<std::uint32_t>(value.size()));
    } else {
        bytes += bytesOf(static_cast<std::uint16_t>(value.size()));
    }
    return bytes + value;
}

std::string optionalText(std::uint16_t group, std::uint16_t number, std::string_view vr,
                         const std::string& value) {
    return value.empty() ? std::string() : element(group, number, vr, value);
}

}  // namespace

TempFolder::TempFolder() {
    static std::atomic<int> number{0};
    path_ = fs::path(::testing::TempDir()) /
            ("adaptiso-imageio-" + std::to_string(::getpid()) + "-" + std::to_string(number++));
    fs::create_directories(path_);
}

TempFolder::~TempFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

fs::path writeFile(const fs::path& file, std::string_view bytes) {
    std::ofstream out(file, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    EXPECT_TRUE(out.good()) << file;
    return file;
}

std::string gzipped(std::string_view bytes) {
    return deflated(bytes, MAX_WBITS + 16);
}
std::string zlibbed(std::string_view bytes) {
    return deflated(bytes, MAX_WBITS);
}

std::string rawDeflated(std::string_view bytes) {
    return deflated(bytes, -MAX_WBITS);
}

std::string refusalOf(const fs::path& input, const ReadOptions& options) {
    try {
        readVolume(input, options);
    } catch (const FileError& error) {
        return error.what();
    }
    ADD_FAILURE() << input << " was read, must be refused";
    return {};
}

void expectRefusal(const fs::path& input, std::string_view fault, const ReadOptions& options) {
    const std::string message = refusalOf(input, options);
    EXPECT_TRUE(message.starts_with(input.native())) << message;
    EXPECT_NE(message.find(fault), std::string::npos) << message << "\nwanted: " << fault;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

void expectNear(const Vec3& actual, const Vec3& expected, double toleranceMm) {
    EXPECT_LE(norm(actual - expected), toleranceMm)
        << "(" << actual.x << ", " << actual.y << ", " << actual.z << ") instead of (" << expected.x
        << ", " << expected.y << ", " << expected.z << ")";
}

std::string NiftiFile::header() const {
    std::string h(352, '\0');
    put<std::int32_t>(h, 0, 348, order);
    for (std::size_t i = 0; i < 8; ++i) {
        put(h, 40 + 2 * i, dim[i], order);
        put(h, 76 + 4 * i, pixdim[i], order);
    }
    put(h, 70, datatype, order);
    put(h, 72, bitpix, order);
    put(h, 108, dataOffset, order);
    put(h, 112, slope, order);
    put(h, 116, intercept, order);
    h[123] = static_cast<char>(units);
    put(h, 252, qformCode, order);
    put(h, 254, sformCode, order);
    for (std::size_t i = 0; i < 3; ++i) {
        put(h, 256 + 4 * i, quaternion[i], order);
        put(h, 268 + 4 * i, qoffset[i], order);
    }
    for (std::size_t i = 0; i < 12; ++i) put(h, 280 + 4 * i, sform[i], order);
    h.replace(344, magic.size(), magic);
    return h;
}

std::string DicomSlice::bytes() const {
    const std::string meta = element(0x0002, 0x0010, "UI", "1.2.840.10008.1.2.1");
    std::string b = std::string(128, '\0') + "DICM" +
                    element(0x0002, 0x0000, "UL", bytesOf(static_cast<std::uint32_t>(meta.size())));
    b += meta;
    b += element(0x0008, 0x0008, "CS", imageType);
    b += element(0x0008, 0x0016, "UI", sopClass);
    b += element(0x0008, 0x0018, "UI", "1.2.3.4.5");
    b += element(0x0010, 0x0010, "PN", "Secret^Patient");
    b += optionalText(0x0020, 0x000E, "UI", seriesUid);
    b += optionalText(0x0020, 0x0032, "DS", position);
    b += optionalText(0x0020, 0x0037, "DS", orientation);
    b += element(0x0028, 0x0002, "US", bytesOf<std::uint16_t>(1));
    b += element(0x0028, 0x0004, "CS", photometric);
    b += optionalText(0x0028, 0x0008, "IS", numberOfFrames);
    b += element(0x0028, 0x0010, "US", bytesOf(rows));
    b += element(0x0028, 0x0011, "US", bytesOf(columns));
    b += optionalText(0x0028, 0x0030, "DS", pixelSpacing);
    b += element(0x0028, 0x0100, "US", bytesOf(bitsAllocated));
    b += element(0x0028, 0x0101, "US", bytesOf(bitsStored));
    b += element(0x0028, 0x0102, "US", bytesOf(static_cast<std::uint16_t>(bitsStored - 1)));
    b += element(0x0028, 0x0103, "US", bytesOf(pixelRepresentation));
    b += optionalText(0x0028, 0x1052, "DS", rescaleIntercept);
    b += optionalText(0x0028, 0x1053, "DS", rescaleSlope);
    if (hasPixelData) b += element(0x7FE0, 0x0010, "OW", pixels);
    return b;
}

DicomSlice stackedSlice(int k) {
    DicomSlice slice;
    slice.position = "10\\20\\" + std::to_string(30 + 2 * k);
    std::vector<std::uint16_t> samples;
    for (int i = 0; i < 6; ++i) samples.push_back(static_cast<std::uint16_t>(100 * k + i));
    slice.pixels = samplesOf(samples);
    return slice;
}

}  // namespace adaptiso::testing
