// What is in the world, as plain data: the result of loading one or more glTF files.
//
// Units: metres, candela (as W/sr: no 683 lm/W), lux (W/m^2), nits (W/(m^2 sr)). Node transforms
// are double precision; mesh data is as in the file, in the space of its node. Everything is
// indexed: -1 means "none". The loader guarantees that every index is in range, that the node tree
// has no cycle, and that every vector of a mesh that is not empty has one entry per vertex.
#pragma once

#include <Imath/ImathMatrix.h>
#include <Imath/ImathQuat.h>
#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ql {

using Imath::M44d;
using Imath::V2f;
using Imath::V3d;
using Imath::V3f;
using Imath::V4f;

// --- Textures --------------------------------------------------------------------------------

enum class Transfer { srgb, linear };

// 8-bit RGBA texels, row 0 at the top (v = 0), not premultiplied.
struct Texture {
    std::string name;
    int width = 0;
    int height = 0;
    std::vector<uint8_t> texels; // width * height * 4
};

enum class Wrap { repeat, mirrored_repeat, clamp };
enum class TextureFilter { bilinear, nearest };

// How a material reads a texture.
struct TextureUse {
    int texture = -1;
    Transfer transfer = Transfer::linear; // alpha is always linear
    int uv_set = 0;                       // 0 or 1
    Wrap wrap_s = Wrap::repeat;
    Wrap wrap_t = Wrap::repeat;
    TextureFilter filter = TextureFilter::bilinear;
    // KHR_texture_transform as rows of a 2 x 3 matrix: (u', v') = M (u, v, 1).
    std::array<float, 6> uv_transform = {1, 0, 0, 0, 1, 0};

    bool used() const { return texture >= 0; }
};

// --- Materials -------------------------------------------------------------------------------

enum class MaterialModel { metallic_roughness, phong, unlit };
enum class AlphaMode { opaque, mask, blend };
enum class FresnelModel { exact, schlick };

struct Material {
    std::string name;
    MaterialModel model = MaterialModel::metallic_roughness;
    // Surfaces reflect on both sides; this says whether they emit on both sides.
    bool double_sided = false;

    // Base colour of glTF; the diffuse colour of the Phong model; the radiance of unlit surfaces.
    V3f base_color = {1, 1, 1};
    float alpha = 1;
    TextureUse base_color_texture;
    AlphaMode alpha_mode = AlphaMode::opaque;
    float alpha_cutoff = 0.5f;

    V3f emission = {0, 0, 0}; // W/(m^2 sr), emissiveFactor times emissiveStrength
    TextureUse emission_texture;
    TextureUse normal_texture;
    float normal_scale = 1;

    // Metallic-roughness.
    float metallic = 1;
    float roughness = 1;                   // perceptual; the GGX alpha is its square
    TextureUse metallic_roughness_texture; // G: roughness, B: metallic
    float ior = 1.5f;                      // both models
    float transmission = 0;
    TextureUse transmission_texture; // R
    // Without KHR_materials_volume a transmissive surface is an infinitely thin wall.
    bool thin_walled = true;

    // Phong of Nilles 2017, section 3.2: f = kd diffuse / pi + ks specular (n + 2)/(2 pi) cos^n,
    // plus a perfect mirror (kr) and perfect refraction (kt). With ior > 0 and kt > 0 the split of
    // kr + kt between the two follows Fresnel.
    float kd = 1;
    float ks = 0;
    float kr = 0;
    float kt = 0;
    float exponent = 1;
    V3f specular_color = {1, 1, 1};
    FresnelModel fresnel = FresnelModel::exact;
};

// --- Geometry --------------------------------------------------------------------------------

// One glTF primitive: triangles of one material.
struct Mesh {
    std::string name;
    int material = 0; // always valid: the loader appends a default material where none is named
    std::vector<V3f> positions;
    std::vector<V3f> normals;            // unit length, or empty: flat
    std::vector<V4f> tangents;           // xyz and the sign of the bitangent, or empty
    std::array<std::vector<V2f>, 2> uvs; // TEXCOORD_0 and TEXCOORD_1, or empty
    std::vector<V4f> colors;             // COLOR_0, linear, or empty
    std::vector<std::array<uint32_t, 3>> triangles;
};

// KHR_implicit_shapes, centred at the node's origin, axis y.
struct ImplicitShape {
    enum class Kind { sphere, cone };
    Kind kind = Kind::sphere;
    int material = 0;
    float radius = 0.5f;        // sphere
    float height = 1;           // cone: from y = -height/2 (bottom) to +height/2 (top)
    float radius_bottom = 0.5f; // cone
    float radius_top = 0;       // cone
};

// --- Cameras and lights: they look along -z of their node, y up ----------------------------------

struct Camera {
    std::string name;
    bool orthographic = false;
    double yfov = 0.8; // radians, full vertical angle
    double ymag = 1;   // orthographic: half height in metres; the width follows the image
};

struct Light {
    enum class Kind { point, spot, directional };
    std::string name;
    Kind kind = Kind::point;
    V3d intensity = {1, 1, 1}; // W/sr (point, spot) or W/m^2 (directional)
    // Spot. Outside outer_angle (radians from the axis) there is no light. With an exponent n the
    // intensity is intensity * cos^n(theta) inside (Nilles 2017, eq. 17); without, glTF's smooth
    // step from inner_angle to outer_angle.
    double inner_angle = 0;
    double outer_angle = 0.7853981633974483;
    std::optional<double> exponent;
};

// --- Nodes and animation -------------------------------------------------------------------------

struct Node {
    std::string name;
    int parent = -1; // parents come before their children
    // Local transform: scale, then rotation, then translation; or a matrix (then not animated).
    V3d translation = {0, 0, 0};
    Imath::Quatd rotation;
    V3d scale = {1, 1, 1};
    std::optional<M44d> matrix; // Imath's convention: row vectors, v' = v M
    std::vector<int> meshes;
    std::vector<int> shapes;
    int camera = -1;
    int light = -1;
};

struct AnimationChannel {
    enum class Path { translation, rotation, scale };
    enum class Interpolation { step, linear, cubic_spline };
    int node = 0;
    Path path = Path::translation;
    Interpolation interpolation = Interpolation::linear;
    std::vector<double> times;                 // seconds, strictly increasing
    std::vector<std::array<double, 4>> values; // xyz or xyzw; cubic: in-tangent, value, out-tangent
};

struct Scene {
    std::vector<Texture> textures;
    std::vector<Material> materials;
    std::vector<Mesh> meshes;
    std::vector<ImplicitShape> shapes;
    std::vector<Camera> cameras;
    std::vector<Light> lights;
    std::vector<Node> nodes; // those of the default scene only
    std::vector<AnimationChannel> animation;

    uint64_t non_finite_vertices = 0;  // dropped with their triangles, counted here
    uint64_t degenerate_triangles = 0; // of zero area, dropped
};

// world_from_node of every node at a time in seconds. Before its first and after its last key a
// channel keeps the value of that key. Errors: ErrorKind::input for numbers beyond 1e100.
std::vector<M44d> world_from_nodes(const Scene& scene, double time_seconds);

} // namespace ql
