// `render` of algorithms that make pictures row by row: the same files, in little memory.
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

using Clock = std::chrono::steady_clock;

class RenderStream : public ProgramTest {
protected:
    static constexpr std::array kRowWise = {"scanline-zbuffer", "scanline", "spans"};

    /// All outputs of one run, by names of this beginning.
    void render(const std::string& prefix, const std::string& ending, const std::string& algorithm,
                std::vector<std::string> options) const {
        std::vector<std::string> words = {"render", "cube.obj", "--algorithm", algorithm};
        for (const char* option : {"--output", "--depth", "--ids", "--normals", "--mask"}) {
            const bool is_mask = option == std::string("--mask");
            words.insert(words.end(), {option, prefix + option + "." +
                                                   (is_mask && ending == "exr" ? "npy" : ending)});
        }
        if (ending == "exr") options.insert(options.end(), {"--aov", "normals,ids"});
        words.insert(words.end(), options.begin(), options.end());
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
    }

    [[nodiscard]] double peak_memory_mib(const std::string& size) const {
        const Outcome outcome =
            run({"render", "cube.obj", "-o", "a.png", "--mask", "m.npy", "--resolution", size,
                 "--algorithm", "scanline-zbuffer", "--json"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        const auto json = nlohmann::json::parse(outcome.out, nullptr, false);
        return json.is_object() ? json.value("peak_rss_mb", 0.0) : 0.0;
    }
};

TEST_F(RenderStream, FilesEqualThoseOfTheWholePicture) {
    for (const char* ending : {"png", "exr", "npy"}) {
        for (const std::vector<std::string>& options :
             {std::vector<std::string>{"--resolution", "1500x100"},
              {"--resolution", "61x67", "--samples", "4", "--shading", "phong"},
              {"--resolution", "701x1", "--background", "none"}}) {
            render("whole", ending, "zbuffer", options);
            for (const char* algorithm : kRowWise) {
                render("rows", ending, algorithm, options);
                for (const std::string& name : files()) {
                    if (!name.starts_with("whole")) continue;
                    EXPECT_TRUE(read(name) == read("rows" + name.substr(5)))
                        << algorithm << " " << name << " " << options[1];
                }
            }
        }
    }
}

TEST_F(RenderStream, StandardOutput) {
    const std::vector<std::string> size = {"--resolution", "900x80", "--algorithm", "spans"};
    const auto with = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {"render", "cube.obj"});
        words.insert(words.end(), size.begin(), size.end());
        return run(words);
    };
    EXPECT_EQ(with({"-o", "a.png"}).status, 0);
    const Outcome piped = with({"-o", "-", "--output-format", "png", "--ids", "i.npy"});
    EXPECT_EQ(piped.status, 0) << piped.err;
    EXPECT_EQ(piped.out, read("a.png"));
    EXPECT_TRUE(exists("i.npy"));
}

TEST_F(RenderStream, MemoryDoesNotGrowWithTheHeight) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the sanitizer keeps freed memory";
#else
    const double low = peak_memory_mib("4000x1500"), high = peak_memory_mib("4000x16000");
    EXPECT_GT(low, 1);
    EXPECT_LT(high, low + 64);  // all samples together take 488 MiB
    EXPECT_LT(high, 300);
#endif
}

TEST_F(RenderStream, LimitsAreThoseOfTheAlgorithm) {
    const auto words = [](const char* algorithm, const char* size, const char* samples) {
        return std::vector<std::string>{"render",  "cube.obj",     "-o", "a.png",     "--algorithm",
                                        algorithm, "--resolution", size, "--samples", samples};
    };
    expect_failure(2, words("zbuffer", "65536x4097", "1"),
                   {"--resolution", "65536x4097", "2^28", "--algorithm scanline-zbuffer"});
    expect_failure(2, words("warnock", "32768x4096", "4"),
                   {"--samples", "32768x4096", "2^28", "--algorithm scanline-zbuffer"});
    expect_failure(2, words("spans", "65537x8", "1"), {"--resolution", "65536"});
    expect_failure(2, words("spans", "0x8", "1"), {"--resolution", "0x8"});
    const Outcome widest = run(words("spans", "65536x3", "4"));
    EXPECT_EQ(widest.status, 0) << widest.err;
    EXPECT_EQ(png_size(read("a.png")), (std::array{65536u, 3u}));
}

TEST_F(RenderStream, NothingAppearsAfterAFailure) {
    write("d.npy", "stood here");
    expect_failure(
        1,
        {"render", "cube.obj", "--algorithm", "scanline", "--resolution", "2000x3000", "--ids",
         "i.npy", "--depth", "d.npy", "-o", "/dev/full", "--output-format", "npy"},
        {"/dev/full"});
    EXPECT_EQ(read("d.npy"), "stood here");
}

TEST_F(RenderStream, StopsBetweenTheRows) {
    const auto before = files();
    const std::vector<std::string> words = {
        "render",      "cube.obj", "--algorithm", "scanline-zbuffer", "-o", "a.exr", "--resolution",
        "30000x30000", "--depth",  "d.npy",       "--quiet"};
    Running program = start(words);
    const auto deadline = Clock::now() + std::chrono::seconds(60);
    while (files() == before && Clock::now() < deadline) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    EXPECT_NE(files(), before);
    program.send(SIGINT);
    EXPECT_EQ(program.wait().status, 130);
    EXPECT_EQ(files(), before);

    auto limited = words;
    limited.insert(limited.end(), {"--time-limit", "0.5"});
    expect_failure(1, limited, {"--time-limit", "0.5 seconds"});
}

}  // namespace
}  // namespace sightline::testing
