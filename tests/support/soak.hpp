// Random scenes in random views, by every algorithm on every vector target, against brute force.
//
// What is compared, and what counts as a sample: the z-buffer's answer on each target, and in turn
// the other algorithms on one target each. Every sample of such a picture is one, id and depth
// together. `brute` is asked once a view.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "support/random_views.hpp"

namespace sightline::testing {

class Soak {
public:
    struct Row {
        std::uint64_t views = 0, samples = 0, differing = 0;
    };
    /// Of the views themselves, each counted once.
    struct Views {
        std::uint64_t views = 0, samples = 0, covered = 0;
        std::uint64_t of_models = 0;         ///< views of real models
        std::uint64_t clipped_and_tiny = 0;  ///< with triangles of both kinds in one view
    };

    /// Differences are told in `log`, a line each, with the seed.
    explicit Soak(std::ostream& log);
    ~Soak();

    /// Makes and compares the view with this seed, alone the same as after any others.
    void compare_view(std::uint64_t seed);
    /// A view of another scene. `lists`: by the list-priority algorithms, too, which take seconds
    /// where many surfaces cross.
    void compare_view(const Scene& scene, std::uint64_t seed, bool lists);
    /// Views from a seed on, until so many samples are compared.
    void compare_samples(std::uint64_t first_seed, std::uint64_t samples);

    /// By algorithm and target.
    [[nodiscard]] const std::map<std::pair<std::string, std::string>, Row>& rows() const {
        return rows_;
    }
    [[nodiscard]] const Views& views() const { return views_; }
    [[nodiscard]] Row sum() const;
    /// bsp's differences that only snapping's edges explain, see bsp_differences.hpp.
    [[nodiscard]] std::uint64_t grazed() const { return grazed_; }

private:
    struct Model;
    struct Job;

    [[nodiscard]] Model* model_of(std::uint64_t seed);
    void load_models();
    void compare(const Scene& scene, Model* model, std::uint64_t seed, bool lists);
    void count_view(const Job& job);
    void compare_on(const Job& job, const std::string& algorithm, std::int64_t target);
    [[nodiscard]] std::uint64_t differences(const Job& job, const ScreenScene& screen,
                                            const std::string& algorithm, std::string& first);
    void add(const Job& job, const std::string& algorithm, std::int64_t target,
             std::uint64_t differing, const std::string& first);

    std::ostream& log_;
    std::vector<std::int64_t> targets_;
    std::vector<std::unique_ptr<Model>> models_;
    bool models_loaded_ = false;
    std::map<std::pair<std::string, std::string>, Row> rows_;
    Views views_;
    std::uint64_t grazed_ = 0;
};

}  // namespace sightline::testing
