// How parts come to share what they share in the whole. The groups of coplanar faces of a scene are
// found within each part, then joined from part to part (scene/sheet_joiner.hpp). Here a first look
// at each part collects the planes of its faces in short; parts that may share one are looked at
// again, and what of them does is kept. Its faces make a small scene, which is projected by itself:
// the planes of its sheets are those of the whole.
#include "shading/stream_plan.hpp"

#include <algorithm>

#include "scene/bounds.hpp"

namespace sightline {

StreamPlan::StreamPlan() : state_(std::make_unique<State>()) {}
StreamPlan::~StreamPlan() = default;

const Scene& StreamPlan::frame() const { return state_->frame; }
bool StreamPlan::has_file_normals() const { return state_->has_file_normals; }
bool StreamPlan::is_shared(std::uint32_t k) const { return state_->shared[k]; }

// -- the survey --------------------------------------------------------------------------------

void StreamPlan::survey(const Scene& part) {
    State& state = *state_;
    Scene& frame = state.frame;
    frame.bounds = joined(frame.bounds, part.bounds);
    frame.reach = joined(frame.reach, part.reach);
    frame.lights.insert(frame.lights.end(), part.lights.begin(), part.lights.end());
    frame.offset = part.offset;
    frame.rounding = std::max(frame.rounding, part.rounding);
    if (!frame.camera) frame.camera = part.camera;
    state.has_file_normals =
        state.has_file_normals || std::ranges::any_of(part.objects, &Object::has_file_normals);
    state.triangles += part.triangle_count();
    state.meshes += static_cast<std::uint32_t>(part.objects.size() - part.quadrics.size());
    const SheetScale own(part.bounds, part.rounding);
    for (std::uint32_t t = 0; t < part.triangle_count(); ++t) {
        const FacePlane plane = plane_of_face(part, own, t);
        if (plane.is_usable())
            state.planes.add(plane.normal, part.positions[part.triangles[t].x], state.parts);
    }
    state.planes.tidy();
    ++state.parts;
}

void StreamPlan::finish_survey() {
    State& state = *state_;
    state.scale = SheetScale(state.frame.bounds, state.frame.rounding);
    state.members.resize(state.parts);
    state.shared.assign(state.parts, false);
    state.joiner.emplace(state.scale);
    if (state.parts < 2 || !(state.scale.radius > 0)) return;
    state.planes.finish();
    state.shared = state.planes.shared_numbers(state.scale, state.parts);
}

// -- the comparison ----------------------------------------------------------------------------

namespace {

/// The sheets of a part by itself, by the scale of the whole, without frames; returns their seeds.
std::vector<std::uint32_t> find_own_sheets(const SheetScale& scale, Scene& part) {
    std::vector<std::uint32_t> seeds;
    part.sheets = {};
    if (scale.radius > 0) find_part_sheets(part, scale, {0, part.triangle_count()}, seeds);
    return seeds;
}

}  // namespace

void StreamPlan::compare(std::uint32_t k, Scene& part) {
    State& state = *state_;
    const std::vector<std::uint32_t> seeds = find_own_sheets(state.scale, part);
    state.joiner->add_part(part, {0, part.triangle_count()}, k, seeds, 0,
                           [&](const FacePlane& plane, const glm::dvec3& point) {
                               return state.planes.has_other(state.scale, plane.normal, point, k);
                           });
}

void StreamPlan::finish_comparison() {
    State& state = *state_;
    state.planes = {};
    const SheetJoiner& joiner = *state.joiner;
    Scene& faces = state.faces;
    std::uint32_t group_number = 0;
    for (const std::vector<std::uint32_t>& group : joiner.join()) {
        for (const std::uint32_t n : group) {
            const SheetNode& node = joiner.nodes()[n];
            for (const std::uint32_t t : joiner.members(node)) {
                state.members[node.part].push_back({t, group_number});
                const auto first = static_cast<std::uint32_t>(3 * faces.triangles.size());
                faces.triangles.emplace_back(first, first + 1, first + 2);
                faces.sheets.of_triangle.push_back(group_number);
            }
            const auto corners = joiner.corners(node);
            faces.positions.insert(faces.positions.end(), corners.begin(), corners.end());
        }
        ++group_number;
    }
    state.joiner.reset();
    for (auto& members : state.members) std::ranges::sort(members, {}, &State::Member::triangle);
    if (group_number == 0) return;
    Object all;
    all.triangle_count = faces.triangle_count();
    faces.objects.push_back(all);
    faces.materials.emplace_back();
    frame_sheets(faces);
    for (const Corners& c : faces.sheets.frame)
        state.group_frames.push_back(
            {faces.positions[c.x], faces.positions[c.y], faces.positions[c.z]});
}

Status StreamPlan::set_view(const Camera& camera, const ProjectOptions& options) {
    State& state = *state_;
    if (state.faces.triangles.empty()) return success();
    ScreenScene screen;
    if (Status done = project(state.faces, camera, options, screen); !done) return done;
    for (std::uint32_t s = 0; s < state.faces.sheets.count(); ++s)
        state.group_planes.push_back(screen.sheet_plane(s));
    state.faces = {};
    return success();
}

// -- parts of the whole ------------------------------------------------------------------------

void StreamPlan::adopt(std::uint32_t k, Scene& part) const {
    const State& state = *state_;
    part.lights = state.frame.lights;
    part.bounds = state.frame.bounds;
    part.rounding = state.frame.rounding;
    const std::vector<std::uint32_t> seeds = find_own_sheets(state.scale, part);
    if (!state.members[k].empty() && part.sheets.of_triangle.empty())
        part.sheets.of_triangle.assign(part.triangles.size(), kNone);
    for (const auto& [triangle, group] : state.members[k])
        part.sheets.of_triangle[triangle] = static_cast<std::uint32_t>(seeds.size()) + group;
    frame_sheets(part);
    // Shared planes go through the corners that they have in the whole, for faces are lit by them.
    std::vector<std::uint32_t> placed(state.group_frames.size(), kNone);
    for (const auto& [triangle, group] : state.members[k]) {
        if (placed[group] != kNone) continue;
        placed[group] = static_cast<std::uint32_t>(part.positions.size());
        const auto& frame = state.group_frames[group];
        part.positions.insert(part.positions.end(), frame.begin(), frame.end());
        part.sheets.frame[part.sheets.of(triangle)] = placed[group] + Corners(0, 1, 2);
    }
}

void StreamPlan::adopt(std::uint32_t k, ScreenScene& screen) const {
    for (const auto& [triangle, group] : state_->members[k])
        screen.set_sheet_plane(screen.scene().sheets.of(triangle), state_->group_planes[group]);
}

}  // namespace sightline
