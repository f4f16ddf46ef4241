// OpenSubdiv behind the protocol of protocol.hpp.
//
// Tags are lines of text: `crease A B SHARPNESS`, `corner V SHARPNESS`, `boundary none|edge|corner`,
// `fvar RULE`, `uv U V` for each value of face-varying data, `corner_uv INDEX` for each corner.
#include "protocol.hpp"

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/osd/ompEvaluator.h>

#include <memory>

namespace Far = OpenSubdiv::Far;
namespace Osd = OpenSubdiv::Osd;
namespace Sdc = OpenSubdiv::Sdc;

struct Vertex {
    double x = 0, y = 0, z = 0;

    void Clear(void* = nullptr) { x = y = z = 0; }
    void AddWithWeight(const Vertex& other, double weight) {
        x += weight * other.x;
        y += weight * other.y;
        z += weight * other.z;
    }
};
static_assert(sizeof(Vertex) == 24);

struct TexturePoint {
    double u = 0, v = 0;

    void Clear(void* = nullptr) { u = v = 0; }
    void AddWithWeight(const TexturePoint& other, double weight) {
        u += weight * other.u;
        v += weight * other.v;
    }
};

// A cage as the library wants it described.
struct Cage {
    std::vector<int> degrees, corners, crease_vertices, corner_vertices, corner_values;
    std::vector<float> creases, sharp_corners;
    std::vector<TexturePoint> values;
    Far::TopologyDescriptor::FVarChannel channel;
    Far::TopologyDescriptor descriptor;
    Sdc::Options options;
    Sdc::SchemeType scheme;

    Cage(const Raw& raw, const Call& call) {
        for (std::size_t f = 0; f < raw.faces(); ++f) degrees.push_back(int(raw.starts[f + 1] - raw.starts[f]));
        corners.assign(raw.corners.begin(), raw.corners.end());
        if (call.scheme == "loop") scheme = Sdc::SCHEME_LOOP;
        else if (call.scheme == "catmull-clark") scheme = Sdc::SCHEME_CATMARK;
        else throw std::runtime_error("OpenSubdiv's driver has no scheme " + call.scheme);
        options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
        if (!call.tags.empty()) read_tags(call.tags);
        descriptor.numVertices = int(raw.points.size());
        descriptor.numFaces = int(degrees.size());
        descriptor.numVertsPerFace = degrees.data();
        descriptor.vertIndicesPerFace = corners.data();
        descriptor.numCreases = int(creases.size());
        descriptor.creaseVertexIndexPairs = crease_vertices.data();
        descriptor.creaseWeights = creases.data();
        descriptor.numCorners = int(sharp_corners.size());
        descriptor.cornerVertexIndices = corner_vertices.data();
        descriptor.cornerWeights = sharp_corners.data();
        if (values.empty()) return;
        channel.numValues = int(values.size());
        channel.valueIndices = corner_values.data();
        descriptor.numFVarChannels = 1;
        descriptor.fvarChannels = &channel;
    }

