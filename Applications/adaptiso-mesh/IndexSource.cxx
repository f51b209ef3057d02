#include "IndexSource.h"

#include <cstddef>
#include <fstream>
#include <string>
#include <vector>

#include "Common/Json.h"
#include "Common/Naming.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/SpanSpace/IndexFile.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

std::vector<std::byte> readBytes(const fs::path& path, const VolumeView& volume) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw FileError(path.string() + ": can't be opened for reading");
    const std::uintmax_t size = fs::file_size(path);
    if (size > largestIndexBytes(volume)) {
        throw InvalidInput(path.string() + ": is longer than any index of this image");
    }
    std::vector<std::byte> bytes(size);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (!file) throw FileError(path.string() + ": can't be read");
    return bytes;
}

std::string borderWord(Border border) {
    return border == Border::Closed ? "closed" : "open";
}

/// An option that was given must be what the index was made with.
void requireSame(const MeshOptions& options, const IndexOptions& kept) {
    const auto check = [&](bool isGiven, const std::string& option, const std::string& wanted,
                           const std::string& has) {
        if (!isGiven || wanted == has) return;
        throw InvalidInput(option + " " + wanted + ": " + options.indexFiles.load.string() +
                           " was made with " + option + " " + has);
    };
    const IndexFiles& given = options.indexFiles;
    check(given.givesBlockSize, "--block-size", std::to_string(options.index.blockSize),
          std::to_string(kept.blockSize));
    check(given.givesBorder, "--border", borderWord(options.index.border), borderWord(kept.border));
    check(given.givesSearch, "--search", std::string(toString(options.index.search)),
          std::string(toString(kept.search)));
    if (kept.border == Border::Open && options.needsClosedSurfaces()) {
        throw InvalidInput(given.load.string() +
                           ": was made with --border open; --min-volume and --fill-cavities need "
                           "closed surfaces");
    }
}

}  // namespace

void checkIndexFile(const MeshOptions& options) {
    const fs::path& path = options.indexFiles.load;
    if (path.empty()) return;
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) throw FileError(path.string() + ": there is no such file");
    if (!fs::is_regular_file(status)) {
        throw FileError(path.string() + ": is not a regular file");
    }
}

SpanSpaceIndex prepareIndex(const VolumeView& volume, MeshOptions& options) {
    const fs::path& path = options.indexFiles.load;
    if (path.empty()) {
        return naming(baseName(options.input),
                      [&] { return SpanSpaceIndex::build(volume, options.index); });
    }
    SpanSpaceIndex index = decodeIndex(readBytes(path, volume), volume, path.string());
    requireSame(options, index.options());
    options.index = index.options();
    return index;
}

}  // namespace adaptiso
