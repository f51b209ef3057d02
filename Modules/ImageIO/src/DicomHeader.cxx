#include "DicomHeader.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "DicomBytes.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "Readers.h"
#include "adaptiso/Core/Surplus.h"

// DICOM PS3.5, chapter 7 (data elements, sequences) and annex A.4 (encapsulated pixel data).
namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kUndefinedLength = 0xFFFFFFFF;
constexpr std::uint64_t kPreambleBytes = 128;
constexpr DicomTag kItem = 0xFFFEE000, kItemEnd = 0xFFFEE00D, kSequenceEnd = 0xFFFEE0DD;
constexpr int kDeepestNesting = 32;
constexpr std::string_view kImplicitLittleEndian = "1.2.840.10008.1.2";
constexpr std::string_view kExplicitLittleEndian = "1.2.840.10008.1.2.1";
constexpr std::string_view kDeflated = "1.2.840.10008.1.2.1.99";
constexpr std::string_view kBigEndian = "1.2.840.10008.1.2.2";

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
    Walker(const fs::path& file, bool keepsDescription)
        : file_(file), bytes_(file), keepsDescription_(keepsDescription) {}

    DicomHeader walk() {
        findFirstElement();
        header_.dataset = walkDataset(kToTheEnd, 0);
        header_.mediaStorage =
            std::string(header_.dataset.text(tag::kSopClass)
                            .value_or(metaGroup_.text(tag::kMediaStorageSopClass).value_or("")));
        return std::move(header_);
    }

