// libFuzzer target: a folder of Zarr. The input is its metadata, a zero byte, and the bytes of the
// files that hold chunks. What the metadata mention decides which they are.

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "InputFolder.h"
#include "ReadFuzzed.h"

namespace {

namespace fs = std::filesystem;

const adaptiso::fuzz::InputFolder& inputFolder() {
    static const adaptiso::fuzz::InputFolder folder;
    static const bool hasFolders = [] {
        for (const char* const name : {"x/c/0/0", "x/0/0/0", "x/c/0/1", "x/0/0/1"}) {
            fs::create_directories(folder.path() / name);
        }
        return true;
    }();
    static_cast<void>(hasFolders);
    return folder;
}

/// The array of an OME-Zarr whose metadata are fuzzed.
constexpr std::string_view kArray =
    R"({"zarr_format": 2, "shape": [3, 4, 5], "chunks": [3, 4, 5], "dtype": "|u1", "order": "C",
        "fill_value": 1, "filters": null, "compressor": null})";

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view input(reinterpret_cast<const char*>(data), size);
    const std::size_t end = std::min(input.find('\0'), input.size());
    const std::string_view metadata = input.substr(0, end);
    const std::string_view chunk = input.substr(std::min(end + 1, input.size()));
    const adaptiso::fuzz::InputFolder& folder = inputFolder();
    const bool isGroup = metadata.find("multiscales") != metadata.npos;
    const bool isThird = metadata.find("node_type") != metadata.npos;
    for (const char* const other : {"x/zarr.json", "x/.zarray", "x/.zattrs", "x/0/.zarray"}) {
        fs::remove(folder.path() / other);
    }
    folder.write(isThird ? "x/zarr.json" : isGroup ? "x/.zattrs" : "x/.zarray", metadata);
    if (isGroup) folder.write("x/0/.zarray", kArray);
    for (const char* const key :
         {"x/0.0.0", "x/0.0.1", "x/0/0/0/0", "x/0/0/1/0", "x/c/0/0/0", "x/c/0/0/1", "x/c/0/1/0"}) {
        folder.write(key, chunk);
    }
    adaptiso::ReadOptions options;
    adaptiso::fuzz::readFuzzed(folder.path() / "x", options);
    options.level = 1;
    options.channel = options.timePoint = options.volumeIndex = 0;
    adaptiso::fuzz::readFuzzed(folder.path() / "x", options);
    return 0;
}
