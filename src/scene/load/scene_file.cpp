#include "scene/load/scene_file.hpp"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "math/rotation.hpp"
#include "scene/load/json_reader.hpp"
#include "scene/load/text.hpp"
#include "sightline/image.hpp"

namespace sightline::load {
namespace {

glm::dmat4 translation(const glm::dvec3& by) {
    glm::dmat4 m(1.0);
    m[3] = glm::dvec4(by, 1.0);
    return m;
}

glm::dmat4 scaling(const JsonValue& value) {
    const glm::dvec3 factors = value.is_number() ? glm::dvec3(value.number()) : value.vector();
    if (factors.x == 0 || factors.y == 0 || factors.z == 0) {
        value.fail("expected factors other than 0");
    }
    glm::dmat4 m(1.0);
    for (int i = 0; i < 3; ++i) m[i][i] = factors[i];
    return m;
}

glm::dmat4 rotation(const JsonValue& value) {
    value.allow_keys({"axis", "degrees"});
    const glm::dvec3 direction = value.at("axis").direction();
    const double length = std::sqrt(glm::dot(direction, direction));
    if (!(length > 0) || !std::isfinite(length)) {
        value.at("axis").fail("expected a direction of moderate length");
    }
    return glm::dmat4(math::rotation_about(direction / length, value.at("degrees").number()));
}

glm::dmat4 matrix(const JsonValue& value) {
    const char* const expected =
        "expected 16 numbers, row by row, of an affine matrix (the last four are 0, 0, 0, 1)";
    if (!value.is_array()) value.fail(expected);
    const std::vector<JsonValue> items = value.items();
    if (items.size() != 16) value.fail(expected);
    glm::dmat4 m;
    for (int i = 0; i < 16; ++i) m[i % 4][i / 4] = items[static_cast<std::size_t>(i)].number();
    if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1) value.fail(expected);
    return m;
}

glm::dmat4 operation(const JsonValue& value) {
    value.allow_keys({"translate", "rotate", "scale", "matrix"});
    const std::string key = value.only_key();
    if (key == "translate") return translation(value.at("translate").vector());
    if (key == "rotate") return rotation(value.at("rotate"));
    if (key == "scale") return scaling(value.at("scale"));
    return matrix(value.at("matrix"));
}

/// The operations of a list, the first of which is applied first.
glm::dmat4 transform(const JsonValue& value) {
    glm::dmat4 m(1.0);
    for (const JsonValue& item : value.items()) m = operation(item) * m;
    return m;
}

bool is_finite(const glm::dmat4& m) {
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            if (!std::isfinite(m[column][row])) return false;
        }
    }
    return true;
}

/// Whether a transform of coordinates up to 1e30 stays far from overflow.
bool is_moderate(const glm::dmat4& m) {
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 3; ++row) {
            if (!(std::abs(m[column][row]) <= kLargestCoordinate)) return false;
        }
    }
    return true;
}

/// One list of operations a frame.
std::vector<glm::dmat4> frames(const JsonValue& value) {
    std::vector<glm::dmat4> result;
    for (const JsonValue& item : value.items()) {
        result.push_back(transform(item));
        if (!is_moderate(result.back())) item.fail("expected numbers that stay below 1e30");
    }
    if (result.empty()) value.fail("expected at least one frame, a list of operations");
    return result;
}

/// "#rrggbb" in sRGB, or three linear numbers.
glm::vec3 color(const JsonValue& value) {
    const char* const expected =
        "expected \"#rrggbb\" (sRGB) or [r, g, b] (three linear numbers from 0 to 1)";
    if (value.is_array()) {
        const std::vector<JsonValue> items = value.items();
        if (items.size() != 3) value.fail(expected);
        return {static_cast<float>(items[0].number_in(0, 1)),
                static_cast<float>(items[1].number_in(0, 1)),
                static_cast<float>(items[2].number_in(0, 1))};
    }
    const std::string text = value.is_string() ? value.text() : "";
    if (text.size() != 7 || text[0] != '#' ||
        text.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos) {
        value.fail(expected);
    }
    const unsigned long rgb = std::stoul(text.substr(1), nullptr, 16);
    const auto channel = [&](int shift) {
        return from_srgb8(static_cast<std::uint8_t>((rgb >> shift) & 0xff));
    };
    return {channel(16), channel(8), channel(0)};
}

MaterialOverride material(const JsonValue& value) {
    value.allow_keys({"base_color", "opacity", "specular", "shininess"});
    MaterialOverride result;
    value.if_has("base_color", [&](const JsonValue& v) { result.base_color = color(v); });
    value.if_has("opacity", [&](const JsonValue& v) {
        result.opacity = static_cast<float>(v.number_in(0, 1));
    });
    value.if_has("specular", [&](const JsonValue& v) {
        result.specular = static_cast<float>(v.number_in(0, 1));
    });
    value.if_has("shininess", [&](const JsonValue& v) {
        result.shininess = static_cast<float>(v.number_in(1, 10000));
    });
    return result;
}

