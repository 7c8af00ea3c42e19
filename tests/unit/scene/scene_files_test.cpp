// The scenes that the repository brings, and those of a data folder beside it if there is one.
#include "scene/features.h"
#include "unit/scene/gltf_builder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

namespace ql {
namespace {

namespace fs = std::filesystem;
using testing_gltf::ScratchFolder;

const std::string kScenes = QL_SOURCE_DIR "/examples/scenes/";

LoadedScene load_example(const std::string& name) {
    return load_gltf({kScenes + name + ".gltf"}, {}, Workers(1));
}

std::string content(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

const Material& material_of_node(const Scene& scene, const std::string& name) {
    for (const Node& node : scene.nodes)
        if (node.name == name)
            return scene.materials.at(size_t(scene.meshes.at(size_t(node.meshes.at(0))).material));
    throw input_error("no node {}", name);
}

TEST(ExampleScenes, GeneratorReproducesThem) {
    ASSERT_EQ(std::system("python3 -c pass"), 0) << "python3 is missing: ./setup installs it";
    const ScratchFolder folder;
    ASSERT_EQ(std::system(("python3 " + kScenes + "make_scenes.py " + folder.path()).c_str()), 0);
    size_t files = 0;
    for (const auto& entry : fs::directory_iterator(folder.path())) {
        ++files;
        EXPECT_EQ(content(entry.path()), content(kScenes + entry.path().filename().string()))
            << entry.path().filename();
    }
    EXPECT_GE(files, 11u);
}

TEST(ExampleScenes, AllLoadWithCameraAndLightAndWithoutWarnings) {
    size_t files = 0;
    for (const auto& entry : fs::directory_iterator(kScenes)) {
        if (entry.path().extension() != ".gltf") continue;
        ++files;
        // That for Sponza has no surface of its own.
        std::vector<std::string> paths = {entry.path().string()};
        if (entry.path().stem() == "sponza_lights") paths.push_back(kScenes + "cornell_area.gltf");
        const LoadedScene loaded = load_gltf(paths, {}, Workers(1));
        const SceneFeatures features = required_features(loaded.scene);
        EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
        EXPECT_GE(features.cameras, 1u) << entry.path();
        EXPECT_TRUE(features.has_light()) << entry.path();
        EXPECT_EQ(loaded.scene.degenerate_triangles, 0u);
    }
    EXPECT_GE(files, 11u);
}

// Walls face the room, blocks face outwards: glass and area lights depend on it.
TEST(ExampleScenes, CornellSurfacesFaceTheRightWay) {
    const Scene scene = load_example("cornell_area").scene;
    const std::vector<M44d> world = world_from_nodes(scene, 0);
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
        const std::string& name = scene.nodes[i].name;
        const bool block = name.ends_with("block");
        V3d middle(0.278, 0.2744, 0.2796);
        if (block) middle = V3d(0, 0.05, 0) * world[i];
        for (const int index : scene.nodes[i].meshes) {
            const Mesh& mesh = scene.meshes[size_t(index)];
            for (const auto& t : mesh.triangles) {
                const V3d a = V3d(mesh.positions[t[0]]) * world[i];
                const V3d b = V3d(mesh.positions[t[1]]) * world[i];
                const V3d c = V3d(mesh.positions[t[2]]) * world[i];
                const double towards = (b - a).cross(c - a).dot(middle - a);
                EXPECT_TRUE(block ? towards < 0 : towards > 0) << name;
            }
        }
    }
}

TEST(ExampleScenes, CornellHasItsMeasuredSizeAndReflectances) {
    const Scene scene = load_example("cornell_point").scene;
    EXPECT_EQ(required_features(scene).triangles, 30u);
    V3d low(1e9);
    V3d high(-1e9);
    const std::vector<M44d> world = world_from_nodes(scene, 0);
    for (size_t i = 0; i < scene.nodes.size(); ++i)
        for (const int index : scene.nodes[i].meshes)
            for (const V3f& p : scene.meshes[size_t(index)].positions)
                for (int c = 0; c < 3; ++c) {
                    const V3d q = V3d(p) * world[i];
                    low[c] = std::min(low[c], q[c]);
                    high[c] = std::max(high[c], q[c]);
                }
    EXPECT_LT((low - V3d(0)).length(), 1e-6);
    EXPECT_LT((high - V3d(0.556, 0.5488, 0.5592)).length(), 1e-6);
    EXPECT_EQ(material_of_node(scene, "red_wall").base_color, V3f(0.63f, 0.065f, 0.05f));
    EXPECT_EQ(material_of_node(scene, "green_wall").base_color, V3f(0.14f, 0.45f, 0.091f));
    EXPECT_EQ(material_of_node(scene, "floor").kd, 1);
}

TEST(ExampleScenes, BackBlockVariants) {
    const Material phong = material_of_node(load_example("cornell_phong").scene, "tall_block");
    EXPECT_EQ(phong.ks, 1);
    EXPECT_EQ(phong.exponent, 40);
    EXPECT_EQ(material_of_node(load_example("cornell_mirror").scene, "tall_block").kr, 1);
    const Material glass = material_of_node(load_example("cornell_glass").scene, "tall_block");
    EXPECT_EQ(glass.kt, 1);
    EXPECT_EQ(glass.ior, 1.45f);
}

TEST(ExampleScenes, SpotShinesFromTheFrontLeftFloorToTheBackRightCeiling) {
    const Scene scene = load_example("cornell_spot").scene;
    const Light& light = scene.lights.at(0);
    EXPECT_NEAR(light.outer_angle, std::acos(0.5), 1e-9);
    EXPECT_EQ(light.exponent, 2.0);
    const std::vector<M44d> world = world_from_nodes(scene, 0);
    int found = 0;
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
        if (scene.nodes[i].light != 0) continue;
        ++found;
        const V3d from = V3d(0) * world[i];
        V3d direction;
        world[i].multDirMatrix(V3d(0, 0, -1), direction);
        const V3d to_corner = (V3d(0, 0.5488, 0.5592) - from).normalized();
        EXPECT_LT((direction - to_corner).length(), 1e-9);
    }
    EXPECT_EQ(found, 1);
}

TEST(ExampleScenes, MovingScenesMove) {
    for (const char* name : {"cornell_moving_camera", "cornell_moving_block"}) {
        const Scene scene = load_example(name).scene;
        const std::vector<M44d> before = world_from_nodes(scene, 0);
        const std::vector<M44d> after = world_from_nodes(scene, 1.0 / 24);
        size_t moved = 0;
        for (size_t i = 0; i < before.size(); ++i)
            moved += before[i] != after[i];
        EXPECT_EQ(moved, 1u) << name;
    }
}

// --- The data folder
// ------------------------------------------------------------------------------

std::string data_folder() {
    const char* given = std::getenv("QL_DATA");
    return given ? given : QL_SOURCE_DIR "/../shared/data";
}

// Files by the triangle counts in the table of the folder's README.md.
std::map<std::string, uint64_t> listed_files(const std::string& folder) {
    std::map<std::string, uint64_t> files;
    std::istringstream lines(content(folder + "/README.md"));
    for (std::string line; std::getline(lines, line);) {
        // | `file` ... | source | author | licence | triangles | ...
        std::vector<std::string> cells;
        std::istringstream row(line);
        for (std::string cell; std::getline(row, cell, '|');)
            cells.push_back(cell);
        if (cells.size() < 6 || !cells[1].starts_with(" `")) continue;
        std::string count = cells[5];
        std::erase_if(count, [](char c) { return c < '0' || c > '9'; });
        files[cells[1].substr(2, cells[1].find('`', 2) - 2)] = std::stoull(count);
    }
    return files;
}

TEST(DataScenes, LoadWithTheListedTrianglesOrAreRefusedForWhatTheyAre) {
    const std::string folder = data_folder() + "/scenes";
    const std::map<std::string, std::string> refused = {
        {"small/draco_box/BoxDraco.gltf", "KHR_draco_mesh_compression"},
        {"small/balloon_ktx2_glb/CesiumBalloonKTX2.glb", "KHR_texture_basisu"},
        {"small/box_gltf1_unsupported/box.gltf", "glTF version 1.0"}};
    const auto files = listed_files(folder);
    EXPECT_EQ(files.size() > 30, fs::exists(folder)); // the table is found wherever the folder is
    for (const auto& [file, triangles] : files) {
        SCOPED_TRACE(file);
        const auto reason = refused.find(file);
        try {
            const Scene scene = load_gltf({folder + "/" + file}, {}, Workers(2)).scene;
            EXPECT_EQ(reason, refused.end());
            EXPECT_EQ(required_features(scene).triangles + scene.degenerate_triangles, triangles);
        } catch (const Error& error) {
            ASSERT_NE(reason, refused.end()) << error.what();
            EXPECT_NE(std::string(error.what()).find(reason->second), std::string::npos);
        }
    }
}

} // namespace
} // namespace ql
