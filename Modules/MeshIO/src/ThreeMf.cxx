// 3MF (core specification): a zip archive of XML. A model has objects, each a mesh or placed others
// (components), and the items to build, which place objects. Ours hold the frame's numbers in mm.
// Read as well: models in several files (production extension, as Bambu Studio and Orca write).

#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include "Bytes.h"
#include "Codecs.h"
#include "Counts.h"
#include "Parts.h"
#include "Zip.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/Xml.h"

namespace adaptiso::meshio {
namespace {

constexpr const char* kXmlHead = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
constexpr const char* kModelName = "3D/3dmodel.model";
constexpr const char* kTypes =
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
    "<Default Extension=\"rels\" "
    "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
    "<Default Extension=\"model\" "
    "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
constexpr const char* kRelations =
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
    "<Relationship Id=\"rel0\" Target=\"/3D/3dmodel.model\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";

void encodeModel(std::span<const MeshPart> parts, const MeshWriteOptions& options, ByteSink& xml) {
    xml << kXmlHead
        << "<model unit=\"millimeter\" xml:lang=\"en-US\" "
           "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
           "<metadata name=\"Application\">adaptiso</metadata>\n<metadata name=\"Description\">"
        << headerLine(options) << "</metadata>\n<resources>\n";
    std::string materials;
    for (const MeshPart& part : parts) {
        if (!part.color) continue;
        constexpr std::string_view kDigits = "0123456789ABCDEF";
        materials += "<base name=\"" + escapedMarkup(part.name) + "\" displaycolor=\"#";
        for (const std::uint8_t shade : *part.color) {
            materials.append(1, kDigits[shade / 16]).append(1, kDigits[shade % 16]);
        }
        materials += "\"/>\n";
    }
    if (!materials.empty()) {
        xml << "<basematerials id=\"1\">\n" << materials << "</basematerials>\n";
    }
    std::int64_t id = 1, material = 0;
    for (const MeshPart& part : parts) {
        xml << "<object id=\"" << ++id << "\" type=\"model\" name=\"" << escapedMarkup(part.name);
        if (part.color) xml << "\" pid=\"1\" pindex=\"" << material++;
        xml << "\">\n<mesh>\n<vertices>\n";
        for (const Vec3& p : part.mesh->points) {
            xml << "<vertex x=\"" << p.x << "\" y=\"" << p.y << "\" z=\"" << p.z << "\"/>\n";
        }
        xml << "</vertices>\n<triangles>\n";
        for (const Triangle& t : part.mesh->triangles) {
            xml << "<triangle v1=\"" << t[0] << "\" v2=\"" << t[1] << "\" v3=\"" << t[2]
                << "\"/>\n";
        }
        xml << "</triangles>\n</mesh>\n</object>\n";
    }
    xml << "</resources>\n<build>\n";
    for (std::int64_t item = 2; item <= id; ++item) xml << "<item objectid=\"" << item << "\"/>\n";
    xml << "</build>\n</model>\n";
}

void encode3mfParts(std::span<const MeshPart> parts, const MeshWriteOptions& options,
                    ByteSink& sink) {
    std::ostringstream model;
    ByteSink xml(model);
    encodeModel(parts, options, xml);
    xml.finish();
    writeZip({{"[Content_Types].xml", std::string(kXmlHead) + kTypes},
              {"_rels/.rels", std::string(kXmlHead) + kRelations},
              {kModelName, std::move(model).str()}},
             sink);
}

void encode3mf(const MeshRecord& record, ByteSink& sink) {
    const MeshPart part{"surface", {}, &record.mesh};
    encode3mfParts({&part, 1}, record.options, sink);
}

// ---- reading

/// An object in place.
struct Placed3mf {
    std::string path;  ///< of its model; empty: of the one that names it
    std::string id;
    AffineTransform transform{};
};

struct Object3mf {
    TriangleMesh mesh{};
    std::vector<Placed3mf> components{};
    std::string colors{}, color{};  ///< numbers of a group and of one in it
    bool isSolid = true;            ///< else a printer's support, or a thing beside the solid
};

struct Model3mf {
    std::string unit = "millimeter", description{};
    std::map<std::string, Object3mf> objects{};
    std::map<std::string, std::vector<std::optional<Color>>> colors{};  ///< groups by number
    std::vector<Placed3mf> items{};

