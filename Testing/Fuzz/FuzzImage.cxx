// libFuzzer target: bytes that claim to be an image file with the ending fuzz::ending(), in a
// folder with data files that detached headers may name. They are refused with a FileError or give
// a sound volume. ITK and GDCM are not asked (Decoders.cxx).

#include <cstdint>

#include "Ending.h"
#include "InputFolder.h"
#include "ReadFuzzed.h"

namespace {

const adaptiso::fuzz::InputFolder& inputFolder() {
    static const adaptiso::fuzz::InputFolder folder;
    static const bool hasData = [] {
        folder.write("x.raw", std::string(256, '\1'));
        folder.write("x.img", std::string(256, '\2'));
        return true;
    }();
    static_cast<void>(hasData);
    return folder;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto file = inputFolder().write("x" + adaptiso::fuzz::ending(),
                                          {reinterpret_cast<const char*>(data), size});
    adaptiso::fuzz::readFuzzed(file);
    adaptiso::ReadOptions options;
    options.volumeIndex = 0;
    adaptiso::fuzz::readFuzzed(file, options);
    return 0;
}
