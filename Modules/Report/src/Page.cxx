#include "adaptiso/Report/Page.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "Html.h"
#include "PageFiles.h"
#include "PageParts.h"
#include "Scene.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

using Json = nlohmann::ordered_json;

/// Text in a script element that is data: nothing in it can end the element.
std::string dataElement(const std::string& id, const std::string& type, const std::string& text) {
    return "<script id=\"" + id + "\" type=\"" + type + "\">" + text + "</script>\n";
}

std::string jsonText(const Json& json) {
    std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
    for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) {
        text.replace(at, 1, "\\u003c");
    }
    return text;
}

Json pointJson(const Vec3& p) {
    return {p.x, p.y, p.z};
}

/// Where to look for a surface: the middle of its box, or of what is its own there, along x.
Vec3 pointIn(const SceneMesh& mesh) {
    if (mesh.isEmpty()) return {};
    const BoundingBox box = boxOf(mesh);
    Vec3 middle = 0.5 * (box.minimum + box.maximum);
    // a bent region does not hold its middle: take that of the widest part of a line through it
    std::vector<double> crossings;
    for (const Segment& segment : cutByPlane(mesh, 2, middle.z)) {
        const Vec3 &a = segment[0], &b = segment[1];
        if ((a.y >= middle.y) == (b.y >= middle.y)) continue;
        crossings.push_back(a.x + (middle.y - a.y) / (b.y - a.y) * (b.x - a.x));
    }
    std::sort(crossings.begin(), crossings.end());
    double widest = 0;
    for (std::size_t n = 0; n + 1 < crossings.size(); n += 2) {
        const double width = crossings[n + 1] - crossings[n];
        if (width <= widest) continue;
        widest = width;
        middle.x = 0.5 * (crossings[n] + crossings[n + 1]);
    }
    return middle;
}

/// The scene as the viewer gets it: no more triangles than it can show with ease.
Scene forViewer(const Scene& scene, const PageOptions& options, std::vector<std::string>& notes) {
    std::vector<std::int64_t> counts;
    for (const SceneSurface& surface : scene.surfaces) {
        counts.push_back(surface.mesh.triangleCount());
    }
    const std::vector<std::int64_t> shares = shareTriangles(counts, options.maxTriangles);
    if (shares == counts) return scene;
    Scene result = scene;
    for (std::size_t n = 0; n < counts.size(); ++n) {
        result.surfaces[n] = coarser(scene.surfaces[n], shares[n]);
    }
    notes.push_back(
        "The viewer shows the surfaces coarser than they are, to stay quick and small; "
        "pictures and numbers are of the surfaces themselves.");
    return result;
}

std::string viewerData(const Report& report, const Scene& scene, const PageOptions& options,
                       std::vector<std::string>& notes) {
    const Scene shown = forViewer(scene, options, notes);
    Json surfaces = Json::array(), spots = Json::array();
    std::string elements;  // tens of MB: added to, not copied
    for (std::size_t n = 0; n < shown.surfaces.size(); ++n) {
        const SceneSurface& surface = shown.surfaces[n];
        // those around the first are seen through
        const bool isOpaque = n == 0 || report.areRegions;
        surfaces.push_back(
            {{"name", surface.name}, {"color", surface.color}, {"opacity", isOpaque ? 1.0 : 0.35}});
        if (report.areRegions) surfaces.back()["point"] = pointJson(pointIn(surface.mesh));
        elements += dataElement("surface-" + std::to_string(n), "text/plain",
                                encodeBase64(gzip(mz3Of(surface))));
    }
    for (const SceneSpot& spot : shown.spots) spots.push_back(pointJson(spot.pointMm));
    const Vec3 middle = 0.5 * (scene.box.minimum + scene.box.maximum);
    const Json data{
        {"surfaces", surfaces},
        {"spots", spots},
        {"start", pointJson(shown.spots.empty() ? middle : shown.spots.front().pointMm)},
        {"hasImage", report.volume.has_value()},
        {"areRegions", report.areRegions}};
    const std::string image =
        report.volume ? niftiOf(report.volume->view, options.maxVoxels, scene.face.get())
                      : blankNifti(scene.box);
    elements += dataElement("data", "application/json", jsonText(data));
    elements += dataElement("volume", "text/plain", encodeBase64(gzip(image)));
    return elements;
}

void addViewerScripts(std::string& html) {
    addScript(embedded::niivueJs(), html);
    addScript(embedded::viewerJs(), html);
}

