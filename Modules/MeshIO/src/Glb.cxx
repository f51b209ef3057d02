// GLB: glTF 2.0 in one file: "glTF", a version, a length; a chunk of JSON, a chunk of bytes. glTF
// is in metres, with Y up and Z to the front. Ours hold the frame's numbers in mm, as float; the
// matrix of the root node turns and scales them, so that they come back as they were. Colours are
// linear in glTF; 16 bits of them keep 8 bits of a screen's.

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "Bytes.h"
#include "Codecs.h"
#include "Counts.h"
#include "Faces.h"
#include "Parts.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ParseJson.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/PortableMath.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso::meshio {
namespace {

using GltfJson = nlohmann::ordered_json;  // of what is written, in a fixed order
using ReadJson = nlohmann::json;          // an ordered one searches all its keys for each

constexpr std::string_view kGltfMagic = "glTF";
constexpr std::size_t kGltfHeaderBytes = 12, kChunkHeaderBytes = 8;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;
constexpr int kInt8 = 5120, kUInt8 = 5121, kInt16 = 5122, kUInt16 = 5123, kUInt32 = 5125,
              kFloat32 = 5126;
constexpr int kPointTarget = 34962, kTriangleTarget = 34963;
constexpr const char* kBlender = "save it anew, e.g. with Blender";
constexpr double kMmPerMetre = 1000;

/// From a frame to glTF's axes: up is Y, the face looks to Z.
Mat3 turnToGltf(CoordinateFrame frame) {
    if (frame == CoordinateFrame::Lps) return {{{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}}};
    return {{{{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}}}};
}

// ---- colours

constexpr double kFullShade = 255, kFullLinear = 65535;

/// Linear intensity, 0 to 1, of an sRGB value, 0 to 255.
double linearOf(std::uint8_t shade) {
    const double s = shade / kFullShade;
    constexpr double kSteep = 0.04045;
    return s <= kSteep ? s / 12.92 : portable::exp(2.4 * portable::log((s + 0.055) / 1.055));
}

std::uint8_t shadeOfLinear(double linear) {
    constexpr double kSteep = 0.0031308;
    if (!(linear > 0)) return 0;
    const double s =
        linear <= kSteep
            ? 12.92 * linear
            : 1.055 * portable::exp(portable::log(std::min(linear, 1.0)) / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(kFullShade * std::clamp(s, 0.0, 1.0)));
}

// ---- writing

/// The JSON of a scene, and where its arrays lie in the chunk of bytes.
class GltfScene {
public:
    explicit GltfScene(const MeshWriteOptions& options) {
        const Mat3 turn = turnToGltf(options.frame);
        GltfJson matrix = GltfJson::array();
        for (const Vec3& c : turn.column) {
            for (const double value : {c.x, c.y, c.z, 0.0}) {
                matrix.push_back(value / kMmPerMetre + 0.0);
            }
        }
        for (const int value : {0, 0, 0, 1}) matrix.push_back(value);
        json_["asset"] = {{"version", "2.0"}, {"generator", headerLine(options)}};
        json_["scene"] = 0;
        json_["scenes"][0]["nodes"][0] = 0;
        json_["nodes"][0] = {{"name", "mm"}, {"matrix", matrix}, {"children", GltfJson::array()}};
    }