    std::optional<Color> colorOf(const Object3mf& object) const {
        const auto group = colors.find(object.colors);
        if (group == colors.end() || object.color.empty()) return {};
        const std::int64_t n = toInteger(object.color, "pindex");
        if (n < 0 || n >= std::ssize(group->second)) return {};
        return group->second[static_cast<std::size_t>(n)];
    }
};

std::string partName(std::string_view path) {
    return std::string(path.starts_with('/') ? path.substr(1) : path);
}

/// "#RRGGBB", "#RRGGBBAA"
std::optional<Color> parseColor(std::string_view text) {
    if (!text.starts_with('#') || text.size() < 7) return {};
    Color color{};
    for (std::size_t n = 0; n < color.size(); ++n) {
        int value = 0;
        for (const char c : lowerCase(text.substr(1 + 2 * n, 2))) {
            const std::size_t digit = std::string_view("0123456789abcdef").find(c);
            if (digit == std::string_view::npos) return {};
            value = 16 * value + static_cast<int>(digit);
        }
        color[n] = static_cast<std::uint8_t>(value);
    }
    return color;
}

/// "m00 m01 m02 m10 ... m32": rows, the last one moves.
AffineTransform parseTransform(std::string_view text) {
    AffineTransform transform;
    if (trimmed(text).empty()) return transform;
    ByteSource words(text);
    for (Vec3& column : transform.linear.column) {
        for (int axis = 0; axis < 3; ++axis) column[axis] = words.realWord("a transform");
    }
    for (int axis = 0; axis < 3; ++axis) transform.offset[axis] = words.realWord("a transform");
    return transform;
}

/// The end of a name behind its prefix.
std::string_view localName(std::string_view name) {
    return name.substr(name.rfind(':') + 1);
}

class ModelHandler : public XmlHandler {
public:
    void onStart(const std::string& name, const XmlAttributes& attributes) override {
        const std::string_view element = localName(name);
        const std::string_view prefix =
            std::string_view(name).substr(0, name.size() - element.size());
        isDescription_ = false;
        if (element == "model") core_ = prefix;
        const bool isOfMaterials = element == "colorgroup" || element == "color";
        if (prefix != core_ && !isOfMaterials) return;
        if (element == "vertex") {
            Vec3& p = object().mesh.points.emplace_back();
            p = {real(attributes, "x"), real(attributes, "y"), real(attributes, "z")};
        } else if (element == "triangle") {
            object().mesh.triangles.push_back(
                {whole(attributes, "v1"), whole(attributes, "v2"), whole(attributes, "v3")});
        } else if (element == "model") {
            model.unit = attributeOr(attributes, "unit", model.unit);
            requireKnown(attributes);
        } else if (element == "metadata") {
            isDescription_ = attributeOr(attributes, "name", "") == "Description";
        } else if (element == "object") {
            const auto [at, isNew] =
                model.objects.emplace(requireAttribute(attributes, "id"), Object3mf{});
            if (!isNew) malformed("two of its objects have the id " + printable(at->first));
            object_ = &at->second;
            object_->colors = attributeOr(attributes, "pid", "");
            object_->color = attributeOr(attributes, "pindex", "0");
            const std::string type = attributeOr(attributes, "type", "model");
            object_->isSolid = type == "model" || type == "surface";
        } else if (element == "component") {
            object().components.push_back(placed(attributes));
        } else if (element == "item") {
            model.items.push_back(placed(attributes));
        } else if (element == "basematerials" || element == "colorgroup") {
            colors_ = &model.colors[requireAttribute(attributes, "id")];
        } else if (colors_ != nullptr && (element == "base" || element == "color")) {
            colors_->push_back(parseColor(
                attributeOr(attributes, element == "base" ? "displaycolor" : "color", "")));
        }
    }
    void onEnd(const std::string& name) override {
        isDescription_ = false;
        if (name == core_ + "object") object_ = nullptr;
        if (localName(name) == "basematerials" || localName(name) == "colorgroup") {
            colors_ = nullptr;
        }
    }
    void onText(std::string_view text) override {
        if (isDescription_) model.description.append(text);
    }

    Model3mf model;

private:
    Object3mf& object() {
        if (object_ == nullptr) malformed("its XML has a part of a mesh outside of an object");
        return *object_;
    }
    static double real(const XmlAttributes& attributes, std::string_view name) {
        return toReal(trimmed(requireAttribute(attributes, name)), "a coordinate");
    }
    static std::int64_t whole(const XmlAttributes& attributes, std::string_view name) {
        return toInteger(trimmed(requireAttribute(attributes, name)), "a triangle's vertex");
    }
    static Placed3mf placed(const XmlAttributes& attributes) {
        Placed3mf placed{{},
                         requireAttribute(attributes, "objectid"),
                         parseTransform(attributeOr(attributes, "transform", ""))};
        for (const auto& [name, value] : attributes) {
            if (localName(name) == "path") placed.path = partName(value);
        }
        return placed;
    }

    /// Refuses extensions without which, as the file says, it can't be read rightly.
    static void requireKnown(const XmlAttributes& attributes) {
        const std::string required = attributeOr(attributes, "requiredextensions", "");
        ByteSource words(required);
        for (std::string_view word = words.word(); !word.empty(); word = words.word()) {
            const std::string space = attributeOr(attributes, "xmlns:" + std::string(word), word);
            const bool isKnown = space.find("/production/") != std::string::npos ||
                                 space.find("/material/") != std::string::npos;
            if (isKnown) continue;
            unsupported("it needs 3MF's extension " + printable(space),
                        "save it as a plain mesh, 3MF or STL");
        }
    }

