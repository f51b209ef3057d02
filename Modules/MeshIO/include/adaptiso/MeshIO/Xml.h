#pragma once

// XML (expat), and the ways XML formats pack binary data: base64 and zlib.

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace adaptiso::meshio {

/// The name of the outermost element; empty if the text is not XML.
std::string_view xmlRoot(std::string_view text);

using XmlAttributes = std::map<std::string, std::string, std::less<>>;

/// The value of `name`; damage if the element has none.
const std::string& requireAttribute(const XmlAttributes& attributes, std::string_view name);
/// The value of `name`, or `otherwise`.
std::string attributeOr(const XmlAttributes& attributes, std::string_view name,
                        std::string_view otherwise);

/// Called by parseXml(), in document order.
class XmlHandler {
public:
    virtual ~XmlHandler() = default;
    virtual void onStart(const std::string& element, const XmlAttributes& attributes) = 0;
    virtual void onEnd(const std::string& element) = 0;
    virtual void onText(std::string_view text) = 0;
    /// Asked after each onStart(): true ends parsing there.
    virtual bool isDone() const { return false; }
    /// Called with what follows the document, where that is more than blanks and comments. Refuses
    /// it.
    virtual void onRest(std::string_view rest);
};

/// Parses the XML in `bytes` (expat). No other file or address is opened, whatever the document
/// says; documents that declare entities are refused. Malformed XML is damage; exceptions of the
/// handler come through.
/// \return  the position at which parsing ended: the '<' of the element at which the handler was
///          done, or the end of the bytes
std::size_t parseXml(std::string_view bytes, XmlHandler& handler);

/// Bytes that `text` spells; white space in it is passed over, decoding stops at padding.
/// Damage at any other character.
std::string decodeBase64(std::string_view text);

/// Characters that `bytes` bytes take, padding included.
constexpr std::size_t base64Length(std::size_t bytes) {
    return (bytes + 2) / 3 * 4;
}

std::string deflated(std::string_view bytes);

/// Damage beyond kSurfaceUnpackLimit: before anything is unpacked.
void requirePlausibleSize(std::size_t packedBytes, std::size_t bytes);

/// The bytes that a zlib or gzip stream holds. Grows with what comes out, never by what a header
/// promises; damage unless it is exactly `expectedBytes`.
std::string inflated(std::string_view stream, std::size_t expectedBytes);

/// Inflates a gzip file, all its members in turn, up to the first `most` bytes.
/// Damage where it breaks off before that, or unpacks as requirePlausibleSize() refuses it.
/// \param behind  set to what follows the last member, if all are unpacked; may be null
std::string gunzipped(std::string_view file, std::size_t most, std::string_view* behind = nullptr);

}  // namespace adaptiso::meshio
