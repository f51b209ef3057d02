// ITK's own readers, for readVolume(): formats that this library has no reader for, and plug-ins.
#include <itkBruker2dseqImageIO.h>
#include <itkGE4ImageIO.h>
#include <itkGE5ImageIO.h>
#include <itkGEAdwImageIO.h>
#include <itkGiplImageIO.h>
#include <itkHDF5ImageIO.h>
#include <itkMINCImageIO.h>
#include <itkMRCImageIO.h>
#include <itkObjectFactoryBase.h>
#include <itkSiemensVisionImageIO.h>
#include <itkStimulateImageIO.h>
#include <itkTIFFImageIO.h>
#include <itkVTKImageIO.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/TextLines.h"
#include "adaptiso/ImageIO/ItkReaders.h"

namespace adaptiso {
namespace {

/// A property that a reader of ITK does not know, and its warning.
struct Doubt {
    const char *code, *text;
};
constexpr Doubt kSpacing{"guessed-spacing", "may not know the voxel size"},
    kEvenSteps{"guessed-spacing", "takes one distance for all slices, even where one is missing"},
    kThickness{"guessed-spacing", "takes the thickness of slices, and no gap, for their distance"},
    kWholeThickness{"guessed-spacing",
                    "takes the thickness of slices in whole mm, and no gap, for their distance"},
    kOrientation{"guessed-orientation",
                 "does not know the orientation: its axes are taken for LPS"},
    kPlane{"guessed-orientation", "knows axial, sagittal and coronal slices, no oblique ones"},
    kOneVoxel{"guessed-position", "may be off by a voxel"},
    kPosition{"guessed-position", "does not know the position: the first voxel is put at 0, 0, 0"},
    kUnit{"guessed-unit", "takes angstroms for mm"},
    kPlugIn{"guessed-orientation",
            "is of a plug-in (ITK_AUTOLOAD_PATH): size, place and values are as it gives them"};

struct Format {
    std::string name;
    itk::ImageIOBase::Pointer (*make)();
    std::vector<Doubt> doubts{};
    bool isRas = false;         ///< ITK 5.2 keeps the file's own axes
    bool mayStopShort = false;  ///< without a word, where the file ends early
    bool opensOthers = false;   ///< files beside the one that is named
};

template <class Io>
itk::ImageIOBase::Pointer make() {
    return Io::New().GetPointer();
}

const Format kFormats[] = {
    {"MINC", make<itk::MINCImageIO>, {}, true},
    {"GIPL", make<itk::GiplImageIO>, {kOrientation}, false, true},
    {"TIFF", make<itk::TIFFImageIO>, {kOrientation, kSpacing}},
    {"VTK image", make<itk::VTKImageIO>, {kOrientation}, false, true},
    {"MRC", make<itk::MRCImageIO>, {kOrientation, kUnit}, false, true},
    {"Bruker 2dseq", make<itk::Bruker2dseqImageIO>, {kEvenSteps, kOneVoxel}, false, false, true},
    {"GE 4", make<itk::GE4ImageIO>, {kEvenSteps, kPlane, kPosition}, false, false, true},
    {"GE 5", make<itk::GE5ImageIO>, {kEvenSteps, kOneVoxel}, false, false, true},
    {"GE Advantage", make<itk::GEAdwImageIO>, {kThickness, kPlane, kPosition}, false, false, true},
    {"Siemens Vision",
     make<itk::SiemensVisionImageIO>,
     {kWholeThickness, kPlane, kPosition},
     false,
     false,
     true},
    {"Stimulate", make<itk::StimulateImageIO>, {kOrientation}, false, false, true},
    {"ITK HDF5", make<itk::HDF5ImageIO>},
};

PixelType pixelTypeOf(const ItkRequest& request, const itk::ImageIOBase& io) {
    const auto refuse = [&](const std::string& fault) {
        return FileError(request.file.string() + ": " + fault + "; give a scalar 3-D image");
    };
    if (io.GetNumberOfComponents() != 1) {
        throw refuse("has " + std::to_string(io.GetNumberOfComponents()) +
                     " values a voxel (colours or vectors)");
    }
    using enum PixelType;  // in the order of ITK's, whose long has 64 bits on Linux
    constexpr PixelType kTypes[]{UInt8,  Int8,  UInt16, Int16,  UInt32,  Int32,
                                 UInt64, Int64, Int64,  UInt64, Float32, Float64};
    const auto place = static_cast<std::size_t>(io.GetComponentType()) -
                       static_cast<std::size_t>(itk::IOComponentEnum::UCHAR);
    if (place >= std::size(kTypes)) throw refuse("has samples of an unknown type");
    return kTypes[place];
}

ImageGeometry geometryOf(const itk::ImageIOBase& io, bool isRas) {
    ImageGeometry geometry;
    const unsigned dimensions = io.GetNumberOfDimensions();
    for (unsigned axis = 0; axis < 3; ++axis) {
        const bool isThere = axis < dimensions;
        geometry.size[axis] = isThere ? static_cast<std::int64_t>(io.GetDimensions(axis)) : 1;
        geometry.originMm[static_cast<int>(axis)] = isThere ? io.GetOrigin(axis) : 0;
        const std::vector<double> direction =
            isThere ? io.GetDirection(axis) : std::vector<double>{0, 0, 1};
        for (unsigned row = 0; row < 3; ++row) {
            geometry.indexToPhysical.column[axis][static_cast<int>(row)] =
                row < direction.size() ? direction[row] * (isThere ? io.GetSpacing(axis) : 1) : 0;
        }
    }
    if (!isRas) return geometry;
    for (Vec3* each : {&geometry.originMm, &geometry.indexToPhysical.column[0],
                       &geometry.indexToPhysical.column[1], &geometry.indexToPhysical.column[2]}) {
        *each = {0 - each->x, 0 - each->y, each->z};
    }
    return geometry;
}

std::vector<Warning> warningsOf(const Format& format) {
    std::vector<Warning> warnings;
    for (const Doubt& doubt : format.doubts) {
        warnings.push_back({doubt.code, "ITK's reader of " + format.name + " " + doubt.text});
    }
    return warnings;
}

FileError cutOff(const std::filesystem::path& file) {
    return FileError(file.string() + ": is shorter than its header says; get it again");
}

/// Whole numbers of a file.
class Numbers {
public:
    Numbers(const std::filesystem::path& path, bool isLittle)
        : path_(path), file_(path, std::ios::binary), isLittle_(isLittle) {}