ModelEntry model(const JsonValue& value) {
    value.allow_keys({"path", "name", "transform", "frames", "material"});
    ModelEntry entry;
    const JsonValue path = value.at("path");
    entry.path = path.text();
    if (entry.path.empty() || entry.path.find('\0') != std::string::npos) {
        path.fail("expected the path of a model");
    }
    if (entry.path == "-") path.fail("a scene file cannot read standard input; name a file");
    if (extension_of(entry.path) == "json") {
        path.fail("a scene file cannot hold another one; list its models instead");
    }
    value.if_has("name", [&](const JsonValue& v) { entry.name = v.text(); });
    value.if_has("transform", [&](const JsonValue& v) {
        entry.transform = transform(v);
        if (!is_finite(entry.transform)) v.fail("its numbers overflow; use smaller ones");
    });
    value.if_has("frames", [&](const JsonValue& v) { entry.frames = frames(v); });
    value.if_has("material", [&](const JsonValue& v) { entry.material = material(v); });
    return entry;
}

Quadric sphere(const JsonValue& value) {
    value.allow_keys({"centre", "radius"});
    return make_sphere(value.at("centre").vector(), value.at("radius").positive());
}

Quadric from_to(const JsonValue& value, Quadric (*make)(glm::dvec3, glm::dvec3, double)) {
    value.allow_keys({"from", "to", "radius"});
    const glm::dvec3 from = value.at("from").vector(), to = value.at("to").vector();
    if (from == to) value.at("to").fail("expected another point than \"from\"");
    return make(from, to, value.at("radius").positive());
}

Quadric general_quadric(const JsonValue& value) {
    value.allow_keys({"coefficients", "box"});
    const JsonValue list = value.at("coefficients");
    const char* const expected =
        "expected 10 numbers, the factors of x^2, y^2, z^2, xy, xz, yz, x, y, z and 1, of which "
        "one before the last is not 0";
    if (!list.is_array()) list.fail(expected);
    const std::vector<JsonValue> items = list.items();
    if (items.size() != 10) list.fail(expected);
    std::array<double, 10> coefficients{};
    bool varies = false;
    for (std::size_t i = 0; i < items.size(); ++i) {
        coefficients[i] = items[i].number();
        varies = varies || (i < 9 && coefficients[i] != 0);
    }
    if (!varies) list.fail(expected);
    const JsonValue box = value.at("box");
    const std::vector<JsonValue> corners = box.items();
    if (corners.size() != 2) box.fail("expected [[x, y, z], [x, y, z]], its lowest and highest");
    const Box extent{corners[0].vector(), corners[1].vector()};
    if (!(extent.lo.x < extent.hi.x && extent.lo.y < extent.hi.y && extent.lo.z < extent.hi.z)) {
        box.fail("expected a lowest corner below the highest one in x, y and z");
    }
    return make_quadric(coefficients, extent);
}

SurfaceEntry surface(const JsonValue& value) {
    value.allow_keys(
        {"sphere", "cylinder", "cone", "quadric", "name", "transform", "frames", "material"});
    SurfaceEntry entry;
    int kinds = 0;
    const auto kind = [&](const char* name, const auto& read) {
        value.if_has(name, [&](const JsonValue& v) {
            entry.quadric = read(v);
            entry.name = name;
            ++kinds;
        });
    };
    kind("sphere", sphere);
    kind("cylinder", [](const JsonValue& v) { return from_to(v, make_cylinder); });
    kind("cone", [](const JsonValue& v) { return from_to(v, make_cone); });
    kind("quadric", general_quadric);
    if (kinds != 1) value.fail("expected one of the keys sphere, cylinder, cone, quadric");
    value.if_has("name", [&](const JsonValue& v) { entry.name = v.text(); });
    value.if_has("transform", [&](const JsonValue& v) {
        entry.quadric = transformed(entry.quadric, transform(v));
    });
    value.if_has("material", [&](const JsonValue& v) { entry.material = material(v); });
    const char* const irregular =
        "it is flat, or its size is not between 1e-30 and 1e30; change its numbers";
    if (!is_regular(entry.quadric)) value.fail(irregular);
    value.if_has("frames", [&](const JsonValue& v) {
        entry.frames = frames(v);
        for (std::size_t i = 0; i < entry.frames.size(); ++i) {
            if (!is_regular(transformed(entry.quadric, entry.frames[i]))) {
                v.items()[i].fail(irregular);
            }
        }
    });
    return entry;
}

