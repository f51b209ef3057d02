#include "Xml.h"

#include <expat.h>

#include <algorithm>
#include <exception>
#include <memory>

#include "ByteSource.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::meshio {
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
            if (bridge.handler_.isDone()) bridge.stop();
        });
    }
    static void XMLCALL onEnd(void* self, const XML_Char* name) {
        guarded(self, [&](Bridge& bridge) { bridge.handler_.onEnd(name); });
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
        stopPosition_ = static_cast<std::size_t>(XML_GetCurrentByteIndex(parser_));
        XML_StopParser(parser_, XML_FALSE);
    }

    XML_Parser parser_;
    XmlHandler& handler_;
    std::exception_ptr exception_;
    bool isStopped_ = false;
    std::size_t stopPosition_ = 0;
};

}  // namespace

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
        if (bridge.isStopped()) return bridge.stopPosition();
        if (status != XML_STATUS_OK) {
            damaged("its XML breaks off in line " +
                    std::to_string(XML_GetCurrentLineNumber(parser.get())) + " (" +
                    XML_ErrorString(XML_GetErrorCode(parser.get())) + ")");
        }
    }
    return bytes.size();
}

}  // namespace adaptiso::meshio
