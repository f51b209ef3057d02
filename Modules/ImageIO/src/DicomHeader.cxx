#include "DicomHeader.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "FileFault.h"
#include "HeaderBytes.h"
#include "HeaderText.h"
#include "Readers.h"

// DICOM PS3.5, chapter 7 (data elements, sequences) and annex A.4 (encapsulated pixel data).
namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kUndefinedLength = 0xFFFFFFFF;
constexpr std::uint64_t kPreambleBytes = 128;
constexpr DicomTag kItem = 0xFFFEE000, kItemEnd = 0xFFFEE00D, kSequenceEnd = 0xFFFEE0DD;
constexpr DicomTag kMediaStorageSopClass = 0x00020002;
constexpr int kDeepestNesting = 32;

constexpr std::array kWantedValues = {kMediaStorageSopClass,
                                      tag::kSopClass,
                                      tag::kTransferSyntax,
                                      tag::kImageType,
                                      tag::kSeriesInstanceUid,
                                      tag::kImagePosition,
                                      tag::kImageOrientation,
                                      tag::kSamplesPerPixel,
                                      tag::kPhotometric,
                                      tag::kNumberOfFrames,
                                      tag::kRows,
                                      tag::kColumns,
                                      tag::kPixelSpacing,
                                      tag::kBitsAllocated,
                                      tag::kBitsStored,
                                      tag::kHighBit,
                                      tag::kPixelRepresentation,
                                      tag::kRescaleIntercept,
                                      tag::kRescaleSlope};

constexpr std::array kWantedSequences = {tag::kModalityLutSequence,
                                         tag::kPlanePositionSequence,
                                         tag::kPlaneOrientationSequence,
                                         tag::kPixelMeasuresSequence,
                                         tag::kPixelValueTransformationSequence,
                                         tag::kSharedFunctionalGroups,
                                         tag::kPerFrameFunctionalGroups};

bool isWantedValue(DicomTag tag) {
    return std::ranges::find(kWantedValues, tag) != kWantedValues.end();
}
bool isWantedSequence(DicomTag tag) {
    return std::ranges::find(kWantedSequences, tag) != kWantedSequences.end();
}

struct Syntax {
    bool isExplicit = true;
    std::endian byteOrder = std::endian::little;
};

struct Element {
    DicomTag tag = 0;
    std::string vr;  ///< empty: implicit
    std::uint32_t length = 0;
};

class Walker {
public:
    explicit Walker(const fs::path& file)
        : file_(file), fileBytes_(requireRegularFile(file)), stream_(file, std::ios::binary) {
        if (!stream_) refuse(file_, "can't be opened for reading", "check its permissions");
    }

    DicomHeader walk() {
        findFirstElement();
        header_.dataset = walkDataset(fileBytes_, 0);
        header_.mediaStorage =
            std::string(header_.dataset.text(tag::kSopClass)
                            .value_or(metaGroup_.text(kMediaStorageSopClass).value_or("")));
        return std::move(header_);
    }

private:
    [[noreturn]] void refuseDamaged(std::string_view what) const {
        refuse(file_, fmt::format("truncated or damaged DICOM file: {}", what),
               "get the whole file again");
    }

    void require(std::uint64_t byteCount, std::uint64_t end) const {
        if (byteCount > end - position_) {
            refuseDamaged("an element's length reaches beyond its end");
        }
    }

    template <std::size_t N>
    std::array<char, N> take(std::uint64_t end) {
        require(N, end);
        std::array<char, N> bytes;
        stream_.read(bytes.data(), N);
        if (stream_.gcount() != static_cast<std::streamsize>(N)) refuseDamaged("can't be read");
        position_ += N;
        return bytes;
    }
    template <class T>
    T takeNumber(std::uint64_t end, std::endian order) {
        const auto bytes = take<sizeof(T)>(end);
        return HeaderBytes({bytes.data(), bytes.size()}, order).at<T>(0);
    }
    void seek(std::uint64_t position) {
        position_ = position;
        stream_.seekg(static_cast<std::streamoff>(position));
    }

    /// Sets syntax_: of the file meta group if there is one, else guessed from the first element.
    void findFirstElement() {
        const bool hasPreamble = [&] {
            if (fileBytes_ < kPreambleBytes + 4) return false;
            seek(kPreambleBytes);
            const auto magic = take<4>(fileBytes_);
            return std::string_view(magic.data(), 4) == "DICM";
        }();
        if (!hasPreamble) seek(0);
        if (fileBytes_ - position_ < 8) refuseDamaged("it ends before the first element");
    }

