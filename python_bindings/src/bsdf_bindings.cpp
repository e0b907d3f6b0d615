// SPDX-License-Identifier: MIT
#include <pybind11/operators.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "arguments.h"
#include "base/unit_direction.h"
#include "bindings.h"
#include "gil.h"
#include "shlight/bsdf.h"
#include "shlight/lobe_table.h"
#include "shlight/plain_fit.h"
#include "whole_objects.h"

namespace shlight::python {
namespace {

bool is_grey(const Bsdf& bsdf) {
    for (const Lobe& lobe : bsdf.lobes()) {
        if (lobe.color.x != lobe.color.y || lobe.color.y != lobe.color.z) {
            return false;
        }
    }
    return true;
}

void check_cosine(double cosine) {
    if (!(cosine >= 0 && cosine <= 1)) {
        throw std::invalid_argument("cos_theta_o must lie in [0, 1]");
    }
}

std::pair<AnyArray<double>, AnyArray<double>> broadcast_pair(const std::string& name, const AnyArray<double>& a,
                                                             const std::string& other, const AnyArray<double>& b) {
    py::sequence both;
    try {
        both = py::module_::import("numpy").attr("broadcast_arrays")(a, b);
    } catch (const py::error_already_set& error) {
        if (!error.matches(PyExc_ValueError)) {
            throw;
        }
        throw std::invalid_argument(name + " and " + other + " have leading axes that do not broadcast");
    }
    return {AnyArray<double>(py::reinterpret_borrow<py::object>(both[0])),
            AnyArray<double>(py::reinterpret_borrow<py::object>(both[1]))};
}

std::shared_ptr<const PlainFit> fit_of(const Lobe& lobe) {
    if (is_mirror(lobe.shape)) {
        throw std::invalid_argument("a perfect mirror (roughness below 0.003) has no coefficients");
    }
    return plain_fit(lobe.shape);
}

/// A lobe's fit by one order, at views of the frame whose x is the surface's tangent.
class LobeFit {
  public:
    LobeFit(const Lobe& lobe, int order)
        : lobe_(lobe), order_(order), fit_(is_anisotropic(lobe.shape) ? nullptr : fit_of(lobe)) {}

    Rgb scale(double cosine) const { return lobe_.scale(static_cast<float>(cosine)); }

    PlainView at(double cosine, double any_azimuth) const {
        const double azimuth = std::remainder(any_azimuth, 2 * std::numbers::pi);  // so that m azimuth is finite
        if (fit_ == nullptr) {
            TableShape shape = std::get<TableShape>(lobe_.shape);
            shape.azimuth = azimuth;
            return plain_view(shape, cosine, order_);
        }
        PlainView view{std::vector<float>(static_cast<std::size_t>(coefficient_count(order_))), fit_->norm(cosine),
                       fit_->residual(cosine, order_)};
        std::vector<float> terms(static_cast<std::size_t>(cosine_count(order_)));
        fit_->coefficients(cosine, order_, terms.data());
        for (int l = 0; l < order_; ++l) {
            for (int m = 0; m <= l; ++m) {
                const double term = terms[static_cast<std::size_t>(cosine_index(l, m))];
                const auto at = [&](int degree) -> float& {
                    return view.coefficients[static_cast<std::size_t>(coefficient_index(l, degree))];
                };
                at(-m) = static_cast<float>(term * std::sin(m * azimuth));
                at(m) = static_cast<float>(term * std::cos(m * azimuth));
            }
        }
        return view;
    }