    void add(const MeshPart& part, const std::vector<Color>* colors) {
        const TriangleMesh& shape = *part.mesh;
        const auto points = std::ssize(shape.points);
        GltfJson attributes;
        attributes["POSITION"] = array(points, 12, "VEC3", kFloat32, kPointTarget);
        addBounds(shape.points, json_["accessors"].back());
        if (!shape.normals.empty()) {
            attributes["NORMAL"] = array(points, 12, "VEC3", kFloat32, kPointTarget);
        }
        if (colors != nullptr) {
            attributes["COLOR_0"] = array(points, 8, "VEC4", kUInt16, kPointTarget);
            json_["accessors"].back()["normalized"] = true;
        }
        const std::size_t indices =
            array(3 * std::ssize(shape.triangles), 4, "SCALAR", kUInt32, kTriangleTarget);
        const std::size_t number = json_["meshes"].size();
        GltfJson look{{"metallicFactor", 0}, {"roughnessFactor", 0.6}};
        if (part.color && colors == nullptr) {
            GltfJson& factor = look["baseColorFactor"];
            for (const std::uint8_t shade : *part.color) {
                factor.push_back(std::round(kFullLinear * linearOf(shade)) / kFullLinear);
            }
            factor.push_back(1);
        }
        json_["materials"].push_back({{"name", part.name}, {"pbrMetallicRoughness", look}});
        GltfJson& mesh = json_["meshes"][number];
        mesh["name"] = part.name;
        mesh["primitives"][0] = {
            {"attributes", attributes}, {"indices", indices}, {"material", number}};
        json_["nodes"].push_back({{"name", part.name}, {"mesh", number}});
        json_["nodes"][0]["children"].push_back(number + 1);
    }

    std::int64_t bytes() const { return bytes_; }

