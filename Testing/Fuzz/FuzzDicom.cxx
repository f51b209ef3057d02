// libFuzzer target: bytes that claim to be the DICOM files of one folder, one after the other
// (`cat *.dcm`). They are refused with a FileError or give a sound volume, as a folder and, the
// first, as a file. GDCM is not asked (Decoders.cxx).

#include <cstdint>
#include <string_view>
#include <vector>

#include "InputFolder.h"
#include "ReadFuzzed.h"

namespace {

constexpr std::size_t kMostFiles = 8;

/// A file begins 128 bytes before its "DICM".
std::vector<std::string_view> filesIn(std::string_view bytes) {
    constexpr std::size_t kPreamble = 128;
    std::vector<std::string_view> files;
    std::size_t begin = 0;
    for (std::size_t at = bytes.find("DICM"); files.size() + 1 < kMostFiles;) {
        at = bytes.find("DICM", at == std::string_view::npos ? at : at + 1);
        if (at == std::string_view::npos) break;
        if (at < begin + kPreamble) continue;
        files.push_back(bytes.substr(begin, at - kPreamble - begin));
        begin = at - kPreamble;
    }
    files.push_back(bytes.substr(begin));
    return files;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const adaptiso::fuzz::InputFolder folder;
    const auto files = filesIn({reinterpret_cast<const char*>(data), size});
    for (std::size_t n = 0; n < files.size(); ++n) folder.write(std::to_string(n), files[n]);
    for (std::size_t n = files.size(); n < kMostFiles; ++n) {
        std::filesystem::remove(folder.path() / std::to_string(n));
    }
    adaptiso::fuzz::readFuzzed(folder.path());
    adaptiso::fuzz::listFuzzed(folder.path());
    adaptiso::ReadOptions options;
    options.volumeIndex = 0;
    options.resampleSlices = true;
    adaptiso::fuzz::readFuzzed(folder.path(), options);
    adaptiso::fuzz::readFuzzed(folder.path() / "0", options);
    return 0;
}