private:
    /// Bytes of the data set itself: their length changes where it turns out to be deflated.
    static constexpr std::uint64_t kToTheEnd = ~std::uint64_t{0};

    std::uint64_t limit(std::uint64_t end) const { return std::min(end, bytes_.size()); }

    [[noreturn]] void refuseDamaged(std::string_view what) const {
        refuse(file_, fmt::format("truncated or damaged DICOM file: {}", what),
               "get the whole file again");
    }

    void require(std::uint64_t byteCount, std::uint64_t end) const {
        if (byteCount > limit(end) - position_) {
            refuseDamaged("an element's length reaches beyond its end");
        }
    }

    template <std::size_t N>
    std::array<char, N> take(std::uint64_t end) {
        require(N, end);
        std::array<char, N> bytes;
        bytes_.read(position_, bytes.data(), N);
        position_ += N;
        return bytes;
    }
    template <class T>
    T takeNumber(std::uint64_t end, std::endian order) {
        const auto bytes = take<sizeof(T)>(end);
        return HeaderBytes({bytes.data(), bytes.size()}, order).at<T>(0);
    }
    std::string peek(std::uint64_t byteCount) {
        std::string bytes(byteCount, '\0');
        bytes_.read(position_, bytes.data(), byteCount);
        return bytes;
    }

    /// Sets syntax_: of the file meta group if there is one, else guessed from the first element.
    void findFirstElement() {
        position_ = kPreambleBytes;
        const bool hasPreamble = bytes_.size() >= kPreambleBytes + 4 && peek(4) == "DICM";
        position_ = hasPreamble ? kPreambleBytes + 4 : 0;
        if (bytes_.size() - position_ < 8) refuseDamaged("it ends before the first element");
    }

    /// A file's meta group is explicit little endian; what follows is as its transfer syntax says.
    void enterDataset() {
        isMetaGroup_ = false;
        header_.transferSyntax = std::string(metaGroup_.text(tag::kTransferSyntax).value_or(""));
        if (header_.transferSyntax.empty()) {
            syntax_.isExplicit = firstElementIsExplicit();
            header_.transferSyntax =
                syntax_.isExplicit ? kExplicitLittleEndian : kImplicitLittleEndian;
            return;
        }
        syntax_.isExplicit = header_.transferSyntax != kImplicitLittleEndian;
        if (header_.transferSyntax == kBigEndian) {
            syntax_.byteOrder = std::endian::big;
            header_.isBigEndian = true;
        }
        if (header_.transferSyntax == kDeflated) {
            header_.deflatedFrom = position_;
            bytes_.inflateFrom(position_);
            position_ = 0;
        }
    }

    bool firstElementIsExplicit() {
        if (bytes_.size() - position_ < 8) return true;
        const std::string bytes = peek(8);
        const auto isCapital = [](char c) { return c >= 'A' && c <= 'Z'; };
        return isCapital(bytes[4]) && isCapital(bytes[5]);
    }

    bool nextIsMetaGroup() {
        if (bytes_.size() - position_ < 8) return false;
        return HeaderBytes(peek(2), std::endian::little).at<std::uint16_t>(0) == 2;
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
        while (position_ < limit(end)) {
            if (isMetaGroup_ && !nextIsMetaGroup()) enterDataset();
            if (depth == 0 && header_.pixelData && isBehindDataset()) break;
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
            if (depth == 0 && header_.pixelData) refuseDamaged("it holds pixel data twice");
            if (depth == 0) header_.pixelData = std::move(pixels);
            return;
        }
        if (element.tag == tag::kFloatPixelData || element.tag == tag::kDoublePixelData) {
            header_.hasFloatPixelData = true;
        }
        const bool isUndefined = element.length == kUndefinedLength;
        if (!isUndefined) require(element.length, end);
        if (element.tag == tag::kExtendedOffsetTable && depth == 0 && !isUndefined) {
            extendedOffsets_ = takeOffsets<std::uint64_t>(element.length);
        }
        if (element.vr == "SQ" || isUndefined ||
            ((element.vr.empty() || element.vr == "UN") && isWantedDicomSequence(element.tag))) {
            const Syntax outer = syntax_;
            if (element.vr == "UN") syntax_ = {false, std::endian::little};  // PS3.5, 6.2.2
            auto items = walkSequence(isUndefined ? end : position_ + element.length, isUndefined,
                                      depth + 1);
            syntax_ = outer;
            if (isWantedDicomSequence(element.tag)) {
                dataset.sequences[element.tag] = std::move(items);
            }
            return;
        }
        takeValue(element, dataset);
        position_ += element.length;
    }

    void takeValue(const Element& element, DicomDataset& dataset) {
        constexpr std::uint32_t kLongestValue = 1024;
        constexpr std::uint32_t kLongestCsa = 1 << 20;
        const std::endian order = isMetaGroup_ ? std::endian::little : syntax_.byteOrder;
        if (isSiemensCsa(element, dataset) && element.length <= kLongestCsa) {
            header_.siemensCsa = peek(element.length);
        }
        if (element.length > kLongestValue) return;
        if (const auto kind = wantedDicomValue(element.tag)) {
            dataset.values[element.tag] = dicomText(peek(element.length), *kind, order);
        } else if (element.tag == tag::kSeriesDescription && keepsDescription_) {
            header_.seriesDescription = peek(element.length);
        } else if ((element.tag & 0xFF01FFFF) == tag::kOverlayBitPosition) {
            const std::string bit = dicomText(peek(element.length), DicomValueKind::UInt16, order);
            if (bit != "0") header_.hasOverlayInPixels = true;
        } else if (isPrivateCreator(element.tag)) {
            dataset.values[element.tag] = peek(element.length);
        }
    }

    static bool isPrivateCreator(DicomTag tag) { return tag >= 0x00290010 && tag <= 0x002900FF; }

    /// Element 10 of the block that the creator "SIEMENS CSA HEADER" has reserved, of a mosaic.
    static bool isSiemensCsa(const Element& element, const DicomDataset& dataset) {
        if (element.tag >> 16 != 0x0029 || (element.tag & 0xFF) != 0x10) return false;
        const DicomTag creator = 0x00290000 | (element.tag >> 8 & 0xFF);
        return dataset.text(creator).value_or("") == "SIEMENS CSA HEADER" &&
               dataset.text(tag::kImageType).value_or("").find("MOSAIC") != std::string_view::npos;
    }

    std::vector<DicomDataset> walkSequence(std::uint64_t end, bool isUndefined, int depth) {
        if (depth > kDeepestNesting) refuseDamaged("its sequences are nested too deeply");
        std::vector<DicomDataset> items;
        while (position_ < limit(end)) {
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
            const std::uint64_t there = limit(end) - position_;
            if (element.length > there) {
                refuseDamaged(fmt::format("pixel data of {} bytes, of which {} are there",
                                          element.length, there));
            }
            pixels.isWords = element.vr == "OW";
            pixels.offset = position_;
            pixels.byteCount = element.length;
            position_ += element.length;
            return pixels;
        }
        pixels.isEncapsulated = true;
        pixels.frameOffsets = std::move(extendedOffsets_);
        for (bool isOffsetTable = true;; isOffsetTable = false) {
            const Element item = takeElement(end);
            if (item.tag == kSequenceEnd) return pixels;
            if (item.tag != kItem) refuseDamaged("compressed pixel data hold no item");
            require(item.length, end);
            if (!isOffsetTable) {
                pixels.fragments.push_back({position_, item.length});
                pixels.byteCount += item.length;
            } else if (pixels.frameOffsets.empty()) {
                pixels.frameOffsets = takeOffsets<std::uint32_t>(item.length);
            }
            position_ += item.length;
        }
    }

    template <class T>
    std::vector<std::uint64_t> takeOffsets(std::uint32_t byteCount) {
        const std::string table = peek(byteCount);
        std::vector<std::uint64_t> offsets;
        for (std::size_t at = 0; at + sizeof(T) <= table.size(); at += sizeof(T)) {
            offsets.push_back(HeaderBytes(table, std::endian::little).at<T>(at));
        }
        return offsets;
    }

    /// True behind the last element of the data set: some writers pad files with zeros, or leave
    /// there what the file held before. Pixel data are followed by private groups, signatures and
    /// padding (PS3.6), in ascending order (PS3.5, 7.1).
    /// \throws FileError  another DICOM file begins there
    bool isBehindDataset() {
        const std::uint64_t left = bytes_.size() - position_;
        if (left <= kMostPadding && areZeros(peek(left))) return true;
        if (left >= 8) {
            const std::string bytes = peek(8);
            const HeaderBytes head(bytes, syntax_.byteOrder);
            const unsigned group = head.at<std::uint16_t>(0), pixelGroup = tag::kPixelData >> 16;
            const bool isLater =
                group > pixelGroup ? group % 2 == 1 || group >= 0xFFFA : group == pixelGroup;
            const bool isItem = group == kItem >> 16;  // which has no type
            const auto length = head.at<std::uint32_t>(4);
            const bool isElement = syntax_.isExplicit
                                       ? firstElementIsExplicit()
                                       : length == kUndefinedLength || length <= left - 8;
            if (isLater && (isItem || isElement)) return false;
        }
        if (left >= kPreambleBytes + 4 && peek(kPreambleBytes + 4).ends_with("DICM")) {
            refuse(file_, "holds another DICOM file behind its data set", "split the two files");
        }
        header_.bytesBehind = left;
        return true;
    }

    fs::path file_;
    DicomBytes bytes_;
    bool keepsDescription_;
    std::uint64_t position_ = 0;
    Syntax syntax_;
    bool isMetaGroup_ = false;
    DicomDataset metaGroup_;
    std::vector<std::uint64_t> extendedOffsets_;
    DicomHeader header_;
};

}  // namespace

bool looksLikeDicom(std::string_view head) {
    if (head.size() >= kPreambleBytes + 4 && head.substr(kPreambleBytes, 4) == "DICM") return true;
    // without preamble: begins with an element of group 2 or 8, little endian
    return head.size() >= 8 && (head[0] == 2 || head[0] == 8) && head[1] == 0 && head[3] == 0 &&
           ((head[4] >= 'A' && head[4] <= 'Z') || (head[6] == 0 && head[7] == 0));
}

DicomHeader readDicomHeader(const fs::path& file, bool keepsDescription) {
    return Walker(file, keepsDescription).walk();
}

}  // namespace adaptiso::detail