    /// \throws FileError  the file ends before
    std::uint64_t at(std::uint64_t place, int bytes) {
        file_.seekg(static_cast<std::streamoff>(place));
        std::uint64_t value = 0;
        for (int n = 0; n < bytes; ++n) {
            const auto byte = static_cast<std::uint64_t>(file_.get() & 0xFF);
            value |= byte << 8 * (isLittle_ ? n : bytes - 1 - n);
        }
        if (!file_) throw cutOff(path_);
        return value;
    }

private:
    std::filesystem::path path_;
    std::ifstream file_;
    bool isLittle_;
};

/// Width, height, bits, photometry, samples a pixel, and their format, of a page of a TIFF.
std::array<std::uint64_t, 6> tiffLayout(Numbers& file, std::uint64_t page, bool& isThumbnail) {
    constexpr std::array kTags{256, 257, 258, 262, 277, 339};
    std::array<std::uint64_t, 6> layout{0, 0, 1, 1, 1, 1};
    isThumbnail = false;
    for (std::uint64_t left = file.at(page, 2), at = page + 2; left > 0; --left, at += 12) {
        const auto tag = static_cast<int>(file.at(at, 2));
        const std::uint64_t value =
            file.at(at + 8, file.at(at + 2, 2) == 3 ? 2 : 4);  // short, long
        const auto* const found = std::ranges::find(kTags, tag);
        if (found != kTags.end()) layout[static_cast<std::size_t>(found - kTags.begin())] = value;
        if (tag == 254) isThumbnail = (value & 1) != 0;
    }
    return layout;
}

/// The directories of all pages are there; libtiff takes those that are for the whole. ITK reads
/// all pages as the first one.
void requireWholeTiff(const std::filesystem::path& path) {
    const auto refuse = [&](const char* fault) { return FileError(path.string() + fault); };
    Numbers file(path, std::ifstream(path).get() == 'I');  // "II": Intel's order
    const std::uint64_t most = std::filesystem::file_size(path);
    std::optional<std::array<std::uint64_t, 6>> first;
    std::uint64_t pages = 0;
    for (std::uint64_t page = file.at(4, 4); page != 0;
         page = file.at(page + 2 + 12 * file.at(page, 2), 4)) {
        if (++pages > most / 18) throw cutOff(path);  // a ring
        bool isThumbnail = false;
        const auto layout = tiffLayout(file, page, isThumbnail);
        if (isThumbnail) continue;
        if (!first) first = layout;
        if (layout != *first)
            throw refuse(": its pages differ in size or pixels; give pages of one kind");
    }
    if (first && first->at(2) == 32 && first->at(5) != 3) {
        throw refuse(
            ": has 32-bit integers, which ITK's reader of TIFF does not read; save floats");
    }
    if (first && first->at(3) == 0) {
        throw refuse(": 0 is white in it, which ITK's reader of TIFF turns over; save black as 0");
    }
}

/// MINC 1 is netCDF (classic), whose library fills up with zeros where the file ends early.
void requireWholeNetCdf(const std::filesystem::path& path) {
    Numbers file(path, false);
    if (file.at(0, 3) != 0x434446) return;  // "CDF"
    std::uint64_t place = 8, end = 0;
    const auto take = [&](int bytes) {
        return file.at(std::exchange(place, place + bytes), bytes);
    };
    const auto skip = [&](std::uint64_t bytes) { place += (bytes + 3) / 4 * 4; };
    const auto each = [&](const auto& work) {  // of a list: its tag, its length
        take(4);
        for (std::uint64_t left = take(4); left > 0; --left) {
            skip(take(4));  // its name
            work();
        }
    };
    const auto attribute = [&] {
        constexpr std::uint64_t kBytes[]{1, 1, 1, 2, 4, 4, 8};  // byte, char, short, int, ...
        const std::uint64_t bytes = kBytes[std::min<std::uint64_t>(take(4), 6)];
        skip(bytes * take(4));
    };
    each([&] { take(4); });  // dimensions
    each(attribute);
    each([&] {  // variables
        skip(4 * take(4));
        each(attribute);
        take(4);
        const std::uint64_t bytes = take(4);
        end = std::max(end, take(file.at(3, 1) == 2 ? 8 : 4) + bytes);
    });
    if (std::filesystem::file_size(path) + 3 < end)
        throw cutOff(path);  // the last may lack its fill
}

/// ITK's reader takes 8-bit samples for unsigned ones, as IMOD wrote them once, and the axes for x,
/// y, z in this order.
void requirePlainMrc(const std::filesystem::path& path) {
    Numbers file(path, Numbers(path, true).at(212, 1) == 0x44);  // the machine's stamp
    constexpr std::uint64_t kImod = 1146047817;
    const bool isUnsigned = file.at(152, 4) == kImod && (file.at(156, 4) & 1) == 0;
    if (file.at(12, 4) == 0 && !isUnsigned) {
        throw FileError(path.string() +
                        ": has signed 8-bit samples (mode 0), which ITK's reader of "
                        "MRC takes for unsigned ones; save 16 bits (mode 1)");
    }
    for (std::uint64_t axis = 0; axis < 3; ++axis) {
        const std::uint64_t named = file.at(64 + 4 * axis, 4);
        if (named == 0 || named == axis + 1) continue;
        throw FileError(path.string() +
                        ": its columns, rows and sections are not x, y and z, which "
                        "ITK's reader of MRC ignores; reorder them");
    }
}

/// ITK's readers of such formats take slices, headers and data of the files beside the one that is
/// named; Bruker's of the acquisition's folder, two above (acqp, method).
/// \throws FileError  one of these is a link to outside of it
void requireNoLinkOut(const Format& format, const std::filesystem::path& path) {
    namespace fs = std::filesystem;
    const fs::path folder = fs::absolute(path).parent_path();
    const bool isBruker =
        format.name == "Bruker 2dseq" && folder.parent_path().filename() == "pdata";
    const fs::path acquisition = folder.parent_path().parent_path();
    std::vector<fs::path> folders{folder};
    if (isBruker) folders.push_back(acquisition);
    std::error_code error;
    for (const fs::path& each : folders) {
        for (const fs::directory_entry& entry : fs::directory_iterator(each, error)) {
            if (!entry.is_symlink(error) || !fs::is_regular_file(entry.path(), error)) continue;
            if (fs::equivalent(entry.path(), path, error)) continue;  // the user named it
            if (isBruker && liesIn(entry.path(), acquisition)) continue;
            requireBeside(entry.path(), path);
        }
    }
}

/// Its header is 14336 bytes; ITK's reader takes the end of each file of the series for the slice.
void requireWholeGe4(itk::ImageIOBase& io, const std::filesystem::path& path) {
    const std::filesystem::path folder = path.parent_path();
    for (const auto& entry : std::filesystem::directory_iterator(folder.empty() ? "." : folder)) {
        if (!entry.is_regular_file() || !io.CanReadFile(entry.path().c_str())) continue;
        Numbers file(entry.path(), false);
        const std::uint64_t pixels = file.at(5394, 2) * file.at(5396, 2);
        if (entry.file_size() < 14336 + 2 * pixels) throw cutOff(entry.path());
    }
}

/// ITK's reader takes 32-bit integers for 16-bit ones, complex samples for real ones, and data from
/// any folder.
void requireSafeStimulate(const std::filesystem::path& path) {
    std::ifstream file(path);
    const std::string header{std::istreambuf_iterator<char>(file), {}};
    TextLines lines(header);
    while (const auto line = lines.next()) {
        const auto has = [&](std::string_view text) { return line->find(text) != line->npos; };
        if (has("dataType") && (has("LWORD") || has("COMPLEX"))) {
            throw FileError(path.string() +
                            ": has samples (LWORD or COMPLEX) that ITK's reader of Stimulate reads "
                            "wrong; convert it to NIfTI");
        }
        if (has("stimFileName") && has("/")) {
            throw FileError(path.string() +
                            ": names data outside its own folder; put the .sdt "
                            "beside it, and name it without a folder");
        }
    }
}

/// Reads all samples. Some of ITK's readers say nothing of a file that ends early, and leave the
/// rest of the samples as it was.
void readWhole(const Format& format, itk::ImageIOBase& io, const ItkRequest& request,
               std::span<std::byte> samples) {
    const std::span<std::byte> end = samples.last(bytesPerPixel(pixelTypeOf(request, io)));
    std::ranges::fill(end, std::byte{0});
    io.Read(samples.data());
    if (!format.mayStopShort) return;
    const std::vector<std::byte> last(end.begin(), end.end());
    std::ranges::fill(end, std::byte{0xFF});
    io.ReadImageInformation();  // GIPL's reader goes on where that ended
    io.Read(samples.data());
    if (!std::ranges::equal(last, end)) throw cutOff(request.file);
}

ReadVolume readBy(const Format& format, itk::ImageIOBase& io, const ItkRequest& request) {
    if (format.opensOthers) requireNoLinkOut(format, request.file);
    if (format.name == "MINC") requireWholeNetCdf(request.file);
    if (format.name == "GE 4") requireWholeGe4(io, request.file);
    if (format.name == "MRC") requirePlainMrc(request.file);
    if (format.name == "TIFF") requireWholeTiff(request.file);
    if (format.name == "Stimulate") requireSafeStimulate(request.file);
    io.ReadImageInformation();
    const PixelType type = pixelTypeOf(request, io);
    const ImageGeometry geometry = geometryOf(io, format.isRas);
    std::int64_t volumes = 1;
    itk::ImageIORegion region(io.GetNumberOfDimensions());
    for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis) {
        region.SetSize(axis, io.GetDimensions(axis));
        if (axis > 2) volumes *= static_cast<std::int64_t>(io.GetDimensions(axis));
    }
    io.SetIORegion(region);
    const std::int64_t chosen = volumes == 1 ? 0 : request.chooseVolume(volumes);
    const auto samples = request.allocate(geometry, type);
    const std::size_t bytes = static_cast<std::size_t>(geometry.voxelCount()) * bytesPerPixel(type);
    if (volumes == 1) {
        readWhole(format, io, request, {samples.get(), bytes});
    } else {
        std::vector<std::byte> all(bytes * static_cast<std::size_t>(volumes));
        readWhole(format, io, request, all);
        std::memcpy(samples.get(), all.data() + bytes * static_cast<std::size_t>(chosen), bytes);
    }
    return {Volume(VolumeView(samples.get(), type, geometry), samples), format.name + " (ITK)",
            warningsOf(format)};
}

/// \return nothing where `io` does not take the file. \throws FileError
std::optional<ReadVolume> readIfIts(const Format& format, itk::ImageIOBase& io,
                                    const ItkRequest& request) {
    // ITK takes any file that has a visu_pars beside it
    if (format.name == "Bruker 2dseq" && request.file.filename() != "2dseq") return std::nullopt;
    try {
        if (!io.CanReadFile(request.file.c_str())) return std::nullopt;
        io.SetFileName(request.file.string());
        return readBy(format, io, request);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception&) {  // its text names places in ITK's sources
        throw FileError(request.file.string() + ": ITK's reader of " + format.name +
                        " cannot read it; get it again, or convert it to NIfTI");
    }
}

}  // namespace
}  // namespace adaptiso

extern "C" void adaptisoReadWithItk(const adaptiso::ItkRequest& request,
                                    std::optional<adaptiso::ReadVolume>& result) {
    for (const adaptiso::Format& format : adaptiso::kFormats) {
        result = adaptiso::readIfIts(format, *format.make(), request);
        if (result) return;
    }
    for (const auto& made : itk::ObjectFactoryBase::CreateAllInstance("itkImageIOBase")) {
        auto* const io = dynamic_cast<itk::ImageIOBase*>(made.GetPointer());
        if (io == nullptr) continue;
        result =
            adaptiso::readIfIts({io->GetNameOfClass(), nullptr, {adaptiso::kPlugIn}}, *io, request);
        if (result) return;
    }
}
