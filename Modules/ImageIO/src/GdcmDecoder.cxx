#include "GdcmDecoder.h"

#include <fmt/core.h>
#include <gdcmImageReader.h>
#include <gdcmTrace.h>

#include "FileFault.h"

namespace adaptiso::detail {
namespace {

/// GDCM's warnings go to stderr by default, and may quote the header.
class SilentGdcm {
public:
    SilentGdcm()
        : warning_(gdcm::Trace::GetWarningFlag()),
          debug_(gdcm::Trace::GetDebugFlag()),
          error_(gdcm::Trace::GetErrorFlag()) {
        set(false, false, false);
    }
    ~SilentGdcm() { set(warning_, debug_, error_); }
    SilentGdcm(const SilentGdcm&) = delete;
    SilentGdcm& operator=(const SilentGdcm&) = delete;

private:
    static void set(bool warning, bool debug, bool error) {
        gdcm::Trace::SetWarning(warning);
        gdcm::Trace::SetDebug(debug);
        gdcm::Trace::SetError(error);
    }
    bool warning_, debug_, error_;
};

bool matches(const gdcm::Image& image, const DicomPixelFormat& format) {
    const gdcm::PixelFormat pixels = image.GetPixelFormat();
    const bool isSigned = pixels.GetPixelRepresentation() == 1;
    const bool wantsSigned = format.stored == PixelType::Int8 ||
                             format.stored == PixelType::Int16 || format.stored == PixelType::Int32;
    const std::int64_t frames = image.GetNumberOfDimensions() == 3 ? image.GetDimension(2) : 1;
    return image.GetDimension(0) == format.columns && image.GetDimension(1) == format.rows &&
           frames == format.frames && pixels.GetSamplesPerPixel() == 1 &&
           pixels.GetBitsAllocated() == 8 * bytesPerPixel(format.stored) &&
           isSigned == wantsSigned && image.GetBufferLength() == format.byteCount();
}

}  // namespace

void decodeWithGdcm(const std::filesystem::path& file, const DicomPixelFormat& format,
                    std::vector<std::byte>& samples) {
    const SilentGdcm silence;
    gdcm::ImageReader reader;
    reader.SetFileName(file.c_str());
    bool isDecoded = false;
    try {
        if (reader.Read()) {
            if (!matches(reader.GetImage(), format)) {
                refuse(file, "its pixel data have another size than its header says",
                       "get the file again");
            }
            samples.resize(format.byteCount());
            isDecoded = reader.GetImage().GetBuffer(reinterpret_cast<char*>(samples.data()));
        }
    } catch (const Error&) {
        throw;
    } catch (const std::exception&) {
        isDecoded = false;
    }
    if (!isDecoded) {
        refuse(file, "GDCM can't decode its pixel data",
               "the file is damaged or of an unknown kind");
    }
}

}  // namespace adaptiso::detail
