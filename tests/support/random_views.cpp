#include "support/random_views.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace sightline::testing {
namespace {

constexpr std::size_t kMostTriangles = 300;

// Evenly distributed in the logarithm.
double of_any_size(Random& random, double lo, double hi) {
    return lo * std::pow(hi / lo, random.uniform(0, 1));
}

// -- scenes -------------------------------------------------------------------------------------

void add_soup(SceneBuilder& b, Random& random) {
    const std::uint32_t n = 1 + random.below(kMostTriangles);
    const double most = of_any_size(random, 0.1, 10);
    for (std::uint32_t k = 0; k < n; ++k) {
        const double size = of_any_size(random, 1e-3, 1) * most;
        const glm::dvec3 p = random.point();
        const glm::dvec3 q = p + size * random.point(), r = p + size * random.point();
        b.triangle(p, q, r);
    }
}

// A field of heights: neighbours share edges.
void add_mesh(SceneBuilder& b, Random& random) {
    const std::uint32_t n = 2 + random.below(10);
    const double size = of_any_size(random, 1e-2, 5), height = size * random.uniform(0, 0.5);
    const glm::dvec3 origin = random.point(), u = size / n * random.point();
    const glm::dvec3 v = size / n * random.point(), up = height * random.point();
    std::vector<glm::dvec3> points;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i)
            points.push_back(origin + (static_cast<double>(i) * u + static_cast<double>(j) * v) +
                             random.uniform(-1, 1) * up);
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const glm::dvec3* p = points.data() + j * (n + 1) + i;
            b.triangle(p[0], p[1], p[n + 2]).triangle(p[0], p[n + 2], p[n + 1]);
        }
}

// Walls that show the inside, or the outside, or anything, around all of it.
void add_room(SceneBuilder& b, Random& random) {
    const glm::dvec3 half = glm::abs(random.point()) + 0.3;
    const bool inside = random.chance(0.7);
    b.box(inside ? half : -half, inside ? -half : half);
}

void add_specks_among_walls(SceneBuilder& b, Random& random) {
    const std::uint32_t n = 1 + random.below(100);
    for (std::uint32_t k = 0; k < n; ++k) {
        const double size = random.chance(0.7) ? of_any_size(random, 1e-4, 0.05) : 2.0;
        const glm::dvec3 p = random.point();
        const glm::dvec3 q = p + size * random.point(), r = p + size * random.point();
        b.triangle(p, q, r);
    }
}

// Another size, or another place, where the numbers have fewer bits left for it.
void move_scene(Scene& scene, Random& random) {
    const double size = of_any_size(random, 1e-3, 1e3);
    const glm::dvec3 away = random.chance(0.5) ? 100 * size * random.point() : glm::dvec3(0);
    for (glm::dvec3& p : scene.positions) p = size * p + away;
}

// -- cameras ------------------------------------------------------------------------------------

class Views {
public:
    Views(const Scene& scene, std::uint64_t seed)
        : scene_(scene), random_(seed ^ 0x51E77u), size_(glm::length(scene.bounds.extent())) {}

    View view(std::uint32_t most_samples) {
        View view;
        view.options.threads = random_.chance(0.9) ? 1 : 0;
        view.options.cull = static_cast<Cull>(random_.below(4));
        const Resolution resolution = choose_picture(most_samples, view.samples_per_axis);
        view.options.page = view.samples_per_axis <= 4 && random_.chance(0.05);
        for (int attempt = 0; attempt < 8; ++attempt) {
            const Result<Camera> camera = make_camera(choose_camera(), scene_.bounds, resolution);
            if (!camera.ok()) continue;
            view.camera = camera.value();
            // Pictures of little would be too many.
            if (coverage(view.camera) > random_.uniform(-0.1, 0.3)) return view;
        }
        if (view.camera.resolution != resolution)
            view.camera = must(make_camera({}, scene_.bounds, resolution));
        return view;
    }

private:
    // Widths beyond one, two and three of the z-buffer's tiles, and heights.
    Resolution choose_picture(std::uint32_t most_samples, std::uint32_t& per_axis) {
        if (random_.chance(0.5)) per_axis = 1u << random_.below(4);
        if (random_.chance(0.05)) return {1, 1};
        const auto side = [&](double most) {
            const double samples = of_any_size(random_, 1, std::max(1.0, most));
            return std::max(1u, static_cast<std::uint32_t>(samples) / per_axis);
        };
        const std::uint32_t width = side(200);
        const double left = static_cast<double>(most_samples) / (width * per_axis);
        const std::uint32_t height = side(std::min(200.0, left));
        return random_.chance(0.5) ? Resolution{width, height} : Resolution{height, width};
    }

    glm::dvec3 within_box() {
        const glm::dvec3 t = 0.5 + 0.55 * random_.point();
        return scene_.bounds.lo + t * scene_.bounds.extent();
    }

    // Looking at a surface, the camera mostly sees one.
    glm::dvec3 on_surface() {
        const Corners c = scene_.triangles[random_.below(scene_.triangle_count())];
        double s = random_.uniform(0, 1), t = random_.uniform(0, 1);
        if (s + t > 1) s = 1 - s, t = 1 - t;
        const glm::dvec3& p = scene_.positions[c.x];
        return p + s * (scene_.positions[c.y] - p) + t * (scene_.positions[c.z] - p);
    }

