#include "adaptiso/MeshIO/Xml.h"

#include <expat.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <memory>

#include "Bytes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Surplus.h"

// expat 2.9 deprecates the names without 64
#if XML_MAJOR_VERSION == 2 && XML_MINOR_VERSION < 9
#define XML_GetCurrentByteIndex64 XML_GetCurrentByteIndex
#define XML_GetCurrentLineNumber64 XML_GetCurrentLineNumber
#endif

namespace adaptiso::meshio {

std::string_view xmlRoot(std::string_view text) {
    using namespace std::string_view_literals;
    text = trimmed(text);
    while (text.starts_with("<?") || text.starts_with("<!")) {
        const bool isComment = text.starts_with("<!--");
        const std::string_view end = text.starts_with("<?") ? "?>"sv : isComment ? "-->"sv : ">"sv;
        const std::size_t at = text.find(end);
        if (at == std::string_view::npos) return {};
        text = trimmed(text.substr(at + end.size()));
    }
    if (!text.starts_with('<')) return {};
    text.remove_prefix(1);
    return text.substr(0, text.find_first_of(" \t\r\n/>"));
}

namespace {

/// Carries the handler through expat's C callbacks, which exceptions must not cross.
class Bridge {
public:
    Bridge(XML_Parser parser, XmlHandler& handler) : parser_(parser), handler_(handler) {
        XML_SetUserData(parser, this);
        XML_SetElementHandler(parser, &onStart, &onEnd);
        XML_SetCharacterDataHandler(parser, &onText);
        XML_SetEntityDeclHandler(parser, &onEntity);
    }

    bool isStopped() const { return isStopped_; }
    bool isEnded() const { return isEnded_; }  ///< at the end of the outermost element
    std::size_t stopPosition() const { return stopPosition_; }
    void rethrow() const {
        if (exception_) std::rethrow_exception(exception_);
    }

private:
    template <class F>
    static void guarded(void* self, F&& call) {
        Bridge& bridge = *static_cast<Bridge*>(self);
        if (bridge.isStopped_) return;
        try {
            call(bridge);
        } catch (...) {
            bridge.exception_ = std::current_exception();
            bridge.stop();
        }
    }

    static void XMLCALL onStart(void* self, const XML_Char* name, const XML_Char** pairs) {
        guarded(self, [&](Bridge& bridge) {
            XmlAttributes attributes;
            for (; *pairs != nullptr; pairs += 2) attributes[pairs[0]] = pairs[1];
            bridge.handler_.onStart(name, attributes);
            ++bridge.depth_;
            if (bridge.handler_.isDone()) bridge.stop();
        });
    }
    static void XMLCALL onEnd(void* self, const XML_Char* name) {
        guarded(self, [&](Bridge& bridge) {
            bridge.handler_.onEnd(name);
            if (--bridge.depth_ > 0) return;
            bridge.isEnded_ = true;
            bridge.stop();
        });
    }
    static void XMLCALL onText(void* self, const XML_Char* text, int length) {
        guarded(self, [&](Bridge& bridge) {
            bridge.handler_.onText({text, static_cast<std::size_t>(length)});
        });
    }
    static void XMLCALL onEntity(void* self, const XML_Char*, int, const XML_Char*, int,
                                 const XML_Char*, const XML_Char*, const XML_Char*,
                                 const XML_Char*) {
        guarded(self, [](Bridge&) {
            unsupported("its XML declares entities", "save it without a document type");
        });
    }

    void stop() {
        isStopped_ = true;
        stopPosition_ = static_cast<std::size_t>(XML_GetCurrentByteIndex64(parser_));
        XML_StopParser(parser_, XML_FALSE);
    }