    std::string core_{};  ///< prefix of the core specification's elements, with its colon
    Object3mf* object_ = nullptr;
    std::vector<std::optional<Color>>* colors_ = nullptr;
    bool isDescription_ = false;
};

class RelationHandler : public XmlHandler {
public:
    void onStart(const std::string& element, const XmlAttributes& attributes) override {
        const bool isModel = localName(element) == "Relationship" &&
                             attributeOr(attributes, "Type", "").ends_with("/3dmodel");
        if (isModel && model.empty()) model = partName(attributeOr(attributes, "Target", ""));
    }
    void onEnd(const std::string& /*element*/) override {}
    void onText(std::string_view /*text*/) override {}

    std::string model{};
};

double mmPer(const std::string& unit) {
    constexpr std::pair<std::string_view, double> kUnits[] = {{"millimeter", 1},  {"micron", 1e-3},
                                                              {"centimeter", 10}, {"inch", 25.4},
                                                              {"foot", 304.8},    {"meter", 1000}};
    for (const auto& [name, mm] : kUnits) {
        if (unit == name) return mm;
    }
    malformed("its unit is " + printable(unit));
}

class Reader3mf {
public:
    Reader3mf(ZipFiles& files, std::size_t fileBytes, const MeshReadOptions& options)
        : files_(files), options_(options), unpacking_(fileBytes) {}

    MeshFile read() {
        RelationHandler relations;
        if (files_.has("_rels/.rels")) parseXml(files_.read("_rels/.rels"), relations);
        const std::string root = relations.model.empty() ? kModelName : relations.model;
        const Model3mf& model = modelAt(root);
        const double mm = mmPer(model.unit);
        std::vector<Placed3mf> open;
        const auto push = [&](const std::vector<Placed3mf>& placed, const std::string& path,
                              const AffineTransform& from) {
            for (auto each = placed.rbegin(); each != placed.rend(); ++each) {
                constexpr std::int64_t kEach = 1024;  // components may lead in a circle
                const std::string& owner = each->path.empty() ? path : each->path;
                unpacking_.add(kEach + std::ssize(owner) + std::ssize(each->id), 1);
                open.push_back({owner, each->id, from * each->transform});
            }
        };
        push(model.items, root, {Mat3::diagonal(mm, mm, mm), {}});
        std::int64_t supports = 0;
        while (!open.empty()) {
            const Placed3mf next = std::move(open.back());
            open.pop_back();
            const Model3mf& own = modelAt(next.path);
            const auto found = own.objects.find(next.id);
            if (found == own.objects.end()) {
                malformed("it places an object " + printable(next.id) + ", which is not there");
            }
            const Object3mf& object = found->second;
            if (!object.isSolid) {
                ++supports;
                continue;
            }
            push(object.components, next.path, next.transform);
            if (object.mesh.points.empty()) continue;
            unpacking_.add(std::ssize(object.mesh.points), sizeof(Vec3));
            unpacking_.add(std::ssize(object.mesh.triangles), sizeof(Triangle));
            joined_.add({object.mesh, {}, own.colorOf(object)}, next.transform);
        }
        MeshFile file;
        FrameMarks marks(options_);
        marks.addText(model.description);
        file.frame = marks.frame();
        file.warnings = std::move(unpacking_.warnings);
        if (supports > 0) {
            file.warnings.push_back(
                {"supports-left-out",
                 counted(supports, "support or other object", "supports or other objects") +
                     " beside the solid left out"});
        }
        if (mm != 1) {
            file.warnings.push_back(
                {"unit-converted", "its lengths in " + model.unit + " were turned into mm"});
        }
        std::move(joined_).moveTo(file, options_);
        requireNoMore({"triangles", std::ssize(file.mesh.triangles), 12}, files_.behind(),
                      file.warnings);
        return file;
    }

private:
    const Model3mf& modelAt(const std::string& path) {
        const std::string key = lowerCase(path);  // as names in the archive
        const auto known = models_.find(key);
        if (known != models_.end()) return known->second;
        ModelHandler handler;
        parseXml(files_.read(path), handler);
        return models_.emplace(key, std::move(handler.model)).first->second;
    }

    ZipFiles& files_;
    const MeshReadOptions& options_;
    Unpacking unpacking_;
    JoinedMeshes joined_;
    std::map<std::string, Model3mf> models_;
};

MeshFile decode3mf(std::string_view bytes, const MeshReadOptions& options) {
    const std::size_t stored = options.storedBytes > 0 ? options.storedBytes : bytes.size();
    ZipFiles files(bytes, stored);
    return Reader3mf(files, stored, options).read();
}

/// Archives of many kinds begin alike; a 3MF has a model among its first files.
bool is3mf(std::string_view head, std::uint64_t /*byteCount*/) {
    const auto holds = [&](std::string_view name) {
        return head.find(name) != std::string_view::npos;
    };
    return head.starts_with("PK\3\4") && (holds(".model") || holds("3D/"));
}

}  // namespace

extern const Codec k3mfCodec{is3mf, decode3mf, encode3mf, false, encode3mfParts};

}  // namespace adaptiso::meshio
