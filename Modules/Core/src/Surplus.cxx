#include "adaptiso/Core/Surplus.h"

namespace adaptiso {

bool areZeros(std::string_view bytes) {
    return bytes.find_first_not_of('\0') == std::string_view::npos;
}

bool isMoreData(std::uint64_t surplus, std::uint64_t record, std::uint64_t counted) {
    return surplus > 0 && (surplus % record == 0 || (counted > 0 && surplus >= counted / 2));
}

}  // namespace adaptiso