    std::string text() {
        json_["buffers"][0]["byteLength"] = bytes_;
        return json_.dump(-1, ' ', false, GltfJson::error_handler_t::replace);
    }

private:
    /// \return the accessor's number
    std::size_t array(std::int64_t count, std::int64_t each, const char* type, int component,
                      int target) {
        const std::size_t view = json_["bufferViews"].size();
        json_["bufferViews"].push_back({{"buffer", 0},
                                        {"byteOffset", bytes_},
                                        {"byteLength", count * each},
                                        {"target", target}});
        bytes_ += count * each;
        json_["accessors"].push_back(
            {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
        return json_["accessors"].size() - 1;
    }

    static void addBounds(const std::vector<Vec3>& points, GltfJson& accessor) {
        BoundingBox box{points.front(), points.front()};
        for (const Vec3& p : points) box.add(p);
        for (const auto& [key, corner] :
             {std::pair("min", box.minimum), std::pair("max", box.maximum)}) {
            for (int axis = 0; axis < 3; ++axis) {
                const volatile float stored = static_cast<float>(corner[axis]);  // as in Stl.cxx
                accessor[key].push_back(static_cast<double>(stored));
            }
        }
    }

    GltfJson json_;
    std::int64_t bytes_ = 0;
};

void encodeArrays(const TriangleMesh& mesh, const std::vector<Color>* colors, ByteSink& sink) {
    for (const Vec3& p : mesh.points) {
        for (int axis = 0; axis < 3; ++axis) sink.littleEndian(static_cast<float>(p[axis]));
    }
    for (const Normal& normal : mesh.normals) {
        // glTF has unit vectors alone
        const Normal n = normal == Normal{} ? Normal{0, 0, 1} : normal;
        for (const float value : {n.x, n.y, n.z}) sink.littleEndian(value);
    }
    if (colors != nullptr) {
        std::array<std::uint16_t, 256> linear{};
        for (std::size_t shade = 0; shade < linear.size(); ++shade) {
            linear[shade] = static_cast<std::uint16_t>(
                std::lround(kFullLinear * linearOf(static_cast<std::uint8_t>(shade))));
        }
        for (const Color& color : *colors) {
            for (const std::uint8_t shade : color) sink.littleEndian(linear[shade]);
            sink.littleEndian(static_cast<std::uint16_t>(kFullLinear));
        }
    }
    for (const Triangle& t : mesh.triangles) {
        for (const VertexId vertex : t) sink.littleEndian(static_cast<std::uint32_t>(vertex));
    }
}

void encodeGlbParts(std::span<const MeshPart> parts, const MeshWriteOptions& options,
                    ByteSink& sink) {
    const std::vector<Color>* const colors = colorsOf(options);
    GltfScene scene(options);
    for (const MeshPart& part : parts) scene.add(part, colors);
    std::string json = scene.text();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::uint64_t length = kGltfHeaderBytes + 2 * kChunkHeaderBytes + json.size() +
                                 static_cast<std::uint64_t>(scene.bytes());
    if (length > std::numeric_limits<std::uint32_t>::max()) {
        throw InvalidInput("GLB files hold 4 GB at most, the surface takes " +
                           std::to_string(length) + " bytes; write .ply or .vtp");
    }
    sink << kGltfMagic;
    const auto word = [&](auto value) { sink.littleEndian(static_cast<std::uint32_t>(value)); };
    word(2);
    word(length);
    word(json.size());
    word(kJsonChunk);
    sink << json;
    word(scene.bytes());
    word(kBinChunk);
    for (const MeshPart& part : parts) encodeArrays(*part.mesh, colors, sink);
}

void encodeGlb(const MeshRecord& record, ByteSink& sink) {
    const MeshPart part{"surface", {}, &record.mesh};
    encodeGlbParts({&part, 1}, record.options, sink);
}

// ---- reading

std::int64_t wholeOf(const ReadJson& value, const char* what) {
    constexpr std::int64_t kMost = std::int64_t{1} << 40;  // no sum of some overflows
    const bool isWhole = value.is_number_integer() &&
                         (!value.is_number_unsigned() || value.get<std::uint64_t>() <= kMost);
    const std::int64_t number = isWhole ? value.get<std::int64_t>() : -1;
    if (number < 0 || number > kMost) malformed(std::string("its ") + what + " is no size");
    return number;
}

std::int64_t wholeAt(const ReadJson& object, const char* key, std::int64_t otherwise) {
    return object.contains(key) ? wholeOf(object.at(key), key) : otherwise;
}

double realAt(const ReadJson& list, std::size_t index) {
    return list.at(index).get<double>();
}

/// The element that `key` of `object` numbers; nullptr where it has none.
const ReadJson* referred(const ReadJson& file, const char* list, const ReadJson& object,
                         const char* key) {
    if (!object.contains(key)) return nullptr;
    return &file.at(list).at(static_cast<std::size_t>(wholeAt(object, key, 0)));
}

std::int64_t componentBytes(int type) {
    switch (type) {
        case kInt8:
        case kUInt8:
            return 1;
        case kInt16:
        case kUInt16:
            return 2;
        case kUInt32:
        case kFloat32:
            return 4;
        default:
            malformed("an array has the component type " + std::to_string(type));
    }
}

/// An array of a file; `bytes` begins at its first number.
struct GltfArray {
    std::string_view bytes{};  ///< empty: zeros
    std::int64_t count = 0, components = 0, stride = 0;
    int type = 0;
    bool isNormalized = false;

    double real(std::int64_t element, std::int64_t component) const {
        if (bytes.empty()) return 0;
        const char* const at = bytes.data() + element * stride + component * componentBytes(type);
        const auto part = [&](auto value) {
            using Stored = decltype(value);
            const auto stored = static_cast<double>(loadAs<Stored>(at, std::endian::little));
            const auto full = static_cast<double>(std::numeric_limits<Stored>::max());
            return isNormalized ? std::max(stored / full, -1.0) : stored;
        };
        switch (type) {
            case kInt8:
                return part(std::int8_t{});
            case kUInt8:
                return part(std::uint8_t{});
            case kInt16:
                return part(std::int16_t{});
            case kUInt16:
                return part(std::uint16_t{});
            case kUInt32:
                return part(std::uint32_t{});
            default:
                return loadAs<float>(at, std::endian::little);
        }
    }
    Vec3 triple(std::int64_t element) const {
        return {real(element, 0), real(element, 1), real(element, 2)};
    }
};

AffineTransform nodeTransform(const ReadJson& node) {
    AffineTransform transform;
    if (node.contains("matrix")) {
        const ReadJson& m = node.at("matrix");
        for (int c = 0; c < 3; ++c) {
            for (int row = 0; row < 3; ++row) {
                transform.linear.column[static_cast<std::size_t>(c)][row] =
                    realAt(m, static_cast<std::size_t>(4 * c + row));
            }
            transform.offset[c] = realAt(m, static_cast<std::size_t>(12 + c));
        }
        return transform;
    }
    if (node.contains("rotation")) {
        const ReadJson& q = node.at("rotation");
        const double x = realAt(q, 0), y = realAt(q, 1), z = realAt(q, 2), w = realAt(q, 3);
        const double s = 2 / (x * x + y * y + z * z + w * w);
        transform.linear = {
            {{{1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)},
              {s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)},
              {s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)}}}};
    }
    for (int axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<std::size_t>(axis);
        if (node.contains("scale")) {
            transform.linear.column[i] = realAt(node.at("scale"), i) * transform.linear.column[i];
        }
        if (node.contains("translation")) {
            transform.offset[axis] = realAt(node.at("translation"), i);
        }
    }
    return transform;
}

