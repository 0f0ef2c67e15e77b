#include "scene/load/ply_vertex.hpp"

#include <string_view>
#include <utility>

namespace sightline::load {
namespace {

using Slot = PlyVertexPlan::Slot;

Slot slot_of(const PlyProperty& property) {
    using enum PlyVertexPlan::Slot;
    // clang-format off
    static constexpr std::pair<std::string_view, Slot> kNames[] = {
        {"x", kX}, {"y", kY}, {"z", kZ}, {"nx", kNx}, {"ny", kNy}, {"nz", kNz},
        {"red", kRed}, {"green", kGreen}, {"blue", kBlue}, {"alpha", kAlpha},
        {"r", kRed}, {"g", kGreen}, {"b", kBlue}, {"a", kAlpha},
        {"diffuse_red", kRed}, {"diffuse_green", kGreen}, {"diffuse_blue", kBlue},
        {"diffuse_alpha", kAlpha}};
    // clang-format on
    if (property.count_type) return kOther;
    for (const auto& [name, slot] : kNames) {
        if (name == property.name) return slot;
    }
    return kOther;
}

/// The value of a colour's full strength. Wide integers hold bytes in practice.
float full_strength(PlyType type) {
    switch (type) {
        case PlyType::int8:
            return 127.0f;
        case PlyType::int16:
            return 32767.0f;
        case PlyType::uint16:
            return 65535.0f;
        case PlyType::float32:
        case PlyType::float64:
            return 1.0f;
        default:
            return 255.0f;
    }
}

bool fits_float(PlyType type) {
    return type != PlyType::float64 && type != PlyType::int32 && type != PlyType::uint32;
}

}  // namespace

PlyVertexPlan::PlyVertexPlan(const PlyElement& element) : stride(0) {
    for (const PlyProperty& property : element.properties) {
        const Slot slot = slot_of(property);
        const bool is_color = slot >= kRed && slot <= kAlpha;
        entries.push_back({&property, slot, is_color ? full_strength(property.type) : 1.0f});
        has[slot] = true;
        precise = precise || (slot <= kZ && !fits_float(property.type));
        if (property.count_type) stride.reset();
        if (stride) *stride += size_of(property.type);
    }
}

}  // namespace sightline::load
