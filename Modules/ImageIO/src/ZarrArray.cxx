#include "ZarrArray.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <set>
#include <string_view>

#include "FileFault.h"
#include "Samples.h"
#include "ZarrStore.h"
#include "adaptiso/Core/Phrases.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

std::string joined(const std::string& path, const std::string& key) {
    return path.empty() ? key : path + "/" + key;
}

[[noreturn]] void refuseKind(const fs::path& file, std::string_view what, std::string_view name) {
    refuse(file, fmt::format("its {} {} is not read here", what, printable(name)),
           "write the array anew without it");
}

/// "<u2" and its like.
PixelType typeOfNumpy(const fs::path& file, const std::string& text, std::endian& order) {
    constexpr std::string_view kOrders = "<>|";
    const std::string kind = text.size() > 1 ? text.substr(1) : "";
    if (text.empty() || kOrders.find(text[0]) == kOrders.npos) refuseKind(file, "dtype", text);
    order = text[0] == '>' ? std::endian::big : std::endian::little;
    constexpr std::pair<std::string_view, PixelType> kTypes[] = {
        {"u1", PixelType::UInt8},   {"i1", PixelType::Int8},   {"b1", PixelType::UInt8},
        {"u2", PixelType::UInt16},  {"i2", PixelType::Int16},  {"u4", PixelType::UInt32},
        {"i4", PixelType::Int32},   {"u8", PixelType::UInt64}, {"i8", PixelType::Int64},
        {"f4", PixelType::Float32}, {"f8", PixelType::Float64}};
    for (const auto& [name, type] : kTypes) {
        if (kind == name) return type;
    }
    refuseKind(file, "dtype", text);
}

template <class T>
std::optional<T> fillAs(const ZarrJson& value) {
    if (value.is_null()) return T{0};
    if (value.is_boolean()) return static_cast<T>(value.get<bool>() ? 1 : 0);
    if constexpr (std::is_floating_point_v<T>) {
        if (value.is_number()) return static_cast<T>(value.get<double>());
        if (!value.is_string()) return std::nullopt;
        const auto text = value.get<std::string>();
        if (text == "NaN") return std::numeric_limits<T>::quiet_NaN();
        if (text == "Infinity") return std::numeric_limits<T>::infinity();
        if (text == "-Infinity") return -std::numeric_limits<T>::infinity();
        // the bits of it, in hexadecimal digits
        using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
        Bits bits = 0;
        const char* const last = text.data() + text.size();
        if (!text.starts_with("0x") || text.size() != 2 + 2 * sizeof(T) ||
            std::from_chars(text.data() + 2, last, bits, 16).ptr != last) {
            return std::nullopt;
        }
        return std::bit_cast<T>(bits);
    } else {
        if (value.is_number_unsigned()) {
            const auto number = value.get<std::uint64_t>();
            if (number > static_cast<std::uint64_t>(std::numeric_limits<T>::max())) return {};
            return static_cast<T>(number);
        }
        if (value.is_number_integer()) {
            const auto number = value.get<std::int64_t>();
            if (number < static_cast<std::int64_t>(std::numeric_limits<T>::min())) return {};
            return static_cast<T>(number);
        }
        if (!value.is_number_float()) return std::nullopt;
        const double number = value.get<double>();  // "0.0" of integers, as some write it
        if (number != std::floor(number) || std::abs(number) > 9e15) return std::nullopt;
        const auto whole = static_cast<std::int64_t>(number);
        if (!std::in_range<T>(whole)) return std::nullopt;
        return static_cast<T>(whole);
    }
}

void takeFill(const fs::path& file, const ZarrJson& value, ZarrArray& array) {
    withPixelType(array.type, [&]<class T>(T) {
        const std::optional<T> fill = fillAs<T>(value);
        if (!fill) {
            refuse(file,
                   fmt::format("its fill_value {} is none of its type ({})", shownJson(value),
                               toString(array.type)),
                   "repair the metadata");
        }
        std::memcpy(array.fill.data(), &*fill, sizeof(T));
    });
}