/// A file's meshes as its scene places them.
class GltfReader {
public:
    GltfReader(const ReadJson& file, std::string_view bin, std::size_t fileBytes,
               const MeshReadOptions& options)
        : file_(file), bin_(bin), options_(options), unpacking_(fileBytes) {
        const std::string generator = file.at("asset").value("generator", "");
        marks_ = findFrameMarker(generator);
        isOurs_ = generator.starts_with("adaptiso surface");
    }

    MeshFile read() && {
        requireReadable();
        visitScene();
        MeshFile read;
        FrameMarks marks(options_);
        marks.add(marks_);
        read.frame = marks.frame();
        read.warnings = std::move(unpacking_.warnings);
        noteLinesLeftOut(linesLeftOut_, read.warnings);
        std::move(joined_).moveTo(read, options_);
        if (isConverted_) read.warnings.push_back({"unit-converted", conversion(read.mesh)});
        if (options_.keepsPointArrays) read.arraysLeftOut = {leftOut_.begin(), leftOut_.end()};
        return read;
    }

private:
    static std::string conversion(const TriangleMesh& mesh) {
        std::string text = "its metres, with Y up, were turned into mm, with Z up";
        constexpr double kLargeMm = 10'000;
        const BoundingBox box = mesh.points.empty() ? BoundingBox{} : boundingBox(mesh);
        if (norm(box.size()) > kLargeMm) {
            text += "; it is " + formatShort(norm(box.size()) / kMmPerMetre) +
                    " m large: where its numbers are mm, scale it by 0.001 first";
        }
        return text;
    }

    void requireReadable() const {
        const std::string version = file_.at("asset").at("version").get<std::string>();
        if (!version.starts_with("2.")) {
            unsupported("it is glTF " + printable(version), "save it as glTF 2.0");
        }
        if (!file_.contains("extensionsRequired")) return;
        for (const ReadJson& each : file_.at("extensionsRequired")) {
            const std::string name = each.get<std::string>();
            const bool isLook = name.starts_with("KHR_materials") ||
                                name.starts_with("KHR_texture") ||
                                name.starts_with("EXT_texture") || name == "KHR_lights_punctual" ||
                                name == "KHR_mesh_quantization";
            if (isLook) continue;
            unsupported("it needs glTF's extension " + printable(name),
                        "save it without (uncompressed), e.g. with Blender");
        }
    }