    XML_Parser parser_;
    XmlHandler& handler_;
    std::exception_ptr exception_;
    bool isStopped_ = false, isEnded_ = false;
    int depth_ = 0;
    std::size_t stopPosition_ = 0;
};

/// `text` without blanks, comments and instructions before its content.
std::string_view withoutMisc(std::string_view text) {
    for (text = trimmed(text); text.starts_with("<!--") || text.starts_with("<?");) {
        const std::string_view mark = text.starts_with("<?") ? "?>" : "-->";
        const std::size_t end = text.find(mark);
        if (end == std::string_view::npos) break;
        text = trimmed(text.substr(end + mark.size()));
    }
    return text;
}

/// \param position  of the outermost element's end
std::size_t endDocument(std::string_view bytes, std::size_t position, XmlHandler& handler) {
    const std::size_t end = std::min(bytes.find('>', position), bytes.size() - 1) + 1;
    const std::string_view rest = bytes.substr(end);
    const bool isSecondFile = rest.find("<?xml") != std::string_view::npos;
    const std::string_view content = isSecondFile ? trimmed(rest) : withoutMisc(rest);
    if (!content.empty()) handler.onRest(content);
    return end;
}

}  // namespace

void XmlHandler::onRest(std::string_view rest) {
    damaged("its XML goes on behind its end, with " + printable(rest));
}

const std::string& requireAttribute(const XmlAttributes& attributes, std::string_view name) {
    const auto found = attributes.find(name);
    if (found == attributes.end()) malformed("its XML lacks the attribute " + printable(name));
    return found->second;
}

std::string attributeOr(const XmlAttributes& attributes, std::string_view name,
                        std::string_view otherwise) {
    const auto found = attributes.find(name);
    return found == attributes.end() ? std::string(otherwise) : found->second;
}

std::size_t parseXml(std::string_view bytes, XmlHandler& handler) {
    const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(
        XML_ParserCreate(nullptr), &XML_ParserFree);
    if (!parser) throw InternalError("parseXml: expat can't be started");
    Bridge bridge(parser.get(), handler);
    constexpr std::size_t kPiece = std::size_t{1} << 20;  // expat counts in int
    for (std::size_t begin = 0; begin == 0 || begin < bytes.size(); begin += kPiece) {
        const std::string_view piece = bytes.substr(begin, kPiece);
        const bool isLast = begin + kPiece >= bytes.size();
        const XML_Status status =
            XML_Parse(parser.get(), piece.data(), static_cast<int>(piece.size()), isLast);
        bridge.rethrow();
        if (bridge.isEnded()) return endDocument(bytes, bridge.stopPosition(), handler);
        if (bridge.isStopped()) return bridge.stopPosition();
        if (status != XML_STATUS_OK) {
            damaged("its XML breaks off in line " +
                    std::to_string(XML_GetCurrentLineNumber64(parser.get())) + " (" +
                    XML_ErrorString(XML_GetErrorCode(parser.get())) + ")");
        }
    }
    return bytes.size();
}

namespace {

constexpr std::string_view kAlphabet =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

constexpr std::array<std::int8_t, 256> makeValues() {
    std::array<std::int8_t, 256> values{};
    values.fill(-1);
    for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
        values[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::int8_t>(i);
    }
    return values;
}
constexpr auto kValues = makeValues();

constexpr std::size_t kPiece = std::size_t{1} << 18;

/// zlib counts in 32 bits: data goes through it in pieces.
uInt nextPiece(std::string_view& bytes, z_stream& stream) {
    const std::size_t piece = std::min(bytes.size(), std::size_t{1} << 30);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    bytes.remove_prefix(piece);
    return static_cast<uInt>(piece);
}

}  // namespace

std::string decodeBase64(std::string_view text) {
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    std::uint32_t group = 0;
    int bits = 0;
    for (const char c : text) {
        if (c == '=') break;
        if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
        const std::int8_t value = kValues[static_cast<unsigned char>(c)];
        if (value < 0) damaged("its base64 data holds the character " + printable({&c, 1}));
        group = group << 6 | static_cast<std::uint32_t>(value);
        bits += 6;
        if (bits >= 8) {
            bits -= 8;
            bytes += static_cast<char>(group >> bits & 0xFF);
        }
    }
    return bytes;
}

std::string deflated(std::string_view bytes) {
    z_stream stream{};
    // numbers of meshes hardly pack better at higher levels, which take several times as long
    if (deflateInit(&stream, Z_BEST_SPEED) != Z_OK) {
        throw InternalError("deflated: zlib can't be started");
    }
    std::string packed;
    std::array<char, kPiece> piece;
    int status = Z_OK;
    while (status != Z_STREAM_END) {
        if (stream.avail_in == 0) stream.avail_in = nextPiece(bytes, stream);
        stream.next_out = reinterpret_cast<Bytef*>(piece.data());
        stream.avail_out = static_cast<uInt>(piece.size());
        status = deflate(&stream, bytes.empty() ? Z_FINISH : Z_NO_FLUSH);
        packed.append(piece.data(), piece.size() - stream.avail_out);
    }
    deflateEnd(&stream);
    return packed;
}

void requirePlausibleSize(std::size_t packedBytes, std::size_t bytes) {
    if (!kSurfaceUnpackLimit.allows(packedBytes, bytes)) {
        malformed("its " + std::to_string(packedBytes) + " bytes claim to hold " +
                  std::to_string(bytes) + ", as only a decompression bomb does");
    }
}

std::string inflated(std::string_view packed, std::size_t expectedBytes) {
    z_stream stream{};
    constexpr int kZlibOrGzip = 15 + 32;
    if (inflateInit2(&stream, kZlibOrGzip) != Z_OK) {
        throw InternalError("inflated: zlib can't be started");
    }
    std::string bytes;
    std::array<char, kPiece> piece;
    int status = Z_OK;
    while (status == Z_OK && bytes.size() <= expectedBytes) {
        if (stream.avail_in == 0) stream.avail_in = nextPiece(packed, stream);
        stream.next_out = reinterpret_cast<Bytef*>(piece.data());
        stream.avail_out = static_cast<uInt>(piece.size());
        status = inflate(&stream, Z_NO_FLUSH);
        bytes.append(piece.data(), piece.size() - stream.avail_out);
    }
    inflateEnd(&stream);
    if (status != Z_STREAM_END || bytes.size() != expectedBytes) {
        damaged("its compressed data unpacks to " + std::to_string(bytes.size()) +
                " sound bytes, must be " + std::to_string(expectedBytes));
    }
    return bytes;
}

std::string gunzipped(std::string_view file, std::size_t most, std::string_view* behind) {
    z_stream stream{};
    constexpr int kGzip = 15 + 16;
    if (inflateInit2(&stream, kGzip) != Z_OK) {
        throw InternalError("gunzipped: zlib can't be started");
    }
    const std::unique_ptr<z_stream, decltype(&inflateEnd)> end(&stream, &inflateEnd);
    std::string_view packed = file;
    std::string bytes;
    std::array<char, kPiece> piece;
    while (bytes.size() < most) {
        if (stream.avail_in == 0) stream.avail_in = nextPiece(packed, stream);
        stream.next_out = reinterpret_cast<Bytef*>(piece.data());
        stream.avail_out = static_cast<uInt>(piece.size());
        const int status = inflate(&stream, Z_NO_FLUSH);
        bytes.append(piece.data(), piece.size() - stream.avail_out);
        requirePlausibleSize(file.size(), bytes.size());
        if (status == Z_OK) continue;
        if (status != Z_STREAM_END) {
            damaged("its gzip data break off after " + std::to_string(bytes.size()) +
                    " unpacked bytes");
        }
        const bool hasMore = stream.avail_in > 0 && *stream.next_in == 0x1F;
        if (hasMore && inflateReset(&stream) == Z_OK) continue;
        if (behind != nullptr) *behind = file.substr(file.size() - packed.size() - stream.avail_in);
        break;
    }
    if (bytes.size() > most) bytes.resize(most);
    return bytes;
}

}  // namespace adaptiso::meshio