std::vector<std::size_t> orderC(std::size_t rank) {
    std::vector<std::size_t> order(rank);
    std::iota(order.begin(), order.end(), std::size_t{0});
    return order;
}

std::vector<std::size_t> orderF(std::size_t rank) {
    std::vector<std::size_t> order = orderC(rank);
    std::reverse(order.begin(), order.end());
    return order;
}

// ---- version 2

ZarrArray arrayOfVersion2(const fs::path& file, const ZarrJson& json) {
    ZarrArray array;
    array.version = 2;
    if (memberOf(json, "zarr_format") != 2) {
        refuse(file, "its zarr_format is not 2", "repair the metadata");
    }
    array.shape = numbersOf(file, json, "shape", 1);
    array.chunk = numbersOf(file, json, "chunks", 1);
    if (!memberOf(json, "dtype").is_string()) refuseKind(file, "dtype", "of several fields");
    array.type = typeOfNumpy(file, textOf(file, json, "dtype"), array.encoding.byteOrder);
    const std::string order = textOf(file, json, "order");
    if (order != "C" && order != "F") refuseKind(file, "order", order);
    array.encoding.order = order == "C" ? orderC(array.rank()) : orderF(array.rank());
    const ZarrJson& filters = memberOf(json, "filters");
    if (!filters.is_null() && !(filters.is_array() && filters.empty())) {
        const ZarrJson& first = filters.is_array() ? filters.front() : filters;
        refuseKind(file, "filter", textOf(file, first, "id"));
    }
    const ZarrJson& compressor = memberOf(json, "compressor");
    if (!compressor.is_null()) {
        array.encoding.codecs.push_back(zarrCodecOf(file, textOf(file, compressor, "id")));
    }
    const ZarrJson& separator = memberOf(json, "dimension_separator");
    array.separator = '.';
    if (!separator.is_null()) {
        if (separator != "." && separator != "/") {
            refuseKind(file, "dimension_separator", shownJson(separator));
        }
        array.separator = separator.get<std::string>().front();
    }
    takeFill(file, memberOf(json, "fill_value"), array);
    return array;
}

// ---- version 3

std::string codecName(const fs::path& file, const ZarrJson& codec) {
    return codec.is_string() ? codec.get<std::string>() : textOf(file, codec, "name");
}

std::endian byteOrderOf(const fs::path& file, const ZarrJson& codec) {
    const ZarrJson& endian = memberOf(memberOf(codec, "configuration"), "endian");
    if (endian.is_null() || endian == "little") return std::endian::little;
    if (endian != "big") refuseKind(file, "endian", shownJson(endian));
    return std::endian::big;
}

/// Order of the dimensions before this transposition.
std::vector<std::size_t> orderOf(const fs::path& file, const ZarrJson& codec, std::size_t rank) {
    const ZarrJson& order = memberOf(memberOf(codec, "configuration"), "order");
    if (order == "C") return orderC(rank);
    if (order == "F") return orderF(rank);
    std::vector<std::size_t> numbers;
    std::set<std::size_t> known;
    if (order.is_array() && order.size() == rank) {
        for (const ZarrJson& number : order) {
            if (!number.is_number_unsigned() || number.get<std::uint64_t>() >= rank) break;
            numbers.push_back(number.get<std::size_t>());
            known.insert(numbers.back());
        }
    }
    if (known.size() != rank) {
        refuse(file, "its metadata are damaged: the order of its codec transpose", "repair them");
    }
    return numbers;
}

ZarrEncoding encodingOf(const fs::path& file, const ZarrJson& codecs, std::size_t rank);

/// "bytes, gzip"
std::string shownCodecs(const ZarrJson& codecs) {
    if (!codecs.is_array() || codecs.empty()) return shownJson(codecs);
    return adaptiso::joined(codecs, [](const ZarrJson& codec) {
        return shownJson(codec.is_object() ? memberOf(codec, "name") : codec);
    });
}

