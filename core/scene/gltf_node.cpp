#include "scene/gltf_node.h"

#include "scene/gltf_light.h"
#include "scene/gltf_material.h"
#include "scene/gltf_mesh.h"
#include "scene/gltf_validate.h"
#include "scene/gltf_value.h"

#include <tiny_gltf.h>

#include <cmath>
#include <numbers>

namespace ql {

namespace {

// --- Transforms ---------------------------------------------------------------------------------

void check_length(const GltfImport& in, const std::vector<double>& values, size_t expected,
                  const std::string& what) {
    if (!values.empty() && values.size() != expected)
        throw in.error("{} has {} numbers, expected {}", what, values.size(), expected);
}

Imath::Quatd unit_rotation(GltfImport& in, const std::vector<double>& xyzw,
                           const std::string& where) {
    const Imath::Quatd rotation(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
    const double length = rotation.length();
    if (!(length > 0)) throw in.error("{}: rotation of length {}, expected 1", where, length);
    if (std::abs(length - 1) > 1e-3)
        in.warn("{}: rotation of length {}, expected 1", where, length);
    return rotation / length;
}

void read_transform(GltfImport& in, const tinygltf::Node& source, const std::string& where,
                    Node& node) {
    check_length(in, source.translation, 3, where + " translation");
    check_length(in, source.rotation, 4, where + " rotation");
    check_length(in, source.scale, 3, where + " scale");
    check_length(in, source.matrix, 16, where + " matrix");
    const auto vector = [](const std::vector<double>& v) { return V3d(v[0], v[1], v[2]); };
    if (!source.translation.empty()) node.translation = vector(source.translation);
    if (!source.rotation.empty()) node.rotation = unit_rotation(in, source.rotation, where);
    if (!source.scale.empty()) node.scale = vector(source.scale);
    if (source.matrix.empty()) return;
    // glTF stores columns of v' = M v, which are the rows of Imath's v' = v M.
    M44d matrix;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            matrix[row][column] = source.matrix[size_t(row * 4 + column)];
    if (matrix[0][3] != 0 || matrix[1][3] != 0 || matrix[2][3] != 0 || matrix[3][3] != 1)
        throw in.error("{}: matrix is not affine", where);
    node.matrix = matrix;
}

// --- Cameras ------------------------------------------------------------------------------------

Camera camera_from(GltfImport& in, int index, const std::string& where) {
    const tinygltf::Camera& source = in.at(in.model.cameras, index, where, "camera");
    const std::string name = fmt::format("camera {}", index);
    Camera camera;
    camera.name = source.name;
    if (source.type == "perspective") {
        camera.yfov = source.perspective.yfov;
        if (!(camera.yfov > 0 && camera.yfov < std::numbers::pi))
            throw in.error("{}: yfov {}, expected an angle between 0 and pi", name, camera.yfov);
    } else if (source.type == "orthographic") {
        camera.orthographic = true;
        camera.ymag = std::abs(source.orthographic.ymag);
        if (!(std::abs(source.orthographic.xmag) > 0 && camera.ymag > 0))
            throw in.error("{}: xmag {} and ymag {}, expected other than 0", name,
                           source.orthographic.xmag, camera.ymag);
    } else {
        throw in.error("{}: type \"{}\", expected perspective or orthographic", name, source.type);
    }
    return camera;
}

// --- Implicit shapes ----------------------------------------------------------------------------

ImplicitShape shape_from(GltfImport& in, const ExtensionObject& source) {
    const std::string type = source.text("type", "");
    const auto shape = source.object(type.c_str());
    const auto size = [&](const char* key, double fallback) {
        const double value = shape ? shape->number(key, fallback) : fallback;
        if (!(value >= 0) || !std::isfinite(float(value)))
            throw in.error("{} {} is {}, expected a positive number", source.where(), key, value);
        return float(value);
    };
    ImplicitShape result;
    if (type == "sphere") {
        result.kind = ImplicitShape::Kind::sphere;
        result.radius = size("radius", 0.5);
        if (result.radius == 0) throw in.error("{}: radius 0", source.where());
    } else if (type == "cylinder") {
        result.kind = ImplicitShape::Kind::cone;
        result.height = size("height", 0.5);
        result.radius_bottom = size("radiusBottom", 0.25);
        result.radius_top = size("radiusTop", 0.25);
        if (result.height == 0 || result.radius_bottom + result.radius_top == 0)
            throw in.error("{}: a cylinder without height or radius", source.where());
    } else {
        throw in.error("{}: type \"{}\", expected sphere or cylinder", source.where(), type);
    }
    return result;
}

void import_shape(GltfImport& in, const tinygltf::Node& source, const std::string& where,
                  Node& node) {
    const auto used = extension(in, source.extensions, "KHR_implicit_shapes", where);
    if (!used) return;
    const auto root = extension(in, in.model.extensions, "KHR_implicit_shapes", "");
    const auto shapes = root ? root->objects("shapes") : std::vector<ExtensionObject>();
    ImplicitShape shape =
        shape_from(in, in.at(shapes, used->index("shape"), used->where(), "shape"));
    const auto material = extension(in, source.extensions, "QL_shape_material", where);
    shape.material = import_material(in, material ? material->index("material") : -1, where);
    node.shapes.push_back(int(in.scene.shapes.size()));
    in.scene.shapes.push_back(shape);
}

// --- Nodes --------------------------------------------------------------------------------------

Node node_from(GltfImport& in, int index) {
    const tinygltf::Node& source = in.model.nodes[size_t(index)];
    const std::string where = fmt::format("node {}", index);
    Node node;
    node.name = source.name;
    read_transform(in, source, where, node);
    if (source.mesh >= 0) {
        in.at(in.model.meshes, source.mesh, where, "mesh");
        node.meshes = import_mesh(in, source.mesh);
    }
    if (source.skin >= 0) {
        in.at(in.model.skins, source.skin, where, "skin");
        in.warn("{}: its skin is not applied (rest pose)", where);
    }
    import_shape(in, source, where, node);
    if (source.camera >= 0) {
        node.camera = int(in.scene.cameras.size());
        Camera camera = camera_from(in, source.camera, where);
        if (camera.name.empty()) camera.name = source.name;
        in.scene.cameras.push_back(std::move(camera));
    }
    if (const auto used = extension(in, source.extensions, "KHR_lights_punctual", where)) {
        node.light = int(in.scene.lights.size());
        in.scene.lights.push_back(light_from(in, used->index("light"), where));
        if (in.scene.lights.back().name.empty()) in.scene.lights.back().name = source.name;
    }
    return node;
}

} // namespace

void import_nodes(GltfImport& in) {
    const std::vector<int> parents = checked_parents(in);
    in.nodes.assign(parents.size(), -1);
    std::vector<int> open = default_roots(in, parents);
    std::reverse(open.begin(), open.end());
    while (!open.empty()) {
        const int index = open.back();
        open.pop_back();
        Node node = node_from(in, index);
        const int parent = parents[size_t(index)];
        node.parent = parent < 0 ? -1 : in.nodes[size_t(parent)];
        in.nodes[size_t(index)] = int(in.scene.nodes.size());
        in.scene.nodes.push_back(std::move(node));
        const std::vector<int>& children = in.model.nodes[size_t(index)].children;
        open.insert(open.end(), children.rbegin(), children.rend());
    }
}

} // namespace ql
