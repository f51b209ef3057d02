#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace adaptiso::fuzz {

/// A folder of this process alone, for readers that take paths. In TMPDIR, which run.sh puts into
/// memory and removes, for a crash removes nothing.
class InputFolder {
public:
    InputFolder();
    ~InputFolder();
    InputFolder(const InputFolder&) = delete;
    InputFolder& operator=(const InputFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

    /// Aborts when the disk is full: that must not look like a sound parser.
    std::filesystem::path write(const std::string& name, std::string_view bytes) const;

private:
    std::filesystem::path path_;
};

}  // namespace adaptiso::fuzz