/// The codecs of a shard's index: bytes, and crc32c or nothing.
void takeIndexCodecs(const fs::path& file, const ZarrJson& codecs, ZarrSharding& sharding) {
    if (!codecs.is_array() || codecs.empty() || codecs.size() > 2 ||
        codecName(file, codecs[0]) != "bytes" ||
        (codecs.size() == 2 && codecName(file, codecs[1]) != "crc32c")) {
        refuseKind(file, "codec of the shards' index", shownCodecs(codecs));
    }
    sharding.indexOrder = byteOrderOf(file, codecs[0]);
    sharding.hasIndexSum = codecs.size() == 2;
}

void takeSharding(const fs::path& file, const ZarrJson& codec, ZarrArray& array) {
    const ZarrJson& configuration = memberOf(codec, "configuration");
    ZarrSharding sharding{array.chunk};
    array.chunk = numbersOf(file, configuration, "chunk_shape", 1);
    takeIndexCodecs(file, memberOf(configuration, "index_codecs"), sharding);
    const ZarrJson& location = memberOf(configuration, "index_location");
    if (!location.is_null() && location != "end" && location != "start") {
        refuseKind(file, "index_location", shownJson(location));
    }
    sharding.isIndexAtEnd = location != "start";
    array.encoding = encodingOf(file, memberOf(configuration, "codecs"), array.rank());
    array.sharding = std::move(sharding);
}

ZarrEncoding encodingOf(const fs::path& file, const ZarrJson& codecs, std::size_t rank) {
    if (!codecs.is_array()) refuse(file, "its metadata are damaged: no codecs", "repair them");
    ZarrEncoding encoding{orderC(rank)};
    bool isBytes = false;
    for (const ZarrJson& codec : codecs) {
        const std::string name = codecName(file, codec);
        if (!isBytes && name == "transpose") {
            std::vector<std::size_t> order;
            for (const std::size_t n : orderOf(file, codec, rank)) {
                order.push_back(encoding.order[n]);
            }
            encoding.order = std::move(order);
        } else if (!isBytes && name == "bytes") {
            encoding.byteOrder = byteOrderOf(file, codec);
            isBytes = true;
        } else if (name == "sharding_indexed") {
            refuseKind(file, "codec", "sharding_indexed within or behind another codec");
        } else if (!isBytes) {
            refuseKind(file, "codec", name);
        } else {
            encoding.codecs.push_back(zarrCodecOf(file, name));
        }
    }
    if (!isBytes) refuse(file, "its metadata are damaged: no codec bytes", "repair them");
    return encoding;
}

/// Features that a reader must support to read the array.
void requireKnownMembers(const fs::path& file, const ZarrJson& json) {
    static const std::set<std::string> kKnown{"zarr_format",     "node_type",
                                              "shape",           "data_type",
                                              "chunk_grid",      "chunk_key_encoding",
                                              "fill_value",      "codecs",
                                              "attributes",      "storage_transformers",
                                              "dimension_names", "consolidated_metadata"};
    for (const auto& [key, value] : json.items()) {
        if (kKnown.contains(key) || memberOf(value, "must_understand") == false) continue;
        refuseKind(file, "member", key);
    }
    const ZarrJson& transformers = memberOf(json, "storage_transformers");
    if (!transformers.is_null() && !(transformers.is_array() && transformers.empty())) {
        refuseKind(file, "storage transformer",
                   transformers.is_array() ? codecName(file, transformers.front()) : "");
    }
}

void takeKeys(const fs::path& file, const ZarrJson& json, ZarrArray& array) {
    const ZarrJson& encoding = memberOf(json, "chunk_key_encoding");
    const std::string name = textOf(file, encoding, "name");
    if (name != "default" && name != "v2") refuseKind(file, "chunk_key_encoding", name);
    array.hasKeyPrefix = name == "default";
    array.separator = name == "default" ? '/' : '.';
    const ZarrJson& separator = memberOf(memberOf(encoding, "configuration"), "separator");
    if (separator.is_null()) return;
    if (separator != "." && separator != "/") refuseKind(file, "separator", shownJson(separator));
    array.separator = separator.get<std::string>().front();
}