/// Like addViewerScripts(), with niivue's script packed: a third of its size.
std::string packedViewerScripts() {
    static const std::string packed = encodeBase64(gzip(embedded::niivueJs()));
    return dataElement("niivue", "text/plain", packed) +
           dataElement("viewer-code", "text/plain", std::string(embedded::viewerJs())) +
           "<script>" + std::string(embedded::unpackJs()) + "</script>\n";
}

std::string imageElement(const Picture& picture, const std::string& style) {
    return "<img alt=\"" + escaped(picture.altText) + "\" style=\"" + style +
           "\" src=\"data:image/png;base64," + encodeBase64(picture.png) + "\">\n";
}

}  // namespace

bool hasViewer() {
    return !embedded::niivueJs().empty();
}

std::string htmlPage(const Report& report, const std::vector<Picture>& pictures,
                     const PageOptions& options) {
    const Scene scene = makeScene(report);
    std::vector<std::string> notes = report.notes;
    bool showsViewer = scene.hasTriangles();
    if (showsViewer && !hasViewer()) {
        notes.push_back(
            "This program was built without the interactive viewer (niivue); the "
            "pictures show the same surfaces.");
        showsViewer = false;
    }
    std::string scripts;
    if (showsViewer) {
        scripts = viewerData(report, scene, options, notes);
        addViewerScripts(scripts);
    }
    const std::string hashes =
        showsViewer ? scriptHashes({embedded::niivueJsSha256(), embedded::viewerJsSha256()})
                    : scriptHashes({});
    const std::string scale = scaleHtml(scene);
    PageFrame frame;
    frame.verdict = report.verdict;
    frame.hasWarnings = !report.warnings.empty();
    frame.generator = report.program + " " + report.version;
    frame.date = report.date;
    frame.title = report.title;
    frame.headline = report.headline;
    frame.banner = failuresHtml(report) + warningsHtml(report);
    frame.facts = factsHtml(report);
    frame.body = faceHtml(report, scene) + spotsHtml(scene, showsViewer) +
                 (showsViewer ? fill(embedded::viewerHtml(), {{"SCALE", scale}}) : "") +
                 checksHtml(report) + tablesHtml(report) + picturesHtml(pictures) +
                 notesHtml(report, notes);
    frame.sources = "img-src data: blob:; script-src " + hashes +
                    "; connect-src data: blob:; worker-src blob:; font-src data:";
    frame.footnote = "Points are in " + report.frame +
                     (scene.isFrameSaid ? "" : "; sides are named as if it were RAS") +
                     ". This page holds everything it needs, loads nothing and sends nothing.";
    if (showsViewer) {
        frame.end = "<details><summary>Licences of the viewer</summary><pre>" +
                    escaped(std::string(embedded::licenses())) + "</pre></details>";
    }
    frame.scripts = std::move(scripts);
    return framed(frame);
}

std::string notebookHtml(const Report& report, const Picture& picture, const PageOptions& options) {
    const Scene scene = makeScene(report);
    std::vector<std::string> notes;
    std::string html = "<div style=\"max-width: 1020px\">\n";
    if (scene.hasTriangles() && hasViewer()) {
        const std::string scripts =
            viewerData(report, scene, options, notes) + packedViewerScripts();
        const std::string scale = scaleHtml(scene), title = escaped(report.title);
        const std::string viewer = fill(embedded::viewerHtml(), {{"SCALE", scale}});
        const std::string hashes = scriptHashes(
            {embedded::unpackJsSha256(), embedded::niivueJsSha256(), embedded::viewerJsSha256()});
        const std::string page = fill(embedded::notebookHtml(), {{"TITLE", title},
                                                                 {"SCRIPT_HASHES", hashes},
                                                                 {"STYLE", embedded::styleCss()},
                                                                 {"VIEWER", viewer},
                                                                 {"SCRIPTS", scripts}});
        constexpr const char* kPlace = "position: absolute; top: 0; left: 0; width: 100%; ";
        // below it a strip for the notice of a browser that can't show the viewer
        html += "<div style=\"position: relative; height: 500px; background: #fff\">\n" +
                imageElement(picture, std::string(kPlace) + "height: 470px; object-fit: contain") +
                "<iframe title=\"" + title + "\" sandbox=\"allow-scripts\" style=\"" + kPlace +
                "height: 100%; border: 0\" srcdoc=\"" + escaped(page) + "\"></iframe>\n</div>\n";
    } else {
        html += imageElement(picture, "max-width: 100%");
    }
    html += "<p>" + escaped(report.title);
    for (const std::string& note : notes) html += ". " + escaped(note);
    return html + "</p>\n</div>\n";
}

}  // namespace adaptiso
