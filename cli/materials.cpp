// --opacity and --holdout: a material's name changes the material, an object's name gives the
// object a material of its own, so that others that share it stay as they are.
#include "materials.hpp"

#include <algorithm>

#include "errors.hpp"
#include "suggest.hpp"

namespace sightline::cli {
namespace {

Error unknown_name(const Scene& scene, std::string_view option, const std::string& name) {
    std::vector<std::string_view> names;
    for (const Material& material : scene.materials) names.push_back(material.name);
    for (const Object& object : scene.objects) names.push_back(object.name);
    return wrong_use("{}: nothing is called '{}'; {}", option, name,
                     did_you_mean(name, names, "'sightline info' lists materials and objects"));
}

/// Changes the materials of a name, and gives the objects of that name changed ones of their own.
template <class Change>
bool apply_to_name(Scene& scene, const std::string& name, const Change& change) {
    bool found = false;
    for (Material& material : scene.materials) {
        if (material.name != name) continue;
        change(material);
        found = true;
    }
    for (Object& object : scene.objects) {
        if (object.name != name) continue;
        Material own = scene.materials[object.material];
        change(own);
        object.material = static_cast<std::uint32_t>(scene.materials.size());
        scene.materials.push_back(std::move(own));
        found = true;
    }
    return found;
}

}  // namespace

std::vector<OpacityRule> read_opacity(OptionReader& reader) {
    std::vector<OpacityRule> rules;
    for (const std::string& text : reader.arguments().values("--opacity")) {
        // A name may hold '='; the number can't.
        const std::size_t sign = text.rfind('=');
        const bool named = sign != std::string::npos;
        const auto opacity = parse_number(named ? std::string_view(text).substr(sign + 1) : text);
        if (!opacity || *opacity < 0 || *opacity > 1 || sign == 0) {
            reader.fail(wrong_use("--opacity: '{}' is not a number from 0 to 1, or NAME=F", text));
            continue;
        }
        rules.push_back({named ? text.substr(0, sign) : "", static_cast<float>(*opacity)});
    }
    return rules;
}

Status apply_opacity(Scene& scene, const std::vector<OpacityRule>& rules) {
    for (const OpacityRule& rule : rules) {
        const auto change = [&rule](Material& material) { material.opacity = rule.opacity; };
        if (rule.name.empty()) {
            std::ranges::for_each(scene.materials, change);
        } else if (!apply_to_name(scene, rule.name, change)) {
            return unknown_name(scene, "--opacity", rule.name);
        }
    }
    return success();
}

Status apply_holdouts(Scene& scene, const std::vector<std::string>& names) {
    const auto change = [](Material& material) { material.holdout = true; };
    for (const std::string& name : names)
        if (!apply_to_name(scene, name, change)) return unknown_name(scene, "--holdout", name);
    return success();
}

}  // namespace sightline::cli
