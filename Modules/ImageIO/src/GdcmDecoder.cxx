#include "GdcmDecoder.h"

#include <gdcmImageCodec.h>
#include <gdcmJPEG2000Codec.h>
#include <gdcmJPEGCodec.h>
#include <gdcmJPEGLSCodec.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>
#include <gdcmTransferSyntax.h>

#include <cstring>
#include <memory>

#include "FileFault.h"
#include "Sandbox.h"

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

/// Compressed pixel data of one fragment: `stream`.
gdcm::DataElement pixelDataOf(std::string_view stream) {
    gdcm::Fragment fragment;
    fragment.SetByteValue(stream.data(), static_cast<std::uint32_t>(stream.size()));
    gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = new gdcm::SequenceOfFragments;
    fragments->AddFragment(fragment);
    gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010));
    pixels.SetVR(gdcm::VR::OB);
    pixels.SetValue(*fragments);
    return pixels;
}

gdcm::PixelFormat pixelFormatOf(const Codestream& codestream) {
    const auto precision = static_cast<unsigned short>(codestream.precision);
    return gdcm::PixelFormat(1, static_cast<unsigned short>(8 * codestream.wordBytes()), precision,
                             static_cast<unsigned short>(precision - 1),
                             static_cast<unsigned short>(codestream.isSigned ? 1 : 0));
}

/// The codec itself: gdcm::Image would try others when it fails, among them one that loops for ever
/// over damaged JPEG (PVRG).
std::unique_ptr<gdcm::ImageCodec> codecFor(const gdcm::TransferSyntax& syntax) {
    if (gdcm::JPEGCodec().CanDecode(syntax)) return std::make_unique<gdcm::JPEGCodec>();
    if (gdcm::JPEGLSCodec().CanDecode(syntax)) return std::make_unique<gdcm::JPEGLSCodec>();
    if (gdcm::JPEG2000Codec().CanDecode(syntax)) return std::make_unique<gdcm::JPEG2000Codec>();
    return nullptr;
}

/// \return false when it can't, or finds other sizes than the codestream's header says
bool decode(std::string_view stream, const std::string& transferSyntax,
            const Codestream& codestream, std::span<std::byte> samples) {
    const auto codec =
        codecFor(gdcm::TransferSyntax(gdcm::TransferSyntax::GetTSType(transferSyntax.c_str())));
    if (!codec) return false;
    const unsigned size[3] = {static_cast<unsigned>(codestream.columns),
                              static_cast<unsigned>(codestream.rows), 1};
    codec->SetNumberOfDimensions(2);
    codec->SetDimensions(size);
    codec->SetPlanarConfiguration(0);
    codec->SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
    codec->SetPixelFormat(pixelFormatOf(codestream));
    gdcm::DataElement decoded;
    if (!codec->Decode(pixelDataOf(stream), decoded)) return false;
    const gdcm::ByteValue* bytes = decoded.GetByteValue();
    // GDCM pads to an even number of bytes
    if (!bytes || (bytes->GetLength() + 1U) / 2 != (samples.size() + 1) / 2) return false;
    std::memcpy(samples.data(), bytes->GetPointer(), samples.size());
    return true;
}

}  // namespace

void decodeWithGdcm(const std::filesystem::path& file, std::string_view stream,
                    const std::string& transferSyntax, const Codestream& codestream,
                    std::span<std::byte> samples) {
    blameInSandbox(file);
    const SilentGdcm silence;
    bool isDecoded = false;
    try {
        isDecoded = decode(stream, transferSyntax, codestream, samples);
    } catch (const std::exception&) {
        isDecoded = false;
    }
    if (!isDecoded) {
        refuse(file, "GDCM can't decode its pixel data",
               "the file is damaged or of an unknown kind");
    }
}

}  // namespace adaptiso::detail