    /// Depth first, in the order of the file.
    void visitScene() {
        if (!file_.contains("nodes")) malformed("its scene has no node");
        const ReadJson& nodes = file_.at("nodes");
        std::vector<std::pair<std::size_t, AffineTransform>> open;
        const auto push = [&](const ReadJson& numbers, const AffineTransform& from) {
            for (std::size_t n = numbers.size(); n-- > 0;) {
                open.emplace_back(static_cast<std::size_t>(wholeOf(numbers.at(n), "node")), from);
            }
        };
        if (file_.contains("scenes")) {
            const ReadJson& scene =
                file_.at("scenes").at(static_cast<std::size_t>(wholeAt(file_, "scene", 0)));
            if (scene.contains("nodes")) push(scene.at("nodes"), {});
        } else {
            push(roots(nodes), {});
        }
        const AffineTransform toMm{transpose(turnToGltf(marks_.value_or(CoordinateFrame::Ras))) *
                                       Mat3::diagonal(kMmPerMetre, kMmPerMetre, kMmPerMetre),
                                   {}};
        std::set<std::size_t> seen;
        while (!open.empty()) {
            const auto [number, from] = open.back();
            open.pop_back();
            if (!seen.insert(number).second) malformed("its scene has a node twice");
            const ReadJson& node = nodes.at(number);
            const AffineTransform place = from * nodeTransform(node);
            if (const ReadJson* const mesh = referred(file_, "meshes", node, "mesh")) {
                if (node.contains("skin")) {
                    unsupported("a skeleton moves one of its meshes",
                                "apply the armature, e.g. with Blender");
                }
                if (node.contains("weights") || mesh->contains("weights")) {
                    unsupported("shape keys move one of its meshes",
                                "apply them, e.g. with Blender");
                }
                addMesh(*mesh, toMm * place);
            }
            if (node.contains("children")) push(node.at("children"), place);
        }
    }

    static ReadJson roots(const ReadJson& nodes) {
        std::set<std::int64_t> children;
        for (const ReadJson& node : nodes) {
            if (!node.contains("children")) continue;
            for (const ReadJson& child : node.at("children")) {
                children.insert(wholeOf(child, "node"));
            }
        }
        ReadJson found = ReadJson::array();
        for (std::int64_t n = 0; n < std::ssize(nodes); ++n) {
            if (!children.contains(n)) found.push_back(n);
        }
        return found;
    }

    void addMesh(const ReadJson& mesh, const AffineTransform& place) {
        PlacedMesh placed;
        bool haveNormals = true, haveColors = true;
        for (const ReadJson& primitive : mesh.at("primitives")) {
            constexpr std::int64_t kEach = 256;  // of a file whose nodes have the same meshes
            const std::int64_t own =
                primitive.contains("attributes") ? std::ssize(primitive.at("attributes")) : 0;
            unpacking_.add(kEach * (1 + own), 1);
            const std::int64_t mode = wholeAt(primitive, "mode", 4);
            constexpr std::int64_t kTriangles = 4, kStrip = 5, kFan = 6;
            if (mode != kTriangles && mode != kStrip && mode != kFan) {
                ++linesLeftOut_;
                continue;
            }
            addPrimitive(primitive, mode, placed, haveNormals, haveColors);
        }
        if (placed.mesh.points.empty()) return;
        if (!haveNormals) placed.mesh.normals.clear();
        if (!haveColors) placed.colors.clear();
        if (!isOurs_) mergeEqualPoints(placed);
        isConverted_ = isConverted_ || !isIdentity(place);
        joined_.add(std::move(placed), place);
    }

    void addPrimitive(const ReadJson& primitive, std::int64_t mode, PlacedMesh& placed,
                      bool& haveNormals, bool& haveColors) {
        const ReadJson& attributes = primitive.at("attributes");
        if (!attributes.contains("POSITION")) malformed("a mesh has no POSITION");
        const std::int64_t before = std::ssize(placed.mesh.points);
        const GltfArray points = arrayAt(attributes, "POSITION", 3);
        unpacking_.add(points.count, sizeof(Vec3));
        for (std::int64_t i = 0; i < points.count; ++i) {
            placed.mesh.points.push_back(points.triple(i));
        }
        haveNormals = haveNormals && attributes.contains("NORMAL");
        if (haveNormals) {
            const GltfArray normals = arrayAt(attributes, "NORMAL", 3, points.count);
            for (std::int64_t i = 0; i < points.count; ++i) {
                placed.mesh.normals.push_back(storedNormal(normals.triple(i)));
            }
        }
        addColors(primitive, points.count, placed, haveColors);
        for (const auto& [name, accessor] : attributes.items()) {
            if (name != "POSITION" && name != "NORMAL" && name != "COLOR_0") {
                leftOut_.insert(storedName(name));
            }
        }
        addCorners(primitive, mode, before, points.count, placed.mesh.triangles);
    }

