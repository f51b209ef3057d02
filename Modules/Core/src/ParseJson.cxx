#include "adaptiso/Core/ParseJson.h"

namespace adaptiso {

bool isDeeplyNested(std::string_view json) {
    constexpr int kDeepest = 100;
    int depth = 0;
    bool isInText = false;
    for (std::size_t at = 0; at < json.size(); ++at) {
        const char c = json[at];
        if (isInText) {
            if (c == '\\') ++at;
            isInText = c != '"';
        } else if (c == '"') {
            isInText = true;
        } else if (c == '[' || c == '{') {
            if (++depth > kDeepest) return true;
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
    return false;
}

}  // namespace adaptiso
