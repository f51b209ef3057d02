#include "DicomBuilder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "Fixtures.h"

namespace adaptiso::testing {
namespace {

constexpr double kColumnStepMm = 0.5, kRowStepMm = 0.75;
constexpr std::uint32_t kUndefined = 0xFFFFFFFF;

std::string tagBytes(std::uint32_t tag, std::endian order) {
    return bytesOf(static_cast<std::uint16_t>(tag >> 16), order) +
           bytesOf(static_cast<std::uint16_t>(tag & 0xFFFF), order);
}

std::string item(const std::string& content, std::endian order) {
    return tagBytes(0xFFFEE000, order) +
           bytesOf(static_cast<std::uint32_t>(content.size()), order) + content;
}

std::string head(std::uint32_t tag, const std::string& vr, std::uint32_t length, bool isExplicit,
                 std::endian order) {
    std::string bytes = tagBytes(tag, order);
    if (!isExplicit) return bytes + bytesOf(length, order);
    const bool isLong = vr == "OB" || vr == "OW" || vr == "SQ" || vr == "UN" || vr == "OF";
    bytes += vr;
    return isLong ? bytes + std::string(2, '\0') + bytesOf(length, order)
                  : bytes + bytesOf(static_cast<std::uint16_t>(length), order);
}

std::string swapped(std::string bytes, std::size_t wordBytes) {
    for (std::size_t at = 0; at + wordBytes <= bytes.size(); at += wordBytes) {
        std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                     bytes.begin() + static_cast<std::ptrdiff_t>(at + wordBytes));
    }
    return bytes;
}

}  // namespace

DicomBuilder& DicomBuilder::text(std::uint32_t tag, const char* vr, const std::string& value) {
    if (value.empty()) return without(tag);
    return bytes(tag, vr,
                 value.size() % 2 ? value + (vr == std::string("UI") ? '\0' : ' ') : value);
}

DicomBuilder& DicomBuilder::us(std::uint32_t tag, std::uint16_t value) {
    elements_[tag] = {"US", bytesOf(value), 2, {}, {}};
    return *this;
}
DicomBuilder& DicomBuilder::ul(std::uint32_t tag, std::uint32_t value) {
    elements_[tag] = {"UL", bytesOf(value), 4, {}, {}};
    return *this;
}
DicomBuilder& DicomBuilder::fd(std::uint32_t tag, double value) {
    elements_[tag] = {"FD", bytesOf(value), 8, {}, {}};
    return *this;
}
DicomBuilder& DicomBuilder::sequence(std::uint32_t tag, std::vector<DicomBuilder> items) {
    elements_[tag] = {"SQ", "", 1, std::move(items), {}};
    return *this;
}
DicomBuilder& DicomBuilder::pixels(const std::vector<std::uint16_t>& samples) {
    elements_[0x7FE00010] = {"OW", samplesOf(samples), 2, {}, {}};
    return *this;
}
DicomBuilder& DicomBuilder::bytes(std::uint32_t tag, const char* vr, const std::string& value) {
    elements_[tag] = {vr, value, 1, {}, {}};
    return *this;
}
DicomBuilder& DicomBuilder::fragments(const std::vector<std::string>& fragments,
                                      const std::vector<std::uint32_t>& offsets) {
    elements_[0x7FE00010] = {"OB", samplesOf(offsets), 1, {}, fragments};
    return *this;
}
DicomBuilder& DicomBuilder::without(std::uint32_t tag) {
    elements_.erase(tag);
    return *this;
}

