#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string>

#include "ByteSource.h"
#include "DicomHeader.h"
#include "FileFault.h"
#include "GdcmDecoder.h"
#include "HeaderBytes.h"
#include "HeaderText.h"
#include "Readers.h"
#include "Samples.h"

// A classic series (a file a slice) and an enhanced multi-frame file are one thing here: a list of
// planes, each with its own place. GDCM decodes the stored samples; rescale (PS3.3, C.11.1) and
// geometry (PS3.3, C.7.6.2.1.1 and C.7.6.16) are done here, because itk::ImageSeriesReader
// straightens tilt, accepts gaps and takes one slice's rescale for all.
namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr double kLargestMisplacementMm = 0.05;  // readVolume's promise on physical coordinates
constexpr double kSameDirection = 1e-4;          // 0.025 mm across a 250 mm field of view

struct DicomFile {
    fs::path path;
    DicomHeader header;
};

/// Where one slice or frame lies, as its header says; what is missing stays empty.
struct Plane {
    std::size_t file = 0;
    std::int64_t frame = 0;
    std::optional<Vec3> position;               ///< centre of the first voxel, LPS mm
    std::optional<Vec3> alongRow, alongColumn;  ///< unit vectors
    std::optional<double> columnStepMm, rowStepMm;
    double slope = 1, intercept = 0;
};

/// Planes that could be one volume: of one series, one size, one orientation, one pixel spacing.
struct PlaneGroup {
    std::string seriesUid;
    std::int64_t columns = 0, rows = 0;
    std::vector<Plane> planes;
};

// ---- what a file's pixels are

DicomPixelFormat pixelFormatOf(const DicomFile& dicom) {
    const auto& [path, header] = dicom;
    const auto need = [&](DicomTag tag, std::string_view name) -> int {
        if (const auto value = header.unsignedShort(tag)) return *value;
        refuse(path, fmt::format("damaged DICOM header: {} is missing", name),
               "get the file again");
    };
    if (header.dataset.text(tag::kImageType).value_or("").find("MOSAIC") !=
        std::string_view::npos) {
        refuse(path, "is a Siemens mosaic (many slices tiled in one image)",
               "convert it with dcm2niix first");
    }
    const auto photometric = header.dataset.text(tag::kPhotometric).value_or("");
    const int components = need(tag::kSamplesPerPixel, "SamplesPerPixel");
    if (components != 1 || (photometric != "MONOCHROME1" && photometric != "MONOCHROME2")) {
        refuse(path,
               fmt::format("its pixels are colour or of an unknown kind ({} samples per "
                           "pixel, photometric interpretation '{}')",
                           components, printable(photometric)),
               "give a scalar grey image");
    }
    DicomPixelFormat format;
    format.rows = need(tag::kRows, "Rows");
    format.columns = need(tag::kColumns, "Columns");
    const int bits = need(tag::kBitsAllocated, "BitsAllocated");
    format.bitsStored = need(tag::kBitsStored, "BitsStored");
    const bool isSigned = need(tag::kPixelRepresentation, "PixelRepresentation") == 1;
    if (format.rows < 1 || format.columns < 1) {
        refuse(path,
               fmt::format("damaged DICOM header: image size {} x {} (Rows, Columns)", format.rows,
                           format.columns),
               "get the file again");
    }
    if ((bits != 8 && bits != 16 && bits != 32) || format.bitsStored < 1 ||
        format.bitsStored > bits ||
        header.unsignedShort(tag::kHighBit).value_or(format.bitsStored - 1) !=
            format.bitsStored - 1) {
        refuse(
            path,
            fmt::format("unsupported pixel bits: {} allocated, {} stored", bits, format.bitsStored),
            "convert it to 8 or 16 bits");
    }
    format.stored = bits == 8    ? (isSigned ? PixelType::Int8 : PixelType::UInt8)
                    : bits == 16 ? (isSigned ? PixelType::Int16 : PixelType::UInt16)
                                 : (isSigned ? PixelType::Int32 : PixelType::UInt32);
    if (const auto text = header.dataset.text(tag::kNumberOfFrames)) {
        const auto frames = parseInteger(*text);
        if (!frames || *frames < 1 || *frames > 1'000'000) {
            refuse(path, "damaged DICOM header: NumberOfFrames is not a positive number",
                   "get the file again");
        }
        format.frames = *frames;
    }
    return format;
}