  private:
    Lobe lobe_;
    int order_;
    std::shared_ptr<const PlainFit> fit_;  // null for an anisotropic lobe
};

using LobeFits = std::vector<LobeFit>;

/// Coefficients at one view: `channels` rows of order² numbers.
void write_coefficients(const LobeFits& lobes, double cosine, double azimuth, int channels, std::size_t row,
                        float* out) {
    std::fill_n(out, static_cast<std::size_t>(channels) * row, 0.0F);
    for (const LobeFit& lobe : lobes) {
        const Rgb scale = lobe.scale(cosine);
        const PlainView view = lobe.at(cosine, azimuth);
        for (int channel = 0; channel < channels; ++channel) {
            for (std::size_t i = 0; i < row; ++i) {
                out[static_cast<std::size_t>(channel) * row + i] += scale[channel] * view.coefficients[i];
            }
        }
    }
}

/// Upper bound of the residual: errors of lobes that share a channel are added, since they may have the same sign.
double residual_at(const LobeFits& lobes, double cosine, double azimuth) {
    double largest = 0;
    std::array<double, 3> errors{}, squares{};  // squares: a lower bound of the squared norm, without overlaps of lobes
    for (const LobeFit& lobe : lobes) {
        const Rgb scale = lobe.scale(cosine);
        const PlainView view = lobe.at(cosine, azimuth);
        for (int channel = 0; channel < 3; ++channel) {
            const auto c = static_cast<std::size_t>(channel);
            const double size = double{scale[channel]} * view.norm;
            errors[c] += size * view.residual;
            squares[c] += size * size;
        }
    }
    for (std::size_t c = 0; c < 3; ++c) {
        largest = std::max(largest, squares[c] > 0 ? errors[c] / std::sqrt(squares[c]) : 0.0);
    }
    return largest;
}

/// Views that broadcast, and fits, for `coefficients` and `residual`.
struct WantedViews {
    AnyArray<double> cosines, azimuths;
    int order;
    LobeFits lobes;