    void addColors(const ReadJson& primitive, std::int64_t count, PlacedMesh& placed,
                   bool& haveColors) {
        if (!options_.keepsPointArrays || !haveColors) return;
        const ReadJson* const material = referred(file_, "materials", primitive, "material");
        const ReadJson none = ReadJson::object();
        const ReadJson& look = material != nullptr && material->contains("pbrMetallicRoughness")
                                   ? material->at("pbrMetallicRoughness")
                                   : none;
        const ReadJson& attributes = primitive.at("attributes");
        haveColors = attributes.contains("COLOR_0") || look.contains("baseColorFactor");
        if (!haveColors) return;
        Vec3 factor{1, 1, 1};
        if (look.contains("baseColorFactor")) {
            const ReadJson& shades = look.at("baseColorFactor");
            factor = {realAt(shades, 0), realAt(shades, 1), realAt(shades, 2)};
        }
        std::optional<GltfArray> own;
        if (attributes.contains("COLOR_0")) own = arrayAt(attributes, "COLOR_0", 3, count);
        for (std::int64_t i = 0; i < count; ++i) {
            const Vec3 of = own ? own->triple(i) : Vec3{1, 1, 1};
            placed.colors.push_back({shadeOfLinear(of.x * factor.x), shadeOfLinear(of.y * factor.y),
                                     shadeOfLinear(of.z * factor.z)});
        }
    }

    void addCorners(const ReadJson& primitive, std::int64_t mode, std::int64_t before,
                    std::int64_t points, std::vector<Triangle>& triangles) {
        std::optional<GltfArray> indices;
        if (primitive.contains("indices")) indices = arrayAt(primitive, "indices", 1);
        const bool areWhole =
            !indices ||
            ((indices->type == kUInt8 || indices->type == kUInt16 || indices->type == kUInt32) &&
             !indices->isNormalized);
        if (!areWhole) {
            malformed("the indices of a mesh have the component type " +
                      std::to_string(indices->type));
        }
        const std::int64_t corners = indices ? indices->count : points;
        unpacking_.add(corners, sizeof(VertexId));
        const auto corner = [&](std::int64_t i) {
            const std::int64_t own = indices ? static_cast<std::int64_t>(indices->real(i, 0)) : i;
            return own >= 0 && own < points ? own + before : std::int64_t{-1};
        };
        constexpr std::int64_t kTriangles = 4, kStrip = 5;
        if (mode == kTriangles && corners % 3 != 0) {
            malformed("a mesh has " + std::to_string(corners) + " corners, no multiple of 3");
        }
        const std::int64_t step = mode == kTriangles ? 3 : 1;
        for (std::int64_t i = 0; i + 2 < corners; i += step) {
            const std::int64_t odd = mode == kStrip ? i % 2 : 0;
            const std::int64_t first = mode == kTriangles || mode == kStrip ? i : 0;
            const Triangle t{corner(mode == kStrip ? i + odd : first), corner(i + 1 - odd),
                             corner(i + 2)};
            const bool isJoint = t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
            if (mode != kTriangles && isJoint && t[0] >= 0) continue;
            triangles.push_back(t);
        }
    }