/// GDCM's RLE codec trusts these numbers (PS3.5, annex G).
void requireSoundRle(const DicomFile& dicom, const DicomPixelFormat& format) {
    const auto& fragments = dicom.header.pixelData->fragments;
    bool isSound = std::ssize(fragments) == format.frames;
    for (const auto& fragment : fragments) {
        constexpr std::size_t kHeaderBytes = 64;
        char raw[kHeaderBytes];
        isSound = isSound && fragment.byteCount >= kHeaderBytes;
        if (!isSound) break;
        ByteSource(dicom.path, fragment.offset, ByteSource::Encoding::Raw).read(raw, kHeaderBytes);
        const HeaderBytes bytes({raw, kHeaderBytes}, std::endian::little);
        const auto segments = bytes.at<std::uint32_t>(0);
        isSound = segments == bytesPerPixel(format.stored);
        std::uint64_t previous = kHeaderBytes - 1;
        for (std::uint32_t s = 0; isSound && s < segments; ++s) {
            const auto offset = bytes.at<std::uint32_t>(4 + 4 * s);
            isSound = offset > previous && offset < fragment.byteCount;
            previous = offset;
        }
    }
    if (!isSound) {
        refuse(dicom.path, "its RLE segments are damaged: its pixel data can't be decoded",
               "get the file again");
    }
}

enum class Codec { None, Rle, Jpeg, Jpeg2000 };

std::optional<Codec> codecOf(std::string_view transferSyntax) {
    static const std::map<std::string_view, Codec> kCodecs = {
        {"1.2.840.10008.1.2", Codec::None},    // implicit little endian
        {"1.2.840.10008.1.2.1", Codec::None},  // explicit little endian
        {"1.2.840.10008.1.2.2", Codec::None},  // explicit big endian
        {"1.2.840.10008.1.2.5", Codec::Rle},
        {"1.2.840.10008.1.2.4.50", Codec::Jpeg},      // baseline
        {"1.2.840.10008.1.2.4.51", Codec::Jpeg},      // extended
        {"1.2.840.10008.1.2.4.57", Codec::Jpeg},      // lossless
        {"1.2.840.10008.1.2.4.70", Codec::Jpeg},      // lossless, first order
        {"1.2.840.10008.1.2.4.80", Codec::Jpeg},      // JPEG-LS lossless
        {"1.2.840.10008.1.2.4.81", Codec::Jpeg},      // JPEG-LS near lossless
        {"1.2.840.10008.1.2.4.90", Codec::Jpeg2000},  // lossless
        {"1.2.840.10008.1.2.4.91", Codec::Jpeg2000}};
    const auto it = kCodecs.find(transferSyntax);
    if (it == kCodecs.end()) return std::nullopt;
    return it->second;
}

/// The codecs write to stderr when they are given something else.
void requireCodestream(const DicomFile& dicom, Codec codec) {
    using namespace std::string_view_literals;
    const auto& fragments = dicom.header.pixelData->fragments;
    char raw[2] = {0, 0};
    if (!fragments.empty() && fragments.front().byteCount >= sizeof raw) {
        ByteSource(dicom.path, fragments.front().offset, ByteSource::Encoding::Raw)
            .read(raw, sizeof raw);
    }
    const std::string_view start(raw, sizeof raw);
    const bool isSound = codec == Codec::Jpeg ? start == "\xff\xd8"sv
                                              : start == "\xff\x4f"sv || start == "\0\0"sv;  // .jp2
    if (!isSound) {
        refuse(dicom.path, "its compressed pixel data are damaged and can't be decoded",
               "get the file again");
    }
}

void requirePixelData(const DicomFile& dicom, const DicomPixelFormat& format) {
    const DicomPixelData& pixels = *dicom.header.pixelData;
    const auto codec = codecOf(dicom.header.transferSyntax);
    if (!codec) {
        refuse(dicom.path, "unsupported transfer syntax (how its pixel data are compressed)",
               "save it uncompressed, e.g. with gdcmconv --raw");
    }
    if ((*codec != Codec::None) != pixels.isEncapsulated) {
        refuse(dicom.path, "damaged: its pixel data are not as its transfer syntax says",
               "get the file again");
    }
    if (*codec == Codec::None && pixels.byteCount < format.byteCount()) {
        refuse(dicom.path,
               fmt::format("truncated: its pixel data hold {} of {} bytes", pixels.byteCount,
                           format.byteCount()),
               "get the whole file");
    }
    if (*codec == Codec::Rle) requireSoundRle(dicom, format);
    if (*codec == Codec::Jpeg || *codec == Codec::Jpeg2000) requireCodestream(dicom, *codec);
}