    // The part of a picture that is covered, judged by a few of its points.
    double coverage(const Camera& camera) {
        constexpr int kProbes = 8;
        int hits = 0;
        for (int k = 0; k < kProbes; ++k) {
            const glm::dvec2 pixel(random_.uniform(0, camera.resolution.width),
                                   random_.uniform(0, camera.resolution.height));
            const glm::dvec3 near = camera.unproject(pixel, camera.near_plane);
            const glm::dvec3 far = camera.unproject(pixel, camera.far_plane);
            hits += std::ranges::any_of(scene_.triangles,
                                        [&](const Corners& c) { return crosses(near, far, c); });
        }
        return static_cast<double>(hits) / kProbes;
    }

    // Whether a stretch goes through a triangle, as far as doubles can tell.
    bool crosses(const glm::dvec3& from, const glm::dvec3& to, const Corners& corners) const {
        glm::dvec3 p[3];
        for (int k = 0; k < 3; ++k) p[k] = scene_.positions[corners[k]] - from;
        const glm::dvec3 way = to - from, normal = glm::cross(p[1] - p[0], p[2] - p[0]);
        const double ahead = glm::dot(normal, p[0]), across = glm::dot(normal, way);
        if (!(ahead * across >= 0 && std::abs(ahead) <= std::abs(across))) return false;
        const double side = glm::dot(way, glm::cross(p[0], p[1]));
        return side * glm::dot(way, glm::cross(p[1], p[2])) > 0 &&
               side * glm::dot(way, glm::cross(p[2], p[0])) > 0;
    }

    CameraOptions choose_camera() {
        CameraOptions o;
        constexpr Projection kinds[] = {Projection::perspective, Projection::orthographic,
                                        Projection::cavalier, Projection::cabinet};
        o.projection = kinds[random_.chance(0.6) ? 0 : 1 + random_.below(3)];
        if (random_.chance(0.5)) o.up = random_.point();
        if (random_.chance(0.5)) o.oblique_angle = random_.uniform(0, 360);
        if (random_.chance(0.4)) o.zoom = of_any_size(random_, 0.5, 50);
        if (*o.projection == Projection::perspective)
            choose_perspective(o);
        else
            choose_parallel(o);
        if (random_.chance(0.4)) choose_planes(o);
        return o;
    }

    void choose_perspective(CameraOptions& o) {
        if (random_.chance(0.8))
            o.fov = random_.chance(0.5) ? of_any_size(random_, 0.01, 179) : random_.uniform(1, 179);
        const double place = random_.uniform(0, 1);
        if (place < 0.25) {
            choose_direction(o);
            return;
        }
        o.target = on_surface();
        if (place < 0.7) {
            o.eye = within_box();
        } else if (place < 0.85) {  // nearly on a surface
            o.eye = on_surface() + of_any_size(random_, 1e-9, 0.1) * size_ * random_.point();
        } else {  // from afar, with no more than that in view
            const double distance = size_ * of_any_size(random_, 1, 1e4);
            o.eye = *o.target + distance * glm::normalize(random_.point());
            o.fov = std::clamp(40 * size_ / distance, 0.01, 120.0);
        }
    }

    void choose_parallel(CameraOptions& o) {
        if (random_.chance(0.5)) {
            choose_direction(o);
        } else {
            o.eye = within_box();
            o.target = on_surface();
        }
        if (random_.chance(0.5)) o.ortho_height = size_ * of_any_size(random_, 1e-4, 1);
    }

    void choose_direction(CameraOptions& o) {
        if (random_.chance(0.3)) {
            o.view = static_cast<NamedView>(random_.below(9));
            o.up.reset();
        } else {
            o.direction = random_.point();
        }
    }

    // Measured from the eye: in a parallel view of a scene in front of it they often cut it, too.
    void choose_planes(CameraOptions& o) {
        const double distance =
            o.eye && o.target ? glm::length(*o.target - *o.eye) : size_ * random_.uniform(0.5, 3);
        if (random_.chance(0.7)) o.near_plane = distance * of_any_size(random_, 1e-6, 2);
        if (random_.chance(0.5))
            o.far_plane = o.near_plane.value_or(distance) * (1 + of_any_size(random_, 1e-4, 1e6));
    }

    const Scene& scene_;
    Random random_;
    double size_;
};

}  // namespace

Scene random_scene(std::uint64_t seed) {
    Random random(seed ^ 0x5CE7Eu);
    Scene scene;
    if (random.chance(0.3)) {
        scene = hostile_scene(seed);
    } else {
        SceneBuilder b;
        if (random.chance(0.7)) add_room(b, random);
        switch (random.below(3)) {
            case 0:
                add_soup(b, random);
                break;
            case 1:
                add_mesh(b, random);
                break;
            default:
                add_specks_among_walls(b, random);
        }
        scene = b.build();
    }
    if (!random.chance(0.2)) return scene;
    move_scene(scene, random);
    finish_scene(scene);
    return scene;
}

View random_view(const Scene& scene, std::uint64_t seed, std::uint32_t most_samples) {
    return Views(scene, seed).view(most_samples);
}

}  // namespace sightline::testing
