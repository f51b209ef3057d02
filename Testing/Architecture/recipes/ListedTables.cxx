// A label table for recipes.py: names in their order, under a line that says so.
#include "Rows.h"

namespace adaptiso::labelnames {
namespace {

constexpr std::string_view kFirstLine = "labels in their order";

bool isListed(const TableFile& file) {
    return file.text.starts_with(kFirstLine);
}

LabelTable decodeListed(const TableFile& file) {
    Collector found("listed names");
    std::int32_t value = 0;
    for (const Line& line : linesOf(file.text)) {
        if (line.number > 1) found.add({++value, std::string(line.text), {}, {}});
    }
    return found.finish();
}

}  // namespace

extern const TableCodec kListedTables{isListed, decodeListed};

}  // namespace adaptiso::labelnames
