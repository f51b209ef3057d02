#include "Fiff.h"

#include <array>

#include "ByteSource.h"

namespace adaptiso::meshio::fiff {
namespace {

constexpr std::uint32_t kVoid = 0, kInt = 3, kFloat = 4, kString = 10, kIdStruct = 31,
                        kDigPointStruct = 33, kMatrix = 0x40000000;
constexpr std::size_t kIdBytes = 20;
constexpr std::int32_t kVersion = (1 << 16) | 4;
constexpr auto kBig = std::endian::big;

void requireType(const Tag& tag, std::uint32_t type, std::size_t bytes) {
    if (tag.type == type && tag.data.size() >= bytes) return;
    damaged("its tag " + std::to_string(tag.kind) + " is of type " + std::to_string(tag.type) +
            " and " + std::to_string(tag.data.size()) + " bytes, must be of type " +
            std::to_string(type) + " and " + std::to_string(bytes) + " bytes or more");
}

/// The number of rows of a matrix with three columns whose elements take four bytes.
std::size_t rowsOf(const Tag& tag, std::uint32_t element) {
    constexpr std::size_t kTail = 3 * sizeof(std::int32_t), kRow = 12;
    requireType(tag, kMatrix | element, kTail);
    const char* const tail = tag.data.data() + tag.data.size() - kTail;
    const auto columns = loadAs<std::int32_t>(tail, kBig);
    const auto rows = loadAs<std::int32_t>(tail + 4, kBig);
    const auto dimensions = loadAs<std::int32_t>(tail + 8, kBig);
    const std::size_t bytes = tag.data.size() - kTail;
    if (dimensions != 2 || columns != 3 || rows < 0 || bytes % kRow != 0 ||
        static_cast<std::size_t>(rows) != bytes / kRow) {
        damaged("its tag " + std::to_string(tag.kind) + " is no matrix with three columns");
    }
    return bytes / kRow;
}

}  // namespace

const Tag* Content::find(std::size_t block, std::int32_t kind) const {
    for (const Tag& tag : tags) {
        if (tag.block == block && tag.kind == kind) return &tag;
    }
    return nullptr;
}

Content decode(std::string_view bytes) {
    ByteSource source(bytes);
    Content content;
    content.blocks.push_back({});
    std::size_t block = 0;
    bool isLast = false;
    while (!isLast && !source.atEnd()) {
        Tag tag;
        tag.kind = source.number<std::int32_t>(kBig);
        tag.type = source.number<std::uint32_t>(kBig);
        const auto size = source.number<std::int32_t>(kBig);
        const auto next = source.number<std::int32_t>(kBig);
        if (content.tags.empty() && (tag.kind != kFileId || tag.type != kIdStruct)) {
            damaged("it does not begin with the tag of a FIFF file");
        }
        requireRoom("bytes of a tag", size, 1, source.left());
        tag.data = source.take(size);
        isLast = next == -1;
        if (next > 0) {
            if (static_cast<std::size_t>(next) < source.position()) {
                unsupported("its tags are not in their order", "save it again with MNE");
            }
            if (static_cast<std::size_t>(next) > bytes.size()) damaged("a tag leads past its end");
            source.seek(next);
        }
        if (tag.kind == kBlockStart) {
            content.blocks.push_back({toInt(tag), block});
            block = content.blocks.size() - 1;
        }
        tag.block = block;
        content.tags.push_back(tag);
        if (tag.kind == kBlockEnd) {
            if (block == 0) damaged("a block ends that did not begin");
            block = content.blocks[block].parent;
        }
    }
    if (content.tags.empty()) damaged("it is empty");
    return content;
}

std::int32_t toInt(const Tag& tag) {
    requireType(tag, kInt, sizeof(std::int32_t));
    return loadAs<std::int32_t>(tag.data.data(), kBig);
}

float toReal(const Tag& tag) {
    requireType(tag, kFloat, sizeof(float));
    return loadAs<float>(tag.data.data(), kBig);
}

std::vector<Vec3> toVectors(const Tag& tag) {
    std::vector<Vec3> rows(rowsOf(tag, kFloat));
    const char* at = tag.data.data();
    for (Vec3& row : rows) {
        for (int axis = 0; axis < 3; ++axis, at += sizeof(float))
            row[axis] = loadAs<float>(at, kBig);
    }
    return rows;
}

std::vector<std::array<std::int32_t, 3>> toTriples(const Tag& tag) {
    std::vector<std::array<std::int32_t, 3>> rows(rowsOf(tag, kInt));
    const char* at = tag.data.data();
    for (auto& row : rows) {
        for (std::int32_t& value : row) {
            value = loadAs<std::int32_t>(at, kBig);
            at += sizeof(value);
        }
    }
    return rows;
}

DigitizedPoint toPoint(const Tag& tag) {
    constexpr std::size_t kBytes = 20;
    requireType(tag, kDigPointStruct, kBytes);
    const char* const bytes = tag.data.data();
    DigitizedPoint point{
        loadAs<std::int32_t>(bytes, kBig), loadAs<std::int32_t>(bytes + 4, kBig), {}};
    for (int axis = 0; axis < 3; ++axis) {
        point.metres[axis] = loadAs<float>(bytes + 8 + 4 * axis, kBig);
    }
    return point;
}

Writer::Writer(ByteSink& sink) : sink_(sink) {
    header(kFileId, kIdStruct, kIdBytes);
    sink_.bigEndian(kVersion);
    for (int n = 0; n < 4; ++n) sink_.bigEndian(std::int32_t{0});  // machine and time
    put(kDirectoryPointer, -1);
    put(kFreeList, -1);
}

void Writer::header(std::int32_t kind, std::uint32_t type, std::size_t bytes, std::int32_t next) {
    sink_.bigEndian(kind);
    sink_.bigEndian(type);
    sink_.bigEndian(static_cast<std::int32_t>(bytes));
    sink_.bigEndian(next);
}

void Writer::put(std::int32_t kind, std::int32_t value) {
    header(kind, kInt, sizeof(value));
    sink_.bigEndian(value);
}

void Writer::put(std::int32_t kind, float value) {
    header(kind, kFloat, sizeof(value));
    sink_.bigEndian(value);
}

void Writer::put(std::int32_t kind, std::string_view text) {
    header(kind, kString, text.size());
    sink_ << text;
}

void Writer::put(std::int32_t kind, std::span<const Vec3> rows) {
    header(kind, kMatrix | kFloat, 12 * rows.size() + 12);
    for (const Vec3& row : rows) {
        for (int axis = 0; axis < 3; ++axis) sink_.bigEndian(static_cast<float>(row[axis]));
    }
    for (const std::size_t n : {std::size_t{3}, rows.size(), std::size_t{2}}) {
        sink_.bigEndian(static_cast<std::int32_t>(n));
    }
}

void Writer::put(std::int32_t kind, std::span<const std::array<std::int32_t, 3>> rows) {
    header(kind, kMatrix | kInt, 12 * rows.size() + 12);
    for (const auto& row : rows) {
        for (const std::int32_t value : row) sink_.bigEndian(value);
    }
    for (const std::size_t n : {std::size_t{3}, rows.size(), std::size_t{2}}) {
        sink_.bigEndian(static_cast<std::int32_t>(n));
    }
}

void Writer::putPoint(std::int32_t pointKind, std::int32_t number, const Vec3& metres) {
    header(kDigPoint, kDigPointStruct, 20);
    sink_.bigEndian(pointKind);
    sink_.bigEndian(number);
    for (int axis = 0; axis < 3; ++axis) sink_.bigEndian(static_cast<float>(metres[axis]));
}

void Writer::finish() {
    header(kNop, kVoid, 0, -1);
}

}  // namespace adaptiso::meshio::fiff
