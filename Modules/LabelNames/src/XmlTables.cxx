// The LabelTable of a GIFTI file, and FSL's atlases, both in XML (expat).
#include <expat.h>

#include <algorithm>
#include <exception>
#include <memory>

#include "Rows.h"

namespace adaptiso::labelnames {
namespace {

/// Collects what both formats have: elements of a label with attributes and a name.
class Labels {
public:
    using Attributes = std::map<std::string, std::string, std::less<>>;

    void start(const std::string& element, Attributes attributes) {
        if (depth_++ == 0) {
            isGifti = element == "GIFTI";
            if (!isGifti && element != "atlas") refuseKind("its XML is a " + printable(element));
        }
        text_.clear();
        if (element == (isGifti ? "Label" : "label")) {
            attributes_ = std::move(attributes);
            isInLabel_ = true;
        }
    }
    void end(const std::string& element) {
        --depth_;
        if (element == "type") isProbabilistic_ = lowerCase(trimmed(text_)) != "label";
        if (isInLabel_ && element == (isGifti ? "Label" : "label")) {
            isInLabel_ = false;
            rows_.push_back({std::move(attributes_), text_});
        }
        text_.clear();
    }
    void text(std::string_view more) {
        constexpr std::size_t kLongest = 1 << 16;  // data of a GIFTI file is none of ours
        if (text_.size() < kLongest) text_ += more.substr(0, kLongest);
    }

    LabelTable finish() const {
        Collector found(isGifti ? "GIFTI" : "FSL");
        for (const auto& [attributes, name] : rows_) found.add(entryOf(attributes, name));
        return found.finish();
    }

    bool isGifti = false;

private:
    static std::int32_t numberOf(const Attributes& attributes, const char* name) {
        const auto at = attributes.find(name);
        if (at == attributes.end()) damaged("a label lacks the attribute " + std::string(name));
        const std::optional<std::int64_t> value = wholeNumber(at->second);
        constexpr std::int64_t kMost = (std::int64_t{1} << 31) - 2;
        if (!value || *value < -kMost || *value > kMost) {
            damaged("a label's " + std::string(name) + " is " + printable(at->second) +
                    ", must be a whole number that 32 bits hold");
        }
        return static_cast<std::int32_t>(*value);
    }

    LabelEntry entryOf(const Attributes& attributes, const std::string& name) const {
        LabelEntry entry;
        entry.name = name;
        if (!isGifti) {
            const bool hasValue = attributes.contains("value");
            entry.value = numberOf(attributes, hasValue ? "value" : "index") +
                          (isProbabilistic_ && !hasValue ? 1 : 0);
            return entry;
        }
        entry.value = numberOf(attributes, attributes.contains("Key") ? "Key" : "Index");
        LabelColor color{};
        constexpr const char* kChannels[] = {"Red", "Green", "Blue"};
        for (std::size_t n = 0; n < 3; ++n) {
            const auto at = attributes.find(kChannels[n]);
            if (at == attributes.end()) return entry;
            const std::optional<double> part = realNumber(at->second);
            if (!part || *part < 0 || *part > 1) {
                damaged("the " + lowerCase(kChannels[n]) + " of label " +
                        std::to_string(entry.value) + " is " + printable(at->second) +
                        ", must be 0 to 1");
            }
            color[n] = static_cast<std::uint8_t>(*part * 255 + 0.5);
        }
        entry.color = color;
        return entry;
    }

    int depth_ = 0;
    bool isInLabel_ = false, isProbabilistic_ = true;
    Attributes attributes_;
    std::string text_;
    std::vector<std::pair<Attributes, std::string>> rows_;
};

/// Carries Labels through expat's C callbacks, which exceptions must not cross.
struct Bridge {
    XML_Parser parser;
    Labels labels{};
    std::exception_ptr exception{};

    template <class F>
    static void guarded(void* self, F&& call) {
        Bridge& bridge = *static_cast<Bridge*>(self);
        if (bridge.exception) return;
        try {
            call(bridge.labels);
        } catch (...) {
            bridge.exception = std::current_exception();
            XML_StopParser(bridge.parser, XML_FALSE);
        }
    }
    static void XMLCALL onStart(void* self, const XML_Char* name, const XML_Char** pairs) {
        guarded(self, [&](Labels& labels) {
            Labels::Attributes attributes;
            for (; *pairs != nullptr; pairs += 2) attributes[pairs[0]] = pairs[1];
            labels.start(name, std::move(attributes));
        });
    }
    static void XMLCALL onEnd(void* self, const XML_Char* name) {
        guarded(self, [&](Labels& labels) { labels.end(name); });
    }
    static void XMLCALL onText(void* self, const XML_Char* text, int length) {
        guarded(self, [&](Labels& labels) {
            labels.text({text, static_cast<std::size_t>(length)});
        });
    }
    static void XMLCALL onEntity(void* self, const XML_Char*, int, const XML_Char*, int,
                                 const XML_Char*, const XML_Char*, const XML_Char*,
                                 const XML_Char*) {
        guarded(self, [](Labels&) { damaged("its XML declares entities, which none needs"); });
    }
};

}  // namespace

LabelTable decodeXml(std::string_view text) {
    const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(
        XML_ParserCreate(nullptr), &XML_ParserFree);
    if (!parser) throw InternalError("decodeXml: expat can't be started");
    Bridge bridge{parser.get()};
    XML_SetUserData(parser.get(), &bridge);
    XML_SetElementHandler(parser.get(), &Bridge::onStart, &Bridge::onEnd);
    XML_SetCharacterDataHandler(parser.get(), &Bridge::onText);
    XML_SetEntityDeclHandler(parser.get(), &Bridge::onEntity);
    const XML_Status status =  // readLabelTable() has bounded the size
        XML_Parse(parser.get(), text.data(), static_cast<int>(text.size()), XML_TRUE);
    if (bridge.exception) std::rethrow_exception(bridge.exception);
    if (status != XML_STATUS_OK) {
        damaged("its XML breaks off in line " +
                std::to_string(XML_GetCurrentLineNumber(parser.get())) + " (" +
                XML_ErrorString(XML_GetErrorCode(parser.get())) + ")");
    }
    return bridge.labels.finish();
}

}  // namespace adaptiso::labelnames
