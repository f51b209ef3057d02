#include <fmt/core.h>

#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <string>

#include "DataPlace.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "NiftiTypes.h"
#include "Readers.h"
#include "Samples.h"

// ITK 5.2.1 decodes NIfTI only where the sform is orthogonal and agrees with pixdim (else it takes
// the qform, or throws) and pads short files with zeros. The format, NIfTI-2 included, is a fixed
// header and plain samples, so it is read here, after nifti1.h and nifti2.h.
namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kHeader1Bytes = 348;
constexpr std::size_t kHeader2Bytes = 540;

struct NiftiHeader {
    int version = 1;
    bool hasDataInside = true;  ///< .nii; false: the samples are in an .img
    std::endian byteOrder = std::endian::native;
    std::array<std::int64_t, 8> dim{};
    int datatype = 0, bitpix = 0;
    std::array<double, 8> pixdim{};
    double dataOffset = 0;
    double slope = 0, intercept = 0;
    int units = 0;
    int intent = 0;
    int qformCode = 0, sformCode = 0;
    Vec3 quaternion, qoffset;
    std::array<std::array<double, 4>, 3> sform{};
};

bool isMagic(std::string_view head, std::size_t offset, std::string_view magic) {
    return head.size() >= offset + magic.size() && head.substr(offset, magic.size()) == magic;
}

NiftiHeader parseVersion1(const HeaderBytes& bytes) {
    NiftiHeader h;
    for (std::size_t i = 0; i < 8; ++i) {
        h.dim[i] = bytes.at<std::int16_t>(40 + 2 * i);
        h.pixdim[i] = bytes.at<float>(76 + 4 * i);
    }
    h.intent = bytes.at<std::int16_t>(68);
    h.datatype = bytes.at<std::int16_t>(70);
    h.bitpix = bytes.at<std::int16_t>(72);
    h.dataOffset = bytes.at<float>(108);
    h.slope = bytes.at<float>(112);
    h.intercept = bytes.at<float>(116);
    h.units = bytes.at<std::uint8_t>(123);
    h.qformCode = bytes.at<std::int16_t>(252);
    h.sformCode = bytes.at<std::int16_t>(254);
    for (int i = 0; i < 3; ++i) {
        h.quaternion[i] = bytes.at<float>(256 + 4 * i);
        h.qoffset[i] = bytes.at<float>(268 + 4 * i);
        for (int j = 0; j < 4; ++j) h.sform[i][j] = bytes.at<float>(280 + 16 * i + 4 * j);
    }
    return h;
}

NiftiHeader parseVersion2(const HeaderBytes& bytes) {
    NiftiHeader h;
    h.version = 2;
    for (std::size_t i = 0; i < 8; ++i) {
        h.dim[i] = bytes.at<std::int64_t>(16 + 8 * i);
        h.pixdim[i] = bytes.at<double>(104 + 8 * i);
    }
    h.datatype = bytes.at<std::int16_t>(12);
    h.bitpix = bytes.at<std::int16_t>(14);
    h.dataOffset = static_cast<double>(bytes.at<std::int64_t>(168));
    h.slope = bytes.at<double>(176);
    h.intercept = bytes.at<double>(184);
    h.qformCode = bytes.at<std::int32_t>(344);
    h.sformCode = bytes.at<std::int32_t>(348);
    for (int i = 0; i < 3; ++i) {
        h.quaternion[i] = bytes.at<double>(352 + 8 * i);
        h.qoffset[i] = bytes.at<double>(376 + 8 * i);
        for (int j = 0; j < 4; ++j) h.sform[i][j] = bytes.at<double>(400 + 32 * i + 8 * j);
    }
    h.units = bytes.at<std::int32_t>(500);
    h.intent = bytes.at<std::int32_t>(504);
    return h;
}

/// NIfTI-2's magic ends with the line ends of every system, as PNG's does: a transfer that turns
/// line ends changes them, and moves what follows.
void requireLineEnds(const fs::path& file, std::string_view head) {
    constexpr std::size_t kAt = 8;
    const bool isLeftOut = isMagic(head, kAt, std::string_view("\0\0\0\0", 4));  // by some writers
    if (isLeftOut || isMagic(head, kAt, "\r\n\x1a\n")) return;
    refuse(
        file,
        "its NIfTI-2 magic is damaged, as by a transfer in text mode that turns line ends: so are "
        "its header and voxels",
        "transfer it again in binary mode");
}

