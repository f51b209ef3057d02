#include "InputFolder.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>

namespace adaptiso::fuzz {
namespace fs = std::filesystem;

InputFolder::InputFolder()
    : path_(fs::temp_directory_path() / ("adaptiso-fuzz-" + std::to_string(getpid()))) {
    fs::create_directories(path_);
}

InputFolder::~InputFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

fs::path InputFolder::write(const std::string& name, std::string_view bytes) const {
    const fs::path file = path_ / name;
    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    stream << bytes;
    stream.close();
    if (!stream) std::abort();
    return file;
}

}  // namespace adaptiso::fuzz