    WantedViews(const Bsdf& bsdf, const py::object& cos_theta_o, const py::object& bands, const py::object& phi_o)
        : order(int_from("order", bands)) {
        check_order(order);
        const AnyArray<double> angles =
            phi_o.is_none() ? AnyArray<double>(py::array(py::float_(0.0))) : array_from<double>("phi_o", phi_o);
        check_all_finite("phi_o", values(angles));
        std::tie(cosines, azimuths) =
            broadcast_pair("cos_theta_o", array_from<double>("cos_theta_o", cos_theta_o), "phi_o", angles);
        for (const double cosine : values(cosines)) {
            check_cosine(cosine);
        }
        for (const Lobe& lobe : bsdf.lobes()) {
            lobes.emplace_back(lobe, order);
        }
    }
};

Array<float> coefficients(const Bsdf& bsdf, const py::object& cos_theta_o, const py::object& bands,
                          const py::object& phi_o) {
    const WantedViews views(bsdf, cos_theta_o, bands, phi_o);
    const int channels = is_grey(bsdf) ? 1 : 3;
    const int row = coefficient_count(views.order);
    std::vector<py::ssize_t> added{row};
    if (channels == 3) {
        added.insert(added.begin(), 3);
    }
    Array<float> out(shape_with(views.cosines, 0, added));
    float* data = out.mutable_data();
    for (std::size_t i = 0; i < values(views.cosines).size(); ++i) {
        write_coefficients(views.lobes, values(views.cosines)[i], values(views.azimuths)[i], channels,
                           static_cast<std::size_t>(row), data);
        data += channels * row;
    }
    return out;
}

Array<double> residual(const Bsdf& bsdf, const py::object& cos_theta_o, const py::object& bands,
                       const py::object& phi_o) {
    const WantedViews views(bsdf, cos_theta_o, bands, phi_o);
    Array<double> out(shape_with(views.cosines, 0, {}));
    double* data = out.mutable_data();
    for (std::size_t i = 0; i < values(views.cosines).size(); ++i) {
        *data++ = residual_at(views.lobes, values(views.cosines)[i], values(views.azimuths)[i]);
    }
    return out;
}

AnyArray<double> directions_from(const char* name, const py::object& value) {
    AnyArray<double> array = array_from<double>(name, value);
    vectors(name, array);  // which checks the shape
    return array;
}

Array<double> evaluate(const Bsdf& bsdf, const py::object& wi, const py::object& wo) {
    const AnyArray<double> lights = directions_from("wi", wi);
    const AnyArray<double> views = directions_from("wo", wo);
    const auto [incoming, outgoing] = broadcast_pair("wi", lights, "wo", views);
    const auto i = vectors("wi", incoming);
    const auto o = vectors("wo", outgoing);
    const bool grey = is_grey(bsdf);
    Array<double> out(shape_with(incoming, 1, grey ? std::vector<py::ssize_t>{} : std::vector<py::ssize_t>{3}));
    double* data = out.mutable_data();
    for (std::size_t k = 0; k < i.size(); ++k) {
        const Rgb f = bsdf.evaluate(unit_direction(i[k], "wi"), unit_direction(o[k], "wo"));
        for (int channel = 0; channel < (grey ? 1 : 3); ++channel) {
            *data++ = static_cast<double>(f[channel]);
        }
    }
    return out;
}

/// Whether a value is an expression of shlight.nodes: a number, a vector or a colour.
bool is_expression(const py::handle& value) {
    return py::hasattr(value, "step") || py::hasattr(value, "as_number");
}

py::object shader_function(const char* name) {
    return py::module_::import("shlight.nodes").attr(name);
}

py::object table_function(const char* name) {
    return py::module_::import("shlight._tables").attr(name);
}

py::object scaled(const Bsdf& bsdf, const py::object& factor) {
    return is_expression(factor) ? shader_function("scaled")(bsdf, factor)
                                 : py::cast(bsdf.scaled(color_from("factor", factor)));
}

py::object lambert(const py::object& albedo) {
    return is_expression(albedo) ? shader_function("lambert")(albedo)
                                 : py::cast(Bsdf::lambert(color_from("albedo", albedo)));
}

/// None: 0.
double ior_from(const py::object& ior) {
    const double index = ior.is_none() ? 0 : real_from("ior", ior);
    if (!ior.is_none() && !(index > 1)) {
        throw std::invalid_argument("ior must be finite and greater than 1");
    }
    return index;
}

Bsdf constant_ggx(const py::object& roughness, const py::object& f0, const py::object& ior) {
    const auto width = static_cast<float>(real_from("roughness", roughness));
    const Rgb head_on = color_from("f0", f0);
    const double index = ior_from(ior);
    const GilReleased release;
    return Bsdf::ggx(width, head_on, index);
}

py::object ggx(const py::object& roughness, const py::object& f0, const py::object& ior) {
    return is_expression(roughness) || is_expression(f0) ? shader_function("ggx")(roughness, f0, py::arg("ior") = ior)
                                                         : py::cast(constant_ggx(roughness, f0, ior));
}

Bsdf layer(const py::object& top, const py::object& base) {
    return Bsdf::layer(object_from<Bsdf>("top", top, "Bsdf"), object_from<Bsdf>("base", base, "Bsdf"));
}

std::string described(const LobeShape& shape) {
    const auto* const ggx = std::get_if<GgxShape>(&shape);
    if (ggx == nullptr) {
        const char* const other = is_anisotropic(shape) ? "anisotropic table" : "table";
        return std::holds_alternative<LambertShape>(shape) ? "lambert" : other;
    }
    constexpr std::array kCurves = {"", ", fresnel='schlick'", ", fresnel='dielectric'", ", fresnel='dip'"};
    std::ostringstream text;
    text.precision(3);
    text << "ggx(roughness=" << std::sqrt(ggx->alpha) << kCurves.at(static_cast<std::size_t>(ggx->fresnel)) << ")";
    return text.str();
}

/// The lobes, with the channels of a table as one.
std::vector<Lobe> lobes_to_show(const Bsdf& bsdf) {
    std::vector<Lobe> lobes;
    for (const Lobe& lobe : bsdf.lobes()) {
        const auto* own = std::get_if<TableShape>(&lobe.shape);
        const auto* last = lobes.empty() ? nullptr : std::get_if<TableShape>(&lobes.back().shape);
        if (own != nullptr && last != nullptr && own->table == last->table && own->channel == last->channel + 1) {
            lobes.back().color += lobe.color;
            lobes.back().shape = lobe.shape;
        } else {
            lobes.push_back(lobe);
        }
    }
    return lobes;
}

/// The lobes, each times its colour; a lobe under another is dimmed by what that reflects at the view.
std::string repr(const Bsdf& bsdf) {
    std::ostringstream text;
    text.precision(3);
    const char* before = "Bsdf(";
    for (const Lobe& lobe : lobes_to_show(bsdf)) {
        const Rgb& c = lobe.color;
        text << before << described(lobe.shape) << " * (" << c.x << ", " << c.y << ", " << c.z << ")"
             << (lobe.weight ? " under a layer" : "");
        before = " + ";
    }
    return bsdf.lobes().empty() ? "Bsdf(black)" : text.str() + ")";
}

using GgxState = std::tuple<double, int, double>;                     // alpha, Fresnel, ior
using TableState = std::tuple<std::shared_ptr<LobeTable>, int, int>;  // table, channel, order
using VaryingState = std::tuple<int, double>;                         // Fresnel, ior
using ShapeState = std::variant<std::monostate, GgxState, TableState, VaryingState>;
using LobeState = std::tuple<ShapeState, std::array<float, 3>, std::optional<std::vector<float>>>;

ShapeState shape_state_of(const Lobe& lobe) {
    if (const auto* ggx = std::get_if<GgxShape>(&lobe.shape)) {
        if (lobe.varying_width != 0) {
            return VaryingState{static_cast<int>(ggx->fresnel), ggx->ior};
        }
        return GgxState{ggx->alpha, static_cast<int>(ggx->fresnel), ggx->ior};
    }
    if (const auto* table = std::get_if<TableShape>(&lobe.shape)) {
        return TableState{std::const_pointer_cast<LobeTable>(table->table), table->channel, lobe.only_order};
    }
    return {};
}

std::vector<LobeState> state_of(const Bsdf& bsdf) {
    std::vector<LobeState> state;
    for (const Lobe& lobe : bsdf.lobes()) {
        state.push_back({shape_state_of(lobe),
                         {lobe.color.x, lobe.color.y, lobe.color.z},
                         lobe.weight ? std::optional(lobe.weight->nodes()) : std::nullopt});
    }
    return state;
}

LobeShape shape_from(const ShapeState& state) {
    if (std::holds_alternative<std::monostate>(state)) {
        return LambertShape{};
    }
    if (const auto* of_table = std::get_if<TableState>(&state)) {
        const auto& [table, channel, order] = *of_table;
        if (table == nullptr || channel < 0 || channel >= table->channels()) {
            throw std::invalid_argument("state does not describe a lobe");
        }
        return TableShape{table, channel};
    }
    const auto* of_points = std::get_if<VaryingState>(&state);
    const auto [alpha, fresnel, ior] =
        of_points != nullptr ? std::tuple_cat(std::tuple(1.0), *of_points) : std::get<GgxState>(state);
    if (!(alpha >= 0 && alpha <= 1 && ior > 1 && std::isfinite(ior)) || fresnel < static_cast<int>(Fresnel::one) ||
        fresnel > static_cast<int>(Fresnel::dielectric)) {
        throw std::invalid_argument("state does not describe a lobe");
    }
    return GgxShape{alpha, static_cast<Fresnel>(fresnel), ior};
}

Bsdf bsdf_from(const std::vector<LobeState>& state) {
    Bsdf sum;
    for (const auto& [shape, color, nodes] : state) {
        if (std::holds_alternative<VaryingState>(shape)) {
            sum = sum + Bsdf::varying(std::get<GgxShape>(shape_from(shape)));
            continue;
        }
        const auto* of_table = std::get_if<TableState>(&shape);
        sum = sum + Bsdf::lobe(shape_from(shape), {color[0], color[1], color[2]},
                               nodes ? std::make_shared<const ViewWeight>(*nodes) : nullptr,
                               of_table != nullptr ? std::get<2>(*of_table) : 0);
    }
    return sum;
}

/// The first line of this and the next two is the signature, as pybind11 writes those of other functions.
constexpr const char* kFromFunctionDoc =
    R"(from_function(f, *, isotropic=True, order='auto', samples=None)

A material of one's own.

f(view, light) takes unit vectors above the horizon, two arrays (n, 3), in the frame of the surface's tangent x and
normal z, and returns the BRDF [1/sr], (n,) or (n, 3) for RGB, without the cosine. It is called while the table is made
and never again.
isotropic: f does not change when both directions are turned about the normal, or mirrored. Otherwise the material is
anisotropic: see phi_o of shade_spheres.
order: "auto", or the only one, 1 … 64, in which harmonics shade it where the order of a call is "auto"; light for which
they err by more than the tolerance is integrated by cubature of the table.
samples: steps of a right angle in the angles of half vectors (Rusinkiewicz 1998), 8 … 128; 64 where f is isotropic, 20
otherwise. `residual` includes what the table lacks of f.
Raises ValueError naming the argument, for an f that is negative, not finite, or not isotropic, too.)";

constexpr const char* kFromTableDoc =
    R"(from_table(values, theta_in, phi_in, theta_out, phi_out, *, order='auto')

A BRDF from a table.

values: [1/sr], without the cosine, (theta_in, phi_in, theta_out, phi_out), or with a last axis of RGB; ≥ 0. in: to the
light; out: to the viewer. Between the angles f is linear in each.
theta_…: from the normal, in 0 … π/2, increasing; to π/2 the last two are extrapolated, but not below 0.
phi_…: about the normal from the tangent, increasing, around the circle; one more at 2π may repeat the first. With one
phi_in f depends on phi_out - phi_in only, and if that runs from 0 to π, it is the same for mirrored directions.
All angles are radians. order: see from_function. Raises ValueError naming the argument.)";