/// xyzt_units of mm and s is 10, a line feed: a transfer in text mode puts a byte before it.
void requireMagicAtItsPlace(const fs::path& file, std::string_view head) {
    constexpr std::size_t kAt = 344, kMost = 16;
    for (const std::string_view magic :
         {std::string_view("n+1\0", 4), std::string_view("ni1\0", 4)}) {
        const std::size_t found = head.find(magic, kAt - kMost);
        if (found == std::string_view::npos || found == kAt || found > kAt + kMost) continue;
        refuse(file,
               fmt::format("its NIfTI magic is at byte {}, not 344: a transfer in text mode has "
                           "displaced its header and voxels",
                           found),
               "transfer the file again in binary mode");
    }
}

NiftiHeader readHeader(const fs::path& file) {
    std::array<char, kHeader2Bytes> buffer{};
    ByteSource source = ByteSource::openPlainOrGzip(file);
    const std::string_view head(buffer.data(), source.readSome(buffer.data(), buffer.size()));
    if (head.size() < kHeader1Bytes) {
        refuse(file, fmt::format("truncated: {} bytes are no NIfTI header (348)", head.size()),
               "get the whole file");
    }
    for (const std::endian order : {std::endian::little, std::endian::big}) {
        const HeaderBytes bytes(head, order);
        const auto headerBytes = bytes.at<std::int32_t>(0);
        NiftiHeader h;
        if (headerBytes == kHeader1Bytes) {
            h = parseVersion1(bytes);
            h.hasDataInside = isMagic(head, 344, std::string_view("n+1\0", 4));
            if (!h.hasDataInside && !isMagic(head, 344, std::string_view("ni1\0", 4))) {
                requireMagicAtItsPlace(file, head);
                refuse(file,
                       "not a NIfTI file: the magic is missing (ANALYZE 7.5 headers do not "
                       "say which way is left)",
                       "convert it to NIfTI-1");
            }
        } else if (headerBytes == kHeader2Bytes) {
            if (head.size() < kHeader2Bytes) {
                refuse(file, "truncated: too short for a NIfTI-2 header (540 bytes)",
                       "get the whole file");
            }
            h = parseVersion2(bytes);
            h.hasDataInside = isMagic(head, 4, std::string_view("n+2\0", 4));
            if (!h.hasDataInside && !isMagic(head, 4, std::string_view("ni2\0", 4))) {
                refuse(file, "not a NIfTI-2 file: the magic is missing", "check what it is");
            }
            requireLineEnds(file, head);
        } else {
            continue;
        }
        h.byteOrder = order;
        return h;
    }
    refuse(file, "not a NIfTI file: its header does not begin with its own length (348 or 540)",
           "check what it is");
}

PixelType pixelTypeOfCode(const fs::path& file, const NiftiHeader& h) {
    for (const NiftiType& row : kNiftiTypes) {
        if (row.code != h.datatype) continue;
        if (h.bitpix != static_cast<int>(8 * bytesPerPixel(row.type))) {
            refuse(file,
                   fmt::format("its header contradicts itself: datatype {} with bitpix {}",
                               h.datatype, h.bitpix),
                   "repair the header");
        }
        return row.type;
    }
    const std::string_view name = h.datatype == 128 || h.datatype == 2304 ? "RGB colour"
                                  : h.datatype == 32 || h.datatype == 1792 || h.datatype == 2048
                                      ? "complex"
                                  : h.datatype == 1    ? "binary"
                                  : h.datatype == 1536 ? "128-bit float"
                                                       : "unknown";
    refuse(file, fmt::format("unsupported data type {} ({})", h.datatype, name),
           "convert it to a scalar integer or float type");
}

/// Connectome Workbench's matrices of NIfTI-2 (cifti-2, table 1): dimensions 5 and 6 hold them.
void refuseCifti(const fs::path& file, const NiftiHeader& h) {
    if (h.version != 2 || h.intent < 3000 || h.intent > 3099) return;
    refuse(file, "is CIFTI: values on surfaces and in voxels, not a volume",
           fmt::format("write its voxels: wb_command -cifti-separate {} COLUMN -volume-all "
                       "volume.nii.gz",
                       displayName(file.filename())));
}

