// libFuzzer target: a folder of Zarr or N5. The input is its metadata, a zero byte, and the bytes
// of the files that hold chunks. What the metadata mention decides which they are.

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
        for (const char* const name : {"x/c/0/0", "x/0/0/0", "x/c/0/1", "x/0/0/1", "n/0/0", "n/1/0",
                                       "n/s0/0/0", "n/s1/0/0"}) {
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

constexpr std::string_view kN5Array =
    R"({"dimensions": [5, 4, 3], "blockSize": [5, 4, 3], "dataType": "uint8",
        "compression": {"type": "raw"}})";

/// Where the metadata are kept.
const char* keyOf(std::string_view metadata) {
    const auto mentions = [&](const char* word) { return metadata.find(word) != metadata.npos; };
    if (mentions("blockSize") || mentions("pixelResolution")) return "n/attributes.json";
    if (mentions("node_type")) return "x/zarr.json";
    return mentions("multiscales") ? "x/.zattrs" : "x/.zarray";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view input(reinterpret_cast<const char*>(data), size);
    const std::size_t end = std::min(input.find('\0'), input.size());
    const std::string_view metadata = input.substr(0, end);
    const std::string_view chunk = input.substr(std::min(end + 1, input.size()));
    const adaptiso::fuzz::InputFolder& folder = inputFolder();
    const std::string key = keyOf(metadata);
    const bool isN5 = key.front() == 'n';
    for (const char* const other : {"x/zarr.json", "x/.zarray", "x/.zattrs", "x/0/.zarray"}) {
        fs::remove(folder.path() / other);
    }
    folder.write(key, metadata);
    if (key == "x/.zattrs") folder.write("x/0/.zarray", kArray);
    if (isN5) {
        folder.write("n/s0/attributes.json", kN5Array);
        folder.write("n/s1/attributes.json", kN5Array);
    }
    for (const char* const chunkKey :
         {"x/0.0.0", "x/0.0.1", "x/0/0/0/0", "x/0/0/1/0", "x/c/0/0/0", "x/c/0/0/1", "x/c/0/1/0",
          "n/0/0/0", "n/1/0/0", "n/s0/0/0/0", "n/s1/0/0/0"}) {
        folder.write(chunkKey, chunk);
    }
    const fs::path image = folder.path() / (isN5 ? "n" : "x");
    adaptiso::ReadOptions options;
    adaptiso::fuzz::readFuzzed(image, options);
    options.level = 1;
    options.channel = options.timePoint = options.volumeIndex = 0;
    adaptiso::fuzz::readFuzzed(image, options);
    return 0;
}
