#include <fmt/core.h>

#include <cmath>
#include <map>

#include "DicomPlanes.h"
#include "FileFault.h"
#include "HeaderText.h"

// Siemens writes all slices of an EPI volume as tiles of one image; how many there are and which
// way they stack stands in a private element, the "CSA header": a list of named items, in two
// versions (laid open in nibabel's documentation, "Siemens format DICOM with CSA header").
namespace adaptiso::detail {
namespace {

constexpr const char* kConvert = "convert it with dcm2niix first";

/// The texts of the CSA header's items by name; empty where it is damaged.
class CsaHeader {
public:
    explicit CsaHeader(std::string_view bytes)
        : bytes_(bytes, std::endian::little), isVersion2_(bytes.starts_with("SV10")) {
        if (!parse(bytes)) items_.clear();
    }

    std::vector<double> numbers(const std::string& name) const {
        std::vector<double> found;
        const auto it = items_.find(name);
        if (it == items_.end()) return found;
        for (const std::string& text : it->second) {
            const auto value = parseNumber(text);
            if (value && std::isfinite(*value)) found.push_back(*value);
        }
        return found;
    }

private:
    bool parse(std::string_view bytes) {
        constexpr std::int32_t kMostTags = 1000, kMostItems = 1000;
        constexpr std::size_t kNameBytes = 64, kTagBytes = 84, kItemBytes = 16;
        std::size_t at = isVersion2_ ? 8 : 0;
        if (at + 8 > bytes.size()) return false;
        const auto tags = bytes_.at<std::int32_t>(at);
        if (tags < 1 || tags > kMostTags) return false;
        at += 8;
        std::int64_t lengthOffset = 0;  // version 1 adds the first tag's number of items
        for (std::int32_t tag = 0; tag < tags; ++tag) {
            if (at + kTagBytes > bytes.size()) return false;
            std::string name(bytes.substr(at, kNameBytes));
            name.resize(name.find('\0') == std::string::npos ? kNameBytes : name.find('\0'));
            const auto count = bytes_.at<std::int32_t>(at + 76);
            if (count < 0 || count > kMostItems) return false;
            if (tag == 0 && !isVersion2_) lengthOffset = count;
            at += kTagBytes;
            for (std::int32_t item = 0; item < count; ++item) {
                if (at + kItemBytes > bytes.size()) return false;
                const std::int64_t length =
                    bytes_.at<std::int32_t>(at + (isVersion2_ ? 4 : 0)) - lengthOffset;
                at += kItemBytes;
                if (length < 0 || at + static_cast<std::size_t>(length) > bytes.size()) {
                    if (isVersion2_) return false;
                    break;  // version 1 ends a tag's items so
                }
                std::string text(bytes.substr(at, static_cast<std::size_t>(length)));
                text.resize(std::min(text.find('\0'), text.size()));
                if (!text.empty()) items_[name].push_back(std::move(text));
                at += (static_cast<std::size_t>(length) + 3) / 4 * 4;
            }
        }
        return true;
    }

    HeaderBytes bytes_;
    bool isVersion2_;
    std::map<std::string, std::vector<std::string>> items_;
};

}  // namespace

bool isSiemensMosaic(const DicomHeader& header) {
    return header.dataset.text(tag::kImageType).value_or("").find("MOSAIC") !=
           std::string_view::npos;
}

DicomFilePlanes mosaicPlanes(const DicomFile& dicom, const DicomPixelFormat& format,
                             const DicomPlane& whole) {
    const auto refuseMosaic = [&](std::string_view why) {
        refuse(dicom.path,
               fmt::format("is a Siemens mosaic (many slices tiled in one image) that {}", why),
               kConvert);
    };
    const CsaHeader csa(dicom.header.siemensCsa);
    const auto number = csa.numbers("NumberOfImagesInMosaic");
    const auto normal = csa.numbers("SliceNormalVector");
    const auto spacing = dicom.header.dataset.numbers(dicom.path, tag::kSpacingBetweenSlices);
    if (number.size() != 1 || normal.size() != 3) {
        refuseMosaic("does not say how its tiles stack (no CSA header)");
    }
    if (spacing.size() != 1 || !(spacing[0] > 0)) {
        refuseMosaic("does not say how far its slices are apart (no SpacingBetweenSlices)");
    }
    const auto slices = static_cast<std::int64_t>(number[0]);
    const auto tiles = static_cast<std::int64_t>(std::ceil(std::sqrt(number[0])));
    if (!(number[0] >= 1 && number[0] <= 10000) || number[0] != static_cast<double>(slices) ||
        format.columns % tiles != 0 || format.rows % tiles != 0) {
        refuseMosaic(fmt::format("can't be cut into tiles: {} slices in {} x {} pixels", number[0],
                                 format.columns, format.rows));
    }
    if (!whole.position || !whole.alongRow || !whole.alongColumn || !whole.columnStepMm) {
        refuseMosaic("does not say where it lies (position, orientation or PixelSpacing)");
    }
    const Vec3 across = cross(*whole.alongRow, *whole.alongColumn);
    const double along = dot(Vec3{normal[0], normal[1], normal[2]}, across);
    if (!(std::abs(std::abs(along) - 1) < 1e-3)) {
        refuseMosaic("stacks its slices in another direction than their normal");
    }

    DicomFilePlanes cut{format.columns / tiles, format.rows / tiles, true, {}};
    // the header's position is that of an image as large as the mosaic around the same centre
    const Vec3 first =
        *whole.position +
        *whole.columnStepMm * static_cast<double>(format.columns - cut.columns) / 2 *
            *whole.alongRow +
        *whole.rowStepMm * static_cast<double>(format.rows - cut.rows) / 2 * *whole.alongColumn;
    const Vec3 step = (along > 0 ? spacing[0] : -spacing[0]) * across;
    for (std::int64_t k = 0; k < slices; ++k) {
        DicomPlane& plane = cut.planes.emplace_back(whole);
        plane.firstColumn = k % tiles * cut.columns;
        plane.firstRow = k / tiles * cut.rows;
        plane.position = first + static_cast<double>(k) * step;
    }
    return cut;
}

}  // namespace adaptiso::detail