    std::unique_ptr<Far::TopologyRefiner> refiner(int levels, bool all) const {
        typedef Far::TopologyRefinerFactory<Far::TopologyDescriptor> Factory;
        std::unique_ptr<Far::TopologyRefiner> refiner(Factory::Create(descriptor, Factory::Options(scheme, options)));
        if (!refiner) throw std::runtime_error("OpenSubdiv refuses the cage");
        Far::TopologyRefiner::UniformOptions how(levels);
        how.fullTopologyInLastLevel = all;
        refiner->RefineUniform(how);
        return refiner;
    }

private:
    void read_tags(const std::string& path) {
        std::ifstream in(path);
        for (std::string kind; in >> kind;) {
            if (kind == "crease") {
                int a, b;
                float sharpness;
                in >> a >> b >> sharpness;
                crease_vertices.insert(crease_vertices.end(), {a, b});
                creases.push_back(sharpness);
            } else if (kind == "corner") {
                int v;
                float sharpness;
                in >> v >> sharpness;
                corner_vertices.push_back(v);
                sharp_corners.push_back(sharpness);
            } else if (kind == "boundary") {
                std::string rule;
                in >> rule;
                options.SetVtxBoundaryInterpolation(
                    rule == "corner" ? Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER
                    : rule == "edge" ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
                                     : Sdc::Options::VTX_BOUNDARY_NONE);
            } else if (kind == "fvar") {
                std::string rule;
                in >> rule;
                options.SetFVarLinearInterpolation(
                    rule == "none" ? Sdc::Options::FVAR_LINEAR_NONE
                    : rule == "corners-only" ? Sdc::Options::FVAR_LINEAR_CORNERS_ONLY
                    : rule == "corners-plus-1" ? Sdc::Options::FVAR_LINEAR_CORNERS_PLUS1
                    : rule == "corners-plus-2" ? Sdc::Options::FVAR_LINEAR_CORNERS_PLUS2
                    : rule == "boundaries" ? Sdc::Options::FVAR_LINEAR_BOUNDARIES
                    : rule == "all" ? Sdc::Options::FVAR_LINEAR_ALL
                                    : throw std::runtime_error("no rule " + rule));
            } else if (kind == "uv") {
                TexturePoint value;
                in >> value.u >> value.v;
                values.push_back(value);
            } else if (kind == "corner_uv") {
                int value;
                in >> value;
                corner_values.push_back(value);
            } else {
                throw std::runtime_error("no tag " + kind);
            }
        }
    }
};

std::vector<Vertex> vertices(const Raw& raw) {
    std::vector<Vertex> vertices(raw.points.size());
    std::memcpy(static_cast<void*>(vertices.data()), raw.points.data(), 24 * raw.points.size());
    return vertices;
}

// All levels but the cage, one behind the other, as the library's tutorials have it.
std::vector<Vertex> interpolated(const Far::TopologyRefiner& refiner, const std::vector<Vertex>& cage) {
    std::vector<Vertex> all(std::size_t(refiner.GetNumVerticesTotal() - refiner.GetLevel(0).GetNumVertices()));
    const Far::PrimvarRefinerReal<double> primvar(refiner);
    const Vertex* from = cage.data();
    Vertex* to = all.data();
    for (int level = 1; level <= refiner.GetMaxLevel(); ++level) {
        primvar.Interpolate(level, from, to);
        from = to;
        to += refiner.GetLevel(level).GetNumVertices();
    }
    return all;
}

// The face-varying values of the corners of the last level, face by face.
void texture(const Far::TopologyRefiner& refiner, const Cage& cage, const Call& call) {
    const Far::PrimvarRefinerReal<double> primvar(refiner);
    std::vector<TexturePoint> now = cage.values;
    for (int level = 1; level <= call.levels; ++level) {
        std::vector<TexturePoint> next(std::size_t(refiner.GetLevel(level).GetNumFVarValues()));
        primvar.InterpolateFaceVarying(level, now, next);
        now.swap(next);
    }
    const auto level = refiner.GetLevel(call.levels);
    std::vector<double> numbers;
    for (int f = 0; f < level.GetNumFaces(); ++f) {
        if (level.IsFaceHole(f)) continue;
        const auto corners = level.GetFaceFVarValues(f);
        for (int k = 0; k < corners.size(); ++k) {
            const TexturePoint& value = now[std::size_t(corners[k])];
            numbers.insert(numbers.end(), {value.u, value.v});
        }
    }
    column(call.out, "uv", numbers);
}

