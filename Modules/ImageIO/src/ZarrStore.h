#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace adaptiso::detail {

/// An open file of a Zarr hierarchy: metadata, a chunk or a shard.
class ZarrFile {
public:
    ZarrFile(std::filesystem::path path, int descriptor);

    const std::filesystem::path& path() const { return path_; }
    std::uint64_t size() const { return size_; }
    /// \throws FileError  the file has not as many bytes there, or its disk fails
    void read(std::uint64_t offset, void* out, std::size_t byteCount) const;

private:
    struct CloseFile {
        void operator()(const int* descriptor) const;
    };
    std::filesystem::path path_;
    std::unique_ptr<const int, CloseFile> descriptor_;
    std::uint64_t size_ = 0;
};

/// The folder of a Zarr hierarchy. Nothing outside it is opened, but what a link of git-annex leads
/// to.
class ZarrStore {
public:
    explicit ZarrStore(std::filesystem::path root) : root_(std::move(root)) {}

    const std::filesystem::path& root() const { return root_; }

    /// The file of a key ("0/c/1/2/3"); none: there is none (ENOENT), which nothing else means.
    /// \throws FileError  it can't be opened, is no regular file, is empty, or lies elsewhere
    std::optional<ZarrFile> open(const std::string& key) const;

    /// The whole of a small file. \throws FileError  as open(), or it is larger than 16 MiB
    std::optional<std::string> readText(const std::string& key) const;

private:
    std::filesystem::path root_;
};

using ZarrJson = nlohmann::json;

/// A JSON object in a file of the store; none: there is no such file.
/// \throws FileError  it is none
std::optional<ZarrJson> readZarrJson(const ZarrStore& store, const std::string& key);

/// The member `key` of an object, or null.
const ZarrJson& memberOf(const ZarrJson& object, const char* key);

/// A value of the metadata for a message: one line, and of lists and objects their kind alone,
/// since they may be as deep as a hostile file likes.
std::string shownJson(const ZarrJson& value);

/// A text that must be there. \throws FileError
std::string textOf(const std::filesystem::path& file, const ZarrJson& object, const char* key);

/// A list of whole numbers from `least` on, one at least. \throws FileError
std::vector<std::uint64_t> numbersOf(const std::filesystem::path& file, const ZarrJson& object,
                                     const char* key, std::uint64_t least);

}  // namespace adaptiso::detail
