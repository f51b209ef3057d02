#include "Common/CommonFrame.h"
#include "Common/Naming.h"
#include "Run.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso::simplifier {
namespace {

namespace fs = std::filesystem;

bool areSame(const fs::path& a, const fs::path& b) {
    std::error_code error;
    return fs::weakly_canonical(fs::absolute(a), error) ==
           fs::weakly_canonical(fs::absolute(b), error);
}

}  // namespace

fs::path dataFile(const fs::path& data, const fs::path& surface) {
    const fs::path file = surface.parent_path() / data.filename();
    return areSame(file, data) ? insertBeforeExtension(file, ".simplified") : file;
}

}  // namespace adaptiso::simplifier