void subdivide(Report& report, const Raw& raw, const Call& call) {
    const Cage cage(raw, call);
    const auto refiner = cage.refiner(call.levels, true);
    const auto start = vertices(raw);
    const auto all = interpolated(*refiner, start);
    const auto level = refiner->GetLevel(call.levels);
    const std::size_t count = std::size_t(level.GetNumVertices());
    const Vertex* last = call.levels == 0 ? start.data() : all.data() + (all.size() - count);
    Raw out;
    out.starts.push_back(0);
    for (std::size_t v = 0; v < count; ++v) out.points.push_back({last[v].x, last[v].y, last[v].z});
    for (int f = 0; f < level.GetNumFaces(); ++f) {
        if (level.IsFaceHole(f)) continue;
        const auto corners = level.GetFaceVertices(f);
        for (int k = 0; k < corners.size(); ++k) out.corners.push_back(uint32_t(corners[k]));
        out.starts.push_back(uint32_t(out.corners.size()));
    }
    write_raw(call.out + ".raw", out);
    std::vector<Vertex> limit(count), first(count), second(count);
    Far::PrimvarRefinerReal<double>(*refiner).Limit(last, limit, first, second);
    for (const auto& [name, values] : {std::pair("limits", &limit), {"tangents_1", &first}, {"tangents_2", &second}}) {
        std::vector<double> numbers;
        for (const auto& p : *values) numbers.insert(numbers.end(), {p.x, p.y, p.z});
        column(call.out, name, numbers);
    }
    if (!cage.values.empty()) texture(*refiner, cage, call);
    report.number("vertices", double(count));
    report.number("faces", double(out.faces()));
}

// One row per vertex of the last level, from the cage.
template <class Real>
std::unique_ptr<const Far::StencilTableReal<Real>> table(const Far::TopologyRefiner& refiner) {
    typename Far::StencilTableFactoryReal<Real>::Options options;
    options.generateIntermediateLevels = false;
    options.generateOffsets = true;
    return std::unique_ptr<const Far::StencilTableReal<Real>>(
        Far::StencilTableFactoryReal<Real>::Create(refiner, options));
}

int main(int count, char** arguments) {
    try {
        const Call call = Call::parse(count, arguments);
        Report report;
        const Raw raw = read_raw(call.input);
        if (call.operation == "subdivide") {
            subdivide(report, raw, call);
        } else {
            const Cage cage(raw, call);
            const auto start = vertices(raw);
            std::unique_ptr<Far::TopologyRefiner> refiner;
            if (call.operation == "plan-refine") {
                report.time(call.repeat, [&] {
                    refiner = cage.refiner(call.levels, false);
                    return interpolated(*refiner, start);
                });
            } else if (call.operation == "plan") {
                report.time(call.repeat, [&] {
                    refiner = cage.refiner(call.levels, false);
                    return 0;
                });
            } else if (call.operation == "refine") {
                refiner = cage.refiner(call.levels, false);
                report.time(call.repeat, [&] { return interpolated(*refiner, start); });
            } else if (call.operation == "stencils") {
                refiner = cage.refiner(call.levels, false);
                const auto stencils = table<double>(*refiner);
                report.number("entries", double(stencils->GetControlIndices().size()));
                report.time(call.repeat, [&] {
                    std::vector<Vertex> refined(std::size_t(stencils->GetNumStencils()));
                    stencils->UpdateValues(start, refined);
                    return refined;
                });
            } else if (call.operation == "stencils-threads-32-bit") {
                refiner = cage.refiner(call.levels, false);
                const auto stencils = table<float>(*refiner);
                std::vector<float> source;
                for (const auto& p : start) source.insert(source.end(), {float(p.x), float(p.y), float(p.z)});
                const Osd::BufferDescriptor layout(0, 3, 3);
                report.time(call.repeat, [&] {
                    std::vector<float> refined(3 * std::size_t(stencils->GetNumStencils()));
                    Osd::OmpEvaluator::EvalStencils(
                        source.data(), layout, refined.data(), layout, stencils->GetSizes().data(),
                        stencils->GetOffsets().data(), stencils->GetControlIndices().data(),
                        stencils->GetWeights().data(), 0, stencils->GetNumStencils());
                    return refined;
                });
            } else {
                throw std::runtime_error("OpenSubdiv's driver has no operation " + call.operation);
            }
            report.number("vertices", double(refiner->GetLevel(call.levels).GetNumVertices()));
            report.number("faces", double(refiner->GetLevel(call.levels).GetNumFaces()));
        }
        report.print();
        return 0;
    } catch (const std::exception& error) {
        std::cerr << error.what() << std::endl;
        return 1;
    }
}