// ---- where its planes lie

std::optional<Vec3> unitVector(const std::vector<double>& numbers, std::size_t from) {
    const Vec3 v{numbers[from], numbers[from + 1], numbers[from + 2]};
    if (!(std::abs(norm(v) - 1) < 1e-3)) return std::nullopt;
    return normalized(v);
}

/// \param place  of a functional group, or the data set itself; nullptr where there is none
Plane planeOf(const fs::path& path, const DicomDataset* position, const DicomDataset* orientation,
              const DicomDataset* measures, const DicomDataset* transformation) {
    const auto numbers = [&](const DicomDataset* set, DicomTag tag) {
        return set ? set->numbers(path, tag) : std::vector<double>{};
    };
    Plane plane;
    if (const auto p = numbers(position, tag::kImagePosition); p.size() == 3) {
        plane.position = Vec3{p[0], p[1], p[2]};
    }
    if (const auto o = numbers(orientation, tag::kImageOrientation); o.size() == 6) {
        plane.alongRow = unitVector(o, 0);
        plane.alongColumn = unitVector(o, 3);
    }
    if (const auto s = numbers(measures, tag::kPixelSpacing); s.size() == 2) {
        plane.rowStepMm = s[0];  // between rows comes first (PS3.3, 10.7.1.3)
        plane.columnStepMm = s[1];
    }
    const auto slope = numbers(transformation, tag::kRescaleSlope);
    const auto intercept = numbers(transformation, tag::kRescaleIntercept);
    if (!slope.empty()) plane.slope = slope.front();
    if (!intercept.empty()) plane.intercept = intercept.front();
    if (plane.slope == 0) {
        refuse(path, "its RescaleSlope is 0: the image would be constant", "get the file again");
    }
    return plane;
}

std::vector<Plane> planesOf(const DicomFile& dicom, const DicomPixelFormat& format) {
    const DicomDataset& top = dicom.header.dataset;
    if (top.item(tag::kModalityLutSequence)) {
        refuse(dicom.path, "its values go through a lookup table (Modality LUT)",
               "convert it with a tool that applies the table");
    }
    const auto perFrame = top.sequences.find(tag::kPerFrameFunctionalGroups);
    if (perFrame == top.sequences.end()) {
        if (format.frames > 1) {
            refuse(dicom.path,
                   "is multi-frame but does not say where its frames lie (no "
                   "functional groups)",
                   "export it as single slices or enhanced DICOM");
        }
        return {planeOf(dicom.path, &top, &top, &top, &top)};
    }
    if (std::ssize(perFrame->second) != format.frames) {
        refuse(dicom.path,
               fmt::format("damaged DICOM header: {} frames but {} functional groups",
                           format.frames, perFrame->second.size()),
               "get the file again");
    }
    const DicomDataset* shared = top.item(tag::kSharedFunctionalGroups);
    std::vector<Plane> planes;
    for (const DicomDataset& own : perFrame->second) {
        const auto group = [&](DicomTag tag) {
            const DicomDataset* found = own.item(tag);
            return found || !shared ? found : shared->item(tag);
        };
        planes.push_back(planeOf(
            dicom.path, group(tag::kPlanePositionSequence), group(tag::kPlaneOrientationSequence),
            group(tag::kPixelMeasuresSequence), group(tag::kPixelValueTransformationSequence)));
        planes.back().frame = std::ssize(planes) - 1;
    }
    return planes;
}

// ---- groups

bool isSame(const std::optional<double>& a, const std::optional<double>& b) {
    return a.has_value() == b.has_value() && (!a || std::abs(*a - *b) <= kSameDirection * *a);
}

bool isSame(const std::optional<Vec3>& a, const std::optional<Vec3>& b) {
    return a.has_value() == b.has_value() && (!a || norm(*a - *b) <= kSameDirection);
}

bool belongs(const PlaneGroup& group, const PlaneGroup& candidate) {
    const Plane& a = group.planes.front();
    const Plane& b = candidate.planes.front();
    return group.seriesUid == candidate.seriesUid && group.columns == candidate.columns &&
           group.rows == candidate.rows && isSame(a.alongRow, b.alongRow) &&
           isSame(a.alongColumn, b.alongColumn) && isSame(a.columnStepMm, b.columnStepMm) &&
           isSame(a.rowStepMm, b.rowStepMm);
}