/// Whose dimension beyond the third counts parts of one value; empty for other intents.
std::string_view componentsOf(int intent) {
    switch (intent) {
        case 1004:
        case 1005:
            return "matrices";
        case 1006:
        case 2006:  // FSL's fnirt
            return "displacements";
        case 1007:
            return "vectors";
        case 1010:
            return "quaternions";
        case 2003:
        case 2004:
            return "colours";
        default:
            return "";
    }
}

struct Extents {
    Index3 size{1, 1, 1};
    std::int64_t volumeCount = 1;
};

Extents extentsOf(const fs::path& file, const NiftiHeader& h) {
    const std::int64_t dimensions = h.dim[0];
    if (dimensions < 1 || dimensions > 7) {
        refuse(file, fmt::format("its header is damaged: dim[0] is {}, must be 1 to 7", dimensions),
               "repair the header");
    }
    Extents extents;
    for (std::size_t i = 1; i <= static_cast<std::size_t>(dimensions); ++i) {
        if (h.dim[i] < 1) {
            refuse(file,
                   fmt::format("its header is damaged: dim[{}] is {}, must be at least 1", i,
                               h.dim[i]),
                   "repair the header");
        }
        if (i <= 3) {
            extents.size[i - 1] = h.dim[i];
        } else if (i == 4) {
            extents.volumeCount = h.dim[i];
        } else if (h.dim[i] > 1) {
            const std::string_view name = componentsOf(h.intent);
            refuse(file,
                   fmt::format("holds {} of {} components (dimension {})",
                               name.empty() ? "vectors" : name, h.dim[i], i),
                   "save one component as a 3-D image");
        }
    }
    return extents;
}

double millimetresPerUnit(const fs::path& file, int units) {
    switch (units & 7) {
        case 0:  // unknown: millimetres, as every reader takes it
        case 2:
            return 1;
        case 1:
            return 1000;
        case 3:
            return 0.001;
        default:
            refuse(file, fmt::format("its header is damaged: unknown unit of length {}", units & 7),
                   "repair xyzt_units");
    }
}

/// Affine in RAS and the file's unit, as the header has it.
struct Affine {
    Mat3 axes;
    Vec3 origin;
};

Vec3 requireSpacing(const fs::path& file, const NiftiHeader& h) {
    Vec3 spacing;
    for (int axis = 0; axis < 3; ++axis) {
        const double d = std::abs(h.pixdim[axis + 1]);  // nifti1.h: pixdim[i] < 0 means |pixdim[i]|
        if (!std::isfinite(d) || d == 0) {
            refuse(file,
                   fmt::format("voxel spacing pixdim[{}] is {}, must be above zero", axis + 1,
                               number(h.pixdim[axis + 1])),
                   "repair the header");
        }
        spacing[axis] = d;
    }
    return spacing;
}

Affine sformAffine(const NiftiHeader& h) {
    Affine affine;
    for (int row = 0; row < 3; ++row) {
        for (int axis = 0; axis < 3; ++axis) affine.axes.column[axis][row] = h.sform[row][axis];
        affine.origin[row] = h.sform[row][3];
    }
    return affine;
}

/// nifti1.h, method 2.
Affine qformAffine(const fs::path& file, const NiftiHeader& h) {
    double b = h.quaternion.x, c = h.quaternion.y, d = h.quaternion.z;
    const double rest = 1 - squaredNorm(h.quaternion);
    constexpr double kRounding = 1e-5;  // three float32 near 1, squared
    if (!(rest > -kRounding)) {
        refuse(file, "its qform is damaged: the quaternion is longer than 1 or not finite",
               "repair the header's orientation");
    }
    double a = std::sqrt(std::max(rest, 0.0));
    if (rest < 1e-7) {  // a half turn, as nifti1.h treats it
        const double scale = 1 / norm(h.quaternion);
        b *= scale, c *= scale, d *= scale, a = 0;
    }
    const Mat3 rotation{
        {{{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)},
          {2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)},
          {2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c}}}};
    const Vec3 spacing = requireSpacing(file, h);
    const double qfac = h.pixdim[0] < 0 ? -1 : 1;
    return {rotation * Mat3::diagonal(spacing.x, spacing.y, qfac * spacing.z), h.qoffset};
}