constexpr const char* kReadDoc =
    R"(read(path, *, order='auto')

A measured BRDF.

UTIA's .bin (Filip & Vávra 2014, "Template-Based Sampling of Anisotropic BRDFs"): anisotropic, θ every 15°, φ every
7.5°, 3 × 288 × 288 doubles, which are taken as they are.
MERL's .binary (Matusik et al. 2003, "A Data-Driven Reflectance Model"): isotropic, 90 × 90 × 180 × 3 doubles, scaled by
1/1500, 1.15/1500 and 1.66/1500. Directions that were not measured, marked by negative numbers, get the values beside
them; directions and their mirror images get the mean of both.
order: see from_function. Raises OSError for a file that cannot be read, ValueError for one that is neither.)";

constexpr const char* kDoc =
    R"(A material: a sum of coloured lobes f·cos in the shading frame (z is the surface normal).

Bsdfs can be added and multiplied by a number or an RGB colour. They are immutable. Colours are 0 … 1e10.
Multiplied by an expression of shlight.nodes, such as a picture, one is a Shader, which Scene.add_mesh takes too.

>>> varnish = shlight.Bsdf.lambert((0.4, 0.2, 0.1)) + shlight.Bsdf.ggx(0.2, 0.04)
>>> varnish.evaluate((0, 0, 1), (0.6, 0, 0.8)).round(4)
array([0.1279, 0.0643, 0.0324]))";