/// In the order of the files' names: the same folder gives the same numbers.
std::vector<PlaneGroup> groupPlanes(const std::vector<DicomFile>& files) {
    std::vector<PlaneGroup> groups;
    for (std::size_t i = 0; i < files.size(); ++i) {
        const DicomPixelFormat format = pixelFormatOf(files[i]);
        requirePixelData(files[i], format);
        for (Plane& plane : planesOf(files[i], format)) {
            plane.file = i;
            PlaneGroup candidate{
                std::string(files[i].header.dataset.text(tag::kSeriesInstanceUid).value_or("")),
                format.columns,
                format.rows,
                {plane}};
            const auto known = std::ranges::find_if(
                groups, [&](const PlaneGroup& group) { return belongs(group, candidate); });
            if (known == groups.end()) {
                groups.push_back(std::move(candidate));
            } else {
                known->planes.push_back(plane);
            }
        }
    }
    return groups;
}

std::string_view orientationName(const Plane& plane) {
    if (!plane.alongRow || !plane.alongColumn) return "unknown";
    const Vec3 normal = cross(*plane.alongRow, *plane.alongColumn);
    const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
    return x >= y && x >= z ? "sagittal" : y >= z ? "coronal" : "axial";
}

/// Counts and geometry only: descriptions and ids may name the patient.
std::string listOf(const std::vector<PlaneGroup>& groups) {
    std::string list;
    for (std::size_t i = 0; i < groups.size(); ++i) {
        const PlaneGroup& group = groups[i];
        const Plane& first = group.planes.front();
        list += fmt::format("{}{}: {} slice{} of {} x {} voxels, {} orientation", i ? "; " : "",
                            i + 1, group.planes.size(), group.planes.size() > 1 ? "s" : "",
                            group.columns, group.rows, orientationName(first));
        if (first.columnStepMm) {
            list +=
                fmt::format(", {} x {} mm", number(*first.columnStepMm), number(*first.rowStepMm));
        }
    }
    return list;
}

PlaneGroup chooseGroup(const fs::path& input, std::vector<PlaneGroup> groups,
                       const ReadOptions& options) {
    if (!options.series) {
        if (groups.size() == 1) return std::move(groups.front());
        refuse(input,
               fmt::format("holds {} groups of slices that differ in series, size, spacing "
                           "or orientation ({})",
                           groups.size(), listOf(groups)),
               "choose one by its number (--series)");
    }
    const auto wanted = parseInteger(*options.series);
    if (wanted && *wanted >= 1 && *wanted <= std::ssize(groups)) {
        return std::move(groups[static_cast<std::size_t>(*wanted - 1)]);
    }
    const auto hasUid = [&](const PlaneGroup& group) { return group.seriesUid == *options.series; };
    if (std::ranges::count_if(groups, hasUid) == 1) {
        return std::move(*std::ranges::find_if(groups, hasUid));
    }
    refuse(input, fmt::format("the asked-for series is not one of these: {}", listOf(groups)),
           "choose one by its number (--series)");
}

// ---- a group's geometry

void requirePlacedPlanes(const std::vector<DicomFile>& files, const PlaneGroup& group) {
    for (const Plane& plane : group.planes) {
        const fs::path& path = files[plane.file].path;
        const char* fault =
            !plane.position                           ? "has no ImagePositionPatient (position)"
            : !plane.alongRow || !plane.alongColumn   ? "has no usable ImageOrientationPatient"
            : !plane.columnStepMm || !plane.rowStepMm ? "has no usable PixelSpacing"
            : !(*plane.columnStepMm > 0 && *plane.rowStepMm > 0) ? "has a PixelSpacing of 0 or less"
            : std::abs(dot(*plane.alongRow, *plane.alongColumn)) > 1e-3
                ? "has an ImageOrientationPatient whose rows and columns are not perpendicular"
                : nullptr;
        if (fault) {
            refuse(path, fmt::format("the DICOM image {}: where it lies is unknown", fault),
                   "export the series again with its geometry");
        }
    }
}