std::string DicomBuilder::dataset(const std::string& transferSyntax) const {
    const bool isExplicit = transferSyntax != kImplicitLittleEndian;
    const std::endian order =
        transferSyntax == kExplicitBigEndian ? std::endian::big : std::endian::little;
    std::string out;
    for (const auto& [tag, element] : elements_) {
        if (!element.fragments.empty()) {
            out += head(tag, "OB", kUndefined, isExplicit, order) + item(element.bytes, order);
            for (const std::string& fragment : element.fragments) out += item(fragment, order);
            out += tagBytes(0xFFFEE0DD, order) + std::string(4, '\0');
            continue;
        }
        std::string content =
            order == std::endian::big ? swapped(element.bytes, element.wordBytes) : element.bytes;
        for (const DicomBuilder& one : element.items) {
            content += item(one.dataset(transferSyntax), order);
        }
        out +=
            head(tag, element.vr, static_cast<std::uint32_t>(content.size()), isExplicit, order) +
            content;
    }
    return out;
}

std::string DicomBuilder::file(const std::string& transferSyntax) const {
    DicomBuilder meta;
    meta.text(0x00020010, "UI", transferSyntax);
    const std::string data = dataset(transferSyntax);
    return std::string(128, '\0') + "DICM" + meta.dataset(kExplicitLittleEndian) +
           (transferSyntax == kDeflatedLittleEndian ? rawDeflated(data) : data);
}

DicomBuilder dicomImage(int columns, int rows) {
    DicomBuilder image;
    image.text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\AXIAL")
        .text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2")
        .text(0x00080060, "CS", "CT")
        .text(0x0008103E, "LO", "Secret^Description")
        .text(0x00100010, "PN", "Secret^Patient")
        .text(0x0020000E, "UI", "1.2.3.4")
        .us(0x00280002, 1)
        .text(0x00280004, "CS", "MONOCHROME2")
        .us(0x00280010, static_cast<std::uint16_t>(rows))
        .us(0x00280011, static_cast<std::uint16_t>(columns))
        .us(0x00280100, 16)
        .us(0x00280101, 16)
        .us(0x00280102, 15)
        .us(0x00280103, 0);
    return image;
}

std::string dicomText(const Vec3& v) {
    char text[100];
    std::snprintf(text, sizeof text, "%.12g\\%.12g\\%.12g", v.x, v.y, v.z);
    return text;
}

void placeDicom(DicomBuilder& image, const Vec3& position, const Vec3& alongRow,
                const Vec3& alongColumn) {
    image.text(0x00200032, "DS", dicomText(position))
        .text(0x00200037, "DS", dicomText(alongRow) + "\\" + dicomText(alongColumn))
        .text(0x00280030, "DS", "0.75\\0.5");
}

std::vector<std::uint16_t> sampleSlice(const Field& field, int columns, int rows,
                                       const Vec3& position, const Vec3& alongRow,
                                       const Vec3& alongColumn) {
    std::vector<std::uint16_t> samples;
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const Vec3 point =
                position + i * kColumnStepMm * alongRow + j * kRowStepMm * alongColumn;
            samples.push_back(static_cast<std::uint16_t>(std::lround(field(point))));
        }
    }
    return samples;
}

DicomBuilder fieldSlice(const Field& field, const Vec3& position, const Vec3& alongRow,
                        const Vec3& alongColumn) {
    DicomBuilder image = dicomImage(kColumns, kRows);
    placeDicom(image, position, alongRow, alongColumn);
    image.pixels(sampleSlice(field, kColumns, kRows, position, alongRow, alongColumn));
    return image;
}

double tellTale(const Vec3& p) {
    return 20000 + 4 * p.x + 60 * p.y + 900 * p.z;
}

void expectField(const VolumeView& volume, const Field& field, double tolerance) {
    dispatchPixelType(volume, [&](const auto& view) {
        const auto& [nx, ny, nz] = view.geometry.size;
        for (std::int64_t k = 0; k < nz; ++k) {
            for (std::int64_t j = 0; j < ny; ++j) {
                for (std::int64_t i = 0; i < nx; ++i) {
                    const Vec3 point = view.geometry.toPhysical(
                        {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
                    ASSERT_NEAR(static_cast<double>(view.at(i, j, k)), field(point),
                                tolerance + 1e-9)  // doubles' rounding
                        << i << ' ' << j << ' ' << k;
                }
            }
        }
    });
}

}  // namespace adaptiso::testing