    /// A file's meta group is explicit little endian; what follows is as its transfer syntax says.
    void enterDataset() {
        isMetaGroup_ = false;
        header_.transferSyntax = std::string(metaGroup_.text(tag::kTransferSyntax).value_or(""));
        if (header_.transferSyntax.empty()) {
            syntax_.isExplicit = firstElementIsExplicit();
            header_.transferSyntax =
                syntax_.isExplicit ? "1.2.840.10008.1.2.1" : "1.2.840.10008.1.2";
        } else {
            syntax_.isExplicit = header_.transferSyntax != "1.2.840.10008.1.2";
            if (header_.transferSyntax == "1.2.840.10008.1.2.2") {
                syntax_.byteOrder = std::endian::big;
                header_.isBigEndian = true;
            }
            if (header_.transferSyntax == "1.2.840.10008.1.2.1.99") {
                refuse(file_, "unsupported transfer syntax (deflated)",
                       "save it uncompressed, e.g. with gdcmconv --raw");
            }
        }
    }

    bool firstElementIsExplicit() {
        const std::uint64_t here = position_;
        const auto bytes = take<8>(fileBytes_);
        seek(here);
        const auto isCapital = [](char c) { return c >= 'A' && c <= 'Z'; };
        return isCapital(bytes[4]) && isCapital(bytes[5]);
    }

    bool nextIsMetaGroup() {
        if (fileBytes_ - position_ < 8) return false;
        const std::uint64_t here = position_;
        const auto group = takeNumber<std::uint16_t>(fileBytes_, std::endian::little);
        seek(here);
        return group == 2;
    }

    Element takeElement(std::uint64_t end) {
        const std::endian order = isMetaGroup_ ? std::endian::little : syntax_.byteOrder;
        Element element;
        const std::uint32_t group = takeNumber<std::uint16_t>(end, order);
        element.tag = group << 16 | takeNumber<std::uint16_t>(end, order);
        if (group == 0xFFFE || !(isMetaGroup_ || syntax_.isExplicit)) {
            element.length = takeNumber<std::uint32_t>(end, order);
            return element;
        }
        const auto vr = take<2>(end);
        element.vr.assign(vr.data(), 2);
        constexpr std::string_view kLongVrs = "OB OD OF OL OV OW SQ SV UC UN UR UT UV";
        if (vr[0] < 'A' || vr[0] > 'Z' || vr[1] < 'A' || vr[1] > 'Z') {
            refuseDamaged("an element's type is no DICOM type");
        }
        if (kLongVrs.find(element.vr) != std::string_view::npos) {
            take<2>(end);
            element.length = takeNumber<std::uint32_t>(end, order);
        } else {
            element.length = takeNumber<std::uint16_t>(end, order);
        }
        return element;
    }

    DicomDataset walkDataset(std::uint64_t end, int depth) {
        if (depth > kDeepestNesting) refuseDamaged("its sequences are nested too deeply");
        DicomDataset dataset;
        if (depth == 0) {
            isMetaGroup_ = nextIsMetaGroup();
            if (!isMetaGroup_) enterDataset();
        }
        while (position_ < end) {
            if (isMetaGroup_ && !nextIsMetaGroup()) enterDataset();
            if (depth == 0 && header_.pixelData && onlyZerosRemain()) break;
            const Element element = takeElement(end);
            if (element.tag == kItemEnd || element.tag == kSequenceEnd) {
                if (depth == 0) refuseDamaged("a sequence ends that never began");
                return dataset;
            }
            takeContent(element, end, depth, isMetaGroup_ ? metaGroup_ : dataset);
        }
        return dataset;
    }

    void takeContent(const Element& element, std::uint64_t end, int depth, DicomDataset& dataset) {
        if (element.tag == tag::kPixelData) {
            DicomPixelData pixels = takePixelData(element, end);
            if (depth == 0) header_.pixelData = std::move(pixels);
            return;
        }
        const bool isUndefined = element.length == kUndefinedLength;
        if (!isUndefined) require(element.length, end);
        if (element.vr == "SQ" || isUndefined ||
            (element.vr.empty() && isWantedSequence(element.tag))) {
            const Syntax outer = syntax_;
            if (element.vr == "UN") syntax_ = {false, std::endian::little};  // PS3.5, 6.2.2
            auto items = walkSequence(isUndefined ? end : position_ + element.length, isUndefined,
                                      depth + 1);
            syntax_ = outer;
            if (isWantedSequence(element.tag)) {
                dataset.sequences[element.tag] = std::move(items);
            }
            return;
        }
        constexpr std::uint32_t kLongestValue = 1024;
        if (isWantedValue(element.tag) && element.length <= kLongestValue) {
            std::string value(element.length, '\0');
            stream_.read(value.data(), element.length);
            dataset.values[element.tag] = std::move(value);
        }
        seek(position_ + element.length);
    }