/// "between slices 3 and 4": the first step that is far from the usual one.
std::string describeGap(const std::vector<double>& along) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < along.size(); ++i) steps.push_back(along[i] - along[i - 1]);
    std::vector<double> sorted = steps;
    std::nth_element(sorted.begin(), sorted.begin() + std::ssize(sorted) / 2, sorted.end());
    const double usual = sorted[sorted.size() / 2];
    const auto worst =
        std::ranges::max_element(steps, {}, [&](double step) { return std::abs(step - usual); });
    const auto before = worst - steps.begin() + 1;
    return fmt::format(
        "uneven slice spacing: {} mm between slices {} and {} where {} mm is usual "
        "(a missing slice?)",
        number(*worst), before, before + 1, number(usual));
}

/// Sorts the planes along their normal and checks that they lie evenly on a line.
ImageGeometry stackPlanes(const fs::path& input, PlaneGroup& group,
                          std::vector<std::string>& warnings) {
    const Plane first = group.planes.front();
    const Vec3 normal = normalized(cross(*first.alongRow, *first.alongColumn));
    const auto place = [&](const Plane& plane) { return dot(*plane.position, normal); };
    std::ranges::stable_sort(group.planes, {}, place);

    std::vector<double> along;
    for (const Plane& plane : group.planes) along.push_back(place(plane));
    constexpr double kSamePlaceMm = 1e-3;
    for (std::size_t i = 1; i < along.size(); ++i) {
        if (along[i] - along[i - 1] < kSamePlaceMm) {
            refuse(input,
                   fmt::format("several slices lie at the same position (slices {} and {} "
                               "of {}): several volumes, echoes or time points, or "
                               "duplicate files",
                               i, i + 1, along.size()),
                   "keep one volume in the folder");
        }
    }

    const Vec3 origin = *group.planes.front().position;
    const double steps = static_cast<double>(group.planes.size() - 1);
    const Vec3 step = (1 / steps) * (*group.planes.back().position - origin);
    for (std::size_t i = 0; i < group.planes.size(); ++i) {
        const Vec3 off = *group.planes[i].position - (origin + static_cast<double>(i) * step);
        if (std::abs(dot(off, normal)) > kLargestMisplacementMm) {
            refuse(input, describeGap(along), "give the complete series");
        }
        if (norm(off) > kLargestMisplacementMm) {
            refuse(input,
                   fmt::format("slice {} lies {} mm beside the line through the other "
                               "slices' positions",
                               i + 1, number(norm(off))),
                   "give one evenly stacked series");
        }
    }
    const double tilt = std::acos(std::min(1.0, dot(step, normal) / norm(step)));
    if (std::sin(tilt) * norm(step) * steps > kLargestMisplacementMm) {
        warnings.push_back(
            fmt::format("the slices are tilted by {:.2f} degrees against their "
                        "stack (gantry tilt): kept as shear",
                        tilt * 180 / std::numbers::pi));
    }
    return {
        {group.columns, group.rows, std::ssize(group.planes)},
        origin,
        {{{*first.columnStepMm * *first.alongRow, *first.rowStepMm * *first.alongColumn, step}}}};
}

// ---- samples

bool isWhole(double value) {
    return value == std::floor(value) && std::abs(value) < 1e9;
}

/// The stored type where nothing is rescaled; the smallest integer type that holds all values where
/// slopes are 1 and intercepts whole; else a float type.
PixelType outputTypeOf(const std::vector<DicomPixelFormat>& formats, const PlaneGroup& group) {
    const PixelType stored = formats[group.planes.front().file].stored;
    bool isPlain = true, isInteger = true, isWide = false;
    double low = 0, high = 0;
    for (const Plane& plane : group.planes) {
        const DicomPixelFormat& format = formats[plane.file];
        const bool isIdentity = plane.slope == 1 && plane.intercept == 0;
        isPlain = isPlain && isIdentity && format.stored == stored;
        isInteger = isInteger && plane.slope == 1 && isWhole(plane.intercept);
        isWide = isWide || bytesPerPixel(format.stored) > 2;
        const bool isSigned = withPixelType(
            format.stored, []<class T>(T) { return std::numeric_limits<T>::is_signed; });
        const double values = std::ldexp(1, format.bitsStored);
        low = std::min(low, plane.intercept - (isSigned ? values / 2 : 0));
        high = std::max(high, plane.intercept + (isSigned ? values / 2 : values) - 1);
    }
    if (isPlain) return stored;
    if (!isInteger) return isWide ? PixelType::Float64 : PixelType::Float32;
    for (const PixelType type : {PixelType::UInt8, PixelType::Int8, PixelType::UInt16,
                                 PixelType::Int16, PixelType::UInt32, PixelType::Int32}) {
        const bool holds = withPixelType(type, [&]<class T>(T) {
            return low >= static_cast<double>(std::numeric_limits<T>::lowest()) &&
                   high <= static_cast<double>(std::numeric_limits<T>::max());
        });
        if (holds) return type;
    }
    return PixelType::Int64;
}

