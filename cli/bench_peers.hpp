// `sightline bench --peers DIR`: our frame and the peers' programs in turn, in one run.
#pragma once

#include <string>

#include "bench_scene.hpp"

namespace sightline::cli {

struct PeersOptions {
    std::string folder;   ///< of the programs
    unsigned rounds = 5;  ///< in each, our frames and then every program once
    double limit = 300;   ///< seconds that one program may take
};

/// Reads --peers, --rounds and --peer-limit and judges what the programs can't do as we do: other
/// cameras, culling, several models. Nothing where --peers is absent.
[[nodiscard]] std::optional<PeersOptions> read_peers(OptionReader& reader,
                                                     const BenchOptions& bench);

/// Measures and prints. Errors (io): no folder, no program in it, a program that fails, takes too
/// long, prints nothing of use, or reads another number of triangles.
[[nodiscard]] Result<int> run_peers(const PeersOptions& options, const BenchOptions& bench);

}  // namespace sightline::cli