    std::vector<DicomDataset> walkSequence(std::uint64_t end, bool isUndefined, int depth) {
        if (depth > kDeepestNesting) refuseDamaged("its sequences are nested too deeply");
        std::vector<DicomDataset> items;
        while (position_ < end) {
            const Element item = takeElement(end);
            if (item.tag == kSequenceEnd && isUndefined) return items;
            if (item.tag != kItem) refuseDamaged("a sequence holds something that is no item");
            if (item.length == kUndefinedLength) {
                items.push_back(walkDataset(end, depth));
            } else {
                require(item.length, end);
                const std::uint64_t itemEnd = position_ + item.length;
                items.push_back(walkDataset(itemEnd, depth));
                if (position_ != itemEnd) refuseDamaged("an item's length is wrong");
            }
        }
        if (isUndefined) refuseDamaged("a sequence does not end");
        return items;
    }

    DicomPixelData takePixelData(const Element& element, std::uint64_t end) {
        DicomPixelData pixels;
        if (element.length != kUndefinedLength) {
            if (element.length > end - position_) {
                refuseDamaged(fmt::format("pixel data of {} bytes, of which {} are there",
                                          element.length, end - position_));
            }
            pixels.byteCount = element.length;
            seek(position_ + element.length);
            return pixels;
        }
        pixels.isEncapsulated = true;
        for (bool isOffsetTable = true;; isOffsetTable = false) {
            const Element item = takeElement(end);
            if (item.tag == kSequenceEnd) return pixels;
            if (item.tag != kItem) refuseDamaged("compressed pixel data hold no item");
            require(item.length, end);
            if (!isOffsetTable) {
                pixels.fragments.push_back({position_, item.length});
                pixels.byteCount += item.length;
            }
            seek(position_ + item.length);
        }
    }

    /// Some writers pad files with zeros.
    bool onlyZerosRemain() {
        const std::uint64_t here = position_;
        constexpr std::uint64_t kMostPadding = 1 << 16;
        const std::uint64_t left = fileBytes_ - here;
        if (left > kMostPadding) return false;
        std::string rest(left, '\1');
        stream_.read(rest.data(), static_cast<std::streamsize>(left));
        seek(here);
        return rest.find_first_not_of('\0') == std::string::npos;
    }

    fs::path file_;
    std::uint64_t fileBytes_;
    std::ifstream stream_;
    std::uint64_t position_ = 0;
    Syntax syntax_;
    bool isMetaGroup_ = false;
    DicomDataset metaGroup_;
    DicomHeader header_;
};

}  // namespace

bool looksLikeDicom(std::string_view head) {
    if (head.size() >= kPreambleBytes + 4 && head.substr(kPreambleBytes, 4) == "DICM") return true;
    // without preamble: begins with an element of group 2 or 8, little endian
    return head.size() >= 8 && (head[0] == 2 || head[0] == 8) && head[1] == 0 && head[3] == 0 &&
           ((head[4] >= 'A' && head[4] <= 'Z') || (head[6] == 0 && head[7] == 0));
}

std::optional<std::string_view> DicomDataset::text(DicomTag tag) const {
    const auto it = values.find(tag);
    if (it == values.end()) return std::nullopt;
    std::string_view value = it->second;
    value = value.substr(0, value.find('\0'));
    value = trimmed(value);
    if (value.empty()) return std::nullopt;
    return value;
}

std::vector<double> DicomDataset::numbers(const fs::path& file, DicomTag tag) const {
    std::vector<double> found;
    const auto whole = text(tag);
    if (!whole) return found;
    for (std::string_view rest = *whole;;) {
        const std::size_t cut = rest.find('\\');
        const auto value = parseNumber(rest.substr(0, cut));
        if (!value || !std::isfinite(*value)) {
            refuse(file,
                   fmt::format("damaged DICOM header: {} is not a finite number",
                               tag == tag::kPixelSpacing       ? "PixelSpacing"
                               : tag == tag::kImagePosition    ? "ImagePositionPatient"
                               : tag == tag::kImageOrientation ? "ImageOrientationPatient"
                               : tag == tag::kRescaleSlope     ? "RescaleSlope"
                               : tag == tag::kRescaleIntercept ? "RescaleIntercept"
                                                               : "a value"),
                   "get the file again");
        }
        found.push_back(*value);
        if (cut == std::string_view::npos) return found;
        rest.remove_prefix(cut + 1);
    }
}

const DicomDataset* DicomDataset::item(DicomTag sequence) const {
    const auto it = sequences.find(sequence);
    return it == sequences.end() || it->second.empty() ? nullptr : &it->second.front();
}

std::optional<std::uint16_t> DicomHeader::unsignedShort(DicomTag tag) const {
    const auto it = dataset.values.find(tag);
    if (it == dataset.values.end() || it->second.size() != 2) return std::nullopt;
    const std::endian order = isBigEndian ? std::endian::big : std::endian::little;
    return HeaderBytes(it->second, order).at<std::uint16_t>(0);
}

DicomHeader readDicomHeader(const fs::path& file) {
    return Walker(file).walk();
}

}  // namespace adaptiso::detail