template <class Stored, class Out>
void rescale(const fs::path& path, const Plane& plane, const std::byte* stored, std::int64_t count,
             Out* out) {
    const auto* in = reinterpret_cast<const Stored*>(stored);
    for (std::int64_t i = 0; i < count; ++i) {
        const double value = plane.slope * static_cast<double>(in[i]) + plane.intercept;
        if constexpr (std::is_integral_v<Out>) {
            if (!(value >= static_cast<double>(std::numeric_limits<Out>::lowest()) &&
                  value <= static_cast<double>(std::numeric_limits<Out>::max()))) {
                refuse(path, "holds a value beyond its BitsStored", "get the file again");
            }
        }
        out[i] = static_cast<Out>(value);
    }
}

class SliceStore {
public:
    SliceStore(std::byte* out, PixelType type, std::int64_t voxelsPerSlice)
        : out_(out), type_(type), voxelsPerSlice_(voxelsPerSlice) {}

    void store(const fs::path& path, const DicomPixelFormat& format, const Plane& plane,
               const std::byte* stored, std::size_t slice) const {
        std::byte* to =
            out_ + slice * static_cast<std::size_t>(voxelsPerSlice_) * bytesPerPixel(type_);
        if (format.stored == type_ && plane.slope == 1 && plane.intercept == 0) {
            std::memcpy(to, stored,
                        static_cast<std::size_t>(voxelsPerSlice_) * bytesPerPixel(type_));
            return;
        }
        withPixelType(format.stored, [&]<class Stored>(Stored) {
            withPixelType(type_, [&]<class Out>(Out) {
                rescale<Stored>(path, plane, stored, voxelsPerSlice_, reinterpret_cast<Out*>(to));
            });
        });
    }

private:
    std::byte* out_;
    PixelType type_;
    std::int64_t voxelsPerSlice_;
};

Volume decodePlanes(const fs::path& input, const std::vector<DicomFile>& files,
                    const PlaneGroup& group, const ImageGeometry& geometry) {
    std::vector<DicomPixelFormat> formats(files.size());
    std::vector<std::vector<std::size_t>> slicesOfFile(files.size());
    for (std::size_t slice = 0; slice < group.planes.size(); ++slice) {
        const std::size_t file = group.planes[slice].file;
        formats[file] = pixelFormatOf(files[file]);
        slicesOfFile[file].push_back(slice);
    }
    const PixelType type = outputTypeOf(formats, group);
    SampleBuffer samples = allocateSamples(input, requireImageBytes(input, geometry.size, type));
    const std::int64_t voxelsPerSlice = geometry.size[0] * geometry.size[1];
    const SliceStore store(samples.get(), type, voxelsPerSlice);

    std::vector<std::byte> stored;  // one file's
    for (std::size_t file = 0; file < files.size(); ++file) {
        if (slicesOfFile[file].empty()) continue;
        decodeWithGdcm(files[file].path, formats[file], stored);
        const std::size_t frameBytes =
            static_cast<std::size_t>(voxelsPerSlice) * bytesPerPixel(formats[file].stored);
        for (const std::size_t slice : slicesOfFile[file]) {
            const Plane& plane = group.planes[slice];
            store.store(files[file].path, formats[file], plane,
                        stored.data() + static_cast<std::size_t>(plane.frame) * frameBytes, slice);
        }
    }
    return makeVolume(std::move(samples), type, geometry);
}

ReadVolume readGroups(const fs::path& input, const std::vector<DicomFile>& files,
                      const ReadOptions& options, std::vector<std::string> warnings) {
    PlaneGroup group = chooseGroup(input, groupPlanes(files), options);
    if (group.planes.size() == 1) {
        refuse(input, "is a single DICOM slice, a surface needs a volume",
               "give the folder with all slices of the series");
    }
    requirePlacedPlanes(files, group);
    const ImageGeometry geometry = stackPlanes(input, group, warnings);
    requireUsableGeometry(input, geometry);
    return {decodePlanes(input, files, group, geometry), "DICOM", std::move(warnings)};
}

