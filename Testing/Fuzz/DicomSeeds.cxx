// DICOM files, several in one seed (FuzzDicom.cxx). Codestreams are headers alone: what GDCM would
// decode is not fuzzed.

#include "Seeds.h"
#include "Unit/ImageIO/DicomBuilder.h"
#include "Unit/ImageIO/Fixtures.h"

namespace adaptiso::fuzz {
namespace {

using namespace testing;

constexpr int kColumns = 4, kRows = 3, kFrames = 3;
constexpr const char* kJpegLossless = "1.2.840.10008.1.2.4.70";
constexpr const char* kJpeg2000 = "1.2.840.10008.1.2.4.90";

DicomBuilder slice(double heightMm) {
    return fieldSlice(tellTale, {1, 0.2 * heightMm, heightMm});
}

std::string stack(const std::vector<double>& heightsMm, const char* syntax) {
    std::string files;
    for (const double height : heightsMm) files += slice(height).file(syntax);
    return files;
}

/// One frame of zeros: each of two segments is a run of 12.
std::string rleFrame() {
    std::string frame(64, '\0');
    put<std::uint32_t>(frame, 0, 2);
    put<std::uint32_t>(frame, 4, 64);
    put<std::uint32_t>(frame, 8, 66);
    return frame + std::string("\xF5\0\xF5\0", 4);
}

std::string jpegHeader() {
    std::string stream(
        "\xFF\xD8\xFF\xC3\0\x0B\x10\0\x03\0\x04\x01\x01\x11\0\xFF\xDA\0\x08\x01\x01"
        "\0\x01\0\0",
        25);
    return stream + std::string(15, '\0');
}

std::string jpeg2000Header() {
    std::string stream(44, '\0');
    stream.replace(0, 6, std::string("\xFF\x4F\xFF\x51\0\x29", 6));
    put<std::uint32_t>(stream, 8, kColumns, std::endian::big);
    put<std::uint32_t>(stream, 12, kRows, std::endian::big);
    put<std::uint16_t>(stream, 40, 1, std::endian::big);
    stream[42] = 15;
    return stream;
}

std::string compressedStack(const char* syntax, const std::vector<std::string>& fragments) {
    std::string files;
    for (const double height : {0., 2.}) files += slice(height).fragments(fragments).file(syntax);
    return files;
}

DicomBuilder enhanced() {
    DicomBuilder orientation, measures, rescale, shared;
    orientation.text(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
    measures.text(0x00280030, "DS", "0.75\\0.5");
    rescale.text(0x00281052, "DS", "-1024").text(0x00281053, "DS", "1");
    shared.sequence(0x00209116, {orientation})
        .sequence(0x00289110, {measures})
        .sequence(0x00289145, {rescale});
    std::vector<DicomBuilder> groups;
    for (int n = 0; n < kFrames; ++n) {
        DicomBuilder plane, group;
        plane.text(0x00200032, "DS", dicomText({1, 2, 2.0 * n}));
        groups.push_back(group.sequence(0x00209113, {plane}));
    }
    DicomBuilder image = dicomImage(kColumns, kRows);
    image.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2.1")
        .text(0x00280008, "IS", std::to_string(kFrames))
        .sequence(0x52009229, {shared})
        .sequence(0x52009230, groups);
    return image;
}

/// Two segments of one bit a pixel; of the first a frame is left out.
std::string segmentation() {
    struct Frame {
        double height;
        std::uint16_t segment;
    };
    std::vector<DicomBuilder> groups;
    for (const auto& [height, segment] : {Frame{0, 1}, Frame{4, 1}, Frame{2, 2}, Frame{4, 2}}) {
        DicomBuilder plane, identification, group;
        plane.text(0x00200032, "DS", dicomText({1, 2, height}));
        identification.us(0x0062000B, segment);
        groups.push_back(
            group.sequence(0x00209113, {plane}).sequence(0x0062000A, {identification}));
    }
    DicomBuilder orientation, measures, shared, label;
    orientation.text(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
    measures.text(0x00280030, "DS", "0.75\\0.5").text(0x00180088, "DS", "2");
    shared.sequence(0x00209116, {orientation}).sequence(0x00289110, {measures});
    label.us(0x00620004, 1).text(0x00620005, "LO", "Liver");
    DicomBuilder image = dicomImage(kColumns, kRows);
    return image.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.66.4")
        .text(0x00280008, "IS", "4")
        .us(0x00280100, 1)
        .us(0x00280101, 1)
        .us(0x00280102, 0)
        .sequence(0x00620002, {label})
        .sequence(0x52009229, {shared})
        .sequence(0x52009230, groups)
        .bytes(0x7FE00010, "OB", std::string(6, '\x5A'))
        .file();
}

/// Passes that times tell apart, and headers that count more slices than there are.
std::string passes() {
    std::string files;
    for (const char* time : {"120000", "120030.5"}) {
        for (const double height : {0., 2.}) {
            files += slice(height)
                         .text(0x00080018, "UI", "1.2.9")
                         .text(0x00080032, "TM", time)
                         .text(0x00201002, "IS", "9")
                         .text(0x00200105, "IS", "3")
                         .us(0x00540081, 3)
                         .file();
        }
    }
    return files;
}

std::string mosaicCsa() {
    const auto tag = [](std::string name, const std::vector<std::string>& values) {
        name.resize(64, '\0');
        const auto count = static_cast<std::int32_t>(values.size());
        std::string bytes = name + bytesOf(count) + std::string("FD\0\0", 4) +
                            bytesOf(std::int32_t{4}) + bytesOf(count) + bytesOf(std::int32_t{77});
        for (const std::string& value : values) {
            const auto length = static_cast<std::int32_t>(value.size());
            for (const std::int32_t n : {length, length, 77, length}) bytes += bytesOf(n);
            bytes += value + std::string((4 - value.size() % 4) % 4, '\0');
        }
        return bytes;
    };
    return std::string("SV10\4\3\2\1", 8) + bytesOf(std::uint32_t{2}) + bytesOf(std::uint32_t{77}) +
           tag("NumberOfImagesInMosaic", {"4"}) + tag("SliceNormalVector", {"0", "0", "1"});
}

std::string mosaic() {
    DicomBuilder image = dicomImage(2 * kColumns, 2 * kRows);
    placeDicom(image, {1, 2, 3});
    image.text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\M\\ND\\MOSAIC")
        .text(0x00180088, "DS", "2.5")
        .text(0x00290010, "LO", "SIEMENS CSA HEADER")
        .bytes(0x00291010, "OB", mosaicCsa())
        .pixels(std::vector<std::uint16_t>(4 * kColumns * kRows, 9));
    return image.file();
}

/// A DICOMDIR that names the two slices behind it as FuzzDicom.cxx does.
std::string directory() {
    std::vector<DicomBuilder> records(1);
    records[0].text(0x00041430, "CS", "PATIENT");
    for (const char* name : {"1", "2"}) {
        records.emplace_back().text(0x00041430, "CS", "IMAGE").text(0x00041500, "CS", name);
    }
    DicomBuilder builder;
    builder.text(0x00080016, "UI", "1.2.840.10008.1.3.10").sequence(0x00041220, records);
    return builder.file() + stack({0, 2}, kExplicitLittleEndian);
}

/// More pixels than the header says, and slices that disagree.
void addContradictions(Seeds& seeds) {
    const std::string pixels = samplesOf(std::vector<std::uint16_t>(kColumns * kRows, 7));
    std::string padded, mixed, rescaled;
    for (const int k : {0, 1}) {
        const double height = 2.0 * k;
        const std::string extra = k == 0 ? std::string("\1\2", 2) : std::string(2048, '\0');
        padded += slice(height).bytes(0x7FE00010, "OW", pixels + extra).file(kDeflatedLittleEndian);
        mixed += slice(height).text(0x00280004, "CS", k ? "MONOCHROME1" : "MONOCHROME2").file();
        rescaled += slice(height)
                        .text(0x00281052, "DS", "-3e38")
                        .text(0x00281053, "DS", k ? "1e34" : "2.5")
                        .text(0x00281054, "LO", "HU")
                        .text(0x00541001, "CS", "BQML")
                        .us(0x00280103, static_cast<std::uint16_t>(k))
                        .file();
    }
    for (const std::string& files : {padded, mixed, rescaled}) seeds.add("dicom", files);
    seeds.add("dicom", compressedStack(kRleLossless, {rleFrame(), rleFrame()}));
    seeds.add("dicom", compressedStack(kJpeg2000, {jpeg2000Header(), jpeg2000Header()}));
}

}  // namespace

void addDicomSeeds(Seeds& seeds) {
    for (const char* syntax : {kExplicitLittleEndian, kImplicitLittleEndian, kExplicitBigEndian,
                               kDeflatedLittleEndian}) {
        seeds.add("dicom", stack({0, 2, 4}, syntax));
    }
    seeds.add("dicom", stack({0, 2, 5, 6}, kExplicitLittleEndian));  // uneven
    std::string acquisitions;
    for (const char* number : {"1", "2"}) {
        for (const double height : {0., 2.}) {
            acquisitions += slice(height).text(0x00200012, "IS", number).file();
        }
    }
    seeds.add("dicom", acquisitions);
    seeds.add("dicom", compressedStack(kRleLossless, {rleFrame()}));
    seeds.add("dicom", compressedStack(kJpegLossless, {jpegHeader()}));
    seeds.add("dicom", compressedStack(kJpeg2000, {jpeg2000Header()}));
    const std::vector<std::uint16_t> samples(kFrames * kColumns * kRows, 7);
    seeds.add("dicom", enhanced().pixels(samples).file());
    seeds.add("dicom", enhanced()
                           .fragments({rleFrame(), rleFrame(), rleFrame()}, {0, 76, 152})
                           .file(kRleLossless));
    seeds.add("dicom", mosaic());
    seeds.add("dicom", segmentation());
    seeds.add("dicom", passes());
    seeds.add("dicom", directory());
    addContradictions(seeds);
}

}  // namespace adaptiso::fuzz
