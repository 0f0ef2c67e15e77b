// `visible --from-directions`: what a file of directions may hold.
#include <sys/stat.h>

#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

class Directions : public ProgramTest {
protected:
    [[nodiscard]] Outcome along(const std::string& text) const {
        write("sun.txt", text);
        return run({"visible", "cube.obj", "--from-directions", "sun.txt"});
    }
};

TEST_F(Directions, FromAnyEditor) {
    const Outcome plain = along("0,0,-1\n1 0 -1\n");
    ASSERT_EQ(plain.status, 0) << plain.err;
    EXPECT_EQ(along("\xef\xbb\xbf# sun\r\n0,0,-1\r\n\r\n1,\t0 -1 # noon").out, plain.out);
}

TEST_F(Directions, OfAnyLength) {
    const auto seen = [&](const std::string& direction) {
        const Outcome outcome = along(direction + "\n");
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        const std::size_t row = outcome.out.find("0," + direction);
        EXPECT_NE(row, std::string::npos) << outcome.out;
        return outcome.out.substr(std::min(row + 2 + direction.size(), outcome.out.size()));
    };
    EXPECT_EQ(seen("1e-300,0,-1e-300"), seen("1,0,-1"));
    EXPECT_EQ(seen("1e+308,0,-1e+308"), seen("1,0,-1"));
}

TEST_F(Directions, FaultsNameTheirLine) {
    for (const std::string wrong : {"0,0,0", "1,2", "1,2,3,4", "1,2,x", "inf,0,0"}) {
        const Outcome outcome = along("0,0,-1\n" + wrong + "\n");
        EXPECT_EQ(outcome.status, 1);
        EXPECT_NE(outcome.err.find("sun.txt:2: "), std::string::npos) << outcome.err;
    }
    EXPECT_NE(along("# none\n").err.find("no direction"), std::string::npos);
}

TEST_F(Directions, WhatIsNoFileIsRefused) {
    const auto refused = [&](const std::string& path, const std::string& why) {
        expect_failure(1, {"visible", "cube.obj", "--from-directions", path}, {path, why});
    };
    refused("missing.txt", "cannot read");
    refused(".", "folder");
    refused("/dev/zero", "device");
    ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
    refused("pipe", "nobody writes");
}

}  // namespace
}  // namespace sightline::testing