/// The first line is the signature, as pybind11 writes those of other functions: that of shlight.nodes.principled.
constexpr const char* kPrincipledDoc =
    R"(principled(base_color=(0.8, 0.8, 0.8), *, metallic=0.0, roughness=0.5, ior=1.5, alpha=1.0, diffuse_roughness=0.0, )"
    R"(specular_ior_level=0.5, specular_tint=(1.0, 1.0, 1.0), coat_weight=0.0, coat_roughness=0.03, coat_ior=1.5, )"
    R"(coat_tint=(1.0, 1.0, 1.0), coat_normal=None, sheen_weight=0.0, sheen_roughness=0.5, )"
    R"(sheen_tint=(1.0, 1.0, 1.0), transmission_weight=0.0, emission_color=(1.0, 1.0, 1.0), emission_strength=0.0, )"
    R"(anisotropic=0.0, anisotropic_rotation=0.0, tangent=None, )"
    R"(subsurface_weight=0.0, subsurface_radius=(1.0, 0.2, 0.1), subsurface_scale=0.05, subsurface_ior=1.4, )"
    R"(subsurface_anisotropy=0.0, subsurface_method='random_walk', thin_wall=False, )"
    R"(thin_film_thickness=0.0, thin_film_ior=1.33, thin_film_model='spectral', )"
    R"(diffuse_model='dimmed', several_bounces=False, at=None)

A Shader: Blender's Principled BSDF, see shlight.nodes.principled.)";

std::vector<Bsdf> single_lobes(const Bsdf& bsdf) {
    std::vector<Bsdf> single;
    std::transform(bsdf.lobes().begin(), bsdf.lobes().end(), std::back_inserter(single),
                   [](const Lobe& lobe) { return Bsdf::lobe(lobe.shape, lobe.color, lobe.weight, lobe.only_order); });
    return single;
}

/// The lobes that are not black with colour 1, and their colours (lobes, 3).
std::pair<Bsdf, Array<float>> uncolored(const Bsdf& bsdf) {
    std::vector<Rgb> colors;
    for (const Lobe& lobe : bsdf.lobes()) {
        if (lobe.color != Rgb(0)) {
            colors.push_back(lobe.color);
        }
    }
    Array<float> array({static_cast<py::ssize_t>(colors.size()), py::ssize_t{3}});
    std::copy(colors.begin(), colors.end(), reinterpret_cast<Rgb*>(array.mutable_data()));
    return {bsdf.uncolored(), array};
}

}  // namespace