/// nibabel's base affine: x runs to the left, the image's middle is the origin.
Affine spacingAffine(const fs::path& file, const NiftiHeader& h, const Index3& size) {
    const Vec3 spacing = requireSpacing(file, h);
    const Mat3 axes = Mat3::diagonal(-spacing.x, spacing.y, spacing.z);
    const Vec3 last{static_cast<double>(size[0] - 1), static_cast<double>(size[1] - 1),
                    static_cast<double>(size[2] - 1)};
    return {axes, -0.5 * (axes * last)};
}

ImageGeometry toLpsMm(const Affine& ras, double scale, const Index3& size) {
    const Mat3 toLps = Mat3::diagonal(-scale, -scale, scale);
    return {size, toLps * ras.origin, toLps * ras.axes};
}

/// The sides of the head that `a` and `b` exchange, as text to append.
std::string exchangedSides(const ImageGeometry& a, const ImageGeometry& b) {
    constexpr std::array<std::string_view, 3> kSides = {"left and right", "front and back",
                                                        "top and bottom"};
    std::string text;
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 step;
        step[axis] = 1;
        const Vec3 there = b.toPhysical(a.toIndex(a.originMm + step)) - b.originMm;
        if (there[axis] < -0.5 * norm(there)) {  // within 60 degrees of the opposite side
            text += fmt::format("; {} are exchanged between them",
                                kSides[static_cast<std::size_t>(axis)]);
        }
    }
    return text;
}

void compareForms(const ImageGeometry& sform, const ImageGeometry& qform,
                  std::vector<Warning>& warnings) {
    constexpr double kSameVoxels = 0.1;
    double apartMm = 0;
    bool isSame = true;
    for (int corner = 0; corner < 8; ++corner) {
        Vec3 index;
        for (int axis = 0; axis < 3; ++axis) {
            index[axis] = (corner >> axis & 1) ? static_cast<double>(sform.size[axis] - 1) : 0;
        }
        const Vec3 place = qform.toPhysical(index);
        const Vec3 moved = sform.toIndex(place) - index;
        for (int axis = 0; axis < 3; ++axis) {
            isSame = isSame && std::abs(moved[axis]) <= kSameVoxels;
        }
        apartMm = std::max(apartMm, norm(place - sform.toPhysical(index)));
    }
    if (isSame) return;
    warnings.push_back({"qform-sform-differ",
                        fmt::format("qform and sform differ by up to {} mm{}; the sform was taken",
                                    number(apartMm), exchangedSides(sform, qform))});
}

/// The sform's voxel size is taken, as nibabel and FreeSurfer do; ANALYZE's heirs take pixdim's.
void compareVoxelSizes(const fs::path& file, const NiftiHeader& h, const ImageGeometry& geometry,
                       double scale, std::vector<Warning>& warnings) {
    constexpr double kSame = 0.01;   // registered images may be stretched; less is rounding
    constexpr double kAbsurd = 100;  // another unit, no brain's
    std::array<double, 3> steps{}, said{};
    double worst = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<std::size_t>(axis);
        steps[at] = norm(geometry.indexToPhysical.column[axis]);
        said[at] = scale * std::abs(h.pixdim[at + 1]);
        if (!std::isfinite(said[at]) || said[at] == 0) return;  // it does not say
        worst = std::max({worst, steps[at] / said[at], said[at] / steps[at]});
    }
    if (worst <= 1 + kSame) return;
    const std::string sizes = fmt::format(
        "voxels are {} x {} x {} mm by pixdim and {} x {} x {} mm by the sform", number(said[0]),
        number(said[1]), number(said[2]), number(steps[0]), number(steps[1]), number(steps[2]));
    if (worst >= kAbsurd) {
        refuse(file, "its header contradicts itself: " + sizes,
               "correct the sform or pixdim; one may be in another unit");
    }
    warnings.push_back({"pixdim-sform-differ", sizes + "; the sform was taken"});
}

