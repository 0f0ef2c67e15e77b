// Draws how an algorithm comes to its answer: the areas that it decided at once in outline, over
// the number of times that each sample was looked at (pale: once; dark: often).
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <sightline/sightline.hpp>
#include <string>
#include <vector>

namespace {

using sightline::Step;
using sightline::StepKind;

/// Keeps what the picture needs of an algorithm's steps.
class Watcher final : public sightline::Observer {
public:
    explicit Watcher(sightline::Resolution size)
        : size_(size),
          looks_(std::size_t{size.width} * size.height),
          border_(looks_.size()),
          decided_(looks_.size()) {}

    void step(const Step& s) override {
        switch (s.kind) {
            case StepKind::sample_decided:
            case StepKind::depths_compared:
                ++looks_[at(std::min(s.x0, size_.width - 1), s.y0)];
                break;
            case StepKind::span_decided:
                paint(s);
                border_[at(s.x0, s.y0)] = 1;
                break;
            case StepKind::tile_entered:
            case StepKind::quadrant_decided:
            case StepKind::quadrant_scanned:
                outline(s);
                break;
            default:
                break;
        }
    }

    [[nodiscard]] sightline::ColorImage picture(const sightline::Visibility& seen) const {
        sightline::ColorImage image(size_.width, size_.height, glm::vec4(1));
        for (std::size_t i = 0; i < looks_.size(); ++i) {
            const float dark = static_cast<float>(std::min(looks_[i], 6u)) / 6.0f;
            const glm::vec3 surface = glm::vec3(0.80f, 0.86f, 0.93f);
            const glm::vec3 often = glm::vec3(0.02f, 0.10f, 0.35f);
            glm::vec3 color = seen.ids[i] == sightline::kNone ? glm::vec3(1) : surface;
            color = color + dark * (often - color);
            if (border_[i] != 0) color = glm::vec3(0.75f, 0.18f, 0.02f);
            image.pixels[i] = glm::vec4(color, 1);
        }
        return image;
    }

private:
    [[nodiscard]] std::size_t at(std::uint32_t x, std::uint32_t y) const {
        return std::size_t{y} * size_.width + x;
    }
    // Only list-priority algorithms decide a sample more than once.
    void paint(const Step& s) {
        for (std::uint32_t x = s.x0; x < s.x1; ++x) {
            std::uint8_t& decided = decided_[at(x, s.y0)];
            looks_[at(x, s.y0)] += decided;
            decided = 1;
        }
    }
    // The upper and the left side: the others are those of the neighbours.
    void outline(const Step& s) {
        for (std::uint32_t x = s.x0; x < s.x1; ++x) border_[at(x, s.y0)] = 1;
        for (std::uint32_t y = s.y0; y < s.y1; ++y) border_[at(s.x0, y)] = 1;
    }

    sightline::Resolution size_;
    std::vector<std::uint32_t> looks_;
    std::vector<std::uint8_t> border_, decided_;
};

int fail(const sightline::Error& error) {
    std::fprintf(stderr, "watch_algorithm: %s\n", error.message.c_str());
    return sightline::exit_status(error.kind);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 4) {
        std::fprintf(stderr, "usage: watch_algorithm MODEL ALGORITHM PICTURE.png\n");
        return 2;
    }
    const sightline::Algorithm* algorithm = sightline::find_algorithm(argv[2]);
    if (algorithm == nullptr) {
        std::fprintf(stderr, "watch_algorithm: no algorithm '%s'; see `sightline algorithms`\n",
                     argv[2]);
        return 2;
    }
    const std::vector<std::string> paths = {argv[1]};
    const auto scene = sightline::load_scene(paths);
    if (!scene) return fail(scene.error());
    const auto camera = sightline::make_camera({}, *scene, {480, 360});
    if (!camera) return fail(camera.error());
    const auto screen = sightline::project(*scene, *camera);
    if (!screen) return fail(screen.error());

    Watcher watcher(camera->resolution);
    sightline::ResolveOptions options;
    options.observer = &watcher;
    sightline::Visibility seen;
    if (auto status = sightline::resolve(*algorithm, *screen, options, seen); !status)
        return fail(status.error());
    if (auto status = sightline::write_color_png(argv[3], watcher.picture(seen)); !status)
        return fail(status.error());
    return 0;
}