ZarrArray arrayOfVersion3(const fs::path& file, const ZarrJson& json) {
    ZarrArray array;
    requireKnownMembers(file, json);
    array.shape = numbersOf(file, json, "shape", 1);
    const ZarrJson& type = memberOf(json, "data_type");
    array.type = zarrTypeOf(
        file, "data_type", type.is_string() ? type.get<std::string>() : textOf(file, type, "name"));
    const ZarrJson& grid = memberOf(json, "chunk_grid");
    const std::string kind = textOf(file, grid, "name");
    if (kind != "regular") refuseKind(file, "chunk_grid", kind);
    array.chunk = numbersOf(file, memberOf(grid, "configuration"), "chunk_shape", 1);
    takeKeys(file, json, array);
    const ZarrJson& codecs = memberOf(json, "codecs");
    const bool isSharded =
        codecs.is_array() && codecs.size() == 1 && codecName(file, codecs[0]) == "sharding_indexed";
    if (isSharded) {
        takeSharding(file, codecs[0], array);
    } else {
        array.encoding = encodingOf(file, codecs, array.rank());
    }
    for (const ZarrJson& name : memberOf(json, "dimension_names")) {
        array.dimensions.push_back(name.is_string() ? name.get<std::string>() : "");
    }
    takeFill(file, memberOf(json, "fill_value"), array);
    return array;
}

}  // namespace

PixelType zarrTypeOf(const fs::path& file, const char* member, const std::string& name) {
    if (name == "bool") return PixelType::UInt8;
    for (int n = 0; n <= static_cast<int>(PixelType::Float64); ++n) {
        const auto type = static_cast<PixelType>(n);
        if (name == toString(type)) return type;
    }
    refuseKind(file, member, name);
}

void requireZarrSizes(const fs::path& file, const ZarrArray& array) {
    constexpr std::size_t kMostDimensions = 8;
    constexpr std::uint64_t kLargestChunk = std::uint64_t{1} << 31;
    const std::size_t rank = array.rank();
    if (rank > kMostDimensions || array.chunk.size() != rank ||
        array.encoding.order.size() != rank ||
        (!array.dimensions.empty() && array.dimensions.size() != rank) ||
        (array.sharding && array.sharding->shard.size() != rank)) {
        refuse(file,
               fmt::format("its metadata contradict each other: {} dimensions, chunks of {}", rank,
                           array.chunk.size()),
               "repair them");
    }
    std::uint64_t bytes = bytesPerPixel(array.type);
    for (const std::uint64_t side : array.chunk) {
        if (side > kLargestChunk / bytes) {
            refuse(file, "its chunks are larger than what is read here (2 GiB)",
                   "write the array in smaller chunks");
        }
        bytes *= side;
    }
    if (!array.sharding) return;
    for (std::size_t n = 0; n < rank; ++n) {
        if (array.sharding->shard[n] % array.chunk[n] == 0) continue;
        refuse(file, "its shards do not consist of whole chunks", "repair the metadata");
    }
}

std::uint64_t ZarrArray::chunkSamples() const {
    return std::accumulate(chunk.begin(), chunk.end(), std::uint64_t{1}, std::multiplies<>());
}

std::string ZarrArray::key(const ZarrIndex& file) const {
    std::string text = hasKeyPrefix ? "c" : "";
    for (std::size_t n = 0; n < file.size(); ++n) {
        if (!text.empty()) text += separator;
        text += std::to_string(file[isN5 ? file.size() - 1 - n : n]);
    }
    return joined(path, text);
}

std::optional<ZarrArray> readZarrArray(const ZarrStore& store, const std::string& path) {
    std::optional<ZarrArray> array;
    std::string key = joined(path, "zarr.json");
    std::optional<ZarrJson> json = readZarrJson(store, key);
    if (json) {
        if (memberOf(*json, "zarr_format") != 3) {
            refuse(store.root() / key, "its zarr_format is not 3", "repair the metadata");
        }
        if (memberOf(*json, "node_type") != "array") return std::nullopt;
        array = arrayOfVersion3(store.root() / key, *json);
    } else {
        key = joined(path, ".zarray");
        json = readZarrJson(store, key);
        if (!json) return readN5Array(store, path);
        array = arrayOfVersion2(store.root() / key, *json);
    }
    array->path = path;
    requireZarrSizes(store.root() / key, *array);
    return array;
}

}  // namespace adaptiso::detail