ImageGeometry geometryOf(const fs::path& file, const NiftiHeader& h, const Index3& size,
                         std::vector<Warning>& warnings) {
    const double scale = millimetresPerUnit(file, h.units);
    if (scale != 1) {
        warnings.push_back({"unit-converted", fmt::format("lengths are in {}, turned into mm",
                                                          scale > 1 ? "metres" : "microns")});
    }
    if (h.sformCode > 0) {
        const ImageGeometry geometry = toLpsMm(sformAffine(h), scale, size);
        requireUsableGeometry(file, geometry);
        compareVoxelSizes(file, h, geometry, scale, warnings);
        if (h.qformCode > 0) {
            compareForms(geometry, toLpsMm(qformAffine(file, h), scale, size), warnings);
        }
        return geometry;
    }
    if (h.qformCode > 0) return toLpsMm(qformAffine(file, h), scale, size);
    warnings.push_back({"guessed-orientation",
                        "neither sform nor qform: orientation and position are unknown, "
                        "left-posterior-superior order was NOT checked; the voxel size alone was "
                        "used"});
    return toLpsMm(spacingAffine(file, h, size), scale, size);
}

/// `file` with the first ending that exists.
fs::path partner(const fs::path& file, std::initializer_list<const char*> endings) {
    fs::path stem = file;
    if (stem.extension() == ".gz" || stem.extension() == ".GZ") stem.replace_extension();
    stem.replace_extension();
    for (const char* ending : endings) {
        fs::path candidate = stem;
        candidate += ending;
        std::error_code error;
        if (!fs::exists(candidate, error)) continue;
        requireRegularFile(candidate);
        requireOwnFolder(file, candidate);
        return candidate;
    }
    refuse(file,
           fmt::format("the other half of the .hdr/.img pair ({}) is missing",
                       displayName(stem.filename()) + *endings.begin()),
           "put both into one folder");
}

bool isImgName(const fs::path& file) {
    const fs::path inner = file.extension() == ".gz" ? file.stem() : file.filename();
    return inner.extension() == ".img" || inner.extension() == ".IMG";
}

std::uint64_t requireDataOffset(const fs::path& file, const NiftiHeader& h) {
    const double least = !h.hasDataInside ? 0 : h.version == 1 ? 352 : 544;
    if (!(h.dataOffset >= least && h.dataOffset < 1e15) ||
        h.dataOffset != std::floor(h.dataOffset)) {
        refuse(file,
               fmt::format("its header is damaged: data offset vox_offset is {}, must be a "
                           "whole number from {}",
                           number(h.dataOffset), least),
               "repair the header");
    }
    return static_cast<std::uint64_t>(h.dataOffset);
}

/// An extension must end before the voxels. Where one reaches beyond vox_offset and the file is
/// longer than its voxels by as much, it would be read as voxels.
/// \param bytesBehind  what follows the voxels, were they at vox_offset
void requireVoxelsBehindExtensions(const fs::path& file, const NiftiHeader& h,
                                   std::uint64_t bytesBehind) {
    if (!h.hasDataInside || bytesBehind == 0) return;
    constexpr std::size_t kFlagBytes = 4, kHeadBytes = 8;
    constexpr std::int32_t kUnit = 16, kMostCode = 1000;  // nifti1.h: sizes are multiples of 16
    ByteSource source = ByteSource::openPlainOrGzip(file);
    std::uint64_t end = (h.version == 1 ? kHeader1Bytes : kHeader2Bytes) + kFlagBytes;
    source.skip(end - kFlagBytes);
    std::array<char, kHeadBytes> head{};
    source.read(head.data(), kFlagBytes);
    const bool isFlagged = head[0] != 0;
    const auto dataOffset = static_cast<std::uint64_t>(h.dataOffset);
    while (source.readSome(head.data(), kHeadBytes) == kHeadBytes) {
        const HeaderBytes bytes({head.data(), kHeadBytes}, h.byteOrder);
        const auto size = bytes.at<std::int32_t>(0), code = bytes.at<std::int32_t>(4);
        if (size < kUnit || size % kUnit != 0 || code < 0 || code > kMostCode) return;
        end += static_cast<std::uint64_t>(size);
        if (end > dataOffset + bytesBehind) return;
        const bool fits = end == dataOffset + bytesBehind;
        if (end > dataOffset && (isFlagged || fits)) {
            refuse(file,
                   fmt::format("its header contradicts itself: voxels begin at byte {} "
                               "(vox_offset), where an extension lies that ends at byte {}",
                               dataOffset, end),
                   fits ? fmt::format("set vox_offset to {}", end) : "repair the header");
        }
        source.skip(static_cast<std::uint64_t>(size) - kHeadBytes);
    }
}