void bind_bsdf(py::module_& m) {
    m.def("uncolored", &uncolored, py::arg("bsdf"));
    m.def("single_lobes", &single_lobes, py::arg("bsdf"));
    m.def(
        "varying_ggx", [](const py::object& ior) { return Bsdf::varying_ggx(ior_from(ior)); }, py::arg("ior"));
    m.attr("LEAST_ROUGHNESS") = kLeastRoughness;
    py::class_<Bsdf> type(m, "Bsdf", kDoc, without_constructor());
    define_pickling(type, &state_of, &bsdf_from);
    {
        py::options options;
        options.disable_function_signatures();
        const auto forward = [&](const char* name, const char* doc, py::object (*function)(const char*)) {
            type.def_static(
                name,
                [=](const py::args& positional, const py::kwargs& named) {
                    return function(name)(*positional, **named);
                },
                doc);
        };
        forward("principled", kPrincipledDoc, &shader_function);
        forward("from_function", kFromFunctionDoc, &table_function);
        forward("from_table", kFromTableDoc, &table_function);
        forward("read", kReadDoc, &table_function);
    }
    type.def_static(
            "lambert", &lambert, py::arg("albedo"),
            "Diffuse: f·cos = albedo · cosθ_i / π. albedo: a number or RGB, ≥ 0. Order 2 is exact.\n\n"
            "Of an expression of shlight.nodes, here and below, it is a Shader, which Scene.add_mesh takes too.")
        .def_static(
            "oren_nayar",
            [](const py::object& albedo, const py::object& sigma) {
                return shader_function("oren_nayar")(albedo, sigma);
            },
            py::arg("albedo"), py::arg("sigma"),
            "A Shader: diffuse of roughness sigma, 0 … 1; albedo: a number, RGB or an expression of shlight.nodes.")
        .def_static("ggx", &ggx, py::arg("roughness"), py::arg("f0"), py::kw_only(), py::arg("ior") = py::none(),
                    R"(GGX microfacets with height-correlated Smith masking; alpha = roughness², 0 ≤ roughness ≤ 1.
Below a roughness of 0.003 a perfect mirror: lights reflect in it, but it has no coefficients and evaluates to 0.

f0 (a number or RGB) is the reflectance seen head-on; Fresnel is f0 + (1 - f0) s with Schlick's
s = (1 - cosθ_d)⁵ or, with `ior`, finite and greater than 1, the dielectric Fresnel curve of that index remapped to
0 … 1; s is 0 where the curve of an index above 3.73 dips under its value head-on.
Raises ValueError naming the argument.)")
        .def_static("layer", &layer, py::arg("top"), py::arg("base"),
                    "top + base · (1 - largest channel of top's directional albedo at the view angle).")
        .def("coefficients", &coefficients, py::arg("cos_theta_o"), py::arg("order"), py::arg("phi_o") = py::none(),
             R"(Coefficients of f·cos for ω_o = (sinθ_o, 0, cosθ_o): shape (..., order²), float32, or (..., 3, order²)
if the material has colour. They fit the upper hemisphere only: use them with light clipped at the horizon.
phi_o: the view's azimuth [rad] in the frame of the coefficients, whose x is the surface's tangent; broadcasts; None: 0.
Raises ValueError for cos_theta_o outside [0, 1] or an order outside 1 … 64.)")
        .def("residual", &residual, py::arg("cos_theta_o"), py::arg("order"), py::arg("phi_o") = py::none(),
             R"(Relative L2 error of that fit over the upper hemisphere, shape (...), in the colour channel where it is
largest. For a sum of lobes an upper bound. For a function that was sampled it includes what its table lacks.)")
        .def("evaluate", &evaluate, py::arg("wi"), py::arg("wo"),
             R"(f·cos for directions (..., 3) in the shading frame, whose x is the tangent of an anisotropic material.
They broadcast against each other: shape (...), or (..., 3) if the material has colour. Zero where either direction lies
below the horizon.)")
        .def_property_readonly("is_anisotropic", &Bsdf::is_anisotropic,
                               "Whether the azimuth of the view from the surface's tangent on matters.")
        .def("__repr__", &repr)
        .def(py::self + py::self)
        .def(
            "__radd__",
            [](const Bsdf& bsdf, const py::int_& start) {
                if (!start.equal(py::int_(0))) {
                    throw py::type_error("a Bsdf can be added to Bsdfs alone");
                }
                return bsdf;
            },
            py::arg("start"), py::is_operator(), "What sum() begins with, 0, adds nothing.")
        .def("__mul__", &scaled, py::arg("factor"), py::is_operator())
        .def("__rmul__", &scaled, py::arg("factor"), py::is_operator())
        // Otherwise numpy would apply `array * bsdf` to each element of the array.
        .attr("__array_ufunc__") = py::none();
}

}  // namespace shlight::python