Light light(const JsonValue& value) {
    value.allow_keys({"type", "direction", "position", "color", "intensity"});
    Light result;
    const std::string type = value.at("type").text();
    if (type == "directional") {
        result.kind = LightKind::directional;
        result.direction = value.at("direction").direction();
    } else if (type == "point") {
        result.kind = LightKind::point;
        result.position = value.at("position").vector();
    } else if (type != "headlight") {
        value.at("type").fail("expected \"headlight\", \"directional\" or \"point\"");
    }
    if (value.has("direction") && result.kind != LightKind::directional) {
        value.at("direction").fail("only a directional light has a direction");
    }
    if (value.has("position") && result.kind != LightKind::point) {
        value.at("position").fail("only a point light has a position");
    }
    value.if_has("color", [&](const JsonValue& v) { result.color = color(v); });
    value.if_has("intensity", [&](const JsonValue& v) {
        result.intensity = static_cast<float>(v.number_in(0, 1e6));
    });
    return result;
}

CameraOptions camera(const JsonValue& value) {
    value.allow_keys({"eye", "target", "up", "direction", "view", "projection", "fov",
                      "ortho-height", "oblique-angle", "zoom", "near", "far"});
    CameraOptions options;
    value.if_has("eye", [&](const JsonValue& v) { options.eye = v.vector(); });
    value.if_has("target", [&](const JsonValue& v) { options.target = v.vector(); });
    value.if_has("up", [&](const JsonValue& v) { options.up = v.direction(); });
    value.if_has("direction", [&](const JsonValue& v) { options.direction = v.direction(); });
    value.if_has("view", [&](const JsonValue& v) {
        options.view = parse_view(v.text());
        if (!options.view) v.fail("unknown view; try \"front\", \"top\" or \"isometric\"");
    });
    value.if_has("projection", [&](const JsonValue& v) {
        options.projection = parse_projection(v.text());
        if (!options.projection)
            v.fail("expected \"perspective\", \"orthographic\", \"cavalier\" or \"cabinet\"");
    });
    value.if_has("fov", [&](const JsonValue& v) {
        options.fov = v.positive();
        if (!(*options.fov < 180)) v.fail("expected degrees between 0 and 180");
    });
    value.if_has("ortho-height", [&](const JsonValue& v) { options.ortho_height = v.positive(); });
    value.if_has("oblique-angle", [&](const JsonValue& v) { options.oblique_angle = v.number(); });
    value.if_has("zoom", [&](const JsonValue& v) { options.zoom = v.positive(); });
    value.if_has("near", [&](const JsonValue& v) { options.near_plane = v.number(); });
    value.if_has("far", [&](const JsonValue& v) { options.far_plane = v.number(); });
    if (options.near_plane && options.far_plane && !(*options.near_plane < *options.far_plane)) {
        value.at("near").fail("expected a number below \"far\"");
    }
    return options;
}

SceneDescription description(const JsonValue& root) {
    root.allow_keys({"models", "surfaces", "lights", "camera"});
    SceneDescription scene;
    root.if_has("surfaces", [&](const JsonValue& v) {
        for (const JsonValue& item : v.items()) scene.surfaces.push_back(surface(item));
    });
    if (scene.surfaces.empty() || root.has("models")) {
        for (const JsonValue& item : root.at("models").items()) {
            scene.models.push_back(model(item));
        }
    }
    if (scene.models.empty() && scene.surfaces.empty()) {
        root.at("models").fail("expected at least one model");
    }
    root.if_has("lights", [&](const JsonValue& v) {
        for (const JsonValue& item : v.items()) scene.lights.push_back(light(item));
    });
    root.if_has("camera", [&](const JsonValue& v) { scene.camera = camera(v); });
    return scene;
}

}  // namespace

Result<SceneDescription> parse_scene_description(std::string_view text, const std::string& name) {
    const Result<nlohmann::json> document = parse_json(text, name);
    if (!document) return document.error();
    try {
        return description(JsonValue(*document));
    } catch (const JsonFault& fault) {
        return json_error(name, fault);
    }
}

Result<std::vector<CameraOptions>> parse_camera_path(std::string_view text,
                                                     const std::string& name) {
    const Result<nlohmann::json> document = parse_json(text, name);
    if (!document) return document.error();
    try {
        std::vector<CameraOptions> cameras;
        const JsonValue root(*document);
        for (const JsonValue& item : root.items()) cameras.push_back(camera(item));
        if (cameras.empty()) root.fail("expected at least one camera");
        return cameras;
    } catch (const JsonFault& fault) {
        return json_error(name, fault);
    }
}

}  // namespace sightline::load
