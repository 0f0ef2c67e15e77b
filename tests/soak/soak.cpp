// The soak test as a program, see support/soak.hpp and scripts/soak.sh.
//
//   sightline_soak FIRST SAMPLES   views from seed FIRST on, until SAMPLES samples are compared
//   sightline_soak SEED            one view
//
// Differences go to standard output, a line each; then come the counts, in columns separated by
// tabs. Exit status 1 when anything differs.
#include "support/soak.hpp"

#include <cstdlib>
#include <iostream>

int main(int argc, char** argv) {
    using sightline::testing::Soak;
    if (argc != 2 && argc != 3) {
        std::cerr << "usage: sightline_soak FIRST SAMPLES, or sightline_soak SEED\n";
        return 2;
    }
    const std::uint64_t seed = std::strtoull(argv[1], nullptr, 10);
    Soak soak(std::cout);
    if (argc == 2)
        soak.compare_view(seed);
    else
        soak.compare_samples(seed, std::strtoull(argv[2], nullptr, 10));
    for (const auto& [key, row] : soak.rows())
        std::cout << "row\t" << key.first << '\t' << key.second << '\t' << row.views << '\t'
                  << row.samples << '\t' << row.differing << '\n';
    const Soak::Views& v = soak.views();
    std::cout << "views\t" << v.views << '\t' << v.samples << '\t' << v.covered << '\t'
              << v.of_models << '\t' << v.clipped_and_tiny << '\t' << soak.grazed() << '\n';
    return soak.sum().differing == 0 ? 0 : 1;
}