    /// \param count  that it must have; negative: any
    GltfArray arrayAt(const ReadJson& object, const char* key, std::int64_t components,
                      std::int64_t count = -1) const {
        const ReadJson& accessor =
            file_.at("accessors").at(static_cast<std::size_t>(wholeOf(object.at(key), key)));
        if (accessor.contains("sparse")) {
            unsupported("its array " + std::string(key) + " is sparse", kBlender);
        }
        GltfArray array;
        array.count = wholeAt(accessor, "count", 0);
        array.type = static_cast<int>(wholeAt(accessor, "componentType", 0));
        array.isNormalized = accessor.value("normalized", false);
        const std::string type = accessor.at("type").get<std::string>();
        array.components = type == "SCALAR" ? 1 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 0;
        if (array.components < components || (components == 1 && array.components != 1)) {
            malformed("its array " + std::string(key) + " is " + printable(type));
        }
        if (count >= 0 && array.count != count) {
            malformed("its array " + std::string(key) + " has " + std::to_string(array.count) +
                      " values for " + std::to_string(count) + " points");
        }
        const std::int64_t each = array.components * componentBytes(array.type);
        const ReadJson* const view = referred(file_, "bufferViews", accessor, "bufferView");
        if (view == nullptr) {
            unsupported("its array " + std::string(key) + " has no data (compressed elsewhere)",
                        kBlender);
        }
        const ReadJson* const buffer = referred(file_, "buffers", *view, "buffer");
        if (buffer == nullptr || wholeAt(*view, "buffer", 0) != 0 || buffer->contains("uri")) {
            unsupported("its data lie in another file", "save it as GLB, all in one file");
        }
        array.stride = wholeAt(*view, "byteStride", each);
        if (array.stride < each) malformed("the byteStride of an array is too small");
        const std::int64_t begin = wholeAt(*view, "byteOffset", 0),
                           length = wholeAt(*view, "byteLength", 0),
                           own = wholeAt(accessor, "byteOffset", 0);
        requireRoom("bytes", begin + length, 1, bin_.size());
        const std::int64_t left = length - own;
        if (array.count > 0 && (left < each || (left - each) / array.stride < array.count - 1)) {
            damaged("its array " + std::string(key) + " has " + std::to_string(array.count) +
                    " values in " + std::to_string(std::max<std::int64_t>(left, 0)) + " bytes");
        }
        array.bytes = bin_.substr(static_cast<std::size_t>(begin + std::min(own, length)));
        return array;
    }

    const ReadJson& file_;
    std::string_view bin_;
    const MeshReadOptions& options_;
    Unpacking unpacking_;
    std::optional<CoordinateFrame> marks_;
    bool isOurs_ = false, isConverted_ = false;
    std::int64_t linesLeftOut_ = 0;
    std::set<std::string> leftOut_;
    JoinedMeshes joined_;
};

MeshFile decodeGlb(std::string_view bytes, const MeshReadOptions& options) {
    ByteSource source(bytes);
    const auto word = [](ByteSource& from) {
        return from.number<std::uint32_t>(std::endian::little);
    };
    if (source.take(kGltfMagic.size()) != kGltfMagic) malformed("it does not begin with glTF");
    if (const std::uint32_t version = word(source); version != 2) {
        unsupported("it is glTF " + std::to_string(version), "save it as glTF 2.0");
    }
    const std::size_t length = word(source);
    if (length < kGltfHeaderBytes) damaged("its length is " + std::to_string(length));
    requireRoom("bytes", static_cast<std::int64_t>(length), 1, bytes.size());
    ByteSource chunks(bytes.substr(kGltfHeaderBytes, length - kGltfHeaderBytes));
    std::string_view text, bin;
    while (!chunks.atEnd()) {
        const std::size_t size = word(chunks);
        const std::uint32_t type = word(chunks);
        const std::string_view chunk = chunks.take(size);
        if (type == kJsonChunk && text.empty()) text = chunk;
        if (type == kBinChunk && bin.empty()) bin = chunk;
    }
    text = text.substr(0, text.find_last_not_of('\0') + 1);  // programs that pad it so
    const ReadJson file = parseJson<ReadJson>(text);
    if (!file.is_object()) malformed("its JSON can't be read");
    try {
        MeshFile read =
            GltfReader(file, bin, options.storedBytes > 0 ? options.storedBytes : bytes.size(),
                       options)
                .read();
        requireNoMore({"triangles", std::ssize(read.mesh.triangles), 12}, bytes.substr(length),
                      read.warnings);
        return read;
    } catch (const ReadJson::exception&) {
        malformed("its JSON is not as glTF has it");
    }
}

bool isGlb(std::string_view head, std::uint64_t /*byteCount*/) {
    return head.starts_with(kGltfMagic);
}

}  // namespace

extern const Codec kGlbCodec{isGlb, decodeGlb, encodeGlb, false, encodeGlbParts};

}  // namespace adaptiso::meshio
