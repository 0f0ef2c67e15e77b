// Wrong use: exit status 2, one line that names the option, the value or the way out, and no file.
#include "cli/run_program.hpp"

namespace sightline::testing {
namespace {

class WrongUse : public ProgramTest {
protected:
    void expect_wrong(std::vector<std::string> words,
                      std::initializer_list<std::string> needles) const {
        expect_failure(2, std::move(words), needles);
    }
    /// The same for options of a `render` that is otherwise right.
    void expect_wrong_render(std::vector<std::string> options,
                             std::initializer_list<std::string> needles) const {
        std::vector<std::string> words = {"render", "cube.obj", "-o", "a.png"};
        words.insert(words.end(), options.begin(), options.end());
        expect_failure(2, std::move(words), needles);
    }
};

TEST_F(WrongUse, Commands) {
    expect_wrong({}, {"no command", "--help"});
    expect_wrong({"rendr", "cube.obj"}, {"'rendr'", "did you mean 'render'"});
    expect_wrong({"sketch", "cube.obj"}, {"unknown command 'sketch'"});
    expect_wrong({"frobnicate"}, {"unknown command 'frobnicate'", "--help"});
    expect_wrong({"--quiet", "render"}, {"the command comes first", "render"});
    expect_wrong({"algorithms", "cube.obj"}, {"takes no arguments", "cube.obj"});
}

TEST_F(WrongUse, OptionNames) {
    expect_wrong_render({"--resoluton", "8x8"}, {"'--resoluton'", "did you mean '--resolution'"});
    expect_wrong_render({"--xyzzy"}, {"'--xyzzy'", "--help"});
    expect_wrong_render({"-Z"}, {"'-Z'"});
    expect_wrong_render({"-output", "b.png"}, {"'-output'", "did you mean '--output'"});
    expect_wrong_render({"--quiet=3"}, {"--quiet takes no value"});
    expect_wrong_render({"--fov"}, {"--fov needs a value"});
    expect_wrong_render({"--near", "--far", "5"}, {"--near needs a value", "'--far'"});
    expect_wrong({"info", "cube.obj", "--samples", "4"}, {"'--samples'", "'info'"});
}

TEST_F(WrongUse, Numbers) {
    for (const char* fov : {"0", "180", "-5", "200", "wide", "", "nan", "inf", "40deg"}) {
        expect_wrong_render({std::string("--fov=") + fov}, {"--fov"});
    }
    expect_wrong_render({"--fov", "200"}, {"--fov", "'200'", "between 0 and 180"});
    expect_wrong_render({"--zoom", "0"}, {"--zoom", "'0'"});
    expect_wrong_render({"--ortho-height", "-1"}, {"--ortho-height", "'-1'"});
    expect_wrong_render({"--threads", "0"}, {"--threads", "'0'"});
    expect_wrong_render({"--threads", "-2"}, {"--threads", "'-2'"});
    expect_wrong_render({"--time-limit", "soon"}, {"--time-limit", "'soon'"});
    expect_wrong_render({"--samples", "5"}, {"--samples", "'5'", "16"});
    expect_wrong_render({"--samples", "36"}, {"--samples", "'36'"});
    expect_wrong_render({"--crease-angle", "181"}, {"--crease-angle", "'181'"});
    expect_wrong_render({"--weld", "-1e-6"}, {"--weld", "'-1e-6'", "from 0 to 0.01"});
    expect_wrong_render({"--weld", "0.5"}, {"--weld", "'0.5'", "as in --weld 1e-5"});
    expect_wrong_render({"--allow-path", "nowhere"}, {"--allow-path", "'nowhere' is not a folder"});
    expect_wrong({"info", "cube.obj", "--allow-path", ".", "--allow-path=cube.obj"},
                 {"--allow-path", "'cube.obj'"});
    expect_wrong({"draw", "cube.obj", "--weld=much", "-o", "a.svg"}, {"--weld", "'much'"});
    expect_wrong_render({"--opacity", "1.5"}, {"--opacity", "'1.5'"});
    expect_wrong_render({"--opacity", "=1"}, {"--opacity", "'=1'"});
}

TEST_F(WrongUse, Sizes) {
    for (const char* size :
         {"800", "800x", "x600", "0x600", "800x0", "-8x6", "8.5x6", "8x6x4", "800X600", "big"}) {
        expect_wrong_render({"--resolution", size}, {"--resolution", size});
    }
    expect_wrong_render({"--resolution", "65537x10"}, {"--resolution", "65536"});
    expect_wrong_render({"--resolution", "65536x65536"}, {"--resolution", "2^28"});
    expect_wrong_render({"--resolution", "16384x16384", "--samples", "4"}, {"--samples", "2^28"});
}

TEST_F(WrongUse, Points) {
    for (const char* point : {"1,2", "1,2,3,4", "a,b,c", "1,,3", "", "1 2 3"}) {
        expect_wrong_render({"--eye", point}, {"--eye", "x,y,z"});
    }
    expect_wrong_render({"--direction", "0,0,0"}, {"--direction"});
    expect_wrong_render({"--up", "0,0,0"}, {"--up"});
    expect_wrong_render({"--eye", "1,2,3", "--target", "1,2,3"}, {"--eye", "--target"});
    expect_wrong_render({"--direction", "0,1,0", "--up", "0,-2,0"}, {"up"});
    expect_wrong_render({"--near", "5", "--far", "5"}, {"--near", "--far"});
    expect_wrong_render({"--near", "-5"}, {"--near"});
    expect_wrong_render({"--view", "front", "--direction", "1,0,0"}, {"--view", "--direction"});
}

TEST_F(WrongUse, Choices) {
    expect_wrong_render({"--view", "isometrik"}, {"--view", "did you mean 'isometric'"});
    expect_wrong_render({"--projection", "Perspective"}, {"--projection", "'perspective'"});
    expect_wrong_render({"--shading", "phonk"}, {"--shading", "'phong'"});
    expect_wrong_render({"--cull", "yes"}, {"--cull", "auto, none, back, front"});
    expect_wrong_render({"--algorithm", "zbufer"}, {"--algorithm", "did you mean 'zbuffer'"});
    expect_wrong_render({"--algorithm", "brute,zbuffer"}, {"--algorithm"});
    expect_wrong({"compare", "cube.obj", "--algorithms", "brute,wornock"}, {"'wornock'"});
    expect_wrong_render({"--format", "obi"}, {"--format", "did you mean 'obj'"});
    for (const char* color :
         {"1,2", "256,0,0", "#12345", "#gggggg", "red", "1,2,3,4,5", "-1,0,0"}) {
        expect_wrong_render({"--background", color}, {"--background", color});
    }
    expect_wrong_render({"--opacity", "cub=0.5"}, {"--opacity", "'cub'", "did you mean 'cube'"});
}

TEST_F(WrongUse, Outputs) {
    expect_wrong({"render", "cube.obj"}, {"nothing to write", "-o"});
    expect_wrong({"render", "-o", "a.png"}, {"no model"});
    expect_wrong({"render", "", "-o", "a.png"}, {"model", "empty"});
    expect_wrong({"render", "cube.obj", "-o", "a.jpg"}, {"-o", "'a.jpg'", "png, exr, npy"});
    expect_wrong({"render", "cube.obj", "-o", "a"}, {"-o", "'a'"});
    expect_wrong({"render", "cube.obj", "-o", ""}, {"-o"});
    expect_wrong({"render", "cube.obj", "--mask", "a.exr"}, {"--mask", "npy, png"});
    expect_wrong({"render", "cube.obj", "-o", "-"}, {"--output-format"});
    expect_wrong({"render", "cube.obj", "-o", "-", "--output-format", "svg"},
                 {"--output-format", "'svg'"});
    expect_wrong({"render", "cube.obj", "-o", "-", "--depth", "-", "--output-format", "npy"},
                 {"standard output"});
    expect_wrong({"render", "cube.obj", "-o", "-", "--output-format", "png", "--json"}, {"--json"});
    expect_wrong_render({"--depth", "./a.png"}, {"--depth", "same file"});
    expect_wrong_render({"--aov", "normals"}, {"--aov", "EXR"});
    expect_wrong({"render", "cube.obj", "-o", "a.exr", "--aov", "depth"}, {"--aov", "'depth'"});
    write("model.png", "not really");
    expect_wrong({"render", "model.png", "-o", "model.png"}, {"'model.png'", "input"});
    EXPECT_EQ(read("model.png"), "not really");
}

TEST_F(WrongUse, StandardInput) {
    expect_wrong({"render", "-", "-o", "a.png"}, {"'-'", "--format"});
    expect_wrong({"render", "-", "-", "--format", "obj", "-o", "a.png"}, {"only once"});
}

TEST_F(WrongUse, Bench) {
    expect_wrong({"bench", "--frames", "0"}, {"--frames", "'0'"});
    expect_wrong({"bench", "cube.obj", "--generate", "10"}, {"--generate", "cube.obj"});
    expect_wrong({"bench", "cube.obj", "--subdivide", "15", "--frames", "1"}, {"2^30"});
    expect_wrong({"info", "cube.obj", "--vanishing-direction", "0,0,0"}, {"--vanishing-direction"});
}

}  // namespace
}  // namespace sightline::testing