SampleLayout layoutOf(const fs::path& file, const NiftiHeader& h, std::vector<Warning>& warnings) {
    SampleLayout layout{pixelTypeOfCode(file, h), h.byteOrder};
    // slope 0 or NaN means "no scaling": nifti1.h and, for NaN, what nibabel and SPM write
    if (h.slope == 0 || std::isnan(h.slope)) {
        if (std::isfinite(h.intercept) && h.intercept != 0) {
            warnings.push_back(
                {"scaling-ignored",
                 fmt::format("scl_inter is {} but scl_slope {}, which means no scaling: the stored "
                             "values were taken",
                             number(h.intercept), number(h.slope))});
        }
        return layout;
    }
    if (!std::isfinite(h.slope) || !std::isfinite(h.intercept)) {
        refuse(file, "its scaling is not finite (scl_slope or scl_inter)", "repair the header");
    }
    layout.isScaled = h.slope != 1 || h.intercept != 0;
    layout.slope = h.slope;
    layout.intercept = h.intercept;
    return layout;
}

}  // namespace

std::optional<std::uint64_t> niftiSamplesAt(std::string_view head) {
    for (const std::endian order : {std::endian::little, std::endian::big}) {
        if (head.size() < kHeader1Bytes) break;
        const HeaderBytes bytes(head, order);
        const auto headerBytes = bytes.at<std::int32_t>(0);
        const bool isFirst = headerBytes == kHeader1Bytes;
        if (!isFirst && (headerBytes != kHeader2Bytes || head.size() < kHeader2Bytes)) continue;
        const std::size_t magicAt = isFirst ? 344 : 4;
        if (isMagic(head, magicAt, isFirst ? "ni1" : "ni2")) return 0;
        if (!isMagic(head, magicAt, isFirst ? "n+1" : "n+2")) continue;
        const double offset =
            isFirst ? bytes.at<float>(108) : static_cast<double>(bytes.at<std::int64_t>(168));
        return offset >= kHeader1Bytes && offset < 1e15 ? static_cast<std::uint64_t>(offset) : 0;
    }
    return std::nullopt;
}

bool looksLikeNifti(std::string_view head) {
    const auto hasMagic = [&](std::string_view magic) {
        return isMagic(head, 344, magic) || isMagic(head, 4, magic);
    };
    return hasMagic("n+1") || hasMagic("ni1") || hasMagic("n+2") || hasMagic("ni2");
}

ReadVolume readNifti(const fs::path& input, const ReadOptions& options) {
    const fs::path headerFile =
        isImgName(input) ? partner(input, {".hdr", ".HDR", ".hdr.gz"}) : input;
    const NiftiHeader header = readHeader(headerFile);
    refuseCifti(headerFile, header);
    const Extents extents = extentsOf(headerFile, header);
    std::vector<Warning> warnings;
    SampleLayout layout = layoutOf(headerFile, header, warnings);
    layout.volumeCount = extents.volumeCount;
    requireImageBytes(headerFile, extents.size, layout.stored);
    const std::string_view components = componentsOf(header.intent);
    layout.volume = chooseVolume(
        headerFile, extents.volumeCount, options,
        components.empty()
            ? ""
            : fmt::format("is 4-D: it holds {} components of {}", extents.volumeCount, components));
    const ImageGeometry geometry = geometryOf(headerFile, header, extents.size, warnings);

    const fs::path dataFile =
        header.hasDataInside ? headerFile : partner(headerFile, {".img", ".IMG", ".img.gz"});
    DataPlace place{headerFile, dataFile, ByteSource::encodingOf(dataFile)};
    place.bytes = requireDataOffset(headerFile, header);
    if (!header.hasDataInside) place.skipName = "vox_offset";
    PlacedVolume read = readPlaced(place, layout, geometry);
    requireVoxelsBehindExtensions(headerFile, header, read.tail.byteCount);
    checkTail(place, read.tail, layout, extents.size, warnings);
    return {std::move(read.volume), header.version == 1 ? "NIfTI-1" : "NIfTI-2",
            std::move(warnings), layout.scalingText("scl_slope", "scl_inter")};
}

}  // namespace adaptiso::detail