// ---- folders

bool hasDicomName(const fs::path& file) {
    const std::string ending = lowerCase(file.extension().native());
    return ending == ".dcm" || ending == ".ima" || ending == ".dicom";
}

/// DICOMDIR, reports, presentation states, plans and the like: what may lie beside the slices.
bool isOtherThanImage(const DicomHeader& header) {
    constexpr std::string_view kStorage = "1.2.840.10008.5.1.4.1.1.";
    std::string_view storage = header.mediaStorage;
    if (storage == "1.2.840.10008.1.3.10") return true;  // DICOMDIR
    if (!storage.starts_with(kStorage)) return false;
    storage.remove_prefix(kStorage.size());
    for (const std::string_view kind :
         {"9.", "11.", "66", "67", "68.", "88.", "104.", "481.2", "481.3", "481.4", "481.5",
          "481.6", "481.7", "481.8", "481.9"}) {
        if (storage.starts_with(kind) && storage != "66.4") return true;  // 66.4: segmentation
    }
    return false;
}

/// A slice that lost its end, as interrupted copies do.
bool isBlankStub(std::string_view head, std::size_t wholeHead) {
    return head.size() < wholeHead && head.find_first_not_of('\0') == std::string_view::npos;
}

struct FolderListing {
    std::vector<fs::path> dicomFiles;  ///< by name
    std::size_t oddEntries = 0;        ///< pipes, devices, link loops
};

/// gdcm::Directory stops at the first broken link or pipe, so the folder is listed here.
FolderListing listFolder(const fs::path& folder) {
    std::vector<fs::path> entries;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        entries.push_back(it->path());
    }
    if (error) refuse(folder, "can't be listed: " + error.message(), "check its permissions");
    std::ranges::sort(entries);

    FolderListing listing;
    for (const fs::path& entry : entries) {
        std::error_code ignored;
        const fs::file_status status = fs::status(entry, ignored);
        if (fs::is_directory(status)) continue;
        if (status.type() == fs::file_type::not_found) {
            refuse(entry, "the link points to no existing file, a slice may be missing",
                   "fetch the file (git annex get) or remove the link");
        }
        if (!fs::is_regular_file(status)) {
            ++listing.oddEntries;
            continue;
        }
        requireRegularFile(entry);
        constexpr std::size_t kMagicEnd = 132;
        const std::string head = readHead(entry, kMagicEnd);
        const bool isHidden = entry.filename().native().starts_with('.');
        if (looksLikeDicom(head)) {
            listing.dicomFiles.push_back(entry);
        } else if (hasDicomName(entry) || (!isHidden && isBlankStub(head, kMagicEnd))) {
            refuse(entry, "is empty, or named like a DICOM file but none: a slice may be damaged",
                   "get it again or remove it");
        }
    }
    return listing;
}

}  // namespace

ReadVolume readDicomFile(const fs::path& file) {
    std::vector<DicomFile> files{{file, readDicomHeader(file)}};
    if (!files.front().header.pixelData) {
        refuse(file, "holds no image (no pixel data)", "give an image file or a DICOM folder");
    }
    return readGroups(file, files, {}, {});
}

ReadVolume readDicomFolder(const fs::path& folder, const ReadOptions& options) {
    const FolderListing listing = listFolder(folder);
    std::vector<DicomFile> files;
    for (const fs::path& path : listing.dicomFiles) {
        DicomFile dicom{path, readDicomHeader(path)};
        if (dicom.header.pixelData) {
            files.push_back(std::move(dicom));
        } else if (!isOtherThanImage(dicom.header)) {
            refuse(path, "is a DICOM image without pixel data, a slice may be cut off",
                   "get it again or remove it");
        }
    }
    if (files.empty()) {
        refuse(folder,
               listing.dicomFiles.empty()
                   ? std::string("no DICOM file found in this folder")
                   : fmt::format("no image found: {} DICOM files without pixel data",
                                 listing.dicomFiles.size()),
               "give an image file or the folder that holds the slices themselves");
    }
    std::vector<std::string> warnings;
    if (listing.oddEntries > 0) {
        warnings.push_back(
            fmt::format("left out {} entries of the folder that are no regular "
                        "files (pipes, link loops)",
                        listing.oddEntries));
    }
    return readGroups(folder, files, options, std::move(warnings));
}

}  // namespace adaptiso::detail
