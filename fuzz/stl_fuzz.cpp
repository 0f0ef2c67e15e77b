// The reader of STL files, in this process.
#include "reader_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return sightline::fuzz::check_reader("stl", data, size);
}
